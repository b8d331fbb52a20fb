//! The story without a pointer: Tab, Enter and keys.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{
    Axis, BottomTab, Dialog, MatchCommand, MoveCommand, PartCommand, PartRef, Section, ViewCommand,
};
use shapematch::registration::Method;
use shapematch::role::Role;
use shapematch::settings::Choice as _;
use shapematch::ui::Shell;
use shapematch::ui::theme::Palette;

use super::mapping::{any_shape, is_ringed};
use super::pairs::click_in;
use super::story::{click, finish, window};

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
    let mut told = window.state().state().log.notices.toasts();
    assert!(told.any(|notice| notice.text.starts_with("Matrix (stamped → crash")));
}

/// Enter presses what has the keyboard; with Ctrl it is the window's alone.
#[test]
fn ctrl_enter_presses_nothing_that_has_the_keyboard() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    tab_to(&mut window, "Reduce");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    let document = &window.state().state().document;
    assert!(document.current_result().is_some(), "it is matched");
    for role in Role::ALL {
        let part = document.part(role).expect("loaded");
        assert!(part.level.is_none(), "and nothing is reduced");
    }
}

#[test]
fn the_key_of_a_match_that_cannot_begin_says_why() {
    let mut window = window();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    let mut told = window.state().state().log.notices.toasts();
    assert!(told.any(
        |notice| notice.text == "Load both parts first." || notice.text == "Load a part first."
    ));
}

#[test]
fn keys_that_have_nothing_to_do_yet_say_so_and_show_the_section_they_speak_of() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let told = |window: &Window, begin: &str| {
        let mut toasts = window.state().state().log.notices.toasts();
        toasts.any(|notice| notice.text.starts_with(begin))
    };
    window.key_press(Key::V);
    window.run_steps(2);
    assert!(told(&window, "Run a match first."));
    let is_open = |window: &Window| {
        let sections = &window.state().state().view.sections;
        sections.is_open(Section::Map)
    };
    assert!(!is_open(&window));
    window.key_press_modifiers(Modifiers::COMMAND, Key::M);
    window.run_steps(2);
    assert!(told(&window, "There is no match yet: "));
    assert!(is_open(&window));
    for key in [Key::W, Key::B] {
        window.key_press(Key::Escape);
        window.run_steps(2);
        assert!(!told(&window, "Move the stamped part over first"));
        window.key_down(key);
        window.run_steps(2);
        assert!(told(&window, "Move the stamped part over first"), "{key:?}");
        let view = &window.state().state().view;
        assert!(view.display.wipe.is_none() && !view.is_blinking, "{key:?}");
        window.key_up(key);
        window.run_steps(2);
    }
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

/// Where what has the keyboard lies.
fn focused_place(window: &Window) -> Option<(String, egui::Rect)> {
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        if node.is_focused() {
            return Some((node.accesskit_node().label()?, node.rect()));
        }
        queue.extend(node.children());
    }
    None
}

/// From one widget to the one beside it Tab goes to the right, also where a row ends at the right edge.
#[test]
fn tab_goes_through_a_row_from_left_to_right() {
    let mut window = super::story::matched();
    super::layout::dismiss_toasts(&mut window);
    let mut seen = Vec::new();
    for tab in [BottomTab::Log, BottomTab::Deviation] {
        let ctx = window.ctx.clone();
        let open = [
            ViewCommand::SetTab(tab),
            ViewCommand::OpenSection(Section::Load, true),
        ];
        let open = open.map(Into::into).to_vec();
        window.state_mut().run_commands(open, &ctx);
        finish(&mut window);
        let mut last: Option<(String, egui::Rect)> = None;
        for _ in 0..120 {
            window.key_press(Key::Tab);
            window.run_steps(2);
            let now = focused_place(&window);
            if let (Some((before, from)), Some((name, to))) = (&last, &now) {
                let is_beside = (from.center().y - to.center().y).abs() < 6.0;
                let is_left = to.right() <= from.left() && from.left() - to.right() < 40.0;
                assert!(
                    !is_beside || !is_left,
                    "{tab:?}: from {before:?} back to {name:?}"
                );
            }
            seen.extend(now.iter().map(|(name, _)| name.clone()));
            last = now;
        }
    }
    for name in ["Save log…", "Edges", "Nodes", "Search commands"] {
        assert!(seen.iter().any(|seen| seen == name), "{name:?}: {seen:?}");
    }
}

/// Selects a part of the crash deck, for Escape to let go where nothing else is open.
fn select_a_part(window: &mut Window) {
    let id = window.state().state().document.part(Role::Crash);
    let id = id.expect("loaded").facts.parts[0].id;
    let select = PartCommand::Select(Some(PartRef {
        role: Role::Crash,
        id,
    }));
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![select.into()], &ctx);
}

fn n_selected(window: &Window) -> usize {
    window.state().state().parts.selected.len()
}

#[test]
fn escape_closes_what_is_open_and_nothing_else() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    select_a_part(&mut window);
    // A menu.
    click(&mut window, "View");
    assert!(egui::Popup::is_any_open(&window.ctx));
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert!(!egui::Popup::is_any_open(&window.ctx));
    assert_eq!(n_selected(&window), 1, "the menu's key went to the window");
    // A key with Ctrl is no menu's: it acts, and the menu goes.
    click(&mut window, "View");
    window.key_press_modifiers(Modifiers::COMMAND, Key::B);
    window.run_steps(2);
    assert!(!egui::Popup::is_any_open(&window.ctx));
    assert!(window.state().state().view.is_column_folded());
    window.key_press_modifiers(Modifiers::COMMAND, Key::B);
    window.run_steps(2);
    // A text field.
    click(&mut window, "Move by hand");
    window.get_by_label("Matrix to paste").focus();
    window.run_steps(2);
    assert_eq!(focused(&window).as_deref(), Some("Matrix to paste"));
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert_eq!(n_selected(&window), 1, "the field's key went to the window");
    // Nothing is open any more.
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert_eq!(n_selected(&window), 0);
}

#[test]
fn ctrl_enter_in_the_field_sets_the_pose_and_runs_no_match() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Move by hand");
    window.get_by_label("Matrix to paste").focus();
    window.run_steps(2);
    let matrix = "1 0 0 7\n0 1 0 8\n0 0 1 9\n0 0 0 1";
    window.get_by_label("Matrix to paste").type_text(matrix);
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    let document = &window.state().state().document;
    let moved = document.crash_from_stamped().translation;
    assert_eq!([moved.x, moved.y, moved.z], [7.0, 8.0, 9.0]);
    assert!(document.result.is_none(), "the match ran");
}

#[test]
fn under_a_dialog_the_window_keeps_still() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.key_press(Key::F1);
    window.run_steps(2);
    window.key_press(Key::M);
    window.run_steps(2);
    assert!(!window.state().state().view.is_moved_over);
    window.key_press(Key::Escape);
    window.run_steps(2);
    window.key_press(Key::M);
    window.run_steps(2);
    assert!(window.state().state().view.is_moved_over);
}

/// A slow frame takes the click that closes a dialog and what is pressed after it together.
#[test]
fn keys_after_the_click_that_closes_a_dialog_are_the_windows() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    for is_after in [false, true] {
        let ctx = window.ctx.clone();
        let open = ViewCommand::SetDialog(Some(Dialog::Preferences)).into();
        window.state_mut().run_commands(vec![open], &ctx);
        window.run_steps(3);
        let pos = window.get_by_label("Close").rect().center();
        let button = |pressed| egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        window
            .input_mut()
            .events
            .extend([egui::Event::PointerMoved(pos), button(true)]);
        window.step();
        let mut events = vec![button(false), key(Key::M, Modifiers::NONE)];
        if !is_after {
            events.reverse();
        }
        window.input_mut().events.extend(events);
        window.run_steps(3);
        window.key_up(Key::M);
        window.step();
        let view = &window.state().state().view;
        assert_eq!(view.dialog, None);
        assert_eq!(view.is_moved_over, is_after, "after the click: {is_after}");
    }
}

#[test]
fn a_pose_moved_by_hand_can_be_copied_and_the_result_is_one_click_away() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    let matched = *window.state().state().document.crash_from_stamped();
    assert!(window.query_by_label("Copy matrix").is_some());
    let ctx = window.ctx.clone();
    let flip = MoveCommand::Flip(Axis::X).into();
    window.state_mut().run_commands(vec![flip], &ctx);
    window.run_steps(3);
    assert!(window.query_by_label("Copy matrix (not matched)").is_some());
    click(&mut window, "Back to the result");
    window.run_steps(2);
    let document = &window.state().state().document;
    assert_eq!(*document.crash_from_stamped(), matched);
    assert!(document.current_result().is_some());
}

#[test]
fn f10_opens_the_menus_and_arrows_go_from_one_to_the_next() {
    let mut window = window();
    let mut shows = |key: Key, item: &str| {
        window.key_press(key);
        window.run_steps(3);
        window.query_by_label_contains(item).is_some()
    };
    assert!(shows(Key::F10, "Preferences…"));
    assert!(shows(Key::ArrowRight, "Undo"));
    assert!(shows(Key::ArrowLeft, "Preferences…"));
    // Round the end.
    assert!(shows(Key::ArrowLeft, "Keys and mouse"));
    assert!(!shows(Key::F10, "Keys and mouse"));
}

#[test]
fn alt_alone_opens_the_menus_and_with_another_key_does_not() {
    let mut window = window();
    let mut press = |keys: &[(Key, bool)]| {
        for &(key, pressed) in keys {
            window.event(egui::Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: egui::Modifiers::ALT,
            });
        }
        window.run_steps(3);
        window.query_by_label_contains("Preferences…").is_some()
    };
    let alt = |pressed| (Key::AltLeft, pressed);
    assert!(!press(&[
        alt(true),
        (Key::H, true),
        (Key::H, false),
        alt(false)
    ]));
    assert!(!press(&[alt(true)]));
    assert!(press(&[alt(false)]));
    assert!(!press(&[alt(true), alt(false)]));
}

/// Whether a line is drawn around the named thing, at its edge or a point inside it.
fn is_framed(window: &Window, rect: egui::Rect) -> bool {
    fn any(shape: &egui::Shape, rect: egui::Rect) -> bool {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().any(|shape| any(shape, rect)),
            egui::Shape::Rect(drawn) => {
                let edges = [drawn.rect.min - rect.min, rect.max - drawn.rect.max];
                let is_at = |x: f32| (0.0..=4.5).contains(&x);
                drawn.stroke.width > 0.9 && edges.iter().all(|e| is_at(e.x) && is_at(e.y))
            }
            _ => false,
        }
    }
    let shapes = &window.output().shapes;
    shapes.iter().any(|clipped| any(&clipped.shape, rect))
}

#[test]
fn the_ring_follows_the_keyboard_and_not_the_pointer() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let canvas = |window: &Window| {
        let is_crash = |label: &str| label.starts_with("Crash part");
        let node = window.get_by(|node| {
            node.role() == egui::accesskit::Role::Canvas
                && node.label().is_some_and(|label| is_crash(&label))
        });
        assert!(node.is_focused());
        node.rect()
    };
    click_in(&mut window, Role::Crash, egui::vec2(90.0, 60.0));
    let rect = canvas(&window);
    assert!(!is_framed(&window, rect), "after a click");
    window.key_press(Key::ArrowLeft);
    window.run_steps(4);
    assert!(is_framed(&window, canvas(&window)), "after an arrow key");
    click_in(&mut window, Role::Crash, egui::vec2(90.0, 60.0));
    assert!(!is_framed(&window, rect), "after a click again");

    tab_to(&mut window, "3 Match");
    let ring = |window: &Window| {
        let style = window.ctx.global_style();
        style.visuals.widgets.active.bg_stroke.width > 1.2
    };
    assert!(ring(&window), "what Tab goes to is ringed");
    assert!(is_framed(&window, window.get_by_label("3 Match").rect()));
    click_in(&mut window, Role::Crash, egui::vec2(90.0, 60.0));
    assert!(!ring(&window), "what is pressed is not");
}

#[test]
fn the_search_is_ringed_like_the_other_buttons_of_the_bar() {
    let mut window = window();
    let ring = Palette::of_visuals(&window.ctx.global_style().visuals).accent_text;
    tab_to(&mut window, "Search commands");
    let rect = window.get_by_label("Search commands").rect();
    assert!(is_ringed(&window, rect, ring));
}

#[test]
fn a_menu_of_choices_is_walked_by_arrows_and_left_for_its_button() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let method = |window: &Window| {
        let recipe = &window.state().state().document.recipe;
        recipe.settings.method
    };
    assert_eq!(method(&window), Method::Fractional);
    // The pointer opens it, the keyboard goes on.
    let button = window.get_by_role_and_label(egui::accesskit::Role::ComboBox, "Method");
    button.click();
    window.run_steps(4);
    assert_eq!(
        focused(&window).as_deref(),
        Some(Method::Fractional.label())
    );
    for (key, at) in [
        (Key::ArrowDown, Method::Umeyama),
        (Key::ArrowDown, Method::Icp),
    ] {
        window.key_press(key);
        window.run_steps(4);
        assert_eq!(focused(&window).as_deref(), Some(at.label()));
    }
    window.key_press(Key::Enter);
    window.run_steps(6);
    assert_eq!(method(&window), Method::Icp);
    assert_eq!(
        focused(&window).as_deref(),
        Some("Method"),
        "the button of the menu"
    );
    window.key_press(Key::Enter);
    window.run_steps(4);
    window.key_press(Key::ArrowUp);
    window.run_steps(4);
    assert_eq!(focused(&window).as_deref(), Some(Method::Umeyama.label()));
    window.key_press(Key::Escape);
    window.run_steps(6);
    assert_eq!(method(&window), Method::Icp);
}

#[test]
fn tab_closes_a_menu_of_choices() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let method = egui::accesskit::Role::ComboBox;
    for modifiers in [Modifiers::NONE, Modifiers::SHIFT] {
        window.get_by_role_and_label(method, "Method").click();
        window.run_steps(4);
        assert!(egui::Popup::is_any_open(&window.ctx));
        window.key_press_modifiers(modifiers, Key::Tab);
        window.run_steps(4);
        assert!(!egui::Popup::is_any_open(&window.ctx));
        assert_eq!(focused(&window).as_deref(), Some("Method"));
    }
}

fn key(key: Key, modifiers: Modifiers) -> egui::Event {
    egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

#[test]
fn what_is_typed_while_the_search_opens_is_searched() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    // All in one frame, and then one letter a frame.
    for n_at_once in [3, 0] {
        let mut events = vec![key(Key::K, Modifiers::COMMAND)];
        // Let go, or the next one would count as repeated.
        window.key_up(Key::K);
        window.step();
        for (letter, text) in [(Key::M, "m"), (Key::O, "o"), (Key::E, "e")] {
            events.push(key(letter, Modifiers::NONE));
            events.push(egui::Event::Text(text.to_owned()));
        }
        let rest = events.split_off(1 + 2 * n_at_once);
        window.input_mut().events.extend(events);
        window.step();
        for pair in rest.chunks(2) {
            window.input_mut().events.extend(pair.iter().cloned());
            window.step();
        }
        window.run_steps(3);
        let dialog = window.state().state().view.dialog;
        assert_eq!(dialog, Some(Dialog::Palette), "{n_at_once} at once");
        let role = egui::accesskit::Role::TextInput;
        let field = window.get_by_role_and_label(role, "Search commands");
        assert_eq!(field.accesskit_node().value().as_deref(), Some("moe"));
        let view = &window.state().state().view;
        assert!(
            !view.is_moved_over && !view.display.has_edges,
            "no key acts beside it"
        );
        window.key_press(Key::Escape);
        window.run_steps(2);
        assert!(window.state().state().view.dialog.is_none());
    }
}

#[test]
fn the_field_of_the_search_stays_where_it_is_while_typing() {
    let mut window = window();
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(4);
    let role = egui::accesskit::Role::TextInput;
    let place = |window: &Window| window.get_by_role_and_label(role, "Search commands").rect();
    let before = place(&window);
    for typed in ["hist", "ory", " qqq"] {
        window.event(egui::Event::Text(typed.to_owned()));
        window.run_steps(4);
        let now = place(&window);
        assert!((now.top() - before.top()).abs() < 0.5, "{before} {now}");
    }
}

/// Enter where nothing is found changes nothing: the field keeps the keyboard, and shows it.
#[test]
fn enter_in_an_empty_search_leaves_the_keyboard_in_its_field() {
    let mut window = window();
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(2);
    window.event(egui::Event::Text("qqqqq".to_owned()));
    window.run_steps(1);
    assert!(window.query_by_label("No matching command").is_some());
    window.key_press(Key::Enter);
    window.run_steps(1);
    assert_eq!(focused(&window).as_deref(), Some("Search commands"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(egui::Event::Text("about".to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    window.run_steps(2);
    assert_eq!(
        window.state().state().view.dialog,
        Some(Dialog::About),
        "what is typed goes on being searched"
    );
}

/// A slow frame takes the key that opens the search, what is typed and Enter together.
#[test]
fn a_command_typed_and_entered_in_one_frame_is_done() {
    let mut window = window();
    let mut events = vec![key(Key::K, Modifiers::COMMAND)];
    events.extend("about".chars().map(|c| egui::Event::Text(c.to_string())));
    events.push(key(Key::Enter, Modifiers::NONE));
    for n_first in [events.len(), 1] {
        let rest = events[n_first..].to_vec();
        window
            .input_mut()
            .events
            .extend_from_slice(&events[..n_first]);
        window.step();
        window.input_mut().events.extend(rest);
        window.run_steps(3);
        let dialog = window.state().state().view.dialog;
        assert_eq!(dialog, Some(Dialog::About), "{n_first} in the first frame");
        window.key_press(Key::Escape);
        window.run_steps(2);
        window.key_up(Key::K);
        window.key_up(Key::Enter);
        window.step();
    }
}

/// A slow frame, such as the one behind an undo, takes several keys together: those behind G belong to the move.
#[test]
fn the_keys_behind_g_move_the_part_whatever_the_frame_takes_together() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let undo = (Key::Z, Modifiers::COMMAND);
    let typed = [Key::G, Key::X, Key::Num5, Key::Comma, Key::Num5, Key::Enter];
    let typed = typed.map(|key| (key, Modifiers::NONE));
    let all = || [undo].into_iter().chain(typed).collect::<Vec<_>>();
    for (keys, n_first, x) in [
        (typed.to_vec(), typed.len(), 5.5),
        (typed.to_vec(), 1, 11.0),
        (all(), all().len(), 11.0),
        (all(), 2, 11.0),
    ] {
        for frame in [&keys[..n_first], &keys[n_first..]] {
            for &(pressed, modifiers) in frame {
                let down = key(pressed, modifiers);
                let mut up = down.clone();
                if let egui::Event::Key { pressed, .. } = &mut up {
                    *pressed = false;
                }
                window.input_mut().events.extend([down, up]);
            }
            window.step();
        }
        window.run_steps(2);
        let state = window.state().state();
        assert!(state.moving.tool.is_none(), "{n_first} of {keys:?}");
        assert!(!state.view.display.is_see_through, "{n_first} of {keys:?}");
        let name = state.history.undo_name();
        let is_named = |name: &str| name.starts_with("Move 5.5") && name.ends_with("along X");
        assert!(
            name.is_some_and(is_named),
            "{name:?}, {n_first} of {keys:?}"
        );
        let moved = state.document.crash_from_stamped().translation;
        assert!((moved.x - x).abs() < 1e-9, "{moved}");
    }
}

#[test]
fn sliders_and_folds_that_the_keyboard_comes_to_are_ringed() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let ring = Palette::of_visuals(&window.ctx.global_style().visuals).accent_text;
    tab_to(&mut window, "Move by hand");
    let rect = window.get_by_label("Move by hand").rect();
    assert!(is_ringed(&window, rect, ring));
    click(&mut window, "Move over");
    finish(&mut window);
    let separation = "Draws the stamped part apart from where it is; the matrix stays";
    for name in ["■ opacity", "▲ opacity", separation] {
        tab_to(&mut window, name);
        let kind = egui::accesskit::Role::Slider;
        let slider = window.get_by_role_and_label(kind, name).rect().center();
        let is_ring = |shape: &egui::Shape| match shape {
            egui::Shape::Rect(drawn) => drawn.rect.contains(slider) && drawn.stroke.color == ring,
            _ => false,
        };
        let shapes = &window.output().shapes;
        let is_ringed = shapes.iter().any(|one| any_shape(&one.shape, &is_ring));
        assert!(is_ringed, "{name}");
    }
}

#[test]
fn a_file_that_is_not_opened_during_a_match_says_why() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let ctx = window.ctx.clone();
    for modifiers in [Modifiers::COMMAND, Modifiers::COMMAND | Modifiers::SHIFT] {
        window
            .state_mut()
            .run_commands(vec![MatchCommand::Run.into()], &ctx);
        window.key_press_modifiers(modifiers, Key::O);
        window.run_steps(1);
        let is_told = {
            let mut told = window.state().state().log.notices.toasts();
            told.any(|notice| notice.text == "A match is running.")
        };
        assert!(is_told);
        finish(&mut window);
    }
}
