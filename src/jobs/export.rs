use super::JobError;
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::cards::cards;
use crate::pipeline::export::{head_lines, write_bytes, write_mesh, write_moved};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::{MatchRun, with_alternative};
use crate::pipeline::node_table::node_table;
use crate::pipeline::record::match_record;
use crate::pipeline::report::report;
use crate::report::CardForm;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is to be made and where it goes.
#[derive(Debug, Clone)]
pub struct ExportRequest {
    /// Where.
    pub to: Destination,
    /// What.
    pub content: ExportContent,
}

/// Where an export goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    /// A file.
    File(PathBuf),
    /// The clipboard; texts only. What it is, for the toast.
    Clipboard(String),
}

/// A match with its parts and the choice among its poses.
#[derive(Debug, Clone)]
pub struct MatchedPair {
    /// The match.
    pub run: Arc<MatchRun>,
    /// The alternative that is shown instead of the best pose; it is measured anew.
    pub alternative: Option<usize>,
    /// The target.
    pub crash: Arc<LoadedPart>,
    /// The source.
    pub stamped: Arc<LoadedPart>,
}

/// What is exported.
#[derive(Debug, Clone)]
pub enum ExportContent {
    /// A text that is ready.
    Text(String),
    /// The record of a match as JSON.
    Record(MatchedPair),
    /// The report of a match as HTML.
    Report(MatchedPair),
    /// LS-DYNA cards, read back.
    Cards(CardForm, MatchedPair),
    /// The distances of all nodes as CSV.
    Deviations {
        /// The target.
        crash: Arc<LoadedPart>,
        /// The source.
        stamped: Arc<LoadedPart>,
        /// Where it lies.
        crash_from_stamped: Similarity,
    },
    /// A part, moved, in its deck or as a mesh.
    Part {
        /// The part.
        part: Arc<LoadedPart>,
        /// Its pose.
        world_from_part: Similarity,
        /// The other part, for what is said about units.
        other: Option<Arc<LoadedPart>>,
    },
    /// A mesh, moved.
    Mesh {
        /// The mesh.
        mesh: Arc<TriMesh>,
        /// Its pose.
        world_from_mesh: Similarity,
        /// Its name.
        title: String,
    },
}

/// What became of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Where it went.
    pub to: Destination,
    /// The text for the clipboard.
    pub text: Option<String>,
    /// What was found out, for example the rounding error of a card.
    pub notes: Vec<String>,
}

/// Makes and writes.
pub(super) fn export(request: ExportRequest, monitor: &Monitor) -> Result<Exported, JobError> {
    let ExportRequest { to, content } = request;
    let (text, notes) = match content {
        ExportContent::Part {
            part,
            world_from_part,
            other,
        } => {
            let lines = head_lines(&part, other.as_deref());
            write_moved(to.path()?, &part, &world_from_part, &lines, monitor)?;
            return Ok(Exported::file(to, Vec::new()));
        }
        ExportContent::Mesh {
            mesh,
            world_from_mesh,
            title,
        } => {
            let moved = mesh.transformed(&world_from_mesh);
            write_mesh(to.path()?, &moved, &title, monitor)?;
            return Ok(Exported::file(to, Vec::new()));
        }
        ExportContent::Text(text) => (text, Vec::new()),
        ExportContent::Record(pair) => {
            let pair = pair.measured(monitor)?;
            let record = match_record(&pair.run, &pair.crash, &pair.stamped);
            let text = serde_json::to_string_pretty(&record)
                .map_err(|error| JobError::Failed(error.to_string()))?;
            (text + "\n", record.warnings)
        }
        ExportContent::Report(pair) => {
            let pair = pair.measured(monitor)?;
            let page = report(&pair.run, &pair.crash, &pair.stamped, monitor)?;
            (page, Vec::new())
        }
        ExportContent::Cards(form, pair) => {
            let pair = pair.measured(monitor)?;
            let cards = cards(form, &pair.run, &pair.crash, &pair.stamped)?;
            let error = cards.largest_node_error(pair.stamped.mesh.positions());
            let note = format!("read back: largest node error from rounding {error:.2e}");
            (cards.text, vec![note])
        }
        ExportContent::Deviations {
            crash,
            stamped,
            crash_from_stamped,
        } => {
            let table = node_table(&crash, &stamped, &crash_from_stamped, monitor)?;
            (table, Vec::new())
        }
    };
    match &to {
        Destination::File(path) => {
            write_bytes(path, text.as_bytes())?;
            Ok(Exported::file(to, notes))
        }
        Destination::Clipboard(_) => Ok(Exported {
            to,
            text: Some(text),
            notes,
        }),
    }
}

impl Exported {
    fn file(to: Destination, notes: Vec<String>) -> Self {
        Self {
            to,
            text: None,
            notes,
        }
    }
}

impl Destination {
    fn path(&self) -> Result<&Path, JobError> {
        match self {
            Self::File(path) => Ok(path),
            Self::Clipboard(what) => {
                let text = format!("{what} is no text that could be copied; write it to a file");
                Err(JobError::Failed(text))
            }
        }
    }
}

impl MatchedPair {
    /// With the chosen pose as the result of the run.
    fn measured(mut self, monitor: &Monitor) -> Result<Self, PipelineError> {
        if let Some(index) = self.alternative.take() {
            let run = with_alternative(&self.run, index, &self.crash, &self.stamped, monitor)?;
            self.run = Arc::new(run);
        }
        Ok(self)
    }
}
