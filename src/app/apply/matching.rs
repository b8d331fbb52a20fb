//! What aligning, matching, sweeps and poses to choose from change.

use std::sync::Arc;
use std::time::Duration;

use crate::app::state::Starts;
use crate::app::{
    AppState, BottomTab, Effect, MatchCommand, MatchResult, NoticeLevel, Part, ViewCommand, facts,
};
use crate::assess::Coverage;
use crate::geometry::Point3;
use crate::jobs::{JobKey, JobKind, MatchInput, MeasureInput, Stamp, SweepInput, SweepRows};
use crate::pipeline::match_parts::{MatchRecipe, MatchRun, ReducedPair};
use crate::pipeline::sweep::{Sweep, SweepSettings};
use crate::registration::StartMethod;
use crate::registration::starts::Start;
use crate::role::{PerRole, Role};

/// A run that took longer is worth a word to the desktop.
const LONG_RUN: Duration = Duration::from_secs(10);
/// Moves of the centre up to this share of the part's size leave the cameras alone.
const NUDGE: f64 = 0.25;

impl AppState {
    pub(super) fn apply_match(&mut self, command: MatchCommand) -> Vec<Effect> {
        match command {
            MatchCommand::SetRecipe(recipe) => self.set_recipe(*recipe),
            MatchCommand::Align => return self.start_with_input(JobKind::Align),
            MatchCommand::ShowStart(index) => self.show_start(index),
            MatchCommand::StepStart(direction) => self.step_start(direction),
            MatchCommand::UseMatchStart(index) => self.use_match_start(index),
            MatchCommand::UseStart(index) => self.use_start(index),
            MatchCommand::Run => return self.run_match(),
            MatchCommand::Refine => return self.refine(),
            MatchCommand::Stop => return self.stop_run(),
            MatchCommand::Cancel => return self.cancel_run(),
            MatchCommand::ShowAlternative(index) => self.show_alternative(index),
            MatchCommand::NextAlternative => self.next_alternative(),
            MatchCommand::Measure => return self.measure(),
            MatchCommand::Sweep(settings) => return self.run_sweep(*settings),
        }
        Vec::new()
    }

    fn set_recipe(&mut self, recipe: MatchRecipe) {
        if self.is_unlocked().is_ok() {
            // A slider sends many recipes; they are one step until something else happens.
            let gesture = self.recipe_gesture();
            self.commit_in("Match settings", Some(gesture), |d| d.recipe = recipe);
        }
    }

    /// The inputs of a match: the levels that are shown, the settings, the pose.
    fn match_input(&self) -> Option<MatchInput> {
        self.can_match().ok()?;
        let (crash, stamped) = self.document.both()?;
        let is_reduced = crash.level.is_some() || stamped.level.is_some();
        let reduced = is_reduced.then(|| ReducedPair {
            meshes: PerRole::new(crash, stamped).map(|part| Arc::clone(part.reduced_mesh())),
            max_triangles: PerRole::new(crash, stamped).map(Part::ceiling),
        });
        let mut recipe = self.document.recipe.clone();
        if recipe.settings.starts.method == StartMethod::GivenPoses {
            let fit = self.pair_fit().ok()?;
            recipe.settings.starts.poses = vec![fit.fit.target_from_source];
        }
        Some(MatchInput {
            parts: PerRole::new(crash, stamped).map(|part| part.loaded.to_arc()),
            reduced,
            recipe,
            current: *self.document.crash_from_stamped(),
        })
    }

    fn start_with_input(&mut self, kind: impl FnOnce(MatchInput) -> JobKind) -> Vec<Effect> {
        let Some(input) = self.match_input() else {
            return Vec::new();
        };
        self.drop_previews();
        vec![self.start(kind(input))]
    }

    fn run_match(&mut self) -> Vec<Effect> {
        self.run_match_of(JobKind::Match)
    }

    /// From where the part lies now; a wide search would lead away from it.
    fn refine(&mut self) -> Vec<Effect> {
        self.run_match_of(|mut input| {
            input.recipe.settings.starts.method = StartMethod::CurrentPose;
            input.recipe.settings.starts.extra_starts = false;
            JobKind::Match(input)
        })
    }

    fn run_match_of(&mut self, kind: impl FnOnce(MatchInput) -> JobKind) -> Vec<Effect> {
        let effects = self.start_with_input(kind);
        if !effects.is_empty() {
            self.live_starts.clear();
            self.failed_match = None;
            self.view.chosen_start = None;
            self.live_pose = None;
        }
        effects
    }

    fn run_sweep(&mut self, settings: SweepSettings) -> Vec<Effect> {
        let rows = SweepRows::default();
        let told = rows.clone();
        let effects = self.start_with_input(|input| {
            JobKind::Sweep(SweepInput {
                parts: input.parts,
                settings,
                rows,
            })
        });
        if !effects.is_empty() {
            let n_triangles = self
                .document
                .part(Role::Stamped)
                .map_or(0, |part| part.loaded.report.n_triangles);
            let begun = Sweep {
                n_triangles,
                ..Sweep::default()
            };
            self.sweep_so_far = Some((begun, told));
            self.view.tab = BottomTab::Sweep;
        }
        effects
    }

    fn measure(&mut self) -> Vec<Effect> {
        let Some((crash, stamped)) = self.document.both() else {
            return Vec::new();
        };
        let input = MeasureInput {
            parts: PerRole::new(crash, stamped).map(|part| part.loaded.to_arc()),
            crash_from_stamped: *self.document.crash_from_stamped(),
        };
        let mut effects = self.cancel_job(JobKey::Measure);
        effects.push(self.start(JobKind::Measure(input)));
        effects
    }

    /// The match measured its best pose; an alternative that is shown is measured as soon as it is.
    pub(super) fn keep_measuring_alternative(&mut self) -> Vec<Effect> {
        let stamp = self.document.stamp();
        let result = self.document.current_result();
        let is_alternative = result.is_some_and(|result| result.alternative.is_some());
        let is_known =
            self.current_measurement().is_some() || self.alternative_asked == Some(stamp);
        let is_free = self.is_unlocked().is_ok() && !self.jobs.is_active(JobKey::Measure);
        if !is_alternative || is_known || !is_free {
            return Vec::new();
        }
        self.alternative_asked = Some(stamp);
        self.measure()
    }

    fn stop_run(&mut self) -> Vec<Effect> {
        let Some(key) = self.locking_job() else {
            return Vec::new();
        };
        self.jobs.ending(key, false);
        vec![Effect::StopJob(key)]
    }

    fn cancel_run(&mut self) -> Vec<Effect> {
        let key = self.locking_job();
        key.map_or_else(Vec::new, |key| self.cancel_job(key))
    }

    /// Asks a job to go. The window shows the old state at once; the worker follows.
    pub(super) fn cancel_job(&mut self, key: JobKey) -> Vec<Effect> {
        if !self.jobs.is_active(key) {
            return Vec::new();
        }
        self.jobs.ending(key, true);
        match key {
            JobKey::Match => self.live_pose = None,
            JobKey::Compare => self.give_up_comparing(self.document.stamp()),
            _ => {}
        }
        vec![Effect::CancelJob(key)]
    }

    fn show_start(&mut self, index: Option<usize>) {
        self.view.hovered_preview = None;
        self.view.pinned_preview = None;
        if self.is_unlocked().is_err() {
            return;
        }
        if let Some(starts) = &mut self.starts {
            let n_starts = starts.poses.len();
            starts.shown = index.filter(|i| *i < n_starts);
        }
    }

    fn step_start(&mut self, direction: i32) {
        let Some(starts) = self.current_starts().filter(|s| !s.poses.is_empty()) else {
            return;
        };
        let n_starts = starts.poses.len();
        let next = match starts.shown {
            None if direction > 0 => 0,
            None => n_starts - 1,
            Some(shown) if direction > 0 => (shown + 1) % n_starts,
            Some(shown) => (shown + n_starts - 1) % n_starts,
        };
        self.show_start(Some(next));
    }

    fn use_start(&mut self, index: usize) {
        let start = self.current_starts().and_then(|s| s.poses.get(index));
        let Some(pose) = start.map(|s| s.target_from_source) else {
            return;
        };
        if self.can_move().is_ok() {
            self.commit_pose(format!("Start pose {}", index + 1), None, pose);
            self.drop_previews();
        }
    }

    /// A start that gave the result or one of its alternatives shows that, so that the result stays
    /// current; any other start moves the part.
    fn use_match_start(&mut self, index: usize) {
        let Some(pose) = self.match_start(index).map(|start| start.last) else {
            return;
        };
        if self.can_move().is_err() {
            return;
        }
        let outcome = self
            .document
            .result
            .as_ref()
            .filter(|_| self.live_starts.is_empty());
        let known = outcome.and_then(|result| {
            let outcome = &result.run.outcome;
            let alternative = outcome.alternatives.iter().position(|a| a.start == index);
            let is_winner = outcome.winner == index;
            is_winner.then_some(None).or(alternative.map(Some))
        });
        match known {
            Some(alternative) => self.show_alternative(alternative),
            None => {
                self.commit_pose(format!("Pose of start {}", index + 1), None, pose);
            }
        }
        self.drop_previews();
    }

    fn show_alternative(&mut self, alternative: Option<usize>) {
        let Some(result) = self.document.result.clone() else {
            return;
        };
        let is_same_pair = result.stamp.parts == self.document.stamp().parts;
        let pose = facts::match_pose(&result.run, alternative);
        let Some(crash_from_stamped) = pose.filter(|_| is_same_pair) else {
            return;
        };
        if self.can_move().is_err() {
            return;
        }
        let name = match alternative {
            None => "Best pose".to_owned(),
            Some(index) => format!("Alternative {}", index + 2),
        };
        self.take_pose_as_result(name, crash_from_stamped, |stamp| MatchResult {
            alternative,
            stamp,
            ..result
        });
    }

    fn next_alternative(&mut self) {
        let Some(result) = &self.document.result else {
            return;
        };
        let n_alternatives = facts::n_alternatives(&result.run);
        let next = result.alternative.map_or(0, |index| index + 1);
        let next = (next < n_alternatives).then_some(next);
        self.show_alternative(next);
    }

    /// Pose and result as one undo step.
    fn take_pose_as_result(
        &mut self,
        name: String,
        crash_from_stamped: crate::geometry::Similarity,
        result: impl FnOnce(Stamp) -> MatchResult,
    ) {
        let revision = self.next_revision();
        self.drop_previews();
        self.commit(name, |document| {
            document.pose.crash_from_stamped = crash_from_stamped;
            document.pose.revision = revision;
            document.result = Some(result(document.stamp()));
        });
    }

    pub(super) fn take_matched(&mut self, run: Arc<MatchRun>, took: Duration) -> Vec<Effect> {
        let (line, level) = (
            facts::match_line(&run, self.lengths()),
            facts::match_level(&run),
        );
        for (step, text, took) in facts::match_steps(&run) {
            self.log_step(step, None, text, Some(took));
        }
        self.live_pose = None;
        self.live_starts.clear();
        self.keep_match_level(&run);
        let pose = run.crash_from_stamped;
        let before = self.document.stamped_center();
        self.take_pose_as_result("Match".to_owned(), pose, |stamp| MatchResult {
            run: run.into(),
            alternative: None,
            stamp,
        });
        self.follow_far_move(before);
        // Its phases have their own rows; counting the whole again would double the total.
        self.log_at(level, "result", None, line.clone(), None);
        if took >= LONG_RUN {
            vec![Effect::NotifyDesktop(line)]
        } else {
            Vec::new()
        }
    }

    /// A part that went far is no longer where the cameras look; one that was nudged still is.
    fn follow_far_move(&mut self, before: Option<Point3>) {
        let (Some(before), Some(after)) = (before, self.document.stamped_center()) else {
            return;
        };
        let part = self.document.part(Role::Stamped);
        let size = part.map_or(0.0, |part| part.bounds().diagonal());
        if (after - before).norm() < NUDGE * size {
            return;
        }
        self.apply_view(ViewCommand::FitAll(Role::Stamped));
        if self.view.is_moved_over {
            self.apply_view(ViewCommand::FitAll(Role::Crash));
        }
    }

    pub(super) fn take_aligned(&mut self, poses: Arc<Vec<Start>>, took: Duration) {
        let n_poses = poses.len();
        let text = facts::counted(n_poses, "start pose");
        self.log_step("align", None, text, Some(took));
        self.starts = Some(Starts {
            parts: self.document.stamp().parts,
            poses: poses.into(),
            shown: (n_poses > 0).then_some(0),
        });
    }

    pub(super) fn take_measured(
        &mut self,
        measurement: Arc<Coverage>,
        stamp: Stamp,
        took: Duration,
    ) {
        let line = facts::measure_line(&measurement, self.lengths());
        self.log_step("measure", None, line, Some(took));
        self.measurement = Some((stamp, measurement.into()));
    }

    /// Takes over the rows that the running sweep has measured since the last look.
    pub(super) fn take_sweep_rows(&mut self) {
        if let Some((sweep, rows)) = &mut self.sweep_so_far {
            for row in rows.take() {
                sweep.push(row);
            }
        }
    }

    pub(super) fn take_swept(&mut self, table: Arc<Sweep>, took: Duration) {
        self.keep_sweep_levels(&table);
        self.sweep = Some(table.into());
        self.sweep_so_far = None;
        self.log_at(
            NoticeLevel::Success,
            "sweep",
            None,
            "sweep finished",
            Some(took),
        );
    }
}
