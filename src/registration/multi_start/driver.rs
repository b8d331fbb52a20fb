//! The search for one hand of the source, from first poses to ranked candidates.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use super::all_pairs::{left_pairs_out, with_all_pairs};
use super::candidate::{Candidate, DataChoice, Pairing};
use super::rounds::{
    Depth, FEWEST_KEPT, drop_behind, ranking, refine, resembles, run_coarse, run_every_start,
};
use super::score::{PoseScorer, TwoSided};
use super::sizes::{
    incompatible_settings, last_stage_swaps, natural_data_side, sizes_incompatible,
};
use super::starts::{Start, StartMethod, starts};
use super::turns::turns;
use super::variations::{mirror_images, twins};
use super::wide_starts::WideStarts;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::RegistrationError;
use crate::registration::icp::{
    Data, Floor, Frames, PairSelection, Run, Stage, StageInput, advance, edge_length, natural_floor,
};
use crate::registration::input::MatchInput;
use crate::registration::observer::MatchMonitor;
use crate::registration::result::{Side, StartOutcome};
use crate::registration::settings::{DataSide, MatchSettings, Search};
use crate::registration::subsample::subsample;
use crate::registration::surface::Surface;

/// Distinct poses that are refined and compared.
const N_DISTINCT: usize = 4;
/// A pose is acceptable if its kept pairs lie within this many floors …
const ACCEPTABLE_RMSE: f64 = 2.5;
/// … and make up this fraction of the data.
const ACCEPTABLE_FRACTION: f64 = 0.7;
/// Where less of what could be covered is kept, the opposite hand is tried too.
const CONFIDENT_FRACTION: f64 = 0.85;
/// Mirror images that score so much worse than the winner after the coarse stage are not refined: a
/// part that is nearly its own mirror image comes within a factor of a few.
const CLEARLY_WORSE: f64 = 8.0;
/// Deviation of a reduced mesh from the sheet, as a fraction of its mean edge length. The car floor
/// measures 0.01 from 10,000 down to 500 triangles.
const REDUCED_ERROR: f64 = 0.02;
/// Below this kept fraction the data overhangs, and the other mesh's points are tried as well.
const OVERHANG: f64 = 0.9;
/// Where the wide search brings the poses near, exact partners are looked for within this share of the
/// smaller part's diagonal, which bounds the time of a question.
const REACH: f64 = 0.1;
/// Nodes that the winner is refined on, all where there are no more: the mean of so many has an error far
/// below what the meshes know.
const N_FULL_POINTS: usize = 150_000;
/// Poses of the opposite hand that are looked at, of those that survive the wide search.
const N_OPPOSITE: usize = 3;

/// The search for one hand of the source: its choices of data and model with their candidates.
pub(crate) struct MultiStart<'a> {
    input: MatchInput<'a>,
    settings: Cow<'a, MatchSettings>,
    mirror: Option<Similarity>,
    pub(crate) choices: Vec<(DataChoice<'a>, Vec<Candidate>)>,
    /// Poses whose twins were tried, with the choice they are of.
    asked: Vec<(usize, Similarity)>,
    scorer: PoseScorer<'a>,
    wide: Option<WideStarts<'a>>,
    /// Points farther away than this find no partner.
    reach: f64,
    pub(crate) timings: SearchTimings,
}

/// How long the phases of one search took.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SearchTimings {
    pub(crate) align: Duration,
    pub(crate) coarse: Duration,
    pub(crate) refine: Duration,
}

/// Numbers the starts of a match from 0, whichever search they belong to.
#[derive(Debug, Default)]
pub(crate) struct StartNumbers(usize);

impl StartNumbers {
    fn next(&mut self) -> usize {
        self.0 += 1;
        self.0 - 1
    }
}

/// A pose that reached the last comparison.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RankedCandidate {
    /// Index of its choice of data and model.
    pub(crate) choice: usize,
    /// Its index there.
    pub(crate) candidate: usize,
    pub(crate) target_from_source: Similarity,
    pub(crate) scores: TwoSided,
}

/// The winner after its last stage.
pub(crate) struct Refined {
    pub(crate) target_from_source: Similarity,
    pub(crate) run: Run,
    pub(crate) data_side: Side,
    pub(crate) floor: f64,
    /// Where pairs were left out, where keeping all of them leads from there.
    pub(crate) with_all_pairs: Option<Similarity>,
}

impl<'a> MultiStart<'a> {
    /// `input` holds the source already mirrored where `mirror` says so.
    pub(crate) fn new(
        input: MatchInput<'a>,
        settings: &'a MatchSettings,
        mirror: Option<Similarity>,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let (source, target) = (input.source, input.target);
        let diagonal = |surface: &Surface| surface.measures().diagonal;
        let smaller = diagonal(source).min(diagonal(target));
        let is_incompatible = sizes_incompatible(source, target);
        let is_wide = settings.starts.wide_search
            && settings.search == Search::CoarseToFine
            && !is_incompatible;
        let reach = match (is_incompatible, is_wide) {
            (true, _) => smaller,
            (_, true) => REACH * smaller,
            _ => f64::INFINITY,
        };
        let wide = is_wide.then(|| WideStarts::of(&input)).flatten();
        let larger = wide.as_ref().and_then(WideStarts::larger);
        monitor.check()?;
        let allowance = settings.allowance;
        Ok(Self {
            scorer: PoseScorer::new([source, target], allowance, (reach, larger), monitor)?,
            settings: if is_incompatible {
                Cow::Owned(incompatible_settings(settings))
            } else {
                Cow::Borrowed(settings)
            },
            wide,
            reach: if is_wide { reach } else { f64::INFINITY },
            input,
            mirror,
            choices: Vec::new(),
            asked: Vec::new(),
            timings: SearchTimings::default(),
        })
    }

    /// Runs the starts and what survives the wide search, and the other choice of data where the data
    /// overhangs.
    pub(crate) fn run(
        &mut self,
        numbers: &mut StartNumbers,
        monitor: &MatchMonitor<'_>,
    ) -> Result<(), RegistrationError> {
        let begin = Instant::now();
        let mut first = starts(self.input.source, self.input.target, &self.settings.starts)?;
        let poses_are_given = self.poses_are_given();
        let mut again = first.clone();
        if let Some(wide) = self.wide.as_ref().filter(|_| !poses_are_given) {
            again = wide.find(monitor.monitor)?;
            first.extend(&again);
        }
        self.timings.align += begin.elapsed();
        let side = self.data_side();
        self.add_choice(side);
        self.run_starts(0, &first, numbers, monitor)?;
        let swaps = self.settings.data_side == DataSide::Auto
            && self.settings.search == Search::CoarseToFine
            && !self.sizes_incompatible()
            && self.best_fraction(0) < OVERHANG;
        if swaps {
            self.add_choice(side.other());
            self.run_starts(1, &again, numbers, monitor)?;
        }
        Ok(self.try_twins_of_winner(numbers, monitor)?)
    }

    /// Tries poses in which parts that look alike from several sides fit as well as in the winner's, where they
    /// were made of another pose.
    fn try_twins_of_winner(
        &mut self,
        numbers: &mut StartNumbers,
        monitor: &MatchMonitor<'_>,
    ) -> Result<(), Cancelled> {
        let begin = Instant::now();
        let Some(winner) = self.ranked_candidates().into_iter().next() else {
            return Ok(());
        };
        let settings = &*self.settings;
        let (choice, candidates) = &mut self.choices[winner.choice];
        let winning = &candidates[winner.candidate];
        let was_asked = self.asked.iter().any(|(of_choice, pose)| {
            *of_choice == winner.choice && choice.is_same(pose, &winning.run.model_from_data)
        });
        if was_asked || settings.search == Search::EveryStart {
            return Ok(());
        }
        let near = alike(choice, winning, self.wide.as_ref(), monitor.monitor)?;
        let mut late = enter(choice, &near, numbers, monitor);
        run_coarse(choice, &mut late, settings, monitor)?;
        let n_late = late.len();
        refine(Depth::Whole, choice, &mut late, n_late, settings, monitor)?;
        candidates.extend(late);
        self.timings.refine += begin.elapsed();
        Ok(())
    }

    /// Runs what survives the wide search, for when no given pose is acceptable.
    pub(crate) fn run_wide_search(
        &mut self,
        numbers: &mut StartNumbers,
        monitor: &MatchMonitor<'_>,
    ) -> Result<(), RegistrationError> {
        let poses_are_given = self.poses_are_given();
        let wide = self.wide.as_ref().filter(|_| poses_are_given);
        let Some(wide) = wide.filter(|_| !monitor.stop_requested()) else {
            return Ok(());
        };
        let begin = Instant::now();
        let found = wide.find(monitor.monitor)?;
        self.timings.align += begin.elapsed();
        Ok(self.run_starts(0, &found, numbers, monitor)?)
    }

    fn poses_are_given(&self) -> bool {
        let method = self.settings.starts.method;
        matches!(method, StartMethod::CurrentPose | StartMethod::GivenPoses)
    }

    /// True if no pose can be worth much because the sizes are too different.
    pub(crate) fn sizes_incompatible(&self) -> bool {
        sizes_incompatible(self.input.source, self.input.target)
    }

    fn data_side(&self) -> Side {
        match self.settings.data_side {
            DataSide::Source => Side::Source,
            DataSide::Target => Side::Target,
            DataSide::Auto => natural_data_side(self.input.source, self.input.target),
        }
    }

    fn add_choice(&mut self, side: Side) {
        let in_roles = |source, target| match side {
            Side::Source => Pairing {
                data: source,
                model: target,
            },
            Side::Target => Pairing {
                data: target,
                model: source,
            },
        };
        let full = in_roles(self.input.source, self.input.target);
        let grid = self.wide.as_mut().and_then(|wide| wide.grid(side.other()));
        let coarse = self.input.reduced.map_or(full, |(s, t)| in_roles(s, t));
        let choice = DataChoice {
            coarse,
            fine: if self.settings.refine_on_full {
                full
            } else {
                coarse
            },
            frames: Frames {
                data_side: side,
                mirror: self.mirror.unwrap_or_default(),
            },
            mirrored: self.mirror.is_some(),
            is_estimated: self.input.reduced.is_none()
                && grid.is_some()
                && expects_anything(&self.settings),
            grid,
            reach: self.reach,
            deviation: 0.0,
        };
        self.choices.push((choice, Vec::new()));
    }

    /// Runs `starts` with one choice of data, from the coarse stage to the refinement.
    fn run_starts(
        &mut self,
        choice_idx: usize,
        starts: &[Start],
        numbers: &mut StartNumbers,
        monitor: &MatchMonitor<'_>,
    ) -> Result<(), Cancelled> {
        let begin = Instant::now();
        let settings = &*self.settings;
        let (choice, done) = &mut self.choices[choice_idx];
        let mut candidates = enter(choice, starts, numbers, monitor);
        if settings.search == Search::EveryStart {
            run_every_start(choice, &mut candidates, settings, monitor)?;
            self.timings.coarse += begin.elapsed();
            done.extend(candidates);
            return Ok(());
        }
        run_coarse(choice, &mut candidates, settings, monitor)?;
        let deepen = |depth, choice: &DataChoice<'_>, candidates: &mut [Candidate], n_distinct| {
            refine(depth, choice, candidates, n_distinct, settings, monitor)
        };
        let mut n_distinct = N_DISTINCT;
        // A part that is nearly symmetric has a twin pose close by which no other start need reach.
        if let Some(&best) = ranking(&candidates).first() {
            let best = &candidates[best];
            self.asked.push((choice_idx, best.run.model_from_data));
            let near = alike(choice, best, self.wide.as_ref(), monitor.monitor)?;
            let turned = turns(choice, best, monitor.monitor)?;
            let mut late = enter(choice, &near, numbers, monitor);
            run_coarse(choice, &mut late, settings, monitor)?;
            candidates.extend(late);
            // They score alike, so that none may leave for want of room.
            for few in turned.chunks(FEWEST_KEPT) {
                let mut turned = enter(choice, few, numbers, monitor);
                run_coarse(choice, &mut turned, settings, monitor)?;
                candidates.extend(turned);
            }
            if !turned.is_empty() {
                drop_behind(choice, &mut candidates, monitor);
                n_distinct = n_distinct.max(ranking(&candidates).len());
            }
        }
        if let Some(&best) = ranking(&candidates).first() {
            choice.expect_as(&candidates[best].run);
        }
        self.timings.coarse += begin.elapsed();
        let begin = Instant::now();
        if !resembles(choice, &candidates) {
            deepen(Depth::Look, choice, &mut candidates, n_distinct)?;
            if let Some(&best) = ranking(&candidates).first() {
                choice.expect_as(&candidates[best].run);
            }
        }
        if resembles(choice, &candidates) {
            deepen(Depth::Whole, choice, &mut candidates, n_distinct)?;
        }
        self.timings.refine += begin.elapsed();
        done.extend(candidates);
        Ok(())
    }

    /// True if the pose was compared with all others that the wide search and the larger part's own
    /// likeness offer.
    pub(crate) fn has_sought_rivals(&self) -> bool {
        self.wide.is_some() && !self.poses_are_given()
    }

    fn best_fraction(&self, choice_idx: usize) -> f64 {
        let (_, candidates) = &self.choices[choice_idx];
        ranking(candidates)
            .first()
            .map_or(0.0, |&i| candidates[i].run.fraction)
    }

    /// True if the best pose leaves so little to explain that the opposite hand need not be tried.
    pub(crate) fn is_confident(&self) -> bool {
        let floor = natural_floor(self.input.source, self.input.target) + self.settings.allowance;
        self.choices.iter().any(|(choice, candidates)| {
            let Pairing { data, model } = choice.fine;
            let bound = (model.measures().area / data.measures().area).min(1.0);
            ranking(candidates).first().is_some_and(|&i| {
                let run = &candidates[i].run;
                run.rmse <= floor && run.fraction >= CONFIDENT_FRACTION * bound
            })
        })
    }

    /// True if a pose has a fair part of the data within a few floors of the model.
    pub(crate) fn is_acceptable(&self) -> bool {
        let limit = ACCEPTABLE_RMSE * self.expected_error() + self.settings.allowance;
        self.choices.iter().any(|(_, candidates)| {
            ranking(candidates).first().is_some_and(|&i| {
                let run = &candidates[i].run;
                run.rmse <= limit && run.fraction >= ACCEPTABLE_FRACTION
            })
        })
    }

    /// How far the searched meshes lie apart when perfectly placed. Two reductions of one sheet
    /// put their vertices at different places, so they differ by more than their own facets do from the sheet.
    fn expected_error(&self) -> f64 {
        match self.input.reduced {
            None => natural_floor(self.input.source, self.input.target),
            Some((source, target)) => {
                natural_floor(source, target).max(REDUCED_ERROR * edge_length(source, target))
            }
        }
    }

    /// Score of the opposite hand over that of `winner`, and its pose: a part that is nearly its own mirror image fits
    /// well with the wrong hand, and only the comparison decides. The hand is looked for where the mirror
    /// images of the winner lie and, unless the winner `is_confident`, by the wide search. `None` if it
    /// found no pose.
    pub(crate) fn opposite_hand(
        &self,
        winner: &RankedCandidate,
        is_confident: bool,
        monitor: &MatchMonitor<'_>,
    ) -> Result<Option<(f64, Similarity)>, Cancelled> {
        let (choice, candidates) = &self.choices[winner.choice];
        let mut starts = mirror_images(choice, &candidates[winner.candidate]);
        if let Some(wide) = self.wide.as_ref().filter(|_| !is_confident) {
            let found = wide.find_opposite(monitor.monitor)?;
            starts.extend(found.into_iter().take(N_OPPOSITE));
        }
        let candidate = |start: &Start| Candidate::new(choice, *start, 0);
        let mut images: Vec<Candidate> = starts.iter().map(candidate).collect();
        run_coarse(choice, &mut images, &self.settings, monitor)?;
        let best = |images: &[Candidate]| {
            let best = *ranking(images).first()?;
            let (pose, scores) = self.score(choice, &images[best]);
            Some((scores.score() / winner.scores.score(), pose))
        };
        let coarse = best(&images);
        if coarse.is_none_or(|(ratio, _)| ratio > CLEARLY_WORSE) {
            return Ok(coarse);
        }
        if !resembles(choice, &images) {
            refine(Depth::Look, choice, &mut images, 1, &self.settings, monitor)?;
        }
        if resembles(choice, &images) {
            refine(
                Depth::Whole,
                choice,
                &mut images,
                1,
                &self.settings,
                monitor,
            )?;
        }
        Ok(best(&images))
    }

    /// The pose of a candidate and its scores.
    fn score(&self, choice: &DataChoice<'_>, candidate: &Candidate) -> (Similarity, TwoSided) {
        let pose = choice
            .frames
            .target_from_source(&candidate.run.model_from_data);
        // The scorer holds the source as it was searched with, mirrored or not.
        let searched = pose.after(&choice.frames.mirror.inverse());
        let scores = self.scorer.score(&searched, candidate.start.flipped);
        (pose, scores)
    }

    /// All that are alive, best first by the two-sided score, without those that met.
    pub(crate) fn ranked_candidates(&self) -> Vec<RankedCandidate> {
        let mut found = Vec::new();
        for (choice_idx, (choice, candidates)) in self.choices.iter().enumerate() {
            for candidate_idx in ranking(candidates) {
                let (pose, scores) = self.score(choice, &candidates[candidate_idx]);
                found.push(RankedCandidate {
                    choice: choice_idx,
                    candidate: candidate_idx,
                    target_from_source: pose,
                    scores,
                });
            }
        }
        found.sort_by(|a, b| a.scores.score().total_cmp(&b.scores.score()));
        found
    }

    /// Runs the winner on the nodes of the full meshes, if the settings ask for it.
    pub(crate) fn refine_winner(
        &mut self,
        winner: &RankedCandidate,
        monitor: &MatchMonitor<'_>,
    ) -> Result<Refined, Cancelled> {
        let (choice, candidates) = &mut self.choices[winner.choice];
        let candidate = &mut candidates[winner.candidate];
        candidate.end(StartOutcome::Won, choice, monitor);
        let flipped = candidate.start.flipped;
        if !self.settings.refine_on_full {
            let rules = choice.rules(Stage::Refine, &self.settings, choice.fine);
            return Ok(Refined {
                target_from_source: winner.target_from_source,
                run: candidate.run.clone(),
                data_side: choice.data_side(),
                floor: rules.selection.floor,
                with_all_pairs: None,
            });
        }
        let swaps = self.settings.data_side == DataSide::Auto && last_stage_swaps(choice.fine);
        let (pairing, mut frames) = (choice.fine, choice.frames);
        let pairing = if swaps {
            frames.data_side = frames.data_side.other();
            pairing.swapped()
        } else {
            pairing
        };
        let rules = choice.rules(Stage::Full, &self.settings, pairing);
        // Different parts have no pose that more points would make exact.
        let n_points = if choice.resembles(&candidate.run) {
            N_FULL_POINTS
        } else {
            self.settings.n_refine_points
        };
        let mut points = Data::new(subsample(pairing.data, n_points, monitor.monitor)?);
        if flipped {
            points = points.flipped();
        }
        let run = &mut candidate.run;
        run.enter_stage();
        if swaps {
            run.model_from_data = run.model_from_data.inverse();
        }
        monitor.phase(rules.stage.name());
        let input = StageInput {
            data: &points,
            model: pairing.model,
            rules: &rules,
            frames: &frames,
            grid: None,
        };
        advance(run, &input, rules.max_iterations, monitor)?;
        let all = if left_pairs_out(run, &rules) && !monitor.stop_requested() {
            let n_points = self.settings.n_refine_points;
            let mut few = Data::new(subsample(pairing.data, n_points, monitor.monitor)?);
            if flipped {
                few = few.flipped();
            }
            Some(with_all_pairs(
                run,
                &StageInput {
                    data: &few,
                    ..input
                },
                monitor.monitor,
            )?)
        } else {
            None
        };
        let refined = Refined {
            target_from_source: frames.target_from_source(&run.model_from_data),
            run: run.clone(),
            data_side: frames.data_side,
            floor: rules.selection.floor,
            with_all_pairs: all.map(|pose| frames.target_from_source(&pose)),
        };
        // The record of the start keeps the roles it was run in.
        if swaps {
            run.model_from_data = run.model_from_data.inverse();
        }
        Ok(refined)
    }
}

/// The starts as candidates.
fn enter(
    choice: &DataChoice<'_>,
    starts: &[Start],
    numbers: &mut StartNumbers,
    monitor: &MatchMonitor<'_>,
) -> Vec<Candidate> {
    let new = starts.iter().map(|start| {
        let candidate = Candidate::new(choice, *start, numbers.next());
        candidate.report(choice, monitor);
        candidate
    });
    new.collect()
}

/// Poses in which parts that fit as `best` says fit too if they look alike from several sides.
fn alike(
    choice: &DataChoice<'_>,
    best: &Candidate,
    wide: Option<&WideStarts>,
    monitor: &Monitor,
) -> Result<Vec<Start>, Cancelled> {
    let mut near = twins(choice, best);
    if let Some(wide) = wide {
        near.extend(wide.alike(&best.as_start(choice), monitor)?);
    }
    Ok(near)
}

/// True if the deviation of the shapes is for the match to find out.
fn expects_anything(settings: &MatchSettings) -> bool {
    match settings.selection {
        PairSelection::Fractional { floor, .. } => floor == Floor::Auto,
        PairSelection::TrimmedSearch => true,
        PairSelection::All | PairSelection::Trimmed { .. } => false,
    }
}
