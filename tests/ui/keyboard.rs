//! The story without a pointer: Tab, Enter and keys.

use super::story::{finish, window};
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::jobs::Role;
use shapematch::ui::Shell;

type Window = Harness<'static, Shell>;

/// Name of what has the keyboard.
fn focused(window: &Window) -> Option<String> {
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        if node.is_focused() {
            return node.accesskit_node().label();
        }
        queue.extend(node.children());
    }
    None
}

/// Presses Tab until `name` has the keyboard; the names that had it on the way.
fn tab_to(window: &mut Window, name: &str) -> Vec<String> {
    let mut passed = Vec::new();
    for _ in 0..150 {
        window.key_press(Key::Tab);
        window.run_steps(2);
        let now = focused(window).unwrap_or_default();
        let is_there = now == name;
        passed.push(now);
        if is_there {
            return passed;
        }
    }
    panic!("Tab does not reach {name:?}: {passed:?}");
}

#[test]
fn load_reduce_match_and_copy_by_keyboard_alone() {
    let mut window = window();
    tab_to(&mut window, "Open the example pair");
    window.key_press(Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    assert!(window.state().state().document.both().is_some());

    // The three sections follow one another.
    let passed = tab_to(&mut window, "3 Match");
    let place = |name: &str| passed.iter().position(|passed| passed == name);
    let (load, reduce) = (place("1 Load & display"), place("2 Reduce"));
    assert!(load.is_none() || load < reduce, "{passed:?}");
    tab_to(&mut window, "Reduce");
    window.key_press(Key::Space);
    window.run_steps(2);
    finish(&mut window);
    for role in Role::ALL {
        let part = window.state().state().document.part(role).expect("loaded");
        assert!(part.level.is_some(), "not reduced");
    }

    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    assert!(window.state().state().document.current_result().is_some());
    let keys = Modifiers::COMMAND | Modifiers::SHIFT;
    window.key_press_modifiers(keys, Key::C);
    window.run_steps(2);
    let mut told = window.state().state().notices.toasts();
    assert!(told.any(|notice| notice.text.starts_with("Matrix (stamped → crash")));
}

#[test]
fn what_has_the_keyboard_can_be_told() {
    // Every widget that Tab reaches has a name.
    let mut window = window();
    window.key_press(Key::Tab);
    window.run_steps(2);
    for _ in 0..40 {
        let name = focused(&window).unwrap_or_default();
        assert!(
            !name.trim().is_empty(),
            "something without a name has the keyboard"
        );
        window.key_press(Key::Tab);
        window.run_steps(2);
    }
    assert!(window.query_by_label("1 Load & display").is_some());
}
