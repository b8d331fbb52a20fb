use std::path::PathBuf;

use crate::formats::{Diagnostic, FormatError, SelectionError};
use crate::monitor::Cancelled;
use crate::registration::RegistrationError;
use crate::report::CardError;
use crate::simplify::SimplifyError;

/// Why a stage of the pipeline has no result.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The file cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The chosen part is not there or has no area.
    #[error("{error}: {path:?}{}", because(.finding))]
    Selection {
        /// What is wrong with the choice.
        error: SelectionError,
        /// The file it was made for.
        path: PathBuf,
        /// The gravest thing the reader found, which may be why.
        finding: Option<Box<Diagnostic>>,
    },
    /// The build lacks the example.
    #[error("the example is not in this build")]
    NoExample,
    /// A unit factor that is not a positive number.
    #[error("the unit factor {0} is not a positive number")]
    BadUnitFactor(f64),
    /// The ending of a path names no format that can be written.
    #[error("the ending is none of .k, .dynain, .stl, .ply, .obj: {0:?}")]
    UnknownEnding(PathBuf),
    /// A file cannot be written.
    #[error("cannot write the file ({reason}): {path:?}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The cards name one part or one set, but several parts were matched.
    #[error(
        "the cards need one crash part or one part set, but {0} parts were matched; choose one \
         part id or a part set on the crash side"
    )]
    SeveralReceivers(usize),
    /// A file was read in another unit, which the cards cannot say.
    #[error(
        "the lengths of {name} were multiplied by {factor}, which the cards cannot hold; match two files of \
         the same unit (--converted writes the stamped one in the crash part's unit)"
    )]
    CardsNeedOneUnit {
        /// The file.
        name: String,
        /// The factor.
        factor: f64,
    },
    /// The cards cannot be written.
    #[error(transparent)]
    Card(#[from] CardError),
    /// The match failed.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The reduction failed.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// ". The reader found: deck.k:5:7: error: …", if it found anything.
fn because(finding: &Option<Box<Diagnostic>>) -> String {
    let words = |finding: &Diagnostic| format!(". The reader found: {finding}");
    finding.as_deref().map(words).unwrap_or_default()
}

impl PipelineError {
    /// True if the work ended because it was asked to, which is no error to be shown.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Format(FormatError::Cancelled(_))
                | Self::Registration(RegistrationError::Cancelled(_))
                | Self::Simplify(SimplifyError::Cancelled(_))
        )
    }
}
