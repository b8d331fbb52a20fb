//! Why a stage of the pipeline has no result.

use std::path::{Path, PathBuf};

use super::project::ProjectError;
use crate::formats::{Diagnostic, FormatError, SelectionError};
use crate::mapping::{MappingError, limits};
use crate::monitor::Cancelled;
use crate::registration::RegistrationError;
use crate::report::CardError;
use crate::simplify::SimplifyError;
use crate::text::{counted, grouped};

/// Why a stage of the pipeline has no result.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The file cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The chosen part is not there or has no area.
    #[error("{error}{near}: {path:?}{}", because(.path, .diagnostic))]
    Selection {
        /// What is wrong with the choice.
        error: SelectionError,
        /// The parts that may have been meant, in words; may be empty.
        near: String,
        /// The file it was made for.
        path: PathBuf,
        /// The most severe diagnostic of the reader, which may be why.
        diagnostic: Option<Box<Diagnostic>>,
    },
    /// The build lacks the example.
    #[error("the example is not in this build")]
    NoExample,
    /// A unit factor that no two units have.
    #[error("the unit factor {0:e} is not between 1e-9 and 1e9")]
    BadUnitFactor(f64),
    /// Something that the output needs is not there.
    #[error("{0} is needed for this")]
    Lacks(&'static str),
    /// A record that has no form as JSON.
    #[error("no JSON can be made of it: {0}")]
    Json(String),
    /// A project cannot be opened.
    #[error(transparent)]
    Project(#[from] Box<ProjectError>),
    /// The extension of a path names no format that can be written.
    #[error("the extension is none of .k, .dynain, .stl, .ply, .obj: {0:?}")]
    UnknownExtension(PathBuf),
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
        /// Name of the part.
        name: String,
        /// Length factor of the part.
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
    /// The mapping failed.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// Neither the deck nor the options say how many layers the elements have.
    #[error(
        "the section of part {part} does not say how many layers its shells have; name them (--layers)"
    )]
    UnknownLayers {
        /// Id of the crash part.
        part: u64,
    },
    /// A part without shells.
    #[error("{error}: {path:?}")]
    NoShells {
        /// Which of both parts it is.
        error: MappingError,
        /// Its file.
        path: PathBuf,
    },
    /// Stamped files without what is to be mapped.
    #[error("none of the results that were asked for are in {0}")]
    NoResults(String),
    /// No crash element got values.
    #[error("nothing is mapped: the parts do not lie on each other at this pose")]
    NothingMapped,
    /// No element got any of the values that were to be written.
    #[error(
        "there is nothing to write: no element has a thickness, a stress or a strain of those asked for"
    )]
    NothingToWrite,
    /// More layers than a mapping carries.
    #[error(
        "part {part} has {n_layers} layers, but a mapping carries 1 to {}; name fewer (--layers)",
        limits::LAYERS.end()
    )]
    TooManyLayers {
        /// Id of the crash part.
        part: u64,
        /// Layers of its section.
        n_layers: usize,
    },
    /// More stacks of plies than the layers of elements can tell apart.
    #[error(
        "the elements have more than 65,536 different stacks of plies; name layers and rule (--layers, --rule)"
    )]
    TooManyRules,
    /// The section's layers lie where a rule of the user's puts them.
    #[error(
        "the section of part {part} has an integration rule of its own (QR/IRID below 0), which is not read; \
         name layers and rule (--layers, --rule)"
    )]
    OwnLayerRule {
        /// Id of the crash part.
        part: u64,
    },
    /// A result to compare with is of another mesh.
    #[error(
        "{path:?} is of another mesh: {} of {} with the same ids have other nodes; give a result on the crash \
         part's own elements",
        grouped(*n_other_nodes),
        counted(*n_same_id, "element")
    )]
    OtherMesh {
        /// The file.
        path: PathBuf,
        /// Its elements with ids of ours.
        n_same_id: usize,
        /// Those of them with other nodes.
        n_other_nodes: usize,
    },
    /// Stresses of a part are read in element axes, which are not mapped.
    #[error(
        "part {part} of {name} is in part set {set}, whose initial stresses are in element axes (LISPSID on \
         *CONTROL_SHELL); stresses are mapped in global axes: take the part out of the set, or map without \
         stress and history (--quantities usual)"
    )]
    ElementAxes {
        /// Id of the part.
        part: u64,
        /// Name of the file.
        name: String,
        /// The part set.
        set: u64,
    },
    /// Stresses of the stamped file are in another unit.
    #[error(
        "the stresses of {name} seem to be in another unit: {why}. Give --stress-factor {factor:e} to \
         convert them, or 1 to take them as they are"
    )]
    StressUnits {
        /// The stamped file.
        name: String,
        /// The evidence, as a clause.
        why: String,
        /// The factor that would bring them into the crash deck's unit.
        factor: f64,
    },
    /// Files to compare with hold nothing of the elements in question.
    #[error("nothing to compare with: no thickness, stress or strain of these elements in {}", names(.0))]
    NothingToCompare(Vec<PathBuf>),
    /// A deck of the kind that was asked for cannot be written; a sentence that says why.
    #[error("{0}")]
    MapOutput(String),
    /// What is written would be made of other contents than those that were read.
    #[error("the file has changed since it was read; reload it, map and write again: {0:?}")]
    Changed(PathBuf),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// ". The reader found: deck.k:5:7: error: …", if it found anything; ". Line 5: error: …" where it stands in the file
/// that is named already.
fn because(path: &Path, diagnostic: &Option<Box<Diagnostic>>) -> String {
    let Some(diagnostic) = diagnostic.as_deref() else {
        return String::new();
    };
    match &diagnostic.position {
        Some(position) if *position.file == *path => {
            let found = Diagnostic {
                position: None,
                ..diagnostic.clone()
            };
            match position.line {
                0 => format!(". The reader found: {found}"),
                line => format!(". Line {line}: {found}"),
            }
        }
        _ => format!(". The reader found: {diagnostic}"),
    }
}

fn names(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| format!("{file:?}")).collect();
    names.join(", ")
}

impl PipelineError {
    /// True if the work ended because it was asked to, which is no error to be shown.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Mapping(MappingError::Cancelled(_))
                | Self::Format(FormatError::Cancelled(_))
                | Self::Registration(RegistrationError::Cancelled(_))
                | Self::Simplify(SimplifyError::Cancelled(_))
                | Self::Selection {
                    error: SelectionError::Cancelled(_),
                    ..
                }
        )
    }
}

/// A cancel request as the error that ends all work; whatever else failed as the result of this step, for
/// callers that go on without it.
pub(super) fn unless_cancelled<T>(
    result: Result<T, PipelineError>,
) -> Result<Result<T, PipelineError>, PipelineError> {
    match result {
        Err(error) if error.is_cancelled() => Err(error),
        other => Ok(other),
    }
}
