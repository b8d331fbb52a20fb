//! What the program remembers between runs, in a file of its own.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::PipelineError;
use super::outputs::json_text;
use super::write_file::write_file_in_new_folder;

/// The file of the preferences; without one nothing is read or written.
#[derive(Debug, Clone, Default)]
pub struct PreferencesFile {
    path: Option<PathBuf>,
}

impl PreferencesFile {
    /// Preferences that are neither read nor written.
    pub fn none() -> Self {
        Self::default()
    }

    /// A file; it need not exist.
    pub fn at(path: &Path) -> Self {
        let path = Some(path.to_owned());
        Self { path }
    }

    /// The preferences; defaults where there is no file or it cannot be read.
    pub fn read<T: DeserializeOwned + Default>(&self) -> T {
        let text = self
            .path
            .as_ref()
            .and_then(|path| std::fs::read_to_string(path).ok());
        let Some(text) = text else {
            return T::default();
        };
        serde_json::from_str(&text).unwrap_or_else(|error| {
            log::warn!("the preferences cannot be read, defaults are used: {error}");
            T::default()
        })
    }

    /// Writes the preferences.
    pub fn write(&self, preferences: &impl Serialize) -> Result<(), PipelineError> {
        match &self.path {
            Some(path) => write_file_in_new_folder(path, json_text(preferences)?.as_bytes()),
            None => Ok(()),
        }
    }
}
