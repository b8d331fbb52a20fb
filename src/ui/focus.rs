//! The ring around what has the keyboard: shown where the keyboard is used to go from one to the next, and not
//! after a click, which says where it went.

use egui::{Context, Event, Id, Key, Response};

use super::theme;

/// Looks at the events of a frame, before anything of it is drawn.
pub fn follow(ctx: &Context) {
    let last = ctx.input(|input| input.events.iter().rev().find_map(goes_by_key));
    let Some(is_shown) = last else { return };
    if is_shown != is_shown_in(ctx) {
        ctx.data_mut(|data| data.insert_temp(id(), is_shown));
        theme::set_ring(ctx, is_shown);
        // This frame has begun with the style of before.
        ctx.request_repaint();
    }
}

/// Whether a widget has the keyboard and is to say so.
pub fn is_ringed(response: &Response) -> bool {
    response.has_focus() && is_shown_in(&response.ctx)
}

fn is_shown_in(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(id())).unwrap_or(false)
}

fn id() -> Id {
    Id::unique("the keyboard goes from one to the next")
}

/// Whether the event goes to another widget by key, or by pointer; `None` if by neither.
fn goes_by_key(event: &Event) -> Option<bool> {
    match event {
        Event::Key {
            key: Key::Tab | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp,
            pressed: true,
            ..
        }
        | Event::AccessKitActionRequest(_) => Some(true),
        Event::PointerButton { pressed: true, .. } | Event::Touch { .. } => Some(false),
        _ => None,
    }
}
