//! The generated bracket as files, for the tests of the core and of the window.

use std::path::Path;

use shapematch::samples::{self, SamplePair, SamplePart, SampleSettings, SampleVariant};

/// The bracket, written into a folder: `crash.k`, `stamped.dynain` and its truth.
pub(crate) fn write_bracket(folder: &Path, variant: SampleVariant) -> SamplePair {
    let pair = samples::generate(&SampleSettings {
        part: SamplePart::Bracket,
        variant,
        ..SampleSettings::default()
    });
    for file in samples::files(&pair) {
        std::fs::write(folder.join(file.name), file.bytes).unwrap();
    }
    pair
}

/// Writes the stamped bracket, the crash part alone (`own.k`) and a car that has it twice (`twice.k`).
pub(crate) fn write_twice(folder: &Path) {
    write_bracket(folder, SampleVariant::Plain);
    std::fs::rename(folder.join("crash.k"), folder.join("own.k")).unwrap();
    write_bracket(folder, SampleVariant::WholeModel);
    let deck = include_str!("data/twice.k");
    std::fs::write(folder.join("twice.k"), deck).unwrap();
}
