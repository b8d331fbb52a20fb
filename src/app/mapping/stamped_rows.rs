//! The list of stamped files as section 4 shows it.

use std::path::PathBuf;

use super::{Further, FurtherPose, MappingState};
use crate::app::{AppState, Part, UnitHint, facts};
use crate::assess::Verdict;
use crate::jobs::JobKey;
use crate::pipeline::map::PoseOrigin;
use crate::pipeline::names::{file_name, told_apart};
use crate::role::PerRole;
use crate::units::Units;

/// A row of the list of stamped files.
#[derive(Debug, Clone, PartialEq)]
pub struct StampedRow {
    /// The file's name.
    pub name: String,
    /// Where it lies.
    pub path: PathBuf,
    /// Its number, and where its pose comes from; `None` for the first one, and for one that is not read.
    pub further: Option<(u64, FurtherPose)>,
    /// What is known of it.
    pub state: StampedState,
    /// Its number among the stamped files, which its colour follows; `None` for one that is not read.
    pub number: Option<usize>,
    /// It is drawn where there is a picture of it.
    pub is_shown: bool,
    /// Its units, where a further file has its own.
    pub own_units: Option<Units>,
    /// A further file whose pose is not good looks as if it were in another unit than the crash part.
    pub unit_hint: Option<UnitHint>,
    /// The command that takes it from the list; the first one stays.
    pub removed_by: Option<u64>,
}

/// What is known of a stamped file.
#[derive(Debug, Clone, PartialEq)]
pub enum StampedState {
    /// It is being read, or waits for that.
    Reading,
    /// It could not be read.
    NotRead(String),
    /// Its match waits for something.
    Waiting(&'static str),
    /// It is being matched.
    Matching,
    /// The match ended without a pose, for this reason if it was not given up.
    NotMatched(Option<String>),
    /// It was matched; the verdict and the match in a line.
    Matched(Verdict, String),
    /// The first one lies at another pose of its match; the verdict and the number of the pose, from 1.
    Alternative(Verdict, usize),
    /// It lies as the first one.
    AsFirst,
    /// The first one lies where a match had put it or was moved from there, and a part has changed since; in words.
    Outdated(String),
    /// The first one lies where it was put by hand.
    ByHand,
    /// The first one lies where its file has it.
    AsLoaded,
}

impl AppState {
    /// The list of stamped files: the first one, the further ones, those that are being read, those that
    /// could not be.
    pub fn stamped_rows(&self) -> Vec<StampedRow> {
        let Some(both) = self.document.both() else {
            return Vec::new();
        };
        let first = &both.stamped.loaded;
        let mut rows = vec![StampedRow {
            name: first.file_name(),
            path: first.path.clone(),
            further: None,
            state: self.first_state(),
            number: Some(0),
            is_shown: !self.is_file_hidden(&first.path),
            own_units: None,
            unit_hint: None,
            removed_by: None,
        }];
        let further = self.document.mapping.further.iter();
        rows.extend(further.map(|further| StampedRow {
            name: further.loaded.file_name(),
            path: further.loaded.path.clone(),
            further: Some((further.revision, further.pose)),
            state: self.further_state(further, both),
            number: self.document.file_number(further.revision),
            is_shown: !self.is_file_hidden(&further.loaded.path),
            own_units: further.loaded.settings.units,
            unit_hint: further.unit_hint(both),
            removed_by: Some(further.revision),
        }));
        let unread = |(revision, path, state): (u64, &PathBuf, StampedState)| StampedRow {
            name: file_name(path),
            path: path.clone(),
            further: None,
            state,
            number: None,
            is_shown: true,
            own_units: None,
            unit_hint: None,
            removed_by: Some(revision),
        };
        let MappingState {
            reading,
            unread: failed,
            ..
        } = &self.mapping;
        let reading = reading.iter();
        rows.extend(reading.map(|(number, path)| unread((*number, path, StampedState::Reading))));
        let failed = failed.iter();
        rows.extend(failed.map(|(number, (path, reason))| {
            unread((*number, path, StampedState::NotRead(reason.clone())))
        }));
        let paths: Vec<PathBuf> = rows.iter().map(|row| row.path.clone()).collect();
        for row in &mut rows {
            row.name = told_apart(&row.path, paths.iter().map(PathBuf::as_path));
        }
        rows
    }

    /// Why the match that the pose of a stamped file comes from, by the file's place in the list, is not good: the
    /// first reason of its verdict, as the card says it.
    pub fn match_doubt(&self, n: usize) -> Option<String> {
        let (verdict, reason) = match n.checked_sub(1) {
            None => {
                let PoseOrigin::Match { verdict } = self.document.pose_origin() else {
                    return None;
                };
                let result = self.document.result.as_ref()?;
                (verdict, result.run.assessment.reasons.first()?)
            }
            Some(further) => {
                let placing = self
                    .document
                    .mapping
                    .further
                    .get(further)?
                    .placing
                    .as_ref()?;
                (placing.verdict, placing.reason.as_ref()?)
            }
        };
        (verdict != Verdict::Good).then(|| self.reason_words(reason))
    }

    fn first_state(&self) -> StampedState {
        match self.document.current_result() {
            Some(result) => match result.alternative {
                None => {
                    let line = facts::match_line(&result.run, self.lengths());
                    StampedState::Matched(result.verdict(), line)
                }
                Some(index) => StampedState::Alternative(result.verdict(), index + 2),
            },
            None => match self.document.pose_origin() {
                origin @ PoseOrigin::Outdated { .. } => {
                    StampedState::Outdated(origin.words(self.lengths()))
                }
                _ if self.document.has_pose() => StampedState::ByHand,
                _ => StampedState::AsLoaded,
            },
        }
    }

    fn further_state(&self, further: &Further, both: PerRole<&Part>) -> StampedState {
        let Some(task) = further.task(both) else {
            return match &further.placing {
                Some(placing) if further.pose == FurtherPose::Matched => {
                    StampedState::Matched(placing.verdict, placing.line(self.lengths()))
                }
                _ => StampedState::AsFirst,
            };
        };
        if self.mapping.placing == Some(task) {
            return match self.jobs.running() {
                Some(job) if job.key == JobKey::PlaceFurther => StampedState::Matching,
                _ => StampedState::Waiting("waits for the task that runs"),
            };
        }
        let mut given_up = self.mapping.unplaced.iter();
        if let Some((_, reason)) = given_up.find(|(given_up, _)| *given_up == task) {
            return StampedState::NotMatched(reason.clone());
        }
        StampedState::Waiting(if self.is_part_open() {
            "waits for the match of the first one, which finds the crash part"
        } else {
            "waits for its turn"
        })
    }
}
