//! The last comparison over all searches, and the outcome it gives.

use std::time::Instant;

use super::driver::{MultiStart, RankedCandidate, Refined};
use crate::geometry::Similarity;
use crate::registration::RegistrationError;
use crate::registration::agreement::same_pose;
use crate::registration::closed_form::{Motion, PairFit, fit_pairs};
use crate::registration::icp::{Run, Termination};
use crate::registration::input::MatchInput;
use crate::registration::observer::MatchMonitor;
use crate::registration::result::{
    Alternative, MatchOutcome, MatchTimings, MirrorCheck, Side, StartRecord,
};
use crate::registration::scale_check::ScaleCheck;
use crate::registration::settings::{Hand, MatchSettings};

/// Alternatives that are worse than this are not worth showing.
const WORTH_SHOWING: f64 = 5.0;

/// Compares what the searches found, refines the best pose and collects the outcome.
pub(crate) fn decide(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
    mut searches: Vec<MultiStart<'_>>,
    monitor: &MatchMonitor<'_>,
) -> Result<MatchOutcome, RegistrationError> {
    let ranked = rank(&searches);
    let &(best, winner) = ranked.first().ok_or(RegistrationError::NoPairs)?;
    let is_confident = searches[best].is_confident();
    let rivals_sought = searches[best].has_sought_rivals() && !monitor.stop_requested();
    let begin = Instant::now();
    let refined = searches[best].refine_winner(&winner, monitor)?;
    let full = begin.elapsed();
    let hand_is_known = settings.hand == Hand::Either || searches[best].sizes_incompatible();
    let opposite = if hand_is_known || monitor.stop_requested() {
        None
    } else {
        // Starts of the other hand are no starts of this match, so they are not reported.
        let unobserved = monitor.monitor.without_observer();
        searches[best].opposite_hand(&winner, is_confident, &MatchMonitor::from(&unobserved))?
    };
    let Refined {
        target_from_source,
        run,
        data_side,
        floor,
        with_all_pairs,
    } = refined;
    let alternatives = alternatives(input, &ranked, &target_from_source, &searches);
    let pairs = fit_kept(&run);
    let (starts, mut timings) = collect_records(searches);
    timings.full = full;
    let pair_scale = pairs.map_or(1.0, |fit| match data_side {
        Side::Source => fit.scale,
        Side::Target => 1.0 / fit.scale,
    });
    let pair_scale = pair_scale * target_from_source.scale;
    Ok(MatchOutcome {
        target_from_source,
        termination: run.termination.unwrap_or(Termination::MaxIterations),
        data_side,
        floor,
        alternatives,
        rivals_sought,
        with_all_pairs,
        winner: run.start_idx,
        starts,
        scale_check: ScaleCheck::new(
            [input.source, input.target],
            target_from_source.scale,
            pair_scale,
        ),
        mirror_check: MirrorCheck {
            score_ratio: opposite.map(|(ratio, _)| ratio),
            by_borders: false,
            target_from_source: opposite.map(|(_, pose)| pose),
        },
        timings,
    })
}

/// The candidates of all searches, best first, each with the index of its search.
fn rank(searches: &[MultiStart<'_>]) -> Vec<(usize, RankedCandidate)> {
    let mut ranked: Vec<(usize, RankedCandidate)> = searches
        .iter()
        .enumerate()
        .flat_map(|(i, search)| search.ranked_candidates().into_iter().map(move |c| (i, c)))
        .collect();
    ranked.sort_by(|a, b| a.1.scores.score().total_cmp(&b.1.scores.score()));
    ranked
}

/// Poses other than the result, each once.
fn alternatives(
    input: &MatchInput<'_>,
    ranked: &[(usize, RankedCandidate)],
    result: &Similarity,
    searches: &[MultiStart<'_>],
) -> Vec<Alternative> {
    let part = input.source.measures().into();
    let is_same = |a: &Similarity, b: &Similarity| same_pose(a, b, &part);
    let mut found: Vec<Alternative> = Vec::new();
    let best = ranked[0].1.scores;
    for (search, ranked) in ranked {
        let pose = ranked.target_from_source;
        let score_ratio = best.ratio_of(&ranked.scores);
        let Some(score_ratio) = score_ratio.filter(|ratio| *ratio <= WORTH_SHOWING) else {
            continue;
        };
        if is_same(&pose, result) || found.iter().any(|a| is_same(&a.target_from_source, &pose)) {
            continue;
        }
        let (_, candidates) = &searches[*search].choices[ranked.choice];
        found.push(Alternative {
            target_from_source: pose,
            score_ratio,
            by_shape: false,
            start: candidates[ranked.candidate].run.start_idx,
        });
    }
    found.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    found
}

/// The records of all starts in order of their numbers, and the summed times.
fn collect_records(searches: Vec<MultiStart<'_>>) -> (Vec<StartRecord>, MatchTimings) {
    let mut timings = MatchTimings::default();
    let mut starts = Vec::new();
    for search in searches {
        timings.align += search.timings.align;
        timings.coarse += search.timings.coarse;
        timings.refine += search.timings.refine;
        for (choice, candidates) in search.choices {
            let records = candidates
                .into_iter()
                .map(|candidate| (candidate.run.start_idx, candidate.into_record(&choice)));
            starts.extend(records);
        }
    }
    starts.sort_by_key(|(idx, _)| *idx);
    let starts = starts.into_iter().map(|(_, record)| record).collect();
    (starts, timings)
}

/// The closed-form fit of the kept pairs, whose scale is a check on units.
fn fit_kept(run: &Run) -> Option<PairFit> {
    let pairs = run
        .kept_pairs()
        .map(|pair| (&pair.moved, &pair.matched, pair.weight));
    // A rigid fit gives the best scale as well.
    fit_pairs(pairs, Motion::Rigid).ok()
}
