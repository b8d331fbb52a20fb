//! One robust point-to-plane step on the grid, and what a pose is worth.
//!
//! Nearly all of the wide search is spent here. `map` of arrays is left out where it was measured to become a call.

use glam::Vec4;
use nalgebra::{Cholesky, Rotation3, SMatrix, SVector};

use super::BLOCK;
use super::cloud::{Cloud, HalfBlock, Motion32};
use crate::geometry::{Matrix3, Vector3};
use crate::search::FeatureGrid;
use crate::search::lanes::{by_coordinate, cross, difference, dot, rotated};

/// Normals of a pair differ by at most this angle (66°), given as its cosine.
const MIN_COS: f32 = 0.4;
/// Weight of the distance between points beside that from the plane.
const POINT_SHARE: f32 = 0.1;
/// Largest turn of one step, radians.
const MAX_TURN: f64 = 0.5;
/// Damping of a step, as a share of the mean stiffness.
const DAMPING: f64 = 1e-4;

/// Pairs farther apart than `cut` do not count; lengths in grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) cut: f32,
    /// Distance within the tangential plane that is negligible, because a cell stands for all
    /// queries in it.
    pub(super) slack: f32,
}

/// Four samples of the moved cloud with their partners.
struct Pairs {
    /// Moved points about the centroid.
    arm: [Vec4; 3],
    /// From the partner to the point.
    off: [Vec4; 3],
    /// Normals of the partners.
    normal: [Vec4; 3],
    /// Signed distance from the partner's plane.
    height: Vec4,
    /// 1 − d²/c² of what counts, else 0.
    nearness: Vec4,
}

impl Pairs {
    #[inline(always)]
    fn weight(&self) -> Vec4 {
        self.nearness * self.nearness
    }

    /// How much each unknown moves the point away from the plane, and how far it is.
    #[inline(always)]
    fn row(&self) -> [Vec4; 7] {
        let [a, b, c] = cross(&self.arm, &self.normal);
        let [x, y, z] = self.normal;
        [a, b, c, x, y, z, self.height]
    }

    /// What [`Sums::point`] sums up beside the weight.
    #[inline(always)]
    fn of_points(&self) -> [Vec4; 15] {
        let [x, y, z] = self.arm;
        let [u, v, w] = self.off;
        let [p, q, r] = cross(&self.arm, &self.off);
        let (xx, xy, xz, yy, yz, zz) = (x * x, x * y, x * z, y * y, y * z, z * z);
        [x, y, z, xx, xy, xz, yy, yz, zz, u, v, w, p, q, r]
    }
}

#[inline(always)]
fn pair_up(
    half: &HalfBlock,
    grid: &FeatureGrid,
    motion: &Motion32,
    sign: f32,
    reach: Reach,
) -> Pairs {
    let arm = rotated(&motion.rotation, &half.point);
    let turned = rotated(&motion.rotation, &half.normal);
    let [x, y, z] = motion.translation;
    let moved = [arm[0] + x, arm[1] + y, arm[2] + z];
    let [a, b, c, d] = grid.nearest_four(moved);
    let point = by_coordinate([a.point, b.point, c.point, d.point]);
    let normal = by_coordinate([a.normal, b.normal, c.normal, d.normal]);
    let off = difference(&moved, &point);
    let height = dot(&off, &normal);
    let height_sq = height * height;
    let along_sq = (dot(&off, &off) - height_sq - reach.slack * reach.slack).max(Vec4::ZERO);
    let per_cut_sq = 1.0 / (reach.cut * reach.cut);
    let nearness = (1.0 - (height_sq + along_sq) * per_cut_sq).max(Vec4::ZERO);
    let agrees = (dot(&turned, &normal) * sign).cmpge(Vec4::splat(MIN_COS));
    Pairs {
        arm,
        off,
        normal,
        height,
        nearness: Vec4::select(agrees, nearness, Vec4::ZERO),
    }
}

/// Mean of Tukey's loss over the first `n_blocks` blocks, 0 (all pairs touch) to 1 (none counts).
pub(super) fn loss(
    cloud: &Cloud,
    n_blocks: usize,
    grid: &FeatureGrid,
    (motion, sign): (&Motion32, f32),
    reach: Reach,
) -> f32 {
    let mut kept = Vec4::ZERO;
    for block in &cloud.blocks[..n_blocks] {
        for half in &block.halves {
            let nearness = pair_up(half, grid, motion, sign, reach).nearness;
            kept += nearness * nearness * nearness;
        }
    }
    1.0 - kept.element_sum() / (n_blocks * BLOCK) as f32
}

/// Sums over pairs, one per lane: the upper triangle of the point-to-plane equations row by row
/// with their right side, then what distances between points add.
struct Sums {
    plane: [Vec4; 27],
    /// Weight, arm (3), products of arms (6), offset (3), arm × offset (3).
    point: [Vec4; 16],
}

impl Sums {
    /// Adds the halves of a block: there are too many sums for the registers, so that each is loaded and stored for
    /// both at once.
    #[inline(always)]
    fn add(&mut self, first: &Pairs, second: &Pairs) {
        let (a, b) = (first.weight(), second.weight());
        let (of_a, of_b) = (first.row(), second.row());
        let mut place = 0;
        for i in 0..6 {
            let (a, b) = (a * of_a[i], b * of_b[i]);
            for j in i..7 {
                self.plane[place] += a * of_a[j] + b * of_b[j];
                place += 1;
            }
        }
        self.point[0] += a + b;
        let of_both = first.of_points().into_iter().zip(second.of_points());
        for (sum, (of_a, of_b)) in self.point[1..].iter_mut().zip(of_both) {
            *sum += a * of_a + b * of_b;
        }
    }

    /// The equations of the step: matrix and right side.
    fn equations(&self) -> (SMatrix<f64, 6, 6>, SVector<f64, 6>) {
        let total = |lanes: &Vec4| lanes.to_array().map(f64::from).iter().sum::<f64>();
        let (mut matrix, mut right) = (SMatrix::zeros(), SVector::zeros());
        let mut place = 0;
        for i in 0..6 {
            for j in i..7 {
                let sum = total(&self.plane[place]);
                place += 1;
                if j == 6 {
                    right[i] = -sum;
                } else {
                    matrix[(i, j)] = sum;
                    matrix[(j, i)] = sum;
                }
            }
        }
        let point: [f64; 16] =
            std::array::from_fn(|k| f64::from(POINT_SHARE) * total(&self.point[k]));
        let [weight, x, y, z, xx, xy, xz, yy, yz, zz, ..] = point;
        let turn = [
            [yy + zz, -xy, -xz],
            [-xy, xx + zz, -yz],
            [-xz, -yz, xx + yy],
        ];
        let mixed = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for i in 0..3 {
            for j in 0..3 {
                matrix[(i, j)] += turn[i][j];
                matrix[(i, j + 3)] += mixed[i][j];
                matrix[(j + 3, i)] += mixed[i][j];
            }
            matrix[(i + 3, i + 3)] += weight;
            right[i] -= point[13 + i];
            right[i + 3] -= point[10 + i];
        }
        (matrix, right)
    }
}

/// One robust step of the first `n_blocks` blocks towards their partners, with Tukey's weights.
/// `None` if hardly anything counts or the pairs fix no motion.
pub(super) fn step(
    cloud: &Cloud,
    n_blocks: usize,
    grid: &FeatureGrid,
    (motion, sign): (&Motion32, f32),
    reach: Reach,
) -> Option<Motion32> {
    let mut sums = Sums {
        plane: [Vec4::ZERO; 27],
        point: [Vec4::ZERO; 16],
    };
    for block in &cloud.blocks[..n_blocks] {
        let [first, second] = &block.halves;
        sums.add(
            &pair_up(first, grid, motion, sign, reach),
            &pair_up(second, grid, motion, sign, reach),
        );
    }
    let (mut matrix, right) = sums.equations();
    let damping = DAMPING * matrix.trace() / 6.0;
    if damping.is_nan() || damping <= 0.0 {
        return None;
    }
    for i in 0..6 {
        matrix[(i, i)] += damping;
    }
    let solved = Cholesky::new(matrix)?.solve(&right);
    Some(moved(motion, &solved))
}

/// The motion after a turn about the centroid and a shift.
fn moved(motion: &Motion32, step: &SVector<f64, 6>) -> Motion32 {
    let turn = Vector3::new(step[0], step[1], step[2]);
    let angle = turn.norm();
    // A bold step is shortened as a whole.
    let share = (MAX_TURN / angle.max(MAX_TURN)).min(1.0);
    let increment = Rotation3::new(turn * share);
    let before = Matrix3::from_fn(|i, j| f64::from(motion.rotation[i][j]));
    let after = increment.matrix() * before;
    Motion32 {
        rotation: std::array::from_fn(|i| std::array::from_fn(|j| after[(i, j)] as f32)),
        translation: std::array::from_fn(|k| motion.translation[k] + (step[k + 3] * share) as f32),
    }
}
