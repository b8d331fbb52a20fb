use super::{Action, ActionInfo, Key, Menu, Shortcut};

const fn key(letter: char) -> Shortcut {
    Shortcut::plain(Key::Letter(letter))
}

const fn ctrl(letter: char) -> Shortcut {
    Shortcut::ctrl(Key::Letter(letter))
}

const fn digit(number: u8) -> Shortcut {
    Shortcut::plain(Key::Digit(number))
}

const fn ctrl_digit(number: u8) -> Shortcut {
    Shortcut::ctrl(Key::Digit(number))
}

const fn function(number: u8) -> Shortcut {
    Shortcut::plain(Key::Function(number))
}

type Row = (&'static str, &'static str, Option<Shortcut>);

impl Action {
    /// Menu, label, tooltip and keys.
    pub fn info(self) -> ActionInfo {
        let menu = self.menu();
        let (label, tooltip, shortcut) = match menu {
            Menu::File => self.file_row(),
            Menu::Edit => self.edit_row(),
            Menu::View => self.view_row(),
            Menu::Match => self.match_row(),
            Menu::Export => self.export_row(),
            Menu::Help => self.help_row(),
        };
        ActionInfo {
            menu,
            label,
            tooltip,
            shortcut,
            other_shortcut: self.other_shortcut(),
        }
    }

    /// The actions of one menu, in its order.
    pub fn in_menu(menu: Menu) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |a| a.menu() == menu)
    }

    /// True if the action lasts only while its key is held.
    pub fn is_held(self) -> bool {
        self == Self::Blink
    }

    /// The action of a key.
    pub fn of_shortcut(shortcut: Shortcut) -> Option<Self> {
        let has = |action: &Self| {
            let info = action.info();
            info.shortcut == Some(shortcut) || info.other_shortcut == Some(shortcut)
        };
        Self::ALL.iter().copied().find(has)
    }

    fn menu(self) -> Menu {
        if self <= Self::Quit {
            Menu::File
        } else if self <= Self::CycleMoveAxes {
            Menu::Edit
        } else if self <= Self::ScaleReset {
            Menu::View
        } else if self <= Self::Measure {
            Menu::Match
        } else if self <= Self::TakePictureTransparent {
            Menu::Export
        } else {
            Menu::Help
        }
    }

    fn other_shortcut(self) -> Option<Shortcut> {
        match self {
            Self::MatchOrStop => Some(function(5)),
            Self::Redo => Some(ctrl('Y')),
            _ => None,
        }
    }

    fn file_row(self) -> Row {
        match self {
            Self::OpenCrash => (
                "Open crash model…",
                "Choose the crash model; its part stays where it is",
                Some(ctrl('O')),
            ),
            Self::OpenStamped => (
                "Open stamped part…",
                "Choose the result of the stamping simulation; this part moves",
                Some(Shortcut::ctrl_shift(Key::Letter('O'))),
            ),
            Self::OpenExample => (
                "Open the example pair",
                "Load a generated crash part and its stamped part",
                None,
            ),
            Self::OpenProject => (
                "Open project…",
                "Open saved work: both files, pose, levels, settings and result",
                None,
            ),
            Self::SaveProject => (
                "Save project",
                "Save the work: what was chosen and found, without the geometry",
                Some(ctrl('S')),
            ),
            Self::SaveProjectAs => (
                "Save project as…",
                "Save the work to another file",
                Some(Shortcut::ctrl_shift(Key::Letter('S'))),
            ),
            Self::ReloadAll => (
                "Reload",
                "Read the files again; choices and pose stay",
                None,
            ),
            Self::Swap => (
                "Swap crash and stamped",
                "Exchange the two parts without reading anything",
                None,
            ),
            Self::CloseCrash => ("Close crash part", "Forget the crash part", None),
            Self::CloseStamped => ("Close stamped part", "Forget the stamped part", None),
            Self::Preferences => (
                "Preferences…",
                "Theme, size of the text, mouse",
                Some(Shortcut::ctrl_shift(Key::Letter('P'))),
            ),
            _ => ("Quit", "Leave the program", Some(ctrl('Q'))),
        }
    }

    fn edit_row(self) -> Row {
        match self {
            Self::Undo => ("Undo", "Take the last step back", Some(ctrl('Z'))),
            Self::Redo => (
                "Redo",
                "Bring the step back that was undone last",
                Some(Shortcut::ctrl_shift(Key::Letter('Z'))),
            ),
            Self::BackToAsLoaded => (
                "Back to as loaded",
                "Pose, levels and visibility as after loading; one undo step",
                None,
            ),
            Self::HideSelected => ("Hide", "Hide the selected parts", Some(key('H'))),
            Self::IsolateSelected => (
                "Isolate",
                "Hide all parts but the selected ones",
                Some(Shortcut::shift(Key::Letter('H'))),
            ),
            Self::ShowAllParts => (
                "Show all",
                "Show all parts of both models",
                Some(Shortcut::alt(Key::Letter('H'))),
            ),
            Self::MoveTool => (
                "Move",
                "Move the stamped part with the pointer; X, Y, Z bind it, digits give the way",
                Some(key('G')),
            ),
            Self::RotateTool => (
                "Rotate",
                "Turn the stamped part with the pointer; X, Y, Z bind it, digits give degrees",
                Some(key('R')),
            ),
            Self::TurnOverX => (
                "Turn over about X",
                "Turn the stamped part by 180° about its own x axis",
                Some(Shortcut::shift(Key::Letter('R'))),
            ),
            Self::TurnOverY => (
                "Turn over about Y",
                "Turn the stamped part by 180° about its own y axis",
                None,
            ),
            Self::TurnOverZ => (
                "Turn over about Z",
                "Turn the stamped part by 180° about its own z axis",
                None,
            ),
            Self::BringCentersTogether => (
                "Bring centres together",
                "Move the stamped part so that the centres of both boxes meet",
                None,
            ),
            Self::ResetPose => (
                "Reset pose",
                "Put the stamped part back where its file has it",
                None,
            ),
            Self::ToggleGizmo => (
                "Gizmo",
                "Show handles that move and turn the stamped part",
                Some(Shortcut::shift(Key::Letter('G'))),
            ),
            Self::PairTool => (
                "Point pairs",
                "Pick points that belong together, in turn on the crash and the stamped part",
                Some(key('N')),
            ),
            _ => (
                "Next move axes",
                "Move along the axes of the crash model, of the part, or of the screen",
                None,
            ),
        }
    }

    fn view_row(self) -> Row {
        self.display_row().unwrap_or_else(|| self.camera_row())
    }

    fn display_row(self) -> Option<Row> {
        let row: Row = match self {
            Self::ToggleMoveOver => (
                "Move over",
                "Show the stamped part in the left window, or back in its own",
                Some(key('M')),
            ),
            Self::ToggleDetailed => (
                "Detailed geometry",
                "Show the full meshes instead of the reduced ones",
                Some(Shortcut::shift(Key::Letter('D'))),
            ),
            Self::Blink => (
                "Blink",
                "Hold to see the full mesh, or the other part when moved over",
                Some(key('B')),
            ),
            Self::ToggleSeeThrough => {
                ("See-through", "Look through the crash part", Some(key('X')))
            }
            Self::ToggleWipe => (
                "Wipe",
                "A line with the stamped part on one side only; before moving over: reduced | full",
                Some(key('W')),
            ),
            Self::ToggleSplit => (
                "Reduced | full",
                "Split each window: reduced mesh left, full mesh right of a line",
                Some(Shortcut::shift(Key::Letter('W'))),
            ),
            Self::ToggleEdges => ("Mesh edges", "Draw the edges of the mesh", Some(key('E'))),
            Self::ToggleFeatureEdges => (
                "Feature edges",
                "Draw sharp edges and borders",
                Some(Shortcut::shift(Key::Letter('E'))),
            ),
            Self::TogglePoints => ("Nodes", "Draw the nodes as points", None),
            Self::ToggleDeviation => (
                "Deviation map",
                "Colour the parts by the signed distance between them",
                Some(key('D')),
            ),
            Self::ToggleOverlap => (
                "Overlap map",
                "Show where the parts match, where they are off, and what only one of them has",
                Some(key('O')),
            ),
            Self::UpdateDeviation => (
                "Update the deviation",
                "Measure the deviation again at the shown pose and levels",
                None,
            ),
            _ => return self.section_row(),
        };
        Some(row)
    }

    fn section_row(self) -> Option<Row> {
        let row: Row = match self {
            Self::ToggleSection => (
                "Section",
                "Cut both parts with a plane and show their outlines",
                Some(key('S')),
            ),
            Self::ToggleSectionClip => (
                "Cut away one half",
                "Hide what lies in front of the section plane",
                Some(Shortcut::shift(Key::Letter('S'))),
            ),
            Self::SectionX => ("Section across X", "Turn the section plane across x", None),
            Self::SectionY => ("Section across Y", "Turn the section plane across y", None),
            Self::SectionZ => ("Section across Z", "Turn the section plane across z", None),
            Self::SectionView => (
                "Section across the view",
                "Turn the section plane to face the viewer",
                None,
            ),
            Self::SectionForward => (
                "Section forward",
                "Move the section plane by a tenth of an element along its normal",
                Some(Shortcut::shift(Key::PageUp)),
            ),
            Self::SectionBack => (
                "Section back",
                "Move the section plane back by a tenth of an element",
                Some(Shortcut::shift(Key::PageDown)),
            ),
            _ => return None,
        };
        Some(row)
    }

    fn camera_row(self) -> Row {
        let home = Shortcut::plain(Key::Home);
        match self {
            Self::FitAll => ("Fit all", "Bring everything visible into view", Some(home)),
            Self::FocusSelection => (
                "Fit selection",
                "Bring the selected parts into view, or everything",
                Some(key('F')),
            ),
            Self::PreviousView => (
                "Previous view",
                "Back to the camera before the last jump",
                Some(digit(0)),
            ),
            Self::ViewFront => ("Front", "Look along +y", Some(digit(1))),
            Self::ViewBack => ("Back", "Look along −y", Some(ctrl_digit(1))),
            Self::ViewRight => ("Right", "Look along −x", Some(digit(3))),
            Self::ViewLeft => ("Left", "Look along +x", Some(ctrl_digit(3))),
            Self::ViewTop => ("Top", "Look along −z", Some(digit(7))),
            Self::ViewBottom => ("Bottom", "Look along +z", Some(ctrl_digit(7))),
            Self::ViewIsometric => ("Isometric", "Look from (+x, −y, +z)", Some(digit(9))),
            Self::ToggleProjection => (
                "Perspective",
                "Perspective or parallel projection",
                Some(digit(5)),
            ),
            Self::ToggleLink => (
                "Link views",
                "Turn and zoom both windows together",
                Some(key('L')),
            ),
            Self::ToggleOrbitStyle => (
                "Free orbit",
                "Turn freely instead of about the vertical axis",
                Some(key('T')),
            ),
            Self::ClearPivot => (
                "Forget the pivot",
                "Turn about the point under the pointer again",
                Some(key('P')),
            ),
            Self::ToggleGraphicsOnly => (
                "Graphics only",
                "Hide everything but the 3D windows",
                Some(function(11)),
            ),
            Self::ScaleUp => (
                "Larger text",
                "Make everything larger",
                Some(Shortcut::ctrl(Key::Plus)),
            ),
            Self::ScaleDown => (
                "Smaller text",
                "Make everything smaller",
                Some(Shortcut::ctrl(Key::Minus)),
            ),
            _ => (
                "Text as designed",
                "Size of the text back to 100 %",
                Some(ctrl_digit(0)),
            ),
        }
    }

    fn match_row(self) -> Row {
        match self {
            Self::Reduce => (
                "Reduce",
                "Reduce the ticked parts to the maximum number of triangles",
                None,
            ),
            Self::ReduceToFull => ("Full mesh", "Go back to the full meshes", None),
            Self::NextLevel => (
                "Coarser level",
                "Next marked level with fewer triangles",
                Some(Shortcut::plain(Key::PageUp)),
            ),
            Self::PreviousLevel => (
                "Finer level",
                "Next marked level with more triangles",
                Some(Shortcut::plain(Key::PageDown)),
            ),
            Self::Align => (
                "Align surface normal",
                "Make first poses by laying the mean surface normals on each other",
                Some(key('A')),
            ),
            Self::NextStart => (
                "Next start",
                "Show the next first pose",
                Some(Shortcut::alt(Key::PageDown)),
            ),
            Self::PreviousStart => (
                "Previous start",
                "Show the previous first pose",
                Some(Shortcut::alt(Key::PageUp)),
            ),
            Self::UseStart => (
                "Use this start",
                "Put the stamped part at the first pose that is shown",
                Some(Shortcut::alt(Key::Enter)),
            ),
            Self::FitPairs => (
                "Fit the pairs",
                "Lay the picked points on each other; with more than three pairs the best mean",
                None,
            ),
            Self::Refine => (
                "Refine",
                "Run the match from where the stamped part lies now",
                Some(Shortcut::ctrl_shift(Key::Enter)),
            ),
            Self::MatchOrStop => (
                "Match",
                "Find the pose; while it runs, stop and keep the best so far",
                Some(Shortcut::ctrl(Key::Enter)),
            ),
            Self::CancelRun => ("Cancel the run", "End the run and keep the old pose", None),
            Self::FlipAlternative => (
                "Other pose",
                "Show the next pose that fits nearly as well, and round to the best",
                Some(key('V')),
            ),
            _ => (
                "Measure",
                "Measure distances and overlap at the present pose",
                Some(Shortcut::shift(Key::Letter('M'))),
            ),
        }
    }

    fn export_row(self) -> Row {
        match self {
            Self::CopyMatrix => (
                "Copy matrix",
                "Copy the pose (stamped → crash) in the form used last",
                Some(Shortcut::ctrl_shift(Key::Letter('C'))),
            ),
            Self::SaveMatrix => ("Save matrix…", "Write the pose as text", None),
            Self::SaveRecord => (
                "Save record…",
                "Write the whole match as JSON: matrix, verdict, settings, times",
                None,
            ),
            Self::SaveReport => (
                "Save report…",
                "Write pictures, verdict, tables and settings as one HTML page",
                None,
            ),
            Self::SaveDeviations => (
                "Save node deviations…",
                "Write how far every node lies from the other part, as CSV",
                None,
            ),
            Self::SaveCards => (
                "Save LS-DYNA cards…",
                "Write the cards that map the stamped part, and read them back",
                None,
            ),
            Self::SaveMoved => (
                "Save moved part…",
                "Write the stamped part where it lies on the crash part",
                None,
            ),
            Self::CopyCommandLine => (
                "Copy as command line",
                "Copy the line that does this match again without the window, bit for bit",
                None,
            ),
            Self::CopyLog => ("Copy log", "Copy the rows of the log as text", None),
            Self::PictureOptions => (
                "Picture as…",
                "Choose size, background and windows of a picture, then write it",
                Some(Shortcut::shift(Key::Function(12))),
            ),
            Self::TakePicture => (
                "Picture",
                "Write a picture of the 3D windows as the last one was taken",
                Some(function(12)),
            ),
            _ => (
                "Picture without background",
                "Write a picture of the 3D windows on a transparent ground",
                Some(Shortcut::ctrl(Key::Function(12))),
            ),
        }
    }

    fn help_row(self) -> Row {
        match self {
            Self::Palette => (
                "Search commands…",
                "Find any command by its name",
                Some(ctrl('K')),
            ),
            Self::Help => ("Keys and mouse", "Show all keys", Some(function(1))),
            Self::Escape => (
                "End",
                "End the present tool, preview or run",
                Some(Shortcut::plain(Key::Escape)),
            ),
            _ => ("About", "Name, version, licences", None),
        }
    }
}
