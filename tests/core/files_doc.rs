//! `docs/files.md` says what the readers do: its tables are those of the code
//! (`UPDATE_EXPECT=1` rewrites them), and its keywords are read, skipped or named as it says.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use shapematch::formats::{DiagnosticKind, Foreign, Format};

use super::keyword::read_text;

fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/files.md")
}

fn formats_table() -> String {
    let mut table = "| format | usual file extensions |\n|---|---|\n".to_owned();
    for format in Format::ALL {
        let extensions: Vec<String> = format
            .extensions()
            .iter()
            .map(|e| format!("`.{e}`"))
            .collect();
        writeln!(table, "| {} | {} |", format.label(), extensions.join(", ")).unwrap();
    }
    table
}

fn foreign_table() -> String {
    let mut table = "| the file is … | what to do |\n|---|---|\n".to_owned();
    for kind in Foreign::ALL {
        writeln!(table, "| {} | {} |", kind.label(), kind.advice()).unwrap();
    }
    table
}

fn diagnostics_table() -> String {
    let mut table = "| diagnostic | severity |\n|---|---|\n".to_owned();
    for kind in DiagnosticKind::ALL {
        writeln!(table, "| {} | {} |", kind.label(), kind.severity().label()).unwrap();
    }
    table
}

/// The page with the text between two marks replaced.
fn with_table(page: &str, name: &str, table: &str) -> String {
    let (begin, end) = (
        format!("<!-- {name} -->\n"),
        format!("<!-- end of {name} -->"),
    );
    let (before, rest) = page.split_once(&begin).expect("the table has its mark");
    let (_, after) = rest.split_once(&end).expect("the table has its end");
    format!("{before}{begin}\n{table}\n{end}{after}")
}

#[test]
fn the_tables_are_those_of_the_code() {
    let written = std::fs::read_to_string(page())
        .unwrap()
        .replace("\r\n", "\n");
    let mut expected = with_table(&written, "formats", &formats_table());
    expected = with_table(&expected, "foreign files", &foreign_table());
    expected = with_table(&expected, "diagnostics", &diagnostics_table());
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(page(), &expected).unwrap();
    }
    assert!(
        written == expected,
        "run with UPDATE_EXPECT=1 and review docs/files.md"
    );
}

/// The keywords in code marks in the first column of a table below a heading.
fn keywords(page: &str, heading: &str) -> Vec<String> {
    let section = page
        .split("\n## ")
        .find(|section| section.starts_with(heading));
    let rows = section.expect("the page has the heading").lines();
    let cells = rows.filter_map(|row| row.strip_prefix("| `")?.split('|').next());
    cells
        .flat_map(|cell| cell.split('`').filter(|word| word.starts_with('*')))
        .map(str::to_owned)
        .collect()
}

#[test]
fn keywords_are_read_skipped_or_named_as_the_page_says() {
    let page = std::fs::read_to_string(page()).unwrap();
    let count = |keyword: &str, kind| {
        let model = read_text(format!("*KEYWORD\n{keyword}\n*END\n"));
        model.diagnostics.count(kind)
    };
    let (read, skipped) = (
        keywords(&page, "Keywords that are read"),
        keywords(&page, "Keywords that are passed over"),
    );
    assert!(read.len() > 20 && skipped.len() > 5, "{read:?} {skipped:?}");
    for keyword in read.iter().chain(&skipped) {
        assert_eq!(
            count(keyword, DiagnosticKind::UnknownKeyword),
            0,
            "{keyword}"
        );
        assert_eq!(count(keyword, DiagnosticKind::Unsupported), 0, "{keyword}");
    }
    let named = keywords(&page, "Keywords that are named");
    assert!(named.len() > 2, "{named:?}");
    for keyword in named {
        assert_eq!(count(&keyword, DiagnosticKind::Unsupported), 1, "{keyword}");
    }
}
