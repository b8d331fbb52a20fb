//! Tests below the window: one file per module, all in one binary.

#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod app;
mod app_exports;
mod assess;
mod attempts;
mod cli;
mod deck_out;
mod deviation;
mod drawn_pan;
mod explain;
mod exports;
mod inspect;
mod jobs;
mod keyword;
mod keyword_large;
mod layering;
mod mesh_files;
mod mirrored;
mod pairs;
mod pan;
mod project;
mod registration;
mod samples;
mod search;
mod simplify;
mod simplify_rules;
mod textbook_qem;
mod tidy;
mod units;
