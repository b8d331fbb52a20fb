//! The desktop's own file dialog for a question.

use std::future::Future;

use super::question::{Question, titles};
use crate::formats::Format;
use crate::pipeline::project::EXTENSION;

/// The dialog; it opens when the future is waited for.
pub(super) fn file_dialog(
    question: &Question,
) -> impl Future<Output = Option<rfd::FileHandle>> + Send + use<> {
    let (title, _) = titles(question);
    let mut dialog = rfd::AsyncFileDialog::new().set_title(title);
    match question {
        Question::OpenProject => dialog = dialog.add_filter("Project", &[EXTENSION]),
        Question::SaveProject(_) => dialog = dialog.add_filter("Project", &[EXTENSION]),
        Question::OtherMapping => {
            let keyword = Format::Keyword;
            dialog = dialog.add_filter(keyword.label(), keyword.extensions());
            dialog = dialog.add_filter("All files", &["*"]);
        }
        Question::Open(_) | Question::Locate(_) | Question::Further => {
            let all: Vec<&str> = Format::ALL
                .iter()
                .flat_map(|f| f.extensions())
                .copied()
                .collect();
            dialog = dialog.add_filter("All formats", &all);
            for format in Format::ALL {
                dialog = dialog.add_filter(format.label(), format.extensions());
            }
            dialog = dialog.add_filter("All files", &["*"]);
        }
        Question::Save { kind, .. } => {
            for (label, ending) in kind.extensions() {
                dialog = dialog.add_filter(*label, &[*ending]);
            }
        }
        Question::Picture { .. } => dialog = dialog.add_filter("PNG", &["png"]),
    }
    if let Some(path) = question.suggestion() {
        if let Some(name) = path.file_name() {
            dialog = dialog.set_file_name(name.to_string_lossy());
        }
        if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
    }
    let is_open = question.is_open();
    async move {
        if is_open {
            dialog.pick_file().await
        } else {
            dialog.save_file().await
        }
    }
}
