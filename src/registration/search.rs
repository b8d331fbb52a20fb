use std::borrow::Cow;
use std::time::{Duration, Instant};

use super::compare::{Judge, TwoSided};
use super::icp::{Data, Frames, Run, advance};
use super::multi_start::{
    Entrant, Leg, Pairing, mirror_images, race, ranking, refine, run_every_start, twins,
};
use super::problem::all_nodes;
use super::result::{Fate, Side};
use super::select::Selection;
use super::settings::{DataSide, MatchSettings, Search};
use super::stages::{Stage, edge_length, natural_floor, stage_rules};
use super::starts::{Start, further_starts, patch_starts, starts};
use super::surface::Surface;
use super::{MatchInput, RegistrationError};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};

/// Distinct poses that are refined and compared.
const N_DISTINCT: usize = 4;
/// A pose convinces if its kept pairs lie within this many floors …
const CONVINCING_RMSE: f64 = 2.5;
/// … and make up this share of the data.
const CONVINCING_FRACTION: f64 = 0.7;
/// Where less of what could be covered is kept, the opposite hand is tried too.
const CERTAIN_FRACTION: f64 = 0.85;
/// Mirror images that score so much worse than the winner after the race are not refined: a part
/// that is nearly its own mirror image comes within a factor of a few.
const CLEARLY_WORSE: f64 = 8.0;
/// Deviation of a reduced mesh from the sheet, as a share of its mean edge length. The car floor
/// measures 0.01 from 10,000 down to 500 triangles.
const REDUCED_ERROR: f64 = 0.02;
/// Below this kept share the data overhangs, and the other mesh's points are tried as well.
const OVERHANG: f64 = 0.9;
/// The smaller part is laid on patches of the larger below this ratio of areas.
const PATCH_RATIO: f64 = 0.75;
/// Below this ratio of areas the units differ, and no start finds a pose worth the time.
const HOPELESS_RATIO: f64 = 0.01;
/// Points that are enough there.
const HOPELESS_POINTS: usize = 50;

/// The search for one hand of the source: legs (choices of data and model) with their entrants.
pub(crate) struct Contest<'a> {
    input: MatchInput<'a>,
    settings: Cow<'a, MatchSettings>,
    mirror: Option<Similarity>,
    pub(crate) legs: Vec<(Leg<'a>, Vec<Entrant>)>,
    judge: Judge<'a>,
    n_starts: usize,
    pub(crate) align: Duration,
    pub(crate) race: Duration,
    pub(crate) refine: Duration,
}

/// A pose that reached the last comparison.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contender {
    pub(crate) leg: usize,
    pub(crate) entrant: usize,
    pub(crate) target_from_source: Similarity,
    pub(crate) scores: TwoSided,
}

/// The winner after its last stage.
pub(crate) struct Finished {
    pub(crate) target_from_source: Similarity,
    pub(crate) run: Run,
    pub(crate) data_side: Side,
    pub(crate) flipped: bool,
    pub(crate) floor: f64,
}

impl<'a> Contest<'a> {
    /// `input` holds the source already mirrored where `mirror` says so; `n_before` starts were
    /// numbered before.
    pub(crate) fn new(
        input: MatchInput<'a>,
        settings: &'a MatchSettings,
        mirror: Option<Similarity>,
        n_before: usize,
    ) -> Self {
        let (source, target) = (input.source, input.target);
        let (reach, settings) = if is_hopeless(source, target) {
            let diagonal = |surface: &Surface| surface.measures().diagonal;
            let reach = diagonal(source).min(diagonal(target));
            (reach, Cow::Owned(hopeless_settings(settings)))
        } else {
            (f64::INFINITY, Cow::Borrowed(settings))
        };
        Self {
            judge: Judge::new(source, target, settings.allowance, reach),
            input,
            settings,
            mirror,
            legs: Vec::new(),
            n_starts: n_before,
            align: Duration::ZERO,
            race: Duration::ZERO,
            refine: Duration::ZERO,
        }
    }

    /// Runs the starts, and the other choice of data where the data overhangs.
    pub(crate) fn run(&mut self, monitor: &Monitor) -> Result<(), RegistrationError> {
        let begin = Instant::now();
        let first = starts(self.input.source, self.input.target, &self.settings.starts)?;
        self.align += begin.elapsed();
        let side = self.data_side();
        self.add_leg(side);
        self.compete(0, &first, monitor)?;
        let swaps = self.settings.data_side == DataSide::Auto
            && self.settings.search == Search::Race
            && !self.is_hopeless()
            && self.best_fraction(0) < OVERHANG;
        if swaps {
            self.add_leg(match side {
                Side::Source => Side::Target,
                Side::Target => Side::Source,
            });
            self.compete(1, &first, monitor)?;
        }
        Ok(())
    }

    /// Runs wider starts, for when nothing convinces.
    pub(crate) fn widen(&mut self, monitor: &Monitor) -> Result<(), RegistrationError> {
        let widens = self.settings.starts.widen
            && !self.is_hopeless()
            && self.settings.search == Search::Race
            && self.settings.selection != Selection::All;
        if widens && !monitor.stop_requested() {
            let begin = Instant::now();
            let (source, target) = (self.input.source, self.input.target);
            let mut wider = further_starts(source, target);
            let (a, b) = (source.measures().area, target.measures().area);
            if a.min(b) < PATCH_RATIO * a.max(b) {
                wider.extend(patch_starts(source, target, &self.settings.starts)?);
            }
            self.align += begin.elapsed();
            self.compete(0, &wider, monitor)?;
        }
        Ok(())
    }

    /// True if the sizes differ so much that the parts must be in different units or different
    /// parts. Points of the larger one would ask far away from the smaller one, which is slow and
    /// tells nothing.
    pub(crate) fn is_hopeless(&self) -> bool {
        is_hopeless(self.input.source, self.input.target)
    }

    fn data_side(&self) -> Side {
        match self.settings.data_side {
            DataSide::Source => Side::Source,
            DataSide::Target => Side::Target,
            DataSide::Auto => natural_data_side(self.input.source, self.input.target),
        }
    }

    fn add_leg(&mut self, side: Side) {
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
        let coarse = self.input.reduced.map_or(full, |(s, t)| in_roles(s, t));
        let leg = Leg {
            coarse,
            fine: if self.settings.finish { full } else { coarse },
            frames: Frames {
                data_is_target: side == Side::Target,
                mirror: self.mirror.unwrap_or_default(),
            },
            mirrored: self.mirror.is_some(),
        };
        self.legs.push((leg, Vec::new()));
    }

    fn compete(
        &mut self,
        leg_idx: usize,
        starts: &[Start],
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let begin = Instant::now();
        let settings = &*self.settings;
        let (leg, done) = &mut self.legs[leg_idx];
        let enter = |starts: &[Start], n_starts: &mut usize| -> Vec<Entrant> {
            let new = starts.iter().map(|start| {
                *n_starts += 1;
                let entrant = Entrant::new(leg, *start, *n_starts - 1);
                entrant.announce(leg, monitor);
                entrant
            });
            new.collect()
        };
        let mut entrants = enter(starts, &mut self.n_starts);
        if settings.search == Search::EveryStart {
            run_every_start(leg, &mut entrants, settings, monitor)?;
            self.race += begin.elapsed();
            done.extend(entrants);
            return Ok(());
        }
        race(leg, &mut entrants, settings, monitor)?;
        if let Some(&best) = ranking(&entrants).first() {
            let mut late = enter(&twins(leg, &entrants[best]), &mut self.n_starts);
            race(leg, &mut late, settings, monitor)?;
            entrants.extend(late);
        }
        self.race += begin.elapsed();
        let begin = Instant::now();
        refine(leg, &mut entrants, N_DISTINCT, settings, monitor)?;
        self.refine += begin.elapsed();
        done.extend(entrants);
        Ok(())
    }

    fn best_fraction(&self, leg_idx: usize) -> f64 {
        let (_, entrants) = &self.legs[leg_idx];
        ranking(entrants)
            .first()
            .map_or(0.0, |&i| entrants[i].run.fraction)
    }

    /// True if the best pose leaves so little to explain that the opposite hand need not be tried.
    pub(crate) fn is_certain(&self) -> bool {
        let floor = natural_floor(self.input.source, self.input.target) + self.settings.allowance;
        self.legs.iter().any(|(leg, entrants)| {
            let Pairing { data, model } = leg.fine;
            let bound = (model.measures().area / data.measures().area).min(1.0);
            ranking(entrants).first().is_some_and(|&i| {
                let run = &entrants[i].run;
                run.rmse <= floor && run.fraction >= CERTAIN_FRACTION * bound
            })
        })
    }

    /// Score of the best mirror image of `winner` over its own score: a part that is nearly its own
    /// mirror image fits well with the wrong hand, and only the comparison tells. `None` if no
    /// mirror image found a place.
    pub(crate) fn mirror_ratio(
        &self,
        winner: &Contender,
        monitor: &Monitor,
    ) -> Result<Option<f64>, Cancelled> {
        let (leg, entrants) = &self.legs[winner.leg];
        let images = mirror_images(leg, &entrants[winner.entrant]);
        let entrant = |start: &Start| Entrant::new(leg, *start, 0);
        let mut images: Vec<Entrant> = images.iter().map(entrant).collect();
        race(leg, &mut images, &self.settings, monitor)?;
        let best_ratio = |images: &[Entrant]| {
            ranking(images).first().map(|&i| {
                let image = &images[i];
                let pose = leg.frames.target_from_source(&image.run.model_from_data);
                let bare = pose.after(&leg.frames.mirror.inverse());
                self.judge.score(&bare, image.start.flipped).score() / winner.scores.score()
            })
        };
        let raced = best_ratio(&images);
        if raced.is_none_or(|ratio| ratio > CLEARLY_WORSE) {
            return Ok(raced);
        }
        refine(leg, &mut images, 1, &self.settings, monitor)?;
        Ok(best_ratio(&images))
    }

    /// True if a pose lays a fair share of the data within a few floors of the model.
    pub(crate) fn convinces(&self) -> bool {
        let limit = CONVINCING_RMSE * self.expected_error() + self.settings.allowance;
        self.legs.iter().any(|(_, entrants)| {
            ranking(entrants).first().is_some_and(|&i| {
                let run = &entrants[i].run;
                run.rmse <= limit && run.fraction >= CONVINCING_FRACTION
            })
        })
    }

    /// How far the searched meshes lie apart when perfectly placed. Two reductions of one sheet
    /// put their vertices at different places, so they differ by more than their own facets say.
    fn expected_error(&self) -> f64 {
        match self.input.reduced {
            None => natural_floor(self.input.source, self.input.target),
            Some((source, target)) => {
                natural_floor(source, target).max(REDUCED_ERROR * edge_length(source, target))
            }
        }
    }

    /// All that are alive, best first by the two-sided score, without those that met.
    pub(crate) fn contenders(&self) -> Vec<Contender> {
        let mut found = Vec::new();
        for (leg_idx, (leg, entrants)) in self.legs.iter().enumerate() {
            for entrant_idx in ranking(entrants) {
                let entrant = &entrants[entrant_idx];
                let pose = leg.frames.target_from_source(&entrant.run.model_from_data);
                let bare = pose.after(&leg.frames.mirror.inverse());
                found.push(Contender {
                    leg: leg_idx,
                    entrant: entrant_idx,
                    target_from_source: pose,
                    scores: self.judge.score(&bare, entrant.start.flipped),
                });
            }
        }
        found.sort_by(|a, b| a.scores.score().total_cmp(&b.scores.score()));
        found
    }

    /// Runs the winner on all points of the fine meshes.
    pub(crate) fn finish(
        &mut self,
        winner: &Contender,
        monitor: &Monitor,
    ) -> Result<Finished, Cancelled> {
        let (leg, entrants) = &mut self.legs[winner.leg];
        let entrant = &mut entrants[winner.entrant];
        entrant.end(Fate::Won, leg, monitor);
        let flipped = entrant.start.flipped;
        if !self.settings.finish {
            let rules = stage_rules(Stage::Refine, &self.settings, leg.fine.data, leg.fine.model);
            return Ok(Finished {
                target_from_source: winner.target_from_source,
                run: entrant.run.clone(),
                data_side: leg.data_side(),
                flipped,
                floor: rules.selection.floor,
            });
        }
        let swaps = self.settings.data_side == DataSide::Auto && finishes_swapped(leg.fine);
        let (pairing, mut frames) = (leg.fine, leg.frames);
        let pairing = if swaps {
            frames.data_is_target = !frames.data_is_target;
            pairing.swapped()
        } else {
            pairing
        };
        let rules = stage_rules(Stage::Finish, &self.settings, pairing.data, pairing.model);
        let mut points = Data::new(all_nodes(pairing.data, true));
        if flipped {
            points = points.flipped();
        }
        let run = &mut entrant.run;
        run.enter_stage();
        if swaps {
            run.model_from_data = run.model_from_data.inverse();
        }
        monitor.progress("finish", 0, None);
        let cap = rules.max_iterations;
        advance(run, &points, (pairing.model, &rules), cap, &frames, monitor)?;
        let finished = Finished {
            target_from_source: frames.target_from_source(&run.model_from_data),
            run: run.clone(),
            data_side: frames.data_side(),
            flipped,
            floor: rules.selection.floor,
        };
        // The story of the start is told in the roles it was run in.
        if swaps {
            run.model_from_data = run.model_from_data.inverse();
        }
        Ok(finished)
    }

    pub(crate) fn n_starts(&self) -> usize {
        self.n_starts
    }
}

/// No pose will be worth much, so a rough one is enough: in the hollow of a part a hundred times as
/// large every question takes long, because all its triangles are about equally far.
fn hopeless_settings(settings: &MatchSettings) -> MatchSettings {
    MatchSettings {
        n_race_points: settings.n_race_points.min(HOPELESS_POINTS),
        n_refine_points: settings.n_refine_points.min(HOPELESS_POINTS),
        finish: false,
        ..settings.clone()
    }
}

fn is_hopeless(source: &Surface, target: &Surface) -> bool {
    let (a, b) = (source.measures().area, target.measures().area);
    a.min(b) <= HOPELESS_RATIO * a.max(b)
}

/// The smaller mesh is the data, because it is the one that is contained; of meshes that differ by
/// less than a tenth the coarser one, because facets of the finer one are more exact.
fn natural_data_side(source: &Surface, target: &Surface) -> Side {
    let (a, b) = (source.measures(), target.measures());
    let source_is_data = if (a.area - b.area).abs() > 0.1 * a.area.max(b.area) {
        a.area < b.area
    } else {
        source.mesh().n_vertices() <= target.mesh().n_vertices()
    };
    if source_is_data {
        Side::Source
    } else {
        Side::Target
    }
}

/// True if the finish is more exact with the roles exchanged: facets of the finer mesh lie closer
/// to the smooth surface, so the coarser mesh should be the data, as long as half of it is covered.
fn finishes_swapped(pairing: Pairing<'_>) -> bool {
    let (data, model) = (pairing.data.measures(), pairing.model.measures());
    let model_is_coarser = model.mean_edge_length > 1.2 * data.mean_edge_length;
    model_is_coarser && data.area > 0.5 * model.area
}
