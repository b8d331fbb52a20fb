//! Reduction to any number of triangles, with the deviation measured rather than estimated.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use rayon::prelude::*;

use super::load::LoadedPart;
use super::{PipelineError, millis_since};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{BorderEdges, Point3, Topology, TriMesh};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;
use crate::search::{Bvh, ClosestPoint};
use crate::simplify::{CollapseSequence, SimplifyReport, SimplifySettings};

/// Points a surface is sampled with, at least, when a deviation is measured.
const N_SAMPLES: usize = 60_000;
/// Points per unit of parallel work; fixed, so that sums do not depend on the number of threads.
const CHUNK: usize = 1024;

/// A mesh at one level of reduction.
#[derive(Debug, Clone)]
pub struct Level {
    /// The reduced mesh.
    pub mesh: Arc<TriMesh>,
    /// For each of its triangles, the triangle of the full mesh it descends from.
    pub triangle_of: Arc<Vec<u32>>,
    /// What the reduction did.
    pub report: SimplifyReport,
    /// Triangles that face away from the full mesh's triangle they came from: folds.
    pub n_flipped: usize,
}

/// Measured distance between a reduced mesh and the full one, in length units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Root mean square over both surfaces, each sampled and measured to the other.
    pub rms: f64,
    /// Largest distance of a sample, both ways.
    pub max: f64,
    /// Root mean square distance between the border lines, both ways; 0 without borders.
    pub border_rms: f64,
    /// Largest distance between the border lines, both ways; 0 without borders.
    pub border_max: f64,
    /// Border loops of the full mesh.
    pub loops_before: usize,
    /// Border loops of the reduced mesh.
    pub loops_after: usize,
}

/// A recorded reduction: every level from full to the coarsest is at hand.
pub struct Levels {
    full: Arc<TriMesh>,
    /// The full mesh as it was prepared when the part was loaded.
    prepared: Option<Arc<Surface>>,
    sequence: CollapseSequence,
    /// Trees over the full surface and its border, made when a deviation is first asked for.
    full_trees: OnceLock<Trees>,
    /// Time the recording took, in milliseconds.
    pub record_ms: f64,
}

struct Trees {
    surface: Arc<Bvh>,
    border: Bvh,
    n_loops: usize,
}

impl Levels {
    /// Records the reduction of a loaded part down to `settings.max_triangles`; edges between its
    /// parts are kept like borders.
    pub fn record(
        part: &LoadedPart,
        settings: &SimplifySettings,
        monitor: &Monitor,
    ) -> Result<Self, PipelineError> {
        let labels = part.ids.parts();
        let several = labels.windows(2).any(|pair| pair[0] != pair[1]);
        let levels = Self::record_mesh(
            &part.mesh,
            if several { labels } else { &[] },
            settings,
            monitor,
        )?;
        Ok(Self {
            prepared: Some(Arc::clone(&part.surface)),
            ..levels
        })
    }

    /// [`Levels::record`] for a bare mesh; `labels` names the part of each triangle or is empty.
    pub fn record_mesh(
        mesh: &Arc<TriMesh>,
        labels: &[u32],
        settings: &SimplifySettings,
        monitor: &Monitor,
    ) -> Result<Self, PipelineError> {
        let start = Instant::now();
        monitor.progress("reduce", 0, None);
        let sequence = CollapseSequence::record_parts(mesh, labels, settings, monitor)?;
        Ok(Self {
            full: mesh.clone(),
            prepared: None,
            sequence,
            full_trees: OnceLock::new(),
            record_ms: millis_since(start),
        })
    }

    /// The full mesh.
    pub fn full(&self) -> &Arc<TriMesh> {
        &self.full
    }

    /// Triangles of the coarsest level that was recorded.
    pub fn coarsest(&self) -> usize {
        self.sequence.coarsest()
    }

    /// The finest mesh with at most `max_triangles` triangles. O(vertices + triangles).
    pub fn level(&self, max_triangles: usize, monitor: &Monitor) -> Result<Level, Cancelled> {
        let simplified = self.sequence.simplified(max_triangles, monitor)?;
        Ok(Level {
            n_flipped: n_flipped(
                &self.full,
                &simplified.mesh,
                &simplified.triangle_of,
                monitor,
            )?,
            mesh: Arc::new(simplified.mesh),
            triangle_of: Arc::new(simplified.triangle_of),
            report: simplified.report,
        })
    }

    /// Measures how far `reduced` lies from the full mesh.
    pub fn measure(&self, reduced: &TriMesh, monitor: &Monitor) -> Result<Deviation, Cancelled> {
        let full = match self.full_trees.get() {
            Some(known) => known,
            None => {
                let made = match &self.prepared {
                    Some(full) => {
                        Trees::new(full.border_edges(), Arc::clone(full.shared_bvh()), monitor)?
                    }
                    None => Trees::of(&self.full, monitor)?,
                };
                self.full_trees.get_or_init(|| made)
            }
        };
        let ours = Trees::of(&Arc::new(reduced.clone()), monitor)?;
        let there = spread(&surface_samples(reduced, monitor)?, &full.surface, monitor)?;
        let back = spread(
            &surface_samples(&self.full, monitor)?,
            &ours.surface,
            monitor,
        )?;
        let border_there = spread(&border_samples(ours.border.mesh()), &full.border, monitor)?;
        let border_back = spread(&border_samples(full.border.mesh()), &ours.border, monitor)?;
        let surface = there.and(&back);
        let border = border_there.and(&border_back);
        Ok(Deviation {
            rms: surface.rms(),
            max: surface.max,
            border_rms: border.rms(),
            border_max: border.max,
            loops_before: full.n_loops,
            loops_after: ours.n_loops,
        })
    }
}

/// Triangles of `reduced` that face away from the triangles of `full` they came from.
fn n_flipped(
    full: &TriMesh,
    reduced: &TriMesh,
    triangle_of: &[u32],
    monitor: &Monitor,
) -> Result<usize, Cancelled> {
    let faces_away = |triangle: &usize| {
        let before = full.area_vector(triangle_of[*triangle] as usize);
        reduced.area_vector(*triangle).dot(&before) < 0.0
    };
    let mut n = 0;
    for_chunks(triangle_of.len(), monitor, |range| {
        n += range.filter(faces_away).count();
    })?;
    Ok(n)
}

impl Trees {
    fn of(mesh: &Arc<TriMesh>, monitor: &Monitor) -> Result<Self, Cancelled> {
        let edges = BorderEdges::of(mesh, &Topology::build(mesh, monitor)?);
        let surface = Bvh::build_for(Arc::clone(mesh), monitor)?;
        Self::new(&edges, Arc::new(surface), monitor)
    }

    fn new(edges: &BorderEdges, surface: Arc<Bvh>, monitor: &Monitor) -> Result<Self, Cancelled> {
        let mesh = surface.mesh();
        // A border edge as a triangle without area: the tree then answers for the line.
        let segments = edges.iter().map(|edge| {
            let [u, v] = edge.ends;
            [u, v, v]
        });
        let border = TriMesh::new(mesh.positions().to_vec(), segments.collect())
            .expect("every edge names vertices of the mesh");
        let n_loops = edges.loops().len();
        Ok(Self {
            border: Bvh::build_for(Arc::new(border), monitor)?,
            n_loops,
            surface,
        })
    }
}

/// A point that stands for a piece of surface or line.
struct Sample {
    point: Point3,
    weight: f64,
}

/// Corners of a regular subdivision of every triangle, about [`N_SAMPLES`] in all and at least three of each, weighted
/// by area.
fn surface_samples(mesh: &TriMesh, monitor: &Monitor) -> Result<Vec<Sample>, Cancelled> {
    let piece = mesh.area() / N_SAMPLES as f64;
    let mut samples = Vec::with_capacity(2 * N_SAMPLES);
    for_chunks(mesh.n_triangles(), monitor, |range| {
        for t in range {
            let area = mesh.triangle_area(t);
            let n = (2.0 * area / piece).sqrt().ceil().clamp(1.0, 300.0) as usize;
            let [a, b, c] = mesh.corners(t);
            // Corners belong to the surface too, and the largest distance is often found there.
            let count = (n + 1) * (n + 2) / 2;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
                    let point = a + (b - a) * u + (c - a) * v;
                    samples.push(Sample {
                        point,
                        weight: area / count as f64,
                    });
                }
            }
        }
    })?;
    Ok(samples)
}

/// Ends and inner points of every segment, weighted by length.
fn border_samples(segments: &TriMesh) -> Vec<Sample> {
    const N: usize = 8;
    let mut samples = Vec::with_capacity(segments.n_triangles() * (N + 1));
    for t in 0..segments.n_triangles() {
        let [a, b, _] = segments.corners(t);
        let weight = (b - a).norm() / (N + 1) as f64;
        samples.extend((0..=N).map(|i| Sample {
            point: a + (b - a) * (i as f64 / N as f64),
            weight,
        }));
    }
    samples
}

/// Weighted squares of distances, and the largest one.
#[derive(Debug, Clone, Copy, Default)]
struct Spread {
    sum_sq: f64,
    weight: f64,
    max: f64,
}

impl Spread {
    fn and(&self, other: &Self) -> Self {
        Self {
            sum_sq: self.sum_sq + other.sum_sq,
            weight: self.weight + other.weight,
            max: self.max.max(other.max),
        }
    }

    fn rms(&self) -> f64 {
        if self.weight > 0.0 {
            (self.sum_sq / self.weight).sqrt()
        } else {
            0.0
        }
    }
}

fn spread(samples: &[Sample], tree: &Bvh, monitor: &Monitor) -> Result<Spread, Cancelled> {
    let chunks: Result<Vec<Spread>, Cancelled> = samples
        .par_chunks(CHUNK)
        .map(|chunk| {
            monitor.check()?;
            let mut spread = Spread::default();
            let mut hint = None;
            for sample in chunk {
                let Some(hit) = tree.closest(&sample.point, f64::INFINITY, hint, None) else {
                    continue;
                };
                hint = Some(hit.triangle);
                spread.sum_sq += sample.weight * hit.distance_sq;
                spread.weight += sample.weight;
                spread.max = spread.max.max(hit.distance_sq.sqrt());
            }
            Ok(spread)
        })
        .collect();
    Ok(chunks?
        .iter()
        .fold(Spread::default(), |sum, spread| sum.and(spread)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy n × n plate.
    fn plate(n: u32, height: f64) -> Arc<TriMesh> {
        let mut positions = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let (x, y) = (f64::from(i), f64::from(j));
                positions.push(Point3::new(
                    x,
                    y,
                    height * (0.4 * x).sin() * (0.3 * y).cos(),
                ));
            }
        }
        let quad = |k: u32| {
            let a = k / n * (n + 1) + k % n;
            [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
        };
        let triangles = (0..n * n).flat_map(quad).collect();
        Arc::new(TriMesh::new(positions, triangles).unwrap())
    }

    #[test]
    fn a_shifted_copy_is_as_far_as_it_was_shifted() {
        let mesh = plate(6, 0.0);
        let levels =
            Levels::record_mesh(&mesh, &[], &SimplifySettings::default(), &Monitor::silent())
                .unwrap();
        let up = crate::geometry::Similarity {
            translation: crate::geometry::Vector3::new(0.0, 0.0, 0.25),
            ..Default::default()
        };
        let deviation = levels
            .measure(&mesh.transformed(&up), &Monitor::silent())
            .unwrap();
        assert!((deviation.rms - 0.25).abs() < 1e-12, "{deviation:?}");
        assert!((deviation.max - 0.25).abs() < 1e-12);
        assert!((deviation.border_max - 0.25).abs() < 1e-12);
        assert_eq!((deviation.loops_before, deviation.loops_after), (1, 1));
    }

    #[test]
    fn triangles_that_turn_over_are_counted() {
        let mesh = plate(6, 0.5);
        let own: Vec<u32> = (0..mesh.n_triangles() as u32).collect();
        let flipped = |other| n_flipped(&mesh, other, &own, &Monitor::silent());
        assert_eq!(flipped(&mesh), Ok(0));
        let turned = (*mesh).clone().flipped();
        assert_eq!(flipped(&turned), Ok(mesh.n_triangles()));
        let settings = SimplifySettings::to_triangles(20);
        let levels = Levels::record_mesh(&mesh, &[], &settings, &Monitor::silent()).unwrap();
        let level = levels.level(20, &Monitor::silent()).unwrap();
        assert_eq!(level.n_flipped, 0);
    }

    #[test]
    fn levels_keep_the_ceiling_and_come_closer_with_more_triangles() {
        let mesh = plate(40, 2.0);
        let settings = SimplifySettings::to_triangles(100);
        let levels = Levels::record_mesh(&mesh, &[], &settings, &Monitor::silent()).unwrap();
        let rms: Vec<f64> = [100, 400, 1600, 3200]
            .map(|n| {
                let level = levels.level(n, &Monitor::silent()).unwrap();
                assert!(level.mesh.n_triangles() <= n);
                levels.measure(&level.mesh, &Monitor::silent()).unwrap().rms
            })
            .to_vec();
        assert!(rms.windows(2).all(|pair| pair[0] > pair[1]), "{rms:?}");
        assert!(rms[3] < 1e-12);
    }

    #[test]
    fn measuring_can_be_cancelled() {
        let mesh = plate(6, 0.0);
        let levels =
            Levels::record_mesh(&mesh, &[], &SimplifySettings::default(), &Monitor::silent())
                .unwrap();
        let monitor = Monitor::silent();
        monitor.request_cancel();
        assert_eq!(levels.measure(&mesh, &monitor), Err(Cancelled));
    }
}
