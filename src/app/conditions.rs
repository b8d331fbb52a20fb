//! What stands in the way of an action: parts that are missing, jobs that hold the inputs.

use super::{Document, JobBoard, MatchResult, Reason};
use crate::jobs::JobKey;
use crate::role::Role;

/// What became of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PartChange {
    /// Its lengths are multiplied by another factor.
    Unit,
    /// It was read again, or other pieces of it were chosen.
    Part,
}

impl JobBoard {
    /// The job that keeps files, levels and poses as they are, if one runs.
    pub fn locking_job(&self) -> Option<JobKey> {
        let locks = [JobKey::Match, JobKey::Align, JobKey::Sweep];
        locks.into_iter().find(|key| self.is_active(*key))
    }

    /// `Ok` unless a match or sweep holds the inputs.
    pub fn is_unlocked(&self) -> Result<(), Reason> {
        match self.locking_job() {
            None => Ok(()),
            Some(JobKey::Sweep) => Err(Reason("A sweep is running.")),
            Some(JobKey::Align) => Err(Reason("The surface normals are being aligned.")),
            Some(_) => Err(Reason("A match is running.")),
        }
    }

    /// `Ok` unless a part is being read or taken otherwise from its deck: another one takes its place soon.
    pub fn are_parts_read(&self) -> Result<(), Reason> {
        let of_role = |role| [JobKey::Load(role), JobKey::Reselect(role)];
        let mut keys = (Role::ALL.into_iter().flat_map(of_role)).chain([JobKey::OpenProject]);
        if keys.any(|key| self.is_active(key)) {
            return Err(Reason("A part is still being read."));
        }
        Ok(())
    }
}

impl Document {
    /// `Ok` if this part is loaded.
    pub fn has_part(&self, role: Role) -> Result<(), Reason> {
        match (self.part(role), role) {
            (Some(_), _) => Ok(()),
            (None, Role::Crash) => Err(Reason("Load the crash part first.")),
            (None, Role::Stamped) => Err(Reason("Load the stamped part first.")),
        }
    }

    /// `Ok` if a part is loaded.
    pub fn has_any_part(&self) -> Result<(), Reason> {
        self.has_part(Role::Crash)
            .or_else(|_| self.has_part(Role::Stamped))
            .map_err(|_| Reason("Load a part first."))
    }

    /// `Ok` if both parts are loaded.
    pub fn has_both_parts(&self) -> Result<(), Reason> {
        let any = self.has_any_part();
        any.map_err(|_| Reason("Load both parts first."))?;
        self.has_part(Role::Crash)?;
        self.has_part(Role::Stamped)
    }

    /// The match of the parts as they are, wherever the stamped part lies by now.
    pub fn match_of_parts(&self) -> Result<&MatchResult, Reason> {
        let result = self.result.as_ref().ok_or(Reason("Run a match first."))?;
        match self.change_after(result) {
            None => Ok(result),
            Some(PartChange::Unit) => {
                Err(Reason("The unit was changed after the match: match again."))
            }
            Some(PartChange::Part) => {
                Err(Reason("A part was changed after the match: match again."))
            }
        }
    }

    /// What became of the parts of a match; `None` while they are the same.
    pub(super) fn change_after(&self, result: &MatchResult) -> Option<PartChange> {
        if result.stamp.parts == self.stamp().parts {
            None
        } else if result.length_factors != self.length_factors() {
            Some(PartChange::Unit)
        } else {
            Some(PartChange::Part)
        }
    }

    /// `Ok` if there is a match that stands for the pose.
    pub fn has_result(&self) -> Result<(), Reason> {
        self.match_of_parts()?;
        match self.current_result() {
            Some(_) => Ok(()),
            None => Err(Reason(
                "The pose was changed after the match. Go back to the result, or match again.",
            )),
        }
    }

    /// `Ok` if the stamped part may be moved while these jobs run.
    pub fn can_move(&self, jobs: &JobBoard) -> Result<(), Reason> {
        self.has_part(Role::Stamped)?;
        jobs.is_unlocked()
    }

    /// `Ok` if a match may start while these jobs run.
    pub fn can_match(&self, jobs: &JobBoard) -> Result<(), Reason> {
        self.has_both_parts()?;
        jobs.are_parts_read()?;
        jobs.is_unlocked()
    }
}
