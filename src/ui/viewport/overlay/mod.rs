//! What egui draws over a window's picture: names, buttons, marks, cards.

mod apart;
mod banner;
mod cards;
mod cube;
mod distance;
mod divider;
mod free;
mod freedom;
mod header;
mod labels;
mod legend;
mod marks;
mod pairs;
mod room;
mod section;

pub use free::free_choice;

pub(super) use self::room::FreeRoom;
pub(super) use crate::text::grouped;
use egui::{Align2, FontId, Painter, Rect, Ui};

use super::fields::{FieldKind, Summary};
use super::frame::FrameContext;
use super::navigation::CameraDrag;
use super::picking::Pick;
use super::picture::Hit;
use crate::app::Command;
use crate::colormap::ColorScale;
use crate::role::Role;
use crate::ui::pictures::clickable;
use crate::ui::theme::{Look, color};

/// Air between the edge of the window and what lies over it.
const MARGIN: f32 = 10.0;

/// A window and what is over it in one frame.
pub(super) struct Overlay<'a> {
    pub frame: &'a FrameContext<'a>,
    pub drag: Option<&'a CameraDrag>,
    pub hit: Option<&'a Hit>,
    /// Colours of the shown field and what they say.
    pub scale: Option<(FieldKind, ColorScale)>,
    /// What the colours should show, measured or not.
    pub kind: Option<FieldKind>,
    /// Figures of the field, where its legend has no others.
    pub summary: Option<Summary>,
    /// What the handle under the pointer does.
    pub hint: Option<String>,
    /// What a click would pick for a pair of points or a distance.
    pub pick: Option<Pick>,
    /// The part is there but not yet its mesh.
    pub is_preparing: bool,
}

impl Overlay<'_> {
    fn role(&self) -> Role {
        self.frame.view.window
    }

    /// True where differences are shown and there are none but rounding.
    fn is_equal(&self) -> bool {
        let is_difference = self.kind.is_some_and(FieldKind::is_difference);
        is_difference && self.summary.is_some_and(|summary| summary.is_nothing())
    }

    fn painter(&self, ui: &Ui) -> Painter {
        ui.painter_at(self.frame.rect())
    }
}

/// Draws everything over the picture.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    marks::pivot(ui, over);
    marks::node(ui, over);
    marks::place(ui, over);
    marks::probe(ui, over);
    if over.is_preparing {
        cards::preparing(ui, over);
    }
    apart::show(ui, over, commands);
    divider::show(ui, over, commands);
    freedom::show(ui, over);
    pairs::show(ui, over);
    pairs::next(ui, over);
    section::handle(ui, over, commands);
    let taken = labels::show(ui, over, commands);
    distance::show(ui, over, &taken);
    let legend = legend::show(ui, over, commands);
    let banner = banner::show(ui, over, commands);
    let sentence = freedom::sentence(ui, over, banner);
    marks::show(ui, over, legend, [banner, sentence]);
    cube::show(ui, over, commands);
    header::show(ui, over);
    clickable(ui, |ui| header::buttons(ui, over, commands));
    free::show(ui, over, commands);
    room::tell(over, legend, sentence.or(banner), commands);
}

/// A text in the place of the picture.
pub(super) fn placeholder(ui: &Ui, rect: Rect, look: &Look) {
    let painter = ui.painter_at(rect);
    let ground = match look.background {
        crate::render::Background::Gradient { bottom, .. } => bottom,
        crate::render::Background::Transparent => [0; 3],
    };
    painter.rect_filled(rect, 0.0, color(ground));
    painter.text(
        rect.center(),
        Align2::CENTER_CENTER,
        "no graphics adapter",
        FontId::proportional(13.0),
        look.weak,
    );
}
