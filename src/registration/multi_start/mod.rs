//! The search from many first poses.
//!
//! Each ICP run ends in a local minimum, so many [`starts`] run on few points in [`rounds`] that
//! keep the better ones; the best distinct ones are refined, compared from both sides
//! ([`score`]), and the winner is refined on the full meshes ([`driver`], [`outcome`]).

mod all_pairs;
mod candidate;
mod driver;
mod holes;
mod outcome;
mod rounds;
mod score;
mod sizes;
pub mod starts;
mod turns;
mod variations;
mod wide_starts;

pub(super) use driver::{MultiStart, StartNumbers};
pub(super) use outcome::decide;
