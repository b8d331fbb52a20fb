//! Iterative closest point from one first pose.
//!
//! Each iteration of a run pairs every data point with the model ([`correspondence`]), drops pairs
//! that cannot count ([`reject`]), keeps some of the rest ([`select`]), and moves the data by a
//! step of the [`metric`], which [`solve`] finds, until [`termination`]. What a stage of the match
//! allows in each of these is in [`stages`].

mod correspondence;
mod iterate;
mod metric;
mod reject;
mod select;
mod solve;
mod stages;
mod termination;

pub use correspondence::PairWith;
pub(super) use correspondence::{Correspondence, MatchRules, Sample, correspond};
pub(super) use iterate::{Data, Frames, Run, StageInput, advance, orthonormal};
pub use metric::Metric;
pub use reject::RejectRules;
pub use select::{Floor, PairSelection};
pub(super) use select::{SelectRules, select};
pub use stages::Stage;
pub(super) use stages::{StageRules, edge_length, natural_floor, stage_rules};
pub use termination::Termination;
