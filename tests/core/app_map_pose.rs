//! A mapping says at which pose it was made, and none begins at a pose that nobody chose.

use shapematch::app::{
    Action, Axis, AxisFrame, FileCommand, MapCommand, MatchCommand, MoveCommand, StampedState,
};
use shapematch::assess::Verdict;
use shapematch::pipeline::map::{CheckRecord, PoseOrigin};
use shapematch::role::Role;
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::app_mapping::{output_input, real};
use super::bracket::write_bracket;

fn loaded(folder: &std::path::Path) -> Window {
    write_bracket(folder, SampleVariant::Plain);
    Window::with_files_of(folder, real)
}

/// The check of the pose, which stands first, and the warnings.
fn pose_of(window: &Window) -> (CheckRecord, Vec<String>) {
    let result = window.state.document.current_mapping().unwrap();
    let check = result.record.checks[0].clone();
    assert_eq!(check.name, "Pose");
    (check, result.record.warnings.clone())
}

#[test]
fn without_a_match_a_mapping_is_asked_for_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = loaded(folder.path());
    let reason = Action::MapOrCancel.enabled(&window.state).unwrap_err();
    assert!(
        reason.0.starts_with("There is no match yet"),
        "{}",
        reason.0
    );
    // Neither by the key nor by whoever sends the command.
    window.apply(MapCommand::MapOrCancel);
    assert!(window.state.document.current_mapping().is_none());
    window.act(Action::MapAsLoaded);
    let (check, warnings) = pose_of(&window);
    assert_eq!(check.found, "as loaded, no match");
    assert_eq!(check.is_met, Some(false));
    let warning = "the pose of stamped.dynain: as loaded, no match";
    assert!(warnings.iter().any(|one| one == warning), "{warnings:?}");
    let told = |row: &shapematch::app::LogRow| row.text.contains("as loaded, no match");
    assert!(window.state.log.rows().iter().any(told));
}

#[test]
fn a_mapping_tells_the_match_it_stands_on_and_how_far_it_was_moved_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = loaded(folder.path());
    window.apply(MatchCommand::Run);
    assert!(Action::MapAsLoaded.enabled(&window.state).is_err());
    window.act(Action::MapOrCancel);
    let (check, warnings) = pose_of(&window);
    assert_eq!(check.found, "GOOD match");
    assert_eq!(check.is_met, Some(true));
    assert!(
        !warnings.iter().any(|one| one.contains("pose")),
        "{warnings:?}"
    );
    let by = |distance: f64| MoveCommand::Translate {
        axis: Axis::X,
        frame: AxisFrame::Global,
        distance,
    };
    window.apply(by(5.0));
    window.act(Action::MapOrCancel);
    let (check, _) = pose_of(&window);
    assert_eq!(check.found, "moved by hand, 5.00 mm from the match (GOOD)");
    assert_eq!(check.is_met, Some(false));
    // The report that the window writes says the same.
    let page = shapematch::pipeline::outputs::Output::MapReport
        .make(
            &output_input(&window),
            None,
            &shapematch::monitor::Monitor::silent(),
        )
        .unwrap();
    let page = String::from_utf8(page.bytes).unwrap();
    assert!(page.contains("moved by hand, 5.00 mm from the match (GOOD)"));
    // Moved back it is where the match put it.
    window.apply(by(-5.0));
    let good = PoseOrigin::Match {
        verdict: Verdict::Good,
    };
    assert_eq!(window.state.document.pose_origin(), good);
}

#[test]
fn after_a_part_has_changed_the_pose_is_that_of_the_match_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = loaded(folder.path());
    window.apply(MatchCommand::Run);
    for (role, changed) in [
        (Role::Crash, "the crash part"),
        (Role::Stamped, "both parts"),
    ] {
        window.apply(FileCommand::Reload(role));
        window.act(Action::MapOrCancel);
        let (check, warnings) = pose_of(&window);
        let found = format!("from the match before {changed} changed (GOOD)");
        assert_eq!(check.found, found);
        assert_eq!(check.is_met, Some(false));
        let warning = format!("the pose of stamped.dynain: {found}");
        assert!(warnings.contains(&warning), "{warnings:?}");
        let state = &window.state.stamped_rows()[0].state;
        assert_eq!(*state, StampedState::Outdated(found));
    }
    // Put back where its file has it, it stands for no match any more.
    window.apply(MoveCommand::Reset);
    assert_eq!(window.state.document.pose_origin(), PoseOrigin::AsLoaded);
    window.act(Action::Undo);
    window.apply(MatchCommand::Run);
    let origin = window.state.document.pose_origin();
    assert!(matches!(origin, PoseOrigin::Match { .. }), "{origin:?}");
}
