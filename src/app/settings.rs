//! Preferences that outlive the program.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::project::absolute;
use super::{NoticeLevel, PictureChoice, UnitMemory};
use crate::colormap::ColorMap;
use crate::formats::ReadOptions;
use crate::jobs::PartSource;
use crate::pipeline::names::told_apart;
use crate::role::{PerRole, Role};

/// Most entries in the list of recent files.
const MAX_RECENT: usize = 10;

/// Dark, light, or as the desktop says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Theme {
    /// As the desktop says.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

impl Theme {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::System, Self::Dark, Self::Light];

    /// Name in the window.
    pub fn label(self) -> &'static str {
        match self {
            Self::System => "System",
            Self::Dark => "Dark",
            Self::Light => "Light",
        }
    }
}

/// Which mouse habits the 3D windows follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum MouseScheme {
    /// Plain left, middle, right; the same with Shift or Ctrl held.
    #[default]
    LsPrePost,
    /// HyperWorks.
    HyperWorks,
    /// ANSA.
    Ansa,
    /// Middle button turns, as CAD programs do.
    Cad,
    /// Middle button turns, Shift pans.
    Blender,
}

impl MouseScheme {
    /// All, in the order of the menu.
    pub const ALL: [Self; 5] = [
        Self::LsPrePost,
        Self::HyperWorks,
        Self::Ansa,
        Self::Cad,
        Self::Blender,
    ];

    /// Name in the menu.
    pub fn label(self) -> &'static str {
        match self {
            Self::LsPrePost => "LS-PrePost / Oasys",
            Self::HyperWorks => "HyperWorks",
            Self::Ansa => "ANSA",
            Self::Cad => "CAD",
            Self::Blender => "Blender",
        }
    }

    /// The scheme in two lines.
    pub fn help(self) -> &'static str {
        match self {
            Self::LsPrePost => {
                "Left rotates, middle pans, right zooms.\nHolding Shift or Ctrl does the same."
            }
            Self::HyperWorks => "Ctrl + left rotates, Ctrl + right pans.\nPlain left rotates too.",
            Self::Ansa => "Ctrl + left rotates, Ctrl + middle pans.\nCtrl + right zooms.",
            Self::Cad => "Middle rotates, Ctrl + middle pans.\nShift + middle zooms.",
            Self::Blender => "Middle rotates, Shift + middle pans.\nCtrl + middle zooms.",
        }
    }
}

/// Preferences: kept between runs. Every field has a default, so an older file still loads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Colours of the window.
    pub theme: Theme,
    /// Size of everything, 0.75 to 2.5.
    pub ui_scale: f32,
    /// Decimals of a millimetre that lengths are shown with; `None` for three significant digits.
    pub decimals: Option<u8>,
    /// Colours of values with a sign that a new work begins with.
    pub signed_map: ColorMap,
    /// Colours of all other values that a new work begins with.
    pub plain_map: ColorMap,
    /// Mouse habits.
    pub mouse: MouseScheme,
    /// True once the question about the mouse was answered or closed.
    pub is_mouse_asked: bool,
    /// No animations.
    pub reduce_motion: bool,
    /// Limit on each file with its includes, unpacked, in GiB.
    pub read_limit: f64,
    /// The work is kept after each step, in case the program does not live to save it.
    pub keeps_work: bool,
    /// Files opened last, newest first.
    pub recent: Vec<PathBuf>,
    /// Labels of the commands that were searched for last, newest first.
    pub recent_commands: Vec<String>,
    /// What was said about the units of files.
    pub unit_memory: UnitMemory,
    /// Marked reduction levels, largest first.
    pub marked_levels: Vec<usize>,
    /// What stands in the field "max triangles".
    pub max_triangles: usize,
    /// Which parts the reduction is applied to.
    pub reduce_roles: PerRole<bool>,
    /// Name of the form of the matrix that was copied last.
    pub matrix_form: Option<String>,
    /// How the last picture was taken.
    pub picture: PictureChoice,
    /// Where it was put.
    pub picture_folder: Option<PathBuf>,
    /// Levels that show no toast; log and bell have them all the same.
    pub muted: BTreeSet<NoticeLevel>,
    /// When each recent file was opened last, in seconds since 1970.
    pub opened: BTreeMap<PathBuf, u64>,
    /// As which part each recent file was opened last.
    pub opened_as: BTreeMap<PathBuf, Role>,
    /// The log runs under the left column too.
    pub is_log_wide: bool,
    /// Width of the left column and height of the log, in points, as the user dragged them.
    pub pane_sizes: [Option<f32>; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: Theme::default(),
            ui_scale: 1.0,
            decimals: None,
            signed_map: ColorMap::CoolWarm,
            plain_map: ColorMap::Viridis,
            mouse: MouseScheme::default(),
            is_mouse_asked: false,
            reduce_motion: false,
            read_limit: ReadOptions::USUAL_LIMIT,
            keeps_work: true,
            recent: Vec::new(),
            recent_commands: Vec::new(),
            unit_memory: UnitMemory::default(),
            marked_levels: vec![50_000, 20_000, 8_000, 4_000, 2_000, 1_000, 500],
            max_triangles: 2_000,
            reduce_roles: PerRole {
                crash: true,
                stamped: true,
            },
            matrix_form: None,
            picture: PictureChoice::default(),
            picture_folder: None,
            muted: BTreeSet::new(),
            opened: BTreeMap::new(),
            opened_as: BTreeMap::new(),
            is_log_wide: false,
            pane_sizes: [None, None],
        }
    }
}

impl Settings {
    /// Smallest and largest size of the window's text.
    pub const UI_SCALES: std::ops::RangeInclusive<f32> = 0.75..=2.5;
    /// Decimals of a millimetre that can be chosen.
    pub const DECIMALS: std::ops::RangeInclusive<u8> = 1..=4;
    /// Read limits that can be chosen, in GiB.
    pub const READ_LIMITS: std::ops::RangeInclusive<f64> = 0.1..=1024.0;

    /// Puts a file first in the list of recent files; `now` in seconds since 1970.
    pub fn remember(&mut self, source: &PartSource, now: u64) {
        if let PartSource::File(path) = source {
            self.remember_path(path, now);
        }
    }

    /// Puts a file or a project first in the list of recent files; `now` in seconds since 1970.
    pub fn remember_path(&mut self, path: &Path, now: u64) {
        // A file may be named from the folder that the program runs in, or whole.
        let whole = absolute(path);
        self.recent.retain(|known| absolute(known) != whole);
        // Another run may begin in another folder.
        self.recent.insert(0, whole.clone());
        self.opened.insert(whole, now);
        self.trim_recent();
    }

    fn trim_recent(&mut self) {
        self.recent.truncate(MAX_RECENT);
        self.opened.retain(|path, _| self.recent.contains(path));
        self.opened_as.retain(|path, _| self.recent.contains(path));
    }

    /// Remembers as which part a file is used.
    pub fn remember_role(&mut self, source: &PartSource, role: Role) {
        if let PartSource::File(path) = source {
            self.opened_as.insert(absolute(path), role);
            self.trim_recent();
        }
    }

    /// Name of a recent file, with as much of its folder as tells it from others of that name.
    pub fn recent_name(&self, path: &Path) -> String {
        told_apart(path, self.recent.iter().map(PathBuf::as_path))
    }

    /// Brings values from a file that someone edited back into their ranges.
    pub fn sanitized(mut self) -> Self {
        let (low, high) = Self::UI_SCALES.into_inner();
        self.ui_scale = if self.ui_scale.is_finite() {
            self.ui_scale.clamp(low, high)
        } else {
            1.0
        };
        let (low, high) = Self::READ_LIMITS.into_inner();
        self.read_limit = if self.read_limit.is_finite() {
            self.read_limit.clamp(low, high)
        } else {
            ReadOptions::USUAL_LIMIT
        };
        let (low, high) = Self::DECIMALS.into_inner();
        self.decimals = self.decimals.map(|n| n.clamp(low, high));
        self.marked_levels.retain(|&n| n > 0);
        self.marked_levels.sort_unstable_by(|a, b| b.cmp(a));
        self.marked_levels.dedup();
        self.max_triangles = self.max_triangles.max(1);
        self.trim_recent();
        self.picture = self.picture.sanitized();
        self
    }
}

/// What the command line asked for. Never saved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StartupOptions {
    /// The crash part.
    pub crash: Option<PathBuf>,
    /// The stamped part.
    pub stamped: Option<PathBuf>,
    /// Open the example pair.
    pub example: bool,
    /// Open the realistic example pair.
    pub realistic: bool,
    /// Neither read nor write preferences.
    pub forget_settings: bool,
}
