//! Holds the page of tuned constants against the code. `UPDATE_EXPECT=1` rewrites it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::layering::{rust_files, source_root};

/// The modules and files with tuned constants, with their heading and what they were tuned on.
const MODULES: &[(&[&str], &str, &str)] = &[
    (
        &["registration/icp"],
        "One ICP run",
        "Set on the sample parts in ten variants from random placements (`tests/core/samples.rs`), with the \
         known poses as reference.",
    ),
    (
        &["registration/multi_start"],
        "Starts, rounds and scores",
        "Set on all pairs of the sample parts and their variants, near-symmetric brackets and pillars among \
         them: right pose first, time second.",
    ),
    (
        &["registration/wide"],
        "The wide search",
        "Set on random shapes of the sample parts with springback of 1, 3 and 8 mm, noise, and cuts to 60, 35 and \
         20 % of the area (`shapematch bench --robustness`).",
    ),
    (
        &["registration"],
        "Surfaces and agreement of poses",
        "Set on the sample parts and on public decks.",
    ),
    (
        &["search"],
        "Closest points",
        "Limits of `f32`, which cost time and never a result: every answer is decided in `f64` and compared with \
         the plain loop (`tests/core/search.rs`). Sizes were measured with `cargo bench --bench search`.",
    ),
    (
        &["assess"],
        "The verdict",
        "Calibrated on random shapes with every disturbance of `shapematch bench --robustness`; the figures are in \
         `tests/bench/RESULTS.md`.",
    ),
    (
        &["settling"],
        "The last steps of a match",
        "Set on random shapes of the sample parts and on families of sheet parts that are unlike them; the figures \
         are in `tests/bench/RESULTS.md`.",
    ),
    (
        &["simplify"],
        "Reduction",
        "Measured on the car floor of 34,808 triangles against a plain textbook implementation \
         (`cargo bench --bench simplify`).",
    ),
    (
        &["mapping"],
        "Mapping",
        "From the tests with closed forms in `tests/core/mapping.rs` and the literature named in the modules.",
    ),
    (
        &[
            "pipeline/find_parts.rs",
            "pipeline/find_parts",
            "pipeline/joined_parts.rs",
            "pipeline/likeness.rs",
        ],
        "Which parts belong together",
        "Checked on decks of generated parts (`tests/core/find_parts.rs`, `tests/core/map_car.rs`).",
    ),
    (
        &[
            "pipeline/map/ready.rs",
            "pipeline/map/verdict.rs",
            "pipeline/map/peak.rs",
        ],
        "Checks of a mapping",
        "Checked on generated parts with known fields (`shapematch bench --mapping`, `tests/core/map_files.rs`) and on \
         decks in other units (`tests/core/map_refusals.rs`).",
    ),
    (
        &[
            "geometry/borders.rs",
            "geometry/cracks.rs",
            "geometry/landmarks.rs",
        ],
        "Borders, cracks and holes",
        "Checked on meshes with known borders, in the tests of these files.",
    ),
    (
        &["units/guess.rs"],
        "Units",
        "Checked on usual sheet parts in every unit, in the tests of this file and `tests/core/units.rs`.",
    ),
];

/// A constant as the code has it.
struct Constant {
    name: String,
    value: String,
    doc: String,
}

/// The numeric constants of a file that stand outside of functions, in its order: numbers, arrays and tuples of
/// numbers. Directly below another, one without words of its own shares those above it; elsewhere it has none.
fn constants(text: &str) -> Vec<Constant> {
    let mut found: Vec<Constant> = Vec::new();
    let mut doc: Vec<&str> = Vec::new();
    let mut is_below = false;
    let code = text.split("#[cfg(test)]").next().unwrap();
    for line in code.lines() {
        if let Some(words) = line.strip_prefix("///") {
            doc.push(words.trim());
            is_below = false;
            continue;
        }
        let declared = line.split_once("const ");
        let declared =
            declared.filter(|(before, _)| before.is_empty() || before.starts_with("pub"));
        let parts = declared.and_then(|(_, rest)| {
            let (name, rest) = rest.split_once(": ")?;
            let (kind, value) = rest.split_once(" = ")?;
            let kind = kind.trim_start_matches(['[', '(']);
            let is_number = ["f64", "f32", "usize", "u32", "u64"]
                .iter()
                .any(|number| kind.starts_with(number));
            let value = value.split(" //").next()?.strip_suffix(';')?;
            is_number.then(|| (name.to_owned(), without_separators(value)))
        });
        let is_constant = declared.is_some();
        if let Some((name, value)) = parts {
            let doc = if doc.is_empty() && is_below {
                "as above".to_owned()
            } else {
                doc.join(" ").trim_end_matches('.').to_owned()
            };
            found.push(Constant { name, value, doc });
        }
        doc.clear();
        is_below = is_constant;
    }
    found
}

/// A value without the underscores between its digits; those of names stay.
fn without_separators(value: &str) -> String {
    let letters: Vec<char> = value.chars().collect();
    let is_digit = |at: Option<usize>| {
        at.and_then(|at| letters.get(at))
            .is_some_and(char::is_ascii_digit)
    };
    let kept = letters.iter().enumerate().filter(|&(at, &letter)| {
        letter != '_' || !(is_digit(at.checked_sub(1)) && is_digit(Some(at + 1)))
    });
    kept.map(|(_, letter)| letter).collect()
}

fn page() -> String {
    let mut page = "# Tuned constants\n\n\
        What the program decides with fixed numbers, module by module: the value, its meaning, and what it was \
        tuned on. Settings that a user can change are listed by `shapematch help match`; the rules of the stages \
        of a match stand as one table in `registration/icp/stages.rs`. This page is written from the comments in \
        the code: `UPDATE_EXPECT=1 cargo test --no-default-features --test core tuning`.\n"
        .to_owned();
    let places = MODULES.iter().flat_map(|(places, ..)| *places);
    let places: Vec<PathBuf> = places.map(|place| source_root().join(place)).collect();
    for (modules, title, tuned_on) in MODULES {
        let files = modules.iter().flat_map(|module| {
            let root = source_root().join(module);
            let all = if root.is_file() {
                vec![root.clone()]
            } else {
                rust_files(&root)
            };
            // Modules with a section of their own are not repeated.
            let is_own = |path: &PathBuf| {
                let inner = places.iter().filter(|other| path.starts_with(other));
                inner.max_by_key(|other| other.components().count()) == Some(&root)
            };
            all.into_iter().filter(is_own).collect::<Vec<_>>()
        });
        let mut rows = String::new();
        for path in files {
            let text = std::fs::read_to_string(&path).unwrap();
            let file = path
                .strip_prefix(source_root())
                .unwrap()
                .display()
                .to_string();
            for Constant { name, value, doc } in constants(&text) {
                assert!(!doc.is_empty(), "say what {name} in {file} means");
                let doc = doc.replace('|', "\\|");
                writeln!(rows, "| `{name}` | {value} | {doc} | `{file}` |").unwrap();
            }
        }
        write!(
            page,
            "\n## {title}\n\n{tuned_on}\n\n| constant | value | meaning | file |\n|---|---|---|---|\n{rows}"
        )
        .unwrap();
    }
    page
}

#[test]
fn the_page_of_tuned_constants_says_what_the_code_does() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tuning.md");
    let expected = page();
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(&path, &expected).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == expected,
        "docs/tuning.md is older than the code; UPDATE_EXPECT=1 writes it again"
    );
}

#[test]
fn constants_are_read_with_their_words() {
    let text = "/// Much.\n/// More.\npub(super) const A_B: f64 = 1_000.5;\nconst C: usize = 1 << 4; // x\n\n\
                const BARE: [f64; 2] = [2_000.0, 0.5];\npub(in crate::x) const F: u32 = N_1 + 3;\n\
                struct S;\n/// Not a number.\nconst D: &str = \"x\";\n#[cfg(test)]\nconst E: f64 = 1.0;";
    let found = constants(text);
    let plain: Vec<_> = found
        .iter()
        .map(|c| [&c.name[..], &c.value, &c.doc])
        .collect();
    assert_eq!(
        plain,
        [
            ["A_B", "1000.5", "Much. More"],
            ["C", "1 << 4", "as above"],
            ["BARE", "[2000.0, 0.5]", ""],
            ["F", "N_1 + 3", "as above"],
        ]
    );
}
