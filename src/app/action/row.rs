//! One row per action: all that menus, keys, help sheet and command search know about it.

use super::{Action, Key, Menu, Shortcut};
use crate::app::{AppState, Command};

/// Why an action is not possible now, as a sentence: "Load both parts first."
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reason(pub &'static str);

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

/// When the keys of an action act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyMode {
    /// Once, when the key goes down.
    OnPress,
    /// Again while the key stays down.
    Repeats,
    /// The action lasts while the key is down.
    WhileHeld,
}

/// The keys of an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keys {
    /// The first is the one that menus and tooltips show; empty if the action has no key.
    pub shortcuts: &'static [Shortcut],
    /// When they act.
    pub mode: KeyMode,
}

impl Keys {
    /// The action has no key.
    pub const NONE: Self = Self::press(&[]);

    /// Keys that act once, when they go down.
    pub const fn press(shortcuts: &'static [Shortcut]) -> Self {
        Self {
            shortcuts,
            mode: KeyMode::OnPress,
        }
    }

    /// Keys that act again while they stay down.
    pub const fn repeat(shortcuts: &'static [Shortcut]) -> Self {
        Self {
            shortcuts,
            mode: KeyMode::Repeats,
        }
    }

    /// Keys that act while they stay down.
    pub const fn hold(shortcuts: &'static [Shortcut]) -> Self {
        Self {
            shortcuts,
            mode: KeyMode::WhileHeld,
        }
    }
}

/// One action of the table.
#[derive(Debug)]
pub struct ActionRow {
    /// The action this row describes.
    pub action: Action,
    /// Name in menus and search, in sentence case; "…" where more input follows.
    pub label: &'static str,
    /// What it does, in a sentence without a full stop.
    pub tooltip: &'static str,
    /// Keys that trigger it, the one shown first in front.
    pub keys: Keys,
    /// `Ok` if it is possible now, else why it is not.
    pub enabled: fn(&AppState) -> Result<(), Reason>,
    /// The command it stands for now. Asked only where `enabled` says `Ok`.
    pub command: fn(&AppState) -> Option<Command>,
}

impl ActionRow {
    /// The key that menus and tooltips show.
    pub fn shortcut(&self) -> Option<Shortcut> {
        self.keys.shortcuts.first().copied()
    }

    /// All its keys as people read them, if it has any: "Ctrl+Enter, F5".
    pub fn key_text(&self) -> Option<String> {
        let keys = self.keys.shortcuts.iter().map(Shortcut::to_string);
        let keys: Vec<String> = keys.collect();
        (!keys.is_empty()).then(|| keys.join(", "))
    }
}

/// Rows of a menu that belong together; a line stands between two groups.
#[derive(Debug)]
pub struct MenuGroup {
    /// The name of the submenu they stand in, if not in the menu itself.
    pub submenu: Option<&'static str>,
    /// The rows, from top to bottom.
    pub rows: &'static [ActionRow],
}

impl MenuGroup {
    /// Rows in the menu itself.
    pub(super) const fn plain(rows: &'static [ActionRow]) -> Self {
        Self {
            submenu: None,
            rows,
        }
    }

    /// Rows in a submenu.
    pub(super) const fn submenu(name: &'static str, rows: &'static [ActionRow]) -> Self {
        Self {
            submenu: Some(name),
            rows,
        }
    }
}

/// The row of each action with its menu, found while compiling: an action without a row, or with two, does
/// not compile.
pub(super) static TABLE: [(Menu, &ActionRow); Action::ALL.len()] = table();

const fn table() -> [(Menu, &'static ActionRow); Action::ALL.len()] {
    let mut found: [Option<(Menu, &ActionRow)>; Action::ALL.len()] = [None; Action::ALL.len()];
    let mut m = 0;
    while m < Menu::ALL.len() {
        let groups = Menu::ALL[m].groups();
        let mut g = 0;
        while g < groups.len() {
            let rows = groups[g].rows;
            let mut r = 0;
            while r < rows.len() {
                let at = rows[r].action as usize;
                assert!(found[at].is_none(), "an action has two rows");
                found[at] = Some((Menu::ALL[m], &rows[r]));
                r += 1;
            }
            g += 1;
        }
        m += 1;
    }
    let Some(first) = found[0] else {
        panic!("the first action has no row");
    };
    let mut all = [first; Action::ALL.len()];
    let mut a = 0;
    while a < all.len() {
        match found[a] {
            Some(row) => all[a] = row,
            None => panic!("an action has no row"),
        }
        a += 1;
    }
    all
}

/// Short names for the keys in the rows.
pub(super) mod keys {
    use super::{Key, Shortcut};

    pub(in super::super) const fn key(letter: char) -> Shortcut {
        Shortcut::plain(Key::Letter(letter))
    }

    pub(in super::super) const fn shift(letter: char) -> Shortcut {
        Shortcut::shift(Key::Letter(letter))
    }

    pub(in super::super) const fn ctrl(letter: char) -> Shortcut {
        Shortcut::ctrl(Key::Letter(letter))
    }

    pub(in super::super) const fn ctrl_shift(letter: char) -> Shortcut {
        Shortcut::ctrl_shift(Key::Letter(letter))
    }

    pub(in super::super) const fn digit(number: u8) -> Shortcut {
        Shortcut::plain(Key::Digit(number))
    }

    pub(in super::super) const fn ctrl_digit(number: u8) -> Shortcut {
        Shortcut::ctrl(Key::Digit(number))
    }

    pub(in super::super) const fn function(number: u8) -> Shortcut {
        Shortcut::plain(Key::Function(number))
    }
}

/// A command as a row gives it.
#[expect(
    clippy::unnecessary_wraps,
    reason = "the rows whose command can be missing share the type"
)]
pub(super) fn some(command: impl Into<Command>) -> Option<Command> {
    Some(command.into())
}
