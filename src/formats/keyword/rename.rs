//! Which files a deck includes, and copies of it with other names in its include lines and everything else byte for
//! byte.

use std::ops::Range;

use super::block::{Block, Blocks};
use super::exchange::line_end_of;
use super::include::{layout_of_keyword, read_includes, read_paths};
use super::source_file::SourceFile;
use crate::formats::model::IncludedAs;

/// Columns of a name on its last or only line.
const COLUMNS: usize = 80;
/// Columns of a piece of a name that goes on, without ` +`.
const COLUMNS_OF_PIECE: usize = 78;
/// Lines of a name.
const MOST_LINES: usize = 3;

/// What a deck includes itself, and the folders that it adds to those where included files are looked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DeckIncludes {
    /// Names of included files.
    pub names: Vec<String>,
    /// Folders of `*INCLUDE_PATH`.
    pub folders: Vec<String>,
    /// Folders of `*INCLUDE_PATH_RELATIVE`, relative to that of the master file.
    pub relative_folders: Vec<String>,
}

/// Hands over every block of a deck.
fn for_blocks(deck: &SourceFile, included_as: &IncludedAs, mut take: impl FnMut(&Block<'_>)) {
    let mut blocks = Blocks::new(deck, included_as.layout);
    while let Some(block) = blocks.next() {
        if block.name == "END" {
            break;
        }
        match layout_of_keyword(&block) {
            Some(layout) if !included_as.layout_is_fixed => blocks.set_layout(layout),
            _ => take(&block),
        }
    }
}

/// The names in an `*INCLUDE` or `*INCLUDE_TRANSFORM` block, each with the bytes that hold it.
fn names(block: &Block<'_>, bytes: &[u8]) -> Vec<(String, Range<usize>)> {
    if !["INCLUDE", "INCLUDE_TRANSFORM"].contains(&block.name.as_str()) {
        return Vec::new();
    }
    let mut includes = read_includes(block);
    if block.name == "INCLUDE_TRANSFORM" {
        // Further cards are numbers.
        includes.truncate(1);
    }
    let with_place = includes.into_iter().map(|include| {
        let end = end_of_name(bytes, include.at..block.body.end);
        (include.name, include.at..end)
    });
    with_place.collect()
}

/// Where the name that begins a range of bytes ends: lines that end in ` +` go on, with comments between them.
fn end_of_name(bytes: &[u8], range: Range<usize>) -> usize {
    let (mut from, mut end) = (range.start, range.start);
    for line in bytes[range].split_inclusive(|&byte| byte == b'\n') {
        let text = line.trim_ascii_end();
        if !text.starts_with(b"$") {
            end = from + text.len();
            if !text.ends_with(b" +") {
                break;
            }
        }
        from += line.len();
    }
    end
}

/// What a deck includes.
pub fn includes_of(deck: &SourceFile, included_as: &IncludedAs) -> DeckIncludes {
    let mut found = DeckIncludes::default();
    for_blocks(deck, included_as, |block| match block.name.as_str() {
        "INCLUDE_PATH" => found.folders.extend(read_paths(block)),
        "INCLUDE_PATH_RELATIVE" => found.relative_folders.extend(read_paths(block)),
        _ => {
            let all = names(block, deck.bytes()).into_iter();
            found.names.extend(all.map(|(name, _)| name));
        }
    });
    found
}

/// The deck with those names changed for which there is another (`None` if there are none), and these names as they
/// were. Comments within a name on several lines go with it; names whose new one is too long for any include line
/// stay.
pub fn rename_includes(
    deck: &SourceFile,
    included_as: &IncludedAs,
    new_name: impl Fn(&str) -> Option<String>,
) -> (Option<Vec<u8>>, Vec<String>) {
    let bytes = deck.bytes();
    let line_end = line_end_of(bytes);
    let (mut copy, mut done, mut renamed) = (Vec::new(), 0, Vec::new());
    for_blocks(deck, included_as, |block| {
        for (name, place) in names(block, bytes) {
            let Some(lines) = new_name(&name).and_then(|new| name_lines(&new)) else {
                continue;
            };
            copy.reserve(bytes.len() - done);
            copy.extend_from_slice(&bytes[done..place.start]);
            let lines: Vec<&[u8]> = lines.iter().map(|line| line.as_bytes()).collect();
            copy.extend(lines.join(line_end));
            done = place.end;
            renamed.push(name);
        }
    });
    let copy = (!renamed.is_empty()).then(|| {
        copy.extend_from_slice(&bytes[done..]);
        copy
    });
    (copy, renamed)
}

/// The lines of a deck that a file name takes, each without its end; `None` where three have no room for it.
pub fn name_lines(name: &str) -> Option<Vec<String>> {
    let (mut lines, mut rest) = (Vec::new(), name);
    while rest.len() > COLUMNS {
        let mut places = (1..=COLUMNS_OF_PIECE).rev();
        let (piece, after) = places.find_map(|at| {
            let (piece, after) = rest.split_at_checked(at)?;
            // A line that begins so is a comment, a keyword or a parameter, and blanks at its ends are lost.
            let is_name = !after.starts_with(['$', '*', '&', ' ']) && !piece.ends_with(' ');
            is_name.then_some((piece, after))
        })?;
        lines.push(format!("{piece} +"));
        rest = after;
    }
    lines.push(rest.to_owned());
    (lines.len() <= MOST_LINES).then_some(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_change_and_everything_else_stays() {
        let deck = "*KEYWORD\n*INCLUDE\n$ first\n  a.k \r\nsub/b.k\nlong/ +\n$ more\n and +\nc.k\n*INCLUDE_TRANSFORM\n\
                    b.k\n$ offsets\n         1\n*NODE\na.k\n*INCLUDE_PATH\n/lib\n*INCLUDE_PATH_RELATIVE\n../far +\n\
                    /away\n*END\n*INCLUDE\na.k\n";
        let file = SourceFile::new("deck.k", deck);
        let as_it_is = IncludedAs::default();
        let found = includes_of(&file, &as_it_is);
        assert_eq!(found.names, ["a.k", "sub/b.k", "long/ andc.k", "b.k"]);
        assert_eq!(found.folders, ["/lib"]);
        assert_eq!(found.relative_folders, ["../far/away"]);
        let (bytes, renamed) = rename_includes(&file, &as_it_is, |name| {
            let last = name.rsplit('/').next().unwrap();
            (name != "sub/b.k").then(|| format!("new_{last}"))
        });
        assert_eq!(renamed, ["a.k", "long/ andc.k", "b.k"]);
        let expected = deck
            .replacen("  a.k \r", "new_a.k \r", 1)
            .replacen("long/ +\n$ more\n and +\nc.k", "new_ andc.k", 1)
            .replacen("\nb.k", "\nnew_b.k", 1);
        assert_eq!(String::from_utf8(bytes.unwrap()).unwrap(), expected);
    }

    #[test]
    fn no_line_of_a_name_is_a_comment_or_a_keyword() {
        for sign in ['$', '*', '&', ' '] {
            let name = format!("{}{sign}{}", "a".repeat(78), "b".repeat(20));
            let lines = name_lines(&name).unwrap();
            assert!(!lines[1].starts_with(sign), "{lines:?}");
            let deck = SourceFile::new("deck.k", format!("*INCLUDE\n{}\n", lines.join("\n")));
            assert_eq!(includes_of(&deck, &IncludedAs::default()).names, [name]);
        }
        assert_eq!(name_lines(&"$".repeat(100)), None);
    }

    #[test]
    fn long_names_run_over_lines_and_longer_ones_stay() {
        let as_it_is = IncludedAs::default();
        for end in ["\n", "\r\n"] {
            let deck = format!("*INCLUDE{end}a.k{end}b.k{end}");
            let file = SourceFile::new("deck.k", deck);
            for n in [80, 81, 158, 236, 237, 300] {
                let name = "ü".repeat(n / 2) + &"x".repeat(n % 2);
                let new = |old: &str| (old == "a.k").then(|| name.clone());
                let (bytes, renamed) = rename_includes(&file, &as_it_is, new);
                if n > 236 {
                    assert_eq!((bytes, renamed.len()), (None, 0));
                    continue;
                }
                let bytes = bytes.unwrap();
                let lines = bytes.split(|&byte| byte == b'\n');
                assert!(lines.map(<[u8]>::len).max().unwrap() <= 81);
                let copy = SourceFile::new("copy.k", bytes);
                let names = includes_of(&copy, &as_it_is).names;
                assert_eq!(names, [name.as_str(), "b.k"]);
            }
        }
    }
}
