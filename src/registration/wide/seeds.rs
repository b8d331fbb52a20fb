//! The first poses: a covering of all rotations at several places, and mean normals of patches.

use nalgebra::SymmetricEigen;

use super::BLOCK;
use super::cloud::{Cloud, Motion32};
use super::rounds::First;
use crate::geometry::{Matrix3, Rotation, Vector3, frame_about};
use crate::registration::starts::{StartKind, super_fibonacci};
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// How many first poses are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SeedCounts {
    /// Rotations of the covering.
    pub(super) rotations: usize,
    /// Places on the larger part for each rotation; 1 lays the centroids on each other.
    pub(super) places: usize,
    /// Patches of the larger part for the local form of "align surface normal".
    pub(super) patches: usize,
    /// Turns about the normal of each patch.
    pub(super) turns: usize,
}

/// A first pose with how it came to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seed {
    pub(super) kind: StartKind,
    pub(super) first: First,
}

/// Samples of the larger part that its patches are measured on.
const N_MODEL_SAMPLES: usize = 2000;
/// Radius of a patch, as a multiple of the data's root mean square distance from its middle.
const PATCH_RADIUS: f64 = 1.2;

/// A point with its normal in grid units.
type Sample = (Vector3, Vector3);

/// All first poses of `cloud` on the surface of `grid`, in a fixed order.
pub(super) fn seeds(
    cloud: &Cloud,
    (data, model): (&Surface, &Surface),
    grid: &FeatureGrid,
    counts: SeedCounts,
) -> Vec<Seed> {
    let scene = Scene::new(cloud, grid);
    let mut found = Vec::new();
    let spread = scene.spread(counts.places.max(counts.patches));
    let centroid = local(grid.to_local(&model.measures().centroid));
    let axes = cloud_axes(cloud, data);
    let rotations = super_fibonacci(counts.rotations);
    for place in 0..counts.places {
        // The first place aligns the centres, the others the middle of the data with a point.
        let (from, to) = match place {
            0 => (Vector3::zeros(), centroid),
            _ => (scene.middle, spread[(place - 1) % spread.len()]),
        };
        for (index, rotation) in rotations.iter().enumerate() {
            let turn = model.measures().principal_axes * matrix(rotation) * axes.transpose();
            push_both(
                &mut found,
                StartKind::Wide {
                    rotation: index,
                    place,
                },
                |_| aligned(&turn, &from, &to),
            );
        }
    }
    if counts.patches > 0 {
        let whole = Patch::around(&scene.data, &scene.middle, scene.radius);
        for (patch, center) in spread.iter().take(counts.patches).enumerate() {
            let there = Patch::around(&scene.model, center, scene.radius);
            for k in 0..counts.turns {
                let angle_deg = 360.0 * k as f64 / counts.turns as f64;
                push_both(
                    &mut found,
                    StartKind::Patch { patch, angle_deg },
                    |flipped| {
                        let turn =
                            Rotation::from_axis_angle(&Vector3::z_axis(), angle_deg.to_radians());
                        let turn =
                            there.frame(false) * matrix(&turn) * whole.frame(flipped).transpose();
                        aligned(&turn, &whole.center, &there.center)
                    },
                );
            }
        }
    }
    found
}

fn push_both(found: &mut Vec<Seed>, kind: StartKind, motion: impl Fn(bool) -> Motion32) {
    for flipped in [false, true] {
        found.push(Seed {
            kind,
            first: First {
                flipped,
                motion: motion(flipped),
            },
        });
    }
}

pub(super) fn matrix(rotation: &Rotation) -> Matrix3 {
    *rotation.to_rotation_matrix().matrix()
}

fn local(point: [f32; 3]) -> Vector3 {
    Vector3::from(point.map(f64::from))
}

/// The motion that turns by `turn` and moves `from` onto `to`.
pub(super) fn aligned(turn: &Matrix3, from: &Vector3, to: &Vector3) -> Motion32 {
    let translation = to - turn * from;
    Motion32 {
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| turn[(i, j)] as f32)),
        translation: [
            translation.x as f32,
            translation.y as f32,
            translation.z as f32,
        ],
    }
}

/// The data's principal axes in the frame of its cloud, right-handed.
fn cloud_axes(cloud: &Cloud, data: &Surface) -> Matrix3 {
    let mut axes = data.measures().principal_axes;
    if cloud.is_mirrored {
        axes.row_mut(0).neg_mut();
        axes.column_mut(2).neg_mut();
    }
    axes
}

/// Samples of both parts and the size of a patch.
struct Scene {
    data: Vec<Sample>,
    model: Vec<Sample>,
    /// The sample of the data nearest to its centroid.
    middle: Vector3,
    radius: f64,
}

impl Scene {
    fn new(cloud: &Cloud, grid: &FeatureGrid) -> Self {
        let blocks = cloud.blocks.iter();
        let normals = blocks.flat_map(|block| (0..BLOCK).map(|l| local(block.normal(l))));
        let data: Vec<Sample> = cloud.points().zip(normals).collect();
        let step = grid.features().len().div_ceil(N_MODEL_SAMPLES);
        let model = grid.features().iter().step_by(step);
        let model = model
            .map(|f| (local(f.point.into()), local(f.normal.into())))
            .collect();
        let middle = data
            .iter()
            .map(|(point, _)| *point)
            .min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))
            .unwrap_or_default();
        let sum: f64 = data.iter().map(|(p, _)| (p - middle).norm_squared()).sum();
        Self {
            radius: PATCH_RADIUS * (sum / data.len().max(1) as f64).sqrt(),
            data,
            model,
            middle,
        }
    }

    /// `n` samples of the model far from each other, at least one; the one nearest to their middle
    /// first.
    fn spread(&self, n: usize) -> Vec<Vector3> {
        let sum: Vector3 = self.model.iter().map(|(point, _)| *point).sum();
        let middle = sum / self.model.len() as f64;
        let nearest = |best: usize, i: usize| {
            let distance = |i: usize| (self.model[i].0 - middle).norm_squared();
            if distance(i) < distance(best) {
                i
            } else {
                best
            }
        };
        let first = (0..self.model.len()).fold(0, nearest);
        let points: Vec<Vector3> = self.model.iter().map(|(point, _)| *point).collect();
        far_apart(&points, first, n)
    }
}

/// The first of some points and others, each as far from those before as any: `n` of them, at least one.
pub(super) fn far_apart(points: &[Vector3], first: usize, n: usize) -> Vec<Vector3> {
    let mut next = first;
    let mut clearance = vec![f64::INFINITY; points.len()];
    let mut chosen = Vec::new();
    while chosen.len() < n.clamp(1, points.len()) {
        let point = points[next];
        chosen.push(point);
        next = 0;
        for (i, other) in points.iter().enumerate() {
            clearance[i] = clearance[i].min((other - point).norm_squared());
            if clearance[i] > clearance[next] {
                next = i;
            }
        }
    }
    chosen
}

/// Centre, mean normal and longest direction of a piece of surface.
struct Patch {
    center: Vector3,
    normal: Vector3,
    longest: Vector3,
}

impl Patch {
    /// What lies within `radius` of `center`.
    fn around(samples: &[Sample], center: &Vector3, radius: f64) -> Self {
        let near = || {
            samples
                .iter()
                .filter(|(p, _)| (p - center).norm_squared() <= radius * radius)
        };
        let n = near().count().max(1) as f64;
        let mean = near().map(|(point, _)| point - center).sum::<Vector3>() / n + center;
        let normal = near().map(|(_, normal)| *normal).sum::<Vector3>() / n;
        let covariance: Matrix3 = near()
            .map(|(point, _)| (point - mean) * (point - mean).transpose())
            .sum();
        let eigen = SymmetricEigen::new(covariance);
        let least: Vector3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
        Self {
            center: mean,
            normal: normal.try_normalize(1e-3).unwrap_or(least),
            longest: eigen.eigenvectors.column(eigen.eigenvalues.imax()).into(),
        }
    }

    /// A right-handed frame whose third axis is the normal, or its opposite.
    fn frame(&self, flipped: bool) -> Matrix3 {
        frame_about(
            &if flipped { -self.normal } else { self.normal },
            &self.longest,
        )
    }
}
