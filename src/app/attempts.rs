//! The starts of a match as the window lists them: those of the running one as they come in, those of a
//! finished one from its record.

use super::state::pose_of;
use super::{AppState, facts};
use crate::geometry::{Point3, Similarity};
use crate::jobs::{JobKey, Role};
use crate::monitor::{Fate, IterationReport, StartReport};
use crate::registration::{IterationRecord, StartRecord};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::time::Duration;

/// Poses closer than this in angle, and in place relative to the part's size, are one pose.
const SAME_ANGLE: f64 = 3.0 * std::f64::consts::PI / 180.0;
const SAME_SHIFT: f64 = 0.02;

/// What the running match told of its starts so far, or what a cancelled or failed one told.
#[derive(Debug, Clone, Default)]
pub struct Race {
    starts: BTreeMap<usize, Runner>,
}

#[derive(Debug, Clone, Default)]
struct Runner {
    name: String,
    fate: Option<Fate>,
    iterations: Vec<IterationReport>,
}

impl Race {
    /// Adds news, in the order they were told.
    pub(super) fn add(&mut self, starts: Vec<StartReport>, iterations: Vec<IterationReport>) {
        for report in starts {
            let runner = self.starts.entry(report.start_idx).or_default();
            runner.name = report.name;
            runner.fate = report.fate;
        }
        for iteration in iterations {
            let runner = self.starts.entry(iteration.start_idx).or_default();
            runner.iterations.push(iteration);
        }
    }

    /// True if nothing was told.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.starts.clear();
    }
}

/// One iteration of a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Root mean square distance of the kept pairs.
    pub rmse: f64,
    /// Share of the area whose pairs were kept.
    pub overlap: f64,
    /// What was minimised; comparable within one stage only.
    pub objective: f64,
    /// The pose, `crash_from_stamped`.
    pub pose: Similarity,
}

#[derive(Debug, Clone, Copy)]
enum Steps<'a> {
    Told(&'a [IterationReport]),
    Kept(&'a [IterationRecord]),
}

/// A start with its whole story so far.
#[derive(Debug, Clone)]
pub struct Attempt<'a> {
    /// Its number over the whole match, counted from 0.
    pub index: usize,
    /// How it came to be, in words.
    pub name: Cow<'a, str>,
    /// What became of it; `None` while it runs, or where its run was cancelled.
    pub fate: Option<Fate>,
    /// Distance that 95 % of its last kept pairs stay below; known when the match has ended.
    pub p95: Option<f64>,
    /// Time of its iterations; known when the match has ended.
    pub took: Option<Duration>,
    last: Option<Similarity>,
    steps: Steps<'a>,
}

impl<'a> Attempt<'a> {
    fn told((index, runner): (&usize, &'a Runner)) -> Self {
        Self {
            index: *index,
            name: Cow::Borrowed(&runner.name),
            fate: runner.fate,
            p95: None,
            took: None,
            last: None,
            steps: Steps::Told(&runner.iterations),
        }
    }

    fn kept((index, record): (usize, &'a StartRecord)) -> Self {
        Self {
            index,
            name: Cow::Owned(record.name()),
            fate: Some(record.fate),
            p95: Some(record.p95),
            took: Some(record.took),
            last: Some(record.last),
            steps: Steps::Kept(&record.iterations),
        }
    }

    /// Iterations made.
    pub fn n_steps(&self) -> usize {
        match self.steps {
            Steps::Told(steps) => steps.len(),
            Steps::Kept(steps) => steps.len(),
        }
    }

    /// One iteration, counted from 0.
    pub fn step(&self, index: usize) -> Option<Step> {
        match self.steps {
            Steps::Told(steps) => steps.get(index).and_then(|report| {
                Some(Step {
                    rmse: report.rmse,
                    overlap: report.fraction,
                    objective: report.objective,
                    pose: pose_of(report)?,
                })
            }),
            Steps::Kept(steps) => steps.get(index).map(|record| Step {
                rmse: record.rmse,
                overlap: record.fraction,
                objective: record.objective,
                pose: record.target_from_source,
            }),
        }
    }

    /// Residual and overlap of every iteration, for the curves. No pose is made.
    pub fn curve(&self) -> Vec<[f64; 2]> {
        match self.steps {
            Steps::Told(steps) => steps.iter().map(|s| [s.rmse, s.fraction]).collect(),
            Steps::Kept(steps) => steps.iter().map(|s| [s.rmse, s.fraction]).collect(),
        }
    }

    /// Its last iteration.
    pub fn last_step(&self) -> Option<Step> {
        self.step(self.n_steps().checked_sub(1)?)
    }

    /// Where it ended, or where it is now.
    pub fn last_pose(&self) -> Option<Similarity> {
        self.last.or_else(|| self.last_step().map(|step| step.pose))
    }

    /// Starts that count come first; within them the better ones.
    fn rank(&self) -> (u8, f64) {
        let class = match self.fate {
            Some(Fate::Won) => 0,
            None => 1,
            Some(Fate::RunnerUp) => 2,
            Some(Fate::MergedInto { .. }) => 3,
            Some(Fate::Dropped { .. }) => 4,
            Some(Fate::Failed) => 5,
        };
        // Rows of running starts keep their order, so that the table does not jump.
        let score = if self.fate.is_none() {
            self.index as f64
        } else {
            self.last_step().map_or(f64::INFINITY, |s| s.objective)
        };
        (class, score)
    }

    fn is_settled(&self) -> bool {
        matches!(self.fate, Some(Fate::Won | Fate::RunnerUp))
    }
}

/// Starts that ended in one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct AttemptGroup {
    /// Places in the list of attempts, the best first.
    pub members: Vec<usize>,
    /// Farthest that a corner of the part's box lies from where the first group has it.
    pub distance: Option<f64>,
}

/// Puts together what ended in one pose, best first. `corners` are those of the part's box in its own
/// space. O(attempts · groups).
pub fn group_attempts(attempts: &[Attempt<'_>], corners: &[Point3; 8]) -> Vec<AttemptGroup> {
    let mut order: Vec<usize> = (0..attempts.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (attempts[a].rank(), attempts[b].rank());
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    // Those that met another come after all that may lead a group, their leader among them.
    let has_met = |&place: &usize| matches!(attempts[place].fate, Some(Fate::MergedInto { .. }));
    let (met, leading): (Vec<_>, Vec<_>) = order.into_iter().partition(has_met);
    let mut groups: Vec<AttemptGroup> = Vec::new();
    for place in leading.into_iter().chain(met) {
        let home = home_of(attempts, place, &groups, corners);
        match home {
            Some(group) => groups[group].members.push(place),
            None => groups.push(AttemptGroup {
                members: vec![place],
                distance: None,
            }),
        }
    }
    let pose = |group: &AttemptGroup| attempts[group.members[0]].last_pose();
    if let Some(first) = groups.first().and_then(pose) {
        for group in &mut groups {
            group.distance = pose(group).map(|pose| pose.max_displacement(&first, corners));
        }
    }
    groups
}

/// The group a start belongs to: that of the start it met, or that of the same pose.
fn home_of(
    attempts: &[Attempt<'_>],
    place: usize,
    groups: &[AttemptGroup],
    corners: &[Point3; 8],
) -> Option<usize> {
    let attempt = &attempts[place];
    let mut met = None;
    let mut at = attempt;
    // A start that was met may itself have met another; the chain is shorter than the list.
    for _ in 0..attempts.len() {
        let Some(Fate::MergedInto { start }) = at.fate else {
            break;
        };
        let found = attempts.iter().position(|other| other.index == start)?;
        at = &attempts[found];
        met = Some(found);
    }
    if let Some(met) = met {
        return groups.iter().position(|group| group.members.contains(&met));
    }
    let pose = attempt.last_pose().filter(|_| attempt.is_settled())?;
    groups.iter().position(|group| {
        let leader = &attempts[group.members[0]];
        let same = |other: Similarity| is_same_pose(&pose, &other, corners);
        leader.is_settled() && leader.last_pose().is_some_and(same)
    })
}

/// True for poses that a further refinement would bring together.
pub fn is_same_pose(a: &Similarity, b: &Similarity, corners: &[Point3; 8]) -> bool {
    let size = (corners[7] - corners[0]).norm();
    let center = [nalgebra::center(&corners[0], &corners[7])];
    a.is_mirrored() == b.is_mirrored()
        && a.angle_to(b) < SAME_ANGLE
        && a.max_displacement(b, &center) < SAME_SHIFT * size * b.scale
}

/// A pose that is shown instead of the real one, without moving anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preview {
    /// Where a start of the last match ended.
    Start(usize),
    /// Where a start was at one of its iterations.
    Step {
        /// The start.
        start: usize,
        /// The iteration, counted from 0.
        iteration: usize,
    },
}

impl Preview {
    /// The start it belongs to.
    pub fn start(self) -> usize {
        match self {
            Self::Start(start) | Self::Step { start, .. } => start,
        }
    }
}

impl AppState {
    /// The starts of the running match, of the result, or of the last run that gave none, in the order
    /// of their numbers.
    pub fn attempts(&self) -> Vec<Attempt<'_>> {
        if !self.race.is_empty() {
            return self.race.starts.iter().map(Attempt::told).collect();
        }
        let result = self.document.result.as_ref();
        let starts = result.map_or(&[][..], |result| &result.run.outcome.starts);
        starts.iter().enumerate().map(Attempt::kept).collect()
    }

    /// One start by its number.
    pub fn attempt(&self, index: usize) -> Option<Attempt<'_>> {
        if !self.race.is_empty() {
            return self.race.starts.get_key_value(&index).map(Attempt::told);
        }
        let result = self.document.result.as_ref()?;
        let record = result.run.outcome.starts.get(index)?;
        Some(Attempt::kept((index, record)))
    }

    /// Poses of the result that fit nearly equally well, itself included; 0 without a result.
    pub fn n_equal_poses(&self) -> usize {
        let result = self.document.result.as_ref();
        result.map_or(0, |result| 1 + facts::n_alternatives(&result.run))
    }

    /// Starts of the running match that have ended, and those that began.
    pub fn race_count(&self) -> [usize; 2] {
        let starts = self.race.starts.values();
        let n_ended = starts.filter(|runner| runner.fate.is_some()).count();
        [n_ended, self.race.starts.len()]
    }

    /// Corners of the stamped part's box in its own space.
    pub fn stamped_corners(&self) -> Option<[Point3; 8]> {
        let bounds = self.document.part(Role::Stamped)?.bounds();
        (!bounds.is_empty()).then(|| bounds.corners())
    }

    /// What is shown instead of the real pose: under the pointer, else pinned.
    pub fn preview(&self) -> Option<Preview> {
        self.view.hovered_preview.or(self.view.pinned_preview)
    }

    pub(super) fn previewed_pose(&self) -> Option<Similarity> {
        match self.preview()? {
            Preview::Start(start) => self.attempt(start)?.last_pose(),
            Preview::Step { start, iteration } => Some(self.attempt(start)?.step(iteration)?.pose),
        }
    }

    /// The start whose curve stands out: the chosen one, the winner, or while the match runs the one
    /// that was heard of last.
    pub fn leading_start(&self) -> Option<usize> {
        let chosen = self.view.chosen_start;
        if let Some(chosen) = chosen.filter(|&start| self.attempt(start).is_some()) {
            return Some(chosen);
        }
        if self.jobs.is_active(JobKey::Match) {
            let latest = self.jobs.running().and_then(|job| job.latest);
            return latest.map(|report| report.start_idx);
        }
        if self.race.is_empty() {
            let result = self.document.result.as_ref()?;
            return Some(result.run.outcome.winner);
        }
        self.race.starts.keys().next().copied()
    }
}
