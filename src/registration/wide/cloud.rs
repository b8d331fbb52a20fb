//! Samples of both parts: evenly spread points, and the data's in blocks that are moved together.

use glam::Vec4;

use super::{BLOCK, LANES};
use crate::geometry::{Matrix3, Point3, Similarity, Vector3, z_order};
use crate::registration::icp::orthonormal;
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// `n` points with the normals of their triangles, each for the same area: the mesh is walked in
/// its order, and a point is set wherever the running area passes the next n-th part of the whole.
/// Where in its triangle it lies follows a sequence that fills the triangle evenly (Roberts 2018).
pub(super) fn area_samples(surface: &Surface, n: usize) -> Vec<(Point3, Vector3)> {
    let mesh = surface.mesh();
    let share = mesh.area() / n as f64;
    let mut samples = Vec::with_capacity(n);
    let mut running = 0.0;
    for triangle in 0..mesh.n_triangles() {
        running += mesh.triangle_area(triangle);
        let due = ((running / share + 0.5) as usize).min(n);
        if due <= samples.len() {
            continue;
        }
        let [a, b, c] = mesh.corners(triangle);
        let normal = mesh.normal(triangle);
        while samples.len() < due {
            let i = samples.len() as f64;
            let (mut u, mut v) = (
                (i * 0.754_877_666_246_693).fract(),
                (i * 0.569_840_290_998_053).fract(),
            );
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            samples.push((a + (b - a) * u + (c - a) * v, normal));
        }
    }
    samples
}

/// Samples of the data about their centroid, in grid units, in blocks of [`BLOCK`]. Every prefix is
/// spread evenly over the surface.
pub(super) struct Cloud {
    pub(super) blocks: Vec<Block>,
    /// Where the centroid of the samples lies, in the data's frame.
    pub(super) center: Point3,
    /// Grid units per unit of length.
    pub(super) scale: f64,
    /// Diagonal of the samples' box, in grid units.
    pub(super) diagonal: f32,
    /// True if the samples were mirrored in their centroid's plane x = 0.
    pub(super) is_mirrored: bool,
}

/// Points and normals of [`BLOCK`] samples.
#[derive(Clone, Copy, Default)]
pub(super) struct Block {
    pub(super) halves: [HalfBlock; 2],
}

/// [`LANES`] samples, coordinate by coordinate.
#[derive(Clone, Copy, Default)]
pub(super) struct HalfBlock {
    pub(super) point: [Vec4; 3],
    pub(super) normal: [Vec4; 3],
}

impl Block {
    fn set(&mut self, sample: usize, point: [f32; 3], normal: [f32; 3]) {
        let (half, lane) = (&mut self.halves[sample / LANES], sample % LANES);
        for k in 0..3 {
            half.point[k][lane] = point[k];
            half.normal[k][lane] = normal[k];
        }
    }

    pub(super) fn point(&self, sample: usize) -> [f32; 3] {
        self.halves[sample / LANES].point.map(|x| x[sample % LANES])
    }

    pub(super) fn normal(&self, sample: usize) -> [f32; 3] {
        self.halves[sample / LANES]
            .normal
            .map(|x| x[sample % LANES])
    }
}

impl Cloud {
    /// About `n` samples of `surface` at the scale of a grid.
    pub(super) fn new(surface: &Surface, n: usize, scale: f64) -> Self {
        let n = n.next_multiple_of(BLOCK);
        let samples = area_samples(surface, n);
        let points: Vec<Point3> = samples.iter().map(|(point, _)| *point).collect();
        let sum: Vector3 = points.iter().map(|point| point.coords).sum();
        let center = Point3::from(sum / points.len().max(1) as f64);
        let order = z_order(&points);
        let mut blocks = vec![Block::default(); samples.len() / BLOCK];
        for (place, rank) in bit_reversed(blocks.len() * BLOCK).into_iter().enumerate() {
            let (point, normal) = &samples[order[rank] as usize];
            let local = (point - center) * scale;
            let [point, normal] = [local, *normal].map(|v| v.cast::<f32>().into());
            blocks[place / BLOCK].set(place % BLOCK, point, normal);
        }
        Self {
            blocks,
            center,
            scale,
            diagonal: (surface.measures().diagonal * scale) as f32,
            is_mirrored: false,
        }
    }

    /// The same samples mirrored: the part of the opposite hand.
    pub(super) fn mirrored(&self) -> Self {
        let mut blocks = self.blocks.clone();
        for half in blocks.iter_mut().flat_map(|block| &mut block.halves) {
            half.point[0] = -half.point[0];
            half.normal[0] = -half.normal[0];
        }
        Self {
            blocks,
            is_mirrored: !self.is_mirrored,
            ..*self
        }
    }

    /// Its points, block by block.
    pub(super) fn points(&self) -> impl Iterator<Item = Vector3> + '_ {
        let blocks = self.blocks.iter();
        let points = blocks.flat_map(|block| (0..BLOCK).map(|sample| block.point(sample)));
        points.map(|point| Vector3::from(point.map(f64::from)))
    }

    /// The cloud of the piece of the surface around a point that has this share of the area.
    pub(super) fn piece(&self, around: &Vector3, share: f64) -> Self {
        let points: Vec<Vector3> = self.points().collect();
        let n = (share * points.len() as f64) as usize;
        let n = n.next_multiple_of(BLOCK).min(points.len());
        let away = |i: usize| (points[i] - around).norm_squared();
        let mut near: Vec<usize> = (0..points.len()).collect();
        near.sort_unstable_by(|&a, &b| away(a).total_cmp(&away(b)).then(a.cmp(&b)));
        near.truncate(n);
        // In the order of the whole, of which every prefix is spread evenly.
        near.sort_unstable();
        let middle = near.iter().map(|&i| points[i]).sum::<Vector3>() / n.max(1) as f64;
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        let mut blocks = vec![Block::default(); n / BLOCK];
        for (place, &i) in near.iter().enumerate() {
            let local = points[i] - middle;
            (low, high) = (low.inf(&local), high.sup(&local));
            let normal = self.blocks[i / BLOCK].normal(i % BLOCK);
            blocks[place / BLOCK].set(place % BLOCK, local.cast::<f32>().into(), normal);
        }
        let data_from_local = self.local_from_data().inverse();
        Self {
            blocks,
            center: data_from_local.apply(&Point3::from(middle / self.scale)),
            diagonal: (high - low).norm() as f32,
            ..*self
        }
    }

    /// From the data's frame to that of the cloud.
    fn local_from_data(&self) -> Similarity {
        let shift = Similarity::from_translation(-self.center.coords);
        if self.is_mirrored {
            Similarity::mirror_x().after(&shift)
        } else {
            shift
        }
    }

    /// The motion of the data that a motion of the cloud stands for.
    pub(super) fn model_from_data(&self, motion: &Motion32, grid: &FeatureGrid) -> Similarity {
        let model_from_local = Similarity {
            rotation: Matrix3::from_fn(|i, j| f64::from(motion.rotation[i][j])),
            translation: grid.origin().coords
                + Vector3::from(motion.translation.map(f64::from)) / self.scale,
            scale: 1.0,
        };
        orthonormal(&model_from_local).after(&self.local_from_data())
    }
}

/// A rotation about the centroid of a cloud and where the centroid goes, in grid units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion32 {
    /// Rows of the rotation.
    pub(super) rotation: [[f32; 3]; 3],
    pub(super) translation: [f32; 3],
}

impl Motion32 {
    pub(super) fn apply(&self, point: &Vector3) -> Vector3 {
        let along = |row: [f32; 3]| Vector3::from(row.map(f64::from)).dot(point);
        Vector3::from(self.rotation.map(along)) + Vector3::from(self.translation.map(f64::from))
    }

    pub(super) fn shifted(&self, by: &Vector3) -> Self {
        Self {
            translation: std::array::from_fn(|k| self.translation[k] + by[k] as f32),
            ..*self
        }
    }

    /// True if both differ by less than an angle (given as its cosine) and a way of the centroid.
    pub(super) fn is_near(&self, other: &Self, min_cos: f32, max_shift: f32) -> bool {
        let shift_sq: f32 = (0..3)
            .map(|k| (self.translation[k] - other.translation[k]).powi(2))
            .sum();
        if shift_sq > max_shift * max_shift {
            return false;
        }
        let trace: f32 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| self.rotation[i][j] * other.rotation[i][j])
            .sum();
        0.5 * (trace - 1.0) > min_cos
    }
}

/// The numbers 0 … n − 1 in an order whose every prefix is spread evenly (van der Corput).
fn bit_reversed(n: usize) -> Vec<usize> {
    let bits = n.next_power_of_two().trailing_zeros();
    (0..n.next_power_of_two())
        .map(|i| {
            if bits == 0 {
                0
            } else {
                i.reverse_bits() >> (usize::BITS - bits)
            }
        })
        .filter(|&i| i < n)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reversed_bits_are_a_permutation_with_even_prefixes() {
        let order = bit_reversed(1200);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..1200));
        for third in 0..3 {
            let within = |i: &&usize| **i / 400 == third;
            let n = order[..64].iter().filter(within).count();
            assert!((20..=23).contains(&n), "{n} of 64 in one third");
        }
        assert_eq!(bit_reversed(1), [0]);
        assert!(bit_reversed(0).len() <= 1);
    }
}
