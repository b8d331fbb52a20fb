//! Which of several parts of a crash model the stamped part belongs to: each is matched alone.

use std::sync::Arc;

use super::PipelineError;
use super::load::{LoadedPart, prepare};
use super::match_parts::{MatchRecipe, MatchRun, match_parts};
use crate::assess::Verdict;
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::role::PerRole;

/// A choice of crash parts with its match.
#[derive(Debug, Clone)]
pub struct Found {
    /// The crash model with these parts chosen.
    pub part: LoadedPart,
    /// The match of the stamped part on them.
    pub run: MatchRun,
}

/// The crash part with the likeliest of its parts chosen, where one of them alone gives a better match than
/// a poor one.
///
/// `ids` are the parts to try, the likeliest first: the first good match ends the search, and of two that fit
/// equally well the first is taken. A stop request ends it with the best so far. Fails only when cancelled.
pub fn race(
    parts: PerRole<&LoadedPart>,
    ids: &[u64],
    recipe: &MatchRecipe,
    current: &Similarity,
    monitor: &Monitor,
) -> Result<Option<LoadedPart>, PipelineError> {
    let mut best: Option<Found> = None;
    for (n_done, &id) in (0_u64..).zip(ids) {
        if monitor.stop_requested() {
            break;
        }
        monitor.progress("parts", n_done, Some(ids.len() as u64));
        let Some(found) = alone(parts, Selection::Parts(vec![id]), recipe, current, monitor)?
        else {
            continue;
        };
        let is_better = best.as_ref().is_none_or(|best| found.is_before(best));
        match found.run.assessment.verdict {
            Verdict::Good => return Ok(Some(found.part)),
            Verdict::Check if is_better => best = Some(found),
            Verdict::Check | Verdict::Poor => {}
        }
    }
    Ok(best.map(|found| found.part))
}

impl Found {
    /// True if this match lies closer than another.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        let [one, other] = [self, other].map(|found| found.run.assessment.coverage.rmse());
        one < other
    }
}

/// The match of the stamped part on some parts of the crash model. Parts that cannot be matched are none
/// to choose. Fails only when cancelled.
pub(super) fn alone(
    parts: PerRole<&LoadedPart>,
    selection: Selection,
    recipe: &MatchRecipe,
    current: &Similarity,
    monitor: &Monitor,
) -> Result<Option<Found>, PipelineError> {
    let mut settings = parts.crash.settings.clone();
    settings.selection = selection;
    let model = Arc::clone(&parts.crash.model);
    let part = prepare(&parts.crash.path, model, &settings, monitor);
    let Some(part) = unless_cancelled(part)? else {
        return Ok(None);
    };
    let pair = PerRole {
        crash: &part,
        stamped: parts.stamped,
    };
    let run = match_parts(pair, None, recipe, current, monitor);
    Ok(unless_cancelled(run)?.map(|run| Found { part, run }))
}

fn unless_cancelled<T>(result: Result<T, PipelineError>) -> Result<Option<T>, PipelineError> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) if error.is_cancelled() => Err(error),
        Err(_) => Ok(None),
    }
}
