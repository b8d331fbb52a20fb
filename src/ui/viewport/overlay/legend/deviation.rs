//! The legend of the deviation: colours with a histogram, limits and tolerance to drag, and what the
//! numbers say.

use egui::{Align, Button, Layout, Rect, RichText, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::bar::Grip;
use super::limits::{self, Limit};
use super::{OLD, OUT_OF_DATE, Room, WIDTH, bar, menu, overlap};
use crate::app::{Coloring, Command, Freshness, InspectCommand};
use crate::assess::deviation::DeviationStats;
use crate::colormap::ColorScale;
use crate::report::distances::{COMPARED_P95, COMPARED_RMS};
use crate::role::Role;
use crate::text::capital;
use crate::ui::pictures::clickable;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, color};
use crate::ui::typed::{Takes, told_field};
use crate::ui::viewport::fields::FieldKind;
use crate::ui::viewport::overlay::Overlay;
use crate::ui::widgets::{length, paint_role_mark, percent};

/// Width of the histogram beside the bar.
const HISTOGRAM: f32 = 64.0;
/// From an end of the bar to the middle of the field of its limit.
const BESIDE_LIMIT: f32 = 16.0;

/// Everything about the deviation.
pub(super) fn show(
    ui: &mut Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    room: Room,
    commands: &mut Vec<Command>,
) {
    let Some((role, stats)) = over.frame.state.deviation_stats() else {
        return;
    };
    title(ui, over, role, commands);
    drawn_on(
        ui,
        over,
        "colours of the reduced part,\nnumbers of the full one",
    );
    freshness(ui, over, commands);
    if over.frame.state.freshness() != Freshness::Current {
        ui.set_opacity(OLD);
    }
    let mut display = over.frame.state.view.display.clone();
    let coloring = &mut display.coloring;
    if room.is_full {
        side_words(ui, over, "in front of crash", true);
    }
    let beside = HISTOGRAM - 2.0;
    limits::field(
        ui,
        over,
        scale,
        (Limit::Upper, beside),
        &mut coloring.limits,
    );
    let is_automatic = bars(ui, over, (scale, stats), room.bar, coloring);
    if is_automatic {
        commands.push(InspectCommand::FitRange.into());
    } else if over.frame.state.is_range_held() && coloring.limits.is_none() {
        let fit = egui::Button::new(RichText::new("Fit the range").size(11.5)).small();
        if clickable(ui, |ui| ui.add(fit))
            .on_hover_text("The range is that of the pose before the move")
            .clicked()
        {
            commands.push(InspectCommand::FitRange.into());
        }
    }
    limits::field(
        ui,
        over,
        scale,
        (Limit::Lower, beside),
        &mut coloring.limits,
    );
    if room.is_full {
        side_words(ui, over, "behind crash", false);
    }
    limits::hide_box(ui, over, &mut coloring.hides_beyond);
    ui.add_space(2.0);
    tolerance(ui, over, scale, stats, coloring);
    if room.is_full {
        numbers(ui, over, stats);
    }
    menu::set(over, display, commands);
}

/// Above the bar of the folded legend: whose colours they are, and faint if they are old.
pub(super) fn slim_head(ui: &mut Ui, over: &Overlay<'_>) {
    drawn_on(ui, over, "reduced part");
    if over.frame.state.freshness() != Freshness::Current {
        ui.set_opacity(0.45);
    }
}

/// Says at the foot of the folded legend that its colours are old, with the way to new ones: the bar stays where
/// it is.
pub(super) fn slim_freshness(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let state = over.frame.state;
    let freshness = state.freshness();
    if freshness == Freshness::Current {
        return;
    }
    let old = RichText::new("out of\ndate").size(11.0);
    ui.label(old.color(Palette::of(ui).check));
    if freshness == Freshness::OutOfDate && state.jobs.locking_job().is_none() {
        let button = Button::new(RichText::new("Update").size(11.0)).small();
        let can = state.can_match().is_ok();
        if clickable(ui, |ui| ui.add_enabled(can, button)).clicked() {
            commands.push(InspectCommand::Update.into());
        }
    }
}

/// Before the first measurement has ended.
pub(super) fn waiting(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let name = over.kind.unwrap_or(FieldKind::Deviation).label();
    let name = RichText::new(name).size(12.5);
    ui.label(name.color(over.frame.look.text));
    freshness(ui, over, commands);
}

/// From which part to which, and the menu.
fn title(ui: &mut Ui, over: &Overlay<'_>, role: Role, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("Deviation")
                .size(12.5)
                .color(over.frame.look.text),
        );
        let (rect, response) = ui.allocate_exact_size(vec2(40.0, 14.0), Sense::click());
        let at =
            |x: f32| Rect::from_center_size(pos2(rect.left() + x, rect.center().y), vec2(9.0, 9.0));
        let other = role.other();
        paint_role_mark(ui.painter(), at(6.0), role, over.frame.look.role(role));
        paint_role_mark(ui.painter(), at(34.0), other, over.frame.look.role(other));
        let tip = pos2(rect.left() + 25.0, rect.center().y);
        let stroke = Stroke::new(1.2, over.frame.look.weak);
        ui.painter()
            .line_segment([tip - vec2(10.0, 0.0), tip], stroke);
        for leg in [vec2(-3.5, 3.0), vec2(-3.5, -3.0)] {
            ui.painter().line_segment([tip + leg, tip], stroke);
        }
        let words = format!(
            "{} to {}, show it on the {} part",
            capital(role.word()),
            other.word(),
            other.word()
        );
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &words));
        if response.hovered() {
            let line = Stroke::new(1.0, over.frame.look.weak);
            ui.painter()
                .hline(rect.x_range(), rect.bottom() + 1.0, line);
        }
        if response.clicked() {
            let mut display = over.frame.state.view.display.clone();
            *display.coloring.on.get_mut(role) = false;
            *display.coloring.on.get_mut(other) = true;
            menu::set(over, display, commands);
        }
        let hint = format!(
            "Measured from the nodes of the {} part; click: on the {} part",
            role.word(),
            other.word()
        );
        response.on_hover_text(hint);
        RowEnd::new(ui, "legend").show(ui, |ui| {
            menu::maps(ui, over, menu::Values::Deviation, commands);
            super::fold(ui, over);
        });
    });
}

/// Whether the numbers are those of what is shown: always a row, so that what is below stays where it is.
pub(super) fn freshness(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let text = match over.frame.state.freshness() {
        Freshness::Current => "up to date",
        Freshness::Missing if over.frame.state.jobs.locking_job().is_some() => {
            "measured after the run"
        }
        Freshness::Missing => "not measured yet",
        Freshness::Updating => "out of date · measuring",
        Freshness::OutOfDate => OUT_OF_DATE,
    };
    let color = match over.frame.state.freshness() {
        Freshness::Current => over.frame.look.weak,
        _ => Palette::of(ui).check,
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(text).size(11.5).color(color));
        let is_open = matches!(
            over.frame.state.freshness(),
            Freshness::Missing | Freshness::OutOfDate
        );
        let is_asked = is_open && over.frame.state.jobs.locking_job().is_none();
        if is_asked {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let button = Button::new(RichText::new("Update").size(11.5)).small();
                let can = over.frame.state.can_match().is_ok();
                if clickable(ui, |ui| ui.add_enabled(can, button)).clicked() {
                    commands.push(InspectCommand::Update.into());
                }
            });
        }
    });
}

/// Which side the sign means.
fn side_words(ui: &mut Ui, over: &Overlay<'_>, words: &str, is_front: bool) {
    let is_signed = over
        .frame
        .state
        .comparison()
        .is_some_and(|comparison| comparison.deviation.is_signed);
    let text = match (is_signed, is_front) {
        (true, true) => format!("+  {words}"),
        (true, false) => format!("−  {words}"),
        (false, true) => "without sign: the crash part\nhas no clear sides".to_owned(),
        (false, false) => return,
    };
    ui.label(RichText::new(text).size(11.0).color(over.frame.look.weak));
}

/// Histogram, bar, ticks, and the handles on them; true if the limits are to follow the values again.
fn bars(
    ui: &mut Ui,
    over: &Overlay<'_>,
    (scale, stats): (&ColorScale, &DeviationStats),
    height: f32,
    coloring: &mut Coloring,
) -> bool {
    let (room, _) = ui.allocate_exact_size(vec2(WIDTH, height + 8.0), Sense::hover());
    let top = room.top() + 4.0;
    let bar_rect = Rect::from_min_size(
        pos2(room.left() + HISTOGRAM + 4.0, top),
        vec2(bar::BAR, height),
    );
    let beside = Rect::from_min_size(pos2(room.left(), top), vec2(HISTOGRAM, height));
    histogram(ui, over, scale, stats, beside);
    bar::paint(ui.painter(), scale, bar_rect, over);
    bar::ticks(ui.painter(), scale, bar_rect, over, true);
    limits::drag_ends(ui, over, scale, bar_rect, &mut coloring.limits);
    for side in [1.0, -1.0] {
        drag_tolerance(ui, over, scale, (side, beside, bar_rect), coloring);
    }
    let is_asked = limits::is_automatic_asked(ui, over, bar_rect);
    if is_asked {
        coloring.limits = None;
        coloring.tolerance = None;
    }
    is_asked
}

/// How much area has which value: bars in the colours of the values, growing to the left.
fn histogram(ui: &Ui, over: &Overlay<'_>, scale: &ColorScale, stats: &DeviationStats, room: Rect) {
    let n_bins = (room.height() / 3.0) as usize;
    let counted = stats.histogram(n_bins, [scale.min, scale.max]);
    let most = counted.shares.iter().copied().fold(0.0, f64::max);
    let step = room.height() / n_bins.max(1) as f32;
    for (i, share) in counted.shares.iter().enumerate() {
        // Rare values are what one looks for: the root keeps them visible.
        let width = if most > 0.0 {
            (share / most).sqrt() as f32 * (room.width() - 2.0)
        } else {
            0.0
        };
        if width < 0.5 {
            continue;
        }
        let bottom = room.bottom() - step * i as f32;
        let row = Rect::from_min_max(
            pos2(room.right() - width, bottom - step + 0.5),
            pos2(room.right(), bottom),
        );
        let middle = scale.value_at((i as f64 + 0.5) / n_bins as f64);
        ui.painter()
            .rect_filled(row, 0.0, color(scale.color(middle)));
    }
    let foot = Stroke::new(1.0, over.frame.look.plate_line);
    ui.painter().vline(room.right() + 1.0, room.y_range(), foot);
    // Beside the fields of the limits, where no bar reaches.
    let beyond = [
        (counted.above, room.top() - BESIDE_LIMIT, "above"),
        (counted.below, room.bottom() + BESIDE_LIMIT, "below"),
    ];
    for (share, y, word) in beyond {
        if share > 5e-4 {
            ui.painter().text(
                pos2(room.left(), y),
                egui::Align2::LEFT_CENTER,
                format!("{} {word}", percent(share)),
                egui::FontId::proportional(9.5),
                over.frame.look.weak,
            );
        }
    }
}

/// An end of the neutral band.
fn drag_tolerance(
    ui: &Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    (side, beside, bar): (f64, Rect, Rect),
    coloring: &mut Coloring,
) {
    let value = side * scale.tolerance;
    if scale.tolerance <= 0.0 || value < scale.min || value > scale.max {
        return;
    }
    let y = bar::y_of(scale, bar, value);
    let from = beside.left();
    let at = Rect::from_min_max(pos2(from, y - 5.0), pos2(bar.left() - 1.0, y + 5.0));
    let name = if side > 0.0 {
        "Upper tolerance"
    } else {
        "Lower tolerance"
    };
    let Grip {
        response,
        is_held,
        color,
    } = Grip::new(ui, over, at, name);
    let stroke = Stroke::new(if is_held { 1.5 } else { 1.0 }, color);
    let dashes = [pos2(from, y), pos2(bar.left(), y)];
    ui.painter()
        .extend(egui::Shape::dashed_line(&dashes, stroke, 3.0, 2.0));
    let tip = pos2(bar.left() - 1.0, y);
    let corners = vec![tip, tip + vec2(-6.0, -4.0), tip + vec2(-6.0, 4.0)];
    ui.painter().add(egui::Shape::convex_polygon(
        corners,
        over.frame.look.text,
        Stroke::NONE,
    ));
    if let Some(pos) = response
        .interact_pointer_pos()
        .filter(|_| response.dragged())
    {
        let share = f64::from((bar.bottom() - pos.y) / bar.height()).clamp(0.0, 1.0);
        let found = side * scale.value_at(share);
        let least = 1e-3 * (scale.max - scale.min);
        coloring.tolerance = Some(found.max(least));
    }
}

/// How much area lies within the neutral band, whose width can be typed.
fn tolerance(
    ui: &mut Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    stats: &DeviationStats,
    coloring: &mut Coloring,
) {
    ui.horizontal_wrapped(|ui| {
        let inside = percent(stats.share_inside(scale.tolerance));
        ui.label(RichText::new(inside).size(15.0).color(over.frame.look.text));
        ui.label(RichText::new("within ±").size(12.0));
        ui.spacing_mut().item_spacing.x = 2.0;
        let mut value = scale.tolerance;
        let takes = Takes::number("Tolerance", "", 0.0..=1e9);
        let field = takes
            .field(&mut value)
            .speed(0.01 * scale.max.abs())
            .custom_formatter(|value, _| length(value));
        let response = told_field(ui, "Tolerance", scale.tolerance, field, |text| {
            takes.read(text)
        });
        response.widget_info(|| {
            let name = format!("Tolerance ({})", over.role().word());
            WidgetInfo::labeled(egui::Role::SpinButton, true, name)
        });
        if response.changed() {
            coloring.tolerance = Some(value);
        }
        ui.label(RichText::new(over.frame.state.document.unit_suffix()).size(12.0));
    });
}

/// Says that the colours are those of the reduced part, where the numbers are those of the full one.
fn drawn_on(ui: &mut Ui, over: &Overlay<'_>, words: &str) {
    let state = over.frame.state;
    let role = state.deviation_stats().map(|(role, _)| role);
    if role.is_some_and(|role| state.shows_reduced(role)) {
        let words = RichText::new(words).size(11.0);
        let words = egui::Label::new(words.color(over.frame.look.weak));
        ui.add(words.wrap());
    }
}

/// Mean and spread, what is alone, and a constant offset in words.
fn numbers(ui: &mut Ui, over: &Overlay<'_>, stats: &DeviationStats) {
    let small = |text: String| RichText::new(text).size(11.0).color(over.frame.look.weak);
    let lengths = over.frame.state.lengths();
    let (least, most) = (lengths.signed(stats.min), lengths.signed_of(stats.max));
    let mean = lengths.signed(stats.mean);
    // In metres they are longer than the legend is wide.
    let wrapped = |text: String| egui::Label::new(small(text)).wrap();
    // Without a counterpart there is no distance, and 0 would be one.
    if !stats.is_empty() {
        ui.add(wrapped(format!("mean {mean}, {least} to {most}")));
        for (measure, value) in [(COMPARED_RMS, stats.rms), (COMPARED_P95, stats.p95)] {
            let text = format!("{} {}", measure.name, lengths.of(value));
            ui.add(wrapped(text)).on_hover_text(measure.help);
        }
    }
    let alone = stats.class_shares[2];
    if alone > 5e-4 {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(14.0, 10.0), Sense::hover());
            overlap::hatched(ui, rect);
            let text = format!("{} without counterpart", percent(alone));
            ui.label(small(text));
        });
    }
    if let Some(offset) = &stats.offset {
        let words = offset.words(|value| lengths.of(value));
        let text = RichText::new(format!("constant offset: {words}")).size(11.5);
        ui.add(egui::Label::new(text).wrap());
    }
}
