//! Where preferences and sessions are kept, and what the preferences hold.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::app::Settings;
use crate::pipeline::preferences::PreferencesFile;

/// Where the window was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// Inner width and height in points.
    pub size: [f32; 2],
    /// Outer corner, where the desktop reports it.
    pub corner: Option<[f32; 2]>,
    /// It filled the screen.
    pub is_maximized: bool,
}

/// What is remembered between runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Preferences of the user.
    pub settings: Settings,
    /// Size and place of the window.
    pub window: Option<WindowPlace>,
}

/// Places on disk that belong to the program.
#[derive(Debug, Clone, Default)]
pub struct UserFiles {
    /// File the preferences are kept in.
    pub preferences: PreferencesFile,
    /// The folder for autosaved sessions; without one none are kept.
    pub sessions: Option<PathBuf>,
}

impl UserFiles {
    /// The user's own folders.
    pub fn of_user() -> Self {
        let Some(folders) = directories::ProjectDirs::from("", "", "shapematch") else {
            return Self::none();
        };
        Self {
            preferences: PreferencesFile::at(&folders.config_dir().join("settings.json")),
            sessions: Some(folders.data_local_dir().join("kept")),
        }
    }

    /// Nothing is kept.
    pub fn none() -> Self {
        Self::default()
    }

    /// A folder of one's own.
    pub fn at(folder: &Path) -> Self {
        Self {
            preferences: PreferencesFile::at(&folder.join("settings.json")),
            sessions: Some(folder.join("kept")),
        }
    }
}
