//! Units that were confirmed for files before.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::formats::FileHash;
use crate::units::Units;

/// Files whose units are remembered.
const MAX_FILES: usize = 100;

/// What the user said about the units of files, so that it is asked only once.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct UnitMemory {
    files: Vec<FileUnits>,
}

/// One file, known by place and content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct FileUnits {
    path: PathBuf,
    hash: FileHash,
    /// The units the user set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    units: Option<Units>,
    /// Crash files of which the user said that the size really is different.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    differs_from: Vec<FileHash>,
}

impl UnitMemory {
    /// The units the user set for a file.
    pub fn units(&self, path: &Path, hash: Option<FileHash>) -> Option<Units> {
        self.find(path, hash?)?.units
    }

    /// True if the user said that this stamped file really has another size than that crash file.
    pub fn differs(&self, path: &Path, hash: Option<FileHash>, crash: FileHash) -> bool {
        let found = hash.and_then(|hash| self.find(path, hash));
        found.is_some_and(|file| file.differs_from.contains(&crash))
    }

    /// Remembers units, or that they are left to guessing.
    pub fn set_units(&mut self, path: &Path, hash: FileHash, units: Option<Units>) {
        self.entry(path, hash).units = units;
        self.tidy();
    }

    /// Remembers that the sizes really are different.
    pub fn set_differs(&mut self, path: &Path, hash: FileHash, crash: FileHash) {
        let file = self.entry(path, hash);
        if !file.differs_from.contains(&crash) {
            file.differs_from.push(crash);
        }
        self.tidy();
    }

    fn find(&self, path: &Path, hash: FileHash) -> Option<&FileUnits> {
        let is_it = |file: &&FileUnits| file.path == path && file.hash == hash;
        self.files.iter().find(is_it)
    }

    /// The file's entry, moved or made to be the last.
    fn entry(&mut self, path: &Path, hash: FileHash) -> &mut FileUnits {
        let known = self.files.iter().position(|file| file.path == path);
        let known = known.map(|at| self.files.remove(at));
        // Another content is another file: what was said of the old one is gone.
        let file = known.filter(|file| file.hash == hash);
        let file = file.unwrap_or_else(|| FileUnits {
            path: path.to_path_buf(),
            hash,
            units: None,
            differs_from: Vec::new(),
        });
        self.files.push(file);
        let last = self.files.len() - 1;
        &mut self.files[last]
    }

    fn tidy(&mut self) {
        self.files
            .retain(|file| file.units.is_some() || !file.differs_from.is_empty());
        let n_over = self.files.len().saturating_sub(MAX_FILES);
        self.files.drain(..n_over);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::LengthUnit;

    #[test]
    fn answers_belong_to_a_place_and_a_content() {
        let (path, [one, other]) = (Path::new("a.k"), [b"1", b"2"].map(|b| FileHash::of(b)));
        let mut memory = UnitMemory::default();
        memory.set_units(path, one, Some(LengthUnit::Meter.into()));
        memory.set_differs(path, one, other);
        let text = serde_json::to_string(&memory).unwrap();
        let memory_again: UnitMemory = serde_json::from_str(&text).unwrap();
        assert_eq!(memory_again, memory);
        assert_eq!(
            memory.units(path, Some(one)),
            Some(LengthUnit::Meter.into())
        );
        assert!(memory.differs(path, Some(one), other));
        assert_eq!(memory.units(path, Some(other)), None);
        assert_eq!(memory.units(Path::new("b.k"), Some(one)), None);
        memory.set_units(path, other, Some(LengthUnit::Inch.into()));
        assert_eq!(memory.units(path, Some(one)), None);
        memory.set_units(path, other, None);
        assert_eq!(memory, UnitMemory::default());
        for n in 0..200_u32 {
            let path = PathBuf::from(n.to_string());
            memory.set_differs(&path, one, other);
        }
        assert!(memory.differs(Path::new("199"), Some(one), other));
        assert!(!memory.differs(Path::new("0"), Some(one), other));
    }
}
