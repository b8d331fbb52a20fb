//! The wide search: thousands of first poses, all over the rotations and, where the sizes differ,
//! all over the larger part, run on a [`FeatureGrid`] instead of the exact tree.
//!
//! A question to the grid costs the same however far away it is asked, so parts that do not fit
//! cost no more than parts that do. Each pose makes robust point-to-plane steps on few points with
//! a wide reach; after each round the better and distinct ones go on with more points and a
//! narrower reach. What survives lies within about a cell of where it belongs and is ranked on the
//! exact meshes by the caller.

mod cloud;
mod holes;
mod rounds;
mod seeds;
mod step;

use std::sync::Arc;

use super::starts::StartKind;
use super::surface::Surface;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::search::{FeatureGrid, GridSettings};
use cloud::{Cloud, area_samples};
use holes::Holes;
use rounds::{Ground, Round};
use seeds::{Seed, SeedCounts};

/// Points that are worked on side by side.
const LANES: usize = 8;
/// Samples of the larger part in its grid.
const N_GRID_SAMPLES: usize = 30_000;
/// Samples of the smaller part.
const N_DATA_SAMPLES: usize = 1200;
/// Parts whose areas differ by more than this share are aligned at many places.
const SAME_AREA: f64 = 0.1;
/// Below this share of the larger area a part is a piece that may slide along the other, and its holes give starts. With
/// an addendum on the other part it is larger, and the borders say more than the middles of a few holes.
const CLEARLY_SMALLER: f64 = 0.65;

/// A pose that survived the wide search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideFind {
    /// The first pose it came from.
    pub kind: StartKind,
    /// True if the data's normals count reversed.
    pub flipped: bool,
    /// Where it lies: the data on the model. Mirrors if the opposite hand was searched.
    pub model_from_data: Similarity,
    /// Mean of Tukey's loss over the data at the last reach: 0 where all of it lies on the model, 1
    /// where nothing does.
    pub loss: f64,
}

/// The larger part of a pair made ready to search on, with the smaller one's samples.
pub struct WideSearch<'a> {
    data: &'a Surface,
    model: &'a Surface,
    grid: Arc<FeatureGrid>,
    cloud: Cloud,
}

/// Starts of parts that may cover each other: 400 rotations lie within 27° of every rotation.
const WHOLE: SeedCounts = SeedCounts {
    rotations: 400,
    places: 1,
    patches: 0,
    turns: 0,
};
/// Starts of a piece on a whole.
const PIECE: SeedCounts = SeedCounts {
    rotations: 300,
    places: 8,
    patches: 100,
    turns: 24,
};
/// Starts of parts of one size that do not cover each other.
const OVERHANGING: SeedCounts = SeedCounts {
    rotations: 150,
    places: 8,
    patches: 50,
    turns: 24,
};
/// Above this loss the parts do not cover each other. Noise of 1 mm on the sample parts stays below
/// it, a strip of 15 % that misses lies above.
const CONTAINED_LOSS: f64 = 0.1;

const ROUNDS: [Round; 5] = [
    Round {
        cut: 1.0,
        n_points: 64,
        n_steps: 4,
        keep: 0.25,
        least: 100,
        most: 3000,
    },
    Round {
        cut: 0.53,
        n_points: 120,
        n_steps: 6,
        keep: 0.2,
        least: 40,
        most: 600,
    },
    Round {
        cut: 0.27,
        n_points: 304,
        n_steps: 8,
        keep: 0.25,
        least: 16,
        most: 120,
    },
    Round {
        cut: 0.13,
        n_points: 1200,
        n_steps: 12,
        keep: 0.4,
        least: 12,
        most: 40,
    },
    Round {
        cut: 0.067,
        n_points: 1200,
        n_steps: 10,
        keep: 1.0,
        least: 8,
        most: 12,
    },
];

/// What holes lay together lies within a few hundredths of where it belongs: all of it is looked at, and the better
/// part moved.
const HOLE_ROUNDS: [Round; 4] = [
    Round {
        cut: 0.27,
        n_points: 64,
        n_steps: 0,
        keep: 0.1,
        least: 40,
        most: 200,
    },
    Round {
        cut: 0.27,
        n_points: 304,
        n_steps: 4,
        keep: 0.25,
        least: 12,
        most: 60,
    },
    Round {
        cut: 0.13,
        n_points: 1200,
        n_steps: 8,
        keep: 0.5,
        least: 8,
        most: 24,
    },
    Round {
        cut: 0.067,
        n_points: 1200,
        n_steps: 10,
        keep: 1.0,
        least: 4,
        most: 8,
    },
];

/// Poses that holes give, of those under which the most of them have their counterpart.
const MOST_ON_HOLES: usize = 4;

/// Reach of the first round, as a share of the data's diagonal.
const REACH: f32 = 0.15;

/// A surface as a grid. `None` if it has no extent.
pub(crate) fn surface_grid(surface: &Surface) -> Option<FeatureGrid> {
    let samples = area_samples(surface, N_GRID_SAMPLES);
    FeatureGrid::build(&samples, &GridSettings::default())
}

impl<'a> WideSearch<'a> {
    /// Makes the grid of `model`, which should be the larger part, and samples `data`. About 10 ms.
    /// `None` if the model has no extent.
    pub fn new(data: &'a Surface, model: &'a Surface) -> Option<Self> {
        Some(Self::on(data, model, Arc::new(surface_grid(model)?)))
    }

    /// The same with the grid that [`surface_grid`] makes of `model`.
    pub(crate) fn on(data: &'a Surface, model: &'a Surface, grid: Arc<FeatureGrid>) -> Self {
        Self {
            data,
            model,
            cloud: Cloud::new(data, N_DATA_SAMPLES, grid.scale()),
            grid,
        }
    }

    /// The distinct poses that survive, best first; those of the opposite hand if `mirrored`. After
    /// a stop request what has been reached. The same for any number of threads.
    pub fn run(&self, mirrored: bool, monitor: &Monitor) -> Result<Vec<WideFind>, Cancelled> {
        let turned;
        let cloud = if mirrored {
            turned = self.cloud.mirrored();
            &turned
        } else {
            &self.cloud
        };
        let counts = self.counts();
        let parts = (self.data, self.model);
        let ground = Ground {
            cloud,
            grid: &self.grid,
            reach: REACH * cloud.diagonal.min(1.0),
        };
        let find = |seeds: &[Seed], candidate: &rounds::Candidate| WideFind {
            kind: seeds[candidate.seed as usize].kind,
            flipped: candidate.flipped,
            model_from_data: cloud.model_from_data(&candidate.motion, &self.grid),
            loss: f64::from(candidate.loss),
        };
        let run = |counts: SeedCounts| {
            let seeds = seeds::seeds(cloud, parts, &self.grid, counts);
            let survivors = rounds::run(ground, &seeds, &ROUNDS, monitor)?;
            let found = survivors.iter().map(|candidate| find(&seeds, candidate));
            Ok::<Vec<WideFind>, Cancelled>(found.collect())
        };
        let mut found = run(counts)?;
        // Parts of one size whose centroids do not belong on each other overhang each other.
        let is_whole = counts.patches == 0;
        let is_apart = found.first().is_none_or(|best| best.loss > CONTAINED_LOSS);
        if is_whole && is_apart {
            found = run(OVERHANGING)?;
        }
        if self.area_ratio() < CLEARLY_SMALLER {
            let holes = Holes::of(cloud, parts, &self.grid);
            let seeds = holes.seeds();
            let survivors = rounds::run(ground, &seeds, &HOLE_ROUNDS, monitor)?;
            let on_holes = most_on_holes(&holes, survivors);
            found.extend(on_holes.iter().map(|candidate| find(&seeds, candidate)));
            found.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        }
        Ok(found)
    }

    /// True if the data may cover all of the model.
    pub(crate) fn is_whole(&self) -> bool {
        self.counts() == WHOLE
    }

    fn area_ratio(&self) -> f64 {
        self.data.measures().area / self.model.measures().area
    }

    fn counts(&self) -> SeedCounts {
        if self.area_ratio() > 1.0 - SAME_AREA {
            WHOLE
        } else {
            PIECE
        }
    }
}

/// Of poses sorted by their loss those under which the most holes have their counterpart, moved onto these.
fn most_on_holes(holes: &Holes, survivors: Vec<rounds::Candidate>) -> Vec<rounds::Candidate> {
    let laid = survivors.into_iter().map(|candidate| {
        let (n, motion) = holes.laid(&candidate.motion);
        (
            n,
            rounds::Candidate {
                motion,
                ..candidate
            },
        )
    });
    let mut laid: Vec<(usize, rounds::Candidate)> = laid.collect();
    let most = laid.iter().map(|(n, _)| *n).max().unwrap_or(0);
    laid.retain(|(n, _)| *n == most && *n > 0);
    laid.truncate(MOST_ON_HOLES);
    laid.into_iter().map(|(_, candidate)| candidate).collect()
}
