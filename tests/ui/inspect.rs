//! Deviation, labels and section through the real windows: what is clicked is found by its name.

use eframe::egui_wgpu::RendererOptions;
use egui::{PointerButton, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{
    Action, Axis, AxisFrame, BottomTab, ColorBy, FreeWindow, Freshness, InspectCommand,
    MoveCommand, PictureChoice, ViewCommand, ViewRoom,
};
use shapematch::colormap::{ColorMap, ColorScale};
use shapematch::geometry::Vector3;
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::layout::texts;
use super::story::{click, finish, matched};
use super::viewport::{Desk, area, drag, harness, settle, show};

fn act(desk: &mut Desk, action: Action) {
    if let Some(command) = action.command(&desk.state) {
        desk.apply(command);
    }
}

/// Two sheets, the stamped one half a unit above the crash one, with the map on.
fn with_map() -> Desk {
    let mut desk = Desk::with_sheets(None);
    desk.apply(
        MoveCommand::Translate {
            axis: Axis::Z,
            frame: AxisFrame::Global,
            distance: 0.5,
        }
        .into(),
    );
    act(&mut desk, Action::ToggleDeviation);
    desk
}

fn starts_with(harness: &Harness<'_, Desk>, text: &str) -> usize {
    let has = |label: Option<String>| label.is_some_and(|label| label.starts_with(text));
    harness.query_all_by(|node| has(node.label())).count()
}

#[test]
fn a_click_on_the_map_pins_a_label_and_its_cross_takes_it_away() {
    let mut harness = harness(with_map());
    assert_eq!(harness.state().state.freshness(), Freshness::Current);
    let at = area(&harness, Role::Stamped).left_center() + vec2(60.0, 0.0);
    for pressed in [true, false] {
        harness.event(egui::Event::PointerMoved(at));
        harness.step();
        harness.event(egui::Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        harness.step();
    }
    harness.run_steps(2);
    let labels = &harness.state().state.document.labels;
    assert_eq!(labels.len(), 1);
    let node = labels[0].node.unwrap();
    assert_eq!(starts_with(&harness, &format!("Label node {node}: +0.")), 1);
    let id = labels[0].id;
    harness.state_mut().apply(InspectCommand::Remove(id).into());
    harness.run_steps(2);
    assert_eq!(starts_with(&harness, "Label node"), 0);
    // Panics unless the windows come to rest.
    harness.run();
}

#[test]
fn the_limits_of_the_colours_are_dragged_and_stay_symmetric() {
    let mut desk = with_map();
    desk.state.view.display.coloring.tolerance = Some(0.1);
    let mut harness = Harness::builder()
        .with_size(vec2(1000.0, 620.0))
        .build_ui_state(show, desk);
    // The map is worked out in the background.
    for _ in 0..500 {
        harness.run_steps(1);
        let label = "Unfold the legend (stamped)";
        if let Some(button) = harness.query_by_label(label) {
            button.click_accesskit();
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    harness.run_steps(3);
    let grip = harness
        .get_by_label("Upper limit of the colours (stamped)")
        .rect();
    let before = harness.state().state.deviation_scale();
    let before = before.unwrap();
    let from = grip.center();
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from - vec2(0.0, 40.0),
    );
    let limits = harness.state().state.view.display.coloring.limits.unwrap();
    assert!(limits[1] > 1.2 * before.max, "{limits:?}");
    assert_eq!(limits[0], -limits[1]);
    let grip = harness.get_by_label("Upper tolerance (stamped)").rect();
    let from = grip.center();
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from - vec2(0.0, 20.0),
    );
    let tolerance = harness
        .state()
        .state
        .view
        .display
        .coloring
        .tolerance
        .unwrap();
    assert!(tolerance > 0.12, "{tolerance}");
    assert_eq!(starts_with(&harness, "Tolerance (stamped)"), 1);
}

/// A window with the legend of a map unfolded.
fn unfolded(by: ColorBy) -> Harness<'static, Desk> {
    let mut desk = with_map();
    desk.state.view.display.color_by = by;
    let mut harness = Harness::builder()
        .with_size(vec2(1000.0, 620.0))
        .build_ui_state(show, desk);
    for _ in 0..500 {
        harness.run_steps(1);
        if let Some(button) = harness.query_by_label("Unfold the legend (stamped)") {
            button.click_accesskit();
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    harness.run_steps(3);
    harness
}

/// True if what lies beyond the limits of a map is not drawn.
fn hides(harness: &Harness<'_, Desk>, by: ColorBy) -> bool {
    let state = &harness.state().state;
    let display = &state.view.display;
    let scale = match by {
        ColorBy::Deviation => state.deviation_scale().unwrap(),
        _ => display.limited(by, ColorScale::new(ColorMap::Viridis, 0.0, 1.0)),
    };
    scale.hides_beyond
}

#[test]
fn what_lies_beyond_the_limits_is_hidden_where_they_are_set() {
    for by in [ColorBy::Deviation, ColorBy::Thickness] {
        let mut harness = unfolded(by);
        let display = |harness: &Harness<'_, Desk>| harness.state().state.view.display.clone();
        assert!(!display(&harness).coloring.hides_beyond);
        let name = "Hide outside the limits (stamped)";
        harness.get_by_label(name).click_accesskit();
        harness.run_steps(2);
        assert!(display(&harness).coloring.hides_beyond);
        // Automatic limits leave out the largest values, which are to be seen.
        assert!(!hides(&harness, by), "{by:?}");
        let grip = harness.get_by_label("Upper limit of the colours (stamped)");
        let from = grip.rect().center();
        let to = from + vec2(0.0, 30.0);
        drag(&mut harness, PointerButton::Primary, from, to);
        let after = display(&harness);
        let is_of_deviation = by == ColorBy::Deviation;
        assert_eq!(after.coloring.limits.is_some(), is_of_deviation);
        assert_eq!(after.limits.contains_key(&by), !is_of_deviation);
        // Limits of one map hide nothing in another.
        assert!(hides(&harness, by) && !hides(&harness, ColorBy::Uncertainty));
        // A project keeps both.
        let text = serde_json::to_string(&after).unwrap();
        let back: shapematch::app::Display = serde_json::from_str(&text).unwrap();
        assert_eq!(back, after);
        // The folded legend says that not everything is drawn.
        let n_notes = |harness: &Harness<'_, Desk>| {
            let notes = harness.query_all_by(|node| node.value().as_deref() == Some("rest hidden"));
            notes.count()
        };
        let n_before = n_notes(&harness);
        harness
            .get_by_label("Fold the legend (stamped)")
            .click_accesskit();
        harness.run_steps(2);
        assert!(n_notes(&harness) > n_before);
    }
}

/// Both windows with the section laid flat below them.
fn show_with_drawing(ui: &mut egui::Ui, desk: &mut Desk) {
    let (upper, lower) = ui.max_rect().split_top_bottom_at_fraction(0.7);
    let builder = egui::UiBuilder::new().max_rect(upper).id_salt("windows");
    ui.scope_builder(builder, |ui| show(ui, desk));
    let mut commands = Vec::new();
    let builder = egui::UiBuilder::new().max_rect(lower).id_salt("drawing");
    ui.scope_builder(builder, |ui| {
        desk.viewports.section_ui(ui, &desk.state, &mut commands);
    });
    for command in commands {
        desk.apply(command);
    }
}

#[test]
fn a_section_is_drawn_in_its_tab_and_moved_over_in_the_free_window() {
    let mut desk = with_map();
    act(&mut desk, Action::ToggleSection);
    assert_eq!(desk.state.view.tab, BottomTab::Section);
    act(&mut desk, Action::ToggleSection);
    assert_eq!(desk.state.view.tab, BottomTab::Log);
    act(&mut desk, Action::ToggleMoveOver);
    act(&mut desk, Action::ToggleSection);
    assert_eq!(desk.state.free_window(), Some(FreeWindow::Section));
    assert_eq!(desk.state.view.tab, BottomTab::Log);
    act(&mut desk, Action::ToggleSection);
    assert_ne!(desk.state.free_window(), Some(FreeWindow::Section));
}

#[test]
fn the_section_has_a_handle_and_a_drawing_and_both_move_the_plane() {
    let mut desk = with_map();
    act(&mut desk, Action::ToggleSection);
    let mut harness = Harness::builder()
        .with_size(vec2(1000.0, 720.0))
        .build_ui_state(show_with_drawing, desk);
    settle(&mut harness);
    assert_eq!(starts_with(&harness, "Outlines in the section plane"), 1);
    let plane =
        |harness: &Harness<'_, Desk>| harness.state().state.inspect.section.shown().unwrap();
    let before = plane(&harness);
    let grip = harness
        .get_by_label("Section plane (stamped)")
        .rect()
        .center();
    drag(
        &mut harness,
        PointerButton::Primary,
        grip,
        grip + vec2(30.0, 10.0),
    );
    let moved = plane(&harness);
    assert!(moved.distance(&before.point).abs() > 1.0);
    assert_eq!(moved.normal, before.normal);
    let grip = harness
        .get_by_label("Section plane (stamped)")
        .rect()
        .center();
    drag(
        &mut harness,
        PointerButton::Secondary,
        grip,
        grip + vec2(30.0, 10.0),
    );
    let turned = plane(&harness);
    assert!(turned.normal.angle(&before.normal) > 0.05);
    harness.get_by_label("Y").click_accesskit();
    harness.run_steps(2);
    assert_eq!(plane(&harness).normal, Vector3::y());
    harness.get_by_label("Section (section)").click_accesskit();
    harness.run_steps(2);
    assert_eq!(harness.state().state.inspect.section.shown(), None);
    assert_eq!(starts_with(&harness, "Outlines in the section plane"), 0);
}

/// While the outlines are still to come, nothing is said of where the plane lies.
#[test]
fn a_plane_that_is_still_cut_is_not_said_to_meet_nothing() {
    let mut harness = Harness::builder()
        .with_size(vec2(1000.0, 720.0))
        .build_ui_state(show_with_drawing, with_map());
    settle(&mut harness);
    for action in [Action::ToggleSection, Action::SectionX, Action::SectionY] {
        act(harness.state_mut(), action);
        for _ in 0..6 {
            harness.step();
            assert_eq!(starts_with(&harness, "The plane meets"), 0, "{action:?}");
        }
        settle(&mut harness);
        assert_eq!(starts_with(&harness, "Cutting"), 0, "{action:?}");
        assert_eq!(starts_with(&harness, "The plane meets"), 0, "{action:?}");
    }
}

#[test]
fn the_sign_can_be_told_without_colours() {
    let state = egui_kittest::wgpu::create_render_state(
        egui_kittest::wgpu::default_wgpu_setup(),
        RendererOptions::PREDICTABLE,
    );
    let renderer = egui_kittest::wgpu::WgpuTestRenderer::from_render_state(state.clone());
    let desk = Desk::with_sheets(Some(&state));
    let builder = Harness::builder()
        .with_size(vec2(360.0, 180.0))
        .renderer(renderer);
    let mut harness = builder.build_ui_state(show, desk);
    let mut measure = |distance: f64| {
        let desk = harness.state_mut();
        desk.apply(MoveCommand::Reset.into());
        desk.apply(
            MoveCommand::Translate {
                axis: Axis::Z,
                frame: AxisFrame::Global,
                distance,
            }
            .into(),
        );
        let mut display = desk.state.view.display.clone();
        display.color_by = ColorBy::Deviation;
        display.coloring.has_pattern = true;
        display.coloring.tolerance = Some(0.1);
        display.has_feature_edges = false;
        desk.apply(ViewCommand::SetDisplay(Box::new(display)).into());
        desk.apply(InspectCommand::Update.into());
        desk.apply(ViewCommand::SetRoom(Role::Stamped, ViewRoom::default()).into());
        desk.apply(ViewCommand::FitAll(Role::Stamped).into());
        // Moved by a hair it is not fitted beside the legend, but stays in the middle.
        let mut camera = desk.camera(Role::Stamped);
        camera.height *= 0.999;
        desk.apply(ViewCommand::SetCamera(Role::Stamped, camera).into());
        settle(&mut harness);
        let transparent = PictureChoice {
            is_transparent: true,
            ..PictureChoice::default()
        };
        let picture = harness
            .state_mut()
            .viewports
            .window_picture(Role::Stamped, &transparent, 1)
            .unwrap();
        let (width, height) = picture.dimensions();
        // Grey values of a square in the middle of the part.
        let side = width.min(height) / 5;
        let grey = |x: u32, y: u32| {
            let [r, g, b, _] = picture.get_pixel(x, y).0;
            f64::from(r) * 0.3 + f64::from(g) * 0.6 + f64::from(b) * 0.1
        };
        let (x0, y0) = ((width - side) / 2, (height - side) / 2);
        let rows: Vec<f64> = (0..side)
            .map(|y| (0..side).map(|x| grey(x0 + x, y0 + y)).sum::<f64>() / f64::from(side))
            .collect();
        let columns: Vec<f64> = (0..side)
            .map(|x| (0..side).map(|y| grey(x0 + x, y0 + y)).sum::<f64>() / f64::from(side))
            .collect();
        (spread(&rows), spread(&columns))
    };
    let (rows, columns) = measure(-0.5);
    assert!(
        rows > 15.0 && rows > 4.0 * columns,
        "lines: {rows} {columns}"
    );
    let (dot_rows, dot_columns) = measure(0.5);
    let [lines, dots] = [columns / rows, dot_columns / dot_rows];
    assert!(dots > 1.7 * lines, "{dots} against {lines}");
}

fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let sum: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (sum / values.len() as f64).sqrt()
}

#[test]
fn after_a_match_the_tab_tells_the_numbers_and_goes_to_the_worst_places() {
    let mut window = matched();
    click(&mut window, "Deviation");
    finish(&mut window);
    assert_eq!(window.state().state().view.tab, BottomTab::Deviation);
    assert_eq!(window.state().state().freshness(), Freshness::Current);
    let (_, stats) = window.state().state().deviation_stats().unwrap();
    assert!(stats.class_shares[0] > 0.9, "{:?}", stats.class_shares);
    let begins = |window: &Harness<'_, shapematch::ui::Shell>, text: &str| {
        let has = |label: Option<String>| label.is_some_and(|label| label.starts_with(text));
        let found = window.query_all_by(|node| has(node.label()));
        found
            .filter_map(|node| node.accesskit_node().label())
            .next()
    };
    let pin = begins(&window, "Pin ").unwrap();
    click(&mut window, &pin);
    assert_eq!(window.state().state().document.labels.len(), 1);
    let before = window.state().state().view.cameras;
    let go = begins(&window, "Go to node").unwrap();
    click(&mut window, &go);
    assert_ne!(window.state().state().view.cameras, before);
    click(&mut window, "Deviation map");
    finish(&mut window);
    assert_eq!(
        window.state().state().view.display.color_by,
        ColorBy::Deviation
    );
    window.key_press(egui::Key::S);
    window.run_steps(3);
    assert!(window.state().state().inspect.section.is_on);
    window.check_accessibility();
}

/// Seen along Y, X falls to the right. In half of a usual screen the controls stand in one row.
#[test]
fn a_section_tells_the_coordinates_of_the_part_and_its_controls_stand_in_one_row() {
    let mut window = matched();
    window.set_size(vec2(1600.0, 1000.0));
    window.run_steps(3);
    click(&mut window, "Move over");
    finish(&mut window);
    window.key_press(egui::Key::S);
    window.run_steps(3);
    let across = Action::SectionY.command(window.state().state()).unwrap();
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![across], &ctx);
    let begin = std::time::Instant::now();
    while !texts(&window)
        .iter()
        .any(|text| text.text.starts_with("Widest gap"))
    {
        assert!(begin.elapsed().as_secs() < 120, "no outlines");
        std::thread::sleep(std::time::Duration::from_millis(10));
        window.run_steps(1);
    }
    window.run_steps(5);
    let painted = texts(&window);
    let row = |name: &str| {
        let text = painted.iter().find(|text| text.text == name);
        text.unwrap_or_else(|| panic!("no {name}")).rect
    };
    let close = window.get_by_label("Section (section)").rect();
    for name in ["All", "Flip", "Worst gap"] {
        assert!(
            (row(name).center().y - close.center().y).abs() < 4.0,
            "{name}"
        );
    }
    let axis = row("X, mm");
    let bounds = window.state().state().visible_bounds(Role::Crash);
    let below = painted.iter().filter(|text| {
        let is_number = text.text.ends_with(" mm") && text.rect.left() > close.left() - 700.0;
        is_number && text.rect.top() > axis.top() && text.rect.top() < axis.bottom() + 20.0
    });
    let mut numbers: Vec<(f32, f64)> = below
        .filter_map(|text| {
            let number = text.text.trim_end_matches(" mm").replace('−', "-");
            Some((text.rect.left(), number.parse().ok()?))
        })
        .collect();
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(numbers.len() > 1, "{numbers:?}");
    assert!(
        numbers.windows(2).all(|pair| pair[1].1 < pair[0].1),
        "{numbers:?}"
    );
    let size = bounds.diagonal();
    let is_near = |x: f64| (bounds.min.x - size..bounds.max.x + size).contains(&x);
    assert!(numbers.iter().all(|(_, x)| is_near(*x)), "{numbers:?}");
}

/// Each drawing of the section, in its tab and in the free window, has a view of its own, which stays while another
/// tab is shown.
#[test]
fn the_drawing_of_the_section_keeps_its_view() {
    let mut window = matched();
    // The free window is higher than wide, the tab is not.
    window.set_size(vec2(1300.0, 1100.0));
    window.run_steps(3);
    click(&mut window, "Move over");
    finish(&mut window);
    let run = |window: &mut Harness<'static, Shell>, command: ViewCommand| {
        let ctx = window.ctx.clone();
        window.state_mut().run_commands(vec![command.into()], &ctx);
        window.run_steps(5);
    };
    window.key_press(egui::Key::S);
    window.run_steps(3);
    run(&mut window, ViewCommand::SetTab(BottomTab::Section));
    let is_drawn = |window: &Harness<'static, Shell>| {
        let texts = texts(window).into_iter();
        texts
            .filter(|text| text.text.starts_with("Widest gap"))
            .count()
            == 2
    };
    let begin = std::time::Instant::now();
    while !is_drawn(&window) {
        assert!(begin.elapsed().as_secs() < 120, "no outlines");
        std::thread::sleep(std::time::Duration::from_millis(10));
        window.run_steps(1);
    }
    window.run_steps(5);
    // Its axes have the letters of the coordinates.
    let is_canvas = |label: Option<String>| {
        let name = "Outlines in the section plane, ";
        label.is_some_and(|label| label.starts_with(name) && label.ends_with(" upwards"))
    };
    let canvases = window.query_all_by(|node| is_canvas(node.label()));
    let mut canvases: Vec<_> = canvases.map(|node| node.rect()).collect();
    canvases.sort_by(|a, b| a.top().total_cmp(&b.top()));
    let [free, tab] = canvases[..] else {
        panic!("{canvases:?}");
    };
    assert!(free.height() > free.width() && tab.width() > tab.height());
    let numbers = |window: &Harness<'static, Shell>, canvas: egui::Rect| -> Vec<String> {
        let around = canvas.expand2(vec2(50.0, 20.0));
        let texts = texts(window).into_iter();
        let numbers = texts.filter(|text| around.contains(text.rect.center()));
        numbers
            .map(|text| format!("{} {:.0}", text.text, text.rect.min))
            .collect()
    };
    let before = [free, tab].map(|canvas| numbers(&window, canvas));
    let at = tab.center() + vec2(0.0, 8.0);
    window.event(egui::Event::PointerMoved(at));
    window.run_steps(1);
    window.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 200.0),
        modifiers: egui::Modifiers::NONE,
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
    });
    window.run_steps(40);
    window.event(egui::Event::PointerGone);
    window.run_steps(5);
    let zoomed = numbers(&window, tab);
    assert_ne!(zoomed, before[1], "the wheel zooms");
    assert_eq!(numbers(&window, free), before[0], "the other drawing stays");
    run(&mut window, ViewCommand::SetTab(BottomTab::Log));
    run(&mut window, ViewCommand::SetTab(BottomTab::Section));
    assert_eq!(numbers(&window, tab), zoomed);
}
