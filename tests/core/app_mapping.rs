//! Section 4 of the window without a window: mapping, its colours, undo, and what is written.

use shapematch::app::{Action, ColorBy, HistoryCommand, MapCommand, MoveCommand, Quantity};
use shapematch::jobs::{JobKind, JobOutput, PipelineRunner, Runner as _};
use shapematch::monitor::Monitor;
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::{Output, OutputInput};
use shapematch::role::{PerRole, Role};
use shapematch::samples::{self, SamplePart, SampleSettings};

use super::app::Window;

fn real(kind: JobKind) -> Result<JobOutput, String> {
    let done = PipelineRunner.run(kind, &Monitor::silent());
    done.map_err(|error| error.to_string())
}

/// A window with a generated bracket at its known pose.
fn at_the_known_pose() -> (Window, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let pair = samples::generate(&SampleSettings {
        part: SamplePart::Bracket,
        ..SampleSettings::default()
    });
    for file in samples::files(&pair) {
        std::fs::write(folder.path().join(file.name), file.bytes).unwrap();
    }
    let mut window = Window::new();
    window.runner = Some(real);
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        window.open(folder.path().join(name).to_str().unwrap(), role);
    }
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: pair.crash_from_stamped,
        name: "Known pose".to_owned(),
    });
    (window, folder)
}

#[test]
fn forming_results_are_mapped_shown_written_and_undone() {
    let (mut window, _folder) = at_the_known_pose();
    assert!(Action::SaveMappedDeck.enabled(&window.state).is_err());
    assert!(window.state.missing_for(ColorBy::PlasticStrain).is_none());
    assert!(window.state.mapped_for(ColorBy::PlasticStrain).is_none());
    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    assert!(
        result.record.mapped_area > 0.95,
        "{:?}",
        result.record.statuses
    );
    assert!(window.state.mapped_for(ColorBy::PlasticStrain).is_some());
    assert!(window.state.mapped_for(ColorBy::Thickness).is_some());
    // Stresses were not asked for.
    assert!(window.state.mapped_for(ColorBy::VonMises).is_none());
    let (listed, n) = window.state.unmapped_elements();
    assert_eq!(
        n,
        result
            .run
            .mapped
            .elements
            .iter()
            .filter(|e| !e.status.has_values())
            .count()
    );
    assert!(listed.len() <= n);

    // What the window writes is what the command line writes.
    let document = &window.state.document;
    let input = OutputInput {
        parts: PerRole::from_fn(|role| document.part(role).map(|p| p.loaded.to_arc())),
        mapping: Some(result.run.to_arc()),
        ..OutputInput::default()
    };
    let monitor = Monitor::silent();
    let deck = Output::Mapped(WriteKind::Deck)
        .make(&input, None, &monitor)
        .unwrap();
    assert!(
        deck.notes[0].contains("read back within"),
        "{:?}",
        deck.notes
    );
    let text = String::from_utf8(deck.bytes).unwrap();
    assert!(text.contains("*ELEMENT_SHELL_THICKNESS") && text.contains("*INITIAL_STRESS_SHELL"));
    let page = Output::MapReport
        .make(&input, None, &monitor)
        .unwrap()
        .bytes;
    assert!(
        String::from_utf8(page)
            .unwrap()
            .contains("What became of the elements")
    );
    let table = Output::MapTable.make(&input, None, &monitor).unwrap().bytes;
    let rows = String::from_utf8(table).unwrap().lines().count();
    assert_eq!(rows, result.run.shells.len() + 1);
    assert!(document.can_write(Output::MapReport));

    // A move makes it out of date, undo brings it back, and a second undo takes it away.
    window.act(Action::FlipX);
    assert!(window.state.document.current_mapping().is_none());
    assert!(window.state.stale(shapematch::app::Section::Map).is_some());
    window.apply(HistoryCommand::Undo);
    assert!(window.state.document.current_mapping().is_some());
    window.apply(HistoryCommand::Undo);
    assert!(window.state.document.mapping.result.is_none());
}

#[test]
fn quantities_are_one_step_each_and_a_running_mapping_can_be_given_up() {
    let (mut window, _folder) = at_the_known_pose();
    let mut recipe = window.state.document.mapping.recipe.clone();
    *Quantity::Stress.switch(&mut recipe.options.quantities) = true;
    window.apply(MapCommand::SetRecipe(Box::new(recipe)));
    assert!(
        window
            .state
            .document
            .mapping
            .recipe
            .options
            .quantities
            .stress
    );
    // The samples have no history variables, and say so.
    assert!(
        window
            .state
            .document
            .lacks_quantity(Quantity::History)
            .is_some()
    );
    assert!(
        window
            .state
            .document
            .lacks_quantity(Quantity::Strain)
            .is_none()
    );
    window.holds = true;
    window.act(Action::MapOrCancel);
    assert_eq!(window.held.len(), 1);
    window.act(Action::MapOrCancel);
    assert!(window.held.is_empty());
    assert!(window.state.document.mapping.result.is_none());
    window.holds = false;
    window.act(Action::MapOrCancel);
    assert!(window.state.mapped_for(ColorBy::VonMises).is_some());
    // Choices are part of a project.
    let project = window.state.to_project(0);
    assert!(project.mapping.options.quantities.stress);
    // Without parts there is nothing to map, and the reason is told.
    let bare = Window::new();
    let reason = Action::MapOrCancel.enabled(&bare.state).unwrap_err();
    assert_eq!(reason.0, "Load both parts first.");
}
