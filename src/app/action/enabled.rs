use super::{Action, Reason};
use crate::app::{AppState, facts};
use crate::jobs::{JobKey, Role};

fn require(is_met: bool, otherwise: &'static str) -> Result<(), Reason> {
    if is_met {
        Ok(())
    } else {
        Err(Reason(otherwise))
    }
}

impl Action {
    /// `Ok` if the action is possible now, else why it is not.
    pub fn enabled(self, state: &AppState) -> Result<(), Reason> {
        use Action as A;
        match self {
            A::OpenCrash | A::OpenStamped | A::OpenExample | A::OpenProject => state.is_unlocked(),
            A::SaveProject | A::SaveProjectAs => state.has_any_part(),
            A::ReloadAll | A::Swap | A::BackToAsLoaded => {
                state.has_any_part()?;
                state.is_unlocked()
            }
            A::CloseCrash => unlocked_with(state, Role::Crash),
            A::CloseStamped => unlocked_with(state, Role::Stamped),
            A::Undo => {
                require(state.history.undo_name().is_some(), "nothing to undo")?;
                state.is_unlocked()
            }
            A::Redo => {
                require(state.history.redo_name().is_some(), "nothing to redo")?;
                state.is_unlocked()
            }
            A::HideSelected | A::IsolateSelected => {
                require(!state.view.selected.is_empty(), "select a part first")
            }
            A::MoveTool | A::RotateTool | A::TurnOverX | A::TurnOverY | A::TurnOverZ => {
                state.can_move()
            }
            A::ResetPose => {
                state.can_move()?;
                let pose = state.document.crash_from_stamped();
                let is_moved = *pose != crate::geometry::Similarity::identity();
                require(is_moved, "the part is where its file has it")
            }
            A::BringCentersTogether | A::Align | A::Measure => state.can_match(),
            A::PairTool | A::Refine => state.can_match(),
            A::FitPairs => state.can_fit_pairs(),
            A::ToggleMoveOver | A::CopyCommandLine | A::SaveDeviations => state.has_both_parts(),
            A::Reduce => state.can_reduce(),
            A::NextLevel | A::PreviousLevel => level_step(self, state),
            A::ReduceToFull | A::ToggleDetailed | A::ToggleSplit => is_reduced(state),
            A::NextStart | A::PreviousStart => has_starts(state),
            A::UseStart => {
                has_starts(state)?;
                require(state.shown_start().is_some(), "show a start first")
            }
            A::MatchOrStop => {
                if state.jobs.is_active(JobKey::Match) {
                    Ok(())
                } else {
                    state.can_match()?;
                    state.has_start_pose()
                }
            }
            A::CancelRun => require(state.locking_job().is_some(), "nothing is running"),
            A::FlipAlternative => has_alternative(state),
            A::ToggleDeviation | A::ToggleOverlap | A::UpdateDeviation => state.has_both_parts(),
            A::ToggleSection
            | A::SectionX
            | A::SectionY
            | A::SectionZ
            | A::SectionView
            | A::ToggleSectionClip => state.has_any_part(),
            A::SectionForward | A::SectionBack => {
                state.has_any_part()?;
                require(state.view.section.is_on, "show the section first")
            }
            A::CopyMatrix | A::SaveMatrix | A::SaveMoved => state.has_part(Role::Stamped),
            A::SaveRecord | A::SaveReport | A::SaveCards => {
                let has_result = state.document.current_result().is_some();
                require(has_result, "run a match first")
            }
            A::ClearPivot => require(
                state.view.pivot.get(state.view.focus).is_some(),
                "no pivot was picked",
            ),
            A::PictureOptions
            | A::TakePicture
            | A::TakePictureTransparent
            | A::FitAll
            | A::FocusSelection => state.has_any_part(),
            _ => Ok(()),
        }
    }
}

fn unlocked_with(state: &AppState, role: Role) -> Result<(), Reason> {
    state.has_part(role)?;
    state.is_unlocked()
}

fn is_reduced(state: &AppState) -> Result<(), Reason> {
    let is_reduced = |role| state.document.part(role).is_some_and(|p| p.level.is_some());
    let any = Role::ALL.into_iter().any(is_reduced);
    require(any, "nothing is reduced")
}

fn level_step(action: Action, state: &AppState) -> Result<(), Reason> {
    state.can_reduce()?;
    let roles = state.settings.reduce_roles;
    let is_ticked = Role::ALL
        .into_iter()
        .any(|role| *roles.get(role) && state.document.part(role).is_some());
    require(is_ticked, "tick a loaded part to reduce")?;
    let direction = if action == Action::NextLevel { 1 } else { -1 };
    require(
        state.next_level(direction).is_some(),
        if direction > 0 {
            "this is the coarsest marked level"
        } else {
            "this is the full mesh"
        },
    )
}

fn has_starts(state: &AppState) -> Result<(), Reason> {
    let n_starts = state.current_starts().map_or(0, |s| s.poses.len());
    require(n_starts > 0, "align the surface normals first")?;
    state.is_unlocked()
}

fn has_alternative(state: &AppState) -> Result<(), Reason> {
    let result = state.document.result.as_ref();
    let run = result.ok_or(Reason("run a match first"))?;
    let n_alternatives = facts::n_alternatives(&run.run);
    require(n_alternatives > 0, "no other pose fits nearly as well")?;
    let is_same_pair = run.stamp.parts == state.document.stamp().parts;
    require(is_same_pair, "a part was exchanged after the match")?;
    state.is_unlocked()
}
