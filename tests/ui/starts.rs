//! The rows of the starts and the curves of the iterations, by name.

use egui_kittest::kittest::Queryable as _;
use shapematch::app::Preview;

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
