//! Levels of reduction: which are made, and what the match gave at each.

mod command;
mod level_result;

use std::sync::Arc;
use std::time::Duration;

pub use command::ReduceCommand;
pub use level_result::LevelResult;

use super::follow_up::FollowUp;
use super::work::Work;
use super::{
    AppState, Document, Effect, GestureId, OfParts, Part, Reason, Settings, ShownGeometry, facts,
};
use crate::app::LogStep;
use crate::jobs::{JobKey, JobKind, MeasureLevelInput, MeasuredLevel, Recording, ReduceInput};
use crate::role::{PerRole, Role};

/// What is remembered of reductions.
#[derive(Debug, Clone, Default)]
pub struct ReduceState {
    /// The last recording of each part, with the part's revision.
    recordings: PerRole<Option<(u64, Arc<Recording>)>>,
    /// The one undo step of both parts that were last to be reduced together, with their ceiling.
    together: Option<(GestureId, usize)>,
    /// Whether the level of a part is being made again, after another selection or unit.
    is_again: PerRole<bool>,
    /// What the match gave with the loaded pair, one for each level.
    level_results: OfParts<Vec<LevelResult>>,
}

impl AppState {
    /// `Ok` if a part may be reduced now.
    pub fn can_reduce(&self) -> Result<(), Reason> {
        self.document.has_any_part()?;
        self.jobs.is_unlocked()
    }

    /// True if the part is drawn reduced.
    pub fn shows_reduced(&self, role: Role) -> bool {
        let is_blinking = self.view.is_blinking && !self.view.is_moved_over;
        let part = self.document.part(role);
        self.view.shown == ShownGeometry::Reduced
            && !is_blinking
            && part.is_some_and(|part| part.level.is_some())
    }

    /// The marked levels that chips and keys offer, the finest first.
    pub fn reachable_levels(&self) -> Vec<usize> {
        self.document.reachable_levels(&self.settings)
    }

    /// See [`Document::next_level`].
    pub fn next_level(&self, direction: i32) -> Option<Option<usize>> {
        self.document.next_level(&self.settings, direction)
    }
}

impl Document {
    /// The marked levels that can be reached: those with fewer triangles than the largest ticked part,
    /// the finest first. Chips and keys offer these.
    pub fn reachable_levels(&self, settings: &Settings) -> Vec<usize> {
        let roles = settings.reduce_roles;
        let ticked = Role::ALL.into_iter().filter(|role| *roles.get(*role));
        let n_full = ticked
            .filter_map(|role| self.part(role))
            .map(|part| part.loaded.report.n_triangles)
            .max();
        let marked = settings.marked_levels.iter().copied();
        marked
            .filter(|n| n_full.is_some_and(|n_full| *n < n_full))
            .collect()
    }

    /// The next coarser (+1) or finer (−1) marked level of the ticked parts: `None` without one,
    /// `Some(None)` for the full mesh, which is finer than the finest mark.
    pub fn next_level(&self, settings: &Settings, direction: i32) -> Option<Option<usize>> {
        let roles = settings.reduce_roles;
        let level = |role: Role| self.part(role).map(|part| part.wanted_level);
        let ticked = Role::ALL.into_iter().filter(|role| *roles.get(*role));
        let current = ticked.filter_map(level).next()?;
        let reachable = self.reachable_levels(settings).into_iter();
        if direction > 0 {
            let n_current = current.unwrap_or(usize::MAX);
            reachable.filter(|n| *n < n_current).max().map(Some)
        } else {
            let n_current = current?;
            Some(reachable.filter(|n| *n > n_current).min())
        }
    }
}

impl ReduceState {
    pub(super) fn apply(&mut self, work: &mut Work<'_>, command: ReduceCommand) -> Vec<Effect> {
        if work.is_unlocked().is_err() {
            return Vec::new();
        }
        match command {
            ReduceCommand::To {
                roles,
                max_triangles,
            } => self.reduce_roles(work, roles, max_triangles),
            ReduceCommand::Full(roles) => reduce_to_full(work, roles),
            ReduceCommand::Step(direction) => self.step_level(work, direction),
        }
    }

    fn reduce_roles(
        &mut self,
        work: &mut Work<'_>,
        roles: PerRole<bool>,
        max_triangles: usize,
    ) -> Vec<Effect> {
        let max_triangles = max_triangles.max(1);
        let is_chosen = |role: &Role| *roles.get(*role) && work.document.part(*role).is_some();
        let chosen: Vec<Role> = Role::ALL.into_iter().filter(is_chosen).collect();
        self.together = (chosen.len() > 1).then(|| (GestureId::new(), max_triangles));
        self.is_again = PerRole::both(false);
        let chosen = chosen.into_iter();
        chosen
            .filter_map(|role| self.reduce(work, role, max_triangles))
            .collect()
    }

    /// The recording of a part's reduction, if one was made.
    fn recording(&self, part: &Part) -> Option<&Arc<Recording>> {
        let known = [&self.recordings.crash, &self.recordings.stamped];
        let of_part = |(of, _): &&(u64, _)| *of == part.revision;
        let found = known.into_iter().flatten().find(of_part);
        found.map(|(_, recording)| recording)
    }

    /// Remembers a recording, or with `None` forgets it.
    pub(super) fn keep_recording(&mut self, role: Role, known: Option<(u64, Arc<Recording>)>) {
        *self.recordings.get_mut(role) = known;
    }

    fn reduce(&mut self, work: &mut Work<'_>, role: Role, max_triangles: usize) -> Option<Effect> {
        let part = work.document.part(role)?;
        let input = ReduceInput {
            role,
            part: part.loaded.to_arc(),
            recording: self.recording(part).cloned(),
            max_triangles,
        };
        Some(work.start(JobKind::Reduce(input)))
    }

    fn step_level(&mut self, work: &mut Work<'_>, direction: i32) -> Vec<Effect> {
        let roles = work.settings.reduce_roles;
        match work.document.next_level(work.settings, direction) {
            Some(Some(max_triangles)) => self.reduce_roles(work, roles, max_triangles),
            Some(None) => reduce_to_full(work, roles),
            None => Vec::new(),
        }
    }

    /// After another selection: the level that was asked for is made again.
    pub(super) fn reduce_again(&mut self, work: &mut Work<'_>, role: Role) -> Vec<Effect> {
        let wanted = work.document.part(role).and_then(|part| part.wanted_level);
        *self.is_again.get_mut(role) = wanted.is_some();
        wanted
            .and_then(|max_triangles| self.reduce(work, role, max_triangles))
            .into_iter()
            .collect()
    }

    pub(super) fn take_reduced(
        &mut self,
        work: &mut Work<'_>,
        role: Role,
        recording: Arc<Recording>,
        level: Arc<MeasuredLevel>,
        took: Duration,
    ) -> Vec<Effect> {
        let Some(part) = work.document.part(role) else {
            return Vec::new();
        };
        let revision = part.revision;
        // Made again after another selection or unit, it belongs to that step.
        let is_again = std::mem::take(self.is_again.get_mut(role))
            && part.level.is_none()
            && part.wanted_level == Some(level.max_triangles);
        *self.recordings.get_mut(role) = Some((revision, Arc::clone(&recording)));
        work.log_step(
            LogStep::Reduce,
            Some(role),
            facts::reduce_line(&level),
            Some(took),
        );
        let of_both = self.together.filter(|(_, n)| *n == level.max_triangles);
        let gesture = of_both.map(|(gesture, _)| gesture);
        let name = if gesture.is_some_and(|gesture| work.history.is_open(gesture)) {
            let ceiling = facts::grouped(level.max_triangles);
            format!("Reduce both parts to at most {ceiling}")
        } else {
            let n_triangles = facts::grouped(level.level.mesh.n_triangles());
            format!("Reduce the {} part to {n_triangles}", role.word())
        };
        let measured = Arc::clone(&level);
        let take = |document: &mut Document| {
            if let Some(part) = document.parts.get_mut(role) {
                part.wanted_level = Some(measured.max_triangles);
                part.level = Some(measured.into());
            }
        };
        if is_again {
            take(work.document);
        } else {
            work.commit_in(name, gesture, take);
        }
        work.follow(FollowUp::LevelMade);
        vec![work.start(JobKind::MeasureLevel(MeasureLevelInput {
            role,
            recording,
            level,
        }))]
    }
}

/// A reduction that is under way would reduce the part again.
fn reduce_to_full(work: &mut Work<'_>, roles: PerRole<bool>) -> Vec<Effect> {
    let chosen = Role::ALL.into_iter().filter(|role| *roles.get(*role));
    let effects = chosen
        .clone()
        .flat_map(|role| work.cancel(JobKey::Reduce(role)))
        .collect();
    work.commit("Back to the full mesh", |document| {
        for role in chosen {
            if let Some(part) = document.parts.get_mut(role) {
                part.level = None;
                part.wanted_level = None;
            }
        }
    });
    effects
}

/// The distances of a level were measured.
pub(super) fn take_level_measured(
    work: &mut Work<'_>,
    role: Role,
    level: &MeasuredLevel,
    took: Duration,
) {
    let line = facts::deviation_line(level, work.lengths());
    work.log_step(LogStep::Measure, Some(role), line, Some(took));
}
