use super::Action;
use crate::app::{
    AppState, Axis, AxisFrame, ColorBy, Command, CopyForm, Dialog, Display, ExportCommand,
    ExportKind, FileCommand, HistoryCommand, InspectCommand, MatchCommand, MeshExport, MotionKind,
    MoveCommand, PairCommand, PartCommand, ProjectCommand, ReduceCommand, SectionView, Settings,
    ShownGeometry, ViewCommand,
};
use crate::geometry::Vector3;
use crate::geometry::camera::{OrbitStyle, StandardView};
use crate::jobs::{JobKey, PerRole, Role};
use crate::report::{CardForm, MatrixForm};

const BOTH: PerRole<bool> = PerRole {
    crash: true,
    stamped: true,
};

impl Action {
    /// The commands the action stands for now; none if it is not enabled.
    pub fn to_commands(self, state: &AppState) -> Vec<Command> {
        if self.enabled(state).is_err() {
            return Vec::new();
        }
        if self == Self::ReloadAll {
            let loaded = Role::ALL.into_iter();
            let loaded = loaded.filter(|role| state.document.part(*role).is_some());
            return loaded.map(|r| FileCommand::Reload(r).into()).collect();
        }
        let command = self
            .edit_command(state)
            .or_else(|| self.display_command(state))
            .or_else(|| self.inspect_command(state))
            .or_else(|| self.camera_command(state))
            .or_else(|| self.match_command(state))
            .or_else(|| self.window_command(state));
        command.into_iter().collect()
    }

    fn edit_command(self, state: &AppState) -> Option<Command> {
        let begin = |kind| {
            let frame = state.move_frame()?;
            Some(Command::from(MoveCommand::Begin { kind, frame }))
        };
        let command: Command = match self {
            Self::OpenCrash => FileCommand::AskOpen(Role::Crash).into(),
            Self::OpenStamped => FileCommand::AskOpen(Role::Stamped).into(),
            Self::OpenExample => FileCommand::OpenExample.into(),
            Self::OpenProject => ProjectCommand::AskOpen.into(),
            Self::SaveProject => ProjectCommand::Save.into(),
            Self::SaveProjectAs => ProjectCommand::SaveAs.into(),
            Self::Swap => FileCommand::Swap.into(),
            Self::CloseCrash => FileCommand::Close(Role::Crash).into(),
            Self::CloseStamped => FileCommand::Close(Role::Stamped).into(),
            Self::Undo => HistoryCommand::Undo.into(),
            Self::Redo => HistoryCommand::Redo.into(),
            Self::BackToAsLoaded => HistoryCommand::BackToAsLoaded.into(),
            Self::HideSelected => PartCommand::HideSelected.into(),
            Self::IsolateSelected => PartCommand::ShowOnlySelected.into(),
            Self::ShowAllParts => PartCommand::ShowAll.into(),
            Self::MoveTool => return begin(MotionKind::Move),
            Self::RotateTool => return begin(MotionKind::Rotate),
            Self::TurnOverX => MoveCommand::TurnOver(Axis::X).into(),
            Self::TurnOverY => MoveCommand::TurnOver(Axis::Y).into(),
            Self::TurnOverZ => MoveCommand::TurnOver(Axis::Z).into(),
            Self::BringCentersTogether => MoveCommand::BringCentersTogether.into(),
            Self::ResetPose => MoveCommand::Reset.into(),
            Self::PairTool => PairCommand::ToggleTool.into(),
            Self::ToggleGizmo => ViewCommand::ToggleGizmo.into(),
            Self::CycleMoveAxes => ViewCommand::SetMoveAxes(next_axes(state)).into(),
            _ => return None,
        };
        Some(command)
    }

    fn display_command(self, state: &AppState) -> Option<Command> {
        let shown = match state.view.shown {
            ShownGeometry::Reduced => ShownGeometry::Detailed,
            ShownGeometry::Detailed => ShownGeometry::Reduced,
        };
        let mut display: Display = state.view.display.clone();
        match self {
            Self::ToggleMoveOver => return Some(ViewCommand::ToggleMoveOver.into()),
            Self::ToggleDetailed => return Some(ViewCommand::SetShown(shown).into()),
            Self::Blink => return Some(ViewCommand::SetBlinking(true).into()),
            Self::ToggleSeeThrough => display.is_see_through ^= true,
            // Before the part is moved over, the same key wipes between reduced and full.
            Self::ToggleWipe
                if !state.view.is_moved_over && Self::ToggleSplit.enabled(state).is_ok() =>
            {
                display.split = toggled(display.split);
            }
            Self::ToggleWipe => display.wipe = toggled(display.wipe),
            Self::ToggleSplit => display.split = toggled(display.split),
            Self::ToggleEdges => display.has_edges ^= true,
            Self::ToggleFeatureEdges => display.has_feature_edges ^= true,
            Self::TogglePoints => display.has_points ^= true,
            Self::ToggleDeviation => toggle_color(&mut display, ColorBy::Deviation),
            Self::ToggleOverlap => toggle_color(&mut display, ColorBy::Overlap),
            _ => return None,
        }
        Some(ViewCommand::SetDisplay(Box::new(display)).into())
    }

    fn inspect_command(self, state: &AppState) -> Option<Command> {
        let step = state.section_step();
        let section = match self {
            Self::UpdateDeviation => return Some(InspectCommand::Update.into()),
            Self::ToggleSection => state.section_toggled(),
            Self::ToggleSectionClip => SectionView {
                is_clipped: !state.view.section.is_clipped,
                ..state.section_across(&section_normal(state))
            },
            Self::SectionX => state.section_across(&Vector3::x()),
            Self::SectionY => state.section_across(&Vector3::y()),
            Self::SectionZ => state.section_across(&Vector3::z()),
            Self::SectionView => {
                let camera = state.view.cameras.get(state.view.focus);
                state.section_across(&-camera.forward())
            }
            Self::SectionForward => state.section_moved(step)?,
            Self::SectionBack => state.section_moved(-step)?,
            _ => return None,
        };
        Some(ViewCommand::SetSection(section).into())
    }

    fn camera_command(self, state: &AppState) -> Option<Command> {
        let role = state.view.focus;
        let standard = |view| ViewCommand::Standard(role, view);
        let style = match state.view.orbit_style {
            OrbitStyle::Turntable => OrbitStyle::Free,
            OrbitStyle::Free => OrbitStyle::Turntable,
        };
        let command = match self {
            Self::FitAll => ViewCommand::FitAll(role),
            Self::FocusSelection => ViewCommand::Focus(role),
            Self::PreviousView => ViewCommand::PreviousCamera(role),
            Self::ViewFront => standard(StandardView::Front),
            Self::ViewBack => standard(StandardView::Back),
            Self::ViewRight => standard(StandardView::Right),
            Self::ViewLeft => standard(StandardView::Left),
            Self::ViewTop => standard(StandardView::Top),
            Self::ViewBottom => standard(StandardView::Bottom),
            Self::ViewIsometric => standard(StandardView::Isometric),
            Self::ToggleProjection => ViewCommand::ToggleProjection(role),
            Self::ToggleLink => ViewCommand::ToggleLink,
            Self::ToggleOrbitStyle => ViewCommand::SetOrbitStyle(style),
            Self::ClearPivot => ViewCommand::SetPivot(role, None),
            _ => return None,
        };
        Some(command.into())
    }

    fn match_command(self, state: &AppState) -> Option<Command> {
        let command: Command = match self {
            Self::Reduce => ReduceCommand::To {
                roles: state.settings.reduce_roles,
                max_triangles: state.settings.max_triangles,
            }
            .into(),
            Self::ReduceToFull => ReduceCommand::Full(BOTH).into(),
            Self::NextLevel => ReduceCommand::Step(1).into(),
            Self::PreviousLevel => ReduceCommand::Step(-1).into(),
            Self::Align => MatchCommand::Align.into(),
            Self::NextStart => MatchCommand::StepStart(1).into(),
            Self::PreviousStart => MatchCommand::StepStart(-1).into(),
            Self::UseStart => MatchCommand::UseStart(state.current_starts()?.shown?).into(),
            Self::FitPairs => PairCommand::Fit.into(),
            Self::Refine => MatchCommand::Refine.into(),
            Self::MatchOrStop if state.jobs.is_active(JobKey::Match) => MatchCommand::Stop.into(),
            Self::MatchOrStop => MatchCommand::Run.into(),
            Self::CancelRun => MatchCommand::Cancel.into(),
            Self::FlipAlternative => MatchCommand::FlipAlternative.into(),
            Self::Measure => MatchCommand::Measure.into(),
            _ => return None,
        };
        Some(command)
    }

    fn window_command(self, state: &AppState) -> Option<Command> {
        let scaled = |change: fn(f32) -> f32| {
            let settings = Settings {
                ui_scale: change(state.settings.ui_scale),
                ..state.settings.clone()
            };
            Command::Settings(Box::new(settings))
        };
        let dialog = |dialog| {
            let is_open = state.view.dialog == Some(dialog);
            ViewCommand::SetDialog((!is_open).then_some(dialog))
        };
        let save = |kind| Command::from(ExportCommand::AskSave(kind));
        let picture = |is_transparent| ExportCommand::TakePicture { is_transparent };
        let command = match self {
            Self::Preferences => dialog(Dialog::Preferences).into(),
            Self::Palette => dialog(Dialog::Palette).into(),
            Self::Help => dialog(Dialog::Help).into(),
            Self::About => dialog(Dialog::About).into(),
            Self::ToggleGraphicsOnly => ViewCommand::ToggleGraphicsOnly.into(),
            Self::ScaleUp => scaled(|scale| scale + 0.125),
            Self::ScaleDown => scaled(|scale| scale - 0.125),
            Self::ScaleReset => scaled(|_| 1.0),
            Self::CopyMatrix => ExportCommand::Copy(state.copy_form()).into(),
            Self::SaveMatrix => save(ExportKind::Matrix(last_matrix(state))),
            Self::SaveReport => save(ExportKind::Report),
            Self::SaveDeviations => save(ExportKind::Deviations),
            Self::SaveRecord => save(ExportKind::Record),
            Self::SaveCards => save(ExportKind::Cards(CardForm::ALL[0])),
            Self::SaveMoved => save(ExportKind::Mesh(MeshExport::Moved)),
            Self::CopyCommandLine => ExportCommand::CopyCommandLine.into(),
            Self::CopyLog => ExportCommand::CopyLog.into(),
            Self::PictureOptions => dialog(Dialog::Picture).into(),
            Self::TakePicture => picture(false).into(),
            Self::TakePictureTransparent => picture(true).into(),
            Self::Escape => Command::Escape,
            Self::Quit => Command::Quit,
            _ => return None,
        };
        Some(command)
    }
}

/// The form of the matrix that was copied last.
fn last_matrix(state: &AppState) -> MatrixForm {
    match state.copy_form() {
        CopyForm::Matrix(form) => form,
        CopyForm::Cards(_) => MatrixForm::Rows,
    }
}

/// What the section plane lies across now, or would.
fn section_normal(state: &AppState) -> Vector3 {
    let plane = state.view.section.plane;
    plane
        .unwrap_or_else(|| state.default_section_plane())
        .normal
}

fn toggle_color(display: &mut Display, by: ColorBy) {
    display.color_by = if display.color_by == by {
        ColorBy::Role
    } else {
        by
    };
}

fn toggled(line: Option<f32>) -> Option<f32> {
    match line {
        None => Some(0.5),
        Some(_) => None,
    }
}

fn next_axes(state: &AppState) -> AxisFrame {
    match state.view.move_axes {
        AxisFrame::Global => AxisFrame::Part,
        AxisFrame::Part => AxisFrame::View,
        AxisFrame::View => AxisFrame::Global,
    }
}
