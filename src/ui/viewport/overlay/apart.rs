//! A dotted line between the two parts where they lie far apart, with the way to bring them together.

use egui::{Button, Pos2, Rect, RichText, Shape, Stroke, Ui, vec2};

use super::{Overlay, legend};
use crate::app::{Command, MoveCommand};
use crate::geometry::Point3;
use crate::role::Role;
use crate::ui::pictures::clickable;
use crate::ui::viewport::navigation::pos_of;

/// Parts are far apart when their centres are further from each other than this share of their
/// mean size.
const FAR: f64 = 0.5;

/// The line and the button, in the left window with both parts in it.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let Some([from, to]) = centers(over) else {
        return;
    };
    let camera = &over.frame.view.camera;
    let ends = [&from, &to].map(|point| pos_of(over.frame.rect(), camera, point));
    let [Some(from), Some(to)] = ends else {
        return;
    };
    let painter = over.painter(ui);
    let lines = [(4.0, over.frame.look.plate), (1.5, over.frame.look.text)];
    for (width, color) in lines {
        let stroke = Stroke::new(width, color);
        painter.extend(Shape::dashed_line(&[from, to], stroke, 3.0, 5.0));
    }
    for (at, role) in [(from, Role::Stamped), (to, Role::Crash)] {
        painter.circle_filled(at, 5.5, over.frame.look.plate);
        painter.circle_filled(at, 4.0, over.frame.look.role(role));
    }
    if over.frame.state.can_move().is_ok() && !over.frame.state.is_preview() {
        let middle = from + (to - from) * 0.5;
        clickable(ui, |ui| suggest(ui, over, middle, commands));
    }
}

/// Centres of the stamped and the crash part, if they are far apart.
fn centers(over: &Overlay<'_>) -> Option<[Point3; 2]> {
    if over.role() != Role::Crash || over.frame.view.over < 1.0 {
        return None;
    }
    let both = over.frame.state.document.both()?;
    let (to, own) = (both.crash.bounds(), both.stamped.bounds());
    let from = over.frame.view.pose.apply(&own.center());
    let size = 0.5 * (to.diagonal() + own.diagonal() * over.frame.view.pose.scale);
    ((from - to.center()).norm() > FAR * size).then(|| [from, to.center()])
}

fn suggest(ui: &mut Ui, over: &Overlay<'_>, middle: Pos2, commands: &mut Vec<Command>) {
    let size = vec2(168.0, 28.0);
    let room = over.frame.rect().shrink2(vec2(90.0, 70.0));
    let center = room.clamp(middle + vec2(0.0, 24.0));
    let text = RichText::new("Align centres").size(12.5);
    let mut area = Rect::from_center_size(center, size);
    // The legend lies over everything in its place.
    if let Some(legend) = legend::last_place(ui, over)
        && legend.expand(4.0).intersects(area)
    {
        let side = if legend.center().x > over.frame.rect().center().x {
            legend.left() - 8.0 - area.right()
        } else {
            legend.right() + 8.0 - area.left()
        };
        area = area.translate(vec2(side, 0.0));
    }
    if ui.put(area, Button::new(text)).clicked() {
        commands.push(MoveCommand::AlignCenters.into());
    }
}
