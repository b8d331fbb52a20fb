//! What levels of reduction change.

use std::sync::Arc;
use std::time::Duration;

use crate::app::{AppState, Effect, ReduceCommand, ShownGeometry, facts};
use crate::jobs::{JobKind, MeasureLevelInput, MeasuredLevel, Recording, ReduceInput};
use crate::role::{PerRole, Role};

impl AppState {
    pub(super) fn apply_reduce(&mut self, command: ReduceCommand) -> Vec<Effect> {
        if self.is_unlocked().is_err() {
            return Vec::new();
        }
        match command {
            ReduceCommand::To {
                roles,
                max_triangles,
            } => self.reduce_roles(roles, max_triangles),
            ReduceCommand::Full(roles) => {
                self.reduce_to_full(roles);
                Vec::new()
            }
            ReduceCommand::Step(direction) => self.step_level(direction),
        }
    }

    fn reduce_roles(&mut self, roles: PerRole<bool>, max_triangles: usize) -> Vec<Effect> {
        let chosen = Role::ALL.into_iter().filter(|role| *roles.get(*role));
        chosen
            .filter_map(|role| self.reduce(role, max_triangles.max(1)))
            .collect()
    }

    fn reduce(&mut self, role: Role, max_triangles: usize) -> Option<Effect> {
        let part = self.document.part(role)?;
        let input = ReduceInput {
            role,
            part: part.loaded.to_arc(),
            recording: self.recording(role).cloned(),
            max_triangles,
        };
        Some(self.start(JobKind::Reduce(input)))
    }

    fn reduce_to_full(&mut self, roles: PerRole<bool>) {
        self.commit("Back to the full mesh", |document| {
            for role in Role::ALL.into_iter().filter(|role| *roles.get(*role)) {
                if let Some(part) = document.parts.get_mut(role) {
                    part.level = None;
                    part.wanted_level = None;
                }
            }
        });
    }

    fn step_level(&mut self, direction: i32) -> Vec<Effect> {
        let roles = self.settings.reduce_roles;
        match self.next_level(direction) {
            Some(Some(max_triangles)) => self.reduce_roles(roles, max_triangles),
            Some(None) => {
                self.reduce_to_full(roles);
                Vec::new()
            }
            None => Vec::new(),
        }
    }

    /// The marked levels that can be reached: those with fewer triangles than the largest ticked part,
    /// the finest first. Chips and keys offer these.
    pub fn reachable_levels(&self) -> Vec<usize> {
        let roles = self.settings.reduce_roles;
        let ticked = Role::ALL.into_iter().filter(|role| *roles.get(*role));
        let n_full = ticked
            .filter_map(|role| self.document.part(role))
            .map(|part| part.loaded.report.n_triangles)
            .max();
        let marked = self.settings.marked_levels.iter().copied();
        marked
            .filter(|n| n_full.is_some_and(|n_full| *n < n_full))
            .collect()
    }

    /// The next coarser (+1) or finer (−1) marked level of the ticked parts: `None` without one,
    /// `Some(None)` for the full mesh, which is finer than the finest mark.
    pub fn next_level(&self, direction: i32) -> Option<Option<usize>> {
        let roles = self.settings.reduce_roles;
        let level = |role: Role| self.document.part(role).map(|part| part.wanted_level);
        let ticked = Role::ALL.into_iter().filter(|role| *roles.get(*role));
        let current = ticked.filter_map(level).next()?;
        let reachable = self.reachable_levels().into_iter();
        if direction > 0 {
            let n_current = current.unwrap_or(usize::MAX);
            reachable.filter(|n| *n < n_current).max().map(Some)
        } else {
            let n_current = current?;
            Some(reachable.filter(|n| *n > n_current).min())
        }
    }

    /// After another selection: the level that was asked for is made again.
    pub(super) fn reduce_again(&mut self, role: Role) -> Vec<Effect> {
        let wanted = self.document.part(role).and_then(|part| part.wanted_level);
        wanted
            .and_then(|max_triangles| self.reduce(role, max_triangles))
            .into_iter()
            .collect()
    }

    pub(super) fn take_reduced(
        &mut self,
        role: Role,
        recording: Arc<Recording>,
        level: Arc<MeasuredLevel>,
        took: Duration,
    ) -> Vec<Effect> {
        let Some(part) = self.document.part(role) else {
            return Vec::new();
        };
        let revision = part.revision;
        *self.recordings.get_mut(role) = Some((revision, Arc::clone(&recording)));
        self.log_step("reduce", Some(role), facts::reduce_line(&level), Some(took));
        let n_triangles = facts::grouped(level.level.mesh.n_triangles());
        let name = format!("Reduce the {} part to {n_triangles}", role.word());
        let measured = Arc::clone(&level);
        self.commit(name, |document| {
            if let Some(part) = document.parts.get_mut(role) {
                part.wanted_level = Some(measured.max_triangles);
                part.level = Some(measured.into());
            }
        });
        self.view.shown = ShownGeometry::Reduced;
        vec![self.start(JobKind::MeasureLevel(MeasureLevelInput {
            role,
            recording,
            level,
        }))]
    }

    pub(super) fn take_level_measured(
        &mut self,
        role: Role,
        level: &MeasuredLevel,
        took: Duration,
    ) -> Vec<Effect> {
        self.log_step(
            "measure",
            Some(role),
            facts::deviation_line(level, self.lengths()),
            Some(took),
        );
        Vec::new()
    }
}
