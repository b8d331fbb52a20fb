//! The ring around what has the keyboard: shown where the keyboard is used to go from one to the next, and not
//! after a click, which says where it went.

use egui::{ComboBox, Context, Event, Id, InnerResponse, Key, Popup, Response, Ui};

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

/// A menu of choices that the keyboard enters when it opens, at the choice that holds ([`chosen`]), and leaves for
/// its button when it closes. Tab closes it too.
pub fn menu<R>(
    ui: &mut Ui,
    menu: ComboBox,
    choices: impl FnOnce(&mut Ui) -> R,
) -> InnerResponse<Option<R>> {
    let shown = menu.show_ui(ui, choices);
    let is_open = shown.inner.is_some();
    let was_open = shown.response.id.with("was open");
    let before =
        ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default(was_open), is_open));
    if before && !is_open {
        shown.response.request_focus();
    } else if is_open && ui.input(|input| input.key_pressed(Key::Tab)) {
        // Tab has gone on beside the open list; from the button it goes on with the next press.
        Popup::close_all(ui.ctx());
        ui.ctx().request_repaint();
    }
    shown
}

/// Gives the keyboard to the choice that holds, in the frame in which its menu opens, and closes the menu after a
/// choice. Called for every choice, with whether it holds.
pub fn chosen(ui: &Ui, holds: bool, choice: Response) -> Response {
    let opened = ui.scope_id().with("opened");
    if holds && is_just_opened(ui, opened) {
        choice.request_focus();
    }
    if choice.clicked() {
        // A menu closes by itself after a press of the pointer alone.
        ui.close();
    }
    choice
}

/// Whether what asks under this id, once in every frame in which it is drawn, was not drawn in the frame before.
pub fn is_just_opened(ui: &Ui, id: Id) -> bool {
    let pass = ui.ctx().cumulative_pass_nr();
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    ui.data_mut(|data| data.insert_temp(id, pass));
    last.is_none_or(|last| last + 1 < pass)
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
