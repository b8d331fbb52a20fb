//! A field for paths: the proposal is selected, Tab completes, `~` is the user's own folder, `file:` addresses are
//! taken.

use std::path::{MAIN_SEPARATOR, PathBuf};

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Modifiers, ScrollArea, TextEdit, Ui};

use super::file_uri;
use super::widgets::text_border;
use crate::text::without_error_number;

/// Most names that are listed.
const MAX_NAMES: usize = 200;

/// What was done in the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct FieldAnswer {
    /// Enter was pressed.
    pub is_entered: bool,
    /// Tab was pressed.
    pub wants_completion: bool,
}

/// Where the caret is put once the text was set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Caret {
    /// Where it is.
    #[default]
    Kept,
    /// The text is a proposal and selected as a whole: typing replaces it.
    OverAll,
    /// Typing goes on with the text.
    AtEnd,
}

/// The field.
pub(super) fn field_ui(ui: &mut Ui, text: &mut String, caret: &mut Caret) -> FieldAnswer {
    let id = ui.make_persistent_id("path");
    let caret = std::mem::take(caret);
    if caret == Caret::AtEnd {
        // Before the field takes the keys of this frame.
        let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
        let end = CCursorRange::one(CCursor::new(text.chars().count()));
        state.cursor.set_char_range(Some(end));
        state.store(ui.ctx(), id);
    }
    let has_focus = ui.memory(|memory| memory.has_focus(id));
    // Taken before the field sees it.
    let is_tab = |input: &mut egui::InputState| input.consume_key(Modifiers::NONE, Key::Tab);
    let wants_completion = has_focus && ui.input_mut(is_tab);
    let field = TextEdit::singleline(text)
        .id(id)
        .hint_text("/folder/file.k")
        .desired_width(f32::INFINITY)
        // Tab stays here instead of going to the next widget.
        .lock_focus(true)
        .margin(egui::Margin::symmetric(8, 4));
    let mut shown = field.show(ui);
    let response = shown
        .response
        .response
        .clone()
        .accessible_name("Path of the file");
    text_border(ui, &response);
    if !response.has_focus() && !response.lost_focus() {
        response.request_focus();
    }
    if caret == Caret::OverAll {
        let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
        shown.state.cursor.set_char_range(Some(all));
        shown.state.store(ui.ctx(), id);
    }
    FieldAnswer {
        is_entered: response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)),
        wants_completion,
    }
}

/// Names to choose from; the one that was clicked.
pub(super) fn names_ui(ui: &mut Ui, names: &[String]) -> Option<String> {
    if names.is_empty() {
        return None;
    }
    let mut chosen = None;
    ScrollArea::vertical().max_height(132.0).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        for name in names {
            let row = egui::Button::new(name)
                .frame_when_inactive(false)
                .truncate();
            if ui.add(row).clicked() {
                chosen = Some(name.clone());
            }
        }
    });
    chosen
}

/// How a typed path goes on.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Completion {
    /// The path as far as it is certain.
    pub text: String,
    /// Names in its folder to choose from, folders with a separator; none if there is no choice left.
    pub names: Vec<String>,
}

impl Completion {
    /// Reads the folder of a typed path; not for the thread that draws.
    pub fn of(typed: &str) -> Self {
        // A pasted address goes on as the path that it means.
        let meant = file_uri::path_of(typed).map(|path| path.display().to_string());
        let typed = meant.as_deref().unwrap_or(typed);
        let (folder, _) = split(typed);
        let folder = if folder.is_empty() { "." } else { folder };
        let entries = std::fs::read_dir(expanded(folder)).into_iter().flatten();
        let named = entries.filter_map(|entry| {
            let entry = entry.ok()?;
            let name = entry.file_name().into_string().ok()?;
            let is_folder = entry.path().is_dir();
            Some(if is_folder {
                format!("{name}{MAIN_SEPARATOR}")
            } else {
                name
            })
        });
        let mut names: Vec<String> = named.collect();
        names.sort();
        Self::among(typed, &names)
    }

    /// The completion of a typed path by names in its folder.
    fn among(typed: &str, names: &[String]) -> Self {
        let (folder, begun) = split(typed);
        let is_hidden = |name: &&String| name.starts_with('.') && !begun.starts_with('.');
        let fitting = names.iter().filter(|name| name.starts_with(begun));
        let fitting: Vec<&String> = fitting.filter(|name| !is_hidden(name)).collect();
        let Some(first) = fitting.first() else {
            return Self {
                text: typed.to_owned(),
                names: Vec::new(),
            };
        };
        let common = fitting.iter().fold(first.as_str(), |common, name| {
            let same = common.char_indices().zip(name.chars());
            let end = same.take_while(|((_, a), b)| a == b).last();
            let end = end.map_or(0, |((at, a), _)| at + a.len_utf8());
            &common[..end]
        });
        let text = format!("{folder}{common}");
        let is_choice = fitting.len() > 1;
        let names = fitting.into_iter().filter(|_| is_choice).take(MAX_NAMES);
        Self {
            text,
            names: names.cloned().collect(),
        }
    }
}

/// A typed path with its last name replaced.
pub(super) fn with_name(typed: &str, name: &str) -> String {
    format!("{}{name}", split(typed).0)
}

/// The folder with its separator, and what was typed of the name.
fn split(typed: &str) -> (&str, &str) {
    let at = typed.rfind(['/', MAIN_SEPARATOR]).map_or(0, |at| at + 1);
    typed.split_at(at)
}

/// A typed path, `~` at its beginning standing for the user's own folder; or the path of a pasted `file:`
/// address.
pub(super) fn expanded(typed: &str) -> PathBuf {
    if let Some(path) = file_uri::path_of(typed) {
        return path;
    }
    let rest = match typed {
        "~" => Some(""),
        _ => typed.strip_prefix("~/"),
    };
    let home = directories::BaseDirs::new().filter(|_| rest.is_some());
    match (home, rest) {
        (Some(home), Some(rest)) => home.home_dir().join(rest),
        _ => PathBuf::from(typed),
    }
}

/// An error of the system without its number.
pub(super) fn plain_words(error: &std::io::Error) -> String {
    without_error_number(&error.to_string()).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn completed(typed: &str) -> (String, Vec<String>) {
        let names = [
            ".hidden",
            "car_floor.k",
            "car_roof.k",
            "deck/",
            "öl.k",
            "ölwanne.k",
        ];
        let names: Vec<String> = names.map(str::to_owned).to_vec();
        let Completion { text, names } = Completion::among(typed, &names);
        (text, names)
    }

    #[test]
    fn a_path_goes_on_as_far_as_it_is_certain() {
        assert_eq!(completed("/a/d"), ("/a/deck/".to_owned(), vec![]));
        let (text, names) = completed("/a/c");
        assert_eq!(text, "/a/car_");
        assert_eq!(names, ["car_floor.k", "car_roof.k"]);
        assert_eq!(completed("x"), ("x".to_owned(), vec![]));
        assert_eq!(completed("ö").0, "öl");
        assert_eq!(completed("/a/.").0, "/a/.hidden");
        assert_eq!(completed("").1.len(), 5);
        assert_eq!(with_name("/a/c", "car_roof.k"), "/a/car_roof.k");
    }

    #[test]
    fn a_folder_is_read_and_the_own_folder_has_a_short_name() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("part.k"), "").unwrap();
        let typed = format!("{}{MAIN_SEPARATOR}pa", folder.path().display());
        let found = Completion::of(&typed);
        assert_eq!(
            found.text,
            folder.path().join("part.k").display().to_string()
        );
        // So is one that was pasted as an address.
        let pasted = format!("file://localhost{}", typed.replace('p', "%70"));
        if cfg!(unix) {
            assert_eq!(Completion::of(&pasted), found);
            assert_eq!(expanded(&pasted), PathBuf::from(&typed));
        }
        assert_eq!(expanded("/~/a"), PathBuf::from("/~/a"));
        if let Some(home) = directories::BaseDirs::new() {
            assert_eq!(expanded("~/a/b.k"), home.home_dir().join("a/b.k"));
        }
    }

    #[test]
    fn errors_are_told_without_their_number() {
        let error = std::io::Error::from_raw_os_error(13);
        assert_eq!(plain_words(&error), "permission denied");
    }
}
