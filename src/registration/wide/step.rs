//! One robust point-to-plane step on the grid, and what a pose is worth.

use nalgebra::{Cholesky, Rotation3, SMatrix, SVector};

use super::LANES;
use super::cloud::{Block, Cloud, Motion32};
use crate::geometry::{Matrix3, Vector3};
use crate::search::FeatureGrid;

/// Normals of a pair differ by at most this angle (66°), given as its cosine.
const MIN_COS: f32 = 0.4;
/// Weight of the distance between points beside that from the plane.
const POINT_SHARE: f32 = 0.1;
/// Largest turn of one step, radians.
const MAX_TURN: f64 = 0.5;
/// Damping of a step, as a share of the mean stiffness.
const DAMPING: f64 = 1e-4;

type Lane = [f32; LANES];

/// Pairs farther apart than `cut` do not count; lengths in grid units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) cut: f32,
    /// Distance within the tangential plane that is negligible, because a cell stands for all
    /// queries in it.
    pub(super) slack: f32,
}

/// A block of the moved cloud with its partners.
struct Pairs {
    /// Moved points about the centroid.
    arm: [Lane; 3],
    /// From the partner to the point.
    off: [Lane; 3],
    /// Normals of the partners.
    normal: [Lane; 3],
    /// Signed distance from the partner's plane.
    height: Lane,
    /// 1 − d²/c² of what counts, else 0.
    nearness: Lane,
}

#[inline(always)]
fn rotated(rows: &[[f32; 3]; 3], v: &[Lane; 3]) -> [Lane; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|l| rows[i][0] * v[0][l] + rows[i][1] * v[1][l] + rows[i][2] * v[2][l])
    })
}

#[inline(always)]
fn pair_up(block: &Block, grid: &FeatureGrid, motion: &Motion32, sign: f32, reach: Reach) -> Pairs {
    let arm = rotated(&motion.rotation, &block.point);
    let turned = rotated(&motion.rotation, &block.normal);
    let (mut off, mut normal) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
    for l in 0..LANES {
        let moved: [f32; 3] = std::array::from_fn(|k| arm[k][l] + motion.translation[k]);
        let partner = grid.nearest(moved);
        for k in 0..3 {
            off[k][l] = moved[k] - partner.point[k];
            normal[k][l] = partner.normal[k];
        }
    }
    let dot = |a: &[Lane; 3], b: &[Lane; 3], l: usize| {
        a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l]
    };
    let height: Lane = std::array::from_fn(|l| dot(&off, &normal, l));
    let per_cut_sq = 1.0 / (reach.cut * reach.cut);
    let slack_sq = reach.slack * reach.slack;
    let nearness = std::array::from_fn(|l| {
        let height_sq = height[l] * height[l];
        let along_sq = (dot(&off, &off, l) - height_sq - slack_sq).max(0.0);
        let nearness = (1.0 - (height_sq + along_sq) * per_cut_sq).max(0.0);
        let agrees = sign * dot(&turned, &normal, l) >= MIN_COS;
        if agrees { nearness } else { 0.0 }
    });
    Pairs {
        arm,
        off,
        normal,
        height,
        nearness,
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
    let mut kept = [0.0; LANES];
    for block in &cloud.blocks[..n_blocks] {
        let pairs = pair_up(block, grid, motion, sign, reach);
        for (sum, u) in kept.iter_mut().zip(pairs.nearness) {
            *sum += u * u * u;
        }
    }
    1.0 - kept.iter().sum::<f32>() / (n_blocks * LANES) as f32
}

/// Sums over pairs, one per lane: the upper triangle of the point-to-plane equations row by row
/// with their right side, then what distances between points add.
struct Sums {
    plane: [Lane; 27],
    /// Weight, arm (3), products of arms (6), offset (3), arm × offset (3).
    point: [Lane; 16],
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, pairs: &Pairs) {
        let Pairs {
            arm, off, normal, ..
        } = pairs;
        let cross = |a: &[Lane; 3], b: &[Lane; 3], i: usize, l: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j][l] * b[k][l] - a[k][l] * b[j][l]
        };
        let weight: Lane = std::array::from_fn(|l| pairs.nearness[l] * pairs.nearness[l]);
        let row: [Lane; 7] = std::array::from_fn(|i| {
            std::array::from_fn(|l| match i {
                0..3 => cross(arm, normal, i, l),
                3..6 => normal[i - 3][l],
                _ => pairs.height[l],
            })
        });
        let mut place = 0;
        for i in 0..6 {
            let weighted: Lane = std::array::from_fn(|l| weight[l] * row[i][l]);
            for other in &row[i..] {
                for l in 0..LANES {
                    self.plane[place][l] += weighted[l] * other[l];
                }
                place += 1;
            }
        }
        let mut place = 0;
        let mut add = |values: Lane| {
            for l in 0..LANES {
                self.point[place][l] += weight[l] * values[l];
            }
            place += 1;
        };
        add([1.0; LANES]);
        for values in arm {
            add(*values);
        }
        for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            add(std::array::from_fn(|l| arm[i][l] * arm[j][l]));
        }
        for values in off {
            add(*values);
        }
        for i in 0..3 {
            add(std::array::from_fn(|l| cross(arm, off, i, l)));
        }
    }

    /// The equations of the step: matrix and right side.
    fn equations(&self) -> (SMatrix<f64, 6, 6>, SVector<f64, 6>) {
        let total = |lane: &Lane| lane.iter().map(|&x| f64::from(x)).sum::<f64>();
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
        plane: [[0.0; LANES]; 27],
        point: [[0.0; LANES]; 16],
    };
    for block in &cloud.blocks[..n_blocks] {
        sums.add(&pair_up(block, grid, motion, sign, reach));
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
