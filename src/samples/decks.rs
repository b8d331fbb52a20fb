//! The pair as LS-DYNA keyword files, in standard format.

use std::fmt::Write as _;

use super::{SampleMesh, SamplePair};
use crate::formats::keyword::fixed_width::fixed_width;

/// A file of a sample, ready to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleFile {
    /// File name without folder.
    pub name: &'static str,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// First node and element id of the crash deck's first part; each part has a range of its own.
const CRASH_FIRST_ID: u64 = 20_100_001;
const CRASH_ID_RANGE: u64 = 100_000;
/// Number of the part set that names the part to match.
const PART_SET: u64 = 2_000_000;

/// All files of a pair: `crash.k`, `stamped.dynain` and `truth.json`.
pub fn files(pair: &SamplePair) -> Vec<SampleFile> {
    vec![
        SampleFile {
            name: "crash.k",
            bytes: write_crash_deck(pair).into_bytes(),
        },
        SampleFile {
            name: "stamped.dynain",
            bytes: write_stamped_deck(pair).into_bytes(),
        },
        SampleFile {
            name: "truth.json",
            bytes: write_truth(pair).into_bytes(),
        },
    ]
}

/// The crash side: parts, sections, a part set that names the part to match, nodes, shells.
pub fn write_crash_deck(pair: &SamplePair) -> String {
    let parts: Vec<&SampleMesh> = std::iter::once(&pair.crash)
        .chain(&pair.neighbours)
        .collect();
    let mut deck = String::from("*KEYWORD\n*TITLE\n");
    let name = pair.settings.part.name();
    line(&mut deck, format_args!("Crash model, sample part {name}"));
    deck.push_str("$ Unit system: mm, s, ton, N\n");
    for part in &parts {
        let (id, title) = (part.part_id, &part.title);
        let thickness = rounded(part.thickness, 10, 4);
        line(&mut deck, format_args!("*PART\n{title}"));
        deck.push_str("$#     pid     secid       mid\n");
        line(&mut deck, format_args!("{id:>10}{id:>10}{:>10}", 1));
        line(&mut deck, format_args!("*SECTION_SHELL_TITLE\n{title}"));
        deck.push_str("$#   secid    elform      shrf       nip\n");
        line(
            &mut deck,
            format_args!("{id:>10}{:>10}{:>10}{:>10}", 16, 0.8333, 5),
        );
        line(&mut deck, format!("{thickness:>10}").repeat(4));
    }
    deck.push_str("*MAT_ELASTIC_TITLE\nSTEEL\n         1   7.85E-9  210000.0       0.3\n");
    deck.push_str("*SET_PART_LIST_TITLE\nPART TO MATCH\n");
    line(&mut deck, format_args!("{PART_SET:>10}"));
    line(&mut deck, format_args!("{:>10}", pair.crash.part_id));
    deck.push_str("*NODE\n$#   nid               x               y               z\n");
    for (part, first) in parts
        .iter()
        .zip((CRASH_FIRST_ID..).step_by(CRASH_ID_RANGE as usize))
    {
        nodes(&mut deck, part, first);
    }
    deck.push_str("*ELEMENT_SHELL\n$#   eid     pid      n1      n2      n3      n4\n");
    for (part, first) in parts
        .iter()
        .zip((CRASH_FIRST_ID..).step_by(CRASH_ID_RANGE as usize))
    {
        for (element, id) in part.elements.iter().zip(first..) {
            shell(&mut deck, part.part_id, id, element, first);
        }
    }
    deck.push_str("*END\n");
    deck
}

/// The stamped side as a dynain: nodes, shells with corner thickness, stresses, strains.
pub fn write_stamped_deck(pair: &SamplePair) -> String {
    let mesh = &pair.stamped;
    let mut deck = String::from("*KEYWORD\n$ Result of a forming simulation\n*NODE\n");
    nodes(&mut deck, mesh, 1);
    deck.push_str("*ELEMENT_SHELL_THICKNESS\n");
    // A hundredth of a micron, in millimetres as in metres.
    let decimals = if mesh.thickness < 0.01 { 8 } else { 5 };
    for ((element, forming), id) in mesh.elements.iter().zip(&mesh.forming).zip(1..) {
        shell(&mut deck, mesh.part_id, id, element, 1);
        for value in forming.thickness {
            let _ = write!(deck, "{:>16}", rounded(value, 16, decimals));
        }
        deck.push('\n');
    }
    deck.push_str("*INITIAL_STRESS_SHELL\n");
    for (forming, id) in mesh.forming.iter().zip(1..) {
        line(
            &mut deck,
            format_args!("{id:>10}{:>10}{:>10}{:>10}", 1, 2, 0),
        );
        for (layer, t) in forming.layers.iter().zip([-0.57735, 0.57735]) {
            let _ = write!(deck, "{t:>10}");
            for value in layer.stress {
                let _ = write!(deck, "{:>10}", rounded(value, 10, 2));
            }
            line(
                &mut deck,
                format_args!("{:>10}", rounded(layer.plastic_strain, 10, 5)),
            );
        }
    }
    deck.push_str("*INITIAL_STRAIN_SHELL\n");
    for (forming, id) in mesh.forming.iter().zip(1..) {
        line(
            &mut deck,
            format_args!("{id:>10}{:>10}{:>10}{:>10}", 1, 2, 0),
        );
        for (layer, t) in forming.layers.iter().zip([-1.0, 1.0]) {
            for value in layer.strain {
                let _ = write!(deck, "{:>10}", rounded(value, 10, 5));
            }
            line(&mut deck, format_args!("{t:>10.1}"));
        }
    }
    deck.push_str("*END\n");
    deck
}

/// The true pose as JSON: `crash_from_stamped` as four rows, with part, variant and seed.
pub fn write_truth(pair: &SamplePair) -> String {
    let truth = serde_json::json!({
        "part": pair.settings.part.name(),
        "variant": pair.settings.variant.name(),
        "seed": pair.settings.seed,
        "crash_part": pair.crash.part_id,
        "crash_part_set": PART_SET,
        "mirrored": pair.crash_from_stamped.is_mirrored(),
        "scale": pair.crash_from_stamped.scale,
        "crash_from_stamped": pair.crash_from_stamped.to_rows(),
    });
    format!("{truth:#}\n")
}

fn line(deck: &mut String, text: impl std::fmt::Display) {
    let _ = writeln!(deck, "{text}");
}

fn nodes(deck: &mut String, mesh: &SampleMesh, first: u64) {
    for (p, id) in mesh.positions.iter().zip(first..) {
        let [x, y, z] = [p.x, p.y, p.z].map(|value| fixed_width(value, 16).unwrap_or_default());
        line(deck, format_args!("{id:>8}{x:>16}{y:>16}{z:>16}"));
    }
}

fn shell(deck: &mut String, part: u64, id: u64, element: &[u32; 4], first: u64) {
    let [a, b, c, d] = element.map(|node| first + u64::from(node));
    line(
        deck,
        format_args!("{id:>8}{part:>8}{a:>8}{b:>8}{c:>8}{d:>8}"),
    );
}

/// The nearest decimal number that fits, at most `decimals` digits after the point.
fn rounded(value: f64, width: usize, decimals: usize) -> String {
    (0..=decimals)
        .rev()
        .map(|decimals| format!("{value:.decimals$}"))
        .find(|text| text.len() <= width)
        .unwrap_or_else(|| format!("{value:.1e}"))
}
