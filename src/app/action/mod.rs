//! What menus, keys, palette and help sheet offer. One table; all of them read it.

mod enabled;
mod shortcut;
mod table;
mod to_command;

pub use shortcut::{Key, Shortcut};

/// Why an action is not possible now, as a piece of a sentence: "load both parts first".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reason(pub &'static str);

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

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

    /// Its title.
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
}

/// What is written about an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActionInfo {
    /// The menu it stands in.
    pub menu: Menu,
    /// Its name, in sentence case; "…" where more input follows.
    pub label: &'static str,
    /// What it does, in a sentence.
    pub tooltip: &'static str,
    /// Its key.
    pub shortcut: Option<Shortcut>,
    /// A second key.
    pub other_shortcut: Option<Shortcut>,
}

impl ActionInfo {
    /// All its keys as people read them, if it has any.
    pub fn keys(&self) -> Option<String> {
        let first = self.shortcut?.to_string();
        Some(match self.other_shortcut {
            Some(other) => format!("{first}, {other}"),
            None => first,
        })
    }
}

macro_rules! actions {
    ($($(#[doc = $doc:literal])* $name:ident),* $(,)?) => {
        /// Something the user can do without further data: a menu entry, a key, a palette line.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Action { $($(#[doc = $doc])* $name),* }

        impl Action {
            /// Every action, in the order of the menus.
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
    /// Choose a project.
    OpenProject,
    /// Write the project to its file.
    SaveProject,
    /// Write the project to another file.
    SaveProjectAs,
    /// Read both parts again.
    ReloadAll,
    /// Exchange the two parts.
    Swap,
    /// Forget the crash part.
    CloseCrash,
    /// Forget the stamped part.
    CloseStamped,
    /// Preferences.
    Preferences,
    /// Leave the program.
    Quit,
    /// One step back.
    Undo,
    /// One step forward.
    Redo,
    /// Pose, levels and display as loaded.
    BackToAsLoaded,
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
    /// Turn over about the part's first axis.
    TurnOverX,
    /// Turn over about the part's second axis.
    TurnOverY,
    /// Turn over about the part's third axis.
    TurnOverZ,
    /// Lay the centres on each other.
    BringCentersTogether,
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
    /// See through the crash part.
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
    /// Colours of the deviation.
    ToggleDeviation,
    /// Colours of the overlap.
    ToggleOverlap,
    /// Measure the deviation again.
    UpdateDeviation,
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
    /// Forget the picked pivot.
    ClearPivot,
    /// Only the 3D windows.
    ToggleGraphicsOnly,
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
    /// Lay picked pairs of points on each other.
    FitPairs,
    /// Run the match from the present pose.
    Refine,
    /// Run the match, or stop it.
    MatchOrStop,
    /// End the run with the old pose.
    CancelRun,
    /// The next pose that fits nearly as well.
    FlipAlternative,
    /// Distances and overlap at the present pose.
    Measure,
    /// The matrix on the clipboard.
    CopyMatrix,
    /// The match as a line for a shell.
    CopyCommandLine,
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
    /// The choices of a picture.
    PictureOptions,
    /// A picture.
    TakePicture,
    /// A picture without background.
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
