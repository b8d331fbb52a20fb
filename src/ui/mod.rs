//! The window: draws the state, emits commands.

pub mod gizmo;
