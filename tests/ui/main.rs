//! Tests above the UI boundary: pictures on the software driver, then panels. One binary.

#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

#[path = "../bracket.rs"]
mod bracket;
mod distance;
mod exports;
mod fills;
mod follow;
mod inspect;
mod keyboard;
mod large;
mod layout;
mod mapping;
mod mapping_walk;
mod monkey;
mod no_window;
mod pairs;
mod panels;
mod parts;
mod preferences;
mod project;
mod render;
mod shaders;
mod sheets;
mod specification;
mod starts;
mod story;
mod typed;
mod viewport;
