use super::AppState;
use crate::jobs::Role;
use crate::report::{CardForm, MatrixForm};
use std::path::PathBuf;

/// A mesh or deck that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshExport {
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

impl MeshExport {
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

    /// True if there is something to write.
    pub fn is_possible(self, state: &AppState) -> bool {
        let part = state.document.part(self.role());
        part.is_some_and(|part| part.level.is_some() || !self.is_reduced())
    }
}

/// What can be written to a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportKind {
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
    /// A mesh; the ending of the name chooses its format.
    Mesh(MeshExport),
    /// The log as text.
    Log,
}

impl ExportKind {
    /// Endings a name may have, the usual one first, with a name for each.
    pub fn endings(self) -> &'static [(&'static str, &'static str)] {
        const DECK: (&str, &str) = ("LS-DYNA keyword", "k");
        const MESHES: [(&str, &str); 3] =
            [("STL", "stl"), ("PLY", "ply"), ("Wavefront OBJ", "obj")];
        match self {
            Self::Matrix(MatrixForm::Json) | Self::Record => &[("JSON", "json")],
            Self::Matrix(MatrixForm::Csv) | Self::Deviations => &[("CSV", "csv")],
            Self::Matrix(_) | Self::Log => &[("Text", "txt")],
            Self::Report => &[("HTML", "html")],
            Self::Cards(_) => &[DECK],
            Self::Mesh(mesh) if mesh.is_reduced() => &[MESHES[0], MESHES[1], MESHES[2], DECK],
            Self::Mesh(_) => &[DECK, MESHES[0], MESHES[1], MESHES[2]],
        }
    }

    /// A name without an ending gets the usual one.
    pub fn with_ending(self, path: PathBuf) -> PathBuf {
        if path.extension().is_some() {
            return path;
        }
        let (_, ending) = self.endings()[0];
        path.with_extension(ending)
    }

    /// A file name to start from, made of the name of the part's file.
    pub fn suggested_name(self, state: &AppState) -> String {
        let role = match self {
            Self::Mesh(mesh) => mesh.role(),
            _ => Role::Stamped,
        };
        let (_, ending) = self.endings()[0];
        let what = match self {
            Self::Matrix(_) => "matrix",
            Self::Record => "match",
            Self::Report => "report",
            Self::Deviations => "deviations",
            Self::Cards(CardForm::IncludeTransform) => "transform",
            Self::Cards(_) => "include",
            Self::Mesh(MeshExport::Moved) => "moved",
            Self::Mesh(MeshExport::MovedReduced) => "moved_reduced",
            Self::Mesh(MeshExport::Converted) => "converted",
            Self::Mesh(MeshExport::Crash) => "copy",
            Self::Mesh(MeshExport::CrashReduced) => "reduced",
            Self::Log => "log",
        };
        match state.document.part(role) {
            Some(part) => format!("{}_{what}.{ending}", stem(&part.loaded.file_name())),
            None => format!("{what}.{ending}"),
        }
    }
}

/// A file name without its endings: "bp.dynain.gz" is "bp".
pub(super) fn stem(name: &str) -> &str {
    match name.find('.') {
        Some(at) if at > 0 => &name[..at],
        _ => name,
    }
}

/// What "Copy" puts on the clipboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CopyForm {
    /// The matrix.
    Matrix(MatrixForm),
    /// LS-DYNA cards.
    Cards(CardForm),
}

impl CopyForm {
    /// All, in the order of the menu.
    pub fn all() -> impl Iterator<Item = Self> {
        let matrices = MatrixForm::ALL.iter().copied().map(Self::Matrix);
        let cards = [CardForm::StampedPart, CardForm::IncludeTransform];
        matrices.chain(cards.map(Self::Cards))
    }

    /// Name in the menu.
    pub fn label(self) -> &'static str {
        match self {
            Self::Matrix(form) => form.label(),
            Self::Cards(CardForm::IncludeTransform) => "Transformation cards",
            Self::Cards(_) => "Include card",
        }
    }

    /// The word under which the last choice is kept.
    pub fn name(self) -> &'static str {
        match self {
            Self::Matrix(form) => form.name(),
            Self::Cards(form) => form.name(),
        }
    }

    /// True if it can be copied now: cards need a match.
    pub fn is_possible(self, state: &AppState) -> bool {
        match self {
            Self::Matrix(_) => state.document.part(Role::Stamped).is_some(),
            Self::Cards(_) => state.document.current_result().is_some(),
        }
    }
}

impl AppState {
    /// The form that was copied last, or the matrix by rows where that is not possible now.
    pub fn copy_form(&self) -> CopyForm {
        let last = self.settings.matrix_form.as_deref();
        let mut known = CopyForm::all().filter(|form| form.is_possible(self));
        let found = known.find(|form| Some(form.name()) == last);
        found.unwrap_or(CopyForm::Matrix(MatrixForm::Rows))
    }
}
