//! Poses that lie some pitches of a row of holes apart: where a piece of a part is shifted along such a row, its holes
//! lie on others, and only ends tell where it belongs.

use super::{HELD_BY_OTHERS, HELD_WITHIN, PoseComparison, Refined};
use crate::assess::borders::LEAST_ACROSS;
use crate::assess::free_motion::FreeMotion;

impl PoseComparison<'_, '_> {
    /// Whether the outlines across a free motion hold a pose. One end of a piece lies near an end of the other part by
    /// chance.
    pub(super) fn is_held_across(&self, pose: &Refined, free: &FreeMotion) -> bool {
        let all = self.borders.across(&pose.pose, free);
        let borders = self.borders.at(&pose.pose);
        let gaps: Vec<f64> = borders.pairs().iter().map(|pair| pair.gap).collect();
        let within = HELD_WITHIN * (self.remainder() + borders.unremarkable());
        borders.across_within(&gaps, within, free) >= LEAST_ACROSS * all
    }

    /// Whether the holes of a pose have counterparts as those of the winner have. Outlines tell such poses apart, and
    /// those of a piece that the other part holds at less than both ends lie on others by chance.
    pub(super) fn holds_as_many_holes(&self, pose: &Refined, winner: &Refined) -> bool {
        winner.n_holes > 0
            && pose.n_holes >= winner.n_holes
            && pose.worst_hole <= self.remainder().max(winner.worst_hole)
            && pose.missing <= winner.missing
            && pose.held >= HELD_BY_OTHERS
    }
}
