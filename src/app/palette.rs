//! What the command search offers: every action, recent files, every form of matrix and card.

use super::{
    Action, AppState, Command, CopyForm, ExportCommand, ExportKind, FileCommand, MeshExport,
    ProjectCommand, Settings,
};
use crate::report::{CardForm, MatrixForm};
use std::path::Path;

/// Commands that are remembered as used last.
const MAX_RECENT: usize = 6;

/// What an entry does.
#[derive(Debug, Clone)]
enum Does {
    Action(Action),
    Command(Box<Command>),
}

/// One line of the command search.
#[derive(Debug, Clone)]
pub struct PaletteEntry {
    /// What is shown and searched.
    pub label: String,
    /// Where it belongs: the menu, or what kind of file.
    pub group: &'static str,
    /// What it does, in a sentence; searched too.
    pub help: String,
    /// Its key.
    pub keys: String,
    /// Why it is not possible now.
    pub reason: Option<&'static str>,
    /// True if it was used lately.
    pub is_recent: bool,
    does: Does,
}

impl PaletteEntry {
    /// The action it stands for, if it is one.
    pub fn action(&self) -> Option<Action> {
        match self.does {
            Does::Action(action) => Some(action),
            Does::Command(_) => None,
        }
    }

    /// What follows from choosing it: nothing if it is not possible now.
    pub fn commands(&self, state: &AppState) -> Vec<Command> {
        if self.reason.is_some() {
            return Vec::new();
        }
        let mut commands = vec![Command::Settings(Box::new(remembered(
            &state.settings,
            &self.label,
        )))];
        match &self.does {
            Does::Action(action) => commands.extend(action.to_commands(state)),
            Does::Command(command) => commands.push(Command::clone(command)),
        }
        commands
    }
}

fn remembered(settings: &Settings, label: &str) -> Settings {
    let mut settings = settings.clone();
    settings.recent_commands.retain(|known| known != label);
    settings.recent_commands.insert(0, label.to_owned());
    settings.recent_commands.truncate(MAX_RECENT);
    settings
}

impl AppState {
    /// The entries that fit what was typed, the best first. Without text those used last come
    /// first, then all others in the order of the menus.
    pub fn palette(&self, typed: &str) -> Vec<PaletteEntry> {
        let mut found: Vec<(f64, PaletteEntry)> = self
            .palette_entries()
            .into_iter()
            .filter_map(|entry| Some((score(&entry, typed)?, entry)))
            .collect();
        let recent = &self.settings.recent_commands;
        let rank = |entry: &PaletteEntry| {
            let place = recent.iter().position(|label| *label == entry.label);
            place.unwrap_or(usize::MAX)
        };
        for (_, entry) in &mut found {
            entry.is_recent = rank(entry) != usize::MAX;
        }
        if typed.trim().is_empty() {
            found.sort_by_key(|(_, entry)| rank(entry));
        } else {
            found.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank(&a.1).cmp(&rank(&b.1))));
        }
        found.into_iter().map(|(_, entry)| entry).collect()
    }

    fn palette_entries(&self) -> Vec<PaletteEntry> {
        let mut entries: Vec<PaletteEntry> =
            Action::ALL.iter().map(|a| self.action_entry(*a)).collect();
        let why = |action: Action| action.enabled(self).err().map(|reason| reason.0);
        let (no_part, no_match) = (why(Action::CopyMatrix), why(Action::SaveCards));
        for form in CopyForm::all() {
            let reason = if form.is_possible(self) {
                None
            } else {
                no_part.or(no_match)
            };
            let label = format!("Copy: {}", form.label());
            entries.push(export(label, ExportCommand::Copy(form), reason));
        }
        for form in MatrixForm::ALL {
            let label = format!("Save matrix: {}…", form.label());
            entries.push(write(label, ExportKind::Matrix(*form), no_part));
        }
        for form in CardForm::ALL {
            let label = format!("Save cards: {}…", form.label());
            entries.push(write(label, ExportKind::Cards(*form), no_match));
        }
        for mesh in MeshExport::ALL {
            let is_possible = mesh.is_possible(self);
            let reason = (!is_possible).then_some("there is no such mesh yet");
            entries.push(write(
                format!("Save: {}", mesh.label()),
                ExportKind::Mesh(mesh),
                reason,
            ));
        }
        let locked = why(Action::OpenExample);
        let recent = self.settings.recent.iter();
        entries.extend(recent.map(|path| file("Open", path, locked)));
        let works = self.project.kept_works.iter().map(|work| PaletteEntry {
            label: format!("Restore {}", work.title),
            does: does(ProjectCommand::Restore(work.path.clone())),
            ..file("Restore", &work.path, locked)
        });
        entries.extend(works);
        entries
    }

    fn action_entry(&self, action: Action) -> PaletteEntry {
        let info = action.info();
        PaletteEntry {
            label: info.label.to_owned(),
            group: info.menu.label(),
            help: info.tooltip.to_owned(),
            keys: info.shortcut.map_or_else(String::new, |s| s.to_string()),
            reason: action.enabled(self).err().map(|reason| reason.0),
            is_recent: false,
            does: Does::Action(action),
        }
    }
}

fn does(command: impl Into<Command>) -> Does {
    Does::Command(Box::new(command.into()))
}

fn export(label: String, command: ExportCommand, reason: Option<&'static str>) -> PaletteEntry {
    PaletteEntry {
        label,
        group: "Export",
        help: String::new(),
        keys: String::new(),
        reason,
        is_recent: false,
        does: does(command),
    }
}

fn write(label: String, kind: ExportKind, reason: Option<&'static str>) -> PaletteEntry {
    export(label, ExportCommand::AskSave(kind), reason)
}

fn file(verb: &str, path: &Path, reason: Option<&'static str>) -> PaletteEntry {
    let name = path.file_name().unwrap_or(path.as_os_str());
    PaletteEntry {
        label: format!("{verb} {}", name.to_string_lossy()),
        group: "Recent",
        help: path.display().to_string(),
        keys: String::new(),
        reason,
        is_recent: false,
        does: does(FileCommand::Open {
            paths: vec![path.to_path_buf()],
            role: None,
        }),
    }
}

/// How well an entry fits; `None` if it does not. Each word has to be found in the label, letter by
/// letter with gaps, or as it stands in the help.
fn score(entry: &PaletteEntry, typed: &str) -> Option<f64> {
    let label = entry.label.to_lowercase();
    let help = entry.help.to_lowercase();
    typed
        .to_lowercase()
        .split_whitespace()
        .try_fold(0.0, |sum, word| {
            let in_help = help.contains(word).then_some(1.5 * word.len() as f64);
            let best = fuzzy(&label, word)
                .into_iter()
                .chain(in_help)
                .reduce(f64::max);
            Some(sum + best?)
        })
}

/// The letters of `word` in their order in `text`: more for letters side by side and for those that
/// begin a word, less for a long text. `None` if a letter is missing.
fn fuzzy(text: &str, word: &str) -> Option<f64> {
    let text: Vec<char> = text.chars().collect();
    let word: Vec<char> = word.chars().collect();
    let starts = (0..text.len()).filter(|&i| text.get(i) == word.first());
    let from = |start: usize| {
        let (mut at, mut sum) = (start, 0.0);
        let mut last = None;
        for letter in &word {
            at += text.get(at..)?.iter().position(|c| c == letter)?;
            let begins = at == 0 || !text[at - 1].is_alphanumeric();
            let follows = last.is_some_and(|last: usize| last + 1 == at);
            sum += 1.0 + f64::from(u8::from(begins)) + 0.8 * f64::from(u8::from(follows));
            if let Some(last) = last.filter(|_| !follows) {
                sum -= 0.05 * (at - last) as f64;
            }
            last = Some(at);
            at += 1;
        }
        Some(sum)
    };
    let best = starts.filter_map(from).reduce(f64::max)?;
    // Letters strewn over the whole text are no find.
    let is_find = best > 0.9 * word.len() as f64;
    is_find.then_some(best - 0.01 * text.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(typed: &str) -> Option<Action> {
        AppState::default().palette(typed).first()?.action()
    }

    #[test]
    fn letters_and_words_find_their_command() {
        assert_eq!(first("undo"), Some(Action::Undo));
        assert_eq!(first("opcr"), Some(Action::OpenCrash));
        assert_eq!(first("save pr"), Some(Action::SaveProject));
        assert_eq!(first("asn"), Some(Action::Align));
        assert_eq!(first("isom"), Some(Action::ViewIsometric));
        assert_eq!(first("theme"), Some(Action::Preferences), "by its help");
        assert!(first("qzxv").is_none());
    }

    #[test]
    fn what_was_used_comes_first_and_is_remembered() {
        let mut state = AppState::default();
        let all = state.palette("");
        assert_eq!(all[0].action(), Some(Action::ALL[0]));
        for label in ["Preferences…", "About"] {
            let entry = state.palette(label).remove(0);
            for command in entry.commands(&state) {
                state.apply(command);
            }
        }
        let labels: Vec<String> = state.palette("").into_iter().map(|e| e.label).collect();
        assert_eq!(labels[..2], ["About", "Preferences…"]);
        let n_about = labels.iter().filter(|label| *label == "About").count();
        assert_eq!(n_about, 1);
    }

    #[test]
    fn what_is_not_possible_says_why_and_does_nothing() {
        let state = AppState::default();
        let copy = state.palette("copy csv").remove(0);
        assert!(copy.label.contains("CSV"), "{}", copy.label);
        assert!(copy.reason.is_some());
        assert!(copy.commands(&state).is_empty());
    }
}
