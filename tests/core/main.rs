//! Tests below the window: one file per module, all in one binary.

mod layering;
mod pan;
mod samples;
mod simplify;
mod tidy;
