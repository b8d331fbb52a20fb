//! Copies a deck with other names in its include lines and everything else byte for byte.

use super::block::Blocks;
use super::include::{Include, layout_of_keyword, read_includes};
use super::source_file::SourceFile;
use crate::formats::model::IncludedAs;

/// Columns of a name on one line.
const MOST_COLUMNS: usize = 80;

/// The names in the `*INCLUDE` and `*INCLUDE_TRANSFORM` lines of a deck, each with the byte range that holds
/// it; `None` for one that runs over several lines.
fn names(deck: &SourceFile, included_as: &IncludedAs) -> Vec<(Include, Option<usize>)> {
    let bytes = deck.bytes();
    let mut found = Vec::new();
    let mut blocks = Blocks::new(deck, included_as.layout);
    while let Some(block) = blocks.next() {
        match block.name.as_str() {
            "END" => break,
            "KEYWORD" if !included_as.layout_is_fixed => {
                if let Some(layout) = layout_of_keyword(block.remark) {
                    blocks.set_layout(layout);
                }
            }
            "INCLUDE" | "INCLUDE_TRANSFORM" => {
                let mut includes = read_includes(&block);
                if block.name == "INCLUDE_TRANSFORM" {
                    // Further cards are numbers.
                    includes.truncate(1);
                }
                found.extend(includes.into_iter().map(|include| {
                    let line = &bytes[include.at..block.body.end];
                    let line = line.split(|&byte| b"\r\n".contains(&byte)).next();
                    let line = line.unwrap_or_default().trim_ascii_end();
                    let runs_over = line.ends_with(b" +");
                    let end = (!runs_over).then(|| include.at + line.len());
                    (include, end)
                }));
            }
            _ => {}
        }
    }
    found
}

/// The names of the files that a deck includes itself.
pub fn included_names(deck: &SourceFile, included_as: &IncludedAs) -> Vec<String> {
    let all = names(deck, included_as).into_iter();
    all.map(|(include, _)| include.name).collect()
}

/// The deck with those names changed for which there is another, and these names as they were. Names on
/// several lines stay, and so do those whose new name has no room on a line.
pub fn rename_includes(
    deck: &SourceFile,
    included_as: &IncludedAs,
    new_name: impl Fn(&str) -> Option<String>,
) -> (Vec<u8>, Vec<String>) {
    let bytes = deck.bytes();
    let (mut copy, mut done, mut renamed) = (Vec::with_capacity(bytes.len()), 0, Vec::new());
    for (include, end) in names(deck, included_as) {
        let (Some(end), Some(name)) = (end, new_name(&include.name)) else {
            continue;
        };
        if name.len() > MOST_COLUMNS {
            continue;
        }
        copy.extend_from_slice(&bytes[done..include.at]);
        copy.extend_from_slice(name.as_bytes());
        done = end;
        renamed.push(include.name);
    }
    copy.extend_from_slice(&bytes[done..]);
    (copy, renamed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_change_and_everything_else_stays() {
        let deck = "*KEYWORD\n*INCLUDE\n$ first\n  a.k \r\nsub/b.k\nlong/ +\nc.k\n*INCLUDE_TRANSFORM\nb.k\n\
                    $ offsets\n         1\n*NODE\na.k\n*END\n*INCLUDE\na.k\n";
        let file = SourceFile::new("deck.k", deck);
        let as_it_is = IncludedAs::default();
        let names = included_names(&file, &as_it_is);
        assert_eq!(names, ["a.k", "sub/b.k", "long/c.k", "b.k"]);
        let (bytes, renamed) = rename_includes(&file, &as_it_is, |name| {
            (name != "sub/b.k").then(|| format!("new_{name}"))
        });
        assert_eq!(renamed, ["a.k", "b.k"]);
        let expected = deck
            .replacen("  a.k \r", "new_a.k \r", 1)
            .replacen("\nb.k", "\nnew_b.k", 1);
        assert_eq!(String::from_utf8(bytes).unwrap(), expected);
        let (same, none) = rename_includes(&file, &as_it_is, |_| Some("x".repeat(81)));
        assert_eq!((same.as_slice(), none.len()), (deck.as_bytes(), 0));
    }
}
