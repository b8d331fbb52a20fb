//! A match from beginning to end: which searches run, and in which order.

use std::time::Instant;

use super::RegistrationError;
use super::input::{MatchInput, Mirrored};
use super::multi_start::{MultiStart, StartNumbers, decide};
use super::observer::MatchMonitor;
use super::result::MatchOutcome;
use super::same_nodes::match_same_nodes;
use super::settings::{Hand, MatchSettings, Method};
use crate::geometry::Similarity;

/// Finds the pose of `input.source` on `input.target`.
///
/// A stop request ends every stage early and keeps the best pose; a cancel request ends with
/// [`RegistrationError::Cancelled`]. The result depends on meshes and settings alone, not on the
/// number of threads. Cost: the wide search takes the same time whatever the parts are, then about half a
/// million closest-point queries follow with the default settings.
pub fn match_surfaces<'a>(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
    monitor: impl Into<MatchMonitor<'a>>,
) -> Result<MatchOutcome, RegistrationError> {
    let begin = Instant::now();
    let monitor = &monitor.into();
    settings.check()?;
    if settings.method == Method::Umeyama {
        return match_same_nodes(input, settings);
    }
    let mirrored = match settings.hand {
        Hand::Same => None,
        Hand::Mirrored | Hand::Either => Some(Mirrored::of(input, monitor.monitor)?),
    };
    let mut numbers = StartNumbers::default();
    let mut searches = Vec::new();
    if settings.hand != Hand::Mirrored {
        searches.push(MultiStart::new(*input, settings, None, monitor.monitor)?);
    }
    if let Some(mirrored) = &mirrored {
        let mirror = Some(Similarity::mirror_x());
        let input = mirrored.input(input);
        searches.push(MultiStart::new(input, settings, mirror, monitor.monitor)?);
    }
    for search in &mut searches {
        search.run(&mut numbers, monitor)?;
    }
    if !searches.iter().any(MultiStart::is_acceptable) {
        for search in &mut searches {
            search.run_wide_search(&mut numbers, monitor)?;
        }
    }
    decide(input, settings, searches, monitor).map(|mut outcome| {
        outcome.timings.total = begin.elapsed();
        outcome
    })
}
