//! Why a mapping gives nothing.

use crate::geometry::MeshError;
use crate::monitor::Cancelled;

/// Why a mapping gives nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MappingError {
    /// No target element has an area.
    #[error(
        "the crash part has no shells to map onto; solids and thick shells take no forming results"
    )]
    EmptyTarget,
    /// There is no source, or one without area.
    #[error("the stamped part has no shells to map from")]
    EmptySource,
    /// None of the sources holds a quantity that was asked for.
    #[error("the stamped part has none of the results that were asked for")]
    NoResults,
    /// The nodes or elements of a part make no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A choice lies outside its range.
    #[error("{name} is {value}, but must be {range}")]
    Setting {
        /// Name of the option.
        name: &'static str,
        /// Value it was given.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
