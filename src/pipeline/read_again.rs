//! The files of a part, read once more: what is exchanged in a deck is exchanged in its text, which a model does not
//! keep.

use std::path::Path;

use super::PipelineError;
use super::load::LoadedPart;
use crate::formats::model::ReadFile;
use crate::formats::{self, Disk, FileBytes, FileHash, FileSource, FormatError, Memory};
use crate::monitor::Monitor;
use crate::samples::{self, SampleFile};

/// The files of a part, where they can be read again.
pub(super) struct ReadAgain<'a> {
    part: &'a LoadedPart,
    from: Box<dyn FileSource>,
}

impl<'a> ReadAgain<'a> {
    /// Files on disk, or in the program where the part is an example.
    pub(super) fn new(part: &'a LoadedPart) -> Self {
        Self {
            part,
            from: source_of(part),
        }
    }

    /// The text of one of the files; an error if it is not what the part was made of any more. Its ids may belong to
    /// other elements.
    pub(super) fn text(
        &self,
        file: &ReadFile,
        monitor: &Monitor,
    ) -> Result<FileBytes, PipelineError> {
        let settings = &self.part.settings.read;
        let text = formats::read_text(&*self.from, &file.path, settings, monitor)?;
        // Behind the text, so that no change between the two is missed.
        if let Some(read) = file.hash {
            let now = FileHash::of_file(&*self.from, &file.path, monitor)
                .map_err(|error| FormatError::open(&file.path, &error))?;
            if now != read {
                return Err(PipelineError::Changed(file.path.clone()));
            }
        }
        Ok(text)
    }

    /// Where the files are read.
    pub(super) fn source(&self) -> &dyn FileSource {
        &*self.from
    }
}

fn source_of(part: &LoadedPart) -> Box<dyn FileSource> {
    let own_of = |files: Vec<SampleFile>| {
        let mut named = files
            .into_iter()
            .filter(|file| part.path == Path::new(file.name));
        named.find(|file| part.hash() == Some(FileHash::of(&file.bytes)))
    };
    let mut own = own_of(samples::bundled());
    if own.is_none() && Disk.find(&part.path).is_none() {
        own = own_of(samples::realistic());
    }
    match own {
        Some(file) => Box::new(Memory::new().with(file.name, file.bytes)),
        None => Box::new(Disk),
    }
}
