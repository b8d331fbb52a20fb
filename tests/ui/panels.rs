//! Panels clicked by name, with the keyboard, at several sizes.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{
    Action, Axis, AxisFrame, BottomTab, Dialog, FileCommand, Menu, MoveCommand, Section,
    ViewCommand,
};
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::layout::{Painted, texts};
use super::story::{click, finish, matched, window};

type Window = Harness<'static, Shell>;

#[test]
fn an_empty_window_invites_and_says_why_the_rest_waits() {
    let window = window();
    for name in [
        "Drop the crash model here",
        "Drop the stamped part here",
        "Load a part first.",
        "Load both parts first.",
    ] {
        assert!(window.query_by_label(name).is_some(), "{name}");
    }
    // One command has one name, in the windows and in the column.
    for action in [Action::OpenCrash, Action::OpenStamped] {
        let name = action.row().label;
        assert_eq!(window.query_all_by_label(name).count(), 2, "{name}");
    }
}

#[test]
fn sections_fold_tabs_turn_and_dialogs_open_by_key() {
    let mut window = window();
    click(&mut window, "2 Reduce");
    assert!(
        !window
            .state()
            .state()
            .view
            .sections
            .is_open(Section::Reduce)
    );
    assert!(window.query_by_label("Sweep").is_none(), "nothing to sweep");
    click(&mut window, "Open the example pair");
    finish(&mut window);
    for tab in [
        BottomTab::Timings,
        BottomTab::Sweep,
        BottomTab::History,
        BottomTab::Log,
    ] {
        click(&mut window, tab.label());
        assert_eq!(window.state().state().view.tab, tab);
    }
    window.key_press(egui::Key::F1);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, Some(Dialog::Help));
    assert!(window.query_by_label("Esc to close").is_some());
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, None);
}

#[test]
fn the_help_sheet_has_all_keys() {
    let mut window = window();
    window.key_press(egui::Key::F1);
    window.run_steps(2);
    let has = |is_it: &dyn Fn(&str) -> bool| {
        let texts = window.query_all_by(|node| node.value().is_some_and(|text| is_it(&text)));
        texts.count() > 0
    };
    let keyed = Action::ALL.iter().map(|action| action.row());
    for info in keyed.filter(|info| info.shortcut().is_some()) {
        assert!(has(&|text| text == info.label), "{}", info.label);
        for key in info.keys.shortcuts {
            let key = key.to_string();
            assert!(has(&|text| text.split(", ").any(|one| one == key)), "{key}");
        }
    }
}

#[test]
fn every_action_stands_in_its_menu() {
    let mut window = window();
    for menu in Menu::ALL {
        let bar = window.query_all_by_label(menu.label()).next();
        bar.expect("the menu").click_accesskit();
        window.run_steps(2);
        for group in menu.groups() {
            if let Some(name) = group.submenu {
                let opener = window.get_by(|node| {
                    let label = node.label();
                    label.is_some_and(|text| text.trim_end_matches(['⏵', ' ']) == name)
                });
                opener.hover();
                window.run_steps(20);
            }
            for info in group.rows {
                let keys = info.shortcut().map_or_else(String::new, |s| s.to_string());
                let is_item = |text: String| {
                    let rest = text.strip_prefix(info.label);
                    rest.is_some_and(|rest| rest.trim() == keys)
                };
                let mut items = window.query_all_by(|node| node.label().is_some_and(is_item));
                assert!(items.next().is_some(), "{}", info.label);
            }
        }
        window.key_press(egui::Key::Escape);
        window.run_steps(2);
    }
}

#[test]
fn parts_hide_swap_and_come_back_by_undo() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Show Part 1");
    let hidden = |window: &egui_kittest::Harness<'static, shapematch::ui::Shell>| {
        let part = window.state().state().document.part(Role::Stamped);
        part.expect("loaded").hidden.len()
    };
    assert_eq!(hidden(&window), 1);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.run_steps(2);
    assert_eq!(hidden(&window), 0);
    let name = |window: &egui_kittest::Harness<'static, shapematch::ui::Shell>| {
        let part = window.state().state().document.part(Role::Crash);
        part.expect("loaded").loaded.file_name()
    };
    let before = name(&window);
    click(&mut window, "⇄ Swap");
    assert_ne!(name(&window), before);
}

#[test]
fn every_state_of_the_window_has_names_at_every_size() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Match settings");
    click(&mut window, "Move by hand");
    for size in [[1280.0, 720.0], [700.0, 450.0], [2560.0, 1440.0]] {
        window.set_size(egui::Vec2::from(size));
        window.run_steps(3);
        window.check_accessibility();
    }
}

#[test]
fn the_numbers_of_a_pose_stay_within_the_column() {
    let mut window = matched();
    click(&mut window, "Move by hand");
    let ctx = window.ctx.clone();
    for distance in [0.0, -14_359.123_4] {
        let by_hand = MoveCommand::Translate {
            axis: Axis::X,
            frame: AxisFrame::Global,
            distance,
        };
        window.state_mut().run_commands(vec![by_hand.into()], &ctx);
        for width in [1400.0, 800.0] {
            window.set_size(egui::vec2(width, 900.0));
            window.run_steps(4);
            let is_view = |label: String| label.starts_with("Crash part, ");
            let view = window.get_by(|node| node.label().is_some_and(is_view));
            let edge = view.rect().left() - 12.0;
            for name in [
                "Centre Z",
                "Move of centre since loading, Z",
                "Matrix to paste",
            ] {
                let field = window.get_by_label(name).rect();
                assert!(field.right() < edge, "{name} at {width}: {field}, {edge}");
            }
        }
    }
}

/// How far the stamped part was moved along X.
fn moved_x(window: &Window) -> f64 {
    let document = &window.state().state().document;
    document.crash_from_stamped().translation.x
}

#[test]
fn a_typed_move_takes_a_decimal_comma_and_its_button_stays_under_the_pointer() {
    let mut window = matched();
    click(&mut window, "Move by hand");
    window.run_steps(4);
    for (typed, moved) in [("12,5", 12.5), ("1 cm", 10.0), ("nan", 10.0), ("inf", 10.0)] {
        let before = moved_x(&window);
        window.get_by_label("Move by").click();
        window.run_steps(2);
        window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        window.event(egui::Event::Text(typed.to_owned()));
        window.run_steps(2);
        window.key_press(egui::Key::Enter);
        window.run_steps(2);
        let name = format!("Move by {moved} mm on X");
        let at = window.get_by_label(&name).rect().center();
        window.hover_at(at);
        window.run_steps(2);
        window.get_by_label(&name).click();
        window.run_steps(4);
        assert!((moved_x(&window) - before - moved).abs() < 1e-9, "{typed}");
        let now = window.get_by_label(&name).rect();
        assert!(
            now.contains(at),
            "{typed}: the button went from {at} to {now}"
        );
    }
}

/// In a pane that is too low for all of the newest row, it is cut after as many lines as fit, and its first line is
/// seen.
#[test]
fn the_log_of_a_low_pane_shows_the_result_from_its_first_line() {
    let mut window = matched();
    for [width, height] in [[560.0, 330.0], [640.0, 360.0], [1400.0, 900.0]] {
        window.set_size(egui::vec2(width, height));
        window.run_steps(4);
        let seen = texts(&window);
        let is_result = |seen: &&Painted| seen.text.starts_with("GOOD: overlap");
        let found: Vec<&Painted> = seen.iter().filter(is_result).collect();
        assert!(!found.is_empty(), "{width} × {height}: not seen");
        let is_cut = |seen: &&&Painted| seen.rect.top() < seen.clip.top();
        assert_eq!(found.iter().filter(is_cut).count(), 0, "{width} × {height}");
    }
}

/// Which sections are unfolded, as their headers tell.
fn folds(window: &Window) -> Vec<bool> {
    ["1 Load & display", "2 Reduce", "3 Match", "4 Map"]
        .map(|header| {
            let node = window.get_by_label(header);
            node.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
        })
        .to_vec()
}

/// Sections fold and unfold by themselves at a load, a match and a mapping, and at nothing between.
#[test]
fn undo_levels_and_moves_by_hand_fold_no_section() {
    let mut window = matched();
    window.set_size(egui::vec2(1280.0, 720.0));
    window.run_steps(8);
    let before = folds(&window);
    assert!(before[2], "the verdict is seen");
    let (ctrl, none) = (egui::Modifiers::COMMAND, egui::Modifiers::NONE);
    for (key, held) in [
        (egui::Key::Z, ctrl),
        (egui::Key::Y, ctrl),
        (egui::Key::PageUp, none),
    ] {
        window.key_press_modifiers(held, key);
        window.run_steps(2);
        finish(&mut window);
        window.run_steps(4);
        assert_eq!(folds(&window), before, "{key:?}");
    }
    let ctx = window.ctx.clone();
    let flip = MoveCommand::Flip(Axis::X).into();
    window.state_mut().run_commands(vec![flip], &ctx);
    window.run_steps(8);
    assert_eq!(folds(&window), before, "a move by hand");
}

/// What a click hits stays where it is when the first number is typed.
#[test]
fn the_first_move_by_hand_shifts_nothing() {
    let mut window = window();
    window.set_size(egui::vec2(1400.0, 1600.0));
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Move by hand");
    window.run_steps(4);
    let field = "Move of centre since loading, X";
    let role = egui::accesskit::Role::SpinButton;
    let place = |window: &Window| window.get_by_role_and_label(role, field).rect();
    let before = place(&window);
    super::typed::type_into(&mut window, field, "3");
    window.run_steps(4);
    assert_eq!(moved_x(&window), 3.0);
    let after = place(&window);
    assert!((after.min - before.min).length() < 0.5, "{before} {after}");
}

#[test]
fn the_header_of_a_folded_section_says_that_the_unit_is_in_doubt() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let ctx = window.ctx.clone();
    let smaller = FileCommand::SetLengthFactor {
        role: Role::Stamped,
        factor: 0.001,
    };
    let fold = ViewCommand::OpenSection(Section::Load, false);
    for command in [smaller.into(), fold.into()] {
        window.state_mut().run_commands(vec![command], &ctx);
        window.run_steps(2);
        finish(&mut window);
    }
    window.run_steps(4);
    let texts = super::layout::texts(&window);
    let mut texts = texts.iter().map(|painted| painted.text.as_str());
    assert!(texts.any(|text| text == "⚠ unit in doubt"));
}

/// The card of a result and the header of its section say each figure once.
#[test]
fn each_figure_of_a_match_is_said_once_beside_the_windows() {
    let mut window = matched();
    window.set_size(egui::vec2(1280.0, 1400.0));
    window.run_steps(8);
    let state = window.state().state();
    let coverage = *state.result_coverage().expect("a result");
    let lengths = state.lengths();
    let p95 = lengths.of(coverage.p95());
    let rms = format!("{} · ", lengths.number(coverage.rmse()));
    let texts = texts(&window);
    // The log below the windows is as wide as they are.
    let said = || texts.iter().filter(|text| text.clip.right() < 400.0);
    let count = |part: &str| said().filter(|text| text.text.contains(part)).count();
    assert_eq!(count(&p95), 1, "{p95}");
    assert_eq!(count(&rms), 1, "{rms}");
    assert_eq!(count("RMS"), 1);
    assert_eq!(said().filter(|text| text.text.ends_with("GOOD")).count(), 1);
    assert_eq!(count("lies within"), 0);
    let n_starts = state
        .document
        .result
        .as_ref()
        .map(|result| result.run.outcome.starts.len());
    assert_eq!(count(&format!("{} starts", n_starts.expect("a result"))), 0);
    assert_eq!(count(" pose fits nearly as well"), 1);
}

#[test]
fn a_menu_that_is_higher_than_the_window_scrolls_to_its_last_entry() {
    let mut window = window();
    window.set_size(egui::vec2(800.0, 400.0));
    window.run_steps(3);
    click(&mut window, "Export");
    window.run_steps(3);
    let bar = window.get_by_label("Export").rect();
    let seen = |window: &Window, name: &str| {
        let mut all = texts(window).into_iter();
        all.find(|text| text.text.starts_with(name))
    };
    let first = seen(&window, "Copy matrix").expect("the first entry");
    assert!(first.rect.top() > bar.bottom() - 1.0, "beside its button");
    assert!(seen(&window, "Save part as").is_none(), "no room for it");
    window.hover_at(first.rect.center());
    window.run_steps(2);
    for _ in 0..20 {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, -100.0),
            phase: egui::TouchPhase::Move,
            modifiers: egui::Modifiers::NONE,
            source: egui::MouseWheelSource::Wheel,
        });
        window.run_steps(2);
    }
    let last = seen(&window, "Save part as").expect("the last entry");
    assert!(last.clip.contains_rect(last.rect.shrink(1.0)));
}
