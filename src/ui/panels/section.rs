//! The frame of the four sections: number, title, summary, fold.

use egui::{
    Align, Align2, CornerRadius, FontId, Margin, Rect, Sense, Stroke, TextStyle, Ui, UiBuilder,
    pos2, vec2,
};

use crate::app::{AppState, Command, Section, ViewCommand};
use crate::role::PerRole;
use crate::ui::focus::is_ringed;
use crate::ui::theme::{Palette, TALL, UNIT};

/// A section: its header is always there, its body while it is unfolded.
pub fn section_ui(
    ui: &mut Ui,
    state: &AppState,
    section: Section,
    summary: &str,
    commands: &mut Vec<Command>,
    body: impl FnOnce(&mut Ui, &mut Vec<Command>),
) {
    let mut fold = Fold::read(ui);
    let is_open = fold.shown[section.index()];
    let opened = egui::Id::unique("section that was opened");
    let top = ui.cursor().top();
    keep_place(ui, section, top);
    if header_ui(ui, state, section, (is_open, summary)) {
        commands.push(ViewCommand::OpenSection(section, !is_open).into());
        ui.data_mut(|data| data.insert_temp(opened, (section.index(), !is_open)));
    }
    if !is_open {
        return;
    }
    let margin = Margin {
        left: 16,
        right: 16,
        top: 4,
        bottom: 12,
    };
    // A child of fixed width: nothing in it may push the edges of those below outwards.
    let room = ui.available_rect_before_wrap() - margin;
    // A name of its own: its widgets stay the same when a section above is folded.
    let id = egui::Id::unique(("section", section.title()));
    let mut inner = ui.new_child(UiBuilder::new().max_rect(room).scope_id(id));
    inner.spacing_mut().item_spacing = vec2(UNIT, 6.0);
    body(&mut inner, commands);
    let height = inner.min_rect().height() + margin.sum().y;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    keep_place(ui, section, top);
    if ui.data(|data| data.get_temp(opened)) == Some((section.index(), true)) {
        ui.data_mut(|data| data.remove::<(usize, bool)>(opened));
        if rect.bottom() > ui.clip_rect().bottom() {
            // What was asked for is seen, its header first.
            let whole = rect.with_min_y(rect.top() - TALL);
            ui.scroll_to_rect(whole, Some(Align::TOP));
        }
    }
    let before = std::mem::replace(&mut fold.bodies[section.index()], height);
    fold.write(ui);
    let is_pressed =
        ui.input(|input| input.pointer.any_pressed()) && ui.rect_contains_pointer(rect);
    let parts = state.document.stamp().parts;
    let has_unfolded = before > 0.0 && height - before > UNFOLDED && fold.parts == parts;
    if (is_pressed || has_unfolded) && state.view.sections.in_use() != section {
        commands.push(ViewCommand::UseSection(section).into());
    }
}

/// Where a section is, header and body, as far as it is seen; `None` while the column is away.
pub fn place_of(ctx: &egui::Context, section: Section) -> Option<Rect> {
    let (drawn, place) = ctx.data(|data| data.get_temp::<(u64, Rect)>(place_id(section)))?;
    let is_there = ctx.cumulative_pass_nr() <= drawn + 1;
    Some(place).filter(|place| is_there && place.is_positive())
}

fn keep_place(ui: &Ui, section: Section, top: f32) {
    let (x, bottom) = (ui.max_rect().x_range(), ui.cursor().top().max(top + TALL));
    let place = Rect::from_x_y_ranges(x, top..=bottom).intersect(ui.clip_rect());
    let drawn = ui.ctx().cumulative_pass_nr();
    ui.data_mut(|data| data.insert_temp(place_id(section), (drawn, place)));
}

fn place_id(section: Section) -> egui::Id {
    egui::Id::unique(("place of a section", section.title()))
}

/// A body that grows by so much was unfolded by someone, with the pointer or without.
const UNFOLDED: f32 = 48.0;

/// How high the bodies were when they were last drawn, and which are drawn now.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fold {
    bodies: [f32; 4],
    shown: [bool; 4],
    /// The parts that were there in the frame before; a body that grows with a new part was not unfolded by anyone.
    parts: PerRole<u64>,
    /// The height the column had, and whether the user pressed something in it since it has that.
    height: f32,
    is_used: bool,
}

impl Fold {
    fn id() -> egui::Id {
        egui::Id::unique("folds of the left column")
    }

    fn read(ui: &Ui) -> Self {
        let kept = ui.data(|data| data.get_temp(Self::id()));
        kept.unwrap_or(Self {
            bodies: [0.0; 4],
            shown: [true, true, true, false],
            parts: PerRole::default(),
            height: 0.0,
            is_used: false,
        })
    }

    fn write(self, ui: &Ui) {
        ui.data_mut(|data| data.insert_temp(Self::id(), self));
    }
}

/// To be called after the sections are drawn.
pub fn drawn_ui(ui: &Ui, state: &AppState) {
    let parts = state.document.stamp().parts;
    let fold = Fold::read(ui);
    let is_pressed = ui.input(|input| input.pointer.any_pressed());
    let is_used = fold.is_used || (is_pressed && ui.rect_contains_pointer(ui.clip_rect()));
    if fold.parts != parts || fold.is_used != is_used {
        // With new parts the bodies have other heights: they are arranged anew.
        let is_used = is_used && fold.parts == parts;
        Fold {
            parts,
            is_used,
            ..fold
        }
        .write(ui);
    }
}

/// Decides which sections are unfolded in a column of this height; before the sections are drawn. They
/// fold for want of room only after a main step, until the user works in the column or does something else, and
/// again when its height changes.
pub fn fold_ui(ui: &Ui, state: &AppState, height: f32) {
    let before = Fold::read(ui);
    let room = height - TALL * Section::ALL.len() as f32;
    let is_resized = (height - before.height).abs() > 0.5;
    let is_used = before.is_used && !is_resized;
    let sections = &state.view.sections;
    let shown = if !sections.is_arranging() && !is_resized {
        sections.held(before.shown)
    } else if is_used {
        sections.kept(before.bodies, room, before.shown)
    } else {
        sections.shown(before.bodies, room, before.shown)
    };
    Fold {
        shown,
        height,
        is_used,
        ..before
    }
    .write(ui);
    if shown != before.shown {
        ui.ctx().request_repaint();
    }
}

/// True if a section shows its body.
pub fn is_unfolded(ui: &Ui, section: Section) -> bool {
    Fold::read(ui).shown[section.index()]
}

/// Draws the header; true if it was clicked.
fn header_ui(
    ui: &mut Ui,
    state: &AppState,
    section: Section,
    (is_open, summary): (bool, &str),
) -> bool {
    let palette = Palette::of(ui);
    let (index, title) = (section.index(), section.title());
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TALL), Sense::click());
    let name = format!("{} {title}", index + 1);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_open, &name));
    let painter = ui.painter();
    if index > 0 {
        painter.hline(rect.x_range(), rect.top(), Stroke::new(1.0, palette.line));
    }
    if response.hovered() || is_ringed(&response) {
        let inner = rect.shrink2(vec2(4.0, 2.0));
        painter.rect_filled(inner, 4.0, palette.card);
        if is_ringed(&response) {
            let ring = Stroke::new(1.5, palette.accent_text);
            painter.rect_stroke(inner, 4.0, ring, egui::StrokeKind::Inside);
        }
    }
    let middle = rect.center().y;
    let badge = Rect::from_center_size(pos2(rect.left() + 25.0, middle), vec2(18.0, 18.0));
    painter.rect_filled(badge, CornerRadius::same(9), palette.widget);
    let small = TextStyle::Small.resolve(ui.style());
    let number = (index + 1).to_string();
    painter.text(
        badge.center(),
        Align2::CENTER_CENTER,
        number,
        small.clone(),
        palette.text,
    );
    let title_font = FontId::proportional(15.0);
    let at = pos2(badge.right() + UNIT, middle);
    let title_rect = painter.text(at, Align2::LEFT_CENTER, title, title_font, palette.text);
    paint_fold(painter, pos2(rect.right() - 24.0, middle), is_open, palette);
    let stale = state.stale(section);
    let question = state.open_question(section).filter(|_| !is_open);
    let (text, color) = match (&question, stale) {
        (Some(question), _) => (question.short, palette.check),
        (None, Some(_)) => ("⚠ out of date", palette.check),
        (None, None) => (summary, palette.secondary),
    };
    let room = rect.right() - 40.0 - title_rect.right() - UNIT;
    let galley = elided(ui, text, small, color, room);
    let at = pos2(
        rect.right() - 40.0 - galley.size().x,
        middle - galley.size().y / 2.0,
    );
    ui.painter().galley(at, galley, color);
    let response = match (question, stale) {
        (Some(question), _) => response.on_hover_text(question.text),
        (None, Some(stale)) => response.on_hover_text(format!("Out of date: {}", stale.reason)),
        (None, None) => response,
    };
    response.clicked()
}

/// One line of text, cut with an ellipsis where it does not fit.
pub fn elided(
    ui: &Ui,
    text: &str,
    font: FontId,
    color: egui::Color32,
    room: f32,
) -> std::sync::Arc<egui::Galley> {
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(0.0));
    ui.painter().layout_job(job)
}

/// One line of text, cut in the middle where it does not fit: names that begin alike are told apart by their
/// ends.
pub fn elided_middle(
    ui: &Ui,
    text: &str,
    font: FontId,
    color: egui::Color32,
    room: f32,
) -> std::sync::Arc<egui::Galley> {
    let lay = |text: String| ui.painter().layout_no_wrap(text, font.clone(), color);
    let whole = lay(text.to_owned());
    if whole.size().x <= room {
        return whole;
    }
    let letters: Vec<char> = text.chars().collect();
    let kept = |n: usize| {
        let (head, tail) = (n.div_ceil(2), n / 2);
        let head: String = letters[..head].iter().collect();
        let tail: String = letters[letters.len() - tail..].iter().collect();
        format!("{}…{}", head.trim_end(), tail.trim_start())
    };
    // As many letters as fit.
    let (mut low, mut high) = (0, letters.len());
    while low + 1 < high {
        let middle = low.midpoint(high);
        if lay(kept(middle)).size().x <= room {
            low = middle;
        } else {
            high = middle;
        }
    }
    elided(ui, &kept(low), font, color, room)
}

fn paint_fold(painter: &egui::Painter, at: egui::Pos2, is_open: bool, palette: &Palette) {
    let corners = if is_open {
        [vec2(-4.0, -2.5), vec2(4.0, -2.5), vec2(0.0, 3.0)]
    } else {
        [vec2(-2.5, -4.0), vec2(3.0, 0.0), vec2(-2.5, 4.0)]
    };
    let points = corners.map(|corner| at + corner).to_vec();
    painter.add(egui::Shape::convex_polygon(
        points,
        palette.secondary,
        Stroke::NONE,
    ));
}
