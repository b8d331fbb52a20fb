//! What two parts are compared by: how far they may differ, and up to which distance they have to do with each
//! other.

use serde::{Deserialize, Serialize};

use super::coverage::overlap_limit;
use crate::registration::Surface;

/// The largest offset of two sheets in thicknesses: from one skin to the other it is one, the parts' thicknesses may
/// differ, and facets add to it.
const MOST_OFFSET: f64 = 1.2;
/// Smooth displacement that is accepted as springback: a share of the diagonal, at most so many
/// millimetres.
const SPRINGBACK_SHARE: f64 = 0.005;
const SPRINGBACK_MOST: f64 = 5.0;
/// Springback does not shrink with the part: of small ones so many millimetres are accepted, at most a share
/// of the diagonal.
const SPRINGBACK_OF_SMALL: f64 = 2.5;
const SHARE_OF_SMALL: f64 = 0.02;
/// Remainder that is accepted at least, in millimetres.
const REMAINDER_LEAST: f64 = 1.0;
/// This share of what may remain is unremarkable whatever the facets are.
pub(crate) const UNREMARKABLE: f64 = 0.1;

/// Distance within which the parts are compared, as a share of the target's diagonal and in tolerances of
/// springback, and borders, in tolerances.
const REACH: f64 = 0.03;
const SPRINGBACK_REACH: f64 = 3.0;
const BORDER_REACH: f64 = 8.0;
/// Borders are looked for under first poses within this share of the diagonal: they are that good.
const FIRST_BORDER_REACH: f64 = 0.03;
/// Borders are looked for within this share of the diagonal while a pose is refined: a door slides so far.
const REFINED_BORDER_REACH: f64 = 0.015;

/// Surfaces lie as close if they lie at most so many times as far apart.
pub(crate) const AS_CLOSE: f64 = 1.5;
/// Surfaces that lie farther apart than before by so many times what they lay apart and what facets leave open
/// lie elsewhere.
const OFF: f64 = 3.0;
/// The facets of a flat part are known no better than this share of what may remain.
const NOTHING: f64 = 0.01;

/// Sources up to so many times the area of the target count as the smaller part.
const AS_LARGE: f64 = 1.02;

/// What an assessment depends on besides the match.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessSettings {
    /// Distance up to which a place counts as covered, in target length units. By default
    /// [`super::overlap_limit`] of the meshes.
    pub limit: Option<f64>,
    /// Deviation of the real shapes that is to be expected besides faceting, such as springback.
    pub allowance: f64,
    /// Thickness of the sheet in target length units, if known.
    pub thickness: Option<f64>,
    /// How far shapes may differ besides springback; by default the larger of a millimetre and the
    /// thickness.
    pub shape_tolerance: Option<f64>,
    /// The pose is that of the mid-surfaces: a separable offset was taken out of it.
    pub remove_offset: bool,
    /// A millimetre in target length units; 1 if not known.
    pub millimetre: Option<f64>,
    /// Both parts are in one unit, as their files or the user say.
    pub is_one_unit: bool,
    /// The match was to find the scale too.
    pub is_scale_free: bool,
    /// How many parts the target consists of; 0 if not known.
    pub n_target_parts: usize,
    /// Errors of the reader about nodes, elements and transformations in the file of the source.
    pub n_source_errors: u64,
    /// The same in the file of the target.
    pub n_target_errors: u64,
}

impl AssessSettings {
    pub(super) fn length_of_millimetre(&self) -> f64 {
        self.millimetre.unwrap_or(1.0)
    }
}

/// How large differences may be before the shape is another. Target length units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShapeTolerance {
    /// What may remain besides springback and offset, at 95 % of the area; borders and holes likewise.
    pub remainder: f64,
    /// How far a smooth bend and twist may reach.
    pub springback: f64,
}

impl ShapeTolerance {
    /// The tolerance for a target of this diagonal. `set` is what the user asked for; `millimetre` is
    /// the length of one in target units.
    pub fn new(set: Option<f64>, thickness: Option<f64>, diagonal: f64, millimetre: f64) -> Self {
        let usual = (REMAINDER_LEAST * millimetre).max(thickness.unwrap_or(0.0));
        let remainder = set.unwrap_or(usual);
        let smooth = (SPRINGBACK_SHARE * diagonal).min(SPRINGBACK_MOST * millimetre);
        Self {
            remainder,
            springback: smooth.max(remainder),
        }
    }

    /// Distances up to this are negligible.
    #[must_use]
    pub fn unremarkable(&self) -> f64 {
        UNREMARKABLE * self.remainder
    }

    /// The tolerance that bends are judged with, which leaves room for the springback of small parts. The
    /// search and the pose keep to the narrower one.
    #[must_use]
    pub(super) fn for_bends(self, diagonal: f64, millimetre: f64) -> Self {
        let of_small = (SPRINGBACK_OF_SMALL * millimetre).min(SHARE_OF_SMALL * diagonal);
        Self {
            springback: self.springback.max(of_small),
            ..self
        }
    }

    /// Uncertainty up to which a pose is certain. The pose of a part that is bent by `bend` is known no better
    /// than that, which is stated with the shape and judged there.
    pub(super) fn of_pose(&self, bend: f64, millimetre: f64) -> f64 {
        let most = self.springback.max(SPRINGBACK_MOST * millimetre);
        (self.springback + bend).min(most)
    }

    /// The tolerance with both limits at least `allowance`.
    #[must_use]
    pub fn at_least(self, allowance: f64) -> Self {
        Self {
            remainder: self.remainder.max(allowance),
            springback: self.springback.max(allowance),
        }
    }
}

/// What a pair is compared by under poses of one scale, in target length units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Distances {
    pub(crate) tolerance: ShapeTolerance,
    /// Surfaces within it are compared,
    pub(crate) reach: f64,
    /// and borders within this.
    pub(crate) border_reach: f64,
    /// Borders are looked for within it under first poses,
    pub(crate) first_border_reach: f64,
    /// and within it while a pose is refined.
    pub(crate) refined_border_reach: f64,
    /// Surfaces within it leave a motion free: what overlaps, and what springback explains.
    pub(crate) free_limit: f64,
    /// Faceting of both meshes and the allowance: distances of this size are negligible.
    pub(crate) noise: f64,
    /// The largest offset between two skins of one sheet; what is larger is a difference of the shapes.
    pub(super) most_offset: f64,
}

impl Distances {
    pub(crate) fn of(
        source: &Surface,
        target: &Surface,
        scale: f64,
        settings: &AssessSettings,
    ) -> Self {
        let tolerance = tolerance_of(target, settings);
        let diagonal = target.measures().diagonal;
        let reach = (REACH * diagonal).max(SPRINGBACK_REACH * tolerance.springback);
        let facets = faceting([source, target], scale);
        Self {
            tolerance,
            reach,
            border_reach: (BORDER_REACH * tolerance.remainder).min(reach),
            first_border_reach: FIRST_BORDER_REACH * diagonal,
            refined_border_reach: REFINED_BORDER_REACH * diagonal,
            free_limit: overlap_limit(source, target, scale, settings.allowance)
                .max(tolerance.springback),
            noise: facets.max(NOTHING * tolerance.remainder) + settings.allowance,
            most_offset: settings
                .thickness
                .map_or(f64::INFINITY, |t| MOST_OFFSET * t),
        }
    }

    /// How much farther apart than `gap` surfaces may lie and still lie as close: a share of what may remain,
    /// but little where they lie as close as their facets allow, since what lies off is elsewhere then.
    pub(crate) fn little_more(&self, share: f64, gap: f64) -> f64 {
        let remainder = self.tolerance.remainder;
        (share * remainder).min(OFF * (gap + self.noise))
    }

    /// How far apart surfaces may lie and still lie as close as others that lie `gap` apart: [`AS_CLOSE`] times as far
    /// and [`Distances::little_more`].
    pub(crate) fn as_close_as(&self, share: f64, gap: f64) -> f64 {
        AS_CLOSE * gap + self.little_more(share, gap)
    }
}

/// How far the facets of both meshes lie off the sheets, under poses of this scale.
pub(super) fn faceting(pair: [&Surface; 2], scale: f64) -> f64 {
    let [source, target] = pair.map(|surface| surface.measures().chordal_error);
    (scale * source).max(target)
}

/// Mean edge length of the coarser mesh, under poses of this scale.
pub(super) fn coarser_edge(pair: [&Surface; 2], scale: f64) -> f64 {
    let [source, target] = pair.map(|surface| surface.measures().mean_edge_length);
    (scale * source).max(target)
}

/// Whether the source is the smaller part, by area, under a pose of this scale: the smaller part's nodes and
/// borders are the ones that are followed.
pub(crate) fn is_source_smaller(source: &Surface, target: &Surface, scale: f64) -> bool {
    source.measures().area * scale * scale <= AS_LARGE * target.measures().area
}

fn tolerance_of(target: &Surface, settings: &AssessSettings) -> ShapeTolerance {
    let usual = ShapeTolerance::new(
        settings.shape_tolerance,
        settings.thickness,
        target.measures().diagonal,
        settings.length_of_millimetre(),
    );
    usual.at_least(settings.allowance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_leave_room_for_springback() {
        let tolerance = ShapeTolerance::new(None, Some(1.5), 430.0, 1.0);
        // The pose of a straight part has the narrower limit, that of a bent one its bend besides.
        assert_eq!(tolerance.of_pose(0.0, 1.0), tolerance.springback);
        assert_eq!(tolerance.of_pose(0.5, 1.0), tolerance.springback + 0.5);
        assert_eq!(tolerance.of_pose(9.0, 1.0), SPRINGBACK_MOST);
        // Of a part of a hand's width two and a half millimetres are too much.
        let small = ShapeTolerance::new(None, None, 80.0, 1.0).for_bends(80.0, 1.0);
        assert!((small.springback - 1.6).abs() < 1e-12);
    }
}
