//! Shape matching for stamped sheet parts: finds the pose that lays the part of a stamping
//! simulation on the same part of a crash model.
//!
//! The product of a match is `target_from_source`, the similarity of
//! `crash = c · R · stamped + t` in column vectors. The modules, from the ground up:
//!
//! - [`monitor`]: progress, stop and cancel.
//! - [`units`]: units of length, unit systems, and what a file says of its own.
//! - [`geometry`]: points, meshes, topology, poses, the camera.
//! - [`colormap`]: colour maps and scales.
//! - [`formats`]: LS-DYNA keyword decks, STL, OBJ, PLY.
//! - [`simplify`]: quadric error simplification.
//! - [`search`]: closest points and rays on triangle meshes.
//! - [`registration`]: Umeyama, ICP, Trimmed ICP, Fractional ICP, and the race of many starts.
//! - [`assess`]: is the pose right? Coverage, ambiguity, free motions, verdict.
//! - [`samples`]: generated pairs of sheet parts with a known pose.
//! - [`report`]: the matrix in all its forms, LS-DYNA cards, the record of a run.
//! - [`pipeline`]: load, reduce, match, export, as one call each.
//! - [`jobs`]: the worker thread of the window: stop, cancel, events.
//! - [`app`]: the window without the window: state, commands, undo.
//! - `ui` (feature `gui`): the window; draws the state, emits commands.
//! - `render` (feature `gui`): scenes into pictures with wgpu.
//!
//! `ARCHITECTURE.md` says who may use whom.

pub mod app;
pub mod assess;
pub mod cli;
pub mod colormap;
pub mod formats;
pub mod geometry;
pub mod jobs;
pub mod monitor;
pub mod pipeline;
pub mod registration;
#[cfg(feature = "gui")]
pub mod render;
pub mod report;
pub mod samples;
pub mod search;
pub mod simplify;
#[cfg(feature = "gui")]
pub mod ui;
pub mod units;
