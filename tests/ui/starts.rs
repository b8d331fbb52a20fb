//! The rows of the starts and the curves of the iterations, by name.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::Preview;
use shapematch::geometry::camera::ScreenSize;
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::story::{click, finish, window};

#[test]
fn a_match_leaves_rows_to_take_and_curves_to_step_through() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Reduce");
    finish(&mut window);
    click(&mut window, "Match the parts");
    finish(&mut window);
    click(&mut window, "Starts");
    let outcome = {
        let result = window.state().state().document.result.as_ref();
        std::sync::Arc::clone(&result.expect("matched").run.outcome)
    };
    let winner = outcome.winner;
    let name = format!("Use the pose of start {}", winner + 1);
    assert!(window.query_by_label(&name).is_some(), "{name}");
    assert!(window.query_by_label("✔ best").is_some());
    click(&mut window, "Convergence");
    click(&mut window, "Iteration before");
    let n_steps = outcome.starts[winner].iterations.len();
    let last = Preview::Step {
        start: winner,
        iteration: n_steps - 1,
    };
    assert_eq!(window.state().state().preview(), Some(last));
    click(&mut window, "Iteration before");
    let shown = window.state().state().shown_pose();
    let pose = outcome.starts[winner].iterations[n_steps - 2].target_from_source;
    assert_eq!(shown, pose);
    click(&mut window, "Back to the result");
    assert!(!window.state().state().is_preview());
}

#[test]
fn one_camera_shows_every_first_pose_whole() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let camera = |window: &Harness<'static, Shell>| window.state().state().view.cameras.crash;
    let alone = camera(&window);
    click(&mut window, "Align surface normals");
    finish(&mut window);
    window.run_steps(20);
    let fitted = camera(&window);
    let n_starts = window.state().state().current_starts().map(<[_]>::len);
    for start in 0..n_starts.expect("first poses") {
        assert_eq!(camera(&window), fitted, "start {start}");
        let area = window
            .get_by(|node| {
                node.label()
                    .is_some_and(|label| label.starts_with("Crash part, "))
            })
            .rect();
        let screen = ScreenSize {
            width: f64::from(area.width()),
            height: f64::from(area.height()),
        };
        let state = window.state().state();
        let part = state.document.part(Role::Stamped).expect("loaded");
        for point in part.loaded.mesh.positions() {
            let point = state.shown_pose().apply(point);
            let at = fitted.project(&point, screen).expect("before the eye");
            let at = area.min + egui::vec2(at.x as f32, at.y as f32);
            assert!(area.contains(at), "start {start}: {at} not in {area}");
        }
        click(&mut window, "Next start");
        window.run_steps(4);
    }
    // Without a first pose the crash part fills its window again.
    click(&mut window, "Back");
    window.run_steps(20);
    assert_eq!(camera(&window), alone);
}

#[test]
fn a_section_of_a_first_pose_is_cut_once_in_each_window() {
    let mut window = super::project::drawn(0.25);
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Align surface normals");
    finish(&mut window);
    assert!(window.state().state().shown_start().is_some());
    // The windows show the stamped part at two poses; once both are cut, nothing is left to do.
    window.key_press(egui::Key::S);
    super::project::picture(&mut window);
    for _ in 0..10 {
        window.run_steps(1);
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert!(window.state_mut().picture().is_some(), "cut again");
    }
}

#[test]
fn the_card_says_that_it_is_of_the_result_while_a_start_is_shown() {
    let mut window = super::story::matched();
    let label = {
        let result = window.state().state().document.current_result();
        result.expect("matched").verdict().label()
    };
    click(&mut window, "Align surface normals");
    finish(&mut window);
    click(&mut window, "Next start");
    let said = format!("Result: {label}. Shown is start 2.");
    assert!(window.query_by_label(&said).is_some(), "{said}");
    click(&mut window, "Deviation");
    finish(&mut window);
    assert!(window.query_by_label("at start 2").is_some());
    click(&mut window, "Back");
    finish(&mut window);
    assert!(window.query_by_label(&said).is_none());
    assert!(window.query_by_label("at start 2").is_none());
}
