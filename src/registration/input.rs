//! The surfaces of a match, as given and mirrored.

use super::RegistrationError;
use super::surface::Surface;
use crate::monitor::Monitor;

/// The surfaces of a match.
#[derive(Clone, Copy)]
pub struct MatchInput<'a> {
    /// The moving part.
    pub source: &'a Surface,
    /// The fixed part.
    pub target: &'a Surface,
    /// Reduced meshes of source and target for the search; without them points of the full ones
    /// are used.
    pub reduced: Option<(&'a Surface, &'a Surface)>,
}

/// The source mirrored, prepared like the original.
pub(super) struct Mirrored {
    source: Surface,
    reduced: Option<Surface>,
}

impl Mirrored {
    pub(super) fn of(input: &MatchInput<'_>, monitor: &Monitor) -> Result<Self, RegistrationError> {
        Ok(Self {
            source: input.source.mirrored(monitor)?,
            reduced: input
                .reduced
                .map(|(source, _)| source.mirrored(monitor))
                .transpose()?,
        })
    }

    pub(super) fn input<'a>(&'a self, original: &MatchInput<'a>) -> MatchInput<'a> {
        MatchInput {
            source: &self.source,
            target: original.target,
            reduced: self.reduced.as_ref().zip(original.reduced.map(|(_, t)| t)),
        }
    }
}
