//! Tests above the glass floor: pictures on the software driver, then panels. One binary.

mod render;
mod viewport;
