//! The menu *Match*: reduction, first poses, the match and its result.

use super::conditions::{has_mapping, has_starts, is_reduced, require};
use super::row::keys::{ctrl, function, key, shift};
use super::row::some;
use super::{Action, ActionRow, Key, Keys, MenuGroup, Reason, Shortcut};
use crate::app::{AppState, MapCommand, MatchCommand, PairCommand, ReduceCommand, facts};
use crate::jobs::JobKey;
use crate::role::{PerRole, Role};

pub(super) const GROUPS: &[MenuGroup] = &[
    MenuGroup::plain(REDUCE),
    MenuGroup::plain(STARTS),
    MenuGroup::plain(MATCH),
    MenuGroup::plain(RESULT),
    MenuGroup::plain(MAP),
];

const MAP: &[ActionRow] = &[
    ActionRow {
        action: Action::AddStamped,
        label: "Add file…",
        tooltip: "One more stamped file for the same crash part, for example of a patch or of the other \
                  half: it is matched by itself, and mapped from with the others",
        keys: Keys::NONE,
        enabled: |state| state.document.has_both_parts(),
        command: |_| some(MapCommand::AskFurther),
    },
    ActionRow {
        action: Action::MapOrCancel,
        label: "Map",
        tooltip: "Carry thickness, strain and stress of the stamped part onto the crash part; while it \
                  runs, give it up",
        keys: Keys::press(&[ctrl('M')]),
        enabled: AppState::can_map,
        command: |_| some(MapCommand::MapOrCancel),
    },
    ActionRow {
        action: Action::MapAsLoaded,
        label: "Map as loaded",
        tooltip: "Map without a match, where the stamped file has its part: right only if both files \
                  have one position",
        keys: Keys::NONE,
        enabled: AppState::can_map_as_loaded,
        command: |_| some(MapCommand::MapAsLoaded),
    },
    ActionRow {
        action: Action::CompareMapping,
        label: "Compare mapping…",
        tooltip: "Show the difference to the result of another mapper or the solver's own file (dyna.inc), \
                  element by element; while it runs, give it up",
        keys: Keys::NONE,
        enabled: has_mapping,
        command: |_| some(MapCommand::AskOther),
    },
    ActionRow {
        action: Action::EndMapComparison,
        label: "End the comparison",
        tooltip: "Compare mappings with the other file no longer",
        keys: Keys::NONE,
        enabled: |state| {
            require(
                state.document.mapping.compare_with.is_some(),
                "Mappings are compared with no file.",
            )
        },
        command: |_| some(MapCommand::EndComparison),
    },
];

const REDUCE: &[ActionRow] = &[
    ActionRow {
        action: Action::Reduce,
        label: "Reduce",
        tooltip: "Reduce the ticked parts to the maximum number of triangles",
        keys: Keys::NONE,
        enabled: AppState::can_reduce,
        command: |state| {
            some(ReduceCommand::To {
                roles: state.settings.reduce_roles,
                max_triangles: state.settings.max_triangles,
            })
        },
    },
    ActionRow {
        action: Action::ReduceToFull,
        label: "Full mesh",
        tooltip: "Go back to the full meshes",
        keys: Keys::NONE,
        enabled: is_reduced,
        command: |_| {
            some(ReduceCommand::Full(PerRole {
                crash: true,
                stamped: true,
            }))
        },
    },
    ActionRow {
        action: Action::NextLevel,
        label: "Coarser level",
        tooltip: "Next marked level with fewer triangles",
        keys: Keys::repeat(&[Shortcut::plain(Key::PageUp)]),
        enabled: |state| level_step(state, 1, "There is no coarser marked level."),
        command: |_| some(ReduceCommand::Step(1)),
    },
    ActionRow {
        action: Action::PreviousLevel,
        label: "Finer level",
        tooltip: "Next marked level with more triangles",
        keys: Keys::repeat(&[Shortcut::plain(Key::PageDown)]),
        enabled: |state| level_step(state, -1, "This is the full mesh."),
        command: |_| some(ReduceCommand::Step(-1)),
    },
];

const STARTS: &[ActionRow] = &[
    ActionRow {
        action: Action::Align,
        label: "Align surface normals",
        tooltip: "Make first poses by aligning the mean surface normals. For a piece of a part the wide \
                  search of the match does it locally: the mean normal of the piece on that of every \
                  patch as large",
        keys: Keys::press(&[key('A')]),
        enabled: AppState::can_match,
        command: |_| some(MatchCommand::Align),
    },
    ActionRow {
        action: Action::NextStart,
        label: "Next start",
        tooltip: "Show the next first pose",
        keys: Keys::repeat(&[Shortcut::alt(Key::PageDown)]),
        enabled: has_starts,
        command: |_| some(MatchCommand::StepStart(1)),
    },
    ActionRow {
        action: Action::PreviousStart,
        label: "Previous start",
        tooltip: "Show the previous first pose",
        keys: Keys::repeat(&[Shortcut::alt(Key::PageUp)]),
        enabled: has_starts,
        command: |_| some(MatchCommand::StepStart(-1)),
    },
    ActionRow {
        action: Action::UseStart,
        label: "Use this start",
        tooltip: "Move the stamped part to the first pose that is shown",
        keys: Keys::press(&[Shortcut::alt(Key::Enter)]),
        enabled: |state| {
            has_starts(state)?;
            require(state.shown_start().is_some(), "Show a start first.")
        },
        command: |state| some(MatchCommand::UseStart(state.previews.start?)),
    },
    ActionRow {
        action: Action::FitPairs,
        label: "Fit the pairs",
        tooltip: "Align the picked points; with more than three pairs by least squares",
        keys: Keys::NONE,
        enabled: |state| state.document.can_fit_pairs(&state.jobs),
        command: |_| some(PairCommand::Fit),
    },
];

const MATCH: &[ActionRow] = &[
    ActionRow {
        action: Action::MatchOrStop,
        label: "Match",
        tooltip: "Find the pose; while it runs, stop and keep the best pose so far",
        keys: Keys::press(&[Shortcut::ctrl(Key::Enter), function(5)]),
        enabled: |state| {
            if state.jobs.is_active(JobKey::Match) {
                return Ok(());
            }
            state.can_match_as_asked()
        },
        command: |state| {
            some(if state.jobs.is_active(JobKey::Match) {
                MatchCommand::Stop
            } else {
                MatchCommand::Run
            })
        },
    },
    ActionRow {
        action: Action::Refine,
        label: "Refine",
        tooltip: "Run the match from the present pose of the stamped part",
        keys: Keys::press(&[Shortcut::ctrl_shift(Key::Enter)]),
        enabled: AppState::can_match,
        command: |_| some(MatchCommand::Refine),
    },
    ActionRow {
        action: Action::CancelRun,
        label: "Cancel the run",
        tooltip: "End the run and keep the old pose",
        keys: Keys::NONE,
        enabled: |state| require(state.jobs.locking_job().is_some(), "Nothing is running."),
        command: |_| some(MatchCommand::Cancel),
    },
];

const RESULT: &[ActionRow] = &[
    ActionRow {
        action: Action::NextAlternative,
        label: "Next alternative",
        tooltip: "Show the next pose that fits nearly as well, after the last the best again",
        keys: Keys::press(&[key('V')]),
        enabled: has_alternative,
        command: |_| some(MatchCommand::NextAlternative),
    },
    ActionRow {
        action: Action::Measure,
        label: "Measure",
        tooltip: "Measure distances and overlap at the present pose",
        keys: Keys::press(&[shift('M')]),
        enabled: AppState::can_match,
        command: |_| some(MatchCommand::Measure),
    },
];

fn level_step(state: &AppState, direction: i32, at_end: &'static str) -> Result<(), Reason> {
    state.can_reduce()?;
    let roles = state.settings.reduce_roles;
    let is_ticked = Role::ALL
        .into_iter()
        .any(|role| *roles.get(role) && state.document.part(role).is_some());
    require(is_ticked, "Tick a loaded part to reduce.")?;
    require(state.next_level(direction).is_some(), at_end)
}

fn has_alternative(state: &AppState) -> Result<(), Reason> {
    let result = state.document.match_of_parts()?;
    let n_alternatives = facts::n_alternatives(&result.run);
    require(n_alternatives > 0, "No other pose fits nearly as well.")?;
    let is_in_doubt = state.is_unit_in_doubt();
    require(
        !is_in_doubt,
        "Say first whether the files are in different units.",
    )?;
    state.jobs.is_unlocked()
}
