//! The section laid flat, in a window or tab of its own: the outlines of all parts, axes of equal
//! scale, distances between clicked points, the gap at the cursor, and gaps drawn ten times as wide.

mod choices;
mod controls;

use std::sync::Arc;

use egui::{
    Align, Align2, Color32, FontId, Id, Layout, Rect, RichText, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use egui_plot::{
    LineStyle, Plot, PlotBounds, PlotPoint, PlotPoints, PlotTransform, PlotUi, Points,
};

use self::choices::{Choices, Zoom, zoom_by_wheel};
use super::coordinates::with_coordinates;
use super::outlines::{Lie, Outline, around, direction_name, told_along};
use super::sections::{self, Cuts, Gaps};
use super::unused::Lines;
use crate::app::{Action, AppState, Command};
use crate::geometry::{Gap, Plane, Point3, SectionLine, Vector3, gap_to_nearest, nearest_on_lines};
use crate::role::Role;
use crate::text::capital;
use crate::ui::panels::bottom::charts::exact_line;
use crate::ui::theme::{Look, UNIT, color};
use crate::ui::widgets::nothing_yet;

/// Clicks this near to an outline take a point of it.
const SNAP: f64 = 12.0;
/// The gap is shown this near to the crash outline.
const NEAR: f64 = 60.0;
/// How many times as wide gaps are drawn on request.
const EXAGGERATED: f64 = 10.0;
/// Width of the crash outline, which lies below, and of the stamped one.
const BELOW: f32 = 5.0;
const ABOVE: f32 = 1.8;
/// A room so many times as wide as it is high has the controls at its side.
const WIDE: f32 = 2.2;
/// Width of the controls at the side, and the air between their groups where they stand in a row.
const SIDE: f32 = 190.0;
const CLOSE_BY: f32 = 4.0;
/// Room for the numbers of the upright axis.
const AXIS: f32 = 46.0;
/// At first so much of the outlines is seen around the worst gap, at most, and so many of its widths,
/// at least.
const CLOSE: f64 = 0.2;
const WIDTHS: f64 = 40.0;
const CLOSING: (&str, Action, bool) = ("×", Action::ToggleSection, false);

/// What is drawn.
pub(super) struct Drawing<'a> {
    pub state: &'a AppState,
    pub look: &'a Look,
    pub plane: Plane,
    pub cuts: &'a Cuts,
    /// Those of unused parts, which are only seen.
    pub unused: &'a [(Role, Arc<Lines>)],
    /// From the crash outline to the stamped one, once they are worked out.
    pub gaps: Option<&'a Gaps>,
    /// Outlines are still to come.
    pub is_cutting: bool,
}

/// Instead of a drawing where there is no plane.
pub(super) fn nothing_ui(ui: &mut Ui) {
    nothing_yet(ui, "No section", "S cuts the parts with a plane");
}

impl Drawing<'_> {
    /// Controls and drawing in the rest of `ui`.
    pub fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let id = ui.make_persistent_id("section drawing");
        let mut choices: Choices = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        ui.visuals_mut().override_text_color = Some(self.look.text);
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        let room = ui.available_size();
        let seen = if room.x > WIDE * room.y && room.x > 2.0 * SIDE {
            self.beside(ui, (id, &mut choices), commands)
        } else {
            self.below(ui, (id, &mut choices), commands)
        };
        if let Some(at) = seen.clicked {
            if choices.picked.len() > 1 {
                choices.picked.clear();
            }
            choices.picked.push(at);
        }
        if seen.is_forgotten {
            choices.picked.clear();
        }
        ui.data_mut(|data| data.insert_temp(id, choices));
    }

    /// A low and wide room: the controls stand left of the drawing.
    fn beside(
        &self,
        ui: &mut Ui,
        (id, choices): (Id, &mut Choices),
        commands: &mut Vec<Command>,
    ) -> Seen {
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            let side = ui.allocate_ui(vec2(SIDE, height), |ui| {
                ui.set_width(SIDE);
                ui.vertical(|ui| {
                    ui.horizontal(|ui| self.names(ui));
                    self.directions(ui, commands);
                    ui.horizontal(|ui| {
                        self.plane_buttons(ui, commands);
                        self.switch(ui, CLOSING, commands);
                    });
                    ui.horizontal(|ui| self.zoom_buttons(ui, choices));
                    ui.scope(|ui| ui.available_rect_before_wrap()).inner
                })
                .inner
            });
            ui.add_space(UNIT);
            let seen = self.plot(ui, ui.available_size(), (id, choices));
            let builder = egui::UiBuilder::new().max_rect(side.inner);
            ui.scope_builder(builder, |ui| {
                ui.set_clip_rect(side.inner.intersect(ui.clip_rect()));
                self.foot(ui, &seen, &choices.picked);
            });
            seen
        })
        .inner
    }

    /// A high room: controls above, measures below.
    fn below(
        &self,
        ui: &mut Ui,
        (id, choices): (Id, &mut Choices),
        commands: &mut Vec<Command>,
    ) -> Seen {
        ui.horizontal_wrapped(|ui| {
            // All in one row of a window that is half of a usual screen.
            ui.spacing_mut().button_padding.x = 5.0;
            self.names(ui);
            ui.add_space(CLOSE_BY);
            self.directions(ui, commands);
            ui.add_space(CLOSE_BY);
            self.plane_buttons(ui, commands);
            ui.add_space(CLOSE_BY);
            self.zoom_buttons(ui, choices);
            ui.add_space(CLOSE_BY);
            self.switch(ui, CLOSING, commands);
        });
        let size = vec2(ui.available_width(), ui.available_height() - 24.0);
        let seen = self.plot(ui, size, (id, choices));
        self.foot(ui, &seen, &choices.picked);
        seen
    }

    /// The outlines with what is measured between them.
    fn plot(&self, ui: &mut Ui, size: Vec2, (id, choices): (Id, &mut Choices)) -> Seen {
        let outlines = self.outlines(choices.is_exaggerated);
        let lie = Lie::of(&outlines);
        if choices.lie.replace(lie) != Some(lie) {
            // The buttons were drawn for what was seen before.
            ui.ctx().request_repaint();
        }
        let has_worst = self.gaps.is_some_and(|gaps| gaps.worst().is_some());
        let parts = self.state.document.stamp().parts;
        let is_new = choices.notice((self.plane.normal, parts), lie, has_worst);
        let mut seen = Seen {
            lie: Some(lie),
            is_exaggerated: choices.is_exaggerated,
            ..Seen::default()
        };
        let zoom = choices
            .zoom
            .take()
            .and_then(|zoom| self.bounds(zoom, &outlines, size));
        let unit = self.state.document.unit_suffix();
        let width = size.x.max(40.0);
        ui.visuals_mut().extreme_bg_color = Color32::TRANSPARENT;
        let plot = Plot::new("section")
            .id(id.with("plot"))
            .width(width)
            .height(size.y.max(40.0))
            .data_aspect(1.0)
            .show_background(false)
            .grid_color(self.look.weak.gamma_multiply(0.35))
            .allow_scroll(false)
            .allow_boxed_zoom(false)
            .allow_axis_zoom_drag(false)
            .y_axis_min_width(AXIS)
            .set_margin_fraction(vec2(0.06, 0.06))
            .show_crosshair(false)
            .label_formatter(|_| None);
        let axes = self.plane.axes();
        let [right, up] = axes.map(|axis| told_along(&axis));
        let signs = [right.1, up.1];
        let shown = with_coordinates(ui, plot, (width - AXIS, unit), signs).show(ui, |plot| {
            if is_new {
                plot.set_auto_bounds(true);
            }
            if let Some(bounds) = zoom {
                plot.set_plot_bounds(bounds);
            }
            choices.is_zoomed |= !is_new && !plot.auto_bounds().any();
            Self::lines(plot, outlines);
            zoom_by_wheel(plot, self.state.document.section_step());
            self.measured(plot, &choices.picked);
            self.look_at(plot, &mut seen);
        });
        self.unused_lines(ui, &shown.transform);
        let response = shown.response;
        self.axis_names(ui, response.rect, [right.0, up.0]);
        response.widget_info(|| {
            let [right, up] = axes.map(|axis| direction_name(&axis));
            let name = format!("Outlines in the section plane, {right} to the right, {up} upwards");
            WidgetInfo::labeled(egui::Role::Canvas, true, name)
        });
        // A double click shows all again and measures nothing.
        seen.clicked = seen.at.filter(|_| response.clicked());
        seen.is_forgotten = response.secondary_clicked() || response.double_clicked();
        seen
    }

    /// What is told along the axes at their ends, with the unit of the numbers.
    fn axis_names(&self, ui: &Ui, plot: Rect, [right, up]: [String; 2]) {
        let unit = match self.state.document.unit_suffix().trim() {
            "" => String::new(),
            unit => format!(", {unit}"),
        };
        let text = |at, align, name: &str| {
            let (text, font) = (format!("{name}{unit}"), FontId::proportional(12.0));
            ui.painter().text(at, align, text, font, self.look.text);
        };
        let at = plot.right_bottom() - vec2(4.0, 2.0);
        text(at, Align2::RIGHT_BOTTOM, &right);
        let at = plot.left_top() + vec2(4.0, 2.0);
        text(at, Align2::LEFT_TOP, &up);
    }

    /// The outlines in the axes of the plane, the crash part's first so that it lies below.
    fn outlines(&self, is_exaggerated: bool) -> Vec<Outline> {
        let mut outlines = Vec::new();
        let wide = self.gaps.filter(|_| is_exaggerated);
        let cuts: Vec<_> = match wide {
            Some(gaps) => {
                let style = |role, number| sections::style(self.look, role, number);
                let crash = (Role::Crash, style(Role::Crash, 0), &gaps.crash, None);
                let stamped = gaps.stamped.iter().map(|file| {
                    let style = style(Role::Stamped, file.number);
                    (Role::Stamped, style, &file.cut, Some(&file.found))
                });
                std::iter::once(crash).chain(stamped).collect()
            }
            None => {
                let cuts = self.cuts.styled(self.look).into_iter();
                cuts.map(|(role, style, cut)| (role, style, cut, None))
                    .collect()
            }
        };
        for (role, style, cut, gaps) in cuts {
            for (index, line) in cut.lines.iter().enumerate() {
                let ways = gaps.and_then(|gaps| gaps.ways.get(index));
                outlines.push(Outline {
                    role,
                    style,
                    points: self.flat(line, ways),
                });
            }
        }
        outlines
    }

    /// A line in the axes of the plane, its points moved on along `ways`.
    fn flat(&self, line: &SectionLine, ways: Option<&Vec<Option<Vector3>>>) -> Vec<[f64; 2]> {
        let n = line.points.len() + usize::from(line.is_closed);
        let place = |index: usize| {
            let index = index % line.points.len();
            let way = ways.and_then(|ways| *ways.get(index)?).unwrap_or_default();
            self.plane
                .flat(&(line.points[index] + way * (EXAGGERATED - 1.0)))
        };
        (0..n).map(place).collect()
    }

    /// What is seen after a zoom.
    fn bounds(&self, zoom: Zoom, outlines: &[Outline], size: Vec2) -> Option<PlotBounds> {
        let shown = match zoom {
            Zoom::Part(role) => Some(role),
            Zoom::WorstGap | Zoom::All => None,
        };
        let [low, high] = around(outlines, shown)?;
        let extent = (high[0] - low[0]).hypot(high[1] - low[1]);
        let aspect = f64::from(size.x / size.y.max(1.0));
        let (center, half) = match zoom {
            Zoom::Part(_) | Zoom::All => {
                let center = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
                let half = (high[1] - low[1]).max((high[0] - low[0]) / aspect);
                (center, 0.55 * half)
            }
            Zoom::WorstGap => {
                let worst = self.gaps?.worst()?;
                let [a, b] = [self.plane.flat(&worst.from), self.plane.flat(&worst.to)];
                let width = (b[0] - a[0]).hypot(b[1] - a[1]);
                let half = (0.5 * WIDTHS * width).min(0.5 * CLOSE * extent);
                ([0, 1].map(|i| 0.5 * (a[i] + b[i])), half / aspect.max(1.0))
            }
        };
        // What is smaller than an element are facets.
        let half = half.max(0.5 * self.state.document.finest_element());
        let half = [half * aspect, half];
        let corner = |sign: f64| [0, 1].map(|i| center[i] + sign * half[i]);
        Some(PlotBounds::from_min_max(corner(-1.0), corner(1.0)))
    }

    fn lines(plot: &mut PlotUi<'_>, outlines: Vec<Outline>) {
        for outline in outlines {
            let Outline {
                role,
                style,
                points,
            } = outline;
            let width = match role {
                Role::Crash => BELOW,
                Role::Stamped => ABOVE,
            };
            let line = exact_line(role.word(), points)
                .color(color(style.rgb))
                .width(width)
                .allow_hover(false);
            plot.line(if style.is_dashed {
                line.style(LineStyle::dashed_dense())
            } else {
                line
            });
        }
    }

    /// The outlines of unused parts, thin and grey. They are no part of the plot, whose view is that of the others.
    fn unused_lines(&self, ui: &Ui, plot: &PlotTransform) {
        let painter = ui.painter_at(*plot.frame());
        let seen = plot.frame().expand(1.0);
        for (role, lines) in self.unused {
            let stroke = Stroke::new(1.0, color(self.look.ghost(*role)));
            for line in lines.iter() {
                let places = line.iter().map(|point| {
                    let [x, y] = self.plane.flat(point);
                    plot.position_from_point(&PlotPoint::new(x, y))
                });
                let places: Vec<_> = places.collect();
                if seen.intersects(Rect::from_points(&places)) {
                    painter.line(places, stroke);
                }
            }
        }
    }

    /// The picked points and the line between them.
    fn measured(&self, plot: &mut PlotUi<'_>, picked: &[[f64; 2]]) {
        if picked.is_empty() {
            return;
        }
        let points = || PlotPoints::from(picked.to_vec());
        let line = exact_line("measured", points())
            .color(self.look.tool)
            .width(1.2)
            .style(LineStyle::dashed_dense());
        plot.line(line.allow_hover(false));
        let ends = Points::new("ends", points())
            .color(self.look.tool)
            .radius(3.5)
            .allow_hover(false);
        plot.points(ends);
    }

    /// The place under the pointer, on an outline if one is near, and the gap there.
    fn look_at(&self, plot: &mut PlotUi<'_>, seen: &mut Seen) {
        let is_hovered = plot.response().hovered();
        let Some(pointer) = plot.pointer_coordinate().filter(|_| is_hovered) else {
            return;
        };
        let per_point = 1.0 / plot.transform().dpos_dvalue_x().abs().max(1e-12);
        let query = self.plane.point_at([pointer.x, pointer.y]);
        let nearest = self
            .cuts
            .styled(self.look)
            .into_iter()
            .filter_map(|(_, _, cut)| nearest_on_lines(&cut.lines, &query))
            .map(|found| found.point)
            .min_by(|a, b| distance(a, &query).total_cmp(&distance(b, &query)));
        let is_near = |point: &Point3| distance(point, &query) < SNAP * per_point;
        let snapped = nearest.filter(|point| is_near(point) && !seen.is_exaggerated);
        let at = snapped.map_or([pointer.x, pointer.y], |point| self.plane.flat(&point));
        seen.at = Some(at).filter(|_| !seen.is_exaggerated);
        if snapped.is_some() {
            let point = Points::new("snap", PlotPoints::from(vec![at]))
                .color(self.look.tool)
                .radius(3.0)
                .filled(false)
                .allow_hover(false);
            plot.points(point);
        }
        let Some(crash) = &self.cuts.parts.crash else {
            return;
        };
        let normal = |triangle| crash.normal(triangle);
        let stamped = self.cuts.stamped().map(|cut| &cut.lines[..]);
        let gap = gap_to_nearest(&crash.lines, normal, stamped, &self.plane, &query);
        seen.gap = gap.filter(|gap| distance(&gap.from, &query) < NEAR * per_point);
        if let Some(gap) = &seen.gap {
            let scale = if seen.is_exaggerated {
                EXAGGERATED
            } else {
                1.0
            };
            let to = gap.from + (gap.to - gap.from) * scale;
            let ends = vec![self.plane.flat(&gap.from), self.plane.flat(&to)];
            let line = exact_line("gap", ends)
                .color(self.look.text)
                .width(1.5)
                .allow_hover(false);
            plot.line(line);
        }
    }

    /// What is said of outlines between which there is nothing to measure.
    fn lie_words(&self, lie: Lie) -> Option<String> {
        let words = match lie {
            Lie::Together => return None,
            Lie::Alone(_) | Lie::Nowhere if self.is_cutting => return Some("cutting…".to_owned()),
            Lie::Apart(distance) => format!(
                "the parts lie {} from each other",
                self.state.lengths().of(distance)
            ),
            Lie::Alone(role) => format!("the plane meets the {} part alone", role.word()),
            Lie::Nowhere => return Some("the plane meets neither part".to_owned()),
        };
        let is_matched = self.state.document.current_result().is_some();
        let hint = " · Match or Move by hand brings the parts together";
        Some(words + if is_matched { "" } else { hint })
    }

    /// What was measured, the gap at the pointer, the worst one, or what one can do.
    fn foot(&self, ui: &mut Ui, seen: &Seen, picked: &[[f64; 2]]) {
        let lengths = self.state.lengths();
        let worst = self.gaps.and_then(Gaps::worst);
        let (text, is_fact) = if let [a, b] = picked {
            let [du, dv] = [b[0] - a[0], b[1] - a[1]];
            let whole = lengths.of(du.hypot(dv));
            let parts = format!("{} across, {} up", lengths.signed(du), lengths.signed(dv));
            (format!("distance {whole}   ({parts})"), true)
        } else if let Some(gap) = &seen.gap {
            let flush = lengths.of(gap.flush);
            let across = lengths.signed_of(gap.gap);
            (format!("gap {across} · flush {flush}"), true)
        } else if let Some(words) = seen.lie.and_then(|lie| self.lie_words(lie)) {
            (words, false)
        } else if picked.len() == 1 {
            ("click the second point".to_owned(), false)
        } else if let Some(worst) = worst {
            let width = lengths.of(distance(&worst.from, &worst.to));
            (
                format!("widest gap {width} · click two points to measure"),
                false,
            )
        } else {
            ("click two points to measure".to_owned(), false)
        };
        let color = if is_fact {
            self.look.text
        } else {
            self.look.weak
        };
        ui.with_layout(Layout::top_down(Align::Min), |ui| {
            let text = RichText::new(capital(&text)).size(11.5).color(color);
            ui.add(egui::Label::new(text).wrap());
        });
    }
}

/// What the pointer is at.
#[derive(Default)]
struct Seen {
    at: Option<[f64; 2]>,
    gap: Option<Gap>,
    lie: Option<Lie>,
    is_exaggerated: bool,
    clicked: Option<[f64; 2]>,
    is_forgotten: bool,
}

fn distance(a: &Point3, b: &Point3) -> f64 {
    (a - b).norm()
}
