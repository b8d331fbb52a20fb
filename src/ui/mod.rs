//! The window: panels that draw the state and queue commands, and the shell that carries them out.
//!
//! Panels have the form `fn xxx_ui(ui, state, commands)`. They hold no logic: what may be done and
//! what follows is decided in [`crate::app`], and everything numeric runs on the worker.

mod background;
pub mod dialogs;
mod file_uri;
mod focus;
pub mod gizmo;
mod help;
pub mod keyboard;
mod no_window;
pub mod overlays;
pub mod palette;
pub mod panels;
mod path_prompt;
mod picture_options;
mod pictures;
pub mod preferences;
pub mod project_dialogs;
mod row_end;
pub mod shell;
mod system_fonts;
pub mod theme;
pub mod toasts;
pub mod typed;
pub mod viewport;
pub mod widgets;

pub use background::step_back;
pub use shell::{Shell, run};
