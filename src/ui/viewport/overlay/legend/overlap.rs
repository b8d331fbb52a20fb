//! What the classes of the overlap picture are called and how much area each has.

use egui::{Rect, RichText, Sense, Stroke, Ui, pos2, vec2};

use super::{bar, deviation};
use crate::app::{Command, Freshness};
use crate::assess::deviation::OverlapClass;
use crate::colormap::{ColorMap, Pattern, UNMATCHED};
use crate::role::Role;
use crate::ui::theme::{color, ink};
use crate::ui::viewport::overlay::Overlay;
use crate::ui::widgets::percent;

/// Swatch, words and shares of each class.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let Some(comparison) = over.frame.state.comparison() else {
        return;
    };
    let roles = over.frame.picture.roles();
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("Overlap")
                .size(12.5)
                .color(over.frame.look.text),
        );
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for role in roles.iter().rev() {
                let (rect, _) = ui.allocate_exact_size(vec2(46.0, 12.0), Sense::hover());
                let mark = Rect::from_center_size(
                    pos2(rect.right() - 5.0, rect.center().y),
                    vec2(9.0, 9.0),
                );
                let color = over.frame.look.role(*role);
                crate::ui::widgets::paint_role_mark(ui.painter(), mark, *role, color);
            }
        });
    });
    ui.add_space(3.0);
    let limit = over.frame.state.lengths().of(comparison.deviation.limit);
    for (index, class) in OverlapClass::ALL.into_iter().enumerate() {
        row(ui, over, class, class.label(), index, &roles);
    }
    ui.label(
        RichText::new(format!(
            "shares of each part's area\nmatched within {limit}"
        ))
        .size(11.0)
        .color(over.frame.look.weak),
    );
    // At the foot, so that the rows stay where they are.
    if over.frame.state.freshness() != Freshness::Current {
        deviation::freshness(ui, over, commands);
    }
}

fn row(
    ui: &mut Ui,
    over: &Overlay<'_>,
    class: OverlapClass,
    words: &str,
    index: usize,
    roles: &[Role],
) {
    let response = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::hover());
        swatch(ui, rect, class, over);
        ui.label(RichText::new(words).size(12.0));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for role in roles.iter().rev() {
                let way = over.frame.state.deviation_of(*role);
                let share = way.map_or(0.0, |way| way.stats.class_shares[index]);
                let (rect, _) = ui.allocate_exact_size(vec2(46.0, 14.0), Sense::hover());
                ui.painter().text(
                    rect.right_center(),
                    egui::Align2::RIGHT_CENTER,
                    percent(share),
                    egui::FontId::proportional(11.5),
                    over.frame.look.text,
                );
            }
        });
    });
    let shares = roles.iter().filter_map(|role| {
        let way = over.frame.state.deviation_of(*role)?;
        let share = percent(way.stats.class_shares[index]);
        Some(format!("{share} of the {} part", role.word()))
    });
    let name = format!("{words}: {}", shares.collect::<Vec<_>>().join(", "));
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
}

/// Colour and pattern as on the parts.
fn swatch(ui: &Ui, rect: Rect, class: OverlapClass, over: &Overlay<'_>) {
    let painter = ui.painter().with_clip_rect(rect);
    match class {
        OverlapClass::Matched => {
            painter.rect_filled(rect, 2.0, color(ColorMap::Classes.sample(0.0)));
        }
        OverlapClass::OffByMore => {
            painter.rect_filled(rect, 2.0, color(ColorMap::Classes.sample(1.0)));
            bar::patterns(&painter, rect, |_| Pattern::Dots);
        }
        OverlapClass::OnlyHere => hatched(ui, rect),
    }
    let stroke = Stroke::new(1.0, over.frame.look.plate_line);
    ui.painter()
        .rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Outside);
}

/// The grey hatch of places without a value.
pub(super) fn hatched(ui: &Ui, rect: Rect) {
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, color(UNMATCHED));
    let stroke = Stroke::new(1.5, ink(150));
    let mut x = rect.left() - rect.height();
    while x < rect.right() {
        painter.line_segment(
            [pos2(x, rect.bottom()), pos2(x + rect.height(), rect.top())],
            stroke,
        );
        x += 5.0 * std::f32::consts::SQRT_2;
    }
}
