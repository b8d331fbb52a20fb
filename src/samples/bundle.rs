//! The pair that comes with the program.

use super::{SampleFile, SamplePart, SampleSettings, SampleVariant};

/// What [`bundled`] was generated from: a floor, coarse enough to travel with the program.
pub fn bundled_settings() -> SampleSettings {
    SampleSettings {
        part: SamplePart::Floor,
        variant: SampleVariant::Plain,
        seed: 12,
        crash_size: Some(14.0),
        stamped_size: Some(38.0),
        ..SampleSettings::default()
    }
}

/// The bundled pair as its files, the decks packed with gzip.
pub fn bundled() -> Vec<SampleFile> {
    let file = |name, bytes: &[u8]| SampleFile {
        name,
        bytes: bytes.to_vec(),
    };
    vec![
        file(
            "crash.k.gz",
            include_bytes!("../../assets/sample/crash.k.gz"),
        ),
        file(
            "stamped.dynain.gz",
            include_bytes!("../../assets/sample/stamped.dynain.gz"),
        ),
        file(
            "truth.json",
            include_bytes!("../../assets/sample/truth.json"),
        ),
    ]
}
