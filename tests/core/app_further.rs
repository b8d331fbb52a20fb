//! Several stamped files for one crash part, in section 4 without a window: read, matched, mapped from,
//! undone, kept in a project, and written as the command line writes them.

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use shapematch::app::{
    Action, Command, Dialog, FileCommand, FurtherPose, HistoryCommand, MapCommand, MatchCommand,
    MoveCommand, NoticeLevel, ProjectCommand, Reason, Section, StampedState, ViewCommand,
};
use shapematch::assess::Verdict;
use shapematch::colormap::ColorScale;
use shapematch::geometry::{Point3, Similarity, Vector3};
use shapematch::jobs::{JobKey, Located, ProjectFile, ProjectRequest};
use shapematch::mapping::Overlap;
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, load};
use shapematch::pipeline::map::{WriteKind, place, placing_recipe};
use shapematch::pipeline::outputs::Output;
use shapematch::pipeline::project::Project;
use shapematch::registration::Hand;
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;
use shapematch::units::{LengthUnit, Units};

use super::app::Window;
use super::app_mapping::real;
use super::bracket::write_bracket;

/// Halves of the bracket overlap by so much, so that no element lies between them.
const LAP: f64 = 3.0;

/// A rotation about all axes with a translation.
fn moved() -> Similarity {
    let axis = Vector3::new(1.0, 2.0, 3.0);
    let rotation = shapematch::app::rotation_about(&Point3::origin(), &axis, 0.7);
    Similarity {
        translation: Vector3::new(120.0, -40.0, 310.0),
        ..rotation
    }
}

/// The part of a stamped deck whose elements lie on one side in x, moved.
fn half(deck: &str, is_kept: impl Fn(f64) -> bool, motion: &Similarity) -> String {
    let number = |text: &str| text.trim().parse::<f64>().unwrap();
    let node = |line: &str| {
        let place = [8, 24, 40].map(|at| number(&line[at..at + 16]));
        (number(&line[..8]) as usize, Point3::from(place))
    };
    let mut x_of = vec![0.0; 100_000];
    let (mut keyword, mut lines, mut is_left_out) = (String::new(), Vec::new(), false);
    let mut n_of_block = 0;
    for line in deck.lines() {
        n_of_block += 1;
        if line.starts_with('*') {
            keyword = line.to_owned();
            n_of_block = 0;
        } else if keyword == "*NODE" && !line.starts_with('$') {
            let (id, place) = node(line);
            x_of[id] = place.x;
            let [x, y, z] = motion.apply(&place).into();
            lines.push(format!("{id:8}{x:16.8}{y:16.8}{z:16.8}"));
            continue;
        } else if keyword == "*ELEMENT_SHELL_THICKNESS" {
            if n_of_block % 2 == 1 {
                let corners = [16, 24, 32, 40].map(|at| number(&line[at..at + 8]) as usize);
                let middle = corners.map(|corner| x_of[corner]).iter().sum::<f64>() / 4.0;
                is_left_out = !is_kept(middle);
            }
            if is_left_out {
                continue;
            }
        }
        lines.push(line.to_owned());
    }
    lines.join("\n") + "\n"
}

/// The same deck in metres: coordinates and thicknesses, which alone have sixteen columns.
fn in_metres(deck: &str) -> String {
    let mut keyword = "";
    let mut n_of_block = 0;
    let lines = deck.lines().map(|line| {
        n_of_block += 1;
        if line.starts_with('*') {
            keyword = line;
            n_of_block = 0;
        }
        let (first, is_length) = match keyword {
            "*NODE" => (8, true),
            "*ELEMENT_SHELL_THICKNESS" => (0, n_of_block % 2 == 0),
            _ => (0, false),
        };
        if !is_length || line.starts_with(['$', '*']) {
            return line.to_owned();
        }
        let mut scaled = line[..first].to_owned();
        for at in (first..line.len()).step_by(16) {
            let number: f64 = line[at..(at + 16).min(line.len())].trim().parse().unwrap();
            scaled += &format!("{:16.9e}", number / 1000.0);
        }
        scaled
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// The crash bracket, and its stamped part as two files: one half as it was formed, the other somewhere
/// else.
pub(super) struct Halves {
    folder: tempfile::TempDir,
    crash: PathBuf,
    pub(super) stamped: [PathBuf; 2],
    crash_from_first: Similarity,
}

impl Halves {
    pub(super) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let pair = write_bracket(folder.path(), SampleVariant::Plain);
        let whole = std::fs::read_to_string(folder.path().join("stamped.dynain")).unwrap();
        let stamped = ["left.dynain", "right.dynain"].map(|name| folder.path().join(name));
        let left = half(&whole, |x| x < LAP, &Similarity::identity());
        let right = half(&whole, |x| x > -LAP, &moved());
        for (path, text) in stamped.iter().zip([left, right]) {
            std::fs::write(path, text).unwrap();
        }
        Self {
            crash: folder.path().join("crash.k"),
            crash_from_first: pair.crash_from_stamped,
            folder,
            stamped,
        }
    }

    /// A window with the first half at its known pose.
    pub(super) fn window(&self) -> Window {
        let mut window = Window::new();
        window.runner = Some(real);
        window.open(self.crash.to_str().unwrap(), Role::Crash);
        window.open(self.stamped[0].to_str().unwrap(), Role::Stamped);
        window.apply(MoveCommand::SetPose {
            crash_from_stamped: self.crash_from_first,
            name: "Known pose".to_owned(),
        });
        window
    }

    /// A window with both halves.
    pub(super) fn with_both(&self) -> Window {
        let mut window = self.window();
        window.apply(MapCommand::AddFurther(self.stamped[1].clone()));
        assert_eq!(window.state.document.mapping.further.len(), 1);
        window
    }
}

fn states(window: &Window) -> Vec<StampedState> {
    let rows = window.state.stamped_rows();
    rows.into_iter().map(|row| row.state).collect()
}

fn verdicts(window: &Window) -> Vec<Option<Verdict>> {
    let verdict = |state| match state {
        StampedState::Matched(verdict, _) => Some(verdict),
        _ => None,
    };
    states(window).into_iter().map(verdict).collect()
}

pub(super) fn first_further(window: &Window) -> u64 {
    window.state.document.mapping.further[0].revision
}

/// The bytes of an output as the window writes it.
fn written(window: &mut Window, output: Output, path: &Path) -> Vec<u8> {
    let command = shapematch::app::ExportCommand::Write {
        kind: output,
        path: path.to_owned(),
    };
    window.apply(command);
    std::fs::read(path).unwrap()
}

/// The words of a line as a shell splits it.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut is_quoted) = (Vec::new(), String::new(), false);
    for c in line.chars() {
        match c {
            '\'' => is_quoted = !is_quoted,
            ' ' if !is_quoted => words.push(std::mem::take(&mut word)),
            c => word.push(c),
        }
    }
    words.push(word);
    words
}

fn run_line(line: &str, more: &[&str]) -> std::process::Output {
    let words = words(line);
    assert_eq!(words[0], "shapematch");
    let mut process = Process::new(env!("CARGO_BIN_EXE_shapematch"));
    process.args(&words[1..]).args(more).output().unwrap()
}

#[test]
fn a_further_file_is_matched_by_itself_and_mapped_from() {
    let halves = Halves::new();
    let mut window = halves.window();
    assert_eq!(states(&window), [StampedState::ByHand]);
    window.apply(MatchCommand::Run);
    window.act(Action::MapOrCancel);
    let alone = window.state.document.current_mapping().unwrap();
    assert!(alone.record.mapped_area < 0.7, "one half alone");
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    assert_eq!(verdicts(&window), [Some(Verdict::Good); 2]);
    // The mapping that is there was made from one file.
    let stale = window.state.stale(Section::Map).unwrap();
    assert_eq!(stale.reason, "the stamped files changed after the mapping");

    // The pose is the one that the command line would find, to the last bit.
    let monitor = Monitor::silent();
    let read = |path: &Path| load(path, &LoadSettings::default(), &monitor).unwrap();
    let (crash, right) = (read(&halves.crash), read(&halves.stamped[1]));
    let parts = PerRole::new(&crash, &right);
    let run = place(parts, &placing_recipe(Hand::Same), &monitor).unwrap();
    let poses = window.state.document.further_poses().unwrap();
    assert_eq!(poses, [run.crash_from_stamped]);
    // And it is that of the first half after the motion of the second.
    let there = poses[0].after(&moved()).apply(&Point3::new(20.0, 5.0, 8.0));
    let expected = halves.crash_from_first.apply(&Point3::new(20.0, 5.0, 8.0));
    assert!((there - expected).norm() < 0.5, "{there} {expected}");

    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    assert!(
        result.record.mapped_area > 0.99,
        "{:?}",
        result.record.statuses
    );
    assert_eq!(result.record.stamped.len(), 2);
    // Statistics are of both, each where the values come from it.
    let pair = result.record.thickness.as_ref().unwrap();
    let change = pair.crash.mean / pair.stamped.mean - 1.0;
    assert!(change.abs() < 0.005, "{change}");
    let covered = &result.run.checks.map_back.as_ref().unwrap().is_covered;
    let area = |number: usize| {
        let areas = result.run.sources[number].mesh.areas().iter();
        let covered = areas.zip(&covered[number]).filter(|(_, covered)| **covered);
        covered.map(|(area, _)| area).sum::<f64>()
    };
    let both = (area(0) + area(1)) / result.run.target.mesh.area();
    assert!(
        (both - 1.0).abs() < 0.03,
        "nothing is counted twice: {both}"
    );
    assert_eq!(window.state.stale(Section::Map), None);

    // Undo takes the mapping away, then the file; redo brings it back with its pose and no new match.
    window.apply(HistoryCommand::Undo);
    window.apply(HistoryCommand::Undo);
    assert!(window.state.document.mapping.further.is_empty());
    assert!(window.state.document.current_mapping().is_some());
    window.holds = true;
    window.apply(HistoryCommand::Redo);
    assert!(window.held.is_empty());
    assert_eq!(verdicts(&window), [Some(Verdict::Good); 2]);
    window.holds = false;
    // The file can be taken out, and that can be undone.
    let revision = first_further(&window);
    window.apply(MapCommand::RemoveFurther(revision));
    assert_eq!(window.state.stamped_rows().len(), 1);
    window.apply(HistoryCommand::Undo);
    assert_eq!(window.state.stamped_rows().len(), 2);
    // A file is not added twice.
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    window.apply(MapCommand::AddFurther(halves.stamped[0].clone()));
    assert_eq!(window.state.stamped_rows().len(), 2);
}

#[test]
fn stamped_files_of_one_name_are_told_apart_by_their_folders() {
    let halves = Halves::new();
    let mut window = halves.window();
    let folder = halves.folder.path().join("other");
    std::fs::create_dir(&folder).unwrap();
    let other = folder.join("left.dynain");
    std::fs::copy(&halves.stamped[1], &other).unwrap();
    window.apply(MapCommand::AddFurther(other));
    let own = halves.folder.path().file_name().unwrap();
    let told = [Path::new(own), Path::new("other")].map(|folder| {
        let name = folder.join("left.dynain");
        name.display().to_string()
    });
    let rows = window.state.stamped_rows();
    assert_eq!(
        rows.iter().map(|row| &row.name).collect::<Vec<_>>(),
        [&told[0], &told[1]]
    );
    let poses = window.state.document.mapped_poses();
    assert_eq!(
        poses.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        [&told[0], &told[1]]
    );
    // So are they in what is said of the mapping.
    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    let pose = result
        .record
        .checks
        .iter()
        .find(|check| check.name == "Pose");
    let found = &pose.unwrap().found;
    assert!(found.starts_with(&told[0]), "{found}");
    let warnings = &result.record.warnings;
    assert!(
        warnings.iter().any(|line| line.contains(&told[0])),
        "{warnings:?}"
    );
}

#[test]
fn the_deck_of_several_files_is_that_of_the_command_line() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    let mut options = window.state.document.mapping.recipe.options.clone();
    options.overlap = Overlap::First;
    window.apply(MapCommand::SetOptions(Box::new(options)));
    window.act(Action::MapOrCancel);
    let line = window.state.document.map_command_line().unwrap();
    assert_eq!(line.matches("--pose").count(), 2, "{line}");
    assert!(
        line.contains("left.dynain ") && line.contains("right.dynain "),
        "{line}"
    );
    assert!(line.contains("--overlap first"), "{line}");
    for kind in WriteKind::ALL {
        // Of one name, which an include says of the file beside it.
        let [path, other] = ["window", "line"].map(|folder| {
            let folder = halves.folder.path().join(folder);
            std::fs::create_dir_all(&folder).unwrap();
            folder.join(format!("{}.k", kind.name()))
        });
        let own = written(&mut window, Output::Mapped(kind), &path);
        let more = ["--write", kind.name(), "--out", other.to_str().unwrap()];
        let done = run_line(&line, &more);
        assert!(done.status.success(), "{done:?}");
        let theirs = std::fs::read(&other).unwrap();
        assert!(own == theirs, "{kind:?}");
        let text = String::from_utf8(own).unwrap();
        let names_both = text.contains("left.dynain") && text.contains("right.dynain");
        assert!(names_both || kind == WriteKind::Deck);
    }
    // So are the table and the figures; the report tells of both files.
    let path = halves.folder.path().join("window.csv");
    let own = written(&mut window, Output::MapTable, &path);
    let other = halves.folder.path().join("line.csv");
    run_line(&line, &["--csv", other.to_str().unwrap()]);
    assert!(own == std::fs::read(&other).unwrap());
    let path = halves.folder.path().join("window.html");
    let page = written(&mut window, Output::MapReport, &path);
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("left.dynain") && page.contains("right.dynain"));
    // And of what each gave, with the colours of the picture.
    assert!(page.contains("Which stamped file gave the elements their values"));
    let scale = ColorScale::files();
    for (number, name) in ["left.dynain", "right.dynain"].into_iter().enumerate() {
        let [r, g, b] = scale.color(ColorScale::file_value(number));
        let row = format!("background:#{r:02x}{g:02x}{b:02x}\"></i>{name}");
        assert!(page.contains(&row), "{row}");
    }
    // No output takes the place of a further file.
    let before = std::fs::read(&halves.stamped[1]).unwrap();
    let after = written(&mut window, Output::MapTable, &halves.stamped[1]);
    assert!(before == after);
}

/// The halves, of which the second file is in metres.
fn one_in_metres() -> Halves {
    let halves = Halves::new();
    let right = &halves.stamped[1];
    let metres = in_metres(&std::fs::read_to_string(right).unwrap());
    std::fs::write(right, metres).unwrap();
    halves
}

/// What the lengths of the further file are multiplied by.
fn factor(window: &Window) -> f64 {
    let further = &window.state.document.mapping.further[0];
    further.loaded.settings.length_factor
}

fn set_units(window: &mut Window, units: Option<Units>) {
    let revision = first_further(window);
    window.apply(MapCommand::SetFurtherUnits(revision, units));
}

#[test]
fn each_stamped_file_may_have_a_unit_of_its_own() {
    let halves = one_in_metres();
    let mut window = halves.with_both();
    // As it is, it fits nowhere, and the list says why.
    assert_eq!(factor(&window), 1.0);
    assert_ne!(verdicts(&window)[1], Some(Verdict::Good));
    let placing = window.state.document.mapping.further[0].placing.clone();
    let reason = placing.and_then(|placing| placing.reason).unwrap();
    let doubts = [0, 1].map(|n| window.state.match_doubt(n));
    assert_eq!(doubts, [None, Some(window.state.reason_words(&reason))]);
    let hint = window.state.stamped_rows()[1].unit_hint.unwrap();
    assert!(hint.words().contains("1000 × smaller"), "{}", hint.words());
    assert_eq!(window.state.stamped_rows()[0].unit_hint, None);

    let is_warned = |window: &Window| {
        let mut toasts = window.state.log.notices.toasts();
        toasts.any(|toast| toast.text.contains("is poor"))
    };
    assert!(is_warned(&window));

    let metre = Units::from(LengthUnit::Meter);
    set_units(&mut window, Some(metre));
    assert!(!is_warned(&window), "the warning was of the pose before");
    assert_eq!(factor(&window), 1000.0);
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));
    let row = window.state.stamped_rows()[1].clone();
    assert_eq!((row.own_units, row.unit_hint), (Some(metre), None));
    assert_eq!(window.part(Role::Stamped).length_factor(), 1.0);
    // One undo step, which the match that follows belongs to.
    window.holds = true;
    assert_eq!(
        window.state.history.undo_name(),
        Some("right.dynain is in m")
    );
    window.apply(HistoryCommand::Undo);
    assert_eq!(factor(&window), 1.0);
    window.apply(HistoryCommand::Redo);
    assert!(window.held.is_empty(), "its pose comes back with it");
    window.holds = false;
    assert_eq!(factor(&window), 1000.0);

    // The file keeps it when it is added again.
    let revision = first_further(&window);
    window.apply(MapCommand::RemoveFurther(revision));
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    assert_eq!(factor(&window), 1000.0);
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));
    set_units(&mut window, None);
    assert_eq!(factor(&window), 1.0, "as the first");
}

#[test]
fn the_deck_of_files_in_two_units_is_that_of_the_command_line() {
    let halves = one_in_metres();
    let mut window = halves.with_both();
    set_units(&mut window, Some(LengthUnit::Meter.into()));
    window.act(Action::MapOrCancel);
    let document = &window.state.document;
    assert!(document.current_mapping().unwrap().record.mapped_area > 0.99);
    let line = document.map_command_line().unwrap();
    let told = "--stamped-length-factor 1.0 --stamped-length-factor 1000.0";
    assert!(line.contains(told), "{line}");
    let [path, other] = ["window", "line"].map(|folder| {
        let folder = halves.folder.path().join(folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder.join("mapped.k")
    });
    for kind in WriteKind::ALL {
        let own = written(&mut window, Output::Mapped(kind), &path);
        let more = ["--write", kind.name(), "--out", other.to_str().unwrap()];
        let done = run_line(&line, &more);
        assert!(done.status.success(), "{done:?}");
        assert!(own == std::fs::read(&other).unwrap(), "{kind:?}");
        let text = String::from_utf8(own).unwrap();
        assert!(text.contains("its lengths multiplied by 1000") || kind == WriteKind::Deck);
    }
    let path = halves.folder.path().join("window.html");
    let page = String::from_utf8(written(&mut window, Output::MapReport, &path)).unwrap();
    assert!(page.contains("right.dynain, lengths × 1000"));
    // Naming the unit of the first one, which is what it was taken for, changes no values.
    let millimetre = Some(LengthUnit::Millimeter.into());
    window.apply(FileCommand::SetUnits {
        role: Role::Stamped,
        units: millimetre,
    });
    assert_eq!(window.state.stale(Section::Map), None);

    // A project keeps it.
    let path = halves.folder.path().join("work.shapematch");
    save(&mut window, &path);
    let again = open(&path);
    assert_eq!(factor(&again), 1000.0);
    assert_eq!(again.state.document.map_command_line(), Some(line));
    // Its poses are those of these lengths alone.
    let map = |factors: &[&str]| {
        let mut process = Process::new(env!("CARGO_BIN_EXE_shapematch"));
        process.arg("map").arg(&halves.crash).args(&halves.stamped);
        process.arg("--project").arg(&path).args(factors);
        process.output().unwrap()
    };
    let done = map(&[]);
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    let stderr = String::from_utf8(done.stderr).unwrap();
    assert!(stderr.contains(told), "{stderr}");
    let done = map(&told.split(' ').collect::<Vec<_>>());
    assert!(done.status.success(), "{done:?}");
}

#[test]
fn as_many_length_factors_as_stamped_files() {
    let halves = Halves::new();
    let refused = |program: &str, files: &[&PathBuf], n_factors: usize| {
        let mut process = Process::new(env!("CARGO_BIN_EXE_shapematch"));
        process.arg(program).arg(&halves.crash).args(files);
        process.args(vec!["--stamped-length-factor=2"; n_factors]);
        if program == "map-car" {
            process.arg("--out").arg(halves.folder.path());
        }
        let done = process.output().unwrap();
        assert_eq!(done.status.code(), Some(2), "{done:?}");
        String::from_utf8(done.stderr).unwrap()
    };
    let [left, right] = &halves.stamped;
    for program in ["map", "map-car"] {
        let told = refused(program, &[left, right], 3);
        let expected = "3 length factors for 2 stamped files; give one for all or one for each";
        assert!(told.contains(expected), "{told}");
        let told = refused(program, &[left], 2);
        assert!(
            told.contains("2 length factors for 1 stamped file;"),
            "{told}"
        );
    }
}

#[test]
fn a_choice_of_parts_in_one_file_is_said_for_each() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    // Of the first file a part is chosen.
    let used = window.part(Role::Stamped).facts.used.clone();
    let id = *used.iter().next().unwrap();
    let part = shapematch::app::PartRef {
        role: Role::Stamped,
        id,
    };
    window.apply(shapematch::app::PartCommand::UseOnly(part));
    window.act(Action::MapOrCancel);
    let line = window.state.document.map_command_line().unwrap();
    let selection = &window.part(Role::Stamped).loaded.settings.selection;
    let expected = format!("--stamped-part {} --stamped-part sheet", selection.typed());
    if selection.typed() != "sheet" {
        assert!(line.contains(&expected), "{line}");
    }
    let other = halves.folder.path().join("line.csv");
    let done = run_line(&line, &["--csv", other.to_str().unwrap()]);
    assert!(done.status.success(), "{done:?}");
    let path = halves.folder.path().join("window.csv");
    let own = written(&mut window, Output::MapTable, &path);
    assert!(own == std::fs::read(&other).unwrap());
    // Of three files two choices are of no use.
    let done = run_line(
        &line,
        &[
            "--stamped-part",
            "1",
            "--stamped-part",
            "1",
            "--stamped-part",
            "1",
        ],
    );
    assert_eq!(done.status.code(), Some(2), "{done:?}");
}

#[test]
fn a_file_lies_as_the_first_one_where_that_is_chosen() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    let revision = first_further(&window);
    window.apply(MapCommand::SetFurtherPose(revision, FurtherPose::AsFirst));
    assert_eq!(
        window.state.document.further_poses().unwrap(),
        [window.pose()]
    );
    assert_eq!(states(&window)[1], StampedState::AsFirst);
    window.act(Action::FlipX);
    assert_eq!(
        window.state.document.further_poses().unwrap(),
        [window.pose()]
    );
    // Its own match is still known.
    window.holds = true;
    window.apply(MapCommand::SetFurtherPose(revision, FurtherPose::Matched));
    assert!(window.held.is_empty());
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));
    window.apply(HistoryCommand::Undo);
    assert_eq!(states(&window)[1], StampedState::AsFirst);
}

#[test]
fn the_list_tells_what_is_read_matched_and_wrong() {
    let halves = Halves::new();
    let mut window = halves.window();
    window.holds = true;
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    assert_eq!(states(&window)[1], StampedState::Reading);
    // Not mapped from before it is there, and it can be given up.
    let revision = window.state.stamped_rows()[1].removed_by.unwrap();
    window.apply(MapCommand::RemoveFurther(revision));
    assert!(window.held.is_empty());
    assert_eq!(window.state.stamped_rows().len(), 1);

    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    let (id, kind, stamp) = window.held.pop().unwrap();
    window.finish(id, kind, stamp);
    // Read; its match runs, and there is nothing to be mapped until it has a pose.
    assert_eq!(states(&window)[1], StampedState::Matching);
    assert!(Action::MapOrCancel.enabled(&window.state).is_err());
    assert!(window.state.document.map_command_line().is_none());
    // Esc gives the match up, which is not begun anew by itself.
    window.close_toasts();
    window.apply(Command::Escape);
    assert!(window.held.is_empty());
    assert_eq!(states(&window)[1], StampedState::NotMatched(None));
    window.act(Action::FlipX);
    assert!(!window.state.jobs.is_active(JobKey::PlaceFurther));
    let Reason(reason) = window.state.document.can_map().unwrap_err();
    assert!(reason.contains("lie as the first one"), "{reason}");
    let revision = first_further(&window);
    window.apply(MapCommand::MatchFurther(revision));
    // The overlap after the move is counted first.
    let (id, kind, stamp) = window.held.remove(0);
    window.finish(id, kind, stamp);
    assert_eq!(states(&window)[1], StampedState::Matching);
    window.finish_held();
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));

    // What cannot be read stays in the list with the reason, until it is taken out.
    let gone = halves.folder.path().join("gone.dynain");
    window.apply(MapCommand::AddFurther(gone));
    let StampedState::NotRead(reason) = &states(&window)[2] else {
        panic!("{:?}", states(&window));
    };
    assert!(reason.contains("gone.dynain"), "{reason}");
    assert!(window.state.document.can_map().is_ok());
    let row = &window.state.stamped_rows()[2];
    window.apply(MapCommand::RemoveFurther(row.removed_by.unwrap()));
    assert_eq!(window.state.stamped_rows().len(), 2);
}

#[test]
fn the_list_begins_anew_with_another_pair() {
    let halves = Halves::new();
    let mut window = halves.window();
    let n_rows = |window: &Window| window.state.stamped_rows().len();
    let add_missing = |window: &mut Window| {
        window.apply(MapCommand::AddFurther(
            halves.folder.path().join("gone.dynain"),
        ));
        assert!(matches!(states(window)[1], StampedState::NotRead(_)));
    };
    add_missing(&mut window);
    window.apply(FileCommand::Close(Role::Crash));
    window.open(halves.crash.to_str().unwrap(), Role::Crash);
    assert_eq!(n_rows(&window), 1);

    let path = halves.folder.path().join("work.shapematch");
    save(&mut window, &path);
    add_missing(&mut window);
    window.apply(ProjectCommand::Open(ProjectRequest {
        path,
        ..ProjectRequest::default()
    }));
    assert_eq!(n_rows(&window), 1);

    // A file that is being read was meant for the crash part before.
    window.holds = true;
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    assert_eq!(states(&window)[1], StampedState::Reading);
    window.act(Action::Swap);
    assert_eq!(n_rows(&window), 1);
    window.finish_held();
    assert_eq!(n_rows(&window), 1);
    assert!(window.state.document.mapping.further.is_empty());
}

#[test]
fn further_files_follow_the_crash_part() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    // Read again, it is matched again, and what was mapped is out of date.
    window.act(Action::MapOrCancel);
    let before = first_further(&window);
    window.apply(FileCommand::ReloadAll);
    assert_ne!(first_further(&window), before);
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));
    let rows = window.state.log.rows().iter();
    let added = rows.filter(|row| row.text.ends_with("one more stamped file"));
    assert_eq!(added.count(), 1, "read again, it is no further one");
    assert!(window.state.document.current_mapping().is_none());
    // A file that changed on disk is offered again.
    let watched = window.state.document.files_read();
    assert!(watched.iter().any(|file| *file.path == halves.stamped[1]));
    let changed = std::iter::once(halves.stamped[1].clone()).collect();
    window.apply(FileCommand::ChangedOnDisk(changed));
    assert!(Action::ReloadChanged.enabled(&window.state).is_ok());
    let before = first_further(&window);
    window.act(Action::ReloadChanged);
    assert_ne!(first_further(&window), before);
    assert!(Action::ReloadChanged.enabled(&window.state).is_err());

    // Another unit of the stamped files holds for all.
    let (role, factor) = (Role::Stamped, 1.0005);
    window.apply(FileCommand::SetLengthFactor { role, factor });
    let further = &window.state.document.mapping.further[0];
    assert_eq!(further.loaded.settings.length_factor, factor);
    assert_eq!(verdicts(&window)[1], Some(Verdict::Good));
    window.apply(HistoryCommand::Undo);

    // Another crash part has other stamped files; undo brings them back.
    let other = halves.folder.path().join("other.k");
    std::fs::copy(&halves.crash, &other).unwrap();
    window.open(other.to_str().unwrap(), Role::Crash);
    assert_eq!(window.state.stamped_rows().len(), 1);
    let told = |window: &Window| {
        let mut rows = window.state.log.rows().iter();
        rows.any(|row| row.text.contains("no longer mapped from"))
    };
    assert!(told(&window));
    window.apply(HistoryCommand::Undo);
    assert_eq!(window.state.stamped_rows().len(), 2);
    window.apply(FileCommand::Swap);
    assert!(window.state.document.mapping.further.is_empty());
}

#[test]
fn a_probe_names_the_file_that_gave_the_values() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    window.act(Action::MapOrCancel);
    let document = &window.state.document;
    let run = document.current_mapping().unwrap().run.to_arc();
    let elements = &run.mapped.elements;
    for (number, name) in [(0, "left.dynain"), (1, "right.dynain")] {
        let gives = |report: &shapematch::mapping::ElementReport| {
            report
                .partner
                .is_some_and(|partner| partner.source == number)
        };
        let element = elements.iter().position(gives).unwrap();
        let partner = elements[element].partner.unwrap();
        let shell = run.source_shells[number as usize][partner.element as usize] as usize;
        let part = window.state.document.all_stamped().nth(number as usize);
        let id = part.unwrap().model.shells[shell].id;
        window.apply(MapCommand::Probe(Some(element)));
        let probe = window.state.probe().unwrap();
        assert_eq!(probe.stamped_id, Some(id));
        assert_eq!(probe.stamped_file.as_deref(), Some(name));
        // Both elements can be ringed, each on its own part.
        let places = window.state.probed_places();
        let ringed: Vec<_> = places
            .iter()
            .map(|(role, file, _)| (*role, *file))
            .collect();
        let file = number as usize;
        assert_eq!(ringed, [(Role::Crash, 0), (Role::Stamped, file)]);
        let center = run.sources[file].mesh.centroids()[partner.element as usize];
        assert_eq!(places[1].2, center);
    }
}

fn save(window: &mut Window, path: &Path) {
    window.apply(ProjectCommand::Write(path.to_owned()));
    let mut written = false;
    for effect in std::mem::take(&mut window.effects) {
        if let shapematch::app::Effect::WriteProject { path, project, .. } = effect {
            project.write(&path).unwrap();
            written = true;
        }
    }
    assert!(written);
}

fn open(path: &Path) -> Window {
    let mut window = Window::new();
    window.runner = Some(real);
    window.apply(ProjectCommand::Open(ProjectRequest {
        path: path.to_owned(),
        ..ProjectRequest::default()
    }));
    window
}

#[test]
fn a_project_keeps_further_files() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    let path = halves.folder.path().join("work.shapematch");
    save(&mut window, &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\"right.dynain\""), "relative to the project");
    let (project, notes) = Project::read(&path).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!(project.further_stamped.len(), 1);

    // The same poses to the last bit, without a new match.
    let again = open(&path);
    let poses = |window: &Window| window.state.document.further_poses().unwrap();
    assert_eq!(poses(&again), poses(&window));
    assert_eq!(verdicts(&again), verdicts(&window));
    assert!(!again.state.is_unsaved());
    assert_eq!(
        again.state.document.map_command_line(),
        window.state.document.map_command_line()
    );

    // The command line takes the poses of all of them from it.
    let csv = halves.folder.path().join("project.csv");
    let map = |stamped: &[&str]| {
        let mut words = vec!["map", halves.crash.to_str().unwrap()];
        words.extend(stamped);
        words.extend(["--project", path.to_str().unwrap()]);
        words.extend(["--csv", csv.to_str().unwrap()]);
        let mut process = Process::new(env!("CARGO_BIN_EXE_shapematch"));
        process.args(words).output().unwrap()
    };
    let [left, right] = halves.stamped.each_ref().map(|path| path.to_str().unwrap());
    let done = map(&[left, right]);
    assert!(done.status.success(), "{done:?}");
    window.act(Action::MapOrCancel);
    let own = halves.folder.path().join("window.csv");
    assert!(written(&mut window, Output::MapTable, &own) == std::fs::read(&csv).unwrap());
    let done = map(&[left]);
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    let told = String::from_utf8(done.stderr).unwrap();
    assert!(
        told.contains("holds 2 stamped files, but 1 are named"),
        "{told}"
    );

    // A file that was moved is asked for, or done without.
    let elsewhere = halves.folder.path().join("elsewhere.dynain");
    std::fs::rename(&halves.stamped[1], &elsewhere).unwrap();
    let mut asked = open(&path);
    assert_eq!(asked.state.view.dialog, Some(Dialog::MissingFiles));
    let file = ProjectFile::Further(0);
    let (_, missing) = asked.state.project.missing.clone().unwrap();
    assert_eq!(missing, [(file, halves.stamped[1].clone())]);
    asked.apply(ProjectCommand::Locate(file, Located::At(elsewhere.clone())));
    assert_eq!(poses(&asked), poses(&window));
    let mut without = open(&path);
    without.apply(ProjectCommand::Locate(file, Located::Without));
    assert!(without.state.document.mapping.further.is_empty());
    assert_eq!(without.pose(), window.pose());

    // One that has changed is told and matched anew.
    std::fs::rename(&elsewhere, &halves.stamped[1]).unwrap();
    let mut changed = std::fs::read_to_string(&halves.stamped[1]).unwrap();
    changed.push_str("$ changed\n");
    std::fs::write(&halves.stamped[1], changed).unwrap();
    let again = open(&path);
    let is_told = |row: &shapematch::app::LogRow| {
        row.level == NoticeLevel::Warning && row.text.contains("right.dynain has changed since")
    };
    assert!(again.state.log.rows().iter().any(is_told));
    assert_eq!(verdicts(&again)[1], Some(Verdict::Good));
    // Projects without such files open as before.
    let mut window = halves.window();
    save(&mut window, &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("further_stamped"));
    assert_eq!(open(&path).state.stamped_rows().len(), 1);
}

#[test]
fn the_match_of_a_further_file_is_told_with_the_decimals_of_now() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    let path = halves.folder.path().join("work.shapematch");
    save(&mut window, &path);
    let told = |window: &Window| match &states(window)[1] {
        StampedState::Matched(_, line) => line.clone(),
        other => panic!("{other:?}"),
    };
    window.state.settings.decimals = Some(1);
    let short = told(&window);
    window.state.settings.decimals = Some(6);
    let long = told(&window);
    assert!(
        short.starts_with("GOOD") && short.len() < long.len(),
        "{short}; {long}"
    );

    let mut again = open(&path);
    again.state.settings.decimals = Some(6);
    assert_eq!(told(&again), long);

    // Older projects have the line as text.
    let text = std::fs::read_to_string(&path).unwrap();
    let mut project: serde_json::Value = serde_json::from_str(&text).unwrap();
    let placing = &mut project["further_stamped"][0]["placing"];
    let fields = placing.as_object_mut().unwrap();
    assert!(fields.remove("coverage").is_some() && fields.remove("reason").is_some());
    fields.insert("line".to_owned(), "GOOD: overlap".into());
    std::fs::write(&path, project.to_string()).unwrap();
    let old = open(&path);
    assert_eq!(verdicts(&old), verdicts(&window));
    assert_eq!(told(&old), "GOOD");
}

#[test]
fn a_project_keeps_which_stamped_files_are_hidden() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    let shown = |window: &Window| {
        let rows = window.state.stamped_rows().into_iter();
        rows.map(|row| row.is_shown).collect::<Vec<_>>()
    };
    let path = halves.folder.path().join("work.shapematch");
    for hidden in 0..2 {
        let show = |is_shown| ViewCommand::ShowFile(halves.stamped[hidden].clone(), is_shown);
        window.apply(show(false));
        save(&mut window, &path);
        let mut again = open(&path);
        assert_eq!(shown(&again), [hidden != 0, hidden != 1]);
        assert_eq!(again.state.is_first_file_hidden(), hidden == 0);
        assert_eq!(again.state.shown_further().len(), usize::from(hidden != 1));
        again.apply(show(true));
        assert_eq!(shown(&again), [true, true]);
        window.apply(show(true));
    }
    // What was hidden in the work before is not hidden in the one that is opened.
    save(&mut window, &path);
    window.apply(ViewCommand::ShowFile(halves.stamped[1].clone(), false));
    window.apply(ProjectCommand::Open(ProjectRequest {
        path,
        ..ProjectRequest::default()
    }));
    assert_eq!(shown(&window), [true, true]);
}

#[test]
fn the_match_of_a_further_file_waits_for_the_crash_part() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::WholeModel);
    let mut window = Window::with_files_of(folder.path(), real);
    let more = folder.path().join("more.dynain");
    std::fs::copy(folder.path().join("stamped.dynain"), &more).unwrap();
    window.apply(MapCommand::AddFurther(more));
    assert!(!window.state.jobs.is_active(JobKey::PlaceFurther));
    let StampedState::Waiting(why) = states(&window)[1] else {
        panic!("{:?}", states(&window));
    };
    assert!(why.contains("the first one"), "{why}");
    window.act(Action::MatchOrStop);
    assert_eq!(verdicts(&window), [Some(Verdict::Good); 2]);
}
