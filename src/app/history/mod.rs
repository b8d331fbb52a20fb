//! The steps done and undone, with their names.

mod apply;
mod command;

use std::cmp::Ordering;
use std::sync::Arc;
use std::sync::atomic::{self, AtomicU64};
use std::time::Duration;

pub use command::HistoryCommand;

use super::{Document, Part};
use crate::role::Role;
use crate::settings::{Setting, Value};
use crate::text::Lengths;

/// Undo steps that are kept; an old document costs little, but not nothing.
const MAX_STEPS: usize = 500;

/// Commands of a series follow each other within this time, as those of a slider that is dragged do.
const SERIES: Duration = Duration::from_secs(1);

/// Names a drag, a typed value or another series of commands that is undone as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GestureId(pub u64);

impl GestureId {
    /// One that was never given before.
    #[expect(clippy::new_without_default, reason = "each is another one")]
    pub fn new() -> Self {
        // Lower ones are left to name.
        static NEXT: AtomicU64 = AtomicU64::new(1 << 32);
        Self(NEXT.fetch_add(1, atomic::Ordering::Relaxed))
    }

    /// That of the text of a label, by the label's number.
    pub fn of_label(id: u64) -> Self {
        Self(1 << 63 | id)
    }
}

#[derive(Debug, Clone)]
struct Step {
    name: String,
    /// When it was done last, since the program began.
    at: Duration,
    /// For a step that was done: the document before. For one that was undone: the one after.
    document: Document,
}

/// What a step changed first of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    /// Files came, went or changed places.
    Files,
    /// Units or chosen parts.
    Selection,
    /// A match was taken over.
    Match,
    /// Forming results were mapped.
    Map,
    /// A level of reduction.
    Level,
    /// The pose.
    Pose,
    /// What is shown and in which colours.
    Display,
    /// The settings of the match.
    Settings,
    /// Anything else, for example a label.
    Other,
}

impl StepKind {
    /// What lies between two documents.
    pub fn between(before: &Document, after: &Document) -> Self {
        let differs = |is: fn(&Part, &Part) -> bool| {
            let of = |role| (before.part(role), after.part(role));
            Role::ALL.into_iter().any(|role| match of(role) {
                (Some(old), Some(new)) => is(old, new),
                (None, None) => false,
                _ => true,
            })
        };
        // A match that was only judged anew is the same match.
        let run = |document: &Document| {
            let result = document.result.as_ref();
            result.map(|result| Arc::as_ptr(&result.run.outcome))
        };
        let [old_map, new_map] = [before, after].map(|document| {
            let result = document.mapping.result.as_ref();
            result.map(|result| &result.run)
        });
        let further = |document: &Document| -> Vec<u64> {
            let all = document.mapping.further.iter();
            all.map(|further| further.revision).collect()
        };
        if differs(|old, new| old.source != new.source) || further(before) != further(after) {
            Self::Files
        } else if after.result.is_some() && run(before) != run(after) {
            Self::Match
        } else if new_map.is_some() && old_map != new_map {
            Self::Map
        } else if differs(|old, new| old.loaded != new.loaded)
            || before.all_meant_for != after.all_meant_for
        {
            Self::Selection
        } else if differs(|old, new| old.level != new.level) {
            Self::Level
        } else if before.pose != after.pose {
            Self::Pose
        } else if differs(|old, new| (&old.hidden, &old.colors) != (&new.hidden, &new.colors)) {
            Self::Display
        } else if before.recipe != after.recipe || before.mapping.recipe != after.mapping.recipe {
            Self::Settings
        } else {
            Self::Other
        }
    }

    /// A sign for it.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Files => "🗁",
            Self::Selection => "☑",
            Self::Match => "🎯",
            Self::Map => "▦",
            Self::Level => "◢",
            Self::Pose => "↔",
            Self::Display => "👁",
            Self::Settings => "⚙",
            Self::Other => "✏",
        }
    }

    /// The sign in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Files => "files",
            Self::Selection => "choice of parts or units",
            Self::Match => "match",
            Self::Map => "mapping",
            Self::Level => "level",
            Self::Pose => "pose",
            Self::Display => "display",
            Self::Settings => "settings",
            Self::Other => "note",
        }
    }
}

/// A step as the history's tab shows it.
#[derive(Debug, Clone)]
pub struct HistoryRow<'a> {
    /// Name of the step, as the undo menu shows it.
    pub name: &'a str,
    /// What it changed.
    pub kind: StepKind,
    /// When it was done last, since the program began.
    pub at: Duration,
    /// The work after it.
    pub document: &'a Document,
}

/// What a change of settings is about, and its name: "Tolerance 0.3 mm", or `several` of more than one.
pub(super) fn step_words<R>(
    several: &str,
    change: Option<(&Setting<R>, Value)>,
    lengths: Lengths,
) -> [String; 2] {
    match change {
        Some((setting, value)) => {
            let value = setting.shown(&value, lengths);
            // Two tables have settings of one label.
            let about = format!("{several}: {}", setting.field);
            [about, format!("{} {value}", setting.label)]
        }
        None => [several.to_owned(), several.to_owned()],
    }
}

/// One ordered history of whole documents.
#[derive(Debug, Clone, Default)]
pub struct History {
    done: Vec<Step>,
    undone: Vec<Step>,
    open_gesture: Option<GestureId>,
    /// What the last series is about, and its name.
    series: Option<(String, GestureId)>,
    n_revisions: u64,
}

impl History {
    /// A number that was never given before.
    pub(super) fn next_revision(&mut self) -> u64 {
        self.n_revisions += 1;
        self.n_revisions
    }

    /// The series about this that the last step is part of, if that was made just before `now`, or a new one.
    pub(super) fn series(&mut self, about: &str, now: Duration) -> GestureId {
        let is_recent = |step: &Step| now.saturating_sub(step.at) < SERIES;
        let is_going_on = self.done.last().is_some_and(is_recent);
        let known = self.series.as_ref().filter(|(known, _)| known == about);
        let known = known.map(|(_, gesture)| *gesture);
        known
            .filter(|gesture| is_going_on && self.is_open(*gesture))
            .unwrap_or_else(|| {
                let gesture = GestureId::new();
                self.series = Some((about.to_owned(), gesture));
                gesture
            })
    }

    /// Notes a step that led away from `before`. Further steps of the same gesture only rename it.
    pub fn push(
        &mut self,
        name: String,
        before: Document,
        gesture: Option<GestureId>,
        at: Duration,
    ) {
        self.undone.clear();
        if gesture.is_some()
            && gesture == self.open_gesture
            && let Some(last) = self.done.last_mut()
        {
            last.name = name;
            last.at = at;
            return;
        }
        self.open_gesture = gesture;
        if self.done.len() == MAX_STEPS {
            self.done.remove(0);
        }
        let document = before;
        self.done.push(Step { name, at, document });
    }

    /// True while the last step is that of this gesture and may still change.
    pub fn is_open(&self, gesture: GestureId) -> bool {
        self.open_gesture == Some(gesture)
    }

    /// Ends the open gesture; one that came back to where it began leaves no step.
    pub fn end_gesture(&mut self, current: &Document) {
        if self.open_gesture.take().is_some() {
            let is_idle = self.done.last().is_some_and(|s| s.document == *current);
            if is_idle {
                self.done.pop();
            }
        }
    }

    /// Takes the open gesture back: the document it began with, without a trace to redo.
    pub fn abandon_gesture(&mut self, gesture: GestureId) -> Option<Document> {
        if self.open_gesture != Some(gesture) {
            return None;
        }
        self.open_gesture = None;
        self.done.pop().map(|step| step.document)
    }

    /// Steps back: the name of the step and the document before it.
    pub fn undo(&mut self, current: Document) -> Option<(String, Document)> {
        self.open_gesture = None;
        shift(&mut self.done, &mut self.undone, current)
    }

    /// Steps forward again.
    pub fn redo(&mut self, current: Document) -> Option<(String, Document)> {
        self.open_gesture = None;
        shift(&mut self.undone, &mut self.done, current)
    }

    /// Name of the step that undo takes back.
    pub fn undo_name(&self) -> Option<&str> {
        self.done.last().map(|s| s.name.as_str())
    }

    /// When the step that undo takes back was done last.
    pub fn undo_at(&self) -> Option<Duration> {
        self.done.last().map(|s| s.at)
    }

    /// Name of the step that redo brings back.
    pub fn redo_name(&self) -> Option<&str> {
        self.undone.last().map(|s| s.name.as_str())
    }

    /// All steps, oldest first; those from [`History::n_done`] on are undone.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let undone = self.undone.iter().rev();
        self.done.iter().chain(undone).map(|s| s.name.as_str())
    }

    /// The step with that number, counted from 0, those that are undone included.
    pub fn row<'a>(&'a self, index: usize, current: &'a Document) -> Option<HistoryRow<'a>> {
        let n_done = self.done.len();
        let undone = |index: usize| {
            let from_end = index.checked_sub(n_done)?;
            let at = self.undone.len().checked_sub(from_end + 1)?;
            self.undone.get(at)
        };
        // The document after so many steps.
        let after = |n: usize| match n.cmp(&n_done) {
            Ordering::Less => self.done.get(n).map(|step| &step.document),
            Ordering::Equal => Some(current),
            Ordering::Greater => undone(n - 1).map(|step| &step.document),
        };
        let step = self.done.get(index).or_else(|| undone(index))?;
        let (before, document) = (after(index)?, after(index + 1)?);
        Some(HistoryRow {
            name: &step.name,
            kind: StepKind::between(before, document),
            at: step.at,
            document,
        })
    }

    /// Steps that are in force.
    pub fn n_done(&self) -> usize {
        self.done.len()
    }

    /// Steps that can be brought back.
    pub fn n_undone(&self) -> usize {
        self.undone.len()
    }
}

fn shift(
    from: &mut Vec<Step>,
    to: &mut Vec<Step>,
    current: Document,
) -> Option<(String, Document)> {
    let step = from.pop()?;
    let name = step.name.clone();
    to.push(Step {
        name: step.name,
        at: step.at,
        document: current,
    });
    Some((name, step.document))
}
