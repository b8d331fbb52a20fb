//! The whole state of the window.

use std::sync::Arc;
use std::time::Duration;

use super::level_result::LevelResults;
use super::{
    Clock, Compared, Document, GestureId, History, JobBoard, Likeness, LiveStarts, Log, LogRow,
    NoticeLevel, Notices, ProjectState, Settings, Shared, StampedPose, ViewState,
};
use crate::assess::Coverage;
use crate::geometry::Similarity;
use crate::jobs::{JobKey, JobKind, Recording, Stamp, SweepRows};
use crate::pipeline::sweep::Sweep;
use crate::registration::starts::Start;
use crate::role::{PerRole, Role};

/// The first poses of the last alignment.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// The parts they were made for.
    pub parts: PerRole<u64>,
    /// The poses, in the order they are stepped through.
    pub poses: Shared<Vec<Start>>,
    /// The one that is shown instead of the real pose.
    pub shown: Option<usize>,
}

/// How much of the better covered part lies on the other, measured after each move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseOverlap {
    /// The state it was measured at.
    pub stamp: Stamp,
    /// Share of the area, 0 to 1.
    pub overlap: f64,
    /// Distance up to which a place counts as covered.
    pub limit: f64,
    /// Against the pose before.
    pub change: Option<f64>,
}

/// Everything the window knows. Panels read it; only [`AppState::apply`] changes it.
#[derive(Debug, Clone, Default)]
pub struct AppState {
    /// What undo covers.
    pub document: Document,
    /// What is shown and how.
    pub view: ViewState,
    /// Preferences.
    pub settings: Settings,
    /// The project that is worked on.
    pub project: ProjectState,
    /// Undo and redo.
    pub history: History,
    /// The rows of the log pane.
    pub log: Log,
    /// Toasts and bell.
    pub notices: Notices,
    /// What runs and what waits.
    pub jobs: JobBoard,
    /// The first poses of the last alignment.
    pub starts: Option<Starts>,
    /// The best pose of the running match, for the preview.
    pub live_pose: Option<Similarity>,
    /// The starts of the running match, or of the last one if it gave no result.
    pub live_starts: LiveStarts,
    /// The overlap after the last move.
    pub overlap: Option<PoseOverlap>,
    /// Why the last match gave no result, with the parts it was run on.
    pub failed_match: Option<(PerRole<u64>, String)>,
    pub(super) overlap_asked: Option<Stamp>,
    /// Distances and overlap with the state they were measured in.
    pub measurement: Option<(Stamp, Shared<Coverage>)>,
    /// The state of the alternative that was measured last without being asked for.
    pub(super) alternative_asked: Option<Stamp>,
    /// The last comparison of both parts, up to date or not.
    pub compared: Option<Compared>,
    /// The tables of the last sweep.
    pub sweep: Option<Shared<Sweep>>,
    /// The rows of the running sweep, and where the next ones come from.
    pub(super) sweep_so_far: Option<(Sweep, SweepRows)>,
    /// Time since the program began, as the shell last told.
    pub now: Duration,
    /// When the program began, as the shell told.
    pub clock: Clock,
    /// What the part list is sorted by, if not the order of the files.
    pub(super) likeness: Option<Likeness>,
    pub(super) level_results: LevelResults,
    pub(super) recordings: PerRole<Option<(u64, Arc<Recording>)>>,
    pub(super) guess: Guess,
    /// The pose at the beginning of the drag or move by keys that is under way.
    pub(super) grab: Option<(GestureId, StampedPose)>,
    pub(super) unit_hint_dismissed_for: Option<PerRole<u64>>,
    /// The undo step of a change of units that a new factor belongs to.
    pub(super) unit_gesture: Option<GestureId>,
    pub(super) open_recipe_gesture: Option<GestureId>,
    /// The state at which a comparison failed or was cancelled.
    pub(super) gave_up_comparing: Option<Stamp>,
    n_revisions: u64,
    n_gestures: u64,
}

/// Roles that were not said but have to be found out from the content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Guess {
    /// Loads of this guess that have not ended.
    pub n_pending: usize,
}

impl AppState {
    /// A window without parts.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings: settings.sanitized(),
            ..Self::default()
        }
    }

    /// Tells how long the program runs; ends toasts whose time is over. To be called once a frame.
    pub fn tick(&mut self, now: Duration) {
        self.now = now;
        self.notices.expire(now);
    }

    /// The pose the stamped part is drawn at: that of the running match, of a shown start, of a
    /// scrubbed iteration, or the real one.
    pub fn shown_pose(&self) -> Similarity {
        if let Some(pose) = self.live_pose {
            return pose;
        }
        if self.is_as_loaded() {
            return Similarity::identity();
        }
        if let Some(start) = self.shown_start() {
            return start.target_from_source;
        }
        if let Some(pose) = self.previewed_pose() {
            return pose;
        }
        self.document.pose.crash_from_stamped
    }

    /// True while something else than the real pose is drawn.
    pub fn is_preview(&self) -> bool {
        self.live_pose.is_some()
            || self.is_as_loaded()
            || self.shown_start().is_some()
            || self.previewed_pose().is_some()
    }

    /// True if the stamped part has a pose.
    pub fn has_pose(&self) -> bool {
        self.document.pose.crash_from_stamped != Similarity::identity()
    }

    /// True while the stamped part is shown where its file has it, in spite of its pose.
    pub fn is_as_loaded(&self) -> bool {
        self.view.is_as_loaded && self.has_pose()
    }

    /// The first pose that is shown instead of the real one.
    pub fn shown_start(&self) -> Option<&Start> {
        let starts = self.current_starts()?;
        starts.poses.get(starts.shown?)
    }

    /// The first poses, if they belong to the parts that are loaded.
    pub fn current_starts(&self) -> Option<&Starts> {
        let parts = self.document.stamp().parts;
        self.starts.as_ref().filter(|s| s.parts == parts)
    }

    /// The tables of the running sweep as far as they are measured, or those of the last one.
    pub fn shown_sweep(&self) -> Option<&Sweep> {
        let so_far = self.sweep_so_far.as_ref();
        let running = so_far.filter(|_| self.jobs.is_active(JobKey::Sweep));
        running.map(|(sweep, _)| sweep).or(self.sweep.as_deref())
    }

    /// The measurement, if parts and pose are still those it was made at.
    pub fn current_measurement(&self) -> Option<&Coverage> {
        let stamp = self.document.stamp();
        let (at, measurement) = self.measurement.as_ref()?;
        (*at == stamp).then_some(&**measurement)
    }

    /// Distances and overlap of the current result at the pose that is shown: those of the match for its
    /// best pose, for an alternative what was measured there; `None` until that is known.
    pub fn result_coverage(&self) -> Option<&Coverage> {
        let result = self.document.current_result()?;
        match result.alternative {
            None => Some(&result.run.assessment.coverage),
            Some(_) => self.current_measurement(),
        }
    }

    /// The overlap at the pose the part has now.
    pub fn current_overlap(&self) -> Option<&PoseOverlap> {
        let stamp = self.document.stamp();
        self.overlap.as_ref().filter(|known| known.stamp == stamp)
    }

    /// The recording of a part's reduction, if one was made.
    pub fn recording(&self, role: Role) -> Option<&Arc<Recording>> {
        let revision = self.document.part(role)?.revision;
        let known = [&self.recordings.crash, &self.recordings.stamped];
        let of_part = |(of, _): &&(u64, _)| *of == revision;
        let found = known.into_iter().flatten().find(of_part);
        found.map(|(_, recording)| recording)
    }

    /// A number that was never given before.
    pub(super) fn next_revision(&mut self) -> u64 {
        self.n_revisions += 1;
        self.n_revisions
    }

    /// A name for a series of commands that is one undo step.
    pub(super) fn next_gesture(&mut self) -> GestureId {
        self.n_gestures += 1;
        // Panels count their own drags from 0; ours must not meet them.
        GestureId(u64::MAX - self.n_gestures)
    }

    /// The gesture of a series of changes of the match settings.
    pub(super) fn recipe_gesture(&mut self) -> GestureId {
        let open = self.open_recipe_gesture;
        let gesture = match open.filter(|gesture| self.history.is_open(*gesture)) {
            Some(gesture) => gesture,
            None => self.next_gesture(),
        };
        *self.open_recipe_gesture.insert(gesture)
    }

    /// Changes the document as one undo step; says whether anything changed.
    pub(super) fn commit(
        &mut self,
        name: impl Into<String>,
        change: impl FnOnce(&mut Document),
    ) -> bool {
        self.commit_in(name, None, change)
    }

    /// [`AppState::commit`] within a gesture.
    pub(super) fn commit_in(
        &mut self,
        name: impl Into<String>,
        gesture: Option<GestureId>,
        change: impl FnOnce(&mut Document),
    ) -> bool {
        let before = self.document.clone();
        change(&mut self.document);
        let has_changed = self.document != before;
        if has_changed {
            self.history.push(name.into(), before, gesture, self.now);
        }
        has_changed
    }

    /// Moves the stamped part as one undo step (or a part of one).
    pub(super) fn commit_pose(
        &mut self,
        name: impl Into<String>,
        gesture: Option<GestureId>,
        crash_from_stamped: Similarity,
    ) -> bool {
        if crash_from_stamped == self.document.pose.crash_from_stamped {
            return false;
        }
        let revision = self.next_revision();
        self.drop_previews();
        self.commit_in(name, gesture, |document| {
            document.pose = StampedPose {
                crash_from_stamped,
                revision,
            };
        })
    }

    /// Shows the real pose again.
    pub(super) fn drop_previews(&mut self) {
        self.view.hovered_preview = None;
        self.view.pinned_preview = None;
        self.view.is_as_loaded = false;
        if let Some(starts) = &mut self.starts {
            starts.shown = None;
        }
    }

    /// Adds a row to the log.
    pub(super) fn log_step(
        &mut self,
        step: &'static str,
        role: Option<Role>,
        text: impl Into<String>,
        took: Option<Duration>,
    ) {
        self.log_at(NoticeLevel::Info, step, role, text, took);
    }

    /// Adds a row to the log with a level, and a toast if the level has one.
    pub(super) fn log_at(
        &mut self,
        level: NoticeLevel,
        step: &'static str,
        role: Option<Role>,
        text: impl Into<String>,
        took: Option<Duration>,
    ) {
        let text = text.into();
        self.notify(level, text.clone());
        self.log.push(LogRow {
            at: self.clock.day_time_at(self.now),
            step,
            role,
            text,
            took,
            level,
            count: 1,
        });
    }

    /// Shows a toast, unless the user muted its level; the bell has it in any case.
    pub(super) fn notify(&mut self, level: NoticeLevel, text: impl Into<String>) {
        let is_muted = self.settings.muted.contains(&level);
        self.notices.push(level, text.into(), (self.now, is_muted));
    }

    /// A job for the worker, stamped with the present state.
    pub(super) fn start(&mut self, kind: JobKind) -> super::Effect {
        self.jobs.submitted(kind.key());
        super::Effect::StartJob(Box::new(kind), self.document.stamp())
    }
}
