//! Keys to commands, through the table of actions.

use std::collections::VecDeque;

use egui::{Event, Modifiers};

use super::palette;
use crate::app::{
    Action, AppState, Axis, Command, Dialog, Key, KeyMode, ModalInput, MoveCommand, NoticeCommand,
    Section, Shortcut, ViewCommand,
};

/// Actions whose keys act while a dialog lies over the window.
const WITH_DIALOG: [Action; 9] = [
    Action::Escape,
    Action::Help,
    Action::Palette,
    Action::Preferences,
    Action::PictureOptions,
    Action::Quit,
    Action::ScaleUp,
    Action::ScaleDown,
    Action::ScaleReset,
];

/// Actions that begin the work itself or look for what is not there: where they are not possible, their keys say why.
const SAY_WHY: [Action; 10] = [
    Action::OpenCrash,
    Action::OpenStamped,
    Action::MatchOrStop,
    Action::Refine,
    Action::MapOrCancel,
    Action::NextAlternative,
    Action::Blink,
    Action::ToggleWipe,
    Action::ToggleGizmo,
    Action::CopyMatrix,
];

/// What the keys of a frame belong to: the topmost thing that is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum KeyOwner {
    /// A question over the window, such as the field for a path.
    Question,
    /// A menu or another popup. Keys with Ctrl close it and act.
    Popup,
    /// A text field, perhaps in a dialog. Keys that write nothing still act.
    TextField,
    /// The window, or the dialog over it.
    #[default]
    Window,
}

/// Keys to commands. Whatever is open has the first word: it may consume keys while it is drawn, and
/// keys that close it close nothing else.
#[derive(Debug, Default)]
pub struct Keyboard {
    /// A text field had the focus at the end of the last frame. Escape takes the focus away before the
    /// frame begins, but belongs to the field nevertheless.
    was_typing: bool,
    owner: KeyOwner,
    /// A dialog was open when the frame began, and no key has changed that.
    had_dialog: bool,
    held: Modifiers,
    /// The events of the frame, each with whether it was taken before anything was drawn.
    events: Vec<(Event, bool)>,
    /// The keys of the frame that are still to act, in their order.
    keys: VecDeque<Event>,
    /// How many of them came before the end of the last click or key that presses a button.
    n_before_press: usize,
    /// A button closed what lay over the window, and so many keys came before that.
    n_covered: Option<usize>,
    /// What follows the last command.
    then: Option<Command>,
}

impl Keyboard {
    /// Who owns the keys of this frame; to be asked before anything is drawn.
    pub fn owner(&self, ctx: &egui::Context, has_question: bool) -> KeyOwner {
        if has_question {
            KeyOwner::Question
        } else if egui::Popup::is_any_open(ctx) {
            KeyOwner::Popup
        } else if self.was_typing || ctx.text_edit_focused() {
            KeyOwner::TextField
        } else {
            KeyOwner::Window
        }
    }

    /// Before anything is drawn: whose the keys of this frame are. What a move by keys takes is taken at once, so that
    /// Enter presses no button and minus zooms no camera, and so are the window's keys with Ctrl, so that Ctrl+Enter
    /// presses none either. A field that is typed in sees them first: Enter ends what is typed.
    pub fn begin(&mut self, ctx: &egui::Context, state: &AppState, has_question: bool) {
        self.owner = self.owner(ctx, has_question);
        self.had_dialog = state.view.dialog.is_some();
        self.keys.clear();
        self.n_covered = None;
        let is_moving = self.is_moving(state);
        let is_typing = self.was_typing || ctx.text_edit_focused();
        ctx.input_mut(|input| {
            let held = input.modifiers;
            let is_taken = |event: &Event| {
                if is_moving {
                    modal_input(event).is_some() || pressed(event, held).is_some()
                } else {
                    !is_typing && self.is_ours_with_ctrl(event)
                }
            };
            let events = std::mem::take(&mut input.events).into_iter();
            let events = events.map(|event| {
                let is_taken = is_taken(&event);
                (event, is_taken)
            });
            let events: Vec<_> = events.collect();
            let left = events.iter().filter(|(_, is_taken)| !is_taken);
            input.events = left.map(|(event, _)| event.clone()).collect();
            self.events = events;
        });
    }

    /// True for a key with Ctrl that goes down and is the window's.
    fn is_ours_with_ctrl(&self, event: &Event) -> bool {
        let Event::Key { modifiers, .. } = event else {
            return false;
        };
        let Some((shortcut, true, _)) = pressed(event, *modifiers).filter(|(key, ..)| key.ctrl)
        else {
            return false;
        };
        let action = Action::of_shortcut(shortcut);
        action.is_some_and(|action| is_ours(shortcut, action, self.owner, self.had_dialog))
    }

    /// When everything is drawn: the keys that were taken before and those that nothing consumed are to act, in the
    /// order in which they came.
    pub fn collect(&mut self, ctx: &egui::Context) {
        self.was_typing = ctx.text_edit_focused();
        self.n_before_press = 0;
        ctx.input(|input| {
            self.held = input.modifiers;
            let mut left = input.events.iter().peekable();
            for (event, is_taken) in self.events.drain(..) {
                let is_press = presses(&event);
                if is_taken || left.next_if_eq(&&event).is_some() {
                    self.keys.push_back(event);
                }
                if is_press {
                    self.n_before_press = self.keys.len();
                }
            }
            self.keys.extend(left.cloned());
        });
    }

    /// What the panels asked for is done: where a button closed the dialog or question over the window, the keys that
    /// came after that are the window's.
    pub fn uncover(&mut self, state: &AppState, has_question: bool) {
        let was_covered = self.had_dialog || self.owner == KeyOwner::Question;
        let is_covered = state.view.dialog.is_some() || has_question;
        self.n_covered = (was_covered && !is_covered).then_some(self.n_before_press);
    }

    /// The command of the next key that has one. It is applied before the one after it is asked for: a slow frame
    /// takes several keys together, and each means what those before it have made of the state.
    pub fn next(&mut self, ctx: &egui::Context, state: &AppState) -> Option<Command> {
        if let Some(command) = self.then.take() {
            return Some(command);
        }
        while let Some(event) = self.keys.pop_front() {
            match &mut self.n_covered {
                Some(0) => {
                    self.had_dialog = false;
                    self.owner = KeyOwner::Window;
                }
                Some(n_covered) => *n_covered -= 1,
                None => {}
            }
            if self.is_moving(state)
                && let Some(input) = modal_input(&event)
            {
                return Some(MoveCommand::Input(input).into());
            }
            let has_dialog = self.had_dialog || state.view.dialog.is_some();
            let asked = of_event(&event, self.held, self.owner, has_dialog, state);
            let Some((command, then)) = asked else {
                continue;
            };
            self.then = then;
            self.had_dialog = false;
            if self.owner == KeyOwner::Popup {
                egui::Popup::close_all(ctx);
                self.owner = KeyOwner::Window;
            }
            if matches!(
                command,
                Command::View(ViewCommand::SetDialog(Some(Dialog::Palette)))
            ) {
                // The rest is meant for the search that opens.
                palette::begin_with(ctx, self.keys.make_contiguous());
                self.keys.clear();
            }
            return Some(command);
        }
        None
    }

    /// What opens now has the keys that are left.
    pub fn give_up(&mut self) {
        self.keys.clear();
    }

    /// Whether keys go to a move by keys.
    fn is_moving(&self, state: &AppState) -> bool {
        let has_dialog = self.had_dialog || state.view.dialog.is_some();
        state.moving.tool.is_some() && self.owner == KeyOwner::Window && !has_dialog
    }
}

/// What a key asks for, and what follows it.
fn of_event(
    event: &Event,
    held: Modifiers,
    owner: KeyOwner,
    has_dialog: bool,
    state: &AppState,
) -> Option<(Command, Option<Command>)> {
    let (shortcut, is_pressed, is_repeat) = pressed(event, held)?;
    let action = Action::of_shortcut(shortcut)?;
    if is_pressed && !is_ours(shortcut, action, owner, has_dialog) {
        return None;
    }
    let alone = |command| (command, None);
    let mode = action.row().keys.mode;
    let is_possible = action.enabled(state).is_ok();
    if mode == KeyMode::WhileHeld && (is_possible || !is_pressed) {
        let is_new = is_pressed != state.view.is_blinking;
        return is_new.then(|| alone(ViewCommand::SetBlinking(is_pressed).into()));
    }
    if !is_pressed || (is_repeat && mode != KeyMode::Repeats) {
        return None;
    }
    match action.enabled(state) {
        Err(reason) if SAY_WHY.contains(&action) => {
            let why = NoticeCommand::Explain(reason.to_string()).into();
            // The section that the reason points to.
            let is_map = action == Action::MapOrCancel && state.document.both().is_some();
            let open = is_map.then(|| ViewCommand::OpenSection(Section::Map, true).into());
            Some((why, open))
        }
        _ => action.command(state).map(alone),
    }
}

/// True for the end of a click and for the keys that press the button with the keyboard.
fn presses(event: &Event) -> bool {
    match event {
        Event::PointerButton { pressed, .. } => !pressed,
        Event::Key { key, pressed, .. } => {
            *pressed && matches!(key, egui::Key::Enter | egui::Key::Space)
        }
        _ => false,
    }
}

/// True if a key that goes down is the window's.
fn is_ours(shortcut: Shortcut, action: Action, owner: KeyOwner, has_dialog: bool) -> bool {
    if has_dialog && !WITH_DIALOG.contains(&action) {
        return false;
    }
    match owner {
        KeyOwner::Question => false,
        // It is closed for them; the other keys walk through it or are typed in it.
        KeyOwner::Popup => shortcut.ctrl && shortcut.works_in_text(),
        // The field of a dialog leaves Escape to the dialog.
        KeyOwner::TextField => shortcut.works_in_text() || (has_dialog && action == Action::Escape),
        KeyOwner::Window => true,
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
            let info = action.row();
            for shortcut in info.keys.shortcuts {
                let name = shortcut.key.name();
                let key = egui::Key::from_name(&name).unwrap_or_else(|| panic!("no key {name}"));
                assert_eq!(our_key(key), Some(shortcut.key), "{name}");
            }
        }
    }

    #[test]
    fn keys_belong_to_what_is_open() {
        let is_ours = |action: Action, owner, has_dialog| {
            let shortcut = action.row().shortcut().expect("a key");
            is_ours(shortcut, action, owner, has_dialog)
        };
        let (escape, search, move_over) = (Action::Escape, Action::Palette, Action::ToggleMoveOver);
        for action in [escape, search, move_over] {
            assert!(is_ours(action, KeyOwner::Window, false));
            assert!(!is_ours(action, KeyOwner::Question, false));
        }
        // A menu keeps its own keys and is closed by those with Ctrl.
        assert!(!is_ours(escape, KeyOwner::Popup, false));
        assert!(!is_ours(move_over, KeyOwner::Popup, false));
        assert!(is_ours(search, KeyOwner::Popup, false));
        assert!(!is_ours(Action::MatchOrStop, KeyOwner::Popup, true));
        assert!(is_ours(search, KeyOwner::TextField, false));
        assert!(!is_ours(escape, KeyOwner::TextField, false));
        assert!(!is_ours(move_over, KeyOwner::TextField, false));
        // Under a dialog the window keeps still; the dialog itself can be closed or changed.
        assert!(is_ours(escape, KeyOwner::TextField, true));
        assert!(is_ours(search, KeyOwner::Window, true));
        assert!(!is_ours(move_over, KeyOwner::Window, true));
        assert!(!is_ours(Action::MatchOrStop, KeyOwner::TextField, true));
    }

    #[test]
    fn digits_go_by_place_and_plus_by_sign() {
        let french_one = shortcut(egui::Key::Quote, Some(egui::Key::Num1), Modifiers::NONE);
        assert_eq!(french_one, Some(Shortcut::plain(Key::Digit(1))));
        let plus = shortcut(egui::Key::Plus, None, Modifiers::COMMAND | Modifiers::SHIFT);
        assert_eq!(plus, Some(Shortcut::ctrl(Key::Plus)));
    }
}
