//! The assessment in words: the only place where verdicts, reasons, free motions and rival poses become
//! English.

use std::f64::consts::PI;

use super::deviation::{ConstantOffset, OffsetKind, OverlapClass};
use super::{
    FreeMotion, FreeMotionKind, PartDirection, PoseKind, PoseStatement, PoseUncertainty, Reason,
    Twin, TwinAxis, Verdict,
};
use crate::geometry::Vector3;
use crate::registration::{Termination, UnitGuess};
use crate::text::{Lengths, counted, fixed, parts_by_id, percent, vector};

mod ratio;
mod shape;

pub use ratio::{alternative_words, as_well, beside, fit_beside, fit_of_hand, likely_beside};

/// Rotations smaller than this are not mentioned.
const NO_ROTATION: f64 = 3.0 * PI / 180.0;
/// A direction is that of an axis if it lies within about a degree of it.
const ALONG_AXIS: f64 = 0.9998;
/// Shares of outlines below this one are hardly any.
const WORTH_TELLING: f64 = 0.1;

impl Verdict {
    /// The word for people: `GOOD`, `CHECK` or `POOR`.
    pub fn label(self) -> &'static str {
        match self {
            Self::Good => "GOOD",
            Self::Check => "CHECK",
            Self::Poor => "POOR",
        }
    }

    /// The sign that stands beside the word, so that colour is never the only one.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Good => "✔",
            Self::Check => "⚠",
            Self::Poor => "✖",
        }
    }

    /// What to do with the pose of which this was stated, as a sentence.
    pub fn advice(self, pose: Option<PoseKind>) -> &'static str {
        match self {
            Self::Good => "The pose can be used.",
            Self::Check if pose == Some(PoseKind::Ambiguous) => {
                "The pose is one of several that fit; choose the one that is meant."
            }
            Self::Check => "The pose is probably right; check the reasons.",
            Self::Poor => "Do not use this pose.",
        }
    }
}

impl Reason {
    /// The reason in words, without a capital and a full stop.
    pub fn words(&self, lengths: Lengths) -> String {
        match self {
            Self::OppositeHand {
                score_ratio,
                by_borders,
            } => opposite_hand(&fit_of_hand(*score_ratio, *by_borders)),
            Self::NearMirrorImage {
                score_ratio,
                by_borders,
            } => near_mirror_image(&fit_of_hand(*score_ratio, *by_borders)),
            Self::SeveralParts {
                n_parts,
                size_ratio,
            } => several_parts(*n_parts, *size_ratio),
            Self::DifferentUnits { size_ratio, unit } => different_units(*size_ratio, *unit),
            Self::SizesFarApart { size_ratio } => sizes_far_apart(*size_ratio),
            Self::PairScale { scale } => {
                format!("the paired points fit best at a scale of {scale:.4}")
            }
            Self::BothOverhang { source, target } => format!(
                "neither part contains the other: {} overlap",
                both_overlaps(*source, *target)
            ),
            Self::PartlyMet { share } => partly_met(*share),
            Self::Elsewhere { share } => elsewhere(*share),
            Self::Sliding {
                motion,
                held_across,
            } => sliding(motion, *held_across),
            Self::Uncertain { by, limit, along } => {
                let [by, limit] = lengths.compared([*by, *limit]);
                let along = along.words();
                format!("the pose may be off by {by}, {along}, more than {limit}")
            }
            Self::Shape { difference } => difference.words(lengths),
            Self::NearAlternative {
                score_ratio,
                by_shape,
                twin,
            } => {
                let fit = other_fit(*twin, (*score_ratio, *by_shape), lengths);
                format!("{fit}: check which pose is meant")
            }
            Self::EqualAlternative {
                score_ratio,
                by_shape,
                twin,
                n_equivalent,
            } => {
                let fit = other_fit(*twin, (*score_ratio, *by_shape), lengths);
                let poses = counted(*n_equivalent, "pose");
                format!("ambiguous: {fit}; {poses} in all")
            }
            Self::AlikeParts { ids } => format!(
                "the stamped part fits {} about as well: choose the part it belongs to",
                parts_by_id(ids)
            ),
            Self::OthersNotSought => {
                "only the given pose was refined: another one may fit as well".to_owned()
            }
            Self::Stopped => "the match was stopped before it converged".to_owned(),
            Self::EndedEarly { termination } => {
                format!("the match ended early: {}", termination.label())
            }
            Self::ReadErrors {
                in_source,
                in_target,
            } => read_errors(*in_source, *in_target),
            Self::InOrder {
                overlap,
                p95,
                rivals_sought,
            } => in_order(*overlap, *p95, *rivals_sought, lengths),
        }
    }

    /// The same where overlaps and distances stand beside it, which it then leaves out.
    pub fn words_beside_figures(&self, lengths: Lengths) -> String {
        match self {
            Self::BothOverhang { .. } => "neither part contains the other".to_owned(),
            Self::InOrder { rivals_sought, .. } => rivals_words(*rivals_sought).to_owned(),
            _ => self.words(lengths),
        }
    }
}

/// Sheets at an offset lie beyond the overlap where their elements are small: nothing is said of distances then.
fn in_order(overlap: f64, p95: f64, rivals_sought: bool, lengths: Lengths) -> String {
    let within = if p95.is_finite() {
        format!(", 95 % of the overlap lies within {},", lengths.bound(p95))
    } else {
        String::new()
    };
    format!(
        "{} of the smaller part has a counterpart with like normals{within} and {}",
        percent(overlap),
        rivals_words(rivals_sought)
    )
}

fn rivals_words(were_sought: bool) -> &'static str {
    if were_sought {
        "no other pose fits nearly as well"
    } else {
        "other poses were not looked for everywhere"
    }
}

fn opposite_hand(fit: &str) -> String {
    format!(
        "looks like the opposite-hand part ({fit} with that hand): match with it, or choose the other part"
    )
}

fn near_mirror_image(fit: &str) -> String {
    format!("the part is nearly its own mirror image: mirrored, {fit}")
}

impl Termination {
    /// Why an iteration ended, in words.
    pub fn label(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::MaxIterations => "reached the iteration limit",
            Self::NoGain => "stopped gaining",
            Self::Stopped => "stopped on request",
            Self::Degenerate => "the pairs fix no motion",
            Self::NoPairs => "no point found a partner",
            Self::ClosedForm => "closed form",
        }
    }
}

impl OverlapClass {
    /// The words for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Matched => "matched",
            Self::OffByMore => "beyond the limit",
            Self::OnlyHere => "on this part only",
        }
    }
}

impl ConstantOffset {
    /// What it looks like, with a length as the caller writes lengths:
    /// "looks like tool side against mid-surface, 0.6 mm".
    pub fn words(&self, length: impl Fn(f64) -> String) -> String {
        let distance = length(self.value.abs());
        match self.kind {
            OffsetKind::ToolSideAgainstMidSurface => {
                format!("looks like tool side against mid-surface, {distance}")
            }
            OffsetKind::OppositeSides => {
                format!("looks like one side of the sheet against the other, {distance}")
            }
        }
    }
}

impl PartDirection {
    /// "mostly along the part".
    pub fn words(self) -> &'static str {
        match self {
            Self::Along => "mostly along the part",
            Self::Across => "mostly across the part",
            Self::Through => "mostly at right angles to the sheet",
            Self::Oblique => "oblique to the axes of the part",
        }
    }
}

impl PoseKind {
    /// The word for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Certain => "certain",
            Self::Uncertain => "uncertain",
            Self::Ambiguous => "ambiguous",
            Self::NotFound => "not found",
        }
    }
}

impl PoseUncertainty {
    /// Why a flat part is uncertain through the sheet; `None` where it is not.
    pub fn words_of_unknown_offset(&self, lengths: Lengths) -> Option<String> {
        (self.unknown_offset > 0.0).then(|| {
            format!(
                "the normals vary too little to tell skin from mid-surface, half the thickness is {}",
                lengths.of(self.unknown_offset)
            )
        })
    }
}

impl PoseStatement {
    /// "certain: ± 0.03 mm, mostly along the part (tolerance 5.00 mm)".
    pub fn words(&self, lengths: Lengths) -> String {
        let label = self.kind.label();
        let Some(stated) = &self.uncertainty else {
            return label.to_owned();
        };
        let offset = stated.words_of_unknown_offset(lengths);
        let offset = offset.map_or_else(String::new, |words| format!("; {words}"));
        format!(
            "{label}: ± {}, {} (tolerance {}{offset})",
            lengths.of(stated.largest),
            stated.along.words(),
            lengths.of(self.tolerance)
        )
    }
}

fn read_errors(in_source: u64, in_target: u64) -> String {
    let of = |(n, file): (u64, &str)| {
        let n = usize::try_from(n).unwrap_or(usize::MAX);
        (n > 0).then(|| format!("{} in the {file} file", counted(n, "read error")))
    };
    let files = [(in_source, "stamped"), (in_target, "crash")];
    let files: Vec<String> = files.into_iter().filter_map(of).collect();
    format!(
        "{}: nodes or elements may be missing or misplaced",
        files.join(" and ")
    )
}

fn different_units(size_ratio: f64, unit: UnitGuess) -> String {
    let larger = if size_ratio < 1.0 { "stamped" } else { "crash" };
    let times = rounded(unit.times(size_ratio));
    format!(
        "the {larger} part is about {times} × larger, as if the stamped part were in {} and the crash part in {}: \
         check units and factors",
        unit.source.plural(),
        unit.target.plural()
    )
}

fn several_parts(n_parts: usize, size_ratio: f64) -> String {
    format!(
        "the crash side holds {}, together about {} × larger than the stamped part: choose the part",
        counted(n_parts, "part"),
        rounded(size_ratio)
    )
}

fn elsewhere(share: f64) -> String {
    format!(
        "{} of the smaller part lies neither on the other part nor beyond its borders, and neither borders nor holes \
         confirm the pose",
        percent(share)
    )
}

fn sliding(motion: &FreeMotion, held_across: Option<f64>) -> String {
    match held_across.filter(|held| *held >= WORTH_TELLING) {
        Some(held) => format!(
            "{}, and only {} of the outlines across it lie together",
            motion.words(),
            percent(held)
        ),
        None => motion.words(),
    }
}

fn sizes_far_apart(size_ratio: f64) -> String {
    let times = size_ratio.max(size_ratio.recip());
    let times = if times < 1e3 {
        rounded(times)
    } else {
        format!("{times:.1e}").replace(".0e", "e")
    };
    format!("sizes differ by a factor of {times}: check the unit")
}

fn rounded(times: f64) -> String {
    fixed(times, if times < 100.0 { 1 } else { 0 })
}

fn partly_met(share: f64) -> String {
    format!(
        "only {} of the smaller part has a counterpart with like normals",
        percent(share)
    )
}

fn both_overlaps(source: f64, target: f64) -> String {
    format!(
        "{} of the stamped part and {} of the crash part",
        percent(source),
        percent(target)
    )
}

/// How the part fits in another pose: "rotated by 180° the part fits nearly as well (error 8 % higher)".
fn other_fit(twin: Option<Twin>, (ratio, by_shape): (f64, bool), lengths: Lengths) -> String {
    format!(
        "{} the part fits {} ({})",
        another_pose(twin, lengths),
        as_well(ratio),
        fit_beside(ratio, by_shape)
    )
}

fn another_pose(twin: Option<Twin>, lengths: Lengths) -> String {
    let words = twin.map(|twin| twin.words(lengths));
    words.unwrap_or_else(|| "in another pose".to_owned()) + ","
}

impl Twin {
    /// "rotated by 180° about its long axis", "mirrored along its long axis".
    pub fn words(&self, lengths: Lengths) -> String {
        if self.is_mirrored {
            let plane = match self.axis {
                TwinAxis::Long => " along its long axis",
                TwinAxis::Cross => " along its short axis",
                TwinAxis::Through => " at its own plane",
                TwinAxis::Other => "",
            };
            return format!("mirrored{plane}");
        }
        if self.angle < NO_ROTATION {
            return format!("shifted by {}", lengths.of(self.shift));
        }
        let axis = match self.axis {
            TwinAxis::Long => " about its long axis",
            TwinAxis::Cross => " about its short axis",
            TwinAxis::Through => " in its own plane",
            TwinAxis::Other => "",
        };
        format!("rotated by {}°{axis}", fixed(self.angle.to_degrees(), 0))
    }
}

impl FreeMotion {
    /// The motion in words, with its axis.
    pub fn words(&self) -> String {
        let axis = axis_words(&self.direction);
        match self.kind {
            FreeMotionKind::Flat => {
                format!("the parts are flat: they can slide in the plane normal to {axis}")
            }
            FreeMotionKind::Cylindrical => {
                format!(
                    "the parts are cylindrical: they can slide along {axis} and rotate about it"
                )
            }
            FreeMotionKind::Extruded => {
                format!("the parts are extruded: they can slide along {axis}")
            }
            FreeMotionKind::Revolved => {
                format!("the parts are surfaces of revolution: they can rotate about {axis}")
            }
            FreeMotionKind::Spherical => {
                "the parts are spherical: they can rotate about their centre".to_owned()
            }
            FreeMotionKind::Other => {
                format!("the parts can move on each other, mainly about {axis}")
            }
        }
    }
}

/// `the x axis` where a direction is one within a degree, else its components.
fn axis_words(direction: &Vector3) -> String {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if direction[axis].abs() > ALONG_AXIS {
            return format!("the {name} axis");
        }
    }
    format!("the direction {}", vector((*direction).into(), 3))
}

#[cfg(test)]
mod tests;
