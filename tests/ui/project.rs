//! Projects, kept work, history and command search in the real window.

use super::story::{click, finish, window};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{Action, Command, Dialog, HistoryCommand, MoveCommand, StartupOptions};
use shapematch::ui::Shell;
use shapematch::ui::storage::{Kept, Storage};
use std::path::Path;
use std::time::Duration;

type Window = Harness<'static, Shell>;

fn run(window: &mut Window, command: impl Into<Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command.into()], &ctx);
    window.run_steps(2);
}

#[test]
fn leaving_with_unsaved_work_asks() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    run(&mut window, MoveCommand::TurnOver(shapematch::app::Axis::X));
    run(&mut window, Command::Quit);
    for name in ["Save", "Don’t save", "Cancel"] {
        assert!(window.query_by_label(name).is_some(), "{name}");
    }
    click(&mut window, "Cancel");
    assert_eq!(window.state().state().view.dialog, None);
    run(&mut window, Command::Quit);
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, None);
}

#[test]
fn history_rows_jump_and_say_where_one_is() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    run(&mut window, MoveCommand::TurnOver(shapematch::app::Axis::X));
    run(&mut window, MoveCommand::TurnOver(shapematch::app::Axis::Y));
    click(&mut window, "History");
    let end = window.state().state().document.clone();
    click(&mut window, "Step 3: Turn over about X (part)");
    assert_eq!(window.state().state().history.n_done(), 3);
    click(&mut window, "Step 4: Turn over about Y (part), undone");
    assert_eq!(window.state().state().document, end);
    run(&mut window, HistoryCommand::JumpTo(2));
    assert!(
        window
            .query_by_label("Step 2: Load stamped.dynain.gz")
            .is_some()
    );
    window.check_accessibility();
}

#[test]
fn the_command_search_is_driven_by_keys() {
    let mut window = window();
    let open = |window: &mut Window| {
        window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
        window.run_steps(3);
    };
    open(&mut window);
    window.event(egui::Event::Text("prefr".to_owned()));
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    assert_eq!(
        window.state().state().view.dialog,
        Some(Dialog::Preferences)
    );
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    // Used lately: it stands first now, and the arrow leads to what is next.
    open(&mut window);
    window.key_press(egui::Key::ArrowDown);
    window.run_steps(2);
    window.key_press(egui::Key::ArrowUp);
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    assert_eq!(
        window.state().state().view.dialog,
        Some(Dialog::Preferences)
    );
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    open(&mut window);
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, None);
}

#[test]
fn every_action_is_found_by_its_name() {
    let window = window();
    let state = window.state().state();
    let all = state.palette("");
    for action in Action::ALL {
        let n = all
            .iter()
            .filter(|entry| entry.action() == Some(*action))
            .count();
        assert_eq!(n, 1, "{action:?} in the command search");
        let found = state.palette(action.info().label);
        let is_first = found
            .iter()
            .take(3)
            .any(|entry| entry.action() == Some(*action));
        assert!(is_first, "{action:?} is not found by its label");
    }
}

#[test]
fn lost_work_is_offered_and_comes_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = |folder: &Path| {
        let storage = Storage::at(&folder.join("settings.json"));
        let mut window = Harness::builder()
            .with_size([1400.0, 900.0])
            .build_eframe(move |cc| {
                let options = StartupOptions::default();
                Shell::new(cc, options, storage, Kept::default()).expect("a thread")
            });
        window.run_steps(2);
        window
    };
    let kept = folder.path().join("kept");
    let mut first = start(folder.path());
    click(&mut first, "Open the example pair");
    finish(&mut first);
    run(&mut first, MoveCommand::TurnOver(shapematch::app::Axis::X));
    let pose = *first.state().state().document.crash_from_stamped();
    let file = loop {
        first.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
        let entries = std::fs::read_dir(&kept).into_iter().flatten().flatten();
        let mut paths = entries.map(|entry| entry.path());
        if let Some(path) = paths.find(|p| p.extension().is_some_and(|e| e == "shapematch")) {
            break path;
        }
    };
    // What a killed program leaves behind: the file without the lock of a living one.
    let left = folder.path().join("000000000001-1.run.shapematch");
    std::fs::copy(&file, &left).expect("a copy");
    drop(first);
    for entry in std::fs::read_dir(&kept).expect("kept").flatten() {
        std::fs::remove_file(entry.path()).expect("emptied");
    }
    std::fs::rename(&left, kept.join("000000000001-1.run.shapematch")).expect("put back");

    let mut next = start(folder.path());
    for _ in 0..400 {
        next.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
        if next.query_by_label("Restore").is_some() {
            break;
        }
    }
    click(&mut next, "Restore");
    finish(&mut next);
    assert_eq!(*next.state().state().document.crash_from_stamped(), pose);
    assert!(next.state().state().is_unsaved());
    assert!(next.state().state().project.lost_work().is_none());
}
