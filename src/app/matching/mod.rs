//! Alignment, match and sweep: what was found, what is running, and which of its poses are looked at.

mod command;
mod explain;
mod first_poses;
mod judge;
mod measure;
mod preview;
mod result;
mod run;
mod starts;
mod sweep;

pub use command::{MatchCommand, PreviewCommand};
pub use explain::Cause;
pub use preview::{Preview, Previews};

use self::starts::LiveStarts;
use super::history::step_words;
use super::work::Work;
use super::{AppState, Document, Effect, GestureId, OfParts, Reason, Shared};
use crate::jobs::{Live, Measurement, Stamp, SweepRows};
use crate::pipeline::sweep::Sweep;
use crate::registration::starts::Start;
use crate::registration::{Method, StartSettings};
use crate::settings::{SETTINGS, changed_setting};

/// A match that gave no pose.
#[derive(Debug, Clone)]
struct Failure {
    /// How it was run.
    method: Method,
    /// What it said.
    message: String,
}

/// What alignment, match, measurement and sweep gave, beside the result in the document.
#[derive(Debug, Clone, Default)]
pub struct MatchState {
    /// The first poses of the last alignment, with the settings they were made with.
    starts: Option<OfParts<(StartSettings, Shared<Vec<Start>>)>>,
    /// The starts of the running match, or of the last one if it gave no result.
    live_starts: OfParts<LiveStarts>,
    /// Why the last match gave no result.
    failure: Option<OfParts<Failure>>,
    /// The undo step of a remedy whose match has not ended.
    remedy_gesture: Option<GestureId>,
    /// Distances and overlap with the state they were measured in.
    measurement: Option<(Stamp, Shared<Measurement>)>,
    /// The state and the shape tolerance of the alternative that was measured last without being asked for.
    alternative_asked: Option<(Stamp, f64)>,
    /// The state and the shape tolerance of the verdict that was asked for last.
    judging_asked: Option<(Stamp, f64)>,
    /// The tables of the last sweep.
    sweep: Option<OfParts<Shared<Sweep>>>,
    /// The rows of the running sweep, and where the next ones come from.
    sweep_so_far: Option<OfParts<(Sweep, SweepRows)>>,
}

impl AppState {
    /// `Ok` if the match may start now.
    pub fn can_match(&self) -> Result<(), Reason> {
        self.document.can_match(&self.jobs)
    }

    /// `Ok` if it may start as the recipe says.
    pub fn can_match_as_asked(&self) -> Result<(), Reason> {
        self.can_match()?;
        self.document.has_start_pose()
    }
}

impl MatchState {
    pub(super) fn apply(&mut self, work: &mut Work<'_>, command: MatchCommand) -> Vec<Effect> {
        match command {
            MatchCommand::SetRecipe(recipe) => {
                // A slider sends many recipes, which are one step.
                let change = changed_setting(&SETTINGS, [&work.document.recipe, &*recipe]);
                let [about, name] = step_words("Match settings", change, work.lengths());
                let gesture = work.history.series(&about, work.log.now);
                self.change_recipe(work, &name, gesture, |d| d.set_recipe(*recipe));
            }
            MatchCommand::SetRemedy {
                name,
                recipe,
                is_matched,
            } => {
                let gesture = GestureId::new();
                let has_changed =
                    self.change_recipe(work, &name, gesture, |d| d.set_remedy(*recipe));
                self.remedy_gesture = (has_changed && is_matched).then_some(gesture);
            }
            MatchCommand::Align => return run::align(work),
            MatchCommand::ShowStart(index) => self.show_start(work, index),
            MatchCommand::StepStart(direction) => self.step_start(work, direction),
            MatchCommand::UseMatchStart(index) => self.use_match_start(work, index),
            MatchCommand::UseStart(index) => self.use_start(work, index),
            MatchCommand::Run => return self.run_match(work),
            MatchCommand::Refine => return self.refine(work),
            MatchCommand::Stop => return run::stop_run(work),
            MatchCommand::Cancel => return run::cancel_run(work),
            MatchCommand::ShowAlternative(index) => result::show_alternative(work, index),
            MatchCommand::NextAlternative => result::next_alternative(work),
            MatchCommand::Measure => return measure::measure(work),
            MatchCommand::Sweep(settings) => return self.run_sweep(work, *settings),
        }
        Vec::new()
    }

    /// The tables of the last sweep of the parts that are loaded.
    pub(super) fn sweep(&self, document: &Document) -> Option<&Shared<Sweep>> {
        self.sweep.as_ref()?.current(document)
    }

    /// A project was opened: only its sweep is known.
    pub(super) fn reopen(&mut self, document: &Document, sweep: Option<Shared<Sweep>>) {
        self.sweep = sweep.map(|sweep| OfParts::new(document, sweep));
        self.starts = None;
        self.measurement = None;
        self.live_starts = OfParts::default();
    }

    /// The running match reported its progress.
    pub(super) fn take_live(&mut self, work: &mut Work<'_>, live: Live) {
        if let Some(best) = &live.best {
            work.previews.live = Some(best.target_from_source);
        }
        if let Some(known) = self.live_starts.current_mut(work.document) {
            known.add(live.starts, live.iterations);
        }
    }

    /// A match ended without a result. Its starts are worth seeing only where nothing better is.
    pub(super) fn match_ended(&mut self, work: &mut Work<'_>) {
        work.previews.live = None;
        if work.document.result.is_some() {
            self.live_starts = OfParts::default();
        }
    }

    /// A match was given up: the remedy that began it too.
    pub(super) fn match_cancelled(&mut self, work: &mut Work<'_>) {
        let gesture = self.remedy_gesture.take();
        let before = gesture.and_then(|gesture| work.history.abandon_gesture(gesture));
        if let Some(before) = before {
            *work.document = before;
        }
    }

    /// The last match gave no pose.
    pub(super) fn match_failed(&mut self, work: &Work<'_>, message: String) {
        self.remedy_gesture = None;
        let failure = Failure {
            method: work.document.recipe.settings.method,
            message,
        };
        self.failure = Some(OfParts::new(work.document, failure));
    }
}
