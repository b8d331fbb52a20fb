//! A whole model beside one stamped part: the match finds the part by itself.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use shapematch::app::{Action, PartCommand, PartRef};
use shapematch::assess::{Reason, Verdict};
use shapematch::jobs::{JobKey, JobKind, JobOutput, PipelineRunner, Runner as _};
use shapematch::monitor::Monitor;
use shapematch::role::Role;
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::bracket::{write_bracket, write_twice};

/// Does a job as the worker does.
pub fn really(kind: JobKind) -> Result<JobOutput, String> {
    let done = PipelineRunner.run(kind, &Monitor::silent());
    done.map_err(|error| error.to_string())
}

#[test]
fn a_match_of_a_whole_model_tries_the_most_alike_parts_alone() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::WholeModel);
    let mut window = Window::with_files_of(folder.path(), really);
    let n_parts = window.part(Role::Crash).facts.used.len();
    assert!(n_parts > 2, "{n_parts}");
    let asked_part = |window: &Window| window.state.part_question()?.only()?.first().copied();
    let asked = asked_part(&window);
    window.act(Action::MatchOrStop);
    let used = &window.part(Role::Crash).facts.used;
    assert_eq!(used.iter().copied().collect::<Vec<_>>(), [asked.unwrap()]);
    let result = window.state.document.current_result().expect("a result");
    assert_eq!(result.run.assessment.verdict, Verdict::Good);
    let times = &result.run.times;
    assert!(
        times.find_ms > 0.0,
        "the match of the search is not made again"
    );
    let rows = window.state.log.rows().iter();
    assert!(
        rows.into_iter()
            .any(|row| row.text.contains("the stamped part fits part") && row.took.is_none())
    );
    // Two steps back the whole model is there again.
    window.act(Action::Undo);
    window.act(Action::Undo);
    assert_eq!(window.part(Role::Crash).facts.used.len(), n_parts);
    // So is the question, and a match finds the part again.
    assert_eq!(asked_part(&window), asked);
    window.act(Action::MatchOrStop);
    let used = &window.part(Role::Crash).facts.used;
    assert_eq!(used.iter().copied().collect::<Vec<_>>(), [asked.unwrap()]);
}

/// A sheet that the model keeps as two parts which share their nodes, as a tailored blank.
#[test]
fn parts_that_share_nodes_are_found_as_one_sheet() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::WholeModel);
    let window = Window::with_files_of(folder.path(), really);
    let id = window.state.part_question().unwrap().only().unwrap()[0];
    let path = window.part(Role::Crash).loaded.path.clone();
    let deck = std::fs::read_to_string(&path).unwrap();
    let (own, other) = (format!("{id:>8}"), format!("{:>8}", 77));
    let of_part = |line: &&str| line.len() > 40 && line.get(8..16) == Some(&own[..]);
    let n_shells = deck.lines().filter(of_part).count();
    assert!(n_shells > 100, "{n_shells}");
    let mut n_met = 0;
    let mut split = String::new();
    for line in deck.lines() {
        let is_second_half = of_part(&line) && {
            n_met += 1;
            n_met > n_shells / 2
        };
        split += &match line.strip_prefix("*NODE") {
            Some("") => format!("*PART\nsecond half\n        77{id:>10}         1\n*NODE"),
            _ if is_second_half => format!("{}{other}{}", &line[..8], &line[16..]),
            _ => line.to_owned(),
        };
        split.push('\n');
    }
    std::fs::write(&path, split).unwrap();
    let mut window = Window::with_files_of(folder.path(), really);
    let question = window.state.part_question().unwrap();
    assert_eq!(question.only(), Some(&[77, id][..]));
    assert_eq!(question.title(&window.state.document), format!("77 + {id}"));
    window.apply(PartCommand::UseAlike(0));
    assert_eq!(window.part(Role::Crash).facts.used.len(), 2);
    window.act(Action::Undo);
    window.act(Action::MatchOrStop);
    let used: Vec<u64> = window
        .part(Role::Crash)
        .facts
        .used
        .iter()
        .copied()
        .collect();
    assert_eq!(used, [77, id]);
    let result = window.state.document.current_result().expect("a result");
    assert_eq!(result.run.assessment.verdict, Verdict::Good);
}

/// Finds no crash part, as a search that is stopped at once.
fn without_parts(kind: JobKind) -> Result<JobOutput, String> {
    match kind {
        JobKind::FindParts(_) => Ok(JobOutput::PartsFound(None)),
        other => really(other),
    }
}

#[test]
fn no_match_begins_after_a_search_for_the_part_that_was_stopped() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::WholeModel);
    let mut window = Window::with_files_of(folder.path(), without_parts);
    window.holds = true;
    window.act(Action::MatchOrStop);
    assert!(matches!(window.held[0].1, JobKind::FindParts(_)));
    window.act(Action::MatchOrStop);
    window.finish_held();
    assert!(window.state.document.result.is_none());
    let last = window.state.log.rows().last().unwrap();
    assert!(last.text.contains("stopped before"), "{}", last.text);
}

#[test]
fn one_thread_and_sixteen_give_the_same_match_and_verdict() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::Plain);
    let run = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        pool.build().unwrap().install(|| {
            let mut window = Window::with_files_of(folder.path(), really);
            window.act(Action::MatchOrStop);
            let result = window.state.document.current_result().expect("a result");
            let assessment = &result.run.assessment;
            let rows = result.run.crash_from_stamped.to_rows();
            let numbers = [
                assessment.coverage.rmse(),
                assessment.coverage.p95(),
                assessment.coverage.better_overlap(),
            ];
            (
                rows.map(|row| row.map(f64::to_bits)),
                numbers.map(f64::to_bits),
                assessment.verdict,
                assessment.reasons.clone(),
            )
        })
    };
    assert_eq!(run(1), run(16));
}

/// The folder of a deck that has the part twice and of the stamped part.
fn twice() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_twice(folder.path());
    folder
}

/// The window with both of them, not matched yet.
fn window_of_twice(folder: &Path) -> Window {
    let mut window = Window::new();
    window.runner = Some(really);
    for (name, role) in [("twice.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        window.open(folder.join(name).to_str().unwrap(), role);
    }
    window
}

/// The record of a match of the command line.
fn record_of(folder: &Path, args: &[&str]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
    command.current_dir(folder).arg("match").args(args);
    let done = command.args(["--json", "-"]).output().unwrap();
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn parts_that_fit_as_well_are_told_and_all_can_be_meant() {
    let folder = twice();
    let told = "fits part 2000040, and part 52000040 about as well";

    let mut window = window_of_twice(folder.path());
    window.act(Action::MatchOrStop);
    let mut rows = window.state.log.rows().iter();
    assert!(rows.any(|row| row.text.contains(told)));

    let args = ["twice.k", "stamped.dynain", "--report", "report.html"];
    let record = record_of(folder.path(), &args);
    // Which of the two is meant no distance tells.
    assert_eq!(record["verdict"], "check");
    assert_eq!(record["pose_statement"], "ambiguous");
    assert_eq!(
        record["files"]["crash"]["parts"],
        serde_json::json!([2_000_040])
    );
    let told = "fits part 52000040 about as well";
    let reasons = record["reasons"].to_string();
    assert!(reasons.contains(told), "{reasons}");
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("On other crash parts: the stamped part fits part 52000040"));
    assert!(report.contains("The pose is one of several that fit"));
    assert!(!report.contains("probably right"));
    let with_parts = |parts| {
        let args = ["twice.k", "stamped.dynain", "--crash-part", parts];
        record_of(folder.path(), &args)
    };
    assert_eq!(with_parts("2000040")["verdict"], "good");
    let record = with_parts("all");
    assert_eq!(
        record["files"]["crash"]["parts"].as_array().unwrap().len(),
        6
    );
    // Matched as one, they hold the part twice as well, among others that lie on it.
    assert_eq!(record["verdict"], "check");
    assert_eq!(record["pose_statement"], "ambiguous");
    let other = &record["alternatives"][0];
    let apart = [
        record["matrix"][0][3].as_f64(),
        other["matrix"][0][3].as_f64(),
    ];
    let apart = (apart[0].unwrap() - apart[1].unwrap()).abs();
    assert!((apart - 3000.0).abs() < 5.0, "{apart}");
}

#[test]
fn which_of_several_parts_is_meant_stays_open_until_the_user_has_chosen() {
    let folder = twice();
    let project = folder.path().join("car.shapematch");
    let name = project.to_str().unwrap();
    let verdict_of = |window: &mut Window| {
        window.act(Action::MatchOrStop);
        let result = window.state.document.current_result().expect("a result");
        let is_open = |reason: &Reason| matches!(reason, Reason::AlikeParts { .. });
        let is_open = result.run.assessment.reasons.iter().any(is_open);
        assert_eq!(is_open, result.verdict() == Verdict::Check);
        let line = window.state.document.command_line().unwrap();
        // The part is named only where the user chose it: the search tells of the others.
        assert_eq!(line.contains("--crash-part 2000040"), !is_open, "{line}");
        result.verdict()
    };
    let mut window = window_of_twice(folder.path());
    // Of parts that are equally alike none is proposed.
    let asked = window.state.part_question().unwrap();
    assert_eq!(asked.only(), None);
    assert_eq!(asked.title(&window.state.document), "2000040, 52000040");
    // Each can be chosen all the same.
    let mut other = window_of_twice(folder.path());
    other.apply(PartCommand::UseAlike(1));
    let used = &other.state.document.part(Role::Crash).unwrap().facts.used;
    assert!(used.iter().eq([&52_000_040]), "{used:?}");
    for _ in 0..2 {
        assert_eq!(verdict_of(&mut window), Verdict::Check);
    }
    let saved = window.state.to_project(0);
    saved.write(&project).unwrap();
    assert_eq!(record_of(folder.path(), &[name])["verdict"], "check");
    let mut again = Window::new();
    again.runner = Some(really);
    again.open(name, Role::Crash);
    assert_eq!(verdict_of(&mut again), Verdict::Check);

    // The part that is matched already is a choice too.
    let (role, id) = (Role::Crash, 2_000_040);
    window.apply(PartCommand::UseOnly(PartRef { role, id }));
    assert_eq!(verdict_of(&mut window), Verdict::Good);
    window.state.to_project(0).write(&project).unwrap();
    assert_eq!(record_of(folder.path(), &[name])["verdict"], "good");
}

#[test]
fn a_project_of_a_whole_model_asks_for_the_part_as_its_files_do() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::WholeModel);
    let project = folder.path().join("car.shapematch");
    let name = project.to_str().unwrap();
    let mut window = Window::with_files_of(folder.path(), really);
    let n_parts = window.part(Role::Crash).facts.used.len();
    let asked = window.state.part_question().cloned();
    assert!(asked.is_some());
    let opened = |window: &Window| {
        window.state.to_project(0).write(&project).unwrap();
        let mut again = Window::new();
        again.runner = Some(really);
        again.open(name, Role::Crash);
        again
    };
    let n_matched = |record: &Value| record["files"]["crash"]["parts"].as_array().unwrap().len();
    let mut again = opened(&window);
    assert_eq!(again.state.part_question(), asked.as_ref());
    again.act(Action::MatchOrStop);
    let result = again.state.document.current_result().expect("a result");
    assert_eq!(result.verdict(), Verdict::Good);
    assert_eq!(again.part(Role::Crash).facts.used.len(), 1);
    let record = record_of(folder.path(), &[name]);
    assert_eq!(
        (record["verdict"].as_str(), n_matched(&record)),
        (Some("good"), 1)
    );

    // An answer is kept.
    window.apply(PartCommand::UseAll(Role::Crash));
    let again = opened(&window);
    assert!(again.state.part_question().is_none());
    let once_more = opened(&again);
    assert!(once_more.state.part_question().is_none());
    assert_eq!(n_matched(&record_of(folder.path(), &[name])), n_parts);
}

#[test]
fn a_part_that_is_chosen_after_a_match_of_several_is_matched_at_once() {
    let folder = twice();
    let mut window = window_of_twice(folder.path());
    window.act(Action::MatchOrStop);
    let role = Role::Crash;
    // The other one, and the same once more, whose surface is there.
    for _ in 0..2 {
        let id = 52_000_040;
        window.apply(PartCommand::MatchOnly(PartRef { role, id }));
        assert!(window.part(role).facts.used.iter().eq(&[id]));
        let result = window.state.document.current_result().expect("a result");
        assert_eq!(result.verdict(), Verdict::Good);
    }
    // A choice that is given up is not matched later.
    window.holds = true;
    let id = 2_000_040;
    window.apply(PartCommand::MatchOnly(PartRef { role, id }));
    window.cancel(JobKey::Reselect(role));
    window.finish_held();
    window.holds = false;
    window.apply(PartCommand::UseOnly(PartRef { role, id }));
    assert!(window.part(role).facts.used.iter().eq(&[id]));
    assert!(window.state.document.current_result().is_none());
}
