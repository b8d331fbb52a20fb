//! Nothing is cut and nothing lies on something else: what was painted is looked at, not a picture.

use egui::{Pos2, Rect, Shape, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::NodeT as _;
use shapematch::app::{Command, Theme};
use shapematch::ui::Shell;
use shapematch::ui::panels::graphics;

use super::story::{click, finish, window};

type Window = Harness<'static, Shell>;

/// A text as it was painted.
struct Painted {
    text: String,
    rect: Rect,
    clip: Rect,
}

/// Every text of the last frame that can be seen.
fn texts(window: &Window) -> Vec<Painted> {
    let mut found = Vec::new();
    for clipped in &window.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut found);
    }
    found
}

fn collect(shape: &Shape, clip: Rect, found: &mut Vec<Painted>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, found)),
        Shape::Text(text) => {
            for row in &text.galley.rows {
                let (Some(first), Some(last)) = (row.glyphs.first(), row.glyphs.last()) else {
                    continue;
                };
                let x = first.pos.x..=last.max_x();
                let rect = Rect::from_x_y_ranges(x, 0.0..=row.size.y);
                let rect = rect.translate(row.pos.to_vec2() + text.pos.to_vec2());
                let seen = rect.intersect(clip);
                let text = row.text();
                if seen.width() > 1.0 && seen.height() > 4.0 && !text.trim().is_empty() {
                    found.push(Painted { text, rect, clip });
                }
            }
        }
        _ => {}
    }
}

/// What lies over the 3D windows, among it toasts, which are meant to lie on something.
fn is_in_graphics(painted: &Painted, window: &Window) -> bool {
    let parts = &window.state().state().document.parts;
    let is_empty = parts.crash.is_none() && parts.stamped.is_none();
    !is_empty && graphics::area(&window.ctx).contains(painted.rect.center())
}

/// What is wrong unless every text lies within its clip sideways and on no other text.
fn faults(window: &Window) -> Vec<String> {
    let mut texts = texts(window);
    texts.retain(|text| !is_in_graphics(text, window));
    assert!(texts.len() > 10, "nothing was painted");
    let mut faults = Vec::new();
    for one in &texts {
        let is_cut =
            one.rect.left() < one.clip.left() - 1.0 || one.rect.right() > one.clip.right() + 1.0;
        if is_cut {
            faults.push(format!("cut: {:?} {} of {}", one.text, one.rect, one.clip));
        }
    }
    for (index, one) in texts.iter().enumerate() {
        for other in &texts[index + 1..] {
            let both = one
                .rect
                .intersect(one.clip)
                .intersect(other.rect.intersect(other.clip));
            if both.width() > 1.5 && both.height() > 3.0 {
                faults.push(format!(
                    "on each other: {:?} {} and {:?} {}",
                    one.text, one.rect, other.text, other.rect
                ));
            }
        }
    }
    faults.extend(overlapping_buttons(window));
    faults
}

/// Buttons and fields that lie partly on one another; one within the other is meant.
fn overlapping_buttons(window: &Window) -> Vec<String> {
    use egui::accesskit::Role;
    let screen = Rect::from_min_size(Pos2::ZERO, window.ctx.content_rect().size());
    let mut all: Vec<(String, Rect)> = Vec::new();
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        queue.extend(node.children());
        let inner = node.accesskit_node();
        let is_meant = matches!(
            inner.role(),
            Role::Button
                | Role::CheckBox
                | Role::TextInput
                | Role::SpinButton
                | Role::ComboBox
                | Role::Tab
        );
        if is_meant && inner.raw_bounds().is_some() && screen.contains_rect(node.rect()) {
            all.push((inner.label().unwrap_or_default(), node.rect()));
        }
    }
    let mut faults = Vec::new();
    for (index, (name, rect)) in all.iter().enumerate() {
        for (other, at) in &all[index + 1..] {
            let both = rect.intersect(*at);
            let is_within =
                rect.expand(0.5).contains_rect(*at) || at.expand(0.5).contains_rect(*rect);
            if both.width() > 1.0 && both.height() > 1.0 && !is_within {
                faults.push(format!(
                    "buttons on each other: {name:?} {rect} and {other:?} {at}"
                ));
            }
        }
    }
    faults
}

/// Changes theme and scale as the preferences do.
fn set(window: &mut Window, theme: Theme, ui_scale: f32) {
    let ctx = window.ctx.clone();
    let mut settings = window.state().state().settings.clone();
    settings.theme = theme;
    settings.ui_scale = ui_scale;
    window
        .state_mut()
        .run_commands(vec![Command::Settings(Box::new(settings))], &ctx);
    window.run_steps(4);
}

#[test]
fn nothing_is_cut_at_any_scale_in_any_theme() {
    let mut window = window();
    let scales = [
        ("100 %", 1.0, [1280.0, 720.0]),
        ("200 %", 2.0, [1280.0, 720.0]),
        ("75 %", 0.75, [960.0, 600.0]),
    ];
    let mut all = Vec::new();
    let mut look = |window: &mut Window, state: &str| {
        for (name, scale, [width, height]) in scales {
            window.set_size(Vec2::new(width, height) / scale);
            for theme in [Theme::Dark, Theme::Light] {
                set(window, theme, 1.0);
                let found = faults(window).into_iter();
                all.extend(found.map(|fault| format!("{state}, {name}, {theme:?}: {fault}")));
            }
        }
        window.set_size(Vec2::new(1400.0, 900.0));
        window.run_steps(3);
    };
    look(&mut window, "empty");
    click(&mut window, "Open the example pair");
    finish(&mut window);
    look(&mut window, "loaded");
    click(&mut window, "Reduce");
    finish(&mut window);
    look(&mut window, "reduced");
    click(&mut window, "Match the parts");
    finish(&mut window);
    look(&mut window, "matched");
    assert!(all.is_empty(), "{}", all.join("\n"));
}
