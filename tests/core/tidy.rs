//! Habits that no compiler checks: file sizes, stray marks, printing below the door.

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
