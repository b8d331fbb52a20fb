//! The starts of a match as the window lists them: while it runs, after it, and as previews.

use super::app::Window;
use shapematch::app::*;
use shapematch::geometry::{Similarity, Vector3};
use shapematch::jobs::Live;
use shapematch::monitor::{Fate, IterationReport, Monitor, Observer, StartReport};
use shapematch::registration::{MatchSettings, match_meshes};
use std::sync::{Arc, Mutex};

fn shifted(x: f64) -> Similarity {
    Similarity {
        translation: Vector3::new(x, 0.0, 0.0),
        ..Similarity::identity()
    }
}

fn iteration(start_idx: usize, iteration: usize, x: f64) -> IterationReport {
    IterationReport {
        start_idx,
        iteration,
        target_from_source: shifted(x).to_rows(),
        objective: x,
        rmse: x,
        fraction: 0.5,
    }
}

fn report(start_idx: usize, fate: Option<Fate>) -> StartReport {
    StartReport {
        start_idx,
        name: format!("pose {start_idx}"),
        fate,
    }
}

fn live(window: &Window, starts: Vec<StartReport>, iterations: Vec<IterationReport>) -> Command {
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
    assert!(window.state.attempts().is_empty());
    let begun = vec![report(0, None), report(1, None)];
    let news = live(&window, begun, vec![iteration(0, 0, 2.0)]);
    window.apply(news);
    let rows: Vec<_> = window.state.attempts();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0].fate, None);
    assert_eq!((rows[0].n_steps(), rows[1].n_steps()), (1, 0));
    let ended = vec![report(1, Some(Fate::Dropped { after: 5 }))];
    let news = live(&window, ended, vec![iteration(0, 1, 1.0)]);
    window.apply(news);
    assert_eq!(
        window.state.attempts()[1].fate,
        Some(Fate::Dropped { after: 5 })
    );
    assert_eq!(
        window.state.attempt(0).unwrap().last_pose(),
        Some(shifted(1.0))
    );
    window.finish_held();
    let outcome = Arc::clone(&window.state.document.result.as_ref().unwrap().run.outcome);
    let rows = window.state.attempts();
    assert_eq!(rows.len(), outcome.starts.len());
    assert!(
        rows.iter()
            .all(|row| row.fate.is_some() && row.p95.is_some())
    );
    assert_eq!(window.state.leading_start(), Some(outcome.winner));
}

#[test]
fn every_start_is_announced_and_its_end_told_once() {
    #[derive(Default)]
    struct Told(Mutex<Vec<StartReport>>);
    impl Observer for Told {
        fn start(&self, report: StartReport) {
            self.0.lock().unwrap().push(report);
        }
    }
    let window = Window::with_both();
    let [crash, stamped] = [
        window.mesh(shapematch::jobs::Role::Crash),
        window.mesh(shapematch::jobs::Role::Stamped),
    ];
    let told = Arc::new(Told::default());
    let monitor = Monitor::with_observer(Arc::clone(&told) as Arc<dyn Observer>);
    let outcome = match_meshes(&stamped, &crash, &MatchSettings::default(), &monitor).unwrap();
    let told = told.0.lock().unwrap();
    for (index, record) in outcome.starts.iter().enumerate() {
        let of_start: Vec<_> = told.iter().filter(|r| r.start_idx == index).collect();
        assert_eq!(of_start[0].fate, None, "start {index} was not announced");
        assert_eq!(of_start[0].name, record.name());
        let ends: Vec<_> = of_start.iter().filter_map(|r| r.fate).collect();
        // Runners-up live to the last comparison, which has no news of its own.
        let expected: &[Fate] = if record.fate == Fate::RunnerUp {
            &[]
        } else {
            &[record.fate]
        };
        assert_eq!(ends, expected, "start {index}");
    }
}

#[test]
fn starts_that_end_in_one_pose_are_one_row_best_first() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::MatchOrStop);
    let starts = vec![
        report(0, Some(Fate::RunnerUp)),
        report(1, Some(Fate::Won)),
        report(2, Some(Fate::MergedInto { start: 3 })),
        report(3, Some(Fate::MergedInto { start: 1 })),
        report(4, Some(Fate::Dropped { after: 5 })),
        report(5, Some(Fate::RunnerUp)),
    ];
    let places = [9.0, 0.1, 7.0, 3.0, 5.0, 0.11];
    let iterations = places.iter().enumerate();
    let iterations = iterations
        .map(|(start, x)| iteration(start, 0, *x))
        .collect();
    let news = live(&window, starts, iterations);
    window.apply(news);
    let attempts = window.state.attempts();
    let corners = window.state.stamped_corners().unwrap();
    let groups = group_attempts(&attempts, &corners);
    let members: Vec<_> = groups.iter().map(|g| g.members.clone()).collect();
    assert_eq!(members, [vec![1, 5, 3, 2], vec![0], vec![4]]);
    assert_eq!(groups[0].distance, Some(0.0));
    let off = groups[1].distance.unwrap();
    assert!((off - 8.9).abs() < 1e-9, "{off}");
}

#[test]
fn a_preview_shows_any_iteration_and_changes_nothing() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let before = window.state.document.clone();
    let n_steps = window.state.history.n_done();
    let outcome = Arc::clone(&before.result.as_ref().unwrap().run.outcome);
    let loser = outcome.starts.iter().position(|s| s.fate != Fate::Won);
    let (start, iteration) = (loser.unwrap(), 1);
    let step = Preview::Step { start, iteration };
    window.apply(ViewCommand::HoverPreview(Some(step)));
    let pose = outcome.starts[start].iterations[iteration].target_from_source;
    assert_eq!(window.state.shown_pose(), pose);
    assert!(window.state.is_preview());
    window.apply(ViewCommand::HoverPreview(None));
    assert_eq!(window.state.shown_pose(), window.pose());
    window.apply(ViewCommand::PinPreview(Some(Preview::Start(start))));
    assert_eq!(window.state.shown_pose(), outcome.starts[start].last);
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_steps);
    window.act(Action::Escape);
    assert!(!window.state.is_preview());
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
    window.apply(MatchCommand::UseAttempt(start));
    assert_eq!(window.pose(), outcome.starts[start].last);
    assert_eq!(window.state.history.n_done(), n_steps + 1);
    // The winner's row is the result again, not just a pose.
    window.apply(MatchCommand::UseAttempt(outcome.winner));
    assert_eq!(window.pose(), matched);
    assert!(window.state.document.current_result().is_some());
    window.act(Action::Undo);
    window.act(Action::Undo);
    assert_eq!(window.pose(), matched);
}
