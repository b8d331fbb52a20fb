//! Shape matching for stamped sheet parts: finds the pose that aligns the part of a stamping
//! simulation with the same part of a crash model.
//!
//! The product of a match is `target_from_source`, the similarity of
//! `crash = c · R · stamped + t` in column vectors. *The paper* is "A Shape-Matching Algorithm for deep
//! drawing applications", on the diploma thesis of Markus Brüchele, supervised by Uli Göhner at the
//! University of Applied Sciences Kempten.
//!
//! The modules, from the ground up:
//!
//! - [`monitor`]: progress, stop and cancel.
//! - [`role`]: crash part and stamped part, and one value for each.
//! - [`units`]: units of length, unit systems, and what a file says of its own.
//! - [`text`]: counts, lengths and sentences as people read them.
//! - [`geometry`]: points, meshes, topology, poses, the camera.
//! - [`colormap`]: colour maps and scales.
//! - [`palette`]: colours that mean the same everywhere.
//! - [`formats`]: LS-DYNA keyword decks, STL, OBJ, PLY.
//! - [`simplify`]: quadric error simplification.
//! - [`search`]: closest points and rays on triangle meshes.
//! - [`registration`]: Umeyama, ICP, Trimmed ICP, Fractional ICP, and the search from many starts.
//! - [`mapping`]: forming results from the stamped shells onto the crash shells.
//! - [`assess`]: is the pose right? Coverage, ambiguity, free motions, verdict.
//! - [`settling`]: the last steps of a match, which choose and move the pose that is assessed.
//! - [`settings`]: the settings of match and mapping by name, one row each.
//! - [`samples`]: generated pairs of sheet parts with a known pose.
//! - [`report`]: the matrix in all its forms, LS-DYNA cards, the record of a run.
//! - [`pipeline`]: load, find parts, reduce, match, map, export and measure, as one call each.
//! - [`jobs`]: the worker thread of the window: stop, cancel, events.
//! - [`app`]: what the window knows and does, by topic, without drawing it: state, commands, undo.
//! - `ui` (feature `gui`): the window; draws the state, emits commands.
//! - `render` (feature `gui`): scenes into pictures with wgpu.
//! - [`cli`]: the command line.
//!
//! `ARCHITECTURE.md` says who may use whom.

pub mod monitor;
pub mod role;
pub mod text;
pub mod units;

pub mod colormap;
pub mod geometry;
pub mod palette;

pub mod formats;
pub mod search;
pub mod simplify;

pub mod mapping;
pub mod registration;
pub mod samples;

pub mod assess;
pub mod settings;
pub mod settling;

pub mod report;

pub mod pipeline;

pub mod jobs;

pub mod app;

#[cfg(feature = "gui")]
pub mod render;
#[cfg(feature = "gui")]
pub mod ui;

pub mod cli;
