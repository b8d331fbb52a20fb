//! What menus, keys, command search and help sheet offer. One row per action; all of them read it.

mod conditions;
mod edit;
mod export;
mod file;
mod help;
mod match_;
mod row;
mod section;
mod shortcut;
mod view;

pub use row::{ActionRow, KeyMode, Keys, MenuGroup, Reason};
pub use shortcut::{Key, Shortcut};

use super::{AppState, ColorBy, Command, Dialog, ShownGeometry, ViewCommand};
use crate::geometry::camera::{OrbitStyle, Projection};

/// The menus, from left to right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Menu {
    /// Files and preferences.
    File,
    /// Undo, parts, moves.
    Edit,
    /// Camera and display.
    View,
    /// Reduction, alignment, match.
    Match,
    /// What leaves the program.
    Export,
    /// Help.
    Help,
}

impl Menu {
    /// All, from left to right.
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Edit,
        Self::View,
        Self::Match,
        Self::Export,
        Self::Help,
    ];

    /// Title of the menu in the menu bar.
    pub fn label(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Match => "Match",
            Self::Export => "Export",
            Self::Help => "Help",
        }
    }

    /// Its rows, in groups from top to bottom.
    pub const fn groups(self) -> &'static [MenuGroup] {
        match self {
            Self::File => file::GROUPS,
            Self::Edit => edit::GROUPS,
            Self::View => view::GROUPS,
            Self::Match => match_::GROUPS,
            Self::Export => export::GROUPS,
            Self::Help => help::GROUPS,
        }
    }

    /// Its rows without the groups.
    pub fn rows(self) -> impl Iterator<Item = &'static ActionRow> {
        self.groups().iter().flat_map(|group| group.rows)
    }
}

macro_rules! actions {
    ($($(#[doc = $doc:literal])* $name:ident),* $(,)?) => {
        /// Something the user can do without further data: a menu entry, a key, a line of the command
        /// search. Its row says the rest.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Action { $($(#[doc = $doc])* $name),* }

        impl Action {
            /// Every action.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];
        }
    };
}

actions! {
    /// Choose a crash model.
    OpenCrash,
    /// Choose a stamped part.
    OpenStamped,
    /// Open the example pair.
    OpenExample,
    /// Load the realistic example pair.
    OpenRealisticExample,
    /// Choose a project.
    OpenProject,
    /// Read the project from its file again.
    ReopenProject,
    /// Write the project to its file.
    SaveProject,
    /// Write the project to another file.
    SaveProjectAs,
    /// Read both parts again.
    ReloadAll,
    /// Read those parts again whose files have changed on disk.
    ReloadChanged,
    /// Exchange the two parts.
    Swap,
    /// Remove the crash part.
    CloseCrash,
    /// Remove the stamped part.
    CloseStamped,
    /// Preferences.
    Preferences,
    /// Close the program.
    Quit,
    /// Choose one more stamped file to map from.
    AddStamped,
    /// Map the forming results, or give the running mapping up.
    MapOrCancel,
    /// Map where the stamped file has its part.
    MapAsLoaded,
    /// Write the crash deck with the mapped results.
    SaveMappedDeck,
    /// Write the crash part with the mapped results.
    SaveMappedPart,
    /// Write the mapped states, and the elements with their thickness beside them.
    SaveMappedInclude,
    /// Compare the mapping with another mapper's result, or give the running comparison up.
    CompareMapping,
    /// Compare mappings no longer.
    EndMapComparison,
    /// Write the report of the mapping.
    SaveMapReport,
    /// Write the table of mapped elements.
    SaveMapTable,
    /// One step back.
    Undo,
    /// One step forward.
    Redo,
    /// Pose, levels and display as loaded.
    ResetAll,
    /// Hide the selected part.
    HideSelected,
    /// Hide all other parts.
    IsolateSelected,
    /// Show all parts.
    ShowAllParts,
    /// Move by keys.
    MoveTool,
    /// Rotate by keys.
    RotateTool,
    /// Rotate by 180° about the part's first axis.
    FlipX,
    /// Rotate by 180° about the part's second axis.
    FlipY,
    /// Rotate by 180° about the part's third axis.
    FlipZ,
    /// Make the centres of both boxes coincide.
    AlignCenters,
    /// Take all moves back.
    ResetPose,
    /// Show the gizmo.
    ToggleGizmo,
    /// Pick pairs of points.
    PairTool,
    /// Global, part or view axes.
    CycleMoveAxes,
    /// Move the stamped part over, or back.
    ToggleMoveOver,
    /// Reduced or detailed geometry.
    ToggleDetailed,
    /// Hold to see the full mesh.
    Blink,
    /// Make the crash part transparent.
    ToggleSeeThrough,
    /// A line that wipes the stamped part away.
    ToggleWipe,
    /// Reduced and full side by side in one window.
    ToggleSplit,
    /// Mesh edges.
    ToggleEdges,
    /// Feature edges and borders.
    ToggleFeatureEdges,
    /// Nodes.
    TogglePoints,
    /// Parts that are not used for the match.
    ToggleUnused,
    /// Colours of the deviation.
    ToggleDeviation,
    /// Colours of the overlap.
    ToggleOverlap,
    /// Colours of the uncertainty of the pose.
    ToggleUncertainty,
    /// Measure the deviation again.
    UpdateDeviation,
    /// Measure between two points, or end it.
    MeasureDistance,
    /// The measured distance on the clipboard.
    CopyDistance,
    /// Colours of the mapped values.
    ShowMapped,
    /// Colours of mapped less stamped.
    ShowMapDifference,
    /// Colours of the distance at the mapping.
    ShowMapDistance,
    /// Colours of the angle between the normals at the mapping.
    ShowMapAngle,
    /// Colours of the mapping's confidence.
    ShowMapConfidence,
    /// What became of the mapped elements.
    ShowMapStatus,
    /// Which stamped file gave the values.
    ShowMapFile,
    /// Colours of mapped less another mapper's result.
    ShowMapOther,
    /// Another quantity of the mapping.
    NextMapQuantity,
    /// Another layer of the sheet.
    NextLayer,
    /// Pin the probed element for the report.
    PinProbe,
    /// No longer look at one element of the mapping.
    EndProbe,
    /// The section plane.
    ToggleSection,
    /// Cut away what lies in front of the section plane.
    ToggleSectionClip,
    /// The section plane across x.
    SectionX,
    /// The section plane across y.
    SectionY,
    /// The section plane across z.
    SectionZ,
    /// The section plane across the view.
    SectionView,
    /// The section plane a step along its normal.
    SectionForward,
    /// The section plane a step back.
    SectionBack,
    /// Fit everything.
    FitAll,
    /// Fit the selection.
    FocusSelection,
    /// Camera before the last jump.
    PreviousView,
    /// Front view.
    ViewFront,
    /// Back view.
    ViewBack,
    /// Right view.
    ViewRight,
    /// Left view.
    ViewLeft,
    /// Top view.
    ViewTop,
    /// Bottom view.
    ViewBottom,
    /// Isometric view.
    ViewIsometric,
    /// Orthographic or perspective.
    ToggleProjection,
    /// Link the two cameras.
    ToggleLink,
    /// Turntable or free orbit.
    ToggleOrbitStyle,
    /// Clear the picked pivot.
    ClearPivot,
    /// Only the 3D windows.
    ToggleGraphicsOnly,
    /// Fold or unfold the left column.
    ToggleColumn,
    /// Larger text.
    ScaleUp,
    /// Smaller text.
    ScaleDown,
    /// Text as designed.
    ScaleReset,
    /// Reduce to the maximum in the field.
    Reduce,
    /// Back to the full mesh.
    ReduceToFull,
    /// Next coarser level.
    NextLevel,
    /// Next finer level.
    PreviousLevel,
    /// First poses from the surface normals.
    Align,
    /// Show the next first pose.
    NextStart,
    /// Show the previous first pose.
    PreviousStart,
    /// Take the shown first pose.
    UseStart,
    /// Align picked pairs of points.
    FitPairs,
    /// Run the match from the present pose.
    Refine,
    /// Run the match, or stop it.
    MatchOrStop,
    /// End the run with the old pose.
    CancelRun,
    /// The next pose that fits nearly as well.
    NextAlternative,
    /// Distances and overlap at the present pose.
    Measure,
    /// The matrix on the clipboard.
    CopyMatrix,
    /// The match as a line for a shell.
    CopyCommandLine,
    /// The mapping as a line for a shell.
    CopyMapCommandLine,
    /// The log as text.
    CopyLog,
    /// The report of the match into a file.
    SaveReport,
    /// The record of the match into a file.
    SaveRecord,
    /// The distances of all nodes into a file.
    SaveDeviations,
    /// The matrix into a file.
    SaveMatrix,
    /// LS-DYNA cards into a file.
    SaveCards,
    /// The moved stamped part into a file.
    SaveMoved,
    /// The choices of an image.
    PictureOptions,
    /// Write an image of the 3D windows as it was chosen last, into the folder of the last one.
    TakePicture,
    /// The same without background.
    TakePictureTransparent,
    /// Search commands.
    Palette,
    /// All keys.
    Help,
    /// End the present tool or run.
    Escape,
    /// Name, version, licences.
    About,
}

impl Action {
    /// What is written about it, its keys, when it is possible and what it does.
    pub fn row(self) -> &'static ActionRow {
        row::TABLE[self as usize].1
    }

    /// The menu it stands in.
    pub fn menu(self) -> Menu {
        row::TABLE[self as usize].0
    }

    /// The action of a key.
    pub fn of_shortcut(shortcut: Shortcut) -> Option<Self> {
        let has = |action: &Self| action.row().keys.shortcuts.contains(&shortcut);
        Self::ALL.iter().copied().find(has)
    }

    /// `Ok` if the action is possible now, else why it is not.
    pub fn enabled(self, state: &AppState) -> Result<(), Reason> {
        (self.row().enabled)(state)
    }

    /// Whether what it switches is on; `None` of an action that is no switch.
    pub fn is_on(self, state: &AppState) -> Option<bool> {
        let (view, display) = (&state.view, &state.view.display);
        Some(match self {
            Self::ToggleGizmo => state.moving.has_gizmo,
            Self::PairTool => state.pairs.tool.is_some(),
            Self::ToggleMoveOver => view.is_moved_over,
            Self::ToggleDetailed => view.shown == ShownGeometry::Detailed,
            Self::ToggleSeeThrough => display.is_see_through,
            Self::ToggleSplit => display.split.is_some(),
            // Before the part is moved over it is the line of the split.
            Self::ToggleWipe if !view.is_moved_over => display.split.is_some(),
            Self::ToggleWipe => display.wipe.is_some(),
            Self::ToggleEdges => display.has_edges,
            Self::ToggleFeatureEdges => display.has_feature_edges,
            Self::TogglePoints => display.has_points,
            Self::ToggleUnused => display.has_unused,
            Self::ToggleDeviation => state.shown_colors() == ColorBy::Deviation,
            Self::ToggleOverlap => state.shown_colors() == ColorBy::Overlap,
            Self::ToggleUncertainty => state.shown_colors() == ColorBy::Uncertainty,
            Self::MeasureDistance => state.inspect.distance.is_some(),
            Self::ToggleSection => state.inspect.section.is_on,
            Self::ToggleSectionClip => state.inspect.section.is_clipped,
            Self::ToggleProjection => {
                let projection = view.cameras.get(view.focus).projection;
                matches!(projection, Projection::Perspective { .. })
            }
            Self::ToggleLink => view.are_linked,
            Self::ToggleOrbitStyle => view.orbit_style == OrbitStyle::Free,
            Self::ToggleGraphicsOnly => view.is_graphics_only,
            Self::ToggleColumn => !view.is_column_folded(),
            _ => return None,
        })
    }

    /// The command the action stands for now; none if it is not enabled.
    pub fn command(self, state: &AppState) -> Option<Command> {
        self.enabled(state).ok()?;
        (self.row().command)(state)
    }
}

/// Opens a dialog, or closes it where it is open.
fn toggled_dialog(state: &AppState, dialog: Dialog) -> ViewCommand {
    let is_open = state.view.dialog == Some(dialog);
    ViewCommand::SetDialog((!is_open).then_some(dialog))
}
