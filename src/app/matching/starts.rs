//! The starts of a match as the window lists them: those of the running one as they come in, those
//! of a finished one from its record.

use super::{MatchState, Preview};
use crate::app::{AppState, Document, Shared, facts};
use crate::geometry::{Point3, Similarity};
use crate::jobs::{JobKey, LiveIteration};
use crate::registration::starts::Start;
use crate::registration::{Extent, StartRecord, StartSettings};
use crate::role::Role;

/// The starts of the running match so far, or of the last one if it was cancelled or failed.
#[derive(Debug, Clone, Default)]
pub(super) struct LiveStarts {
    starts: Vec<StartRecord>,
}

impl LiveStarts {
    /// Adds what was reported, in the order it was.
    pub(super) fn add(
        &mut self,
        starts: Vec<(usize, StartRecord)>,
        iterations: Vec<LiveIteration>,
    ) {
        for (number, record) in starts {
            // Starts begin in the order of their numbers, so a new one is the next.
            match self.starts.get_mut(number) {
                Some(known) => {
                    let iterations = std::mem::take(&mut known.iterations);
                    *known = StartRecord {
                        iterations,
                        ..record
                    };
                }
                None => self.starts.push(record),
            }
        }
        for iteration in iterations {
            if let Some(start) = self.starts.get_mut(iteration.start) {
                start.add(iteration.record);
            }
        }
    }
}

impl MatchState {
    /// The first poses, in the order they are stepped through, if they belong to the parts that are loaded and to the
    /// settings.
    pub(in crate::app) fn starts_of(&self, document: &Document) -> Option<&Shared<Vec<Start>>> {
        let (made_with, starts) = self.starts.as_ref()?.current(document)?;
        let turns = |starts: &StartSettings| (starts.angle_segment_deg, starts.both_signs);
        (turns(made_with) == turns(&document.recipe.settings.starts)).then_some(starts)
    }

    fn live_starts(&self, document: &Document) -> &[StartRecord] {
        let known = self.live_starts.current(document);
        known.map_or(&[], |known| &known.starts)
    }

    fn match_starts<'a>(&'a self, document: &'a Document) -> &'a [StartRecord] {
        if self.has_live_starts(document) {
            return self.live_starts(document);
        }
        let result = document.result.as_ref();
        result.map_or(&[], |result| &result.run.outcome.starts)
    }

    /// One start of the running or last match by its number.
    pub(super) fn start<'a>(
        &'a self,
        document: &'a Document,
        number: usize,
    ) -> Option<&'a StartRecord> {
        self.match_starts(document).get(number)
    }

    /// True if the running match, or the last one that gave no result, reported starts.
    pub(in crate::app) fn has_live_starts(&self, document: &Document) -> bool {
        !self.live_starts(document).is_empty()
    }
}

impl AppState {
    /// The first poses, if they belong to the parts that are loaded.
    pub fn current_starts(&self) -> Option<&[Start]> {
        let starts = self.matching.starts_of(&self.document)?;
        Some(starts)
    }

    /// The first pose that is shown instead of the real one.
    pub fn shown_start(&self) -> Option<&Start> {
        self.current_starts()?.get(self.previews.start?)
    }

    /// The starts of the running match, of the result, or of the last run that gave none, in the
    /// order of their numbers.
    pub fn match_starts(&self) -> &[StartRecord] {
        self.matching.match_starts(&self.document)
    }

    /// One start by its number.
    pub fn match_start(&self, number: usize) -> Option<&StartRecord> {
        self.match_starts().get(number)
    }

    /// Poses of the result that fit nearly equally well, itself included; 0 without a result.
    pub fn n_equal_poses(&self) -> usize {
        let result = self.document.result.as_ref();
        result.map_or(0, |result| {
            let is_in_doubt = self.is_unit_in_doubt();
            let n_alternatives = if is_in_doubt {
                0
            } else {
                facts::n_alternatives(&result.run)
            };
            1 + n_alternatives
        })
    }

    /// Starts of the running match that have ended, and those that began.
    pub fn n_ended_starts(&self) -> [usize; 2] {
        let starts = self.matching.live_starts(&self.document);
        let n_ended = starts.iter().filter(|start| start.outcome.is_some());
        [n_ended.count(), starts.len()]
    }

    /// Where the stamped part lies in its own space, and how large it is; a point without one.
    pub fn stamped_extent(&self) -> Extent {
        let bounds = self.document.part(Role::Stamped).map(|part| part.bounds());
        let bounds = bounds.filter(|bounds| !bounds.is_empty());
        bounds.map_or_else(Extent::default, |bounds| Extent::from(&bounds))
    }

    /// Corners of the stamped part's box in its own space.
    pub fn stamped_corners(&self) -> Option<[Point3; 8]> {
        let bounds = self.document.part(Role::Stamped)?.bounds();
        (!bounds.is_empty()).then(|| bounds.corners())
    }

    /// What is shown instead of the real pose: under the pointer, else pinned.
    pub fn preview(&self) -> Option<Preview> {
        self.previews.of_match()
    }

    pub(in crate::app) fn previewed_pose(&self) -> Option<Similarity> {
        match self.preview()? {
            Preview::Start(start) => Some(self.match_start(start)?.last),
            Preview::Step { start, iteration } => {
                let iterations = &self.match_start(start)?.iterations;
                iterations.get(iteration).map(|it| it.target_from_source)
            }
        }
    }

    /// The start whose curve stands out: the chosen one, the winner, or while the match runs the one
    /// of the latest iteration.
    pub fn leading_start(&self) -> Option<usize> {
        let chosen = self.previews.chosen_start;
        if let Some(chosen) = chosen.filter(|&start| self.match_start(start).is_some()) {
            return Some(chosen);
        }
        if self.jobs.is_active(JobKey::Match) {
            let latest = self.jobs.running().and_then(|job| job.latest);
            return latest.map(|iteration| iteration.start);
        }
        if !self.matching.has_live_starts(&self.document) {
            let result = self.document.result.as_ref()?;
            return Some(result.run.outcome.winner);
        }
        Some(0)
    }
}
