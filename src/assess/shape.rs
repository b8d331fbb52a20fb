//! Are both parts the same shape? What a smooth bend and twist explain is springback; what remains, and
//! borders that do not lie where they belong, are differences of the part.

mod local;

use serde::{Deserialize, Serialize};

use super::border_curve::BorderCurve;
use super::borders::{Borders, HolePair, LEAST_PAIRED, PairKind};
use super::contact::{Contacts, STATED_SHARE};
use super::evidence::PoseEvidence;
use super::fit::{Fit, HoleLeft};
use super::outline_pieces::OutlinePieces;
use super::outline_shift::outline_aside_of_holes;
use super::stretch::{PartAxis, Stretch, stretch};
use super::tolerance::{ShapeTolerance, UNREMARKABLE};
use super::trims::{self, BorderApart};
use crate::geometry::serial::{any_float, xyz};
use crate::geometry::{Point3, Vector3};
use local::{LocalDifferences, local_differences};

/// Parts that meet over less than this share of the smaller one are different parts.
const LEAST_MET: f64 = 0.5;
/// Parts that meet over less than this share, and differ where they meet, are different parts too: a
/// trimmed part keeps its shape.
const MOSTLY_MET: f64 = 0.75;
/// Of parts of which the smaller meets the other by less than this share, each has a piece that the other lacks,
pub(crate) const OVERHANGS: f64 = 0.95;
/// unless more than this share lies neither on the other part nor beyond its borders.
const ELSEWHERE: f64 = 0.03;
/// A remainder of so many tolerances is that of a different part where most of the area exceeds the tolerance.
const DIFFERENT: f64 = 6.0;
/// Distances up to so many times the faceting, or [`UNREMARKABLE`] of the tolerance, are negligible at most of the
/// area.
pub(crate) const FACETING: f64 = 3.0;
const SAME_SHARE: f64 = 0.8;
/// The mean of how far holes lie off is known to so many of its standard errors.
const SURELY: f64 = 3.0;
/// Fewer holes determine neither their mean nor how much they scatter.
const LEAST_HOLES: usize = 4;
/// Borders lie together up to this share of how far they may lie apart.
pub(super) const TOGETHER: f64 = 0.5;
/// Patches that are searched for the place of the largest difference: 2 to this power.
const PLACE_LEVELS: u32 = 5;

/// The statement about the shape in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeKind {
    /// The parts differ by no more than their facets.
    Same,
    /// The same part, bent or offset within the tolerance.
    Deformed,
    /// A part of the same kind whose surface, borders or holes differ by more than the tolerance.
    OtherVersion,
    /// Two parts that do not belong together.
    Different,
}

/// How borders and holes lie. Lengths in target units.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BorderFit {
    /// Distance across the border that 90 % of the borders beside each other do not exceed, without what
    /// springback and an error of the pose explain; `None` where too few borders lie beside each other.
    pub offset: Option<f64>,
    /// Share of the smaller part's borders that lies on a border of the other: within half of what is accepted.
    #[serde(default)]
    pub together: f64,
    /// Where one part was trimmed farther out than the other: how far outlines lie apart, at 90 % of those that
    /// do. They are no evidence, neither of the pose nor of the shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_trim: Option<f64>,
    /// Where most borders lie together, the stretch that lies farthest apart, if that is by more than is
    /// accepted: a single end that was cut elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart: Option<BorderApart>,
    /// Pieces of sheet at the outlines that only one part has, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pieces: Option<OutlinePieces>,
    /// Holes that both parts have.
    pub n_holes: usize,
    /// Largest distance of a hole from its counterpart, likewise, with the difference of the radii.
    #[serde(with = "any_float")]
    pub worst_hole: f64,
    /// Holes of the source where the target is solid.
    pub only_source: usize,
    /// Holes of the target where the source is solid.
    pub only_target: usize,
}

impl BorderFit {
    /// Holes of one part where the other is solid.
    pub(crate) fn n_alone(&self) -> usize {
        self.only_source + self.only_target
    }
}

/// An end or a flange that is bent, in the target's frame and unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BentEnd {
    /// How far it lies off where it lies off most.
    pub by: f64,
    /// The place.
    #[serde(with = "xyz")]
    pub at: Point3,
}

/// What speaks against one shape. Lengths in target units, places in the target's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "what")]
pub enum ShapeReason {
    /// The parts meet over this share of the smaller one only.
    HardlyMet {
        /// Fraction of the smaller part's area.
        share: f64,
    },
    /// Bend and twist reach farther than springback may.
    Bent {
        /// At 95 % of the area.
        by: f64,
        /// What is accepted.
        limit: f64,
    },
    /// The surfaces differ by more than the tolerance.
    Surface {
        /// At 95 % of the area.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the largest difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
        /// They differ by more than is accepted at most of the area, and not at a flange or an end only.
        #[serde(default)]
        mostly: bool,
    },
    /// The surfaces differ by more than the tolerance at one place: a bead, an emboss or a dent that only one
    /// part has.
    Local {
        /// At most.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the largest difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
        /// The place is an end or a flange, which is bent.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_end: bool,
    },
    /// The borders do not lie on each other.
    #[serde(rename = "rims")]
    Borders {
        /// At 90 % of the borders beside each other.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the largest difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
    },
    /// A hole lies elsewhere or has another size, or all lie elsewhere.
    Hole {
        /// By how much.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
        /// No single hole does so beyond doubt, but all holes lie off one way, by so much in the mean.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_mean: bool,
    },
    /// One part is a longer, wider or higher version of the other.
    Stretched {
        /// How much longer one of them is.
        by: f64,
        /// The same as a share; negative where the source is shorter.
        share: f64,
        /// Principal axis of the source along which it is.
        axis: PartAxis,
    },
    /// Each part has holes where the other is solid.
    Holes {
        /// In the source only.
        only_source: usize,
        /// In the target only.
        only_target: usize,
        /// Where one of them lies.
        #[serde(with = "xyz")]
        at: Point3,
    },
    /// Each part has pieces of sheet at its outline that the other lacks: a lug or a notch lies elsewhere.
    Outlines {
        /// The pieces.
        pieces: OutlinePieces,
    },
}

/// Whether a part of which this share meets the other one lies beyond its borders otherwise, with this share: hardly
/// any of it lies where the other part is and does not meet it.
pub(crate) fn only_overhangs(met: f64, overhang: f64) -> bool {
    1.0 - met - overhang < ELSEWHERE
}

impl ShapeReason {
    /// Whether it is a bend, which springback may be.
    pub(crate) fn is_bend(&self) -> bool {
        matches!(self, Self::Bent { .. })
    }

    /// Whether parts that differ so are two different parts.
    pub(super) fn is_of_another_part(&self) -> bool {
        match self {
            Self::HardlyMet { .. } => true,
            Self::Surface {
                by, limit, mostly, ..
            } => *mostly && *by > DIFFERENT * limit,
            _ => false,
        }
    }
}

/// What can be said about the shapes, independent of how fine the meshes are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeStatement {
    /// In one word.
    pub kind: ShapeKind,
    /// What was accepted.
    pub tolerance: ShapeTolerance,
    /// Share of the smaller part's area that meets the other part.
    #[serde(with = "any_float")]
    pub met: f64,
    /// Share of the smaller part's area that lies beyond the borders of the other part; `None` where most of it
    /// meets that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overhang: Option<f64>,
    /// How far bend and twist displace the sheet along its normal, at 95 % of the area.
    #[serde(with = "any_float")]
    pub springback: f64,
    /// What neither they nor an offset explain, at 95 % of the area.
    #[serde(with = "any_float")]
    pub remainder: f64,
    /// A constant distance between the sheets, as between skin and mid-surface, positive where the
    /// source lies in front of the target; `None` where it is nothing beside the facets, or not
    /// separable.
    pub offset: Option<f64>,
    /// False where normals vary too little to distinguish an offset from a shift of the part.
    pub is_offset_separable: bool,
    /// True if the pose was to be that of the mid-surfaces, without the offset.
    #[serde(default)]
    pub is_offset_removed: bool,
    /// The end or flange that is bent most, by more than the remainder may be and no more than springback; `None` where
    /// none is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bent_end: Option<BentEnd>,
    /// Borders and holes.
    #[serde(rename = "rims")]
    pub borders: BorderFit,
    /// What speaks against one shape, the most severe first; empty within the tolerance.
    pub reasons: Vec<ShapeReason>,
}

impl ShapeStatement {
    /// Compares the shapes at a pose; `fit` is that of the evidence.
    pub(super) fn of(evidence: &PoseEvidence<'_>, fit: &Fit, tolerance: ShapeTolerance) -> Self {
        let contacts = &evidence.contacts;
        let mut statement = Self {
            kind: ShapeKind::Same,
            tolerance,
            met: contacts.share,
            overhang: (contacts.share < MOSTLY_MET).then(|| evidence.overhang()),
            springback: contacts.at_share(&fit.smooth, STATED_SHARE),
            remainder: contacts.at_share(&fit.left, STATED_SHARE),
            offset: Some(fit.offset).filter(|o| o.abs() > FACETING * evidence.noise),
            is_offset_separable: fit.is_separable,
            is_offset_removed: false,
            bent_end: None,
            borders: border_fit(&evidence.borders, fit, &tolerance),
            reasons: Vec::new(),
        };
        let mostly = contacts.at_share(&fit.left, SAME_SHARE);
        statement.find_reasons(evidence, fit, mostly);
        statement.kind = statement.judge(evidence.noise, mostly);
        statement
    }

    /// The same where what was found is no evidence of another part.
    pub(super) fn of_one_part(mut self, noise: f64) -> Self {
        self.reasons.clear();
        self.kind = self.judge(noise, self.remainder);
        self
    }

    /// Looks for pieces of sheet at the outlines that only one part has. Where just one part has them, it was trimmed
    /// later; where both have, they are two versions. `borders` are those of source and target.
    /// O(places along the outlines · log triangles).
    pub(super) fn compare_outlines(
        &mut self,
        evidence: &PoseEvidence<'_>,
        borders: [&[BorderCurve]; 2],
    ) {
        if self.met < MOSTLY_MET {
            return;
        }
        // A bend of a curved part moves borders within the sheet too.
        let limit = evidence
            .borders
            .limit(&self.tolerance)
            .hypot(self.springback);
        self.borders.pieces = OutlinePieces::of(evidence, borders, limit);
        if let Some(pieces) = self.borders.pieces.filter(OutlinePieces::are_of_both) {
            self.reasons.push(ShapeReason::Outlines { pieces });
            self.kind = self.kind.max(ShapeKind::OtherVersion);
        }
    }

    /// The statement about parts that do not meet at all.
    pub(crate) fn nothing_met(tolerance: ShapeTolerance) -> Self {
        Self {
            kind: ShapeKind::Different,
            tolerance,
            met: 0.0,
            overhang: None,
            springback: 0.0,
            remainder: f64::INFINITY,
            offset: None,
            is_offset_separable: false,
            is_offset_removed: false,
            bent_end: None,
            borders: BorderFit::default(),
            reasons: vec![ShapeReason::HardlyMet { share: 0.0 }],
        }
    }

    /// Looks for what speaks against one shape; `mostly` is the remainder at most of the area.
    fn find_reasons(&mut self, evidence: &PoseEvidence<'_>, fit: &Fit, mostly: f64) {
        let mut reasons = Vec::new();
        let limit = self.tolerance.remainder;
        // What differs at most of the area is no end.
        let local = if self.remainder > limit && mostly > limit {
            LocalDifferences::default()
        } else {
            local_differences(evidence, fit, &self.tolerance)
        };
        self.leave_out_ends(&evidence.contacts, fit, &local);
        let differs = self.remainder > limit;
        if self.met < LEAST_MET || differs && self.met < MOSTLY_MET {
            reasons.push(ShapeReason::HardlyMet { share: self.met });
        }
        if differs {
            let at = worst_place(&evidence.contacts, &fit.left);
            reasons.push(ShapeReason::Surface {
                by: self.remainder,
                limit,
                at,
                mostly: mostly > limit,
            });
        } else {
            reasons.extend(local.reason);
            self.bent_end = local.bent_end;
        }
        reasons.extend(self.border_reasons(evidence, fit));
        // Where the parts differ anyway, nothing more is learned from it.
        if reasons.is_empty()
            && let Some(found) = stretch(evidence, &self.tolerance)
        {
            let Stretch { axis, share, by } = found;
            reasons.push(ShapeReason::Stretched { by, share, axis });
        }
        if self.springback > self.tolerance.springback {
            reasons.push(ShapeReason::Bent {
                by: self.springback,
                limit: self.tolerance.springback,
            });
        }
        self.reasons = reasons;
    }

    /// Ends that springback bends are no remainder, where nothing else is too large.
    fn leave_out_ends(&mut self, contacts: &Contacts, fit: &Fit, local: &LocalDifferences) {
        let limit = self.tolerance.remainder;
        if self.remainder <= limit || local.at_ends.is_empty() {
            return;
        }
        let mut left = fit.left.clone();
        for &number in &local.at_ends {
            left[number] = 0.0;
        }
        let remainder = contacts.at_share(&left, STATED_SHARE);
        if remainder <= limit {
            self.remainder = remainder;
        }
    }

    fn border_reasons(&self, evidence: &PoseEvidence<'_>, fit: &Fit) -> Vec<ShapeReason> {
        let borders = &evidence.borders;
        let limit = borders.limit(&self.tolerance);
        let mut reasons = Vec::new();
        reasons.extend(misplaced_hole(borders, &fit.holes, &self.tolerance));
        if let ([of_source, ..], [of_target, ..]) =
            (borders.missing[0].as_slice(), borders.missing[1].as_slice())
        {
            let larger = if of_source.radius > of_target.radius {
                of_source
            } else {
                of_target
            };
            reasons.push(ShapeReason::Holes {
                only_source: borders.missing[0].len(),
                only_target: borders.missing[1].len(),
                at: larger.center,
            });
        }
        let Some(by) = self.borders.offset.filter(|by| *by > limit) else {
            let aside = outline_aside_of_holes(evidence, fit, limit);
            reasons.extend(aside.map(|BorderApart { by, at }| ShapeReason::Borders {
                by,
                limit,
                at,
            }));
            return reasons;
        };
        let pairs = borders.pairs().iter().zip(&fit.borders);
        let within = pairs.filter(|(pair, left)| pair.kind != PairKind::Mixed && left.abs() <= by);
        if let Some((pair, _)) = within.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
            let at = pair.point;
            reasons.push(ShapeReason::Borders { by, limit, at });
        }
        reasons
    }

    /// `mostly` is the remainder at most of the area.
    fn judge(&self, noise: f64, mostly: f64) -> ShapeKind {
        if self.reasons.iter().any(ShapeReason::is_of_another_part) {
            return ShapeKind::Different;
        }
        if !self.reasons.is_empty() {
            return if self.reasons.iter().all(ShapeReason::is_bend) {
                ShapeKind::Deformed
            } else {
                ShapeKind::OtherVersion
            };
        }
        let facets = (FACETING * noise).max(UNREMARKABLE * self.tolerance.remainder);
        let is_bent = self.springback.max(mostly) > facets || self.bent_end.is_some();
        if !is_bent && self.offset.is_none() {
            ShapeKind::Same
        } else {
            ShapeKind::Deformed
        }
    }
}

fn border_fit(borders: &Borders, fit: &Fit, tolerance: &ShapeTolerance) -> BorderFit {
    BorderFit {
        offset: (borders.share() >= LEAST_PAIRED).then(|| borders.distance_of_most(&fit.borders)),
        together: borders.share_within(&fit.borders, TOGETHER * borders.limit(tolerance)),
        other_trim: None,
        apart: trims::farthest_apart(borders, &fit.borders, borders.limit(tolerance)),
        pieces: None,
        n_holes: borders.holes.len(),
        worst_hole: fit.holes.iter().map(HoleLeft::size).fold(0.0, f64::max),
        only_source: borders.missing[0].len(),
        only_target: borders.missing[1].len(),
    }
}

/// A hole that lies elsewhere or has another size than its counterpart, or all of them lying aside one way: their
/// mean is known better than each, where borders are ragged. `left` is what is left of the distance of each.
fn misplaced_hole(
    borders: &Borders,
    left: &[HoleLeft],
    tolerance: &ShapeTolerance,
) -> Option<ShapeReason> {
    // The nodes of round holes tell how well each of them is known, however ragged the outlines are.
    let ragged = borders.limit(tolerance);
    let limit_of = |pair: &HolePair| {
        let round = |by: f64| tolerance.remainder.hypot(by);
        pair.out_of_round.map_or(ragged, |by| round(by).min(ragged))
    };
    let holes = borders.all_holes().zip(left);
    let holes = holes.map(|(pair, left)| (pair, left.size(), limit_of(pair)));
    let worst = holes.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)));
    let (pair, by, limit) = worst?;
    let of_each = (by, limit);
    let of_all = mean_off(left).map(|mean| (mean.off, mean.limit(tolerance)));
    let is_beyond = |(by, limit): &(f64, f64)| by > limit;
    let [of_each, of_all] = [Some(of_each), of_all].map(|of| of.filter(is_beyond));
    let (by, limit) = of_each.or(of_all)?;
    Some(ShapeReason::Hole {
        by,
        limit,
        at: pair.hole.center,
        is_mean: of_each.is_none(),
    })
}

/// How far holes lie off in the mean.
struct MeanOff {
    off: f64,
    /// Standard error.
    error: f64,
}

/// `None` of too few holes.
fn mean_off(left: &[HoleLeft]) -> Option<MeanOff> {
    let n = left.len() as f64;
    let mean = left.iter().map(|hole| hole.off).sum::<Vector3>() / n;
    let squares = left.iter().map(|hole| (hole.off - mean).norm_squared());
    let variance = squares.sum::<f64>() / (n - 1.0);
    (left.len() >= LEAST_HOLES).then(|| MeanOff {
        off: mean.norm(),
        error: (variance / n).sqrt(),
    })
}

impl MeanOff {
    fn limit(&self, tolerance: &ShapeTolerance) -> f64 {
        tolerance.remainder.hypot(SURELY * self.error)
    }
}

/// Middle of the patch whose values are largest.
fn worst_place(contacts: &Contacts, values: &[f64]) -> Point3 {
    let patch_of = contacts.patches(PLACE_LEVELS);
    let n = patch_of.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![(0.0, Vector3::zeros(), 0.0); n];
    for ((contact, value), patch) in contacts.list.iter().zip(values).zip(patch_of) {
        let (square, place, weight) = &mut sums[patch];
        *square += contact.weight * value * value;
        *place += (contact.point - contacts.center) * contact.weight;
        *weight += contact.weight;
    }
    let mean = |(square, _, weight): &&(f64, Vector3, f64)| square / weight.max(1e-300);
    let worst = sums.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)));
    worst.map_or(contacts.center, |(_, place, weight)| {
        contacts.center + place / weight.max(1e-300)
    })
}

#[cfg(test)]
mod tests;
