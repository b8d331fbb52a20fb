//! Tests above the glass floor: pictures on the software driver, then panels. One binary.

mod panels;
mod render;
mod story;
mod viewport;
