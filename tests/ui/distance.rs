//! Distances clicked with the mouse in a 3D window.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::geometry::camera::ScreenSize;
use shapematch::role::Role;
use shapematch::search::ClosestPoint as _;
use shapematch::ui::Shell;

use super::layout::texts;
use super::pairs::click_in;
use super::story::{click, finish, matched, window};

/// What a screen reader is told of the distance in the picture.
fn told(window: &Harness<'static, Shell>) -> Vec<String> {
    let all = window.query_all_by(|node| {
        let text = node.value().or_else(|| node.label());
        text.is_some_and(|text| text.starts_with("Distance "))
    });
    let text = |node: egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        node.value().or_else(|| node.label())
    };
    all.filter_map(text).collect()
}

/// The example pair, while points of a distance are clicked.
fn measuring() -> Harness<'static, Shell> {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.key_press(egui::Key::I);
    window
}

fn is_painted(window: &Harness<'static, Shell>, text: &str) -> bool {
    texts(window).iter().any(|painted| painted.text == text)
}

#[test]
fn a_double_click_is_one_point() {
    let mut window = measuring();
    let off = [-60.0, -50.0].into();
    click_in(&mut window, Role::Crash, off);
    let pos = window.ctx.input(|i| i.pointer.latest_pos());
    let pos = pos.expect("the pointer");
    let button = |pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    // The first of two quick clicks comes long after the click before it.
    for n_points in [2, 1] {
        window.run_steps(4);
        for _ in 0..2 {
            let events = [true, false].map(button);
            window.input_mut().events.extend(events);
            window.step();
        }
        window.run_steps(2);
        assert_eq!(window.state().state().distance_ends().len(), n_points);
    }
}

#[test]
fn two_clicks_draw_a_distance_and_escape_takes_it_away() {
    let mut window = measuring();
    window.run_steps(2);
    assert!(is_painted(&window, "Click the first point"));
    click_in(&mut window, Role::Crash, [-60.0, -50.0].into());
    assert_eq!(window.state().state().distance_ends().len(), 1);
    assert!(is_painted(&window, "Click the second point"));
    // The line follows the pointer before the second click.
    let first = window.get_by(|node| {
        let label = node.label();
        label.is_some_and(|label| label.starts_with("Crash part"))
    });
    let pos = first.rect().center() + egui::vec2(20.0, 10.0);
    window.event(egui::Event::PointerMoved(pos));
    window.run_steps(2);
    assert_eq!(told(&window).len(), 1);
    assert_eq!(window.state().state().measured_distance(), None);
    // Only a point of the same window belongs to it.
    click_in(&mut window, Role::Stamped, [0.0, 0.0].into());
    assert_eq!(window.state().state().distance_ends().len(), 1);
    click_in(&mut window, Role::Crash, [70.0, 40.0].into());
    let state = window.state().state();
    let [length, axes] = state.measured_distance().expect("a distance");
    assert_eq!(told(&window), [format!("Distance {length}, {axes}")]);
    assert!(is_painted(&window, &length), "{length}");
    assert!(is_painted(&window, &axes), "{axes}");
    let [from, to] = [0, 1].map(|n| state.distance_ends()[n].1);
    assert_eq!(length, state.lengths().of((to - from).norm()));
    assert!(state.parts.selected.is_empty(), "a point is no selection");
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().inspect.distance, None);
    assert_eq!(told(&window), [] as [String; 0]);
}

/// The pointer in a round hole takes its centre, and the plate says so.
#[test]
fn a_distance_from_a_hole_begins_at_its_centre() {
    let mut window = measuring();
    window.run_steps(30);
    let state = window.state().state();
    let part = state.document.part(Role::Crash).expect("loaded");
    let hole = part
        .facts
        .landmarks
        .values()
        .next()
        .expect("one part")
        .holes[0];
    let canvas = window.get_by(|node| {
        let label = node.label();
        node.role() == egui::accesskit::Role::Canvas
            && label.is_some_and(|label| label.starts_with("Crash part"))
    });
    let size = canvas.rect().size();
    let screen = ScreenSize::new(size.x.round() as u32, size.y.round() as u32);
    let camera = state.view.cameras.crash;
    let seen = camera.project(&hole.center, screen).expect("in front");
    let middle = egui::vec2(seen.x as f32, seen.y as f32) - 0.5 * size;
    // A little beside it.
    click_in(&mut window, Role::Crash, middle + egui::vec2(3.0, 2.0));
    let ends = window.state().state().distance_ends();
    let [(role, point)] = ends[..] else {
        panic!("{ends:?}");
    };
    assert_eq!(role, Role::Crash);
    assert!((point - hole.center).norm() < 1e-9 * hole.center.coords.norm().max(1.0));
    click_in(&mut window, Role::Crash, [-60.0, -50.0].into());
    assert!(is_painted(&window, "from centre of hole"));
    let told = told(&window);
    assert!(
        told.iter()
            .all(|text| text.ends_with(", from centre of hole"))
            && told.len() == 1
    );
}

/// What is drawn apart for the eye is measured where it is.
#[test]
fn a_separation_does_not_move_the_nodes_that_are_measured() {
    let mut window = matched();
    click(&mut window, "Move over");
    let slider = window.get_by(|node| {
        let label = node.label().unwrap_or_default();
        node.role() == egui::accesskit::Role::Slider && label.contains("apart from where it is")
    });
    slider.focus();
    for _ in 0..40 {
        window.key_press(egui::Key::ArrowRight);
        window.run_steps(1);
    }
    let separation = window.state().state().view.display.separation;
    assert!(separation > 1.0, "{separation}");
    let mut n_stamped = 0;
    // From either side, so that each part is once in front.
    let sides = [egui::Modifiers::NONE, egui::Modifiers::COMMAND];
    let views = [egui::Key::Num1, egui::Key::Num3, egui::Key::Num7];
    for (side, view) in sides.iter().flat_map(|side| views.map(|view| (side, view))) {
        window.key_press_modifiers(*side, view);
        window.run_steps(30);
        for off in [[-60.0, -20.0], [-20.0, 15.0], [25.0, -15.0], [70.0, 20.0]] {
            window.key_press(egui::Key::I);
            window.run_steps(2);
            click_in(&mut window, Role::Crash, off.into());
            n_stamped += usize::from(is_on_stamped(&window));
            window.key_press(egui::Key::Escape);
            window.run_steps(2);
        }
    }
    assert!(n_stamped > 2, "{n_stamped}");
}

/// Whether a node or a place of the stamped part was clicked, which has to lie on it.
fn is_on_stamped(window: &Harness<'static, Shell>) -> bool {
    let state = window.state().state();
    let Some(&(Role::Stamped, point)) = state.distance_ends().first() else {
        return false;
    };
    let part = state.document.part(Role::Stamped).expect("it was clicked");
    let landmarks = part.facts.landmarks.values();
    let mut holes = landmarks.flat_map(|of_part| &of_part.holes);
    if holes.any(|hole| (hole.center - point).norm() < 1e-6) {
        return false;
    }
    let tree = part.loaded.surface.bvh();
    let hit = tree.closest(&point, f64::INFINITY, None, None);
    let off = hit.expect("a surface").distance_sq.sqrt();
    assert!(off < 1e-3, "{point}: {off}");
    true
}
