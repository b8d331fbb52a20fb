//! LS-DYNA keyword decks.
//!
//! [`block`] cuts a file into keyword blocks, [`card`] a line into fields; `nodes`, `shells` and `solids`
//! read the mesh; [`deck`] walks the tree of included files and puts the model together.
//!
//! Every reader of a keyword has the same shape: it takes a [`block::Block`], walks its
//! [`cards`](block::Block::cards), adds to what it fills and pushes a
//! [`Diagnostic`](super::diagnostic::Diagnostic) (made by [`card::Card::diagnose`] or
//! [`block::Block::diagnose`]) for what it cannot use:
//!
//! - `parameter::ParameterTable` implements [`card::Parameters`] and has `define(&mut self,
//!   &Block, &mut Diagnostics)` for every `*PARAMETER…` block, `push_scope()` and `pop_scope()`
//!   around an included file.
//! - `transform::Transformation::from_block(&Block, &mut Diagnostics) -> Option<(u64, Self)>` reads
//!   one `*DEFINE_TRANSFORMATION`; `matrix(&dyn Fn(u64) -> Option<Point3>) -> Result<Matrix4, _>`
//!   carries it out, with node positions by id.
//! - `forming` reads one `*INITIAL_STRESS_…` or `*INITIAL_STRAIN_…` block; `results` spreads what
//!   was given to sets and turns tensors with the motions of includes.

mod assemble;
pub mod block;
pub mod card;
mod chunks;
pub mod deck;
mod ends;
pub mod exchange;
mod exponential;
pub mod expression;
pub mod fixed_width;
mod forming;
pub(crate) mod include;
mod link;
pub mod materials;
mod mesh;
pub(crate) mod names;
mod nodes;
pub mod number;
pub mod parameter;
mod parameter_card;
pub mod parameter_error;
mod parts;
mod plies;
pub mod rename;
mod resolve;
mod results;
mod set_members;
mod sets;
mod shells;
mod solids;
pub mod source_file;
pub mod state_cards;
pub mod transform;
mod unit_clues;
pub mod write;
