//! Habits that no compiler checks: file sizes, stray marks, imports, words, threads.

use std::path::Path;

use super::layering::{rust_files, source_root};

/// Lines of a file before its test module.
const MAX_LINES: usize = 600;

#[test]
fn files_stay_readable() {
    let mut long = Vec::new();
    for path in rust_files(&source_root()) {
        let text = std::fs::read_to_string(&path).unwrap();
        let n_lines = text
            .lines()
            .take_while(|line| line.trim() != "#[cfg(test)]")
            .count();
        if n_lines > MAX_LINES {
            long.push(format!("{}: {n_lines} lines", path.display()));
        }
    }
    assert!(long.is_empty(), "split these files:\n{}", long.join("\n"));
}

#[test]
fn nothing_is_left_lying_about() {
    let marks = [
        "TODO",
        "XXX",
        "HACK",
        "todo!(",
        "unimplemented!(",
        "#[ignore",
    ];
    let mut found = Vec::new();
    for path in rust_files(&source_root()) {
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark)) {
                found.push(format!(
                    "{}:{}: {}",
                    path.display(),
                    number + 1,
                    line.trim()
                ));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Colours stand in the theme, in the palette and in the colour maps; elsewhere they have names.
#[test]
fn colours_are_written_in_one_place() {
    let homes = ["src/ui/theme", "src/palette.rs", "src/colormap"];
    let signs = [
        "from_rgb(",
        "from_gray(",
        "from_black_alpha(",
        "from_rgba_unmultiplied_const(",
        "[0x",
    ];
    let mut found = Vec::new();
    for path in rust_files(&source_root()) {
        let place = path.display().to_string();
        let is_window = place.contains("src/ui") || place.contains("src/render");
        if !is_window || homes.iter().any(|home| place.contains(home)) {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for (number, line) in code.lines().enumerate() {
            let code = line.split("//").next().unwrap();
            if signs.iter().any(|sign| code.contains(sign)) {
                found.push(format!("{place}:{}: {}", number + 1, line.trim()));
            }
        }
    }
    assert!(
        found.is_empty(),
        "name these colours in the theme:\n{}",
        found.join("\n")
    );
}

/// All source files with their text.
fn sources() -> Vec<(String, String)> {
    let read = |path: std::path::PathBuf| {
        let name = path
            .strip_prefix(source_root())
            .unwrap()
            .display()
            .to_string();
        (name, std::fs::read_to_string(&path).unwrap())
    };
    rust_files(&source_root()).into_iter().map(read).collect()
}

#[test]
fn every_file_says_what_it_is_for() {
    let silent: Vec<String> = sources()
        .into_iter()
        .filter(|(_, text)| !text.starts_with("//! "))
        .map(|(name, _)| name)
        .collect();
    assert!(silent.is_empty(), "no `//!` head:\n{}", silent.join("\n"));
}

/// Code is broken by the formatter, which leaves comments as they are.
#[test]
fn comments_are_at_most_120_columns_wide() {
    let wide_lines = |(name, text): (String, String)| {
        let lines = text.lines().enumerate();
        let comments = lines.filter(|(_, line)| line.trim_start().starts_with("//"));
        let wide = comments.filter(|(_, line)| line.chars().count() > 120);
        wide.map(|(at, _)| format!("{name}:{}", at + 1))
            .collect::<Vec<_>>()
    };
    let wide: Vec<String> = sources().into_iter().flat_map(wide_lines).collect();
    assert!(wide.is_empty(), "too wide:\n{}", wide.join("\n"));
}

/// 0 for the standard library, 1 for crates, 2 for modules of ours.
fn import_group(line: &str, modules: &[&str]) -> u8 {
    let path = line.trim_start_matches("use ").trim_start_matches("::");
    let first: &str = path.split([':', ';', ' ', '{']).next().unwrap_or_default();
    match first {
        "std" | "core" | "alloc" => 0,
        "crate" | "self" | "super" => 2,
        name if modules.contains(&name) => 2,
        _ => 1,
    }
}

#[test]
fn imports_stand_in_three_groups() {
    let mut broken = Vec::new();
    for (name, text) in sources() {
        let modules: Vec<&str> = text
            .lines()
            .filter_map(|line| line.split("mod ").nth(1)?.strip_suffix(';'))
            .collect();
        let mut last: Option<u8> = None;
        let mut is_after_blank = true;
        let mut is_open = false;
        for (number, line) in text.lines().enumerate() {
            if is_open {
                is_open = !line.ends_with(';');
            } else if line.starts_with("use ") {
                let group = import_group(line, &modules);
                let fits = match last {
                    None => true,
                    Some(last) => {
                        group == last && !is_after_blank || group > last && is_after_blank
                    }
                };
                if !fits {
                    broken.push(format!("{name}:{}: {line}", number + 1));
                }
                last = Some(group);
                is_open = !line.ends_with(';');
                is_after_blank = false;
            } else if line.is_empty() {
                is_after_blank = true;
            } else if !line.starts_with("#[cfg") {
                last = None;
            }
        }
    }
    let broken = broken.join("\n");
    assert!(broken.is_empty(), "std, then crates, then ours:\n{broken}");
}

/// Words that ARCHITECTURE.md replaces by those of the field, with what to say instead.
const REPLACED_WORDS: &[(&str, &str)] = &[
    ("Contest", "MultiStart"),
    ("Entrant", "Candidate"),
    ("Contender", "RankedCandidate"),
    ("Heat", "Round"),
    ("Judge", "PoseScorer"),
    ("Fate", "StartOutcome"),
    ("Draughtsman", "FigureRenderer"),
    ("Keeper", "Autosave"),
    ("gravest", "most severe"),
    ("hopeless", "sizes incompatible"),
    ("laid on", "aligned to"),
];

#[test]
fn words_of_the_glossary_are_used() {
    let mut found = Vec::new();
    for (name, text) in sources() {
        for (number, line) in text.lines().enumerate() {
            for (word, better) in REPLACED_WORDS {
                if has_word(line, word) {
                    found.push(format!("{name}:{}: {word} → {better}", number + 1));
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Texts that the window and the report said before, each with what they say now.
const REPLACED_TEXTS: &[(&str, &str)] = &[
    ("Not now: ", "what is missing, as a sentence"),
    ("Nothing was done yet", "No steps yet"),
    ("Mouse like", "Mouse controls"),
    ("Preparing the picture", "Building the 3D view…"),
    (
        "waiting for the work before it",
        "Waiting for the previous task",
    ),
    ("Align surface normal\"", "Align surface normals"),
    ("starts that agree", "Converged starts"),
    ("what became of it", "Outcome"),
    ("dropped after", "stopped after"),
    ("score ratio", "error … % higher"),
    ("Nearly as good", "Alternatives (V)"),
    ("part that fits twice", "Ambiguous pose"),
    ("shape that slides on itself", "Sliding possible"),
    ("The wrong place?", "Wrong location"),
    ("Neither part contains", "Partial overlap only"),
    ("95 % within\"", "P95"),
    ("Worst places", "Largest deviations"),
    ("Turn over", "Flip 180°"),
    ("Centres together", "Align centres"),
    ("Forget the pivot", "Clear pivot"),
    ("Size of the text", "UI scale"),
    ("Show toasts for", "Notifications"),
    ("No command of that name", "No matching command"),
    ("Own size", "Custom size"),
    ("Settled below", "Convergence limit"),
    ("Off by more", "Beyond the limit"),
    ("No counterpart\"", "On this part only"),
    ("no counterpart\"", "on this part only"),
];

/// What is found in lines of these modules that are no comments, each with its place.
fn found_in_code_of(modules: &[&str], find: impl Fn(&str) -> Option<String>) -> String {
    let is_meant = |name: &str| modules.iter().any(|module| name.starts_with(module));
    let mut found = Vec::new();
    for (name, text) in sources().into_iter().filter(|(name, _)| is_meant(name)) {
        let lines = text.lines().enumerate();
        for (number, line) in lines.filter(|(_, line)| !line.trim_start().starts_with("//")) {
            found.extend(find(line).map(|what| format!("{name}:{}: {what}", number + 1)));
        }
    }
    found.join("\n")
}

#[test]
fn window_and_report_keep_to_the_words_agreed_on() {
    let places = ["ui", "app", "report", "assess", "settings"];
    let found = found_in_code_of(&places, |line| {
        let replaced = REPLACED_TEXTS.iter().find(|(old, _)| line.contains(old));
        replaced.map(|(old, new)| format!("{old} → {new}"))
    });
    assert!(found.is_empty(), "{found}");
}

#[test]
fn counts_agree_with_their_nouns() {
    let places = ["ui", "app", "report", "assess", "cli"];
    let found = found_in_code_of(&places, |line| {
        has_fixed_plural(line).then(|| line.trim().to_owned())
    });
    assert!(
        found.is_empty(),
        "one is no plural, so use counted:\n{found}"
    );
}

/// True for `{n_parts} parts` and `{n} parts`, in which one would be a plural. A share, as in "2 of {n} parts", has
/// one.
fn has_fixed_plural(line: &str) -> bool {
    line.match_indices("{n").any(|(at, _)| {
        let is_share = line[..at].ends_with(" of ");
        let Some((value, rest)) = line[at + 1..].split_once("} ") else {
            return false;
        };
        let is_count = value == "n" || value.starts_with("n_");
        let is_letter = |c: &char| c.is_ascii_lowercase();
        let word: String = rest.chars().take_while(is_letter).collect();
        let is_verb = ["is", "was", "has", "as"].contains(&word.as_str());
        is_count && !is_share && word.ends_with('s') && !is_verb
    })
}

#[test]
fn a_fixed_plural_is_seen() {
    for line in ["\"{n} starts\"", "\"for {n_parts} parts, with\""] {
        assert!(has_fixed_plural(line), "{line}");
    }
    for line in [
        "\"{n} of\"",
        "\"1 of {n} starts\"",
        "\"{name} stands\"",
        "\"{n} is\"",
    ] {
        assert!(!has_fixed_plural(line), "{line}");
    }
}

/// True if the line holds the word, not as a part of a longer one.
fn has_word(line: &str, word: &str) -> bool {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !before.is_some_and(is_letter) && !after.is_some_and(is_letter)
    })
}

#[test]
fn threads_have_names() {
    let unnamed: Vec<String> = sources()
        .into_iter()
        .filter(|(_, text)| text.contains("thread::spawn("))
        .map(|(name, _)| name)
        .collect();
    let unnamed = unnamed.join(", ");
    assert!(
        unnamed.is_empty(),
        "name the threads (thread::Builder): {unnamed}"
    );
}

#[test]
fn the_readme_shows_every_subcommand() {
    use clap::CommandFactory as _;
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    let command = shapematch::cli::Cli::command();
    let missing: Vec<&str> = command
        .get_subcommands()
        .map(clap::Command::get_name)
        .filter(|name| !readme.contains(&format!("shapematch {name}")))
        .collect();
    assert!(missing.is_empty(), "not in README.md: {missing:?}");
}

/// The pages of the project that name files and options.
fn pages() -> [(&'static str, String); 5] {
    [
        "README.md",
        "ARCHITECTURE.md",
        "docs/files.md",
        "docs/mapping.md",
        "docs/tuning.md",
    ]
    .map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        (name, std::fs::read_to_string(path).unwrap())
    })
}

/// What stands in backticks on a page, outside of blocks.
fn quoted(page: &str) -> Vec<&str> {
    let is_block = |index: usize| index % 2 == 1;
    let texts = page.split("```").enumerate();
    let texts = texts.filter(|(index, _)| !is_block(*index));
    let words = texts.flat_map(|(_, text)| text.split('`').skip(1).step_by(2));
    words.collect()
}

#[test]
fn files_that_the_pages_name_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut missing = Vec::new();
    for (name, page) in pages() {
        for word in quoted(&page) {
            let is_path = word.ends_with(".rs") || (word.ends_with('/') && word.len() > 1);
            if !is_path || word.contains(['<', '*', ' ', '…', '\\']) {
                continue;
            }
            let homes = [root.join(word), root.join("src").join(word)];
            // A file may be named without its folder.
            let is_named = |path: &std::path::PathBuf| path.ends_with(word);
            let is_there = homes.iter().any(|path| path.exists())
                || rust_files(root.join("src").as_path()).iter().any(is_named)
                || rust_files(root.join("tests").as_path())
                    .iter()
                    .any(is_named);
            if !is_there {
                missing.push(format!("{name}: {word}"));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn options_that_the_pages_name_are_options() {
    use clap::CommandFactory as _;
    let command = shapematch::cli::Cli::command();
    let mut known: Vec<String> = vec!["help".to_owned(), "version".to_owned()];
    let all = std::iter::once(&command).chain(command.get_subcommands());
    for option in all.flat_map(clap::Command::get_opts) {
        known.extend(option.get_long().map(str::to_owned));
    }
    // Of cargo and its benchmarks.
    known.extend(
        [
            "no-default-features",
            "features",
            "bench",
            "release",
            "quick",
            "test",
        ]
        .map(str::to_owned),
    );
    let mut unknown = Vec::new();
    for (name, page) in pages() {
        for rest in page.split("--").skip(1) {
            let is_option = |c: &char| c.is_ascii_lowercase() || *c == '-';
            let option: String = rest.chars().take_while(is_option).collect();
            let option = option.trim_end_matches('-');
            if !option.is_empty() && !known.iter().any(|one| one == option) {
                unknown.push(format!("{name}: --{option}"));
            }
        }
    }
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
}
