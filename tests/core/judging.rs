//! The verdict follows the shape tolerance beside it, while the pose stays.

use std::sync::Arc;

use shapematch::app::*;
use shapematch::assess::Assessment;
use shapematch::jobs::{JobKind, JobOutput, PipelineRunner, Runner as _};
use shapematch::monitor::Monitor;

use super::app::Window;

fn matched() -> Window {
    let mut window = Window::with_both();
    // The real match, whose pose is its own.
    window.runner = Some(|kind: JobKind| {
        let run = PipelineRunner.run(kind, &Monitor::silent());
        run.map_err(|error| error.to_string())
    });
    window.act(Action::MatchOrStop);
    window
}

fn set_tolerance(window: &mut Window, tolerance: f64) {
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.shape_tolerance = tolerance;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
}

fn assessment(window: &Window) -> Assessment {
    let result = window.state.document.current_result().unwrap();
    Assessment::clone(&result.run.assessment)
}

fn judged_with(window: &Window) -> f64 {
    assessment(window).shape.unwrap().tolerance.remainder
}

#[test]
fn a_tolerance_judges_anew_as_a_new_match_would() {
    let mut window = matched();
    assert_eq!(judged_with(&window), 1.0);
    let (pose, before) = (window.pose(), assessment(&window));
    let n_matches = |window: &Window| {
        let rows = window.state.log.rows().iter();
        rows.filter(|row| row.step == LogStep::Match).count()
    };
    let n_before = n_matches(&window);
    set_tolerance(&mut window, 1e-6);
    assert_eq!(judged_with(&window), 1e-6);
    assert_eq!(window.pose(), pose, "the pose stays");
    assert_eq!(n_matches(&window), n_before, "nothing is searched");
    let judged = assessment(&window);
    assert_ne!(judged.reasons, before.reasons);
    // Undo brings tolerance and verdict back, redo the new ones.
    window.apply(HistoryCommand::Undo);
    assert_eq!(window.state.document.recipe.settings.shape_tolerance, 0.0);
    assert_eq!(assessment(&window), before);
    window.apply(HistoryCommand::Redo);
    assert_eq!(assessment(&window), judged);
    // A whole new match with this tolerance says the same of the same pose.
    window.act(Action::MatchOrStop);
    assert_eq!(n_matches(&window), n_before + 1);
    assert_eq!((window.pose(), assessment(&window)), (pose, judged));
}

#[test]
fn a_verdict_that_comes_too_late_is_dropped_and_asked_for_again() {
    let mut window = matched();
    let before = assessment(&window);
    window.holds = true;
    set_tolerance(&mut window, 1e-6);
    assert_eq!(window.held.len(), 1, "judged off the frame");
    window.apply(HistoryCommand::Undo);
    window.finish_held();
    assert_eq!(assessment(&window), before);
    window.apply(HistoryCommand::Redo);
    assert_eq!(judged_with(&window), 1e-6);
}

#[test]
fn a_difference_is_allowed_at_a_click() {
    let mut window = matched();
    set_tolerance(&mut window, 1e-9);
    let run = window.state.document.result.as_ref().unwrap().run.to_arc();
    let mut other = shapematch::pipeline::match_parts::MatchRun::clone(&run);
    let mut weak = Assessment::clone(&run.assessment);
    weak.verdict = shapematch::assess::Verdict::Check;
    weak.reasons = vec![shapematch::assess::Reason::Shape {
        difference: shapematch::assess::ShapeReason::Bent {
            by: 0.5432,
            limit: 0.1,
        },
    }];
    other.assessment = Arc::new(weak);
    window.state.document.result.as_mut().unwrap().run = Arc::new(other).into();
    let causes = window.state.causes();
    let allowed = causes.iter().find_map(|cause| {
        let (label, commands) = cause.remedy.clone()?;
        label.starts_with("Allow").then_some((label, commands))
    });
    let (label, commands) = allowed.unwrap();
    assert!(label.starts_with("Allow 0.550"), "{label}");
    for command in commands {
        window.apply(command);
    }
    assert!((judged_with(&window) - 0.55).abs() < 1e-12);
}

#[test]
fn a_project_keeps_the_tolerance_with_the_verdict() {
    let mut window = matched();
    set_tolerance(&mut window, 0.25);
    let text = window
        .state
        .to_project(0)
        .to_text(std::path::Path::new("a.shapematch"))
        .unwrap();
    assert!(text.contains("\"shape_tolerance\": 0.25"), "{text}");
}

#[test]
fn judging_gives_the_run_with_its_recipe() {
    let mut window = matched();
    window.holds = true;
    set_tolerance(&mut window, 0.5);
    let (_, kind, _) = window.held.pop().unwrap();
    let output = PipelineRunner.run(kind, &Monitor::silent()).unwrap();
    let JobOutput::Judged(run) = output else {
        panic!("no verdict");
    };
    assert_eq!(run.recipe.settings.shape_tolerance, 0.5);
}
