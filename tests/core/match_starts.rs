//! The starts of a match as the window lists them: while it runs, after it, and as previews.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use shapematch::app::*;
use shapematch::geometry::{Pose, Similarity, Vector3};
use shapematch::jobs::{Live, LiveIteration};
use shapematch::monitor::Monitor;
use shapematch::registration::{
    Extent, IterationRecord, MatchMonitor, MatchSettings, Observer, Side, Stage, StartKind,
    StartOutcome, StartRecord, group_starts, same_pose,
};
use shapematch::role::Role;

use super::app::Window;
use super::registration::match_meshes;

fn shifted(x: f64) -> Similarity {
    Similarity {
        translation: Vector3::new(x, 0.0, 0.0),
        ..Similarity::identity()
    }
}

pub fn live_iteration(start: usize, number: usize, x: f64) -> LiveIteration {
    LiveIteration {
        start,
        number,
        record: IterationRecord {
            stage: Stage::Coarse,
            target_from_source: shifted(x),
            objective: x,
            rmse: x,
            fraction: 0.5,
        },
    }
}

/// A start that began at 0 and lies at `x`.
fn start(x: f64, outcome: Option<StartOutcome>) -> StartRecord {
    StartRecord {
        kind: StartKind::CurrentPose,
        flipped: false,
        mirrored: false,
        data_side: Side::Source,
        first: Similarity::identity(),
        last: shifted(x),
        iterations: Vec::new(),
        score: x,
        p95: x,
        took: Duration::ZERO,
        termination: None,
        outcome,
    }
}

pub fn running_start() -> StartRecord {
    start(0.0, None)
}

fn live(
    window: &Window,
    starts: Vec<(usize, StartRecord)>,
    iterations: Vec<LiveIteration>,
) -> Command {
    Command::Live(Box::new(Live {
        job: window.state.jobs.running().map(|job| job.id),
        starts,
        iterations,
        ..Live::default()
    }))
}

#[test]
fn rows_fill_while_a_match_runs_and_the_record_takes_their_place() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::MatchOrStop);
    assert!(window.state.match_starts().is_empty());
    let begun = vec![(0, running_start()), (1, running_start())];
    let news = live(&window, begun, vec![live_iteration(0, 0, 2.0)]);
    window.apply(news);
    let rows = window.state.match_starts();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0].outcome, None);
    let n_iterations = |row: usize| rows[row].iterations.len();
    assert_eq!((n_iterations(0), n_iterations(1)), (1, 0));
    let dropped = Some(StartOutcome::Dropped { after: 5 });
    let ended = vec![(1, start(3.0, dropped))];
    let news = live(&window, ended, vec![live_iteration(0, 1, 1.0)]);
    window.apply(news);
    let rows = window.state.match_starts();
    assert_eq!(rows[1].outcome, dropped);
    assert_eq!(rows[1].last, shifted(3.0));
    assert_eq!((rows[0].last, rows[0].score), (shifted(1.0), 1.0));
    assert_eq!(window.state.n_ended_starts(), [1, 2]);
    window.finish_held();
    let outcome = Arc::clone(&window.state.document.result.as_ref().unwrap().run.outcome);
    assert_eq!(window.state.match_starts(), outcome.starts);
    assert!(outcome.starts.iter().all(|start| start.outcome.is_some()));
    assert_eq!(window.state.leading_start(), Some(outcome.winner));
}

#[test]
fn every_start_is_reported_when_it_begins_and_when_it_ends() {
    #[derive(Default)]
    struct Reported(Mutex<Vec<(usize, StartRecord)>>);
    impl Observer for Reported {
        fn start(&self, start: usize, record: &StartRecord) {
            self.0.lock().unwrap().push((start, record.clone()));
        }
    }
    let window = Window::with_both();
    let [crash, stamped] = [window.mesh(Role::Crash), window.mesh(Role::Stamped)];
    let reported = Reported::default();
    let monitor = Monitor::silent();
    let monitor = MatchMonitor::observed(&monitor, &reported);
    let outcome = match_meshes(&stamped, &crash, &MatchSettings::default(), monitor).unwrap();
    let reported = reported.0.lock().unwrap();
    for (number, record) in outcome.starts.iter().enumerate() {
        let of_start = reported.iter().filter(|(start, _)| *start == number);
        let of_start: Vec<&StartRecord> = of_start.map(|(_, record)| record).collect();
        assert_eq!(of_start[0].outcome, None, "start {number} did not begin");
        assert_eq!(of_start[0].kind, record.kind);
        assert_eq!(of_start[0].first, record.first);
        let ends: Vec<_> = of_start.iter().filter_map(|r| r.outcome).collect();
        // Runners-up live to the last comparison, which has no news of its own.
        let expected: Vec<StartOutcome> = record
            .outcome
            .into_iter()
            .filter(|outcome| *outcome != StartOutcome::RunnerUp)
            .collect();
        assert_eq!(ends, expected, "start {number}");
    }
}

#[test]
fn starts_that_end_in_one_pose_are_one_group_best_first() {
    let merged = |start| Some(StartOutcome::MergedInto { start });
    let dropped = |after| Some(StartOutcome::Dropped { after });
    let starts = [
        start(9.0, Some(StartOutcome::RunnerUp)),
        start(0.1, Some(StartOutcome::Won)),
        // Those that met others go with them, wherever they were then.
        start(7.0, merged(3)),
        start(3.0, merged(1)),
        start(5.0, dropped(5)),
        start(0.11, Some(StartOutcome::RunnerUp)),
        start(5.01, dropped(10)),
        start(0.1, Some(StartOutcome::Failed)),
        start(0.1, None),
    ];
    let part = Extent {
        diagonal: 100.0,
        ..Extent::default()
    };
    let members = |starts: &[StartRecord]| -> Vec<Vec<usize>> {
        let groups = group_starts(starts, &part);
        groups.into_iter().map(|group| group.members).collect()
    };
    let expected = [vec![1, 5, 3, 2], vec![8], vec![0], vec![6, 4], vec![7]];
    assert_eq!(members(&starts), expected);
    // Numbers of a damaged file that lead nowhere, or in a circle.
    let damaged = [
        start(1.0, merged(1)),
        start(2.0, merged(0)),
        start(3.0, merged(99)),
    ];
    assert_eq!(members(&damaged).concat().len(), 3);
}

#[test]
fn one_pose_means_the_same_hand_and_a_fraction_of_the_part() {
    let part = Extent {
        diagonal: 100.0,
        ..Extent::default()
    };
    let here = shifted(50.0);
    assert!(same_pose(&here, &shifted(51.9), &part));
    assert!(!same_pose(&here, &shifted(52.1), &part));
    let rotated = |degrees: f64| {
        Similarity::from(Pose::rotation(Vector3::new(0.0, 0.0, degrees.to_radians()))).after(&here)
    };
    let at_origin = Similarity::identity();
    let about_center = |degrees: f64| {
        Similarity::from(Pose::rotation(Vector3::new(0.0, 0.0, degrees.to_radians())))
    };
    assert!(same_pose(&at_origin, &about_center(2.9), &part));
    assert!(!same_pose(&at_origin, &about_center(3.1), &part));
    // A small rotation about a far point moves the part away.
    assert!(!same_pose(&here, &rotated(2.9), &part));
    assert!(!same_pose(&at_origin, &Similarity::mirror_x(), &part));
    // The distance counts in lengths of the target, where the part is 25 times as large.
    let large = |x: f64| Similarity {
        scale: 25.0,
        ..shifted(x)
    };
    assert!(same_pose(&large(0.0), &large(49.0), &part));
    assert!(!same_pose(&large(0.0), &large(51.0), &part));
}

#[test]
fn a_preview_shows_any_iteration_and_changes_nothing() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let before = window.state.document.clone();
    let n_steps = window.state.history.n_done();
    let outcome = Arc::clone(&before.result.as_ref().unwrap().run.outcome);
    let loser = outcome
        .starts
        .iter()
        .position(|s| s.outcome != Some(StartOutcome::Won));
    let (start, iteration) = (loser.unwrap(), 1);
    let step = Preview::Step { start, iteration };
    window.apply(PreviewCommand::Hover(Some(step)));
    let pose = outcome.starts[start].iterations[iteration].target_from_source;
    assert_eq!(window.state.shown_pose(), pose);
    assert!(window.state.is_preview());
    window.apply(PreviewCommand::Hover(None));
    assert_eq!(window.state.shown_pose(), window.pose());
    window.apply(PreviewCommand::Pin(Some(Preview::Start(start))));
    assert_eq!(window.state.shown_pose(), outcome.starts[start].last);
    // The matrix of another pose than the one that is seen is not copied by mistake.
    assert!(Action::CopyMatrix.enabled(&window.state).is_err());
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_steps);
    window.act(Action::Escape);
    assert!(!window.state.is_preview());
    assert_eq!(Action::CopyMatrix.enabled(&window.state), Ok(()));
}

#[test]
fn taking_the_pose_of_a_start_is_one_step() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let matched = window.pose();
    let n_steps = window.state.history.n_done();
    let outcome = Arc::clone(&window.state.document.result.as_ref().unwrap().run.outcome);
    let known = |start: &usize| outcome.alternatives.iter().any(|a| a.start == *start);
    let other = (0..outcome.starts.len()).find(|s| *s != outcome.winner && !known(s));
    let start = other.unwrap();
    window.apply(MatchCommand::UseMatchStart(start));
    assert_eq!(window.pose(), outcome.starts[start].last);
    assert_eq!(window.state.history.n_done(), n_steps + 1);
    // The winner's row is the result again, not just a pose.
    window.apply(MatchCommand::UseMatchStart(outcome.winner));
    assert_eq!(window.pose(), matched);
    assert!(window.state.document.current_result().is_some());
    window.act(Action::Undo);
    window.act(Action::Undo);
    assert_eq!(window.pose(), matched);
}
