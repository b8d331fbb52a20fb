use super::JobError;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::cards::cards;
use crate::pipeline::export::{write_bytes, write_moved};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::record::match_record;
use crate::report::CardForm;
use std::path::PathBuf;
use std::sync::Arc;

/// What is to be written and where.
#[derive(Debug, Clone)]
pub enum ExportRequest {
    /// A text that is ready.
    Text {
        /// The file.
        path: PathBuf,
        /// Its content.
        text: String,
    },
    /// The record of a match as JSON.
    Record {
        /// The file.
        path: PathBuf,
        /// The match.
        run: Arc<MatchRun>,
        /// The target.
        crash: Arc<LoadedPart>,
        /// The source.
        stamped: Arc<LoadedPart>,
    },
    /// LS-DYNA cards, read back.
    Cards {
        /// The file.
        path: PathBuf,
        /// Which cards.
        form: CardForm,
        /// The match.
        run: Arc<MatchRun>,
        /// The target.
        crash: Arc<LoadedPart>,
        /// The source.
        stamped: Arc<LoadedPart>,
    },
    /// The stamped part, moved onto the crash part.
    Moved {
        /// The file; its ending chooses the format.
        path: PathBuf,
        /// The part.
        stamped: Arc<LoadedPart>,
        /// Its pose.
        crash_from_stamped: Similarity,
    },
}

/// Writes; returns the files and what the writing found out.
pub(super) fn export(
    request: ExportRequest,
    monitor: &Monitor,
) -> Result<(PathBuf, Vec<String>), JobError> {
    match request {
        ExportRequest::Text { path, text } => {
            write_bytes(&path, text.as_bytes())?;
            Ok((path, Vec::new()))
        }
        ExportRequest::Record {
            path,
            run,
            crash,
            stamped,
        } => {
            let record = match_record(&run, &crash, &stamped);
            let text = serde_json::to_string_pretty(&record)
                .map_err(|error| JobError::Failed(error.to_string()))?;
            write_bytes(&path, text.as_bytes())?;
            Ok((path, record.warnings))
        }
        ExportRequest::Cards {
            path,
            form,
            run,
            crash,
            stamped,
        } => {
            let cards = cards(form, &run, &crash, &stamped)?;
            write_bytes(&path, cards.text.as_bytes())?;
            let error = cards.largest_node_error(&stamped.mesh.aabb().corners());
            let note = format!("read back: largest node error from rounding {error:.2e}");
            Ok((path, vec![note]))
        }
        ExportRequest::Moved {
            path,
            stamped,
            crash_from_stamped,
        } => {
            write_moved(&path, &stamped, &crash_from_stamped, &[], monitor)?;
            Ok((path, Vec::new()))
        }
    }
}
