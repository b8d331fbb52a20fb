//! The stamped window follows its part, and keys act on the window that was used last.

use egui::{PointerButton, Rect};
use egui_kittest::Harness;
use shapematch::app::{Action, GestureId, MoveCommand, ViewCommand, rotation_about};
use shapematch::geometry::camera::ScreenSize;
use shapematch::geometry::{Point3, Similarity, Vector3};
use shapematch::role::Role;

use super::viewport::{Desk, area, harness, settle};

/// Share of the stamped part's nodes that its window shows, and how much of its height they take.
fn seen(harness: &Harness<'_, Desk>) -> (f64, f64) {
    let desk = harness.state();
    let area: Rect = area(harness, Role::Stamped);
    let screen = ScreenSize {
        width: f64::from(area.width()),
        height: f64::from(area.height()),
    };
    let (camera, pose) = (desk.camera(Role::Stamped), desk.state.shown_pose());
    let part = desk.state.document.part(Role::Stamped).unwrap();
    let nodes = part.loaded.mesh.positions();
    let places: Vec<_> = nodes
        .iter()
        .filter_map(|node| camera.project(&pose.apply(node), screen))
        .filter(|at| (0.0..screen.width).contains(&at.x) && (0.0..screen.height).contains(&at.y))
        .collect();
    let low = places.iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
    let high = places.iter().map(|at| at.y).fold(0.0, f64::max);
    (
        places.len() as f64 / nodes.len() as f64,
        (high - low) / screen.height,
    )
}

fn act(harness: &mut Harness<'_, Desk>, action: Action) {
    let desk = harness.state_mut();
    let command = action.command(&desk.state).unwrap();
    desk.apply(command);
    settle(harness);
}

#[test]
fn after_every_step_of_the_pose_the_stamped_window_shows_its_part_whole() {
    let mut harness = harness(Desk::with_sheets(None));
    assert_eq!(seen(&harness).0, 1.0);
    // Far away and turned: the one is fitted, the other carried along, and both must not add up.
    let away = Similarity {
        translation: Vector3::new(900.0, -400.0, 250.0),
        ..Similarity::identity()
    };
    let delta = away.after(&rotation_about(
        &Point3::origin(),
        &Vector3::new(1.0, 0.4, 0.2),
        2.0,
    ));
    let name = "Drag".to_owned();
    let gesture = GestureId(1);
    let step = MoveCommand::Drag {
        gesture,
        delta,
        name,
    };
    harness.state_mut().apply(step.into());
    settle(&mut harness);
    let (share, height) = seen(&harness);
    assert!(share == 1.0 && height > 0.2, "moved: {share} {height}");
    for action in [Action::Undo, Action::Redo, Action::Undo] {
        act(&mut harness, action);
        let (share, height) = seen(&harness);
        assert!(share == 1.0 && height > 0.2, "{action:?}: {share} {height}");
    }
}

/// A camera that turned with the part would show the same picture as before.
#[test]
fn a_part_that_is_turned_over_is_seen_turned_over() {
    let mut harness = harness(Desk::with_sheets(None));
    let before = harness.state().camera(Role::Stamped);
    act(&mut harness, Action::FlipX);
    let after = harness.state().camera(Role::Stamped);
    assert_eq!(after.world_from_view, before.world_from_view);
    assert_eq!(seen(&harness).0, 1.0);
}

#[test]
fn fit_all_fits_both_windows() {
    let mut harness = harness(Desk::with_sheets(None));
    for role in Role::ALL {
        let mut camera = harness.state().camera(role);
        camera.target.x += 1e4;
        let command = ViewCommand::SetCamera(role, camera);
        harness.state_mut().apply(command.into());
    }
    settle(&mut harness);
    assert_eq!(seen(&harness).0, 0.0);
    act(&mut harness, Action::FitAll);
    let state = &harness.state().state;
    assert!(Role::ALL.iter().all(|role| state.view.is_fitted(*role)));
    assert_eq!(seen(&harness).0, 1.0);
}

#[test]
fn a_quick_click_beside_the_part_chooses_the_window() {
    let mut harness = harness(Desk::with_sheets(None));
    for role in [Role::Stamped, Role::Crash, Role::Stamped] {
        let at = area(&harness, role).center_bottom() - egui::vec2(0.0, 3.0);
        harness.event(egui::Event::PointerMoved(at));
        for pressed in [true, false] {
            harness.event(egui::Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            });
        }
        harness.run_steps(2);
        assert_eq!(harness.state().state.view.focus, role);
    }
}
