//! The pairs that come with the program: an easy one as files, a realistic one made when it is asked for.

use super::{
    SampleFile, SamplePair, SamplePart, SampleSettings, SampleVariant, disturb, files, generate,
};

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

/// Springback of the realistic pair and the deviation of its noise, in millimetres.
const SPRINGBACK: f64 = 2.0;
const NOISE: f64 = 0.1;
/// Share of its crash part that is left by the trim.
const TRIMMED_TO: f64 = 0.75;

/// A pair as it comes from real work: the stamped pillar is the skin of the sheet, sprung back and a
/// little rough, and the crash part is its mid-surface, trimmed. The pose is that of the undisturbed part.
pub fn realistic_pair() -> SamplePair {
    let settings = SampleSettings {
        part: SamplePart::Pillar,
        seed: 5,
        crash_size: Some(8.0),
        stamped_size: Some(8.0),
        ..SampleSettings::default()
    };
    let mut pair = generate(&settings);
    let skin = disturb::offset(&pair.stamped.to_trimesh(), 0.5 * pair.crash.thickness);
    let sprung = disturb::sprung(&skin, SPRINGBACK, settings.seed);
    let rough = disturb::noisy(&sprung, NOISE, settings.seed);
    pair.stamped.positions = rough.positions().to_vec();
    let trimmed = disturb::cut(&pair.crash.to_trimesh(), TRIMMED_TO, settings.seed);
    let (positions, triangles) = trimmed.into_parts();
    pair.crash.positions = positions;
    pair.crash.elements = triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect();
    pair
}

/// The realistic pair as its files. Takes some tenths of a second.
pub fn realistic() -> Vec<SampleFile> {
    files(&realistic_pair())
}
