//! The rounds of the search: all starts on few points, the best distinct ones on more.

use rayon::prelude::*;

use super::candidate::{BothSigns, Candidate, DataChoice, Pairing};
use crate::monitor::Cancelled;
use crate::registration::icp::{
    Data, PairWith, Run, Stage, StageInput, StageRules, Termination, advance,
};
use crate::registration::observer::MatchMonitor;
use crate::registration::result::StartOutcome;
use crate::registration::settings::MatchSettings;
use crate::registration::subsample::{all_nodes, subsample};
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// Some iterations of the coarse stage at whose end only the better candidates go on.
struct Round {
    n_iterations: usize,
    /// Fraction of the coarse stage's points in use: far from the pose a few determine as much as many,
    /// and queries from far away are the expensive ones.
    points: f64,
    /// Fraction of the candidates that goes on.
    keep: f64,
    /// At least so many go on.
    least: usize,
    /// True if the grid will do, where there is one.
    on_grid: bool,
}

/// So many candidates go through the coarse stage whatever their scores are.
pub(crate) const FEWEST_KEPT: usize = 4;

/// The coarse stage of the usual starts, and of those that a preselection has left.
const ROUNDS: [Round; 3] = [
    Round {
        n_iterations: 5,
        points: 0.5,
        keep: 0.5,
        least: 10,
        on_grid: true,
    },
    Round {
        n_iterations: 5,
        points: 1.0,
        keep: 0.5,
        least: 6,
        on_grid: true,
    },
    Round {
        n_iterations: 10,
        points: 1.0,
        keep: 0.5,
        least: FEWEST_KEPT,
        on_grid: false,
    },
];
/// From this many starts on a preselection comes first, so that a wide search costs about as much
/// as a narrow one.
const MANY_STARTS: usize = 40;
/// The round that comes first with many starts.
const PRESELECTION: Round = Round {
    n_iterations: 4,
    points: 0.3,
    keep: 0.25,
    least: 24,
    on_grid: true,
};
/// A candidate whose score is this many times the best one's is dropped at the end of a round.
const CLEARLY_BEHIND: f64 = 8.0;
/// Iterations of the refinement after each of which candidates that are clearly behind are dropped.
const PRUNE_AFTER: usize = 10;
/// A candidate is refined no further if it would still score so many times as much as the best one when it
/// went on gaining to the end as it does now: another pose that does is no near alternative.
const WITHIN_SIGHT: f64 = 1.5;
/// Nor if its score rose by this share since the last look: it slides along a part that does not hold it,
/// away from the best pose it had.
const SLIDES_OFF: f64 = 0.01;
/// Nor, but for the best one, if its score fell by less than this share: it slides or turns as the surfaces leave it
/// free to, and ten more steps change as little.
const LITTLE_GAIN: f64 = 0.01;
/// Iterations of a closer look at candidates that do not resemble the model.
const LOOK_ITERATIONS: usize = 20;

/// What all candidates of a round are advanced on.
#[derive(Clone, Copy)]
struct RoundInput<'a> {
    points: &'a BothSigns,
    model: &'a Surface,
    rules: &'a StageRules,
    grid: Option<&'a FeatureGrid>,
}

/// How many candidates go on, and after how many iterations in all.
#[derive(Clone, Copy)]
struct Cut {
    keep: usize,
    after: usize,
}

/// Runs all candidates on few points, dropping and merging after each round.
pub(crate) fn run_coarse(
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    settings: &MatchSettings,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = choice.coarse;
    let rules = choice.rules(Stage::Coarse, settings, choice.coarse);
    let preselection = (candidates.len() >= MANY_STARTS).then_some(PRESELECTION);
    let grid = choice.grid.as_deref();
    let grid = grid.filter(|_| settings.pair_with == PairWith::Triangle);
    let mut in_use: Option<((f64, bool), BothSigns)> = None;
    let mut done = 0;
    for round in preselection.iter().chain(&ROUNDS) {
        monitor.phase(rules.stage.name());
        done += round.n_iterations;
        let on_grid = round.on_grid && grid.is_some();
        let key = (round.points, on_grid);
        let unchanged = in_use.take().filter(|(last, _)| *last == key);
        let points = match unchanged {
            Some(points) => points,
            None => {
                // Scores and pairs of other points do not carry over.
                for candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
                    candidate.run.enter_stage();
                }
                let n_points = (round.points * settings.n_coarse_points as f64).ceil() as usize;
                let points = subsample(data, n_points, monitor.monitor)?;
                (key, BothSigns::new(Data::new(points)))
            }
        };
        let (_, points) = in_use.insert(points);
        let input = RoundInput {
            points,
            model,
            rules: &rules,
            grid: grid.filter(|_| on_grid),
        };
        advance_all(choice, candidates, input, round.n_iterations, monitor)?;
        let n_alive = candidates.iter().filter(|c| c.is_alive()).count();
        let keep = ((n_alive as f64 * round.keep).ceil() as usize).max(round.least);
        merge(choice, candidates, monitor);
        prune(choice, candidates, Cut { keep, after: done }, monitor);
    }
    Ok(())
}

/// True if the best candidate has shapes that may be those of one part.
pub(crate) fn resembles(choice: &DataChoice<'_>, candidates: &[Candidate]) -> bool {
    let best = ranking(candidates).first().copied();
    best.is_none_or(|best| choice.resembles(&candidates[best].run))
}

/// How far candidates are refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Depth {
    /// On the few points of the coarse stage: where no candidate resembles the model this shows whether a right
    /// pose is among them that the coarse stage did not reach, and of different parts no more is worth knowing.
    Look,
    /// On more points, to the end.
    Whole,
}

/// Runs the best `n_distinct` candidates on the fine meshes; the rest is dropped.
pub(crate) fn refine(
    depth: Depth,
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    n_distinct: usize,
    settings: &MatchSettings,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = choice.fine;
    let n_coarse = candidates.iter().map(|c| c.run.records.len()).max();
    let n_coarse = n_coarse.unwrap_or(0);
    let cut = |after| Cut {
        keep: n_distinct,
        after,
    };
    // Late starts may have met earlier ones, which must not take the place of other poses.
    merge(choice, candidates, monitor);
    prune(choice, candidates, cut(n_coarse), monitor);
    let rules = choice.rules(Stage::Refine, settings, choice.fine);
    let (n_points, most) = match depth {
        Depth::Look => (settings.n_coarse_points, LOOK_ITERATIONS),
        Depth::Whole => (settings.n_refine_points, rules.max_iterations),
    };
    let points = subsample(data, n_points, monitor.monitor)?;
    let points = BothSigns::new(Data::new(points));
    let input = RoundInput {
        points: &points,
        model,
        rules: &rules,
        grid: None,
    };
    enter_stage(candidates, input, monitor);
    let most = most.min(rules.max_iterations);
    let mut done = 0;
    while done < most {
        let n_iterations = PRUNE_AFTER.min(most - done);
        advance_all(choice, candidates, input, n_iterations, monitor)?;
        done += n_iterations;
        merge(choice, candidates, monitor);
        prune(choice, candidates, cut(n_coarse + done), monitor);
        end_without_gain(candidates, most - done);
    }
    Ok(())
}

/// Runs every candidate on all points of the coarse meshes to its end, first with a wide basin.
pub(crate) fn run_every_start(
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    settings: &MatchSettings,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = choice.coarse;
    let points = BothSigns::new(Data::new(all_nodes(data)));
    for stage in [Stage::WideBasin, Stage::Converge] {
        let rules = choice.rules(stage, settings, choice.coarse);
        let input = RoundInput {
            points: &points,
            model,
            rules: &rules,
            grid: None,
        };
        enter_stage(candidates, input, monitor);
        advance_all(choice, candidates, input, rules.max_iterations, monitor)?;
    }
    merge(choice, candidates, monitor);
    Ok(())
}

/// Scores and pairs of another stage do not carry over; poses do.
fn enter_stage(candidates: &mut [Candidate], input: RoundInput<'_>, monitor: &MatchMonitor<'_>) {
    monitor.phase(input.rules.stage.name());
    for candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
        candidate.run.enter_stage();
    }
}

/// Continues all that are alive, in parallel; none knows of the others.
fn advance_all(
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    input: RoundInput<'_>,
    n_iterations: usize,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    candidates
        .par_iter_mut()
        .filter(|candidate| candidate.is_alive())
        .try_for_each(|candidate| {
            let stage_input = StageInput {
                data: input.points.get(candidate.start.flipped),
                model: input.model,
                rules: input.rules,
                frames: &choice.frames,
                grid: input.grid,
            };
            advance(&mut candidate.run, &stage_input, n_iterations, monitor)
        })?;
    for candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
        if has_failed(&candidate.run) {
            candidate.end(StartOutcome::Failed, choice, monitor);
        }
    }
    Ok(())
}

fn has_failed(run: &Run) -> bool {
    let no_pairs = run.termination == Some(Termination::NoPairs);
    no_pairs || !run.score.is_finite()
}

/// Indices of those alive, best score first; equal scores in order of the starts.
pub(crate) fn ranking(candidates: &[Candidate]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..candidates.len())
        .filter(|&i| candidates[i].is_alive())
        .collect();
    order.sort_by(|&a, &b| {
        let (x, y) = (&candidates[a].run.score, &candidates[b].run.score);
        x.total_cmp(y).then(a.cmp(&b))
    });
    order
}

/// Lets the best go on that are not clearly behind.
fn prune(
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    cut: Cut,
    monitor: &MatchMonitor<'_>,
) {
    let order = ranking(candidates);
    let Some(&first) = order.first() else {
        return;
    };
    let limit = CLEARLY_BEHIND * candidates[first].run.score;
    let dropped = StartOutcome::Dropped { after: cut.after };
    for (rank, i) in order.into_iter().enumerate() {
        if rank >= cut.keep || (rank > 0 && candidates[i].run.score > limit) {
            candidates[i].end(dropped, choice, monitor);
        }
    }
}

/// Drops what scores worse than an alternative that is worth refining, however many go on.
pub(crate) fn drop_behind(
    choice: &DataChoice<'_>,
    candidates: &mut [Candidate],
    monitor: &MatchMonitor<'_>,
) {
    merge(choice, candidates, monitor);
    let order = ranking(candidates);
    let Some(&first) = order.first() else {
        return;
    };
    let limit = WITHIN_SIGHT * candidates[first].run.score;
    for i in order {
        if candidates[i].run.score > limit {
            let after = candidates[i].run.records.len();
            candidates[i].end(StartOutcome::Dropped { after }, choice, monitor);
        }
    }
}

/// Ends the runs that more iterations would not help, of which `n_left` are left.
fn end_without_gain(candidates: &mut [Candidate], n_left: usize) {
    let Some(&best) = ranking(candidates).first() else {
        return;
    };
    let limit = WITHIN_SIGHT * candidates[best].run.score;
    let alive = candidates.iter_mut().enumerate();
    for (i, candidate) in alive.filter(|(_, candidate)| candidate.is_alive()) {
        let run = &mut candidate.run;
        let Some(gain) = run.gain(PRUNE_AFTER - 1) else {
            continue;
        };
        let slides_off = gain < -SLIDES_OFF * run.score;
        let gains_little = i != best && gain < LITTLE_GAIN * run.score;
        let could_gain = gain.max(0.0) * n_left as f64 / PRUNE_AFTER as f64;
        let is_behind = run.score - could_gain > limit;
        if run.termination.is_none() && (slides_off || gains_little || is_behind) {
            run.end_at_best();
        }
    }
}

/// Of those that met in one pose only the best goes on.
fn merge(choice: &DataChoice<'_>, candidates: &mut [Candidate], monitor: &MatchMonitor<'_>) {
    let order = ranking(candidates);
    for (rank, &i) in order.iter().enumerate() {
        let better = order[..rank].iter().copied().find(|&j| {
            let (a, b) = (&candidates[j], &candidates[i]);
            a.is_alive() && choice.is_same(&a.run.model_from_data, &b.run.model_from_data)
        });
        if let Some(better) = better {
            let start = candidates[better].run.start_idx;
            candidates[i].end(StartOutcome::MergedInto { start }, choice, monitor);
        }
    }
}
