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
mod pieces;
mod rounds;
mod seeds;
mod step;

use std::sync::Arc;

use super::starts::StartKind;
use super::surface::Surface;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::search::{FeatureGrid, GridSettings};
use cloud::{Cloud, Motion32, area_samples};
use holes::GridHoles;
use rounds::{Ground, Round};
use seeds::SeedCounts;

/// Samples that are worked on side by side.
const LANES: usize = 4;
/// Samples of a block.
const BLOCK: usize = 2 * LANES;
/// Samples of the larger part in its grid.
const N_GRID_SAMPLES: usize = 30_000;
/// Samples of the smaller part.
const N_DATA_SAMPLES: usize = 1200;
/// Parts whose areas differ by more than this share are aligned at many places.
const SAME_AREA: f64 = 0.1;

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
const CONTAINED_LOSS: f32 = 0.1;

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

/// What holes align lies within a few hundredths of where it belongs: all of it is looked at, and the better
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
/// Poses that holes give at most.
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

    /// The distinct poses that survive, best first. After a stop request what has been reached. The same for any
    /// number of threads.
    pub fn run(&self, monitor: &Monitor) -> Result<Vec<WideFind>, Cancelled> {
        self.run_with(&self.cloud, monitor)
    }

    /// The same for the opposite hand of the data.
    pub fn run_mirrored(&self, monitor: &Monitor) -> Result<Vec<WideFind>, Cancelled> {
        self.run_with(&self.cloud.mirrored(), monitor)
    }

    fn run_with(&self, cloud: &Cloud, monitor: &Monitor) -> Result<Vec<WideFind>, Cancelled> {
        let counts = self.counts();
        let mut seeds = seeds::seeds(cloud, (self.data, self.model), &self.grid, counts);
        let ground = self.ground(cloud);
        let mut found = rounds::run(
            ground,
            seeds.iter().map(|seed| seed.first),
            &ROUNDS,
            monitor,
        )?;
        // Parts of one size whose centroids do not belong on each other overhang each other.
        if counts.patches == 0 && found.first().is_none_or(|best| best.loss > CONTAINED_LOSS) {
            seeds = seeds::seeds(cloud, (self.data, self.model), &self.grid, OVERHANGING);
            found = rounds::run(
                ground,
                seeds.iter().map(|seed| seed.first),
                &ROUNDS,
                monitor,
            )?;
        }
        let find = |candidate: rounds::TriedPose| WideFind {
            kind: seeds[candidate.seed as usize].kind,
            flipped: candidate.flipped,
            model_from_data: cloud.model_from_data(&candidate.motion, &self.grid),
            loss: f64::from(candidate.loss),
        };
        Ok(found.into_iter().map(find).collect())
    }

    /// Poses `model_from_data` in which holes of the data lie on holes of the model that are as large and as far apart:
    /// of those whose surfaces lie close the ones under which the most holes have their counterpart, at most four. They
    /// are as exact as the middles of a few holes. Empty where a part has no holes.
    /// O(holes of the data² · holes of the model² + poses), all bounded.
    pub fn on_holes(&self, monitor: &Monitor) -> Result<Vec<Similarity>, Cancelled> {
        self.on_holes_with(&self.cloud, monitor)
    }

    /// The same for the opposite hand: the poses mirror.
    pub fn on_holes_mirrored(&self, monitor: &Monitor) -> Result<Vec<Similarity>, Cancelled> {
        self.on_holes_with(&self.cloud.mirrored(), monitor)
    }

    fn on_holes_with(
        &self,
        cloud: &Cloud,
        monitor: &Monitor,
    ) -> Result<Vec<Similarity>, Cancelled> {
        let holes = GridHoles::of(cloud, (self.data, self.model), &self.grid);
        let ground = self.ground(cloud);
        let first = holes.first_poses(monitor)?.into_iter();
        let survivors = rounds::run(ground, first, &HOLE_ROUNDS, monitor)?.into_iter();
        let moved = survivors.map(|candidate| holes.aligned(&candidate.motion));
        let mut moved: Vec<(usize, Motion32)> = moved.collect();
        let most = moved.iter().map(|(n, _)| *n).max().unwrap_or(0);
        moved.retain(|(n, _)| *n == most && *n > 0);
        moved.truncate(MOST_ON_HOLES);
        let poses = moved
            .iter()
            .map(|(_, motion)| cloud.model_from_data(motion, &self.grid));
        Ok(poses.collect())
    }

    fn ground<'b>(&'b self, cloud: &'b Cloud) -> Ground<'b> {
        Ground {
            cloud,
            grid: &self.grid,
            reach: REACH * cloud.diagonal.min(1.0),
        }
    }

    /// True if the data may cover all of the model.
    pub(crate) fn is_whole(&self) -> bool {
        self.counts() == WHOLE
    }

    fn counts(&self) -> SeedCounts {
        if is_piece(self.data, self.model) {
            PIECE
        } else {
            WHOLE
        }
    }
}

/// True if a part is too small to cover all of another one.
pub(crate) fn is_piece(data: &Surface, model: &Surface) -> bool {
    data.measures().area <= (1.0 - SAME_AREA) * model.measures().area
}
