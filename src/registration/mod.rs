//! Finds the motion that lays the source mesh on the target mesh.
//!
//! [`umeyama`] solves paired points in closed form. Everything else is an iteration with three
//! separate choices: what a point is paired with ([`PairWith`]), which pairs are kept
//! ([`Selection`]) and what is minimised ([`Metric`], [`Motion`]). ICP, Trimmed ICP and Fractional
//! ICP are such choices; [`Method`] names them. Because each run ends in a local minimum, many
//! first poses ([`starts`]) race on few points; the best distinct ones are refined, compared from
//! both sides, and the winner is finished on the full meshes ([`match_surfaces`]).

mod compare;
mod correspondence;
mod error;
mod holes;
mod icp;
mod metric;
mod multi_start;
mod outcome;
mod point_pairs;
mod problem;
mod reject;
mod result;
mod search;
mod select;
mod settings;
mod stages;
pub mod starts;
mod surface;
mod termination;
mod umeyama;
mod units;

use std::time::Instant;

pub use correspondence::PairWith;
pub use error::RegistrationError;
pub use metric::Metric;
pub use point_pairs::{PairDoubt, PointPairFit, fit_point_pairs};
pub use reject::RejectRules;
pub use result::{
    Alternative, Fate, IterationRecord, MatchOutcome, MatchTimings, MirrorCheck, Side, StartRecord,
};
pub use select::{Floor, Selection};
pub use settings::{DataSide, Hand, MatchSettings, Method, Search};
pub use starts::{StartKind, StartMethod, StartSettings, align_surface_normals};
pub use surface::{Measures, Surface};
pub use termination::Termination;
pub use umeyama::{Motion, PairFit, umeyama};
pub use units::{ScaleCheck, UNIT_FACTORS, UnitGuess, guess_unit};

use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use search::Contest;

/// The surfaces of a match.
#[derive(Clone, Copy)]
pub struct MatchInput<'a> {
    /// The moving part.
    pub source: &'a Surface,
    /// The fixed part.
    pub target: &'a Surface,
    /// Reduced meshes of source and target for the search; without them it thins the full ones.
    pub reduced: Option<(&'a Surface, &'a Surface)>,
}

/// [`match_surfaces`] for bare meshes, which it prepares first.
pub fn match_meshes(
    source: &TriMesh,
    target: &TriMesh,
    settings: &MatchSettings,
    monitor: &Monitor,
) -> Result<MatchOutcome, RegistrationError> {
    let (source, target) = rayon::join(
        || Surface::new(source, "source"),
        || Surface::new(target, "target"),
    );
    let input = MatchInput {
        source: &source?,
        target: &target?,
        reduced: None,
    };
    match_surfaces(&input, settings, monitor)
}

/// Finds the pose of `input.source` on `input.target`.
///
/// A stop request ends every stage early and keeps the best pose; a cancel request ends with
/// [`RegistrationError::Cancelled`]. The result depends on meshes and settings alone, not on the
/// number of threads. Cost: about half a million closest-point queries with the default settings.
pub fn match_surfaces(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
    monitor: &Monitor,
) -> Result<MatchOutcome, RegistrationError> {
    let begin = Instant::now();
    settings.check()?;
    if settings.method == Method::Umeyama {
        return outcome::closed_form(input, settings);
    }
    let mirrored = match settings.hand {
        Hand::Same => None,
        Hand::Mirrored | Hand::Either => Some(Mirrored::of(input)?),
    };
    let mut contests = Vec::new();
    if settings.hand != Hand::Mirrored {
        let mut contest = Contest::new(*input, settings, None, 0);
        contest.run(monitor)?;
        contests.push(contest);
    }
    if let Some(mirrored) = &mirrored {
        let n_before = contests.first().map_or(0, Contest::n_starts);
        let mirror = Some(Similarity::mirror_x());
        let mut contest = Contest::new(mirrored.input(input), settings, mirror, n_before);
        contest.run(monitor)?;
        contests.push(contest);
    }
    if !contests.iter().any(Contest::convinces) {
        for contest in &mut contests {
            contest.widen(monitor)?;
        }
    }
    outcome::decide(input, settings, contests, monitor).map(|mut outcome| {
        outcome.timings.total = begin.elapsed();
        outcome
    })
}

/// The source mirrored, prepared like the original.
struct Mirrored {
    source: Surface,
    reduced: Option<Surface>,
}

impl Mirrored {
    fn of(input: &MatchInput<'_>) -> Result<Self, RegistrationError> {
        let mirror = Similarity::mirror_x();
        let turned =
            |surface: &Surface| Surface::new(&surface.mesh().transformed(&mirror), "source");
        Ok(Self {
            source: turned(input.source)?,
            reduced: input
                .reduced
                .map(|(source, _)| turned(source))
                .transpose()?,
        })
    }

    fn input<'a>(&'a self, original: &MatchInput<'a>) -> MatchInput<'a> {
        MatchInput {
            source: &self.source,
            target: original.target,
            reduced: self.reduced.as_ref().zip(original.reduced.map(|(_, t)| t)),
        }
    }
}
