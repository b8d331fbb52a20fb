//! The further stamped files as they are seen in 3D: which there are, where they lie, which were hidden.

use std::path::Path;

use super::{Further, MapResult};
use crate::app::{AppState, Document, Shared};
use crate::geometry::Similarity;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::names::told_apart;
use crate::role::Role;

/// A further stamped file in the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownFile {
    /// Its number among the stamped files, which its colour follows; the first stamped part is 0.
    pub number: usize,
    /// What was read.
    pub loaded: Shared<LoadedPart>,
    /// `crash = c · R · stamped + t`; `None` if it lies as the first one.
    pub own_pose: Option<Similarity>,
}

/// What a stamped file gave to a mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct FileShare {
    /// Its number among the stamped files.
    pub number: usize,
    /// The file's name.
    pub name: String,
    /// How many elements took their values from it.
    pub n_elements: usize,
    /// Their share of the area.
    pub area_share: f64,
    /// The first of them, by its place in the run.
    pub first: Option<usize>,
}

impl MapResult {
    /// True if it was made from several stamped files.
    pub(in crate::app) fn has_several_files(&self) -> bool {
        !self.further.is_empty()
    }
}

impl Document {
    /// True once the stamped part was brought to the crash part, or mapped from where it lies.
    pub fn is_stamped_placed(&self) -> bool {
        self.both().is_some() && (self.has_pose() || self.current_mapping().is_some())
    }

    /// The number of each further stamped file of the list: that of the current mapping where it was made
    /// from the file, so that colours stay what they were; new files come after them.
    fn file_numbers(&self) -> Vec<usize> {
        let mapped = self.current_mapping();
        let mapped = mapped.map_or(&[][..], |result| &result.further);
        let mut next = mapped.len();
        let mut number = |further: &Further| {
            let known = mapped
                .iter()
                .position(|part| part.is_same_surface(&further.loaded));
            1 + known.unwrap_or_else(|| {
                next += 1;
                next - 1
            })
        };
        self.mapping.further.iter().map(&mut number).collect()
    }

    /// The number of a further stamped file, by the number that is never given twice.
    pub(super) fn file_number(&self, revision: u64) -> Option<usize> {
        let further = self.mapping.further.iter();
        let mut pairs = further.zip(self.file_numbers());
        let found = pairs.find(|(further, _)| further.revision == revision);
        found.map(|(_, number)| number)
    }

    /// Its name, with as much of its folder as tells it from the others of the mapping.
    pub fn mapped_file_name(&self, number: usize) -> Option<String> {
        let n_files = 1 + self.current_mapping()?.further.len();
        let all = (0..n_files).filter_map(|number| self.mapped_file(number));
        let own = self.mapped_file(number)?;
        Some(told_apart(&own.path, all.map(|part| part.path.as_path())))
    }

    /// A stamped file that the current mapping was made from.
    pub fn mapped_file(&self, number: usize) -> Option<&Shared<LoadedPart>> {
        let result = self.current_mapping()?;
        match number.checked_sub(1) {
            None => self.part(Role::Stamped).map(|part| &part.loaded),
            Some(further) => result.further.get(further),
        }
    }
}

impl AppState {
    /// The further stamped files that are seen with the first one: those with a pose that were not hidden,
    /// once the first one has been brought to the crash part.
    pub fn shown_further(&self) -> Vec<ShownFile> {
        let document = &self.document;
        let is_seen = document.is_stamped_placed() && !self.is_preview();
        let Some(both) = document.both().filter(|_| is_seen) else {
            return Vec::new();
        };
        let further = document.mapping.further.iter();
        let shown = further.zip(document.file_numbers());
        let shown = shown.filter(|(further, _)| !self.is_file_hidden(&further.loaded.path));
        shown
            .filter_map(|(further, number)| {
                Some(ShownFile {
                    number,
                    loaded: further.loaded.clone(),
                    own_pose: further.place(both)?,
                })
            })
            .collect()
    }

    /// True if the first stamped part is hidden in the list of files.
    pub fn is_first_file_hidden(&self) -> bool {
        let part = self.document.part(Role::Stamped);
        part.is_some_and(|part| self.is_file_hidden(&part.loaded.path))
    }

    /// True if a stamped file was hidden. One file alone has no list in which it could be shown again.
    pub(in crate::app) fn is_file_hidden(&self, file: &Path) -> bool {
        !self.document.mapping.further.is_empty() && self.view.hidden_files.contains(file)
    }

    /// What each stamped file gave to the current mapping; empty if there was one only.
    pub fn map_files(&self) -> Vec<FileShare> {
        let result = self.document.current_mapping();
        let Some(result) = result.filter(|result| result.has_several_files()) else {
            return Vec::new();
        };
        let files = result.lists.givers.iter().enumerate();
        files
            .filter_map(|(number, giver)| {
                Some(FileShare {
                    number,
                    name: self.document.mapped_file_name(number)?,
                    n_elements: giver.n_elements,
                    area_share: giver.area_share,
                    first: giver.first,
                })
            })
            .collect()
    }
}
