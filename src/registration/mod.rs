//! Finds the motion that aligns the source mesh with the target mesh.
//!
//! [`umeyama`] solves paired points in closed form. Everything else is an iteration (`icp`) with
//! three separate choices: what a point is paired with ([`PairWith`]), which pairs are kept
//! ([`PairSelection`]) and what is minimised ([`Metric`], [`Motion`]). ICP, Trimmed ICP and Fractional
//! ICP are such choices; [`Method`] names them. Because each run ends in a local minimum, many
//! first poses ([`starts`]) run on few points; the best distinct ones are refined, compared from
//! both sides, and the winner is refined on the full meshes (`multi_start`, [`match_surfaces`]).

mod agreement;
mod closed_form;
mod error;
mod icp;
mod input;
mod match_surfaces;
mod multi_start;
mod observer;
mod point_pairs;
mod result;
mod same_nodes;
mod scale_check;
mod settings;
mod subsample;
mod surface;
mod wide;

pub use agreement::{Extent, StartGroup, group_starts, same_pose};
pub(crate) use closed_form::fit_pairs;
pub use closed_form::{Motion, PairFit, umeyama};
pub use error::RegistrationError;
pub use icp::{Floor, Metric, PairSelection, PairWith, RejectRules, Stage, Termination};
pub use input::MatchInput;
pub use match_surfaces::match_surfaces;
pub use multi_start::starts;
pub(crate) use multi_start::starts::axes_on_axes;
pub use multi_start::starts::{StartKind, StartMethod, StartSettings, align_surface_normals};
pub use observer::{MatchMonitor, Observer};
pub use point_pairs::{PairDoubt, PointPairFit, fit_point_pairs};
pub use result::{
    Alternative, IterationRecord, MatchOutcome, MatchTimings, MirrorCheck, Side, StartOutcome,
    StartRecord,
};
pub use scale_check::{ScaleCheck, UnitGuess, guess_unit};
pub use settings::{DataSide, Hand, MatchSettings, Method, Search, limits};
pub(crate) use subsample::WeightedNode;
pub(crate) use surface::principal_frame;
pub use surface::{Measures, Surface};
pub(crate) use wide::is_piece;
pub use wide::{WideFind, WideSearch};
