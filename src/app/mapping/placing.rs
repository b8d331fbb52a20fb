//! What the match of a further stamped file gave.

use crate::app::facts;
use crate::assess::{self, Coverage, Verdict};
use crate::geometry::Similarity;
use crate::pipeline::match_parts::MatchRun;
use crate::text::Lengths;

/// What the match of a further stamped file gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Placing {
    /// `crash = c · R · stamped + t`.
    pub crash_from_stamped: Similarity,
    /// Whether the pose can be used.
    pub verdict: Verdict,
    /// Distances and overlap; unknown of an older project.
    pub coverage: Option<Coverage>,
    /// The first reason for the verdict.
    pub reason: Option<assess::Reason>,
    /// The number of the crash part that it was matched with.
    pub crash_revision: u64,
}

impl Placing {
    /// Of a run on the crash part of this number.
    pub(super) fn of(run: &MatchRun, crash_revision: u64) -> Self {
        Self {
            crash_from_stamped: run.crash_from_stamped,
            verdict: run.assessment.verdict,
            coverage: Some(run.assessment.coverage),
            reason: run.assessment.reasons.first().cloned(),
            crash_revision,
        }
    }

    /// The match in a line.
    pub(in crate::app) fn line(&self, lengths: Lengths) -> String {
        let verdict = (self.verdict, self.crash_from_stamped.is_mirrored());
        match &self.coverage {
            Some(coverage) => facts::line_of(verdict, (coverage, self.reason.as_ref()), lengths),
            None => self.verdict.label().to_owned(),
        }
    }
}
