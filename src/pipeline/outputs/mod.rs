//! Everything the program can hand over as a file: one list for the command line and the window.
//!
//! [`Output`] says of each what it is called, which file extensions it has, what it needs, and
//! makes its bytes. Where files may go is checked by [`check_targets`] before any work begins.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::PipelineError;
use super::load::LoadedPart;
use super::map::{MapRun, OtherResult, WriteKind, elements_path};
use super::match_parts::{MatchRun, with_alternative};
use super::units::{PairUnits, scaled_pose};
use super::write_file::{write_file_unless_cancelled, write_files_unless_cancelled};
use crate::formats::Format;
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::report::{CardForm, MatrixForm};
use crate::role::{PerRole, Role};

pub mod cards;
mod check;
pub mod deck;
mod mapped;
pub mod node_table;
pub mod record;
pub mod report;
pub(super) mod report_figures;

pub use check::{Content, Refusal, Target, check_targets, overwritten_inputs};

/// A mesh or deck that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshOutput {
    /// The stamped part, moved onto the crash part; as a deck with its ids and forming results.
    Moved,
    /// The same at its level of reduction, as a mesh.
    MovedReduced,
    /// The stamped part where its file has it, in the unit of the crash part.
    Converted,
    /// The crash part.
    Crash,
    /// The crash part at its level of reduction, as a mesh.
    CrashReduced,
}

impl MeshOutput {
    /// All, in the order of the menu.
    pub const ALL: [Self; 5] = [
        Self::Moved,
        Self::MovedReduced,
        Self::Converted,
        Self::Crash,
        Self::CrashReduced,
    ];

    /// Name in the menu.
    pub fn label(self) -> &'static str {
        match self {
            Self::Moved => "Stamped part, moved…",
            Self::MovedReduced => "Stamped part, moved and reduced…",
            Self::Converted => "Stamped part in the crash part's unit…",
            Self::Crash => "Crash part…",
            Self::CrashReduced => "Crash part, reduced…",
        }
    }

    /// Whose it is.
    pub fn role(self) -> Role {
        match self {
            Self::Moved | Self::MovedReduced | Self::Converted => Role::Stamped,
            Self::Crash | Self::CrashReduced => Role::Crash,
        }
    }

    /// True if it is the mesh at its level of reduction.
    pub fn is_reduced(self) -> bool {
        matches!(self, Self::MovedReduced | Self::CrashReduced)
    }

    /// True if it lies where the match puts it.
    fn is_moved(self) -> bool {
        matches!(self, Self::Moved | Self::MovedReduced)
    }
}

/// What can be written to a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// The matrix as text.
    Matrix(MatrixForm),
    /// The whole record of the match as JSON.
    Record,
    /// The report of the match as HTML.
    Report,
    /// The distances of all nodes as CSV.
    Deviations,
    /// LS-DYNA cards.
    Cards(CardForm),
    /// A mesh; the extension of the name chooses its format.
    Mesh(MeshOutput),
    /// The mapped results as a deck.
    Mapped(WriteKind),
    /// The report of the mapping as HTML.
    MapReport,
    /// Status and values of every mapped element as CSV.
    MapTable,
    /// A picture of the 3D windows, which the window draws.
    Picture,
    /// The log of the window as text.
    Log,
}

/// What an output cannot do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// The picture of a window.
    Window,
    /// A loaded part.
    Part(Role),
    /// A part at a level of reduction.
    ReducedPart(Role),
    /// Two loaded parts.
    BothParts,
    /// A match of both parts.
    Match,
    /// A mapping of the forming results.
    Mapping,
}

/// What outputs are made from.
#[derive(Debug, Clone, Default)]
pub struct OutputInput {
    /// The loaded parts.
    pub parts: PerRole<Option<Arc<LoadedPart>>>,
    /// Where the stamped part lies.
    pub crash_from_stamped: Similarity,
    /// The match that gave this pose.
    pub run: Option<Arc<MatchRun>>,
    /// The alternative that is shown instead of the best pose; it is measured anew.
    pub alternative: Option<usize>,
    /// The meshes at their levels of reduction.
    pub reduced: PerRole<Option<Arc<TriMesh>>>,
    /// The mapping of the forming results at this pose.
    pub mapping: Option<Arc<MapRun>>,
    /// The stamped parts that it was made from beside the loaded one.
    pub further_stamped: Vec<Arc<LoadedPart>>,
    /// Ids of the crash elements that the report of the mapping tells of one by one.
    pub pins: Vec<u64>,
    /// Another mapper's result that stands beside it.
    pub other: Option<Arc<OtherResult>>,
    /// The text of the log.
    pub log: String,
}

/// An output ready to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Made {
    /// What the file holds.
    pub bytes: Vec<u8>,
    /// What was found out on the way, a sentence each.
    pub notes: Vec<String>,
}

const DECK: (&str, &str) = ("LS-DYNA keyword", "k");
const STL: (&str, &str) = ("STL", "stl");
const PLY: (&str, &str) = ("PLY", "ply");
const OBJ: (&str, &str) = ("Wavefront OBJ", "obj");

impl Output {
    /// Every output, in the order of the menus.
    pub const ALL: &[Self] = &[
        Self::Record,
        Self::Matrix(MatrixForm::Rows),
        Self::Matrix(MatrixForm::Columns),
        Self::Matrix(MatrixForm::Inverse),
        Self::Matrix(MatrixForm::Csv),
        Self::Matrix(MatrixForm::Quaternion),
        Self::Matrix(MatrixForm::Json),
        Self::Mesh(MeshOutput::Moved),
        Self::Mesh(MeshOutput::MovedReduced),
        Self::Mesh(MeshOutput::Converted),
        Self::Mesh(MeshOutput::Crash),
        Self::Mesh(MeshOutput::CrashReduced),
        Self::Deviations,
        Self::Report,
        Self::Cards(CardForm::StampedPart),
        Self::Cards(CardForm::StampedPartInverse),
        Self::Cards(CardForm::IncludeTransform),
        Self::Mapped(WriteKind::Deck),
        Self::Mapped(WriteKind::Part),
        Self::Mapped(WriteKind::Include),
        Self::MapReport,
        Self::MapTable,
        Self::Picture,
        Self::Log,
    ];

    /// What it is, for lists and messages.
    pub fn label(self) -> &'static str {
        match self {
            Self::Matrix(form) => form.label(),
            Self::Record => "Record as JSON",
            Self::Report => "Report as HTML",
            Self::Deviations => "Distances of all nodes as CSV",
            Self::Cards(form) => form.label(),
            Self::Mesh(mesh) => mesh.label(),
            Self::Mapped(WriteKind::Deck) => "Crash deck with mapped results",
            Self::Mapped(WriteKind::Part) => "Crash part with mapped results",
            Self::Mapped(WriteKind::Include) => "Mapped results as an include",
            Self::MapReport => "Mapping report as HTML",
            Self::MapTable => "Mapped elements as CSV",
            Self::Picture => "Image",
            Self::Log => "Log",
        }
    }

    /// The option of the command line that writes it; `None` where only the window does.
    pub fn option(self) -> Option<&'static str> {
        match self {
            Self::Matrix(_) => Some("--matrix"),
            Self::Record => Some("--json"),
            Self::Report => Some("--report"),
            Self::Deviations => Some("--deviations"),
            Self::Cards(_) => Some("--cards"),
            Self::Mesh(MeshOutput::Moved) => Some("--moved"),
            Self::Mesh(MeshOutput::Converted) => Some("--converted"),
            Self::Mesh(MeshOutput::Crash) => Some("--crash-mesh"),
            Self::Mesh(MeshOutput::MovedReduced | MeshOutput::CrashReduced)
            | Self::Mapped(_)
            | Self::MapReport
            | Self::MapTable
            | Self::Picture
            | Self::Log => None,
        }
    }

    /// File extensions it may have, the usual one first, with a name for each.
    pub fn extensions(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Matrix(MatrixForm::Json) | Self::Record => &[("JSON", "json")],
            Self::Matrix(MatrixForm::Csv) | Self::Deviations | Self::MapTable => &[("CSV", "csv")],
            Self::Matrix(_) | Self::Log => &[("Text", "txt")],
            Self::Report | Self::MapReport => &[("HTML", "html")],
            Self::Cards(_) | Self::Mapped(_) => &[DECK],
            Self::Mesh(mesh) if mesh.is_reduced() => &[STL, PLY, OBJ, DECK],
            Self::Mesh(_) => &[DECK, STL, PLY, OBJ],
            Self::Picture => &[("PNG", "png")],
        }
    }

    /// What it cannot do without.
    pub fn needs(self) -> Needs {
        match self {
            Self::Matrix(_) => Needs::Part(Role::Stamped),
            Self::Record | Self::Report | Self::Cards(_) => Needs::Match,
            Self::Deviations => Needs::BothParts,
            Self::Mesh(mesh) if mesh.is_reduced() => Needs::ReducedPart(mesh.role()),
            Self::Mesh(mesh) => Needs::Part(mesh.role()),
            Self::Mapped(_) | Self::MapReport | Self::MapTable => Needs::Mapping,
            Self::Picture | Self::Log => Needs::Window,
        }
    }

    /// What its name has to follow.
    pub fn content(self) -> Content {
        match self {
            Self::Cards(_) | Self::Mapped(_) => Content::Deck,
            Self::Mesh(_) => Content::Mesh,
            _ => Content::Text,
        }
    }

    /// The file that is written beside the one at `path`, where there may be one.
    pub fn file_beside(self, path: &Path) -> Option<PathBuf> {
        let has_one = self == Self::Mapped(WriteKind::Include);
        has_one.then(|| elements_path(path))
    }

    /// The path with the usual extension if it has none.
    pub fn with_extension(self, path: PathBuf) -> PathBuf {
        if path.extension().is_some() {
            return path;
        }
        let (_, extension) = self.extensions()[0];
        path.with_extension(extension)
    }

    /// The part whose file gives the name.
    pub fn named_after(self) -> Role {
        match self {
            Self::Mesh(mesh) => mesh.role(),
            Self::Mapped(_) => Role::Crash,
            _ => Role::Stamped,
        }
    }

    /// A file name to start from: that of the part's file with what it is.
    pub fn default_name(self, part_file: Option<&str>) -> String {
        let (_, extension) = self.extensions()[0];
        let what = match self {
            Self::Matrix(_) => "matrix",
            Self::Record => "match",
            Self::Report => "report",
            Self::Deviations => "deviations",
            Self::Cards(CardForm::IncludeTransform) => "transform",
            Self::Cards(_) => "include",
            Self::Mesh(MeshOutput::Moved) => "moved",
            Self::Mesh(MeshOutput::MovedReduced) => "moved_reduced",
            Self::Mesh(MeshOutput::Converted) => "converted",
            Self::Mesh(MeshOutput::Crash) => "copy",
            Self::Mesh(MeshOutput::CrashReduced) => "reduced",
            Self::Mapped(WriteKind::Deck) => "mapped",
            Self::Mapped(WriteKind::Part) => "mapped_part",
            Self::Mapped(WriteKind::Include) => "mapped_include",
            Self::MapReport => "mapping",
            Self::MapTable => "mapped_elements",
            Self::Picture => "picture",
            Self::Log => "log",
        };
        match part_file {
            Some(name) => format!("{}_{what}.{extension}", stem(name)),
            None => format!("{what}.{extension}"),
        }
    }

    /// Makes the bytes. `format` is that of a mesh; other outputs have but one.
    pub fn make(
        self,
        input: &OutputInput,
        format: Option<Format>,
        monitor: &Monitor,
    ) -> Result<Made, PipelineError> {
        self.make_in(input, format, None, monitor)
    }

    /// The same for a file that will stand in `folder`.
    pub fn make_in(
        self,
        input: &OutputInput,
        format: Option<Format>,
        folder: Option<&Path>,
        monitor: &Monitor,
    ) -> Result<Made, PipelineError> {
        let pose = &input.crash_from_stamped;
        let (text, notes) = match self {
            Self::Matrix(form) => {
                let units = input.both().map(PairUnits::sentences).unwrap_or_default();
                (form.write_with(pose, &units), Vec::new())
            }
            Self::Record => {
                let (run, parts) = input.matched(monitor)?;
                let record = record::match_record(&run, parts);
                (json_text(&record)?, record.warnings)
            }
            Self::Report => {
                let (run, parts) = input.matched(monitor)?;
                (report::report(&run, parts, monitor)?, Vec::new())
            }
            Self::Deviations => {
                let parts = input.both().ok_or(PipelineError::Lacks("both parts"))?;
                // An alternative has none of its own.
                let run = input.run.as_ref().filter(|_| input.alternative.is_none());
                let stated = run.and_then(|run| run.assessment.uncertainty());
                let table = node_table::node_table(parts, pose, stated, monitor)?;
                (table, Vec::new())
            }
            Self::Cards(form) => {
                let (run, parts) = input.matched(monitor)?;
                let cards = cards::cards(form, &run, parts, folder)?;
                let notes = cards::notes(form, &run, parts, &cards);
                (cards.text, notes)
            }
            Self::Mesh(mesh) => {
                let format = format.ok_or(PipelineError::Lacks("a mesh format"))?;
                let bytes = mesh.make(input, format, monitor)?;
                let part = input.parts.get(mesh.role()).as_deref();
                let of_deck = part.filter(|_| format == Format::Keyword);
                let lacks = if mesh.is_reduced() {
                    deck::reduced_lacks
                } else {
                    deck::left_out
                };
                let moves = of_deck.filter(|_| mesh.is_moved());
                let scale = input.crash_from_stamped.scale;
                let scaled = moves.and_then(|part| scaled_pose(part, scale));
                let notes = of_deck.and_then(lacks).into_iter().chain(scaled).collect();
                return Ok(Made { bytes, notes });
            }
            Self::Mapped(kind) => return mapped::deck(kind, input, monitor),
            Self::MapReport => (mapped::report(input, monitor)?, Vec::new()),
            Self::MapTable => (mapped::table(input, monitor)?, Vec::new()),
            Self::Log => (input.log.clone(), Vec::new()),
            Self::Picture => return Err(PipelineError::Lacks("a window")),
        };
        let bytes = text.into_bytes();
        Ok(Made { bytes, notes })
    }

    /// Makes it and writes it to a file, whole or not at all; returns what was found out. An include of
    /// mapped results has a second file beside it, [`Output::file_beside`].
    pub fn write(
        self,
        input: &OutputInput,
        path: &Path,
        monitor: &Monitor,
    ) -> Result<Vec<String>, PipelineError> {
        let format = match self {
            Self::Mesh(_) => Some(deck::format_of(path)?),
            Self::Mapped(kind) => {
                let made = mapped::deck_files(kind, input, path, monitor)?;
                let files = made.files.iter();
                let files: Vec<_> = files.map(|file| (&*file.path, &*file.bytes)).collect();
                write_files_unless_cancelled(&files, monitor)?;
                let beside = made.files.iter().skip(1).map(mapped::note_beside);
                return Ok([mapped::note(&made)].into_iter().chain(beside).collect());
            }
            _ => None,
        };
        let made = self.make_in(input, format, path.parent(), monitor)?;
        write_file_unless_cancelled(path, &made.bytes, monitor)?;
        Ok(made.notes)
    }

    /// What can be known before a match: that the cards can hold it.
    pub fn check(self, parts: PerRole<&LoadedPart>) -> Result<(), PipelineError> {
        match self {
            Self::Cards(form) => cards::check(form, parts),
            _ => Ok(()),
        }
    }
}

impl MeshOutput {
    fn make(
        self,
        input: &OutputInput,
        format: Format,
        monitor: &Monitor,
    ) -> Result<Vec<u8>, PipelineError> {
        let role = self.role();
        let part = input.parts.get(role).as_deref();
        let part = part.ok_or(PipelineError::Lacks("the part"))?;
        let pose = if self.is_moved() {
            input.crash_from_stamped
        } else {
            Similarity::identity()
        };
        if self.is_reduced() {
            let mesh = input.reduced.get(role).as_deref();
            let mesh = mesh.ok_or(PipelineError::Lacks("a level of reduction"))?;
            return deck::reduced_bytes(format, part, mesh, &pose, monitor);
        }
        let units = PairUnits::of(input.parts.as_ref().map(Option::as_deref));
        let lines = deck::head_lines(part, &units);
        deck::part_bytes(format, part, &pose, &lines, monitor)
    }
}

impl OutputInput {
    /// Both parts, where both are there.
    fn both(&self) -> Option<PerRole<&LoadedPart>> {
        self.parts.as_ref().map(Option::as_deref).all()
    }

    /// The match with the chosen pose as its result, and its parts.
    fn matched(
        &self,
        monitor: &Monitor,
    ) -> Result<(Arc<MatchRun>, PerRole<&LoadedPart>), PipelineError> {
        let parts = self.both().ok_or(PipelineError::Lacks("both parts"))?;
        let run = self.run.as_ref().ok_or(PipelineError::Lacks("a match"))?;
        let run = match self.alternative {
            Some(index) => Arc::new(with_alternative(run, index, parts, monitor)?),
            None => Arc::clone(run),
        };
        Ok((run, parts))
    }

    /// The files that the parts were read from, with all their includes.
    pub fn files(&self) -> Vec<PathBuf> {
        let parts = self.parts.iter().filter_map(|(_, part)| part.as_deref());
        let further = self.further_stamped.iter().map(|part| &**part);
        parts.chain(further).flat_map(LoadedPart::files).collect()
    }
}

/// A record as the text of a file.
pub fn json_text(record: &impl serde::Serialize) -> Result<String, PipelineError> {
    let text = serde_json::to_string_pretty(record);
    Ok(text.map_err(|error| PipelineError::Json(error.to_string()))? + "\n")
}

/// A file name without its extensions: "bp.dynain.gz" is "bp".
pub fn stem(name: &str) -> &str {
    match name.find('.') {
        Some(at) if at > 0 => &name[..at],
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_holds_every_form_once() {
        let all = Output::ALL;
        for (i, output) in all.iter().enumerate() {
            assert!(!all[..i].contains(output), "{output:?} stands twice");
            assert!(!output.label().is_empty() && !output.extensions().is_empty());
            let name = output.default_name(Some("bp.dynain.gz"));
            assert!(name.starts_with("bp_"), "{name}");
            assert_eq!(output.with_extension(name.clone().into()), Path::new(&name));
        }
        let matrices = MatrixForm::ALL.iter().copied().map(Output::Matrix);
        let cards = CardForm::ALL.iter().copied().map(Output::Cards);
        let meshes = MeshOutput::ALL.into_iter().map(Output::Mesh);
        let mut forms = matrices.chain(cards).chain(meshes);
        assert!(forms.all(|output| all.contains(&output)));
    }

    #[test]
    fn what_is_lacking_is_named() {
        let input = OutputInput::default();
        for &output in Output::ALL {
            let made = output.make(&input, Some(Format::Stl), &Monitor::silent());
            let is_text = matches!(output, Output::Matrix(_) | Output::Log);
            assert_eq!(made.is_ok(), is_text, "{output:?}");
        }
    }
}
