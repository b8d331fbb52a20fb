//! Pairs of points: picked in turn, fitted as one step, undone one by one, and a start of the match.

use shapematch::app::*;
use shapematch::geometry::{Point3, Rotation, Similarity, Vector3};
use shapematch::jobs::JobKind;
use shapematch::registration::StartMethod;
use shapematch::role::Role;

use super::app::Window;

fn picked(point: Point3) -> PickedPoint {
    PickedPoint {
        point,
        kind: PickKind::Surface,
    }
}

fn pose() -> Similarity {
    let turn = Rotation::new(Vector3::new(0.2, -0.3, 1.4));
    Similarity {
        rotation: *turn.to_rotation_matrix().matrix(),
        translation: Vector3::new(50.0, 7.0, -3.0),
        scale: 1.0,
    }
}

const PLACES: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [18.0, 1.0, 2.0],
    [3.0, 4.0, 0.5],
    [15.0, 3.0, 6.0],
];

fn pick(window: &mut Window, role: Role, point: Point3) {
    let point = picked(point);
    window.apply(PairCommand::Pick { role, point });
}

/// A window with the tool on and `n` pairs of one pose.
fn with_pairs(n: usize) -> Window {
    let mut window = Window::with_both();
    window.act(Action::PairTool);
    for place in PLACES.into_iter().take(n) {
        let stamped = Point3::from(place);
        pick(&mut window, Role::Crash, pose().apply(&stamped));
        pick(&mut window, Role::Stamped, stamped);
    }
    window
}

/// The same, of which the match begins at the pairs.
fn begun_at_pairs(n: usize) -> Window {
    let mut window = with_pairs(n);
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.starts.method = StartMethod::GivenPoses;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window
}

#[test]
fn clicks_alternate_and_each_is_one_step() {
    let mut window = Window::with_both();
    assert_eq!(window.state.next_pick(), None);
    window.act(Action::PairTool);
    assert_eq!(window.state.next_pick(), Some((0, Role::Crash)));
    pick(&mut window, Role::Crash, Point3::origin());
    assert_eq!(window.state.next_pick(), Some((0, Role::Stamped)));
    // Out of turn the point is picked anew, which is told.
    let anew = "The crash point of pair 1 is picked anew; the next one is on the stamped part, in the right window";
    let is_told = |window: &Window| {
        let mut toasts = window.state.log.notices.toasts();
        toasts.any(|notice| notice.text == anew)
    };
    assert!(!is_told(&window));
    pick(&mut window, Role::Crash, Point3::new(1.0, 0.0, 0.0));
    assert_eq!(window.state.document.current_pairs().len(), 1);
    assert!(is_told(&window));
    pick(&mut window, Role::Stamped, Point3::origin());
    assert_eq!(window.state.next_pick(), Some((1, Role::Crash)));
    let n_steps = window.state.history.n_done();
    window.act(Action::Undo);
    assert_eq!(window.state.history.n_done(), n_steps - 1);
    assert_eq!(window.state.next_pick(), Some((0, Role::Stamped)));
    window.act(Action::Redo);
    window.apply(PairCommand::Delete(0));
    assert!(window.state.document.current_pairs().is_empty());
    window.act(Action::Undo);
    assert_eq!(window.state.document.current_pairs().len(), 1);
    window.act(Action::Escape);
    assert_eq!(window.state.pairs.tool, None);
}

#[test]
fn the_fit_is_one_step_and_says_what_is_missing_before() {
    let window = with_pairs(2);
    assert_eq!(
        Action::FitPairs.enabled(&window.state),
        Err(Reason("Pick three pairs of points first."))
    );
    assert_eq!(
        window.state.document.pair_fit().unwrap_err(),
        "one more pair is needed"
    );
    for n in [3, 4] {
        let mut window = with_pairs(n);
        let n_steps = window.state.history.n_done();
        window.act(Action::FitPairs);
        assert_eq!(window.state.history.n_done(), n_steps + 1);
        let corners = window.state.stamped_corners().unwrap();
        assert!(window.pose().max_displacement(&pose(), &corners) < 1e-9);
        window.act(Action::Undo);
        assert_eq!(window.pose(), Similarity::identity());
        assert_eq!(window.state.document.current_pairs().len(), n);
    }
}

#[test]
fn points_on_a_line_are_refused_with_the_reason() {
    let mut window = Window::with_both();
    window.act(Action::PairTool);
    for i in 0..4 {
        let point = Point3::new(f64::from(i), 0.0, 0.0);
        pick(&mut window, Role::Crash, point);
        pick(&mut window, Role::Stamped, point);
    }
    assert!(Action::FitPairs.enabled(&window.state).is_err());
    let reason = window.state.document.pair_fit().unwrap_err();
    assert!(reason.contains("one line"), "{reason}");
    window.apply(PairCommand::Fit);
    assert_eq!(window.pose(), Similarity::identity());
}

#[test]
fn a_point_of_a_pair_that_is_gone_is_not_picked_anew() {
    let mut window = with_pairs(3);
    window.apply(PairCommand::Repick {
        pair: 2,
        role: Role::Crash,
    });
    while window.state.document.current_pairs().len() > 1 {
        window.act(Action::Undo);
    }
    let (place, role) = window.state.next_pick().unwrap();
    assert!(place <= 1, "{place}");
    pick(&mut window, role, Point3::origin());
    let pairs = window.state.document.current_pairs();
    assert!(pairs[place].get(role).is_some());
}

#[test]
fn a_wrong_pair_is_named_and_picked_again() {
    let mut window = with_pairs(4);
    window.apply(PairCommand::Repick {
        pair: 1,
        role: Role::Crash,
    });
    assert_eq!(window.state.next_pick(), Some((1, Role::Crash)));
    pick(&mut window, Role::Stamped, Point3::origin());
    assert_eq!(
        window.state.next_pick(),
        Some((1, Role::Crash)),
        "not asked for"
    );
    let why = window.state.wrong_pick(Role::Stamped);
    let words = "Pair 2 waits for its point on the crash part, in the left window";
    assert_eq!(why.as_deref(), Some(words));
    assert_eq!(window.state.wrong_pick(Role::Crash), None);
    window.act(Action::ToggleMoveOver);
    let why = window.state.wrong_pick(Role::Stamped).unwrap();
    assert!(why.starts_with("Points are picked in the left window"));
    assert_eq!(window.state.wrong_pick(Role::Crash), None);
    window.act(Action::ToggleMoveOver);
    let right = pose().apply(&Point3::from(PLACES[1]));
    pick(
        &mut window,
        Role::Crash,
        right + Vector3::new(0.0, 5.0, 0.0),
    );
    assert_eq!(window.state.next_pick(), Some((4, Role::Crash)));
    let fit = window.state.document.pair_fit().unwrap();
    let doubt = window
        .state
        .document
        .pair_doubt_text(&fit, window.state.lengths());
    let doubt = doubt.unwrap();
    assert!(doubt.starts_with("Pair 2 lies 5"), "{doubt}");
}

#[test]
fn pairs_are_a_start_of_the_match() {
    let mut window = begun_at_pairs(2);
    assert!(Action::MatchOrStop.enabled(&window.state).is_err());
    let stamped = Point3::from(PLACES[2]);
    pick(&mut window, Role::Crash, pose().apply(&stamped));
    pick(&mut window, Role::Stamped, stamped);
    assert_eq!(Action::MatchOrStop.enabled(&window.state), Ok(()));
    let effects = window.state.apply(MatchCommand::Run);
    let [Effect::StartJob(kind, _)] = &effects[..] else {
        panic!("{effects:?}");
    };
    let JobKind::Match(input) = &**kind else {
        panic!("{kind:?}");
    };
    let starts = &input.recipe.settings.starts.poses;
    let corners = window.state.stamped_corners().unwrap();
    assert!(starts[0].max_displacement(&pose(), &corners) < 1e-9);
}

/// Before a match the copied line is the match that would run, so it has the pose of the pairs.
#[test]
fn a_start_from_pairs_is_copied_with_its_pose() {
    let mut window = begun_at_pairs(2);
    let why = Action::CopyCommandLine.enabled(&window.state);
    assert_eq!(why, Action::MatchOrStop.enabled(&window.state));
    assert!(why.is_err_and(|why| why.0.starts_with("Pick three pairs of points first")));
    assert_eq!(window.state.document.command_line(), None);
    let stamped = Point3::from(PLACES[2]);
    pick(&mut window, Role::Crash, pose().apply(&stamped));
    pick(&mut window, Role::Stamped, stamped);
    assert_eq!(Action::CopyCommandLine.enabled(&window.state), Ok(()));
    let line = window.state.document.command_line().unwrap();
    let (_, given) = line.split_once("--start given --start-pose '").unwrap();
    let (numbers, _) = given.split_once('\'').unwrap();
    let numbers: Vec<f64> = numbers.split(' ').map(|n| n.parse().unwrap()).collect();
    let fit = window.state.document.pair_fit().unwrap();
    let rows = fit.fit.target_from_source.to_rows();
    assert_eq!(numbers, rows.as_flattened());
}

#[test]
fn refining_starts_from_the_present_pose_and_leaves_the_recipe() {
    let mut window = with_pairs(3);
    window.act(Action::FitPairs);
    let recipe = window.state.document.recipe.clone();
    let effects = window.state.apply(MatchCommand::Refine);
    let [Effect::StartJob(kind, _)] = &effects[..] else {
        panic!("{effects:?}");
    };
    let JobKind::Match(input) = &**kind else {
        panic!("{kind:?}");
    };
    let starts = &input.recipe.settings.starts;
    assert_eq!(starts.method, StartMethod::CurrentPose);
    assert_eq!(input.current, window.pose());
    assert_eq!(window.state.document.recipe, recipe);
}

/// Only what begins at the pairs waits for them.
#[test]
fn what_does_not_begin_at_the_pairs_needs_none() {
    let mut window = begun_at_pairs(1);
    let why = window.state.can_match_as_asked();
    assert_eq!(why, Action::MatchOrStop.enabled(&window.state));
    assert!(why.is_err());
    for command in [MatchCommand::Run, MatchCommand::Sweep(Box::default())] {
        assert!(window.state.apply(command).is_empty());
    }
    for action in [Action::Refine, Action::Align] {
        let mut window = begun_at_pairs(1);
        assert_eq!(action.enabled(&window.state), Ok(()), "{action:?}");
        let command = action.command(&window.state).unwrap();
        let effects = window.state.apply(command);
        assert!(
            matches!(effects[..], [Effect::StartJob(..)]),
            "{action:?}: {effects:?}"
        );
    }
}

#[test]
fn pairs_of_parts_that_are_gone_do_not_count() {
    let mut window = with_pairs(3);
    window.open("stamped.k", Role::Stamped);
    assert!(window.state.document.current_pairs().is_empty());
    window.act(Action::Undo);
    assert_eq!(window.state.document.current_pairs().len(), 3);
}
