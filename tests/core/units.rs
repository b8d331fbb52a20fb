//! Units: guessed, shown, asked about once, remembered with the file, stated in exports.

use std::path::Path;

use shapematch::app::*;
use shapematch::formats::Memory;
use shapematch::geometry::Similarity;
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, LoadedPart, load_from};
use shapematch::pipeline::match_parts::{MatchRecipe, match_parts};
use shapematch::pipeline::outputs::record::match_record;
use shapematch::pipeline::units::{PairUnits, doubts_of_set_units};
use shapematch::role::{PerRole, Role};
use shapematch::units::{LengthUnit, UnitSystem};

use super::app::Window;

fn words(window: &Window, role: Role) -> String {
    window
        .state
        .units_of(role)
        .map_or_else(|| "unknown".to_owned(), |known| known.words())
}

fn set(role: Role, units: impl Into<shapematch::units::Units>) -> FileCommand {
    let units = Some(units.into());
    FileCommand::SetUnits { role, units }
}

#[test]
fn unknown_units_are_said_to_be_unknown_and_can_be_set() {
    let mut window = Window::with_both();
    assert_eq!(words(&window, Role::Crash), "unknown");
    assert_eq!(window.state.lengths().of(0.38), "0.380");
    let before = window.state.document.clone();
    let n_done = window.state.history.n_done();
    window.apply(set(Role::Crash, UnitSystem::TonMmS));
    assert_eq!(words(&window, Role::Crash), "ton-mm-s, set by you");
    assert_eq!(
        words(&window, Role::Stamped),
        "mm, assumed from the other part"
    );
    assert_eq!(window.state.lengths().of(0.38), "0.380 mm");
    // Only a word about the file has changed: what was measured stays valid.
    assert_eq!(window.state.document.stamp(), before.stamp());
    assert_eq!(window.state.history.n_done(), n_done + 1);
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);
}

#[test]
fn what_the_files_say_is_asked_about_once_and_is_one_undo_step() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    window.open("says_m.k", Role::Stamped);
    let hint = window.state.unit_hint().unwrap();
    assert_eq!((hint.factor, hint.unit), (1000.0, Some(LengthUnit::Meter)));
    assert_eq!(hint.text(), "Stamped looks 1000 × smaller than crash");
    assert_eq!(words(&window, Role::Stamped), "m, from title or comment");
    // Lengths of either file alone are in its own unit, and exports say the same.
    let unit = |window: &Window, role| window.state.lengths_of(role).suffix();
    assert_eq!(unit(&window, Role::Stamped), " m");
    assert_eq!(unit(&window, Role::Crash), " mm");
    let [crash, stamped] = Role::ALL.map(|role| window.part(role).loaded.clone());
    assert_eq!(
        PairUnits::sentences(PerRole::new(&*crash, &*stamped))[2],
        "says_m.k: m, from title or comment; no factor was applied"
    );
    // Section 1 may be folded; its header says that there is a question.
    let asks = |window: &Window| window.state.open_question(Section::Load).is_some();
    assert!(asks(&window));
    let before = window.state.document.clone();
    let n_done = window.state.history.n_done();
    window.apply(set(Role::Stamped, LengthUnit::Meter));
    assert!(!asks(&window));
    assert_eq!(window.part(Role::Stamped).length_factor(), 1000.0);
    assert_eq!(window.state.unit_hint(), None);
    assert_eq!(words(&window, Role::Stamped), "m, set by you");
    assert_eq!(
        unit(&window, Role::Stamped),
        " mm",
        "its lengths are converted"
    );
    assert_eq!(
        window.state.document.length_unit(),
        Some(LengthUnit::Millimeter)
    );
    assert_eq!(window.state.history.n_done(), n_done + 1);
    assert_eq!(window.state.history.undo_name(), Some("says_m.k is in m"));
    let after = window.state.document.clone();
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);
    window.act(Action::Redo);
    assert_eq!(window.state.document, after);
}

/// The factor goes with the unit that it came from, and thicknesses are lengths like all others.
#[test]
fn a_unit_that_is_taken_back_takes_its_factor_with_it() {
    let mut window = Window::new();
    window.open("crash.k", Role::Crash);
    window.open("stamped.k", Role::Stamped);
    window.apply(set(Role::Crash, LengthUnit::Millimeter));
    let thickness = |window: &Window| window.part(Role::Stamped).facts.parts[0].thickness;
    let before = thickness(&window);
    window.apply(set(Role::Stamped, LengthUnit::Meter));
    assert_eq!(window.part(Role::Stamped).length_factor(), 1000.0);
    assert_eq!(thickness(&window), before.map(|t| 1000.0 * t));
    window.apply(FileCommand::SetUnits {
        role: Role::Stamped,
        units: None,
    });
    assert_eq!(window.part(Role::Stamped).length_factor(), 1.0);
    assert_eq!(thickness(&window), before);
}

/// Settings are set as a whole, and the command search remembers its entries among them.
#[test]
fn the_command_search_remembers_entries_that_change_settings() {
    let mut window = Window::new();
    for typed in ["increase ui scale", "units of the crash file: cm"] {
        window.open("says_mm.k", Role::Crash);
        let entry = window.state.palette(typed).remove(0);
        let scale = window.state.settings.ui_scale;
        for command in entry.commands(&window.state) {
            window.apply(command);
        }
        assert_eq!(window.state.settings.recent_commands[0], entry.label);
        let has_grown = window.state.settings.ui_scale > scale;
        assert_eq!(has_grown, typed.contains("scale"));
    }
}

#[test]
fn units_are_set_from_the_command_search() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    let entry = window
        .state
        .palette("units of the crash file: cm")
        .remove(0);
    for command in entry.commands(&window.state) {
        window.apply(command);
    }
    assert_eq!(words(&window, Role::Crash), "cm, set by you");
}

#[test]
fn a_guess_gives_way_to_the_hint_that_contradicts_it() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    window.open("inches.k", Role::Stamped);
    let guess = window.part(Role::Stamped).loaded.units().unwrap();
    assert_eq!(guess.words(), "m, guessed from size");
    let hint = window.state.unit_hint().unwrap();
    assert_eq!(hint.unit, Some(LengthUnit::Inch));
    assert_eq!(words(&window, Role::Stamped), "unknown");
    assert_eq!(window.state.lengths_of(Role::Stamped).suffix(), "");
}

#[test]
fn an_answer_is_remembered_for_the_file() {
    let mut first = Window::new();
    first.open("says_mm.k", Role::Crash);
    first.open("says_m.k", Role::Stamped);
    first.apply(set(Role::Stamped, LengthUnit::Meter));
    let text = serde_json::to_string(&first.state.settings).unwrap();
    let mut next = Window::new();
    next.state.settings = serde_json::from_str(&text).unwrap();
    next.open("says_m.k", Role::Stamped);
    next.open("says_mm.k", Role::Crash);
    assert_eq!(next.part(Role::Stamped).length_factor(), 1000.0);
    assert_eq!(words(&next, Role::Stamped), "m, set by you");

    let mut other = Window::new();
    other.open("says_mm.k", Role::Crash);
    other.open("says_m.k", Role::Stamped);
    other.apply(FileCommand::DismissUnitHint);
    assert_eq!(other.state.unit_hint(), None);
    assert_eq!(
        words(&other, Role::Stamped),
        "mm, assumed from the other part"
    );
    let mut again = Window::new();
    again.state.settings = other.state.settings.clone();
    again.open("says_mm.k", Role::Crash);
    again.open("says_m.k", Role::Stamped);
    assert_eq!(again.state.unit_hint(), None);
}

#[test]
fn another_unit_of_the_crash_file_carries_the_stamped_file_along() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    window.open("says_m.k", Role::Stamped);
    window.apply(set(Role::Stamped, LengthUnit::Meter));
    window.apply(set(Role::Crash, LengthUnit::Centimeter));
    assert_eq!(window.part(Role::Stamped).length_factor(), 100.0);
    assert_eq!(window.state.lengths().of(2.0), "2.00 cm");
}

fn bundled(name: &str, settings: &LoadSettings) -> LoadedPart {
    let file = shapematch::samples::bundled()
        .into_iter()
        .find(|file| file.name.starts_with(name))
        .unwrap();
    let files = Memory::new().with(file.name, file.bytes);
    load_from(&files, Path::new(file.name), settings, &Monitor::silent()).unwrap()
}

#[test]
fn every_export_states_units_and_factors() {
    let settings = LoadSettings {
        units: Some(LengthUnit::Centimeter.into()),
        length_factor: 10.0,
        ..LoadSettings::default()
    };
    let crash = bundled("crash", &LoadSettings::default());
    let stamped = bundled("stamped", &settings);
    let known = crash.units().unwrap();
    assert_eq!(known.words(), "ton-mm-s, from title or comment");
    assert_eq!(
        PairUnits::sentences(PerRole::new(&crash, &stamped))[2],
        "stamped.dynain.gz: cm, set by you; its lengths were multiplied by 10"
    );

    let stamped = bundled("stamped", &LoadSettings::default());
    let known = stamped.units().unwrap();
    assert_eq!(known.words(), "mm, guessed from size and thickness");
    let recipe = MatchRecipe {
        max_triangles: Some(500),
        ..MatchRecipe::default()
    };
    let silent = Monitor::silent();
    let identity = Similarity::identity();
    let parts = PerRole::new(&crash, &stamped);
    let run = match_parts(parts, None, &recipe, &identity, &silent).unwrap();
    let record = match_record(&run, parts);
    assert_eq!(record.units.length, Some(LengthUnit::Millimeter));
    assert_eq!(record.files.crash.units, Some("ton-mm-s"));
    assert_eq!(record.files.stamped.units, Some("mm"));
    let form = shapematch::report::CardForm::ALL[0];
    let cards = shapematch::pipeline::outputs::cards::cards(form, &run, parts, None).unwrap();
    assert!(cards.text.contains("lengths in mm"), "{}", cards.text);
    assert!(cards.text.contains("stamped.dynain.gz: mm, guessed"));
}

#[test]
fn stresses_in_other_units_are_told() {
    let crash = bundled("crash", &LoadSettings::default());
    let settings = LoadSettings {
        units: Some(UnitSystem::KgMmMs.into()),
        ..LoadSettings::default()
    };
    let stamped = bundled("stamped", &settings);
    let warning = PairUnits::stress_warning(PerRole::new(&crash, &stamped)).unwrap();
    assert!(
        warning.contains("in MPa") && warning.contains("in GPa"),
        "{warning}"
    );
    let words = PairUnits::sentences(PerRole::new(&crash, &stamped));
    assert_eq!(words[2], "stamped.dynain.gz: kg-mm-ms, set by you");
    let alike = bundled("stamped", &LoadSettings::default());
    assert_eq!(
        PairUnits::stress_warning(PerRole::new(&crash, &alike)),
        None
    );
}

#[test]
fn units_that_are_set_stand_and_what_contradicts_them_is_told() {
    let set = |name, units: shapematch::units::Units| {
        let units = Some(units);
        bundled(
            name,
            &LoadSettings {
                units,
                ..LoadSettings::default()
            },
        )
    };
    let as_it_is = bundled("crash", &LoadSettings::default());
    let stamped = set("stamped", UnitSystem::KgMS.into());
    let parts = PerRole::new(&as_it_is, &stamped);
    let words = PairUnits::sentences(parts);
    assert_eq!(words[0], "lengths in mm");
    assert_eq!(
        words[2],
        "stamped.dynain.gz: kg-m-s, set by you; no factor was applied"
    );
    let doubts = doubts_of_set_units(parts);
    assert_eq!(doubts.len(), 2, "{doubts:?}");
    assert_eq!(
        doubts[0],
        "the units of stamped.dynain.gz are set to kg-m-s, which contradicts mm, guessed from size and thickness"
    );
    assert_eq!(
        doubts[1],
        "the units of stamped.dynain.gz (kg-m-s, set by you) and crash.k.gz (ton-mm-s, from title or comment) differ \
         by the factor 1000, but the sizes of the parts do not; no factor was applied, so the lengths of both are \
         taken to be in mm"
    );

    let crash = set("crash", UnitSystem::GMmMs.into());
    let stamped = set("stamped", LengthUnit::Millimeter.into());
    let doubts = doubts_of_set_units(PerRole::new(&crash, &stamped));
    assert_eq!(doubts.len(), 1, "{doubts:?}");
    assert!(
        doubts[0]
            .ends_with("are set to g-mm-ms, which contradicts ton-mm-s, from title or comment"),
        "{}",
        doubts[0]
    );
    let none = doubts_of_set_units(PerRole::new(&as_it_is, &stamped));
    assert_eq!(none, Vec::<String>::new());
}

#[test]
fn the_window_tells_what_contradicts_the_units_that_are_set() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    window.apply(set(Role::Crash, LengthUnit::Millimeter));
    let told = |window: &Window| {
        let mut rows = window.state.log.rows().iter();
        rows.any(|row| {
            row.text
                .contains("which contradicts mm, from title or comment")
        })
    };
    assert!(!told(&window));
    window.apply(set(Role::Crash, LengthUnit::Inch));
    assert!(told(&window));
}
