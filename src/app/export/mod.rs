//! Which exports are possible now, and what is asked before them.

mod apply;
mod command;
mod command_line;
mod picture;

use std::path::PathBuf;

pub use command::ExportCommand;
pub use picture::{PictureChoice, PicturePlace, PictureSize, PictureWindows};

use super::{AppState, Document, Reason};
use crate::pipeline::outputs::{Needs, Output};
use crate::report::{CardForm, MatrixForm};
use crate::role::Role;

/// What "Copy" puts on the clipboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CopyForm {
    /// The matrix in one of its forms.
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

    /// `Ok` if it can be copied now: cards need a match.
    pub fn enabled(self, state: &AppState) -> Result<(), Reason> {
        match self {
            Self::Matrix(_) => state.document.has_part(Role::Stamped)?,
            Self::Cards(_) => state.document.has_result()?,
        }
        state.shows_its_pose()
    }
}

impl Document {
    /// True if there is what an output needs.
    pub fn can_write(&self, output: Output) -> bool {
        match output.needs() {
            Needs::Window => true,
            Needs::Part(role) => self.part(role).is_some(),
            Needs::ReducedPart(role) => {
                let part = self.part(role);
                part.is_some_and(|part| part.level.is_some())
            }
            Needs::BothParts => self.both().is_some(),
            Needs::Match => self.has_result().is_ok(),
            Needs::Mapping => self.current_mapping().is_some(),
        }
    }

    /// The files of all parts with their includes, which no output may overwrite.
    pub fn files(&self) -> Vec<PathBuf> {
        let crash = self.part(Role::Crash).map(|part| &part.loaded);
        let parts = crash.into_iter().chain(self.all_stamped());
        parts.flat_map(|part| part.files()).collect()
    }

    /// A path to start from, made of the part's file and beside it.
    pub(in crate::app) fn suggested_path(&self, output: Output) -> PathBuf {
        let role = output.named_after();
        let part = self.part(role);
        let name = output.default_name(part.map(|part| part.loaded.file_name()).as_deref());
        self.beside_part(role, &name)
    }

    /// A name in the folder of a part's file; an example lies in none.
    fn beside_part(&self, role: Role, name: &str) -> PathBuf {
        let part = self.part(role).or(self.part(role.other()));
        let folder = part.and_then(|part| part.loaded.path.parent());
        folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
    }
}

impl AppState {
    /// The form that was copied last, or the matrix by rows where that is not possible now.
    pub fn copy_form(&self) -> CopyForm {
        let last = self.settings.matrix_form.as_deref();
        let mut known = CopyForm::all().filter(|form| form.enabled(self).is_ok());
        let found = known.find(|form| Some(form.name()) == last);
        found.unwrap_or(CopyForm::Matrix(MatrixForm::Rows))
    }
}
