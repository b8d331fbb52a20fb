//! Commands that come while a job runs or waits: none is lost, and none is undone by the job's end.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use shapematch::app::*;
use shapematch::geometry::Similarity;
use shapematch::jobs::{JobKey, JobKind, JobOutput, JobStage, Live};
use shapematch::pipeline::sweep::{MatchingRow, Sweep};
use shapematch::role::{PerRole, Role};
use shapematch::units::{LengthUnit, Units};

use super::app::{Window, shifted};
use super::match_starts::{live_iteration, running_start};

fn crash_part(id: u64) -> PartRef {
    PartRef {
        role: Role::Crash,
        id,
    }
}

/// A car of three parts, of which the second is the stamped one.
fn car_and_stamped() -> Window {
    let mut window = Window::new();
    window.open("car.k", Role::Crash);
    window.open("stamped.k", Role::Stamped);
    window
}

fn used(window: &Window) -> Vec<u64> {
    window
        .part(Role::Crash)
        .facts
        .used
        .iter()
        .copied()
        .collect()
}

/// Opens another stamped part while the held jobs wait, and lets them end then.
fn end_held_after_another_part(window: &mut Window) {
    let held = std::mem::take(&mut window.held);
    window.holds = false;
    window.open("metres.k", Role::Stamped);
    window.held = held;
    window.finish_held();
}

#[test]
fn the_full_mesh_stays_though_a_reduction_was_under_way() {
    let roles = PerRole::both(true);
    let back: [Command; 2] = [
        ReduceCommand::Full(roles).into(),
        HistoryCommand::ResetAll.into(),
    ];
    for command in back {
        let mut window = Window::with_both();
        window.holds = true;
        window.apply(ReduceCommand::To {
            roles,
            max_triangles: 60,
        });
        assert_eq!(window.held.len(), 2);
        window.apply(command);
        window.finish_held();
        for role in Role::ALL {
            let part = window.part(role);
            assert!(part.level.is_none() && part.wanted_level.is_none());
        }
    }
}

#[test]
fn choices_that_follow_each_other_all_count() {
    let mut window = car_and_stamped();
    window.holds = true;
    window.apply(PartCommand::SetUsed(crash_part(21), false));
    let is_used = |window: &Window, id| window.state.is_part_used(crash_part(id));
    assert!(!is_used(&window, 21) && is_used(&window, 22), "at once");
    window.apply(PartCommand::SetUsed(crash_part(23), false));
    let (role, factor) = (Role::Crash, 2.0);
    window.apply(FileCommand::SetLengthFactor { role, factor });
    let units = Some(Units::from(LengthUnit::Meter));
    window.apply(FileCommand::SetUnits { role, units });
    assert_eq!(used(&window), [21, 22, 23], "not made yet");
    window.finish_held();
    assert_eq!(used(&window), [22]);
    let settings = &window.part(role).loaded.settings;
    assert_eq!((settings.length_factor, settings.units), (factor, units));

    // A choice that is taken back leaves the part as it is.
    window.holds = true;
    window.apply(PartCommand::SetUsed(crash_part(21), true));
    window.apply(PartCommand::SetUsed(crash_part(21), false));
    assert!(window.held.is_empty());
    assert!(!is_used(&window, 21));
    // So does one that is given up.
    window.apply(PartCommand::SetUsed(crash_part(21), true));
    window.close_toasts();
    window.apply(Command::Escape);
    assert!(!is_used(&window, 21));
    window.finish_held();
    assert_eq!(used(&window), [22]);
}

#[test]
fn crash_parts_that_were_chosen_are_those_that_are_matched() {
    let mut window = car_and_stamped();
    window.apply(PartCommand::SetUsed(crash_part(23), false));
    assert_eq!(used(&window), [21, 22]);
    assert!(window.state.more_alike().is_some(), "one of them alone is");
    assert!(window.state.part_question().is_none(), "it was answered");
    window.holds = true;
    window.act(Action::MatchOrStop);
    assert!(matches!(window.held[0].1, JobKind::Match(_)));
    window.apply(MatchCommand::Cancel);
    window.holds = false;

    window.apply(PartCommand::UseAll(Role::Crash));
    assert_eq!(used(&window), [21, 22, 23]);
    assert!(window.state.part_question().is_none(), "all are meant");
    // In another unit they are the same parts.
    let (role, factor) = (Role::Crash, 1.001);
    window.apply(FileCommand::SetLengthFactor { role, factor });
    assert!(window.state.part_question().is_none());
    // Of another crash model it is asked anew.
    window.open("crash.k", Role::Crash);
    window.open("car.k", Role::Crash);
    assert!(window.state.part_question().is_some());
}

#[test]
fn a_sweep_and_the_starts_of_a_match_go_with_their_parts() {
    let mut window = Window::with_both();
    window.holds = true;
    window.apply(MatchCommand::Sweep(Box::default()));
    let (id, kind, stamp) = window.held.remove(0);
    let table = Sweep {
        matching: vec![MatchingRow {
            max_triangles: None,
            crash_from_stamped: shifted(5.0),
            triangles: PerRole::both(100),
            time_ms: 1.0,
            node_rms: 0.1,
            node_max: 0.1,
            finished_ms: 1.0,
            finished_node_rms: 0.1,
            paper_ms: None,
        }],
        ..Sweep::default()
    };
    let swept = JobOutput::Swept(Arc::new(table));
    window.tell(id, kind.key(), stamp, JobStage::Finished(swept));
    assert!(window.state.shown_sweep().is_some());

    window.act(Action::MatchOrStop);
    let live = Live {
        job: window.state.jobs.running().map(|job| job.id),
        starts: vec![(0, running_start())],
        iterations: vec![live_iteration(0, 0, 5.0)],
        ..Live::default()
    };
    window.apply(Command::Live(Box::new(live)));
    window.apply(MatchCommand::Cancel);
    assert_eq!(window.state.match_starts().len(), 1);

    window.holds = false;
    window.open("metres.k", Role::Stamped);
    assert!(window.state.shown_sweep().is_none());
    assert!(window.state.to_project(0).sweep.is_none());
    assert!(window.state.match_starts().is_empty());
    window.act(Action::Undo);
    assert!(window.state.shown_sweep().is_some());
    assert!(window.state.to_project(0).sweep.is_some());
}

#[test]
fn a_measurement_that_was_discarded_is_made_when_its_pose_is_there_again() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    window.holds = true;
    window.apply(MatchCommand::ShowAlternative(Some(0)));
    assert!(window.state.jobs.is_active(JobKey::Measure));
    window.act(Action::Undo);
    window.finish_held();
    window.act(Action::Redo);
    assert!(window.state.result_coverage().is_some());
    assert!(window.state.alternative_statements().is_some());
}

#[test]
fn an_overlap_that_was_discarded_is_measured_when_its_parts_are_there_again() {
    let mut window = Window::with_both();
    window.holds = true;
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: shifted(5.0),
        name: "Shift".to_owned(),
    });
    assert!(window.state.jobs.is_active(JobKey::Overlap));
    end_held_after_another_part(&mut window);
    assert!(window.state.current_overlap().is_none());
    window.act(Action::Undo);
    assert_eq!(window.pose(), shifted(5.0));
    assert!(window.state.current_overlap().is_some());
}

#[test]
fn a_verdict_that_was_discarded_is_asked_for_again() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.shape_tolerance = 1e-6;
    window.holds = true;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    assert!(window.state.jobs.is_active(JobKey::Verdict));
    end_held_after_another_part(&mut window);
    window.act(Action::Undo);
    let result = window.state.document.current_result().unwrap();
    assert_eq!(result.run.recipe.settings.shape_tolerance, 1e-6);
}

#[test]
fn a_drag_that_ends_while_a_match_runs_lets_the_part_go() {
    let gesture = GestureId(1);
    for end in [MoveCommand::EndDrag, MoveCommand::AbandonDrag(gesture)] {
        let mut window = Window::with_both();
        window.apply(MoveCommand::Drag {
            gesture,
            delta: shifted(5.0),
            name: "Move".to_owned(),
        });
        window.holds = true;
        window.act(Action::MatchOrStop);
        assert!(window.state.jobs.is_active(JobKey::Match));
        window.apply(end);
        assert!(!window.state.moving.is_moving());
        assert_eq!(window.pose(), shifted(5.0), "it is matched from there");
        window.apply(MatchCommand::Cancel);
        window.act(Action::Undo);
        assert_eq!(window.pose(), Similarity::identity());
    }
}

#[test]
fn files_that_are_dropped_while_others_are_read_are_sorted_by_content() {
    let mut window = Window::new();
    window.holds = true;
    for names in [["crash.k", "car.k"], ["stamped.k", "crash.k"]] {
        let paths = names.map(PathBuf::from).to_vec();
        window.apply(FileCommand::Open { paths, role: None });
    }
    assert_eq!(window.held.len(), 2, "the newer ones");
    window.finish_held();
    let name = |role| window.part(role).loaded.file_name();
    assert_eq!(Role::ALL.map(name), ["crash.k", "stamped.k"]);
}

/// What is asked of the parts while one is made anew would be about the one before.
#[test]
fn a_match_waits_for_the_parts_that_are_being_read() {
    let mut window = car_and_stamped();
    window.holds = true;
    window.apply(PartCommand::UseOnly(crash_part(22)));
    let reading = Err(Reason("A part is still being read."));
    assert_eq!(window.state.can_match(), reading);
    assert_eq!(Action::MatchOrStop.enabled(&window.state), reading);
    assert_eq!(Action::Swap.enabled(&window.state), reading);
    window.act(Action::MatchOrStop);
    window.apply(FileCommand::Swap);
    assert!(!window.state.jobs.is_active(JobKey::Match));
    window.finish_held();
    assert_eq!(used(&window), [22]);
    assert_eq!(window.state.can_match(), Ok(()));
}

/// A part that was closed does not come back with the end of its reading.
#[test]
fn a_part_that_is_closed_while_it_is_read_stays_closed() {
    let mut window = Window::with_both();
    window.holds = true;
    window.apply(FileCommand::Reload(Role::Stamped));
    window.apply(FileCommand::Close(Role::Stamped));
    window.finish_held();
    assert!(window.state.document.part(Role::Stamped).is_none());
}

/// The window asks the same question whichever way it is closed.
#[test]
fn a_running_match_would_be_lost_with_the_window() {
    let mut window = Window::with_both();
    assert!(!window.state.would_lose_work());
    window.holds = true;
    window.act(Action::MatchOrStop);
    assert!(!window.state.is_unsaved());
    assert!(window.state.would_lose_work());
}

/// A level that was asked for once more by hand is a step of its own.
#[test]
fn reducing_again_after_a_reload_is_an_undo_step() {
    let mut window = Window::with_both();
    let reduce = ReduceCommand::To {
        roles: PerRole::new(true, false),
        max_triangles: 60,
    };
    window.apply(reduce);
    window.apply(FileCommand::Reload(Role::Crash));
    let part = window.part(Role::Crash);
    assert!(part.wanted_level.is_some());
    let n_done = window.state.history.n_done();
    let is_reduced = part.level.is_some();
    window.apply(reduce);
    assert!(window.part(Role::Crash).level.is_some());
    assert!(is_reduced || window.state.history.n_done() == n_done + 1);
}

/// The part that is left has its own window again.
#[test]
fn closing_a_part_ends_move_over() {
    let mut window = Window::with_both();
    window.act(Action::ToggleMoveOver);
    assert!(window.state.view.is_moved_over);
    window.apply(FileCommand::Close(Role::Crash));
    assert!(!window.state.view.is_moved_over);
}

/// Escape takes back the move by keys alone.
#[test]
fn another_move_ends_the_move_by_keys() {
    let mut window = Window::with_both();
    window.apply(MoveCommand::Begin {
        kind: MotionKind::Move,
        frame: window.state.move_frame().unwrap(),
    });
    window.act(Action::FlipX);
    assert!(window.state.moving.tool.is_none());
    let flipped = window.pose();
    window.apply(Command::Escape);
    assert_eq!(window.pose(), flipped);
}

/// What was said about a match is about other parts then.
#[test]
fn messages_about_a_match_end_with_its_parts() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let text = "the pose needs a look".to_owned();
    window.state.log.now += Duration::from_secs(1);
    let showing = Showing {
        now: window.state.log.now,
        is_muted: false,
        about: Some(LogStep::Match),
    };
    window
        .state
        .log
        .notices
        .push(NoticeLevel::Warning, text.clone(), showing);
    let is_toast = |window: &Window| window.state.log.notices.toasts().any(|n| n.text == text);
    assert!(is_toast(&window));
    window.state.log.now += Duration::from_secs(1);
    window.apply(FileCommand::Close(Role::Crash));
    assert!(!is_toast(&window));
}
