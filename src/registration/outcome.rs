use std::time::Instant;

use super::compare::TwoSided;
use super::icp::Run;
use super::result::{
    Alternative, Fate, MatchOutcome, MatchTimings, MirrorCheck, Side, StartRecord,
};
use super::search::{Contender, Contest, Finished};
use super::settings::{Hand, MatchSettings};
use super::starts::StartKind;
use super::surface::Surface;
use super::termination::Termination;
use super::umeyama::{Motion, PairFit, fit_pairs, umeyama};
use super::units::ScaleCheck;
use super::{MatchInput, Mirrored, RegistrationError};
use crate::geometry::{Point3, Similarity};
use crate::monitor::Monitor;

/// Alternatives that are worse than this are not worth showing.
const WORTH_SHOWING: f64 = 5.0;

/// Compares what the contests found, finishes the best pose and writes the outcome.
pub(super) fn decide(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
    mut contests: Vec<Contest<'_>>,
    monitor: &Monitor,
) -> Result<MatchOutcome, RegistrationError> {
    let ranked = rank(&contests);
    let &(home, winner) = ranked.first().ok_or(RegistrationError::NoPairs)?;
    let certain = contests[home].is_certain();
    let begin = Instant::now();
    let finished = contests[home].finish(&winner, monitor)?;
    let finish = begin.elapsed();
    let is_told = settings.hand == Hand::Either || contests[home].is_hopeless();
    let mirror_ratio = if is_told || monitor.stop_requested() {
        None
    } else if certain || settings.hand == Hand::Mirrored {
        contests[home].mirror_ratio(&winner, &monitor.without_observer())?
    } else {
        opposite_hand(input, settings, &winner.scores, monitor)?
    };
    let Finished {
        target_from_source,
        run,
        data_side,
        flipped,
        floor,
    } = finished;
    let alternatives = alternatives(input, &ranked, &target_from_source, &contests);
    let pairs = fit_kept(&run);
    let (p95, max) = run.spread();
    let (starts, mut timings) = tell(contests);
    timings.finish = finish;
    let pair_scale = pairs.map_or(1.0, |fit| match data_side {
        Side::Source => fit.scale,
        Side::Target => 1.0 / fit.scale,
    });
    let pair_scale = pair_scale * target_from_source.scale;
    Ok(MatchOutcome {
        target_from_source,
        termination: run.termination.unwrap_or(Termination::MaxIterations),
        rmse: run.rmse,
        p95,
        max,
        fraction: run.fraction,
        data_side,
        normals_opposed: flipped,
        objective: run.score,
        floor,
        alternatives,
        winner: run.start_idx,
        starts,
        scale_check: ScaleCheck::new(input.source, input.target, pair_scale),
        mirror_check: MirrorCheck {
            mirrored_rmse: pairs.map_or(run.rmse, |fit| fit.mirrored_rmse),
            score_ratio: mirror_ratio,
        },
        timings,
    })
}

/// The last comparison over all contests, best first, with the index of the contest.
fn rank(contests: &[Contest<'_>]) -> Vec<(usize, Contender)> {
    let mut ranked: Vec<(usize, Contender)> = contests
        .iter()
        .enumerate()
        .flat_map(|(i, contest)| contest.contenders().into_iter().map(move |c| (i, c)))
        .collect();
    ranked.sort_by(|a, b| a.1.scores.score().total_cmp(&b.1.scores.score()));
    ranked
}

/// Poses other than the result, each once.
fn alternatives(
    input: &MatchInput<'_>,
    ranked: &[(usize, Contender)],
    result: &Similarity,
    contests: &[Contest<'_>],
) -> Vec<Alternative> {
    let measures = input.source.measures();
    let center: [Point3; 1] = [measures.centroid];
    let is_same = |a: &Similarity, b: &Similarity| {
        a.is_mirrored() == b.is_mirrored()
            && a.angle_to(b) < 3.0_f64.to_radians()
            && a.max_displacement(b, &center) < 0.02 * measures.diagonal * b.scale
    };
    let mut found: Vec<Alternative> = Vec::new();
    let best = ranked[0].1.scores;
    for (contest, contender) in ranked {
        let pose = contender.target_from_source;
        let score_ratio = best.ratio_of(&contender.scores);
        let known =
            is_same(&pose, result) || found.iter().any(|a| is_same(&a.target_from_source, &pose));
        if known || score_ratio > WORTH_SHOWING {
            continue;
        }
        let (_, entrants) = &contests[*contest].legs[contender.leg];
        found.push(Alternative {
            target_from_source: pose,
            score_ratio,
            start: entrants[contender.entrant].run.start_idx,
        });
    }
    found.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    found
}

/// Score of the mirrored source relative to `best`; `None` if it found no pose.
fn opposite_hand(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
    best: &TwoSided,
    monitor: &Monitor,
) -> Result<Option<f64>, RegistrationError> {
    let mirrored = Mirrored::of(input)?;
    // What the mirrored part does is not part of the story of this match.
    let quiet = monitor.without_observer();
    let mirror = Some(Similarity::mirror_x());
    let mut contest = Contest::new(mirrored.input(input), settings, mirror, 0);
    contest.run(&quiet)?;
    let found = contest.contenders();
    Ok(found.first().map(|c| c.scores.score() / best.score()))
}

/// The records of all starts in order of their numbers, and the summed times.
fn tell(contests: Vec<Contest<'_>>) -> (Vec<StartRecord>, MatchTimings) {
    let mut timings = MatchTimings::default();
    let mut starts = Vec::new();
    for contest in contests {
        timings.align += contest.align;
        timings.race += contest.race;
        timings.refine += contest.refine;
        for (leg, entrants) in contest.legs {
            let records = entrants
                .into_iter()
                .map(|entrant| (entrant.run.start_idx, entrant.into_record(&leg)));
            starts.extend(records);
        }
    }
    starts.sort_by_key(|(idx, _)| *idx);
    let starts = starts.into_iter().map(|(_, record)| record).collect();
    (starts, timings)
}

/// The closed-form fit of the kept pairs with free scale, a check on units and hand.
fn fit_kept(run: &Run) -> Option<PairFit> {
    let pairs = run
        .kept_pairs()
        .map(|pair| (&pair.moved, &pair.matched, pair.weight));
    // The rigid fit gives the mirrored rmse in comparable form and tells the best scale as well.
    fit_pairs(pairs, Motion::Rigid).ok()
}

/// Meshes with the same nodes in the same order: Umeyama's solution over all nodes.
pub(super) fn closed_form(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
) -> Result<MatchOutcome, RegistrationError> {
    let begin = Instant::now();
    let source = input.source.nodes_as_given();
    let target = input.target.nodes_as_given();
    let fit = umeyama(&source, &target, None, settings.motion)?;
    let mirrored = match settings.hand {
        Hand::Same => false,
        Hand::Mirrored => true,
        Hand::Either => fit.mirrored_rmse < fit.rmse,
    };
    let (target_from_source, rmse) = if mirrored {
        (fit.mirrored, fit.mirrored_rmse)
    } else {
        (fit.target_from_source, fit.rmse)
    };
    let mut distances: Vec<f64> = source
        .iter()
        .zip(&target)
        .map(|(x, y)| (target_from_source.apply(x) - y).norm())
        .collect();
    distances.sort_by(f64::total_cmp);
    let max = distances.last().copied().unwrap_or(0.0);
    let p95 = distances
        .get(distances.len() * 95 / 100)
        .copied()
        .unwrap_or(max);
    Ok(MatchOutcome {
        target_from_source,
        termination: Termination::ClosedForm,
        rmse,
        p95,
        max,
        fraction: 1.0,
        data_side: Side::Source,
        normals_opposed: opposed(input, &target_from_source),
        objective: rmse,
        floor: 0.0,
        alternatives: Vec::new(),
        winner: 0,
        starts: vec![StartRecord {
            kind: StartKind::CurrentPose,
            flipped: false,
            mirrored,
            data_side: Side::Source,
            first: Similarity::identity(),
            last: target_from_source,
            iterations: Vec::new(),
            score: rmse,
            p95,
            took: begin.elapsed(),
            termination: Some(Termination::ClosedForm),
            fate: Fate::Won,
        }],
        scale_check: ScaleCheck::new(input.source, input.target, fit.scale),
        mirror_check: MirrorCheck {
            mirrored_rmse: fit.mirrored_rmse,
            score_ratio: None,
        },
        timings: MatchTimings {
            total: begin.elapsed(),
            ..MatchTimings::default()
        },
    })
}

/// True if the mean normals point to opposite sides under the pose.
fn opposed(input: &MatchInput<'_>, target_from_source: &Similarity) -> bool {
    let normal = |surface: &Surface| surface.measures().mean_normal;
    target_from_source
        .rotate(&normal(input.source))
        .dot(&normal(input.target))
        < 0.0
}
