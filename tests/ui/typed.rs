//! Numbers typed into fields: what no field takes changes nothing and is told at the field.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{Command, MatchCommand, Settings, ViewCommand};
use shapematch::mapping::MapOptions;
use shapematch::registration::{Floor, MatchSettings, Method, PairSelection};
use shapematch::role::Role;
use shapematch::settings::{Domain, MAP_SETTINGS, MatchRecipe, SETTINGS, Setting, Unit};
use shapematch::ui::Shell;
use shapematch::ui::theme::Palette;

use super::mapping::is_ringed;
use super::story::{click, finish, matched, window};

type Window = Harness<'static, Shell>;

fn run(window: &mut Window, command: impl Into<Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command.into()], &ctx);
    window.run_steps(4);
}

/// Types a text into a field and leaves it with Enter.
pub(crate) fn type_into(window: &mut Window, field: &str, text: &str) {
    let role = egui::accesskit::Role::SpinButton;
    window.get_by_role_and_label(role, field).click();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.event(egui::Event::Text(text.to_owned()));
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(2);
}

/// Types texts that a field does not take; each is told with its reason.
fn is_refused(window: &mut Window, field: &str, typed: &[(&str, &str)]) {
    for (text, why) in typed {
        type_into(window, field, text);
        assert!(window.query_by_label(why).is_some(), "{field}: {why}");
    }
}

/// The fields of a table that are numbers: their names, and texts that they refuse with the begin of the reason.
fn numbers<R>(table: &'static [Setting<R>]) -> Vec<(&'static str, [(&'static str, String); 2])> {
    let told = |row: &'static Setting<R>| {
        let (what, outside) = match &row.domain {
            Domain::Count(_) => ("whole number", "1e12"),
            Domain::Limit(_) => ("whole number", "0"),
            Domain::Number {
                unit: Unit::Length | Unit::LengthOrAuto,
                ..
            }
            | Domain::Reach
            | Domain::Floor => ("length", "-1"),
            Domain::Number { .. } => ("number", "-1"),
            Domain::Choice(_) | Domain::Switch | Domain::Poses => return None,
        };
        let field = match &row.domain {
            Domain::Floor => "Length of the floor",
            _ => row.label,
        };
        let none = |text: &str| format!("“{text}” is not a {what}.");
        // Where every whole number is taken, a part of one is not.
        let takes_all = matches!(&row.domain, Domain::Count(range) if *range.end() == usize::MAX);
        let second = if takes_all {
            ("1,5", none("1,5"))
        } else {
            (outside, format!("{field}: "))
        };
        Some((field, [("much", none("much")), second]))
    };
    table.iter().filter_map(told).collect()
}

/// Each field of a table that is there refuses what it does not take; the names of those that are there.
fn walk<R>(window: &mut Window, table: &'static [Setting<R>]) -> Vec<&'static str> {
    let role = egui::accesskit::Role::SpinButton;
    let mut seen = Vec::new();
    for (field, typed) in numbers(table) {
        if window.query_by_role_and_label(role, field).is_none() {
            continue;
        }
        for (text, why) in typed {
            type_into(window, field, text);
            let mut told = window
                .query_all_by(|node| node.value().is_some_and(|value| value.starts_with(&why)));
            assert!(told.next().is_some(), "{field}, typed {text}: {why}");
        }
        seen.push(field);
    }
    seen
}

#[test]
fn every_number_of_the_settings_says_at_its_field_why_a_text_is_refused() {
    let mut window = window();
    window.set_size(egui::vec2(1400.0, 2400.0));
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Match settings");
    let mut seen = Vec::new();
    for selection in [
        PairSelection::Fractional {
            lambda: 3.0,
            floor: Floor::Length(0.1),
        },
        PairSelection::Trimmed { overlap: 0.9 },
    ] {
        let recipe = MatchRecipe {
            settings: MatchSettings {
                selection,
                ..MatchSettings::of(Method::Fractional)
            },
            max_triangles: Some(2000),
        };
        run(
            &mut window,
            MatchCommand::SetRecipe(Box::new(recipe.clone())),
        );
        seen.extend(walk(&mut window, &SETTINGS));
        assert_eq!(window.state().state().document.recipe, recipe);
    }
    for (field, _) in numbers(&SETTINGS) {
        assert!(seen.contains(&field), "{field} is not in the form");
    }
    click(&mut window, "4 Map");
    click(&mut window, "Mapping settings");
    let seen = walk(&mut window, &MAP_SETTINGS);
    let names: Vec<_> = numbers(&MAP_SETTINGS)
        .into_iter()
        .map(|row| row.0)
        .collect();
    assert_eq!(seen, names);
    let recipe = &window.state().state().document.mapping.recipe;
    assert_eq!(recipe.options, MapOptions::default());
}

#[test]
fn limits_moves_and_sizes_that_cannot_be_are_refused() {
    let mut window = matched();
    click(&mut window, "Move over");
    finish(&mut window);
    click(&mut window, "Unfold the legend (stamped)");
    let coloring = |window: &Window| window.state().state().view.display.coloring;
    let before = coloring(&window);
    let role = egui::accesskit::Role::SpinButton;
    let below = |window: &Window| {
        let field = window.get_by_role_and_label(role, "Tolerance (stamped)");
        field.rect().top()
    };
    let at = below(&window);
    let lower = [("much", "“much” is not a number.")];
    is_refused(&mut window, "Lower limit (stamped)", &lower);
    assert_eq!(below(&window), at, "the fields of the legend stay in place");
    let tolerance = [("-1", "Tolerance: 0 to 1,000,000,000.")];
    is_refused(&mut window, "Tolerance (stamped)", &tolerance);
    assert_eq!(coloring(&window), before);
    let mut display = window.state().state().view.display.clone();
    display.coloring.limits = Some([0.5, 1.0]);
    run(&mut window, ViewCommand::SetDisplay(Box::new(display)));
    is_refused(
        &mut window,
        "Upper limit (stamped)",
        &[("0.25", "Upper limit: above +0.500.")],
    );
    assert_eq!(coloring(&window).limits, Some([0.5, 1.0]));
}

#[test]
fn a_number_that_cannot_be_is_refused_where_it_is_typed() {
    let mut window = matched();
    let level = |window: &Window| {
        let state = window.state().state();
        let part = state.document.part(Role::Crash).expect("loaded");
        (state.settings.max_triangles, part.wanted_level)
    };
    click(&mut window, "2 Reduce");
    window.run_steps(4);
    let before = level(&window);
    let below = |window: &Window| {
        let row = window.get_by_label("Reduce both parts").rect();
        (window.get_by_label("3 Match").rect().top() - row.top()).round()
    };
    let place = below(&window);
    for (typed, why) in [
        ("a few", "“a few” is not a whole number."),
        ("0", "Max triangles: 4 to 50,000,000."),
    ] {
        type_into(&mut window, "Max triangles", typed);
        assert!(window.query_by_label(why).is_some(), "{why}");
        assert_eq!(below(&window), place, "nothing below moves");
        finish(&mut window);
        assert_eq!(level(&window), before, "{typed}");
    }
    type_into(&mut window, "Max triangles", "600");
    finish(&mut window);
    assert_eq!(level(&window), (600, Some(600)));
    let refused = window.query_all_by(|node| {
        node.value()
            .is_some_and(|text| text.starts_with("Max triangles: "))
    });
    assert_eq!(refused.count(), 0);
}

#[test]
fn a_field_that_is_left_by_escape_keeps_its_value() {
    let mut window = matched();
    let tolerance = |window: &Window| {
        let recipe = &window.state().state().document.recipe;
        recipe.settings.shape_tolerance
    };
    let role = egui::accesskit::Role::SpinButton;
    window
        .get_by_role_and_label(role, "Shape tolerance")
        .click();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.event(egui::Event::Text("0.7".to_owned()));
    window.run_steps(2);
    window.key_press(egui::Key::Escape);
    window.run_steps(4);
    assert_eq!(tolerance(&window), 0.0);
    // The next text is taken.
    type_into(&mut window, "Shape tolerance", "0.9");
    finish(&mut window);
    assert_eq!(tolerance(&window), 0.9);
}

#[test]
fn a_tolerance_that_is_none_is_refused_beside_the_verdict() {
    let mut window = matched();
    let tolerance = |window: &Window| {
        let recipe = &window.state().state().document.recipe;
        recipe.settings.shape_tolerance
    };
    let typed = [
        ("wide", "“wide” is not a length."),
        ("-1", "Shape tolerance: 0 mm or more."),
    ];
    is_refused(&mut window, "Shape tolerance", &typed);
    assert_eq!(tolerance(&window), 0.0);
    // The form of the settings calls it as the card does.
    click(&mut window, "Match settings");
    let painted = super::layout::texts(&window);
    let label = painted.iter().find(|text| text.text == "Shape tolerance");
    let middle = label.expect("in the form").rect.center().y;
    let beside = |text: &&super::layout::Painted| (text.rect.center().y - middle).abs() < 6.0;
    let row: Vec<&str> = painted
        .iter()
        .filter(beside)
        .map(|text| text.text.as_str())
        .collect();
    assert!(row.contains(&"auto"), "{row:?}");
    click(&mut window, "Hide the match settings");
    type_into(&mut window, "Shape tolerance", "0,2 cm");
    finish(&mut window);
    assert_eq!(tolerance(&window), 2.0);
    let refused = typed.map(|(_, why)| why);
    let is_told = |why: &&str| window.query_by_label(why).is_some();
    assert_eq!(refused.iter().find(|why| is_told(why)), None);
    let result = window.state().state().document.current_result();
    let judged = result.and_then(|result| result.run.assessment.shape.as_ref());
    assert_eq!(judged.map(|shape| shape.tolerance.remainder), Some(2.0));
}

#[test]
fn a_refusal_goes_when_the_field_is_edited_or_its_value_changes() {
    let mut window = matched();
    window.set_size(egui::vec2(1400.0, 1400.0));
    click(&mut window, "2 Reduce");
    window.run_steps(4);
    let why = "“a few” is not a whole number.";
    let is_told = |window: &Window| window.query_by_label(why).is_some();
    let refuse = |window: &mut Window| {
        type_into(window, "Max triangles", "a few");
        assert!(is_told(window));
    };
    let role = egui::accesskit::Role::SpinButton;
    refuse(&mut window);
    let is_framed = |window: &Window| {
        let poor = Palette::of_visuals(&window.ctx.global_style().visuals).poor;
        let field = window.get_by_role_and_label(role, "Max triangles");
        is_ringed(window, field.rect(), poor)
    };
    assert!(is_framed(&window));
    type_into(&mut window, "Shape tolerance", "0.7");
    finish(&mut window);
    assert!(!is_framed(&window), "another field took a value");

    refuse(&mut window);
    window.get_by_role_and_label(role, "Max triangles").click();
    window.run_steps(2);
    assert!(!is_told(&window), "it is edited again");
    window.key_press(egui::Key::Escape);
    window.run_steps(2);

    refuse(&mut window);
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert!(!is_told(&window), "Escape");

    refuse(&mut window);
    window.get_by_label("Reduce both parts").click();
    window.run_steps(2);
    assert!(
        !is_told(&window) && !is_framed(&window),
        "the pointer was pressed"
    );

    refuse(&mut window);
    let settings = Settings {
        max_triangles: 700,
        ..window.state().state().settings.clone()
    };
    run(&mut window, Command::Settings(Box::new(settings)));
    assert!(!is_told(&window), "another value");

    window.get_by_role_and_label(role, "Max triangles").click();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.key_press(egui::Key::Backspace);
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(2);
    assert!(window.query_by_label("Enter a whole number.").is_some());
}
