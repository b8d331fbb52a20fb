//! The whole state of the window, composed of the states of its topics.

use std::time::Duration;

use super::follow_up::FollowUp;
use super::view::Scene;
use super::work::Work;
use super::{
    Document, FreeWindow, History, InspectState, JobBoard, LogState, MappingState, MatchState,
    MovingState, PairsState, PartsState, Previews, ProjectState, Reason, ReduceState, Settings,
    ViewState,
};
use crate::geometry::Similarity;

/// Everything the window knows. Panels read it; beside the time, which [`AppState::tick`] tells, only
/// [`AppState::apply`] changes it, and hands each topic its own state and the `Work`.
#[derive(Debug, Clone, Default)]
pub struct AppState {
    /// What undo covers.
    pub document: Document,
    /// Undo and redo.
    pub history: History,
    /// What runs and what waits.
    pub jobs: JobBoard,
    /// Preferences.
    pub settings: Settings,
    /// The log, toasts and bell, and the time.
    pub log: LogState,
    /// Poses that are shown instead of the real one.
    pub previews: Previews,
    /// The files and the parts in them.
    pub parts: PartsState,
    /// Levels of reduction.
    pub reduce: ReduceState,
    /// Alignment, match and sweep.
    pub matching: MatchState,
    /// Further stamped files that are read and matched.
    pub mapping: MappingState,
    /// Moves by hand.
    pub moving: MovingState,
    /// Picked pairs of points.
    pub pairs: PairsState,
    /// Deviation, section and distances.
    pub inspect: InspectState,
    /// What is shown and how.
    pub view: ViewState,
    /// The project that is worked on.
    pub project: ProjectState,
    /// Empty between two commands.
    pub(super) follow_ups: Vec<FollowUp>,
}

/// The state of each topic, lent beside the `Work`.
pub(super) struct Topics<'a> {
    pub parts: &'a mut PartsState,
    pub reduce: &'a mut ReduceState,
    pub matching: &'a mut MatchState,
    pub mapping: &'a mut MappingState,
    pub moving: &'a mut MovingState,
    pub pairs: &'a mut PairsState,
    pub inspect: &'a mut InspectState,
    pub view: &'a mut ViewState,
    pub project: &'a mut ProjectState,
}

impl AppState {
    /// A window without parts.
    pub fn new(settings: Settings) -> Self {
        let settings = settings.sanitized();
        let mut state = Self::default();
        state.view.display.coloring = state.view.display.coloring.with_maps_of(&settings);
        state.settings = settings;
        state
    }

    /// Tells how long the program runs; ends toasts whose time is over. To be called once a frame.
    pub fn tick(&mut self, now: Duration) {
        self.log.tick(now);
    }

    /// The work and the topics, so that a topic can be given both.
    pub(super) fn split(&mut self) -> (Work<'_>, Topics<'_>) {
        let Self {
            document,
            history,
            jobs,
            settings,
            log,
            previews,
            parts,
            reduce,
            matching,
            mapping,
            moving,
            pairs,
            inspect,
            view,
            project,
            follow_ups,
        } = self;
        let work = Work {
            document,
            history,
            jobs,
            settings,
            log,
            previews,
            follow_ups,
        };
        let topics = Topics {
            parts,
            reduce,
            matching,
            mapping,
            moving,
            pairs,
            inspect,
            view,
            project,
        };
        (work, topics)
    }

    /// The work alone.
    pub(super) fn work(&mut self) -> Work<'_> {
        self.split().0
    }

    /// Lets the view look at what there is to be seen.
    pub(super) fn with_scene<R>(
        &mut self,
        look: impl FnOnce(&mut ViewState, &Scene<'_>) -> R,
    ) -> R {
        let beside = self.free_window();
        let starts = self.matching.starts_of(&self.document);
        let starts = starts.filter(|_| self.previews.start.is_some());
        let starts = starts.map_or(&[][..], |starts| starts.as_slice());
        let scene = Scene {
            is_beside: beside.is_some_and(FreeWindow::is_picture),
            are_compared: self.are_windows_compared(),
            pose: self.shown_pose(),
            starts,
            document: &self.document,
            selected: &self.parts.selected,
            further: self.shown_further(),
        };
        look(&mut self.view, &scene)
    }

    /// The pose the stamped part is drawn at: that of the running match, of a shown start, of a
    /// scrubbed iteration, or the real one.
    pub fn shown_pose(&self) -> Similarity {
        if let Some(pose) = self.previews.live {
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
        self.previews.live.is_some() || self.is_chosen_preview()
    }

    /// True while a preview is chosen that the user can close, unlike the pose of the running match.
    pub(super) fn is_chosen_preview(&self) -> bool {
        self.is_as_loaded() || self.shown_start().is_some() || self.previewed_pose().is_some()
    }

    /// `Ok` unless something else is looked at than the pose that would be written, copied or mapped at.
    pub fn shows_its_pose(&self) -> Result<(), Reason> {
        if self.previews.live.is_some() {
            return Err(Reason("A match is running."));
        }
        if self.is_as_loaded() {
            return Err(Reason(
                "The stamped part is shown as loaded: show it at its pose first.",
            ));
        }
        if self.is_chosen_preview() {
            return Err(Reason("A start is previewed: show the real pose first."));
        }
        Ok(())
    }

    /// True while the stamped part is shown where its file has it, in spite of its pose.
    pub fn is_as_loaded(&self) -> bool {
        self.previews.is_as_loaded && self.document.has_pose()
    }
}
