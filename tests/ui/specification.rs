//! What the specification asks of the whole window beside the panels: files that are dropped or change on
//! disk, names and news for a screen reader, rest without motion.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::accesskit::{Live, Role as Kind};
use egui::{Event, Key, Modifiers, Shape, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{
    Action, Axis, AxisFrame, Command, MoveCommand, Section, Settings, ViewCommand,
};
use shapematch::geometry::{Similarity, Vector3};
use shapematch::jobs::{JobKey, PartSource};
use shapematch::role::Role;
use shapematch::samples::SampleVariant;
use shapematch::ui::Shell;

use super::bracket::write_bracket;
use super::layout::{dismiss_toasts, texts};
use super::story::{click, finish, window};

type Window = Harness<'static, Shell>;

/// A file as the desktop hands it over.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// The bracket's files: crash, stamped.
fn files(folder: &Path) -> [PathBuf; 2] {
    write_bracket(folder, SampleVariant::Plain);
    ["crash.k", "stamped.dynain"].map(|name| folder.join(name))
}

fn drop_files(window: &mut Window, files: &[&PathBuf]) {
    for file in files {
        let dropped = Arc::new(Dropped((*file).clone()));
        window.input_mut().dropped_files.push(dropped);
    }
    window.run_steps(2);
}

fn part_of(window: &Window, role: Role) -> Option<PartSource> {
    let part = window.state().state().document.part(role);
    part.map(|part| part.source.clone())
}

fn act(window: &mut Window, commands: Vec<Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(commands, &ctx);
    window.run_steps(2);
}

/// Draws until `is_so`, for what happens on other threads.
fn wait_until(window: &mut Window, what: &str, is_so: impl Fn(&Window) -> bool) {
    let begin = Instant::now();
    while !is_so(window) {
        assert!(begin.elapsed() < Duration::from_secs(120), "not: {what}");
        std::thread::sleep(Duration::from_millis(20));
        window.run_steps(1);
    }
}

/// The window after both files were dropped, with the folder that they lie in.
fn both_dropped() -> (tempfile::TempDir, [PathBuf; 2], Window) {
    let folder = tempfile::tempdir().unwrap();
    let paths = files(folder.path());
    let mut window = window();
    drop_files(&mut window, &[&paths[0], &paths[1]]);
    finish(&mut window);
    (folder, paths, window)
}

#[test]
fn two_files_dropped_the_wrong_way_round_find_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let [crash, stamped] = files(folder.path());
    let mut window = window();
    drop_files(&mut window, &[&stamped, &crash]);
    finish(&mut window);
    let sources = [Role::Crash, Role::Stamped].map(|role| part_of(&window, role));
    let expected = [&crash, &stamped].map(|path| Some(PartSource::File(path.clone())));
    assert_eq!(sources, expected);
    // The guess is told with the way out, which reads nothing again.
    let swap = Action::Swap.command(window.state().state()).unwrap();
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![swap], &ctx);
    for role in Role::ALL {
        let key = JobKey::Load(role);
        assert!(
            !window.state().state().jobs.is_active(key),
            "it is read again"
        );
    }
    assert_eq!(part_of(&window, Role::Crash), expected[1]);
}

/// Moves the pointer to the header of section 4 with the next frame.
fn aim_at_map(window: &mut Window) {
    let header = window.get_by_role_and_label(Kind::Button, "4 Map");
    let at = header.rect().center();
    window.event(Event::PointerMoved(at));
}

/// Moves the pointer to the header of section 4.
fn point_at_map(window: &mut Window) {
    aim_at_map(window);
    window.run_steps(1);
}

/// What is said while files hang over the window.
fn said_of(window: &mut Window, files: Vec<egui::HoveredFile>) -> Option<String> {
    window.input_mut().hovered_files = files;
    window.run_steps(1);
    let painted = texts(window);
    window.input_mut().hovered_files.clear();
    let mut said = painted.into_iter().map(|text| text.text);
    said.find(|text| text.starts_with("Drop "))
}

/// Both parts with section 4 open, and two more stamped files.
fn with_section_4(folder: &Path) -> (Window, [PathBuf; 3]) {
    let [crash, stamped] = files(folder);
    let more = ["second.dynain", "third.dynain"].map(|name| folder.join(name));
    for file in &more {
        std::fs::copy(&stamped, file).unwrap();
    }
    let mut window = window();
    drop_files(&mut window, &[&stamped, &crash]);
    finish(&mut window);
    let open = ViewCommand::UseSection(Section::Map);
    act(&mut window, vec![open.into()]);
    point_at_map(&mut window);
    let [second, third] = more;
    (window, [stamped, second, third])
}

fn set_pose(window: &mut Window) {
    let set = MoveCommand::SetPose {
        crash_from_stamped: Similarity {
            translation: Vector3::new(0.0, 0.0, 1.0),
            ..Similarity::identity()
        },
        name: "Known pose".to_owned(),
    };
    act(window, vec![set.into()]);
    point_at_map(window);
}

/// The sentences of the places that would take the files which hang over the window.
fn hints(window: &mut Window, n_files: usize) -> Vec<String> {
    window.input_mut().hovered_files = vec![egui::HoveredFile::default(); n_files];
    window.run_steps(1);
    let painted = texts(window).into_iter().map(|text| text.text);
    let hints = painted.filter(|text| text.starts_with("Drop") && !text.ends_with("here"));
    let hints = hints.collect();
    window.input_mut().hovered_files.clear();
    window.run_steps(1);
    hints
}

fn point_at(window: &mut Window, x: f32, y: f32) {
    window.event(Event::PointerMoved(pos2(x, y)));
    window.run_steps(1);
}

#[test]
fn files_that_hang_over_the_window_are_told_where_they_go() {
    let mut window = window();
    point_at(&mut window, 600.0, 300.0);
    assert_eq!(hints(&mut window, 1), ["Drop as the crash part"]);
    point_at(&mut window, 1200.0, 300.0);
    assert_eq!(hints(&mut window, 1), ["Drop as the stamped part"]);
    let pair = ["Drop: the content tells which is which"; 2];
    assert_eq!(hints(&mut window, 2), pair);
    assert_eq!(hints(&mut window, 3), ["Drop: the first two are opened"; 2]);
    // Over the left column, where it is taken too.
    point_at(&mut window, 100.0, 600.0);
    let beside = ["Drop: the content tells which part it is"; 2];
    assert_eq!(hints(&mut window, 1), beside);
    // A desktop without a pointer while something is dragged.
    window.event(Event::PointerGone);
    window.run_steps(1);
    let both = ["Drop as the crash part", "Drop as the stamped part"];
    assert_eq!(hints(&mut window, 1), both);
}

#[test]
fn a_dropped_file_that_cannot_be_read_says_so_and_replaces_nothing() {
    let (folder, _, mut window) = both_dropped();
    let before = Role::ALL.map(|role| part_of(&window, role));
    let broken = folder.path().join("picture.k");
    std::fs::write(&broken, [0xFF, 0x00, 0x17].repeat(50)).unwrap();
    for (file, says) in [
        (folder.path().join("gone.k"), "gone.k"),
        (folder.path().to_owned(), "folder"),
        (broken, "picture.k"),
    ] {
        point_at(&mut window, 600.0, 300.0);
        drop_files(&mut window, &[&file]);
        finish(&mut window);
        assert_eq!(Role::ALL.map(|role| part_of(&window, role)), before);
        let mut toasts = window.state().state().log.notices.toasts();
        let error = toasts.next().unwrap();
        assert_eq!(error.level, shapematch::app::NoticeLevel::Error, "{says}");
        assert!(error.text.contains(says), "{says}: {}", error.text);
    }
}

#[test]
fn what_is_dropped_during_a_match_is_answered_and_nothing_is_lost() {
    let (folder, [crash, stamped], mut window) = both_dropped();
    let project = folder.path().join("work.shapematch");
    let saved = window.state().state().to_project(0);
    saved.write(&project).unwrap();
    point_at(&mut window, 600.0, 300.0);
    let cases: [&[&PathBuf]; 3] = [&[&stamped], &[&stamped, &crash], &[&project]];
    for dropped in cases {
        let before = window.state().state().document.revisions();
        click(&mut window, "Match the parts");
        assert!(window.state().state().jobs.locking_job().is_some());
        drop_files(&mut window, dropped);
        let is_told = {
            let mut toasts = window.state().state().log.notices.toasts();
            toasts.any(|toast| toast.text == "Not opened. A match is running. Stop it first.")
        };
        assert!(is_told, "{dropped:?}");
        finish(&mut window);
        let state = window.state().state();
        assert!(state.document.current_result().is_some(), "{dropped:?}");
        assert_eq!(state.document.revisions(), before, "{dropped:?}");
        assert_eq!(state.project_path(), None, "{dropped:?}");
        dismiss_toasts(&mut window);
    }
    for (role, file) in [(Role::Crash, crash), (Role::Stamped, stamped)] {
        assert_eq!(part_of(&window, role), Some(PartSource::File(file)));
    }
}

/// One that is dropped on section 4 waits until the match is done, and is then matched itself.
#[test]
fn a_further_file_that_is_dropped_during_a_match_is_added_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, [_, second, _]) = with_section_4(folder.path());
    set_pose(&mut window);
    let run = Action::MatchOrStop.command(window.state().state());
    act(&mut window, run.into_iter().collect());
    assert!(window.state().state().jobs.locking_job().is_some());
    // In one frame: the match may end at any time, and its result moves the section away.
    aim_at_map(&mut window);
    drop_files(&mut window, &[&second]);
    finish(&mut window);
    assert!(window.state().state().document.current_result().is_some());
    assert_eq!(stamped_names(&window), ["stamped.dynain", "second.dynain"]);
    let further = &window.state().state().document.mapping.further;
    let placing = further[0].placing.as_ref().expect("it has a pose");
    assert!(placing.crash_from_stamped != Similarity::identity());
}

/// The section with Stop and Cancel may be folded, and the whole column too.
#[test]
fn a_run_can_be_given_up_while_the_left_column_is_folded() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let fold = action(&window, Action::ToggleColumn);
    act(&mut window, fold);
    let run = action(&window, Action::MatchOrStop);
    act(&mut window, run);
    click(&mut window, "Cancel the run");
    assert!(window.state().state().jobs.locking_job().is_none());
    finish(&mut window);
    assert!(window.state().state().document.result.is_none());
    assert!(window.query_by_label("Cancel the run").is_none());
}

fn stamped_names(window: &Window) -> Vec<String> {
    let rows = window.state().state().stamped_rows();
    rows.into_iter().map(|row| row.name).collect()
}

#[test]
fn a_file_that_is_dropped_on_section_4_is_one_more_stamped_file_once_a_pose_stands() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, [stamped, second, third]) = with_section_4(folder.path());
    let hovered = |window: &mut Window, n: usize| {
        let files = vec![egui::HoveredFile::default(); n];
        said_of(window, files)
    };
    // Without a pose the file is opened as before.
    assert_ne!(
        hovered(&mut window, 1).as_deref(),
        Some("Drop as one more stamped file")
    );
    set_pose(&mut window);
    for (n, words) in [
        (1, "Drop as one more stamped file"),
        (2, "Drop as more stamped files"),
    ] {
        assert_eq!(hovered(&mut window, n).as_deref(), Some(words));
    }
    drop_files(&mut window, &[&second, &third]);
    finish(&mut window);
    assert_eq!(
        stamped_names(&window),
        ["stamped.dynain", "second.dynain", "third.dynain"]
    );
    assert_eq!(
        part_of(&window, Role::Stamped),
        Some(PartSource::File(stamped)),
        "the first one stays"
    );
    // Over a 3D window it is the part of that window.
    window.event(Event::PointerMoved(pos2(1200.0, 300.0)));
    window.run_steps(1);
    assert_eq!(
        hovered(&mut window, 1).as_deref(),
        Some("Drop as the stamped part")
    );
}

#[test]
fn a_project_that_is_dropped_on_section_4_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, [_, second, _]) = with_section_4(folder.path());
    set_pose(&mut window);
    let project = folder.path().join("work.shapematch");
    window
        .state()
        .state()
        .to_project(0)
        .write(&project)
        .unwrap();
    drop_files(&mut window, &[&second]);
    finish(&mut window);
    assert_eq!(stamped_names(&window), ["stamped.dynain", "second.dynain"]);
    point_at_map(&mut window);
    let file = egui::HoveredFile {
        path: Some(project.clone()),
        ..egui::HoveredFile::default()
    };
    assert_eq!(
        said_of(&mut window, vec![file]).as_deref(),
        Some("Drop to open the project")
    );
    drop_files(&mut window, &[&project]);
    finish(&mut window);
    let opened = window.state().state().project_path().cloned();
    assert_eq!(opened, Some(project));
    assert_eq!(stamped_names(&window), ["stamped.dynain"]);
}

#[test]
fn a_file_goes_to_the_window_it_is_dropped_on_whenever_the_pointer_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let [crash, stamped] = files(folder.path());
    let mut window = window();
    // On the right window, with the pointer known.
    window.event(Event::PointerMoved(pos2(1200.0, 300.0)));
    window.run_steps(1);
    drop_files(&mut window, &[&crash]);
    finish(&mut window);
    let right = Some(PartSource::File(crash.clone()));
    assert_eq!(part_of(&window, Role::Stamped), right);
    // A desktop that gives the pointer back only after the drop: on the left window.
    window.event(Event::PointerGone);
    window.run_steps(1);
    drop_files(&mut window, &[&stamped]);
    assert!(
        !window
            .state()
            .state()
            .jobs
            .is_active(JobKey::Load(Role::Crash))
    );
    window.event(Event::PointerMoved(pos2(600.0, 300.0)));
    window.run_steps(2);
    finish(&mut window);
    assert_eq!(
        part_of(&window, Role::Crash),
        Some(PartSource::File(stamped.clone()))
    );
    // One that never does: the content decides which of the two it replaces.
    let swap = action(&window, Action::Swap);
    act(&mut window, swap);
    window.event(Event::PointerGone);
    window.run_steps(1);
    drop_files(&mut window, &[&stamped]);
    wait_until(&mut window, "it is read", |window| {
        window.state().state().jobs.is_busy() || !window.state().is_idle()
    });
    finish(&mut window);
    assert_eq!(
        part_of(&window, Role::Stamped),
        Some(PartSource::File(stamped))
    );
    assert_eq!(part_of(&window, Role::Crash), right);
}

#[test]
fn a_file_that_changes_on_disk_is_offered_to_be_read_again() {
    let (_folder, [_, stamped], mut window) = both_dropped();
    click(&mut window, "Match the parts");
    finish(&mut window);
    let has_changed = |window: &Window| window.state().state().has_changed_on_disk(Role::Stamped);
    assert!(!has_changed(&window));
    assert!(window.query_by_label("Reload the stamped file").is_none());
    let content = |window: &Window| {
        let part = window.state().state().document.part(Role::Stamped);
        part.expect("loaded").loaded.hash()
    };
    let before = content(&window);

    let text = std::fs::read_to_string(&stamped).unwrap();
    std::fs::write(&stamped, format!("$ written anew\n{text}")).unwrap();
    wait_until(&mut window, "the change is noticed", has_changed);
    window.run_steps(2);
    assert_eq!(content(&window), before, "nothing is read unasked");
    let toasts = window.state().state().log.notices.toasts();
    assert_eq!(
        toasts
            .filter(|toast| toast.offers == [Action::ReloadChanged])
            .count(),
        1
    );
    // Nothing folds or unfolds by itself now: the header of the section says it.
    let open = ViewCommand::OpenSection(Section::Load, true);
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![open.into()], &ctx);
    window.run_steps(2);
    click(&mut window, "Reload the stamped file");
    finish(&mut window);
    assert_ne!(content(&window), before);
    assert!(!has_changed(&window));
    let state = window.state().state();
    assert!(
        state.document.result.is_some(),
        "the result stays to be seen"
    );
    assert!(
        state.document.current_result().is_none(),
        "it is out of date"
    );
    let offers = |toast: &&shapematch::app::Notice| toast.offers == [Action::ReloadChanged];
    assert_eq!(state.log.notices.toasts().filter(offers).count(), 0);
    // The step back is the old content, which the file no longer has.
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    assert_eq!(content(&window), before);
    wait_until(
        &mut window,
        "the old content is told from the new",
        has_changed,
    );
}

/// What a screen reader would tell as news: kind of news and text.
fn news(window: &Window) -> Vec<(Live, String)> {
    let mut found = Vec::new();
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        queue.extend(node.children());
        let inner = node.accesskit_node();
        let live = inner.live();
        if live != Live::Off {
            let text = inner.label().or_else(|| inner.value());
            found.push((live, text.unwrap_or_default()));
        }
    }
    found
}

#[test]
fn a_screen_reader_hears_what_is_shown_and_what_became_of_it() {
    let mut window = window();
    window.check_accessibility();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let canvases = |window: &Window| {
        let found = window.query_all_by(|node| node.role() == Kind::Canvas);
        let labels = found.filter_map(|node| node.accesskit_node().label());
        labels.collect::<Vec<_>>()
    };
    let shown = canvases(&window);
    assert!(
        shown.iter().any(|label| label.starts_with("Crash part, ")),
        "{shown:?}"
    );
    assert!(
        shown
            .iter()
            .any(|label| label.ends_with(", isometric view")),
        "{shown:?}"
    );
    let commands = action(&window, Action::MatchOrStop);
    act(&mut window, commands);
    wait_until(
        &mut window,
        "the match tells its state or has ended",
        |window| {
            let is_told = news(window).iter().any(|(_, text)| !text.is_empty());
            is_told || window.state().is_idle()
        },
    );
    finish(&mut window);
    let verdict = |(live, text): &(Live, String)| *live == Live::Polite && text.contains("GOOD");
    let told = news(&window);
    assert!(told.iter().any(verdict), "{told:?}");
    window.check_accessibility();
    // An error is told at once.
    act(
        &mut window,
        vec![Command::Notice(shapematch::app::NoticeCommand::Tell(
            shapematch::app::NoticeLevel::Error,
            "the disk is full".to_owned(),
        ))],
    );
    let told = news(&window);
    let error =
        |(live, text): &(Live, String)| *live == Live::Assertive && text.ends_with("disk is full");
    assert!(told.iter().any(error), "{told:?}");
    for over in [
        Action::ToggleMoveOver,
        Action::ToggleDeviation,
        Action::MapOrCancel,
    ] {
        let commands = action(&window, over);
        act(&mut window, commands);
        finish(&mut window);
        window.check_accessibility();
    }
    let shown = canvases(&window);
    assert!(
        shown
            .iter()
            .any(|label| label.contains("with the stamped part")),
        "{shown:?}"
    );
}

fn action(window: &Window, action: Action) -> Vec<Command> {
    action.command(window.state().state()).into_iter().collect()
}

/// Places of everything that is painted.
fn painted(window: &Window) -> Vec<[i32; 4]> {
    let shapes = window.output().shapes.iter();
    let rects = shapes.filter(|clipped| !matches!(clipped.shape, Shape::Callback(_)));
    let rects = rects.map(|clipped| clipped.shape.visual_bounding_rect());
    let ends = rects.map(|rect| [rect.min.x, rect.min.y, rect.max.x, rect.max.y]);
    ends.map(|ends| ends.map(|x| x.round() as i32)).collect()
}

#[test]
fn without_motion_everything_is_where_it_belongs_in_the_next_frame() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.run_steps(40);
    let settings = Settings {
        reduce_motion: true,
        ..window.state().state().settings.clone()
    };
    act(&mut window, vec![Command::Settings(Box::new(settings))]);
    let mut is_at_rest = |what: &str, step: &mut dyn FnMut(&mut Window)| {
        step(&mut window);
        window.run_steps(4);
        let soon = painted(&window);
        window.run_steps(60);
        assert_eq!(soon, painted(&window), "{what} moves on");
    };
    is_at_rest("a view by key", &mut |window| window.key_press(Key::Num7));
    is_at_rest("a fold", &mut |window| click(window, "2 Reduce"));
    is_at_rest("a menu", &mut |window| click(window, "View"));
    is_at_rest("its end", &mut |window| window.key_press(Key::Escape));
    is_at_rest("moving over", &mut |window| window.key_press(Key::M));
}

#[test]
fn a_section_of_parts_that_lie_apart_says_so_and_shows_each() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let section = action(&window, Action::ToggleSection);
    act(&mut window, section);
    let says = |window: &Window, begin: &str| {
        let mut texts = window.query_all_by(|node| {
            let value = node.value();
            value.is_some_and(|value| value.starts_with(begin))
        });
        texts.next().is_some()
    };
    wait_until(&mut window, "a part alone", |window| {
        says(window, "The plane meets the crash part alone")
    });
    let far = MoveCommand::Translate {
        axis: Axis::Y,
        frame: AxisFrame::Global,
        distance: 5000.0,
    };
    act(
        &mut window,
        vec![MoveCommand::AlignCenters.into(), far.into()],
    );
    wait_until(&mut window, "parts apart", |window| {
        says(window, "The parts lie ")
    });
    window.run_steps(2);
    assert!(window.query_by_label("Worst gap").is_none());
    click(&mut window, "Show the outline of the stamped part");
    click(&mut window, "Match the parts");
    finish(&mut window);
    wait_until(&mut window, "the widest gap", |window| {
        says(window, "Widest gap ")
    });
    window.run_steps(2);
    assert!(window.query_by_label("Worst gap").is_some());
}
