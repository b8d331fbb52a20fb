//! Poses of parts of which each has a piece that the other lacks. All of the smaller part together lies closest where
//! most of it meets the other, which may be elsewhere; a piece of it that the other part has as well lies on that.

use super::WideSearch;
use super::rounds::{self, Round};
use super::seeds::{self, SeedCounts};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};

/// Pieces that are aligned to the other part, from all over the smaller one.
const N_PIECES: usize = 4;
/// Share of the smaller part's area in each. Parts that share half of it have such a piece in common.
const PIECE_SHARE: f64 = 0.35;
/// Each piece is aligned to patches of its size; the covering of all rotations found no pose besides in 72 pairs.
const ON_PATCHES: SeedCounts = SeedCounts {
    rotations: 0,
    places: 0,
    patches: 60,
    turns: 18,
};
/// A piece with a larger loss lies on nothing like it.
const LIES_ON_LOSS: f32 = 0.4;
/// Poses of each piece at most.
const MOST_OF_PIECE: usize = 4;

const PIECE_ROUNDS: [Round; 6] = [
    Round {
        cut: 1.0,
        n_points: 40,
        n_steps: 4,
        keep: 0.25,
        least: 100,
        most: 1200,
    },
    Round {
        cut: 0.53,
        n_points: 80,
        n_steps: 6,
        keep: 0.2,
        least: 40,
        most: 240,
    },
    Round {
        cut: 0.27,
        n_points: 160,
        n_steps: 8,
        keep: 0.25,
        least: 16,
        most: 60,
    },
    Round {
        cut: 0.13,
        n_points: 400,
        n_steps: 12,
        keep: 0.5,
        least: 12,
        most: 24,
    },
    Round {
        cut: 0.067,
        n_points: 400,
        n_steps: 8,
        keep: 0.7,
        least: 12,
        most: 16,
    },
    // A piece of a smooth panel lies about as close in many places, but nowhere else as exactly.
    Round {
        cut: 0.02,
        n_points: 400,
        n_steps: 8,
        keep: 1.0,
        least: 8,
        most: 8,
    },
];

impl WideSearch<'_> {
    /// Poses `model_from_data` in which a piece of the data lies on the model, whatever the rest of it does: the best
    /// four of each of four pieces, as exact as the grid. The same for any number of threads. O(patches · turns),
    /// bounded.
    pub fn on_pieces(&self, monitor: &Monitor) -> Result<Vec<Similarity>, Cancelled> {
        let points: Vec<_> = self.cloud.points().collect();
        let away = |i: usize| points[i].norm_squared();
        let outermost = (0..points.len()).max_by(|&a, &b| away(a).total_cmp(&away(b)));
        let Some(outermost) = outermost else {
            return Ok(Vec::new());
        };
        let mut found = Vec::new();
        for middle in seeds::far_apart(&points, outermost, N_PIECES) {
            let piece = self.cloud.piece(&middle, PIECE_SHARE);
            let seeds = seeds::seeds(&piece, (self.data, self.model), &self.grid, ON_PATCHES);
            let first = seeds.iter().map(|seed| seed.first);
            let of_piece = rounds::run(self.ground(&piece), first, &PIECE_ROUNDS, monitor)?;
            let lie_on = of_piece
                .into_iter()
                .filter(|lies| lies.loss <= LIES_ON_LOSS);
            let poses = lie_on.map(|lies| piece.model_from_data(&lies.motion, &self.grid));
            found.extend(poses.take(MOST_OF_PIECE));
        }
        Ok(found)
    }
}
