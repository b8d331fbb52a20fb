//! Choices for pictures of the 3D windows.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::app::{AppState, Document};
use crate::pipeline::outputs::stem;
use crate::report::{DIRECTION, build_id, number};
use crate::role::Role;

/// Size of a picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PictureSize {
    /// So many times the window's pixels.
    Window(u32),
    /// Width and height in pixels.
    Pixels([u32; 2]),
}

impl PictureSize {
    /// Usual sizes, in the order of the dialog.
    pub const PRESETS: [Self; 5] = [
        Self::Window(1),
        Self::Window(2),
        Self::Window(4),
        Self::Pixels([1920, 1080]),
        Self::Pixels([3840, 2160]),
    ];
    /// Smallest and largest side.
    pub const SIDES: std::ops::RangeInclusive<u32> = 64..=4096;

    /// Name in the dialog.
    pub fn label(self) -> String {
        match self {
            Self::Window(factor) => format!("Window × {factor}"),
            Self::Pixels([width, height]) => format!("{width} × {height}"),
        }
    }
}

/// Which 3D windows are in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum PictureWindows {
    /// Both side by side, or the left one where the stamped part is moved over.
    #[default]
    AsShown,
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl PictureWindows {
    /// All, in the order of the dialog.
    pub const ALL: [Self; 3] = [Self::AsShown, Self::Left, Self::Right];

    /// Name in the dialog.
    pub fn label(self) -> &'static str {
        match self {
            Self::AsShown => "As shown",
            Self::Left => "Left window",
            Self::Right => "Right window",
        }
    }
}

/// Everything that is chosen about a picture; kept between runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureChoice {
    /// Size in pixels or relative to the window.
    pub size: PictureSize,
    /// What it shows.
    pub windows: PictureWindows,
    /// Draws the parts on transparent ground.
    pub is_transparent: bool,
    /// As on the screen, with legend, names and scale; then the size is that of the screen. Without a choice: where
    /// colours show values, which say nothing without their numbers.
    pub overlays: Option<bool>,
}

impl Default for PictureChoice {
    fn default() -> Self {
        Self {
            size: PictureSize::Window(2),
            windows: PictureWindows::default(),
            is_transparent: false,
            overlays: None,
        }
    }
}

impl PictureChoice {
    /// Brings sizes from a file that someone edited back into their range.
    pub fn sanitized(mut self) -> Self {
        let (low, high) = PictureSize::SIDES.into_inner();
        self.size = match self.size {
            PictureSize::Window(factor) => PictureSize::Window(factor.clamp(1, 4)),
            PictureSize::Pixels(sides) => PictureSize::Pixels(sides.map(|s| s.clamp(low, high))),
        };
        self
    }

    /// True if a picture is taken with legend, names and scale, as `state` is.
    pub fn has_overlays(&self, state: &AppState) -> bool {
        let shows_values = |role| state.color_by(role).shows_values();
        let by_itself = !self.is_transparent && Role::ALL.into_iter().any(shows_values);
        self.overlays.unwrap_or(by_itself)
    }

    /// The size a picture is taken in, as `state` is.
    pub fn size_of(&self, state: &AppState) -> PictureSize {
        if self.has_overlays(state) {
            PictureSize::Window(1)
        } else {
            self.size
        }
    }
}

/// Where a picture goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PicturePlace {
    /// Into the file named here.
    File(PathBuf),
    /// The first name in a folder that is still free: "bp_1.png", "bp_2.png", …
    Next {
        /// Folder in which the next free name is taken.
        folder: PathBuf,
        /// What the name begins with.
        stem: String,
    },
}

impl Document {
    /// What a picture's name begins with.
    pub(in crate::app) fn picture_stem(&self) -> String {
        let part = Role::ALL.into_iter().rev().find_map(|role| self.part(role));
        part.map_or_else(
            || "shapematch".to_owned(),
            |part| stem(&part.loaded.file_name()).to_owned(),
        )
    }

    /// What a picture file says about itself: keyword and text.
    pub fn picture_texts(&self) -> Vec<(&'static str, String)> {
        let mut texts = vec![("Software", build_id())];
        for (role, part) in self.parts.iter() {
            let Some(part) = part else { continue };
            let keyword = match role {
                Role::Crash => "Crash file",
                Role::Stamped => "Stamped file",
            };
            let hash = part
                .loaded
                .hash()
                .map_or_else(String::new, |hash| format!(", SHA-256 {hash}"));
            texts.push((keyword, format!("{}{hash}", part.loaded.file_name())));
        }
        if self.part(Role::Stamped).is_some() {
            let rows = self.crash_from_stamped().to_rows();
            let rows = rows.map(|row| row.map(number).join(" "));
            texts.push(("Pose", format!("# {DIRECTION}\n{}", rows.join("\n"))));
        }
        if let Some(result) = self.current_result() {
            texts.push(("Verdict", result.verdict().label().to_owned()));
        }
        texts
    }
}
