//! Preferences and the place of the window on disk.

use crate::app::Settings;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Where the window was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// Inner width and height in points.
    pub size: [f32; 2],
    /// Outer corner, where the desktop tells it.
    pub corner: Option<[f32; 2]>,
    /// It filled the screen.
    pub is_maximized: bool,
}

/// What is kept between runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Kept {
    /// Preferences.
    pub settings: Settings,
    /// The window.
    pub window: Option<WindowPlace>,
}

/// The file it is kept in; without one nothing is read or written.
#[derive(Debug, Clone, Default)]
pub struct Storage {
    path: Option<PathBuf>,
    /// The folder for work that is kept in case of a crash.
    kept: Option<PathBuf>,
}

impl Storage {
    /// The user's own folder for preferences.
    pub fn of_user() -> Self {
        let folders = directories::ProjectDirs::from("", "", "shapematch");
        let path = folders.map(|folders| folders.config_dir().join("settings.json"));
        let kept = super::keeper::Keeper::folder_of_user();
        Self { path, kept }
    }

    /// Keeps nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// A file of one's own.
    pub fn at(path: &Path) -> Self {
        Self {
            path: Some(path.to_owned()),
            kept: path.parent().map(|folder| folder.join("kept")),
        }
    }

    /// The folder for kept work; none where no preferences are kept either.
    pub fn kept_folder(&self) -> Option<PathBuf> {
        self.kept.clone()
    }

    /// What was kept; defaults where there is nothing or it cannot be read.
    pub fn read(&self) -> Kept {
        let text = self
            .path
            .as_ref()
            .and_then(|path| std::fs::read_to_string(path).ok());
        let Some(text) = text else {
            return Kept::default();
        };
        serde_json::from_str(&text).unwrap_or_else(|error| {
            log::warn!("the preferences could not be read and start anew: {error}");
            Kept::default()
        })
    }

    /// Writes beside the file and renames, so that a crash leaves the old one whole.
    pub fn write(&self, kept: &Kept) -> Result<(), String> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(kept).map_err(|error| error.to_string())?;
        let beside = path.with_extension("json.new");
        path.parent()
            .map_or(Ok(()), std::fs::create_dir_all)
            .and_then(|()| std::fs::write(&beside, text))
            .and_then(|()| std::fs::rename(&beside, path))
            .map_err(|error| format!("{}: {error}", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_rubbish_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/settings.json");
        let storage = Storage::at(&path);
        assert_eq!(storage.read(), Kept::default());
        let mut kept = Kept::default();
        kept.settings.ui_scale = 1.5;
        kept.window = Some(WindowPlace {
            size: [1280.0, 720.0],
            corner: None,
            is_maximized: true,
        });
        storage.write(&kept).unwrap();
        assert_eq!(storage.read(), kept);
        std::fs::write(&path, "{ not json").unwrap();
        assert_eq!(storage.read(), Kept::default());
        assert_eq!(Storage::none().write(&kept), Ok(()));
    }
}
