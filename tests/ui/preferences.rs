//! Preferences hold at once, and are what the file of preferences keeps.

use egui::accesskit::Role as Kind;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{Action, BottomTab, Command, Settings, ViewCommand};
use shapematch::colormap::ColorMap;
use shapematch::ui::Shell;

use super::story::{click, finish, matched};

type Window = Harness<'static, Shell>;

fn settings(window: &Window) -> &Settings {
    &window.state().state().settings
}

/// Opens the preferences, clicks what is named, closes them.
fn choose(window: &mut Window, names: &[&str]) {
    run(window, Action::Preferences);
    for name in names {
        click(window, name);
    }
    click(window, "Close");
}

/// Chooses a colour map in its row.
fn choose_map(window: &mut Window, row: &str, map: &str) {
    run(window, Action::Preferences);
    let menu = window.get_by_role_and_label(Kind::ComboBox, row);
    menu.click_accesskit();
    window.run_steps(2);
    click(window, map);
    click(window, "Close");
}

fn run(window: &mut Window, action: Action) {
    if let Some(command) = action.command(window.state().state()) {
        apply(window, command);
    }
}

fn apply(window: &mut Window, command: Command) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command], &ctx);
    window.run_steps(2);
}

/// Texts of the window that contain `part`.
fn texts(window: &Window, part: &str) -> Vec<String> {
    let has = |text: &Option<String>| text.as_ref().is_some_and(|text| text.contains(part));
    let nodes = window.query_all_by(|node| has(&node.label()) || has(&node.value()));
    let texts = nodes.filter_map(|node| {
        let node = node.accesskit_node();
        node.label()
            .filter(|text| text.contains(part))
            .or_else(|| node.value())
    });
    texts.collect()
}

/// True if `text` has a length in millimetres with so many decimals.
fn has_decimals(text: &str, decimals: usize) -> bool {
    text.split(" mm").any(|before| {
        let digits = before
            .chars()
            .rev()
            .take_while(char::is_ascii_digit)
            .count();
        digits == decimals && before[..before.len() - digits].ends_with('.')
    })
}

#[test]
fn every_length_has_the_decimals_of_the_preferences() {
    let mut window = matched();
    assert_eq!(settings(&window).decimals, None);
    for decimals in [2, 4] {
        let example = format!("{:.decimals$} mm", 0.0);
        choose(&mut window, &[&example]);
        assert_eq!(settings(&window).decimals.map(usize::from), Some(decimals));
        let mut places = vec!["within ", " · "];
        run(&mut window, Action::ToggleDeviation);
        finish(&mut window);
        apply(
            &mut window,
            ViewCommand::SetTab(BottomTab::Deviation).into(),
        );
        places.push("matched ≤");
        for place in places {
            let found = texts(&window, place);
            let lengths = found.iter().filter(|text| text.contains(" mm"));
            // Fields that are typed in and lines of the log keep what they had.
            assert!(
                lengths.clone().any(|text| has_decimals(text, decimals)),
                "{place}: {found:?}"
            );
        }
        run(&mut window, Action::ToggleDeviation);
    }
    choose(&mut window, &["Automatic"]);
    assert_eq!(settings(&window).decimals, None);
}

#[test]
fn the_preferences_fit_a_small_window_and_show_the_scale_of_the_keys() {
    let mut window = super::story::window();
    for _ in 0..10 {
        run(&mut window, Action::ScaleUp);
    }
    assert_eq!(settings(&window).ui_scale, 2.25);
    window.set_size(egui::vec2(1280.0, 720.0) / 2.25);
    window.run_steps(2);
    run(&mut window, Action::Preferences);
    window.run_steps(4);
    let screen = window.ctx.content_rect();
    for name in ["Close", "225 %", "250 %"] {
        let place = window.get_by_label(name).rect();
        assert!(
            screen.shrink(16.0).contains_rect(place),
            "{name}: {place} of {screen}"
        );
    }
    click(&mut window, "Close");
    for (action, end) in [(Action::ScaleUp, 2.5), (Action::ScaleDown, 0.75)] {
        for _ in 0..20 {
            run(&mut window, action);
        }
        assert_eq!(settings(&window).ui_scale, end);
        assert!(action.enabled(window.state().state()).is_err());
    }
}

#[test]
fn colours_of_the_preferences_hold_at_once_and_for_the_next_start() {
    let mut window = matched();
    run(&mut window, Action::ToggleDeviation);
    finish(&mut window);
    let map = |window: &Window| {
        let state = window.state().state();
        state.deviation_scale().expect("measured").map
    };
    assert_eq!(map(&window), ColorMap::CoolWarm);
    choose_map(&mut window, "Deviation colours", "Grey, for printing");
    assert_eq!(map(&window), ColorMap::Grey);
    choose_map(&mut window, "Other colours", "Cividis");
    assert_eq!(
        window.state().state().view.display.coloring.map,
        ColorMap::Cividis
    );

    // What the file keeps is what the next window begins with.
    let kept = serde_json::to_string(settings(&window)).unwrap();
    let read: Settings = serde_json::from_str(&kept).unwrap();
    assert_eq!(&read, settings(&window));
    let next = shapematch::app::AppState::new(read);
    assert_eq!(next.view.display.coloring.signed_map, ColorMap::Grey);
    assert_eq!(next.view.display.coloring.map, ColorMap::Cividis);
    // A file with keys missing, and one that someone edited.
    let old: Settings = serde_json::from_str("{}").unwrap();
    assert_eq!(old, Settings::default());
    let edited: Settings = serde_json::from_str("{\"decimals\": 200}").unwrap();
    assert_eq!(edited.sanitized().decimals, Some(4));
}
