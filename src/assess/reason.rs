//! Why a verdict is what it is: each reason with its numbers and its weight.

use serde::{Deserialize, Serialize};

use super::{FreeMotion, PartDirection, ShapeReason, Twin, Verdict};
use crate::geometry::serial::any_float;
use crate::registration::{Termination, UnitGuess};

/// One reason for a verdict. Lengths are in target length units, scores relative to the result's.
///
/// Stored by name with its numbers; [`Reason::words`] puts it into words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// The mirrored source fits clearly better.
    OppositeHand {
        /// Score of the opposite hand over the result's.
        #[serde(with = "any_float")]
        score_ratio: f64,
        /// Whether borders and holes say so, and the score is no measured error.
        #[serde(default)]
        by_borders: bool,
    },
    /// The source is nearly its own mirror image, and mirrored it fits a little better.
    NearMirrorImage {
        /// Score of the opposite hand over the result's.
        #[serde(with = "any_float")]
        score_ratio: f64,
        /// Whether borders and holes say so, and the score is no measured error.
        #[serde(default)]
        by_borders: bool,
    },
    /// The target consists of more parts than the source belongs to.
    SeveralParts {
        /// How many.
        n_parts: usize,
        /// Their size together over that of the source.
        #[serde(with = "any_float")]
        size_ratio: f64,
    },
    /// The sizes differ by a factor between length units.
    DifferentUnits {
        /// Target size over source size.
        #[serde(with = "any_float")]
        size_ratio: f64,
        /// The factor, and between which units it lies.
        unit: UnitGuess,
    },
    /// The sizes differ by a large factor that lies between no known units.
    SizesFarApart {
        /// Target size over source size.
        #[serde(with = "any_float")]
        size_ratio: f64,
    },
    /// The final pairs would fit better at another scale.
    PairScale {
        /// The scale that fits them best.
        #[serde(with = "any_float")]
        scale: f64,
    },
    /// Each part extends beyond the other.
    BothOverhang {
        /// Covered fraction of the source's area.
        #[serde(with = "any_float")]
        source: f64,
        /// Covered fraction of the target's area.
        #[serde(with = "any_float")]
        target: f64,
    },
    /// One part lies on the other, and much of the smaller one without a counterpart.
    PartlyMet {
        /// Fraction of the smaller part's area that has one.
        #[serde(with = "any_float")]
        share: f64,
    },
    /// A piece of the smaller part lies neither on the other part nor beyond its borders, and neither borders nor holes
    /// confirm the pose.
    Elsewhere {
        /// Fraction of the smaller part's area.
        #[serde(with = "any_float")]
        share: f64,
    },
    /// The surfaces slide on each other.
    Sliding {
        /// How they do.
        motion: FreeMotion,
        /// Share of the smaller part's outlines across the motion that lies together, where it is too small to hold the
        /// part.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        held_across: Option<f64>,
    },
    /// The pose may be off by more than the tolerance.
    Uncertain {
        /// Largest uncertainty of a node.
        #[serde(with = "any_float")]
        by: f64,
        /// The tolerance of the pose, a length ([`super::ShapeTolerance`] widened by the bend).
        limit: f64,
        /// In which direction most.
        along: PartDirection,
    },
    /// The shapes differ.
    Shape {
        /// In what way the shapes differ.
        difference: ShapeReason,
    },
    /// A distinct pose fits nearly as well.
    NearAlternative {
        /// Its score over the result's.
        #[serde(with = "any_float")]
        score_ratio: f64,
        /// Whether the ratio is what surfaces, borders and holes say, and no measured error.
        #[serde(default)]
        by_shape: bool,
        /// How it differs from the result, if that was measured.
        twin: Option<Twin>,
    },
    /// A distinct pose fits as well.
    EqualAlternative {
        /// Its score over the result's.
        #[serde(with = "any_float")]
        score_ratio: f64,
        /// Whether the ratio is what surfaces, borders and holes say, and no measured error.
        #[serde(default)]
        by_shape: bool,
        /// How it differs from the result, if that was measured.
        twin: Option<Twin>,
        /// Equivalent poses, the result included.
        n_equivalent: usize,
    },
    /// Other parts of the target's model fit the source about as well: which one is meant is not known.
    AlikeParts {
        /// Their ids.
        ids: Vec<u64>,
    },
    /// Only given poses were refined: another pose may fit as well.
    OthersNotSought,
    /// The user stopped the match before it converged.
    Stopped,
    /// The iteration ended without a fit.
    EndedEarly {
        /// Why the iterations ended.
        termination: Termination,
    },
    /// What the files hold of nodes, elements and transformations was not read without errors: parts may be
    /// incomplete or lie elsewhere.
    ReadErrors {
        /// In the file of the source.
        in_source: u64,
        /// In the file of the target.
        in_target: u64,
    },
    /// Nothing speaks against the pose.
    InOrder {
        /// Share of the smaller part that meets the other.
        #[serde(with = "any_float")]
        overlap: f64,
        /// Distance that 95 % of the overlap stays below.
        #[serde(with = "any_float")]
        p95: f64,
        /// Whether other poses were looked for everywhere.
        #[serde(default)]
        rivals_sought: bool,
    },
}

impl Reason {
    /// Whether it states that the parts are in different units: nothing else that was found is evidence then.
    pub fn is_of_units(&self) -> bool {
        matches!(
            self,
            Self::DifferentUnits { .. } | Self::SizesFarApart { .. }
        )
    }

    /// Ids of other parts of the target's model that fit about as well, if one of the reasons names them.
    pub fn alike_parts(reasons: &[Self]) -> Option<&[u64]> {
        reasons.iter().find_map(|reason| match reason {
            Self::AlikeParts { ids } => Some(&ids[..]),
            _ => None,
        })
    }

    /// The verdict that this reason alone would give.
    pub fn severity(&self) -> Verdict {
        match self {
            Self::InOrder { .. } => Verdict::Good,
            Self::Shape { difference } if difference.is_of_another_part() => Verdict::Poor,
            Self::Shape { .. } => Verdict::Check,
            Self::NearMirrorImage { .. }
            | Self::PairScale { .. }
            | Self::Uncertain { .. }
            | Self::BothOverhang { .. }
            | Self::PartlyMet { .. }
            | Self::Elsewhere { .. }
            | Self::Sliding { .. }
            | Self::NearAlternative { .. }
            | Self::EqualAlternative { .. }
            | Self::AlikeParts { .. }
            | Self::OthersNotSought
            | Self::Stopped
            | Self::ReadErrors { .. } => Verdict::Check,
            Self::OppositeHand { .. }
            | Self::SeveralParts { .. }
            | Self::DifferentUnits { .. }
            | Self::SizesFarApart { .. }
            | Self::EndedEarly { .. } => Verdict::Poor,
        }
    }
}
