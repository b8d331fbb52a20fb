//! Pairs of points clicked with the mouse in both windows.

use egui::{Event, Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::story::{click, finish, window};

/// Presses and lets go in the middle of a window, a little off.
pub(crate) fn click_in(window: &mut Harness<'static, Shell>, role: Role, off: egui::Vec2) {
    let name = match role {
        Role::Crash => "Crash part",
        Role::Stamped => "Stamped part",
    };
    let canvas = window.get_by(|node| {
        node.role() == egui::accesskit::Role::Canvas
            && node.label().is_some_and(|label| label.starts_with(name))
    });
    let pos = canvas.rect().center() + off;
    window.event(Event::PointerMoved(pos));
    window.run_steps(2);
    for pressed in [true, false] {
        window.event(Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        window.run_steps(1);
    }
    window.run_steps(2);
}

#[test]
fn three_clicked_pairs_make_a_pose() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.key_press(egui::Key::N);
    window.run_steps(2);
    assert!(window.query_by_label("Pair 1: click on").is_some());
    for (n, off) in [[-60.0, -50.0], [70.0, -40.0], [10.0, 60.0]]
        .into_iter()
        .enumerate()
    {
        assert_eq!(window.state().state().document.current_pairs().len(), n);
        for role in Role::ALL {
            click_in(&mut window, role, off.into());
        }
    }
    let state = window.state().state();
    assert_eq!(state.document.current_pairs().len(), 3);
    assert!(
        state
            .document
            .current_pairs()
            .iter()
            .all(|p| p.crash.is_some() && p.stamped.is_some())
    );
    assert!(state.parts.selected.is_empty(), "a pick is no selection");
    let expected = state
        .document
        .pair_fit()
        .expect("a pose")
        .fit
        .target_from_source;
    click(&mut window, "Fit the pairs");
    finish(&mut window);
    assert_eq!(
        *window.state().state().document.crash_from_stamped(),
        expected
    );
    click(&mut window, "Delete pair 2");
    assert_eq!(window.state().state().document.current_pairs().len(), 2);
    assert!(window.query_by_label("One more pair is needed.").is_some());
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().pairs.tool, None);
}
