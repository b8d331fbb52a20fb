//! Why a registration gave no pose.

use std::ops::RangeInclusive;

use crate::monitor::Cancelled;
use crate::text::grouped;

/// Why a registration gave no pose.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegistrationError {
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A mesh has no triangle with area.
    #[error("the {side} mesh has no triangle with area")]
    EmptyMesh {
        /// `source` or `target`.
        side: &'static str,
    },
    /// Paired points need the same count on both sides.
    #[error(
        "Umeyama pairs points in their order, but the source (stamped part) has {} and the target \
         (crash part) {}; take another method for meshes that differ",
        grouped(*n_source),
        grouped(*n_target)
    )]
    UnequalCounts {
        /// Points of the source.
        n_source: usize,
        /// Points of the target.
        n_target: usize,
    },
    /// Fewer than three pairs with positive weight and finite coordinates.
    #[error("at least three usable pairs are needed to fix a pose, not {n_pairs}")]
    TooFewPairs {
        /// Number of usable pairs.
        n_pairs: usize,
    },
    /// All points of one side lie in one place.
    #[error("all points coincide, so every rotation fits")]
    CoincidentPoints,
    /// All points lie on one line.
    #[error("all points lie on one line, so the rotation about it is free")]
    CollinearPoints,
    /// The angle segment gives too few or absurdly many starts.
    #[error(
        "an angle segment of {degrees}° is outside 1° to 60°: above 60° there are fewer than six \
         starts, too few to reach the right minimum from every placement"
    )]
    AngleSegment {
        /// The segment asked for.
        degrees: f64,
    },
    /// There is no start to run.
    #[error("the start method takes given poses, but none is given (--start-pose)")]
    NoStarts,
    /// A setting is outside its range.
    #[error("{name} is {value}, but must be {}", range_words(.range))]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value it was given.
        value: f64,
        /// The range it has to lie in.
        range: RangeInclusive<f64>,
    },
    /// No start had a single usable pair.
    #[error("no start found usable pairs between the two parts")]
    NoPairs,
}

impl RegistrationError {
    /// True if a setting is to blame and not the parts.
    pub fn is_setting(&self) -> bool {
        matches!(
            self,
            Self::Setting { .. } | Self::AngleSegment { .. } | Self::NoStarts
        )
    }
}

fn range_words(range: &RangeInclusive<f64>) -> String {
    let (low, high) = (range.start(), range.end());
    if *high < f64::MAX {
        format!("from {low} to {high}")
    } else {
        format!("at least {low}")
    }
}
