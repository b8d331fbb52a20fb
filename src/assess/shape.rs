//! Are both parts the same shape? What a smooth bend and twist explain is springback; what remains, and
//! rims that do not lie where they belong, are differences of the part.

mod bends;
mod equations;
mod local;

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use super::contact::{Contacts, Six, quantile, robust_weights, solve};
use super::rims::Rims;
use super::stretch::{PartAxis, Stretch, stretch};
use super::trims;
use crate::geometry::serial::{any_float, xyz};
use crate::geometry::{Point3, Similarity, Vector3};
use crate::registration::Surface;

pub(super) use bends::Bends;
use bends::N_BENDS;
use equations::{Equations, own_share};
use local::{LocalDifference, local_difference};

/// Unknowns of the fit: a rigid motion, an offset, and the bends.
pub(super) const N: usize = 7 + N_BENDS;
/// Times that places far off the fit are given less weight.
const ROUNDS: usize = 4;
/// Share of an offset that nothing else can imitate; with less it is not told apart.
pub(super) const LEAST_OWN: f64 = 0.02;
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
/// Where fewer of the smaller part's rims lie beside rims of the other, the parts are trimmed differently
/// and rims say nothing about the shape.
pub(super) const LEAST_PAIRED: f64 = 0.4;
/// Parts that meet over less than this share of the smaller one are different parts.
const LEAST_MET: f64 = 0.5;
/// Parts that meet over less than this share, and differ where they meet, are different parts too: a
/// trimmed part keeps its shape.
const MOSTLY_MET: f64 = 0.75;
/// A remainder of so many tolerances is that of a different part.
const DIFFERENT: f64 = 6.0;
/// Distances up to so many times the faceting, or this share of the tolerance, are unremarkable at most of
/// the area.
pub(super) const FACETING: f64 = 3.0;
pub(super) const UNREMARKABLE: f64 = 0.1;
const SAME_SHARE: f64 = 0.8;
/// Patches that are searched for the place of the largest difference: 2 to this power.
const PLACE_LEVELS: u32 = 5;

/// How large differences may be before the shape is another. Target length units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShapeTolerance {
    /// What may remain besides springback and offset, at 95 % of the area; rims and holes likewise.
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

/// The statement about the shape in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeKind {
    /// The parts differ by no more than their facets.
    Same,
    /// The same part, bent or offset within the tolerance.
    Deformed,
    /// A part of the same kind whose surface, rims or holes differ by more than the tolerance.
    OtherVersion,
    /// Two parts that do not belong together.
    Different,
}

/// How rims and holes lie. Lengths in target units.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RimFit {
    /// Distance across the rim that 90 % of the rims beside each other do not exceed, without what
    /// springback and an error of the pose explain; `None` where too few rims lie beside each other.
    pub offset: Option<f64>,
    /// Where one part was trimmed farther out than the other: how far outlines lie apart, at 90 % of those that
    /// do. They are no evidence, neither of the pose nor of the shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_trim: Option<f64>,
    /// Where most borders lie together, the stretch that lies farthest apart, if that is by more than is
    /// accepted: a single end that was cut elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart: Option<BorderApart>,
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

/// A stretch of border that lies apart from its counterpart. In target units and the target's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BorderApart {
    /// Distance across the border that half of the stretch exceeds.
    pub by: f64,
    /// Its middle.
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
    },
    /// The rims do not lie on each other.
    Rims {
        /// At 90 % of the rims beside each other.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the largest difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
    },
    /// A hole lies elsewhere or has another size.
    Hole {
        /// By how much.
        by: f64,
        /// What is accepted.
        limit: f64,
        /// Point of the difference, in the target's frame.
        #[serde(with = "xyz")]
        at: Point3,
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
}

impl ShapeReason {
    /// Whether parts that differ so are two different parts.
    pub(super) fn is_of_another_part(&self) -> bool {
        match self {
            Self::HardlyMet { .. } => true,
            Self::Surface { by, limit, .. } => *by > DIFFERENT * limit,
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
    /// False where normals vary too little to tell an offset from a shift of the part.
    pub is_offset_separable: bool,
    /// True if the pose was to be that of the mid-surfaces, without the offset.
    #[serde(default)]
    pub is_offset_removed: bool,
    /// Rims and holes.
    pub rims: RimFit,
    /// What speaks against one shape, the most severe first; empty within the tolerance.
    pub reasons: Vec<ShapeReason>,
}

/// What the statement is made from.
#[derive(Clone, Copy)]
pub(super) struct ShapeEvidence<'a> {
    pub(super) source: &'a Surface,
    pub(super) target: &'a Surface,
    pub(super) pose: &'a Similarity,
    pub(super) contacts: &'a Contacts,
    pub(super) rims: &'a Rims,
    /// Faceting of both meshes.
    pub(super) noise: f64,
    /// Surfaces within it are compared.
    pub(super) reach: f64,
}

impl ShapeStatement {
    /// Compares the shapes at a pose.
    pub(super) fn of(evidence: &ShapeEvidence<'_>, tolerance: ShapeTolerance) -> Self {
        let fit = Fit::of(evidence);
        let contacts = evidence.contacts;
        let areas = contacts.list.iter().map(|c| c.weight);
        let at = |share: f64, values: &[f64]| {
            let sizes = values.iter().map(|v| v.abs());
            quantile(&mut sizes.zip(areas.clone()).collect::<Vec<_>>(), share)
        };
        let mut statement = Self {
            kind: ShapeKind::Same,
            tolerance,
            met: contacts.share,
            springback: at(0.95, &fit.smooth),
            remainder: at(0.95, &fit.left),
            offset: Some(fit.offset).filter(|o| o.abs() > FACETING * evidence.noise),
            is_offset_separable: fit.is_separable,
            is_offset_removed: false,
            rims: rim_fit(evidence.rims, &fit, &tolerance),
            reasons: Vec::new(),
        };
        statement.reasons = statement.find_reasons(evidence, &fit);
        statement.kind = statement.judge(evidence.noise, at(SAME_SHARE, &fit.left));
        statement
    }

    /// The statement about parts that do not meet at all.
    pub(super) fn nothing_met(tolerance: ShapeTolerance) -> Self {
        Self {
            kind: ShapeKind::Different,
            tolerance,
            met: 0.0,
            springback: 0.0,
            remainder: f64::INFINITY,
            offset: None,
            is_offset_separable: false,
            is_offset_removed: false,
            rims: RimFit::default(),
            reasons: vec![ShapeReason::HardlyMet { share: 0.0 }],
        }
    }

    fn find_reasons(&self, evidence: &ShapeEvidence<'_>, fit: &Fit) -> Vec<ShapeReason> {
        let mut reasons = Vec::new();
        let differs = self.remainder > self.tolerance.remainder;
        if self.met < LEAST_MET || differs && self.met < MOSTLY_MET {
            reasons.push(ShapeReason::HardlyMet { share: self.met });
        }
        let limit = self.tolerance.remainder;
        if self.remainder > limit {
            let at = worst_place(evidence.contacts, &fit.left);
            reasons.push(ShapeReason::Surface {
                by: self.remainder,
                limit,
                at,
            });
        } else if let Some(LocalDifference { by, at }) =
            local_difference(evidence, &fit.left, limit)
        {
            reasons.push(ShapeReason::Local { by, limit, at });
        }
        reasons.extend(self.rim_reasons(evidence, fit));
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
        reasons
    }

    fn rim_reasons(&self, evidence: &ShapeEvidence<'_>, fit: &Fit) -> Vec<ShapeReason> {
        let rims = evidence.rims;
        let limit = rims.limit(&self.tolerance);
        let mut reasons = Vec::new();
        let holes = rims.all_holes().zip(&fit.holes);
        let worst = holes.max_by(|a, b| a.1.total_cmp(b.1));
        if let Some((pair, &by)) = worst.filter(|(_, by)| **by > limit) {
            let at = pair.hole.center;
            reasons.push(ShapeReason::Hole { by, limit, at });
        }
        if let ([of_source, ..], [of_target, ..]) =
            (rims.missing[0].as_slice(), rims.missing[1].as_slice())
        {
            let larger = if of_source.radius > of_target.radius {
                of_source
            } else {
                of_target
            };
            reasons.push(ShapeReason::Holes {
                only_source: rims.missing[0].len(),
                only_target: rims.missing[1].len(),
                at: larger.center,
            });
        }
        let Some(by) = self.rims.offset.filter(|by| *by > limit) else {
            return reasons;
        };
        let pairs = rims.pairs().iter().zip(&fit.rims);
        let within = pairs.filter(|(_, left)| left.abs() <= by);
        if let Some((pair, _)) = within.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
            let at = pair.point;
            reasons.push(ShapeReason::Rims { by, limit, at });
        }
        reasons
    }

    /// `mostly` is the remainder at most of the area.
    fn judge(&self, noise: f64, mostly: f64) -> ShapeKind {
        if self.reasons.iter().any(ShapeReason::is_of_another_part) {
            return ShapeKind::Different;
        }
        if !self.reasons.is_empty() {
            let only_bent = self
                .reasons
                .iter()
                .all(|r| matches!(r, ShapeReason::Bent { .. }));
            return if only_bent {
                ShapeKind::Deformed
            } else {
                ShapeKind::OtherVersion
            };
        }
        let facets = (FACETING * noise).max(UNREMARKABLE * self.tolerance.remainder);
        if self.springback.max(mostly) <= facets && self.offset.is_none() {
            ShapeKind::Same
        } else {
            ShapeKind::Deformed
        }
    }
}

/// Distance across the rims that 90 % of them do not exceed.
fn most_of_rims(rims: &Rims, left: &[f64]) -> f64 {
    let sizes = left.iter().map(|left| left.abs());
    let sizes = sizes.zip(rims.pairs().iter().map(|p| p.weight));
    quantile(&mut sizes.collect::<Vec<_>>(), 0.9)
}

fn rim_fit(rims: &Rims, fit: &Fit, tolerance: &ShapeTolerance) -> RimFit {
    RimFit {
        offset: (rims.share() >= LEAST_PAIRED).then(|| most_of_rims(rims, &fit.rims)),
        other_trim: None,
        apart: trims::farthest_apart(rims, &fit.rims, rims.limit(tolerance)),
        n_holes: rims.holes.len(),
        worst_hole: fit.holes.iter().copied().fold(0.0, f64::max),
        only_source: rims.missing[0].len(),
        only_target: rims.missing[1].len(),
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

/// The gaps taken apart.
pub(super) struct Fit {
    /// Of each place, what rigid motion and bends explain.
    smooth: Vec<f64>,
    /// What nothing explains, not even the facets.
    left: Vec<f64>,
    /// The same for each pair of rims and of holes.
    pub(super) rims: Vec<f64>,
    pub(super) holes: Vec<f64>,
    /// How far the source lies from where it belongs, bends counted as part of its shape; turns in
    /// lengths at the contacts' radius.
    pub(super) rigid: Six,
    offset: f64,
    is_separable: bool,
}

/// One row of the fit.
pub(super) type Row = SVector<f64, N>;

/// How much each unknown moves a place along a direction; `offset` is what a unit of the offset does.
pub(super) fn explaining(
    contacts: &Contacts,
    bends: &Bends,
    point: &Point3,
    direction: &Vector3,
    offset: f64,
) -> Row {
    let mut row = Row::zeros();
    let six = contacts.row(point, direction);
    row.fixed_rows_mut::<6>(0).copy_from(&six);
    row[6] = offset;
    row.fixed_rows_mut::<N_BENDS>(7)
        .copy_from(&bends.row(point, direction));
    row
}

impl Fit {
    /// The offset of the sheets, where it can be told from a shift.
    pub(super) fn separate_offset(&self) -> Option<f64> {
        self.is_separable.then_some(self.offset)
    }

    /// Robust least squares over a rigid motion, an offset and the bends of a plate that keep lengths
    /// (second and third order). Rims take part, so that a slide of the pose along the part is no
    /// difference of the shape. O(places).
    pub(super) fn of(evidence: &ShapeEvidence<'_>) -> Self {
        let (contacts, rims) = (evidence.contacts, evidence.rims);
        let bends = Bends::of(evidence);
        let row = |point: &Point3, direction: &Vector3, offset: f64| {
            explaining(contacts, &bends, point, direction, offset)
        };
        let places = contacts.list.iter();
        let places: Vec<Row> = places.map(|c| row(&c.point, &c.normal, 1.0)).collect();
        let beside = rims.pairs().iter();
        let beside: Vec<Row> = beside.map(|p| row(&p.point, &p.across, 0.0)).collect();
        let areas: Vec<f64> = contacts.list.iter().map(|c| c.weight).collect();
        let mut left: Vec<f64> = contacts.list.iter().map(|c| c.gap).collect();
        let mut found = Row::zeros();
        let mut is_separable = false;
        let rim_weights = rims.weights(evidence.noise);
        for _ in 0..ROUNDS {
            let weights = robust_weights(&left, &areas, evidence.noise);
            let mut equations = Equations::default();
            for ((row, contact), weight) in places.iter().zip(&contacts.list).zip(weights) {
                equations.add(row, contact.gap, weight);
            }
            for ((row, pair), weight) in beside.iter().zip(rims.pairs()).zip(&rim_weights) {
                equations.add(row, pair.gap, *weight);
            }
            is_separable = own_share(&equations.matrix) > LEAST_OWN;
            if !is_separable {
                // The shift of the rigid motion takes it.
                equations.leave_out(6);
            }
            found = solve(&equations.matrix, &equations.right);
            for ((left, row), contact) in left.iter_mut().zip(&places).zip(&contacts.list) {
                *left = contact.gap - row.dot(&found);
            }
        }
        let smooth = places.iter().map(|row| row.dot(&found) - found[6]);
        for (left, contact) in left.iter_mut().zip(&contacts.list) {
            *left = left.signum() * (left.abs() - contact.facet).max(0.0);
        }
        let beside = beside.iter().zip(rims.pairs());
        let beside: Vec<f64> = beside.map(|(row, p)| p.gap - row.dot(&found)).collect();
        let as_they_are: Vec<f64> = rims.pairs().iter().map(|p| p.gap).collect();
        // What throws most rims apart explains none of them.
        let explains = most_of_rims(rims, &beside) <= most_of_rims(rims, &as_they_are);
        let holes = rims.all_holes().map(|pair| {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let explained = axes.map(|axis| row(&pair.hole.center, &axis, 0.0).dot(&found));
            let left = pair.off - Vector3::from(explained);
            // Across its sheet the middle of a hole says what the surface says.
            let within = left - pair.hole.normal * left.dot(&pair.hole.normal);
            within.norm() + pair.wider
        });
        Self {
            smooth: smooth.collect(),
            rims: if explains { beside } else { as_they_are },
            holes: holes.collect(),
            rigid: found.fixed_rows::<6>(0) + bends.rigid_part(&found, contacts),
            left,
            offset: found[6],
            is_separable,
        }
    }
}

#[cfg(test)]
mod tests;
