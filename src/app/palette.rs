//! What the command search offers: every action, tab, section, colour and colour map, recent files, every form of
//! matrix and card, the themes.

use std::path::Path;

use super::fuzzy::Search;
use super::{
    Action, ActionRow, AppState, BottomTab, ColorBy, Command, CopyForm, ExportCommand, FileCommand,
    Menu, ProjectCommand, Section, Settings, Theme, ViewCommand,
};
use crate::colormap::ColorMap;
use crate::pipeline::names::file_name;
use crate::pipeline::outputs::{MeshOutput, Output};
use crate::report::{CardForm, MatrixForm};
use crate::role::Role;
use crate::text::inside;
use crate::units::Units;

/// Commands that are remembered as used last.
const MAX_RECENT: usize = 6;

/// What an entry does.
#[derive(Debug, Clone)]
enum Does {
    Action(Action),
    Command(Box<Command>),
    Theme(Theme),
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
    /// Keys of the entry as text; empty for none.
    pub keys: String,
    /// Why it is not possible now.
    pub reason: Option<&'static str>,
    /// True if it was used lately.
    pub is_recent: bool,
    /// The letters of the label that fit what was typed, by their number.
    pub letters: Vec<usize>,
    does: Does,
}

impl PaletteEntry {
    /// One that is always possible and has no keys.
    fn plain(
        label: impl Into<String>,
        group: &'static str,
        help: impl Into<String>,
        does: Does,
    ) -> Self {
        Self {
            label: label.into(),
            group,
            help: help.into(),
            keys: String::new(),
            reason: None,
            is_recent: false,
            letters: Vec::new(),
            does,
        }
    }

    /// The action it stands for, if it is one.
    pub fn action(&self) -> Option<Action> {
        match self.does {
            Does::Action(action) => Some(action),
            Does::Command(_) | Does::Theme(_) => None,
        }
    }

    /// What follows from choosing it: nothing if it is not possible now.
    pub fn commands(&self, state: &AppState) -> Vec<Command> {
        if self.reason.is_some() {
            return Vec::new();
        }
        let command = match &self.does {
            Does::Theme(theme) => {
                let mut settings = state.settings.clone();
                settings.theme = *theme;
                Some(Command::Settings(Box::new(settings)))
            }
            Does::Action(action) => action.command(state),
            Does::Command(command) => Some(Command::clone(command)),
        };
        match command {
            // Settings are set as a whole.
            Some(Command::Settings(mut settings)) => {
                remember(&mut settings, &self.label);
                vec![Command::Settings(settings)]
            }
            command => {
                let mut settings = state.settings.clone();
                remember(&mut settings, &self.label);
                let remembered = Command::Settings(Box::new(settings));
                std::iter::once(remembered).chain(command).collect()
            }
        }
    }
}

fn remember(settings: &mut Settings, label: &str) {
    let recent = &mut settings.recent_commands;
    recent.retain(|known| known != label);
    recent.insert(0, label.to_owned());
    recent.truncate(MAX_RECENT);
}

impl AppState {
    /// The entries that fit what was typed, the best first. Without text those used last come
    /// first, then all others in the order of the menus.
    pub fn palette(&self, typed: &str) -> Vec<PaletteEntry> {
        let mut search = Search::new(typed);
        let mut found: Vec<(f64, PaletteEntry)> = self
            .palette_entries()
            .into_iter()
            .filter_map(|mut entry| {
                let find = search.find(&entry.label, &entry.help)?;
                entry.letters = find.letters;
                Some((find.score, entry))
            })
            .collect();
        let recent = &self.settings.recent_commands;
        let rank = |entry: &PaletteEntry| {
            let place = recent.iter().position(|label| *label == entry.label);
            place.unwrap_or(usize::MAX)
        };
        for (_, entry) in &mut found {
            entry.is_recent = rank(entry) != usize::MAX;
        }
        if search.is_empty() {
            found.sort_by_key(|(_, entry)| rank(entry));
        } else {
            found.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank(&a.1).cmp(&rank(&b.1))));
        }
        found.into_iter().map(|(_, entry)| entry).collect()
    }

    fn palette_entries(&self) -> Vec<PaletteEntry> {
        let mut entries: Vec<PaletteEntry> = Menu::ALL
            .into_iter()
            .flat_map(Menu::rows)
            .map(|row| self.action_entry(row))
            .collect();
        let why = |action: Action| action.enabled(self).err().map(|reason| reason.0);
        let (no_part, no_match) = (why(Action::CopyMatrix), why(Action::SaveCards));
        for form in CopyForm::all() {
            let reason = form.enabled(self).err().map(|reason| reason.0);
            let label = format!("Copy: {}", form.label());
            entries.push(export(label, ExportCommand::Copy(form), reason));
        }
        for form in MatrixForm::ALL {
            let label = format!("Save matrix: {}…", form.label());
            entries.push(write(label, Output::Matrix(*form), no_part));
        }
        for form in CardForm::ALL {
            let label = format!("Save cards: {}…", form.label());
            entries.push(write(label, Output::Cards(*form), no_match));
        }
        for mesh in MeshOutput::ALL {
            let is_possible = self.document.can_write(Output::Mesh(mesh));
            let reason = (!is_possible).then_some("There is no such mesh yet.");
            entries.push(write(
                format!("Save: {}", mesh.label()),
                Output::Mesh(mesh),
                reason,
            ));
        }
        entries.extend(ColorBy::ALL.map(|by| self.color_entry(by)));
        entries.extend(ColorMap::ALL.map(|map| self.map_entry(map)));
        entries.extend(BottomTab::ALL.map(|tab| self.tab_entry(tab)));
        entries.extend(Section::ALL.map(|section| {
            let label = format!("{} {}", section.index() + 1, section.title());
            let open = ViewCommand::ShowSection(section);
            place("Left column", label, section.help(), open)
        }));
        let by_hand = "Numbers, axes, flips and a pasted matrix; in section 3";
        entries.push(place(
            "Left column",
            "Move by hand".to_owned(),
            by_hand,
            ViewCommand::ShowMoveByHand,
        ));
        entries.extend(
            Role::ALL
                .into_iter()
                .flat_map(|role| self.units_entries(role)),
        );
        let locked = self.jobs.is_unlocked().err().map(|reason| reason.0);
        let recent = self.settings.recent.iter();
        entries.extend(recent.map(|path| PaletteEntry {
            label: format!("Open {}", self.settings.recent_name(path)),
            ..file("Open", path, locked)
        }));
        let sessions = self.project.sessions.iter().map(|session| PaletteEntry {
            label: format!("Recover {}", session.title),
            does: does(ProjectCommand::Restore(session.path.clone())),
            ..file("Recover", &session.path, locked)
        });
        entries.extend(sessions);
        entries.extend(Theme::ALL.map(|theme| {
            let label = format!("Theme: {}", theme.label().to_lowercase());
            let (group, help) = ("Preferences", "Colours of the window");
            PaletteEntry::plain(label, group, help, Does::Theme(theme))
        }));
        entries
    }

    /// Every unit that a file may be in.
    fn units_entries(&self, role: Role) -> impl Iterator<Item = PaletteEntry> {
        let possible = self.document.has_part(role);
        let possible = possible.and_then(|()| self.jobs.is_unlocked());
        let reason = possible.err().map(|reason| reason.0);
        Units::all().map(move |units| {
            let label = format!("Units of the {} file: {}", role.word(), units.label());
            let units = Some(units);
            let does = does(FileCommand::SetUnits { role, units });
            PaletteEntry {
                reason,
                ..PaletteEntry::plain(label, "Units", "What the lengths of the file are in", does)
            }
        })
    }

    fn color_entry(&self, by: ColorBy) -> PaletteEntry {
        let mut display = self.view.display.clone();
        display.color_by = by;
        let label = format!("Colour: {}", inside(by.label()));
        let help = "What the colours of the parts show";
        let does = does(ViewCommand::SetDisplay(Box::new(display)));
        PaletteEntry {
            reason: self.missing_for(by),
            ..PaletteEntry::plain(label, by.group(), help, does)
        }
    }

    /// One map for all values, with and without a sign.
    fn map_entry(&self, map: ColorMap) -> PaletteEntry {
        let mut display = self.view.display.clone();
        (display.coloring.map, display.coloring.signed_map) = (map, map);
        let label = format!("Colour map: {}", inside(map.label()));
        let help = "Colours of the values that are shown";
        place(
            "View",
            label,
            help,
            ViewCommand::SetDisplay(Box::new(display)),
        )
    }

    fn tab_entry(&self, tab: BottomTab) -> PaletteEntry {
        let reason = (!self.has_content(tab)).then_some("The tab has nothing to show yet.");
        PaletteEntry {
            reason,
            ..place(
                "Tab",
                format!("Tab: {}", inside(tab.label())),
                tab.help(),
                ViewCommand::SetTab(tab),
            )
        }
    }

    fn action_entry(&self, row: &ActionRow) -> PaletteEntry {
        let group = row.action.menu().label();
        PaletteEntry {
            keys: row.shortcut().map_or_else(String::new, |s| s.to_string()),
            reason: row.action.enabled(self).err().map(|reason| reason.0),
            ..PaletteEntry::plain(row.label, group, row.tooltip, Does::Action(row.action))
        }
    }
}

fn does(command: impl Into<Command>) -> Does {
    Does::Command(Box::new(command.into()))
}

/// Something that is always possible: where it is, its name and what it does.
fn place(group: &'static str, label: String, help: &str, command: ViewCommand) -> PaletteEntry {
    PaletteEntry::plain(label, group, help, does(command))
}

fn export(label: String, command: ExportCommand, reason: Option<&'static str>) -> PaletteEntry {
    PaletteEntry {
        reason,
        ..PaletteEntry::plain(label, "Export", "", does(command))
    }
}

fn write(label: String, kind: Output, reason: Option<&'static str>) -> PaletteEntry {
    export(label, ExportCommand::AskSave(kind), reason)
}

fn file(verb: &str, path: &Path, reason: Option<&'static str>) -> PaletteEntry {
    let label = format!("{verb} {}", file_name(path));
    let open = FileCommand::Open {
        paths: vec![path.to_path_buf()],
        role: None,
    };
    PaletteEntry {
        reason,
        ..PaletteEntry::plain(label, "Recent", path.display().to_string(), does(open))
    }
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
        assert_eq!(
            first("notifications"),
            Some(Action::Preferences),
            "by its help"
        );
        assert!(first("qzxv").is_none());
    }

    #[test]
    fn a_theme_is_chosen_by_its_name() {
        let mut state = AppState::default();
        for (typed, theme) in [("light", Theme::Light), ("dark", Theme::Dark)] {
            let entry = state.palette(typed).remove(0);
            for command in entry.commands(&state) {
                let _ = state.apply(command);
            }
            assert_eq!(state.settings.theme, theme);
            assert_eq!(state.palette("")[0].label, entry.label);
        }
    }

    #[test]
    fn the_units_of_both_files_are_commands() {
        let state = AppState::default();
        let found = state.palette("units");
        for role in Role::ALL {
            let label = format!("Units of the {} file: mm", role.word());
            let entry = found.iter().find(|entry| entry.label == label);
            let reason = entry.expect(&label).reason;
            assert!(reason.is_some(), "no part is loaded");
        }
    }

    #[test]
    fn every_colour_is_a_command() {
        let mut state = AppState::default();
        let thinning = state.palette("thinning").remove(0);
        assert_eq!(thinning.label, "Colour: thinning");
        assert!(thinning.reason.is_some(), "no part is loaded");
        let entry = state.palette("colour: part").remove(0);
        for command in entry.commands(&state) {
            let _ = state.apply(command);
        }
        assert_eq!(state.view.display.color_by, ColorBy::Part);
        // Groups stand together, each once.
        let mut groups: Vec<_> = ColorBy::ALL.map(ColorBy::group).to_vec();
        groups.dedup();
        assert_eq!(groups, ["Part", "Match", "Forming", "Mapping"]);
    }

    #[test]
    fn tabs_sections_and_maps_are_found_by_their_usual_words() {
        let state = AppState::default();
        for (typed, label) in [
            ("history", "Tab: history"),
            ("timings", "Tab: timings"),
            ("sweep", "Tab: sweep"),
            ("move by hand", "Move by hand"),
            ("greyscale", "Colour map: grey, for printing"),
            ("rainbow", "Colour map: rainbow, like LS-PrePost"),
        ] {
            let found = state.palette(typed);
            let first = found.first().map(|entry| entry.label.as_str());
            assert_eq!(first, Some(label), "{typed}");
        }
        for tab in BottomTab::ALL {
            let found = state.palette(tab.label());
            let is_it = |entry: &PaletteEntry| entry.label.ends_with(&inside(tab.label()));
            assert!(found.iter().any(is_it), "{}", tab.label());
        }
        for section in Section::ALL {
            let found = state.palette(section.title());
            let is_it = |entry: &PaletteEntry| entry.label.ends_with(section.title());
            assert!(found.iter().any(is_it), "{}", section.title());
        }
    }

    #[test]
    fn what_was_used_comes_first_and_is_remembered() {
        let mut state = AppState::default();
        let all = state.palette("");
        assert_eq!(all[0].action(), Some(Action::OpenCrash));
        for label in ["Preferences…", "About"] {
            let entry = state.palette(label).remove(0);
            for command in entry.commands(&state) {
                let _ = state.apply(command);
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
