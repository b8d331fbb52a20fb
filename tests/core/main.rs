//! Tests below the window: one file per module, all in one binary.

#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod app;
mod app_exports;
mod app_mapping;
mod assess;
mod autosave;
mod cancel;
mod cli;
mod deck_out;
mod deviation;
mod drawn_pan;
mod explain;
mod exports;
mod files_doc;
mod foreign_files;
mod inspect;
mod jobs;
mod judging;
mod keyword;
mod keyword_faults;
mod keyword_large;
mod layering;
mod map_decks;
mod map_files;
mod mapping;
mod mapping_checks;
mod match_starts;
mod mesh_files;
mod mirrored;
mod mutated_files;
mod outputs;
mod pairs;
mod pan;
mod project;
mod registration;
mod robustness;
mod samples;
mod search;
mod simplify;
mod simplify_rules;
mod textbook_qem;
mod tidy;
mod tuning;
mod units;
mod wide_search;
