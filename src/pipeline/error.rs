use std::path::PathBuf;

use crate::formats::{FormatError, SelectionError};
use crate::monitor::Cancelled;
use crate::simplify::SimplifyError;

/// Why a stage of the pipeline has no result.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The file cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The chosen part is not there or has no area.
    #[error("{error}: {path:?}")]
    Selection {
        /// What is wrong with the choice.
        error: SelectionError,
        /// The file it was made for.
        path: PathBuf,
    },
    /// A unit factor that is not a positive number.
    #[error("the unit factor {0} is not a positive number")]
    BadUnitFactor(f64),
    /// The reduction failed.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl PipelineError {
    /// True if the work ended because it was asked to, which is no error to be shown.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Format(FormatError::Cancelled(_))
                | Self::Simplify(SimplifyError::Cancelled(_))
        )
    }
}
