//! Holds the page of tuned constants against the code. `UPDATE_EXPECT=1` rewrites it.

use std::fmt::Write as _;
use std::path::Path;

use super::layering::{rust_files, source_root};

/// The modules with tuned constants, each with what they were tuned on.
const MODULES: &[(&str, &str, &str)] = &[
    (
        "registration/icp",
        "One ICP run",
        "Set on the sample parts in ten variants from random placements (`tests/core/samples.rs`), with the \
         known poses as reference.",
    ),
    (
        "registration/multi_start",
        "Starts, rounds and scores",
        "Set on all pairs of the sample parts and their variants, near-symmetric brackets and pillars among \
         them: right pose first, time second.",
    ),
    (
        "registration/wide",
        "The wide search",
        "Set on random shapes of the sample parts with springback of 1, 3 and 8 mm, noise, and cuts to 60, 35 and \
         20 % of the area (`shapematch bench --robustness`).",
    ),
    (
        "registration",
        "Surfaces and agreement of poses",
        "Set on the sample parts and on public decks.",
    ),
    (
        "search",
        "Closest points",
        "Limits of `f32`, which cost time and never a result: every answer is decided in `f64` and compared with \
         the plain loop (`tests/core/search.rs`). Sizes were measured with `cargo bench --bench search`.",
    ),
    (
        "assess",
        "The verdict",
        "Calibrated on random shapes with every disturbance of `shapematch bench --robustness`; the figures are in \
         `tests/bench/RESULTS.md`.",
    ),
    (
        "settling",
        "The last steps of a match",
        "Set on random shapes of the sample parts and on families of sheet parts that are unlike them; the figures \
         are in `tests/bench/RESULTS.md`.",
    ),
    (
        "simplify",
        "Reduction",
        "Measured on the car floor of 34,808 triangles against a plain textbook implementation \
         (`cargo bench --bench simplify`).",
    ),
    (
        "mapping",
        "Mapping",
        "From the tests with closed forms in `tests/core/mapping.rs` and the literature named in the modules.",
    ),
];

/// A constant as the code has it.
struct Constant {
    name: String,
    value: String,
    doc: String,
}

/// The numeric constants of a file that stand outside of functions, in its order.
fn constants(text: &str) -> Vec<Constant> {
    let mut found: Vec<Constant> = Vec::new();
    let mut doc: Vec<&str> = Vec::new();
    let code = text.split("#[cfg(test)]").next().unwrap();
    for line in code.lines() {
        if let Some(words) = line.strip_prefix("///") {
            doc.push(words.trim());
            continue;
        }
        let declared = line.trim_start_matches("pub").trim_start_matches("(super)");
        let declared = declared.trim_start_matches("(crate)").trim_start();
        let parts = declared.strip_prefix("const ").and_then(|rest| {
            let (name, rest) = rest.split_once(": ")?;
            let (kind, value) = rest.split_once(" = ")?;
            let is_number = ["f64", "f32", "usize", "u32", "u64"].contains(&kind);
            let value = value.split(';').next()?.split(" //").next()?;
            is_number.then(|| (name.to_owned(), value.replace('_', "")))
        });
        if let Some((name, value)) = parts {
            // A constant without words of its own shares those above it.
            let doc = if doc.is_empty() {
                "as above".to_owned()
            } else {
                doc.join(" ").trim_end_matches('.').to_owned()
            };
            found.push(Constant { name, value, doc });
        }
        doc.clear();
    }
    found
}

fn page() -> String {
    let mut page = "# Tuned constants\n\n\
        What the program decides with fixed numbers, module by module: the value, its meaning, and what it was \
        tuned on. Settings that a user can change are listed by `shapematch help match`; the rules of the stages \
        of a match stand as one table in `registration/icp/stages.rs`. This page is written from the comments in \
        the code: `UPDATE_EXPECT=1 cargo test --no-default-features --test core tuning`.\n"
        .to_owned();
    for (module, title, tuned_on) in MODULES {
        let root = source_root().join(module);
        // Modules with a section of their own are not repeated.
        let is_own = |path: &Path| {
            let inner = MODULES.iter().map(|(other, ..)| source_root().join(other));
            let deepest = inner.filter(|other| path.starts_with(other));
            deepest.max_by_key(|other| other.components().count()) == Some(root.clone())
        };
        let files = rust_files(&root).into_iter().filter(|path| is_own(path));
        let mut rows = String::new();
        for path in files {
            let text = std::fs::read_to_string(&path).unwrap();
            let file = path
                .strip_prefix(source_root())
                .unwrap()
                .display()
                .to_string();
            for Constant { name, value, doc } in constants(&text) {
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
                struct S;\n/// Not a number.\nconst D: &str = \"x\";\n#[cfg(test)]\nconst E: f64 = 1.0;";
    let found = constants(text);
    let plain: Vec<_> = found
        .iter()
        .map(|c| [&c.name[..], &c.value, &c.doc])
        .collect();
    assert_eq!(
        plain,
        [["A_B", "1000.5", "Much. More"], ["C", "1 << 4", "as above"]]
    );
}
