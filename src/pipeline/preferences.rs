//! What the program remembers between runs, in a file of its own.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::PipelineError;
use super::outputs::json_text;
use super::write_file::write_file_in_new_folder;

/// The file of the preferences; without one nothing is read or written. Programs that run at once share it:
/// each writes what it changed itself, and keeps what the others did.
#[derive(Debug, Clone, Default)]
pub struct PreferencesFile {
    path: Option<PathBuf>,
    /// What this program read or wrote last.
    known: Option<Value>,
}

impl PreferencesFile {
    /// Preferences that are neither read nor written.
    pub fn none() -> Self {
        Self::default()
    }

    /// A file; it need not exist.
    pub fn at(path: &Path) -> Self {
        Self {
            path: Some(path.to_owned()),
            known: None,
        }
    }

    /// The preferences; defaults where there is no file or it cannot be read.
    pub fn read<T: DeserializeOwned + Serialize + Default>(&mut self) -> T {
        let read: T = self.text().map_or_else(T::default, |text| {
            serde_json::from_str(&text).unwrap_or_else(|error| {
                log::warn!("the preferences cannot be read, defaults are used: {error}");
                T::default()
            })
        });
        self.known = serde_json::to_value(&read).ok();
        read
    }

    /// Writes the preferences, with what other programs changed since this one wrote.
    pub fn write(&mut self, preferences: &impl Serialize) -> Result<(), PipelineError> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let ours = serde_json::to_value(preferences).ok();
        let theirs = self.text();
        let theirs: Option<Value> = theirs.and_then(|text| serde_json::from_str(&text).ok());
        let all = match &theirs {
            Some(theirs) => merged(self.known.as_ref(), ours.as_ref(), Some(theirs)),
            None => ours.clone(),
        };
        write_file_in_new_folder(path, json_text(&all)?.as_bytes())?;
        self.known = ours;
        Ok(())
    }

    fn text(&self) -> Option<String> {
        std::fs::read_to_string(self.path.as_ref()?).ok()
    }
}

/// What this program changed since `known`, in what the others wrote.
fn merged(known: Option<&Value>, ours: Option<&Value>, theirs: Option<&Value>) -> Option<Value> {
    if ours == known {
        return theirs.cloned();
    }
    match (ours, theirs) {
        (Some(Value::Object(ours)), Some(Value::Object(theirs))) => {
            let known = known.and_then(Value::as_object);
            let keys = ours.keys().chain(theirs.keys());
            let values = keys.filter_map(|key| {
                let known = known.and_then(|known| known.get(key));
                let value = merged(known, ours.get(key), theirs.get(key))?;
                Some((key.clone(), value))
            });
            Some(Value::Object(values.collect::<Map<_, _>>()))
        }
        // Of lists of names, as of the files opened last, those that others added stay.
        (Some(Value::Array(ours)), Some(Value::Array(theirs))) if is_names(ours, theirs) => {
            let known = known.and_then(Value::as_array);
            let is_known = |name: &Value| known.is_some_and(|known| known.contains(name));
            let added = theirs.iter();
            let added = added.filter(|name| !ours.contains(name) && !is_known(name));
            Some(ours.iter().chain(added).cloned().collect())
        }
        _ => ours.cloned(),
    }
}

fn is_names(ours: &[Value], theirs: &[Value]) -> bool {
    ours.iter().chain(theirs).all(Value::is_string)
}
