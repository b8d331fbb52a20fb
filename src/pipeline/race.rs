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
    let mut best: Option<(LoadedPart, MatchRun)> = None;
    for (n_done, &id) in (0_u64..).zip(ids) {
        if monitor.stop_requested() {
            break;
        }
        monitor.progress("parts", n_done, Some(ids.len() as u64));
        let mut settings = parts.crash.settings.clone();
        settings.selection = Selection::Parts(vec![id]);
        let model = Arc::clone(&parts.crash.model);
        let alone = prepare(&parts.crash.path, model, &settings, monitor);
        let Some(alone) = unless_cancelled(alone)? else {
            continue;
        };
        let pair = PerRole {
            crash: &alone,
            stamped: parts.stamped,
        };
        let run = match_parts(pair, None, recipe, current, monitor);
        let Some(run) = unless_cancelled(run)? else {
            continue;
        };
        let is_better = best.as_ref().is_none_or(|(_, best)| is_before(&run, best));
        match run.assessment.verdict {
            Verdict::Good => return Ok(Some(alone)),
            Verdict::Check if is_better => best = Some((alone, run)),
            Verdict::Check | Verdict::Poor => {}
        }
    }
    Ok(best.map(|(part, _)| part))
}

/// A part that cannot be matched is none to choose.
fn unless_cancelled<T>(result: Result<T, PipelineError>) -> Result<Option<T>, PipelineError> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) if error.is_cancelled() => Err(error),
        Err(_) => Ok(None),
    }
}

/// True if the first match lies closer.
fn is_before(one: &MatchRun, other: &MatchRun) -> bool {
    let [one, other] = [one, other].map(|run| run.assessment.coverage.rmse());
    one < other
}
