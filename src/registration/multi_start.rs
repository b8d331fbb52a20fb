use rayon::prelude::*;

use super::icp::{Data, Frames, Run, StageRules, advance};
use super::problem::{all_nodes, thin};
use super::result::{Fate, Side, StartRecord, start_name};
use super::settings::MatchSettings;
use super::stages::{Stage, stage_rules};
use super::starts::{Start, StartKind};
use super::surface::Surface;
use super::termination::Termination;
use crate::geometry::{Point3, Similarity};
use crate::monitor::{Cancelled, Monitor, StartReport};

/// Poses closer than this in angle and centroid are one pose.
const SAME_ANGLE_DEG: f64 = 3.0;
const SAME_SHIFT: f64 = 0.02;

/// A stretch of the race at whose end only the better ones go on.
struct Heat {
    n_iterations: usize,
    /// Share of the race points that are asked: far from the pose a few say as much as many, and
    /// queries from far away are the dear ones.
    points: f64,
    /// Share of the starts that goes on.
    keep: f64,
    /// Of a small field at least so many go on.
    least: usize,
}

/// The race of the usual starts, and of those that a crowd has left.
const HEATS: [Heat; 3] = [
    Heat {
        n_iterations: 5,
        points: 0.5,
        keep: 0.5,
        least: 10,
    },
    Heat {
        n_iterations: 5,
        points: 1.0,
        keep: 0.5,
        least: 6,
    },
    Heat {
        n_iterations: 10,
        points: 1.0,
        keep: 0.5,
        least: 4,
    },
];
/// From this many starts on a qualifying heat comes first, so that a wide search costs about as
/// much as a narrow one.
const CROWD: usize = 40;
/// The heat in which a crowd qualifies.
const QUALIFYING: Heat = Heat {
    n_iterations: 4,
    points: 0.3,
    keep: 0.25,
    least: 24,
};
/// A start this much worse than the best one drops out at the end of a heat.
const HOPELESS: f64 = 8.0;

/// Iterations of the refinement after which the hopeless drop out.
const PROBATION: usize = 10;

/// The surfaces of one stage in their roles.
#[derive(Clone, Copy)]
pub(crate) struct Pairing<'a> {
    pub(crate) data: &'a Surface,
    pub(crate) model: &'a Surface,
}

impl Pairing<'_> {
    pub(crate) fn swapped(self) -> Self {
        Self {
            data: self.model,
            model: self.data,
        }
    }
}

/// One choice of hand and of data and model.
pub(crate) struct Leg<'a> {
    /// The meshes of the race.
    pub(crate) coarse: Pairing<'a>,
    /// The meshes of what follows.
    pub(crate) fine: Pairing<'a>,
    pub(crate) frames: Frames,
    pub(crate) mirrored: bool,
}

impl Leg<'_> {
    pub(crate) fn data_side(&self) -> Side {
        self.frames.data_side()
    }

    /// Turns a start (a motion of the possibly mirrored source) into a motion of the data.
    fn model_from_data(&self, start: &Start) -> Similarity {
        if self.frames.data_is_target {
            start.target_from_source.inverse()
        } else {
            start.target_from_source
        }
    }

    fn is_same(&self, a: &Similarity, b: &Similarity) -> bool {
        let measures = self.fine.data.measures();
        let center: [Point3; 1] = [measures.centroid];
        a.angle_to(b) < SAME_ANGLE_DEG.to_radians()
            && a.max_displacement(b, &center) < SAME_SHIFT * measures.diagonal
    }
}

/// A start on its way.
pub(crate) struct Entrant {
    pub(crate) start: Start,
    pub(crate) first: Similarity,
    pub(crate) run: Run,
    /// Set once it is out.
    pub(crate) fate: Option<Fate>,
    /// Score at the end of the race, for comparison with late entrants.
    pub(crate) race_score: f64,
}

impl Entrant {
    pub(crate) fn new(leg: &Leg<'_>, start: Start, start_idx: usize) -> Self {
        let pose = leg.model_from_data(&start);
        Self {
            start,
            first: leg.frames.target_from_source(&pose),
            run: Run::new(start_idx, pose),
            fate: None,
            race_score: f64::INFINITY,
        }
    }

    pub(crate) fn is_alive(&self) -> bool {
        self.fate.is_none()
    }

    /// Tells that it begins.
    pub(crate) fn announce(&self, leg: &Leg<'_>, monitor: &Monitor) {
        monitor.start(|| StartReport {
            start_idx: self.run.start_idx,
            name: start_name(
                self.start.kind,
                leg.data_side(),
                self.start.flipped,
                leg.mirrored,
            ),
            fate: self.fate,
        });
    }

    /// Takes it out of the race, and tells.
    pub(crate) fn end(&mut self, fate: Fate, leg: &Leg<'_>, monitor: &Monitor) {
        self.fate = Some(fate);
        self.announce(leg, monitor);
    }

    pub(crate) fn into_record(self, leg: &Leg<'_>) -> StartRecord {
        StartRecord {
            kind: self.start.kind,
            flipped: self.start.flipped,
            mirrored: leg.mirrored,
            data_side: leg.data_side(),
            first: self.first,
            last: leg.frames.target_from_source(&self.run.model_from_data),
            score: self.run.score,
            p95: self.run.spread().0,
            took: self.run.took,
            termination: self.run.termination,
            fate: self.fate.unwrap_or(Fate::RunnerUp),
            iterations: self.run.records,
        }
    }
}

/// Data of a stage with both directions of the normals.
pub(crate) struct BothSigns([Data; 2]);

impl BothSigns {
    pub(crate) fn new(data: Data) -> Self {
        let flipped = data.flipped();
        Self([data, flipped])
    }

    pub(crate) fn get(&self, flipped: bool) -> &Data {
        &self.0[usize::from(flipped)]
    }
}

/// Runs all entrants on few points, dropping and merging after each heat.
pub(crate) fn race(
    leg: &Leg<'_>,
    entrants: &mut [Entrant],
    settings: &MatchSettings,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = leg.coarse;
    let rules = stage_rules(Stage::Race, settings, data, model);
    let qualifying = (entrants.len() >= CROWD).then_some(QUALIFYING);
    let mut asked: Option<(f64, BothSigns)> = None;
    let mut done = 0;
    for heat in qualifying.iter().chain(&HEATS) {
        monitor.progress("race", done as u64, None);
        done += heat.n_iterations;
        let unchanged = asked.take().filter(|(share, _)| *share == heat.points);
        let (_, points) = asked.insert(unchanged.unwrap_or_else(|| {
            // Scores and partners of other points do not carry over.
            for entrant in entrants.iter_mut().filter(|e| e.is_alive()) {
                entrant.run.enter_stage();
            }
            let n_points = (heat.points * settings.n_race_points as f64).ceil() as usize;
            let points = BothSigns::new(Data::new(thin(data, n_points)));
            (heat.points, points)
        }));
        let n_iterations = heat.n_iterations;
        advance_all(
            leg,
            entrants,
            (&*points, model),
            &rules,
            n_iterations,
            monitor,
        )?;
        let n_alive = entrants.iter().filter(|e| e.is_alive()).count();
        let keep = ((n_alive as f64 * heat.keep).ceil() as usize).max(heat.least);
        merge(leg, entrants, monitor);
        drop_slow(leg, entrants, (keep, done), monitor);
    }
    for entrant in entrants.iter_mut() {
        entrant.race_score = entrant.run.score;
    }
    Ok(())
}

/// Runs the best `n_distinct` entrants on more points of the fine meshes; the rest is dropped.
pub(crate) fn refine(
    leg: &Leg<'_>,
    entrants: &mut [Entrant],
    n_distinct: usize,
    settings: &MatchSettings,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = leg.fine;
    let raced = entrants.iter().map(|e| e.run.records.len()).max();
    let raced = raced.unwrap_or(0);
    drop_slow(leg, entrants, (n_distinct, raced), monitor);
    let points = BothSigns::new(Data::new(thin(data, settings.n_refine_points)));
    let rules = stage_rules(Stage::Refine, settings, data, model);
    monitor.progress("refine", 0, None);
    for entrant in entrants.iter_mut().filter(|e| e.is_alive()) {
        entrant.run.enter_stage();
    }
    let first = PROBATION.min(rules.max_iterations);
    for n_iterations in [first, rules.max_iterations - first] {
        advance_all(
            leg,
            entrants,
            (&points, model),
            &rules,
            n_iterations,
            monitor,
        )?;
        merge(leg, entrants, monitor);
        let after = raced + n_iterations;
        drop_slow(leg, entrants, (n_distinct, after), monitor);
    }
    Ok(())
}

/// Runs every entrant on all points of the coarse meshes to its end, first with a wide basin.
pub(crate) fn run_every_start(
    leg: &Leg<'_>,
    entrants: &mut [Entrant],
    settings: &MatchSettings,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let Pairing { data, model } = leg.coarse;
    let points = BothSigns::new(Data::new(all_nodes(data, true)));
    for stage in [Stage::Catch, Stage::Settle] {
        let rules = stage_rules(stage, settings, data, model);
        monitor.progress(rules.name, 0, None);
        for entrant in entrants.iter_mut().filter(|e| e.is_alive()) {
            entrant.run.enter_stage();
        }
        let cap = rules.max_iterations;
        advance_all(leg, entrants, (&points, model), &rules, cap, monitor)?;
    }
    merge(leg, entrants, monitor);
    Ok(())
}

/// Continues all that are alive, in parallel; none knows of the others.
fn advance_all(
    leg: &Leg<'_>,
    entrants: &mut [Entrant],
    (points, model): (&BothSigns, &Surface),
    rules: &StageRules,
    n_iterations: usize,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    entrants
        .par_iter_mut()
        .filter(|entrant| entrant.is_alive())
        .try_for_each(|entrant| {
            let data = points.get(entrant.start.flipped);
            let run = &mut entrant.run;
            advance(
                run,
                data,
                (model, rules),
                n_iterations,
                &leg.frames,
                monitor,
            )
        })?;
    for entrant in entrants.iter_mut().filter(|e| e.is_alive()) {
        let lost = run_failed(&entrant.run);
        if lost {
            entrant.end(Fate::Failed, leg, monitor);
        }
    }
    Ok(())
}

fn run_failed(run: &Run) -> bool {
    let no_pairs = run.termination == Some(Termination::NoPairs);
    no_pairs || !run.score.is_finite()
}

/// Indices of those alive, best score first; equal scores in order of the starts.
pub(crate) fn ranking(entrants: &[Entrant]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..entrants.len())
        .filter(|&i| entrants[i].is_alive())
        .collect();
    order.sort_by(|&a, &b| {
        let (x, y) = (&entrants[a].run.score, &entrants[b].run.score);
        x.total_cmp(y).then(a.cmp(&b))
    });
    order
}

/// Lets the best `keep` go on.
fn drop_slow(
    leg: &Leg<'_>,
    entrants: &mut [Entrant],
    (keep, after): (usize, usize),
    monitor: &Monitor,
) {
    let order = ranking(entrants);
    let Some(&first) = order.first() else {
        return;
    };
    let limit = HOPELESS * entrants[first].run.score;
    for (rank, i) in order.into_iter().enumerate() {
        if rank >= keep || (rank > 0 && entrants[i].run.score > limit) {
            entrants[i].end(Fate::Dropped { after }, leg, monitor);
        }
    }
}

/// Of those that met in one pose only the best goes on.
fn merge(leg: &Leg<'_>, entrants: &mut [Entrant], monitor: &Monitor) {
    let order = ranking(entrants);
    for (rank, &i) in order.iter().enumerate() {
        let better = order[..rank].iter().copied().find(|&j| {
            let (a, b) = (&entrants[j], &entrants[i]);
            a.is_alive() && leg.is_same(&a.run.model_from_data, &b.run.model_from_data)
        });
        if let Some(better) = better {
            let start = entrants[better].run.start_idx;
            entrants[i].end(Fate::MergedInto { start }, leg, monitor);
        }
    }
}

/// The pose of `entrant` mirrored in each principal plane of the data: where a part that is nearly
/// its own mirror image lies if it is of the opposite hand.
pub(crate) fn mirror_images(leg: &Leg<'_>, entrant: &Entrant) -> Vec<Start> {
    let measures = leg.fine.data.measures();
    (0..3)
        .map(|axis| {
            let normal: crate::geometry::Vector3 = measures.principal_axes.column(axis).into();
            let rotation = crate::geometry::Matrix3::identity() - normal * normal.transpose() * 2.0;
            let mirror = Similarity {
                rotation,
                translation: measures.centroid.coords - rotation * measures.centroid.coords,
                scale: 1.0,
            };
            variation(leg, entrant, &mirror, axis)
        })
        .collect()
}

/// The pose of `entrant` turned by 180° about each principal axis of the data: where parts that
/// are nearly symmetric have their twins.
pub(crate) fn twins(leg: &Leg<'_>, entrant: &Entrant) -> Vec<Start> {
    let measures = leg.fine.data.measures();
    (0..3)
        .map(|axis| {
            let direction =
                nalgebra::Unit::new_normalize(measures.principal_axes.column(axis).into());
            let turn = crate::geometry::Rotation::from_axis_angle(&direction, std::f64::consts::PI);
            let shift = measures.centroid.coords - turn * measures.centroid.coords;
            let turn = Similarity {
                rotation: *turn.to_rotation_matrix().matrix(),
                translation: shift,
                scale: 1.0,
            };
            variation(leg, entrant, &turn, axis)
        })
        .collect()
}

/// The pose of `entrant` after the data was moved by `motion`.
fn variation(leg: &Leg<'_>, entrant: &Entrant, motion: &Similarity, axis: usize) -> Start {
    let pose = entrant.run.model_from_data.after(motion);
    Start {
        kind: StartKind::Twin { axis },
        // Turning a sheet over shows its other side.
        flipped: entrant.start.flipped != turns_over(motion, leg),
        target_from_source: if leg.frames.data_is_target {
            pose.inverse()
        } else {
            pose
        },
    }
}

/// True if `turn` reverses the mean normal of the data.
fn turns_over(turn: &Similarity, leg: &Leg<'_>) -> bool {
    let normal = leg.fine.data.measures().mean_normal;
    turn.rotate(&normal).dot(&normal) < 0.0
}
