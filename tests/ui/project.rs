//! Projects, kept work, history and command search in the real window.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{
    Action, Axis, Command, Dialog, FileCommand, HistoryCommand, MatchCommand, MoveCommand,
    ProjectCommand, StartupOptions, ViewCommand,
};
use shapematch::geometry::camera::StandardView;
use shapematch::report::picture::Picture;
use shapematch::role::Role;
use shapematch::ui::Shell;
use shapematch::ui::preferences::{Preferences, UserFiles};

use super::story::{click, finish, window};

type Window = Harness<'static, Shell>;

fn run(window: &mut Window, command: impl Into<Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command.into()], &ctx);
    window.run_steps(2);
}

/// A window with a graphics adapter in which a step takes so many seconds.
pub(super) fn drawn(step_secs: f32) -> Window {
    let mut window = Harness::builder()
        .with_size([900.0, 600.0])
        .with_step_dt(step_secs)
        .wgpu()
        .build_eframe(|cc| {
            let options = StartupOptions::default();
            Shell::new(cc, options, UserFiles::none(), Preferences::default()).expect("a thread")
        });
    window.run_steps(2);
    window
}

/// What both windows show as soon as all of it is made.
pub(super) fn picture(window: &mut Window) -> Picture {
    let begin = Instant::now();
    loop {
        window.run_steps(2);
        if let Some(picture) = window.state_mut().picture() {
            let colors: BTreeSet<&[u8]> = picture.rgba.chunks(4).collect();
            assert!(colors.len() > 100, "an empty picture proves nothing");
            return picture;
        }
        let patience = Duration::from_secs(120);
        assert!(begin.elapsed() < patience, "the picture does not end");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The example as files of a folder, the crash model first.
fn example_on_disk(folder: &Path) -> Vec<PathBuf> {
    let mut files = shapematch::samples::bundled();
    files.retain(|file| !file.name.ends_with("json"));
    files.sort_by_key(|file| !file.name.starts_with("crash"));
    let write = |file: &shapematch::samples::SampleFile| {
        let path = folder.join(file.name);
        std::fs::write(&path, &file.bytes).expect("a folder");
        path
    };
    files.iter().map(write).collect()
}

fn open(window: &mut Window, paths: Vec<PathBuf>) {
    run(window, FileCommand::Open { paths, role: None });
    finish(window);
}

fn save(window: &mut Window, path: &Path) {
    run(window, ProjectCommand::Write(path.to_path_buf()));
    while window.state().state().is_unsaved() {
        window.run_steps(1);
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Looks from a side, a little closer than what would be fitted.
fn look_from(window: &mut Window, role: Role, view: StandardView) {
    run(window, ViewCommand::Standard(role, view));
    let mut camera = *window.state().state().view.cameras.get(role);
    camera.height *= 0.9;
    run(window, ViewCommand::SetCamera(role, camera));
}

fn assert_same(a: &Picture, b: &Picture, what: &str) {
    assert_eq!((a.width, a.height), (b.width, b.height), "{what}");
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    let n_differing = pixels.filter(|(a, b)| a != b).count();
    assert_eq!(n_differing, 0, "pixels differ {what}");
}

#[test]
fn a_project_saved_and_opened_gives_the_same_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = example_on_disk(folder.path());
    let [beside, over] =
        ["beside", "over"].map(|n| folder.path().join(n).with_extension("shapematch"));
    // Every flight is over after two steps.
    let mut first = drawn(1.0);
    open(&mut first, paths);
    click(&mut first, "Reduce");
    finish(&mut first);
    run(&mut first, MoveCommand::Flip(Axis::X));
    look_from(&mut first, Role::Stamped, StandardView::Front);
    let mut display = first.state().state().view.display.clone();
    display.has_edges = true;
    run(&mut first, ViewCommand::SetDisplay(Box::new(display)));
    let picture_beside = picture(&mut first);
    save(&mut first, &beside);
    run(&mut first, ViewCommand::ToggleMoveOver);
    run(&mut first, MatchCommand::Run);
    finish(&mut first);
    look_from(&mut first, Role::Crash, StandardView::Left);
    let picture_over = picture(&mut first);
    save(&mut first, &over);
    drop(first);
    assert_ne!(picture_beside, picture_over);

    // No flight gets anywhere in so short a time, so there must be none.
    let mut again = drawn(1e-6);
    for turn in ["at first", "after another"] {
        open(&mut again, vec![beside.clone()]);
        let now = picture(&mut again);
        assert_same(&now, &picture_beside, &format!("beside, {turn}"));
        open(&mut again, vec![over.clone()]);
        let now = picture(&mut again);
        assert_same(&now, &picture_over, &format!("moved over, {turn}"));
    }
}

#[test]
fn leaving_with_unsaved_work_asks() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    run(&mut window, MoveCommand::Flip(Axis::X));
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
    run(&mut window, MoveCommand::Flip(Axis::X));
    run(&mut window, MoveCommand::Flip(Axis::Y));
    click(&mut window, "History");
    let end = window.state().state().document.clone();
    click(&mut window, "Step 2: Flip about X (180°)");
    assert_eq!(window.state().state().history.n_done(), 2);
    click(&mut window, "Step 3: Flip about Y (180°), undone");
    assert_eq!(window.state().state().document, end);
    run(&mut window, HistoryCommand::JumpTo(1));
    assert!(window.query_by_label("Step 1: Load both files").is_some());
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
    // What was typed last is gone.
    open(&mut window);
    window.event(egui::Event::Text("xyz".to_owned()));
    window.run_steps(2);
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
        let found = state.palette(action.row().label);
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
        let files = UserFiles::at(folder);
        let mut window = Harness::builder()
            .with_size([1400.0, 900.0])
            .build_eframe(move |cc| {
                let options = StartupOptions::default();
                Shell::new(cc, options, files, Preferences::default()).expect("a thread")
            });
        window.run_steps(2);
        window
    };
    let kept = folder.path().join("kept");
    let mut first = start(folder.path());
    click(&mut first, "Open the example pair");
    finish(&mut first);
    run(&mut first, MoveCommand::Flip(Axis::X));
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
        if next.query_by_label("Recover").is_some() {
            break;
        }
    }
    // The offer leaves the ways to open files free, and the log, which may have a row already.
    let gone = folder.path().join("gone.k");
    let open = FileCommand::Open {
        paths: vec![gone],
        role: None,
    };
    run(&mut next, open);
    finish(&mut next);
    super::layout::dismiss_toasts(&mut next);
    for [width, height] in [
        [1400.0, 900.0],
        [1024.0, 700.0],
        [640.0, 360.0],
        [320.0, 216.0],
    ] {
        next.set_size(egui::vec2(width, height));
        next.run_steps(4);
        assert!(next.query_by_label("Recover").is_some());
        let found = super::layout::faults(&next);
        assert!(found.is_empty(), "{width} × {height}: {}", found.join("\n"));
    }
    click(&mut next, "Recover");
    finish(&mut next);
    assert_eq!(*next.state().state().document.crash_from_stamped(), pose);
    assert!(next.state().state().is_unsaved());
    assert!(next.state().state().project.lost_session().is_none());
}

#[test]
fn a_restored_project_shows_its_verdict() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = example_on_disk(folder.path());
    let kept = folder.path().join("kept.shapematch");
    let mut first = window();
    open(&mut first, paths);
    run(&mut first, MatchCommand::Run);
    finish(&mut first);
    let verdict = |window: &Window| {
        let result = window.state().state().document.current_result();
        let verdict = result.map(|result| result.run.assessment.verdict)?;
        Some(format!("{} {}", verdict.sign(), verdict.label()))
    };
    let before = verdict(&first).expect("a result");
    save(&mut first, &kept);
    drop(first);
    let mut again = window();
    open(&mut again, vec![kept]);
    assert_eq!(verdict(&again).as_ref(), Some(&before));
    assert!(
        again.query_by_label(&before).is_some(),
        "{before} is not seen"
    );
    let tolerance =
        again.query_by_role_and_label(egui::accesskit::Role::SpinButton, "Shape tolerance");
    assert!(tolerance.is_some());
}
