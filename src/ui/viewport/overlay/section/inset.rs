//! The outlines of both parts in the section plane, laid flat: axes of equal scale, distances between
//! clicked points, and the gap between the sheets at the cursor.

use std::sync::Arc;

use egui::{
    Align, Button, Color32, CornerRadius, CursorIcon, Frame, Layout, Margin, Pos2, Rect, RichText,
    Sense, Shape, Stroke, Ui, UiBuilder, Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotUi, Points};

use super::super::{MARGIN, Overlay};
use crate::app::{Action, Command, InspectCommand, SectionView};
use crate::geometry::{Gap, Plane, Point3, gap_at, nearest_on_lines};
use crate::role::{PerRole, Role};
use crate::ui::viewport::sections::Cut;
use crate::ui::widgets::{paint_role_mark, signed};

/// Size before the user drags it, and the smallest.
const SIZE: Vec2 = vec2(320.0, 230.0);
const LEAST: Vec2 = vec2(240.0, 170.0);
/// Room below for the axes and the scale bar.
const BELOW: f32 = 92.0;
/// Clicks this near to an outline take a point of it.
const SNAP: f64 = 12.0;
/// The gap is told this near to the crash outline.
const NEAR: f64 = 60.0;
/// Zoom per point of the wheel.
const ZOOM: f32 = 0.004;

type Cuts = PerRole<Option<Arc<Cut>>>;

/// The inset, in the left window where there is a crash part.
pub(in crate::ui::viewport::overlay) fn show(
    ui: &mut Ui,
    over: &Overlay<'_>,
    cuts: &Cuts,
    commands: &mut Vec<Command>,
) {
    let Some(plane) = over.frame.state.inspect.section.shown() else {
        return;
    };
    let home = if over.frame.state.document.part(Role::Crash).is_some() {
        Role::Crash
    } else {
        Role::Stamped
    };
    let room = over.frame.rect().shrink(MARGIN);
    if over.role() != home || room.width() < LEAST.x || room.height() < LEAST.y + 2.0 * BELOW {
        return;
    }
    let id = ui.make_persistent_id(("section inset", over.role().word()));
    let most = vec2(room.width(), room.height() - BELOW - 60.0).max(LEAST);
    let size: Vec2 = ui.data(|data| data.get_temp(id)).unwrap_or(SIZE);
    let size = size.clamp(LEAST, most);
    let corner = pos2(room.left(), room.bottom() - BELOW - size.y);
    let area = Rect::from_min_size(corner, size);
    ui.interact(area, id.with("ground"), Sense::click_and_drag());
    let ground = over.frame.look.plate.to_opaque().gamma_multiply(0.98);
    ui.painter().rect(
        area,
        CornerRadius::same(6),
        ground,
        Stroke::new(1.0, over.frame.look.plate_line),
        egui::StrokeKind::Inside,
    );
    let builder = UiBuilder::new()
        .max_rect(area)
        .layout(Layout::top_down(Align::Min));
    ui.scope_builder(builder, |ui| {
        ui.set_clip_rect(over.frame.rect().intersect(area));
        ui.visuals_mut().override_text_color = Some(over.frame.look.text);
        ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
        Frame::new()
            .inner_margin(Margin::symmetric(8, 6))
            .show(ui, |ui| content(ui, over, &plane, cuts, commands));
    });
    resize(ui, over, area, id);
}

/// The corner that makes it larger.
fn resize(ui: &Ui, over: &Overlay<'_>, area: Rect, id: egui::Id) {
    let grip = Rect::from_center_size(area.right_top(), Vec2::splat(18.0));
    let response = ui.interact(grip, id.with("size"), Sense::drag());
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeNeSw);
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Splitter, true, "Size of the section view")
    });
    if response.dragged() {
        let delta = response.drag_delta();
        let size = area.size() + vec2(delta.x, -delta.y);
        ui.data_mut(|data| data.insert_temp(id, size));
    }
    if response.hovered() || response.dragged() {
        let corner = area.right_top();
        let line = Stroke::new(2.0, over.frame.look.tool);
        let ends = [
            [corner - vec2(14.0, 0.0), corner],
            [corner, corner + vec2(0.0, 14.0)],
        ];
        ui.painter()
            .extend(ends.map(|ends| Shape::line_segment(ends, line)));
    }
}

fn content(
    ui: &mut Ui,
    over: &Overlay<'_>,
    plane: &Plane,
    cuts: &Cuts,
    commands: &mut Vec<Command>,
) {
    head(ui, over, commands);
    let foot_height = 18.0;
    let size = vec2(
        ui.available_width(),
        ui.available_height() - foot_height - 2.0,
    );
    let id = ui.make_persistent_id(("section measure", over.role().word()));
    let mut picked: Vec<[f64; 2]> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let seen = plot(ui, over, (plane, cuts), size, &mut picked);
    ui.data_mut(|data| data.insert_temp(id, picked.clone()));
    foot(ui, over, &seen, &picked);
}

/// Title, role marks, and the buttons of the plane.
fn head(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let state = over.frame.state;
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("Section")
                .size(12.5)
                .color(over.frame.look.text),
        );
        for role in Role::ALL {
            let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            let mark = Rect::from_center_size(rect.center(), Vec2::splat(9.0));
            paint_role_mark(ui.painter(), mark, role, over.frame.look.role(role));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let is_clipped = state.inspect.section.is_clipped;
            let buttons = [
                ("×", Action::ToggleSection, false),
                ("Cut", Action::ToggleSectionClip, is_clipped),
                ("View", Action::SectionView, false),
                ("Z", Action::SectionZ, false),
                ("Y", Action::SectionY, false),
                ("X", Action::SectionX, false),
            ];
            for (sign, action, is_on) in buttons {
                let info = action.row();
                let button = Button::new(RichText::new(sign).size(11.5))
                    .small()
                    .selected(is_on)
                    .frame_when_inactive(is_on);
                let response = ui.add(button).on_hover_text(info.tooltip);
                let name = format!("{} (section)", info.label);
                if response.accessible_name(name).clicked() {
                    commands.extend(action.command(state));
                }
            }
            flip(ui, over, commands);
        });
    });
}

/// Turns the plane's front round.
fn flip(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let button = Button::new(RichText::new("Flip").size(11.5))
        .small()
        .frame_when_inactive(false);
    let response = ui
        .add(button)
        .on_hover_text("Look at the plane from behind");
    if response.accessible_name("Flip the section plane").clicked()
        && let Some(plane) = over.frame.state.inspect.section.plane
    {
        let section = SectionView {
            plane: Some(Plane::new(plane.point, &-plane.normal)),
            ..over.frame.state.inspect.section
        };
        commands.push(InspectCommand::SetSection(section).into());
    }
}

/// What the pointer is at.
#[derive(Default)]
struct Seen {
    at: Option<[f64; 2]>,
    gap: Option<Gap>,
    is_empty: bool,
}

/// The outlines with what is measured between them.
fn plot(
    ui: &mut Ui,
    over: &Overlay<'_>,
    (plane, cuts): (&Plane, &Cuts),
    size: Vec2,
    picked: &mut Vec<[f64; 2]>,
) -> Seen {
    let outlines = cuts.iter().flat_map(|(role, cut)| {
        let lines = cut.iter().flat_map(|cut| &cut.lines);
        lines.map(move |line| (role, flat(plane, line)))
    });
    let outlines: Vec<(Role, Vec<[f64; 2]>)> = outlines.collect();
    // Another direction of the plane is another picture.
    let n = plane.normal;
    let view = format!("{:.2} {:.2} {:.2}", n.x, n.y, n.z);
    let mut seen = Seen {
        is_empty: outlines.is_empty(),
        ..Seen::default()
    };
    let grid = over.frame.look.weak.gamma_multiply(0.35);
    ui.visuals_mut().extreme_bg_color = Color32::TRANSPARENT;
    let shown = Plot::new(("section", over.role().word(), view))
        .width(size.x)
        .height(size.y)
        .data_aspect(1.0)
        .show_background(false)
        .grid_color(grid)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .y_axis_min_width(30.0)
        .set_margin_fraction(vec2(0.06, 0.06))
        .show_crosshair(false)
        .label_formatter(|_| None)
        .show(ui, |plot| {
            for (role, points) in outlines {
                let line = Line::new(role.word(), PlotPoints::from(points))
                    .color(over.frame.look.role(role))
                    .width(2.0)
                    .allow_hover(false);
                plot.line(line);
            }
            if plot.response().hovered() {
                let scroll = plot.ctx().input(|i| i.smooth_scroll_delta().y);
                if scroll != 0.0 {
                    plot.zoom_bounds_around_hovered(Vec2::splat((scroll * ZOOM).exp()));
                }
            }
            measured(plot, over, picked);
            look(plot, over, (plane, cuts), &mut seen);
        });
    let response = shown.response;
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Canvas, true, "Outlines in the section plane")
    });
    if response.clicked()
        && let Some(at) = seen.at
    {
        if picked.len() > 1 {
            picked.clear();
        }
        picked.push(at);
    } else if response.secondary_clicked() {
        picked.clear();
    }
    seen
}

/// A line in the axes of the plane.
fn flat(plane: &Plane, line: &crate::geometry::SectionLine) -> Vec<[f64; 2]> {
    let [right, up] = plane.axes();
    let first = line.points.first().filter(|_| line.is_closed);
    let points = line.points.iter().chain(first);
    let flat = points.map(|p| [right.dot(&p.coords), up.dot(&p.coords)]);
    flat.collect()
}

/// The picked points and the line between them.
fn measured(plot: &mut PlotUi<'_>, over: &Overlay<'_>, picked: &[[f64; 2]]) {
    if picked.is_empty() {
        return;
    }
    let points = || PlotPoints::from(picked.to_vec());
    let line = Line::new("measured", points())
        .color(over.frame.look.tool)
        .width(1.2)
        .style(LineStyle::dashed_dense());
    plot.line(line.allow_hover(false));
    let ends = Points::new("ends", points())
        .color(over.frame.look.tool)
        .radius(3.5)
        .allow_hover(false);
    plot.points(ends);
}

/// The place under the pointer, on an outline if one is near, and the gap there.
fn look(
    plot: &mut PlotUi<'_>,
    over: &Overlay<'_>,
    (plane, cuts): (&Plane, &Cuts),
    seen: &mut Seen,
) {
    let Some(pointer) = plot
        .pointer_coordinate()
        .filter(|_| plot.response().hovered())
    else {
        return;
    };
    let per_point = 1.0 / plot.transform().dpos_dvalue_x().abs().max(1e-12);
    let query = plane.point_at([pointer.x, pointer.y]);
    let nearest = cuts
        .iter()
        .filter_map(|(_, cut)| nearest_on_lines(&cut.as_ref()?.lines, &query))
        .map(|found| found.point)
        .min_by(|a, b| distance(a, &query).total_cmp(&distance(b, &query)));
    let snapped = nearest.filter(|point| distance(point, &query) < SNAP * per_point);
    let at = snapped.map_or([pointer.x, pointer.y], |point| plane.flat(&point));
    seen.at = Some(at);
    if snapped.is_some() {
        dot(plot, over, at);
    }
    let (Some(crash), Some(stamped)) = (&cuts.crash, &cuts.stamped) else {
        return;
    };
    let normal = |triangle| crash.normal(triangle);
    let gap = gap_at(&crash.lines, normal, &stamped.lines, plane, &query);
    seen.gap = gap.filter(|gap| distance(&gap.from, &query) < NEAR * per_point);
    if let Some(gap) = &seen.gap {
        let ends = vec![plane.flat(&gap.from), plane.flat(&gap.to)];
        let line = Line::new("gap", PlotPoints::from(ends))
            .color(over.frame.look.text)
            .width(1.5)
            .allow_hover(false);
        plot.line(line);
    }
}

fn distance(a: &Point3, b: &Point3) -> f64 {
    (a - b).norm()
}

fn dot(plot: &mut PlotUi<'_>, over: &Overlay<'_>, at: [f64; 2]) {
    let center: Pos2 = plot.screen_from_plot(PlotPoint::new(at[0], at[1]));
    if over.frame.rect().contains(center) {
        let point = Points::new("snap", PlotPoints::from(vec![at]))
            .color(over.frame.look.tool)
            .radius(3.0)
            .filled(false)
            .allow_hover(false);
        plot.points(point);
    }
}

/// What was measured, the gap at the pointer, or what one can do.
fn foot(ui: &mut Ui, over: &Overlay<'_>, seen: &Seen, picked: &[[f64; 2]]) {
    let state = over.frame.state;
    let (text, is_fact) = if let [a, b] = picked {
        let [du, dv] = [b[0] - a[0], b[1] - a[1]];
        let whole = state.document.length_text(du.hypot(dv));
        let parts = format!("{} across, {} up", signed(du), signed(dv));
        (format!("distance {whole}   ({parts})"), true)
    } else if let Some(gap) = &seen.gap {
        let flush = state.document.length_text(gap.flush);
        let across = format!("{}{}", signed(gap.gap), state.document.unit_suffix());
        (format!("gap {across} · flush {flush}"), true)
    } else if seen.is_empty {
        ("the plane meets neither part".to_owned(), false)
    } else if picked.len() == 1 {
        ("click the second point".to_owned(), false)
    } else {
        ("click two points to measure".to_owned(), false)
    };
    let color = if is_fact {
        over.frame.look.text
    } else {
        over.frame.look.weak
    };
    ui.add(egui::Label::new(RichText::new(text).size(11.5).color(color)).truncate());
}
