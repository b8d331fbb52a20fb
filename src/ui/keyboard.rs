//! Keys to commands, through the table of actions.

use crate::app::{
    Action, AppState, Axis, Command, Key, ModalInput, MoveCommand, Shortcut, ViewCommand,
};
use egui::{Event, Modifiers};

/// The commands of this frame's keys.
pub fn commands(ctx: &egui::Context, state: &AppState) -> Vec<Command> {
    let is_typing = ctx.text_edit_focused();
    let is_popup_open = ctx.any_popup_open();
    let (events, held) = ctx.input(|input| (input.events.clone(), input.modifiers));
    let mut commands = Vec::new();
    for event in &events {
        if is_popup_open && !matches!(event, Event::Key { pressed: false, .. }) {
            continue;
        }
        let is_moving = state.view.move_tool.is_some() && !is_typing;
        if is_moving && let Some(input) = modal_input(event) {
            commands.push(MoveCommand::Input(input).into());
        } else {
            commands.extend(of_event(event, held, is_typing, state));
        }
    }
    commands
}

fn of_event(event: &Event, held: Modifiers, is_typing: bool, state: &AppState) -> Vec<Command> {
    let Some((shortcut, is_pressed, is_repeat)) = pressed(event, held) else {
        return Vec::new();
    };
    if is_typing && is_pressed && !shortcut.works_in_text() {
        return Vec::new();
    }
    let Some(action) = Action::of_shortcut(shortcut) else {
        return Vec::new();
    };
    if action.is_held() {
        let is_new = is_pressed != state.view.is_blinking;
        let command = ViewCommand::SetBlinking(is_pressed).into();
        return is_new.then_some(command).into_iter().collect();
    }
    let repeats = matches!(
        action,
        Action::Undo
            | Action::Redo
            | Action::NextLevel
            | Action::PreviousLevel
            | Action::NextStart
            | Action::PreviousStart
            | Action::ScaleUp
            | Action::ScaleDown
    );
    if is_pressed && (repeats || !is_repeat) {
        action.to_commands(state)
    } else {
        Vec::new()
    }
}

/// Key with what is held, whether it went down, and whether it repeats.
fn pressed(event: &Event, held: Modifiers) -> Option<(Shortcut, bool, bool)> {
    match event {
        Event::Key {
            key,
            physical_key,
            pressed,
            repeat,
            modifiers,
        } => {
            let shortcut = shortcut(*key, *physical_key, *modifiers)?;
            Some((shortcut, *pressed, *repeat))
        }
        // The desktop layer turns Ctrl + Shift + C into a copy without a key.
        Event::Copy if held.shift => Some((Shortcut::ctrl_shift(Key::Letter('C')), true, false)),
        _ => None,
    }
}

/// Our name of a key. Digits go by their place, so that they work on every layout.
fn shortcut(key: egui::Key, place: Option<egui::Key>, modifiers: Modifiers) -> Option<Shortcut> {
    let digit = |key: egui::Key| match our_key(key) {
        Some(Key::Digit(digit)) => Some(Key::Digit(digit)),
        _ => None,
    };
    let key = place.and_then(digit).or_else(|| our_key(key))?;
    // Plus needs Shift on some keyboards and not on others.
    let is_sign = matches!(key, Key::Plus | Key::Minus);
    Some(Shortcut {
        ctrl: modifiers.command,
        shift: modifiers.shift && !is_sign,
        alt: modifiers.alt,
        key,
    })
}

fn our_key(key: egui::Key) -> Option<Key> {
    let name = key.name();
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some(letter @ 'A'..='Z'), None) => return Some(Key::Letter(letter)),
        (Some(digit @ '0'..='9'), None) => return Some(Key::Digit(digit as u8 - b'0')),
        (Some('F'), Some('1'..='9')) => {
            let number = name[1..].parse().ok()?;
            return (number <= 12).then_some(Key::Function(number));
        }
        _ => {}
    }
    match key {
        egui::Key::Enter => Some(Key::Enter),
        egui::Key::Escape => Some(Key::Escape),
        egui::Key::Home => Some(Key::Home),
        egui::Key::PageUp => Some(Key::PageUp),
        egui::Key::PageDown => Some(Key::PageDown),
        egui::Key::Plus | egui::Key::Equals => Some(Key::Plus),
        egui::Key::Minus => Some(Key::Minus),
        _ => None,
    }
}

/// What a key means while a move by keys is under way.
fn modal_input(event: &Event) -> Option<ModalInput> {
    let Event::Key {
        key,
        pressed: true,
        modifiers,
        ..
    } = event
    else {
        return None;
    };
    if modifiers.command || modifiers.alt {
        return None;
    }
    let axis = |axis| ModalInput::Axis {
        axis,
        is_plane: modifiers.shift,
    };
    let input = match key {
        egui::Key::X => axis(Axis::X),
        egui::Key::Y => axis(Axis::Y),
        egui::Key::Z => axis(Axis::Z),
        egui::Key::Enter => ModalInput::Accept,
        egui::Key::Escape => ModalInput::Reject,
        egui::Key::Backspace => ModalInput::Backspace,
        egui::Key::Minus => ModalInput::Character('-'),
        egui::Key::Period => ModalInput::Character('.'),
        egui::Key::Comma => ModalInput::Character(','),
        other => match our_key(*other)? {
            Key::Digit(digit) => ModalInput::Character((b'0' + digit) as char),
            _ => return None,
        },
    };
    Some(input)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_can_be_pressed() {
        for action in Action::ALL {
            let info = action.info();
            for shortcut in [info.shortcut, info.other_shortcut].into_iter().flatten() {
                let name = shortcut.key.name();
                let key = egui::Key::from_name(&name).unwrap_or_else(|| panic!("no key {name}"));
                assert_eq!(our_key(key), Some(shortcut.key), "{name}");
            }
        }
    }

    #[test]
    fn digits_go_by_place_and_plus_by_sign() {
        let french_one = shortcut(egui::Key::Quote, Some(egui::Key::Num1), Modifiers::NONE);
        assert_eq!(french_one, Some(Shortcut::plain(Key::Digit(1))));
        let plus = shortcut(egui::Key::Plus, None, Modifiers::COMMAND | Modifiers::SHIFT);
        assert_eq!(plus, Some(Shortcut::ctrl(Key::Plus)));
    }
}
