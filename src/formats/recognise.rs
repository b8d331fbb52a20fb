//! What a file is, by its content. The name only decides where the content says nothing.

use std::path::Path;

use memchr::memmem;

use super::foreign::Foreign;
use super::keyword::names::{is_known, keyword_name};
use super::{Format, stl};

/// Bytes that are looked at to tell a text's format.
const HEAD: usize = 1 << 16;
/// Bytes that are looked at to tell text from binary.
const SAMPLE: usize = 4096;

/// First bytes of files that are not read.
const MAGIC: &[(&[u8], Foreign)] = &[
    (b"PK\x03\x04", Foreign::Zip),
    (b"PK\x05\x06", Foreign::Zip),
    (b"\xfd7zXZ\0", Foreign::Packed),
    (b"\x28\xb5\x2f\xfd", Foreign::Packed),
    (b"BZh", Foreign::Packed),
    // Within gzip data.
    (b"\x1f\x8b", Foreign::Packed),
    (b"7z\xbc\xaf\x27\x1c", Foreign::Packed),
    (b"\x1f\x9d", Foreign::Packed),
    (b"\x89HDF\r\n\x1a\n", Foreign::OtherMesh),
    (b"glTF", Foreign::OtherMesh),
    (b"Kaydara FBX", Foreign::OtherMesh),
    (b"version https://git-lfs", Foreign::GitLfs),
    (b"ISO-10303-21", Foreign::Step),
    (b"# vtk DataFile", Foreign::OtherMesh),
    (b"$MeshFormat", Foreign::OtherMesh),
    (b"OFF\n", Foreign::OtherMesh),
    (b"OFF\r", Foreign::OtherMesh),
    (b"#RADIOSS", Foreign::Radioss),
];

/// The format of a file whose text is normalised (see [`super::text::normalised`]), or what else
/// it is. Looks at the head of the file; of a text that shows nothing there, at all of it.
pub(super) fn recognise(path: &Path, bytes: &[u8]) -> Result<Format, Foreign> {
    let head = &bytes[..bytes.len().min(HEAD)];
    if bytes.len() <= HEAD && head.trim_ascii().is_empty() {
        return Err(Foreign::Empty);
    }
    if let Some(&(_, foreign)) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(foreign);
    }
    if is_ply(head) {
        return Ok(Format::Ply);
    }
    if is_lsda(head) {
        return Err(Foreign::Lsda);
    }
    if head.get(257..262) == Some(b"ustar") {
        return Err(Foreign::Packed);
    }
    let by_name = Format::of_name(path);
    if stl::has_binary_length(bytes) {
        return Ok(Format::Stl);
    }
    if !is_text(head) {
        return if is_d3plot(head) {
            Err(Foreign::D3plot)
        } else if by_name == Some(Format::Stl) && bytes.len() >= stl::HEADER {
            Ok(Format::Stl)
        } else if by_name == Some(Format::Keyword) && has_keyword(bytes) {
            // A deck with some stray bytes at its head.
            Ok(Format::Keyword)
        } else {
            Err(Foreign::Binary)
        };
    }
    text_format(head, by_name).or_else(|unclear| match unclear {
        Some(foreign) => Err(foreign),
        None if has_keyword(bytes) => Ok(Format::Keyword),
        None => match by_name {
            Some(format) if format != Format::Keyword => Ok(format),
            _ if memmem::find(bytes, b"\n*").is_some() || bytes.starts_with(b"*") => {
                Err(Foreign::NoKeyword)
            }
            _ => Err(Foreign::Text),
        },
    })
}

fn is_ply(head: &[u8]) -> bool {
    // A deck may begin with a line such as "ply of carbon".
    let mut lines = head.split(|&b| b == b'\n' || b == b'\r');
    let first = lines.next().unwrap_or_default();
    first.trim_ascii_end().eq_ignore_ascii_case(b"ply") && lines.next().is_some()
}

/// An LSDA file begins with the sizes of its own integers: header length 8, lengths, offsets.
fn is_lsda(head: &[u8]) -> bool {
    matches!(head, [8, 8, 8, 1, 1, ..] | [7 | 8, 4 | 8, 4 | 8, 1, ..])
}

/// No zero byte, and hardly a control character that text does not have.
fn is_text(head: &[u8]) -> bool {
    let sample = &head[..head.len().min(SAMPLE)];
    let is_control = |b: &&u8| **b < 9 || (14..27).contains(*b);
    !sample.contains(&0) && sample.iter().filter(is_control).count() * 20 <= sample.len()
}

/// The control words of a d3plot: ten words of title, then among others the kind of file in word
/// 11 and the number of dimensions in word 15, as integers of four or eight bytes.
fn is_d3plot(head: &[u8]) -> bool {
    let word = |index: usize, size: usize, is_big: bool| -> Option<u64> {
        let bytes = head.get(index * size..(index + 1) * size)?;
        let fold = |sum: u64, &byte: &u8| sum << 8 | u64::from(byte);
        Some(if is_big {
            bytes.iter().fold(0, fold)
        } else {
            bytes.iter().rev().fold(0, fold)
        })
    };
    let fits = |size: usize, is_big: bool| {
        let title = head.get(..10 * size).unwrap_or_default();
        let has_title = !title.is_empty() && title.iter().all(|b| (32..127).contains(b) || *b == 0);
        has_title
            && matches!(word(11, size, is_big), Some(1..=11))
            && matches!(word(15, size, is_big), Some(2..=7))
    };
    [(4, false), (4, true), (8, false), (8, true)]
        .iter()
        .any(|&(size, is_big)| fits(size, is_big))
}

/// A known keyword at the beginning of a line anywhere.
fn has_keyword(bytes: &[u8]) -> bool {
    let at_start = bytes.starts_with(b"*").then_some(0);
    let later = memmem::find_iter(bytes, b"\n*").map(|at| at + 1);
    at_start
        .into_iter()
        .chain(later)
        .take(10_000)
        .any(|at| keyword_name(&bytes[at + 1..]).is_some_and(|name| is_known(&name)))
}

/// A line that begins with `*KEYWORD`.
fn has_head(head: &[u8]) -> bool {
    let mut lines = head.split(|&b| b == b'\n');
    lines.any(|line| {
        line.get(..8)
            .is_some_and(|start| start.eq_ignore_ascii_case(b"*KEYWORD"))
    })
}

/// What the lines of a head speak for. `Err(None)`: nothing.
fn text_format(head: &[u8], by_name: Option<Format>) -> Result<Format, Option<Foreign>> {
    if let Some(foreign) = foreign_text(head) {
        return Err(Some(foreign));
    }
    // Of these even a first line as other formats have it is a remark.
    let is_named = by_name == Some(Format::Keyword) && has_keyword(head);
    let is_sure_deck = is_named || has_head(head);
    let (mut first, mut is_deck) = (None, false);
    for line in head.split(|&b| b == b'\n') {
        let line = line.trim_ascii_end();
        if let Some(name) = line.strip_prefix(b"*").and_then(keyword_name) {
            if is_abaqus(line) {
                return Err(Some(Foreign::Abaqus));
            }
            is_deck |= is_known(&name);
            // Some names are Abaqus's too, such as NODE and PART.
            if is_deck && (name == "KEYWORD" || name.contains('_')) {
                return Ok(Format::Keyword);
            }
            continue;
        }
        let trimmed = line.trim_ascii_start();
        if is_deck || trimmed.is_empty() || trimmed.starts_with(b"$") || trimmed.starts_with(b"**")
        {
            continue;
        }
        if let Some(foreign) = foreign_line(line) {
            return Err(Some(foreign));
        }
        if is_sure_deck {
            continue;
        }
        let is_first = first.is_none();
        first.get_or_insert(trimmed);
        if is_first && is_solid(trimmed, head) {
            return Ok(Format::Stl);
        }
        if is_obj_line(trimmed, by_name == Some(Format::Obj)) {
            return Ok(Format::Obj);
        }
    }
    if is_deck {
        Ok(Format::Keyword)
    } else {
        Err(None)
    }
}

/// Text that its first words tell.
fn foreign_text(head: &[u8]) -> Option<Foreign> {
    let text = head.trim_ascii_start();
    let start = text[..text.len().min(512)].to_ascii_lowercase();
    let begins = |word: &str| start.starts_with(word.as_bytes());
    if begins("<!doctype html") || begins("<html") || begins("<head") {
        return Some(Foreign::Html);
    }
    let holds = |word: &[u8]| begins("{") && memmem::find(&start, word).is_some();
    if holds(b"\"shapematch.project/") {
        return Some(Foreign::Project);
    }
    if holds(b"\"shapematch.") {
        return Some(Foreign::Record);
    }
    // Columns 73 to 80 of an IGES file: section letter and number.
    let line = head.split(|&b| b == b'\n').next()?.trim_ascii_end();
    let is_iges = line.len() == 80
        && line[72] == b'S'
        && line[73..].trim_ascii().iter().all(u8::is_ascii_digit);
    is_iges.then_some(Foreign::Iges)
}

/// Lines that only one other program writes.
fn foreign_line(line: &[u8]) -> Option<Foreign> {
    let upper: Vec<u8> = line.iter().take(40).map(u8::to_ascii_uppercase).collect();
    let begins = |words: &[&str]| words.iter().any(|word| upper.starts_with(word.as_bytes()));
    let has_number = upper.iter().any(u8::is_ascii_digit);
    if begins(&["BEGIN BULK", "CEND"])
        || has_number && begins(&["GRID ", "GRID*", "GRID,", "CQUAD4", "CTRIA3", "SOL "])
    {
        return Some(Foreign::Nastran);
    }
    if begins(&["/COM,", "/PREP7", "/NOPR", "NBLOCK,", "EBLOCK,", "ET,"]) {
        return Some(Foreign::Ansys);
    }
    if begins(&["/BEGIN", "/NODE", "/SHELL/", "/SH3N/", "/PART/", "#RADIOSS"]) {
        return Some(Foreign::Radioss);
    }
    if begins(&["INPUTVERSION", "NODE  /", "SHELL /"]) {
        return Some(Foreign::PamCrash);
    }
    None
}

/// Abaqus keywords have parameters after a comma, or names that LS-DYNA does not have.
fn is_abaqus(line: &[u8]) -> bool {
    const ONLY_THERE: &[&str] = &[
        "HEADING",
        "PREPRINT",
        "NSET",
        "ELSET",
        "STEP",
        "SHELL SECTION",
        "SOLID SECTION",
        "ASSEMBLY",
        "INSTANCE",
        "SURFACE",
    ];
    let text: Vec<u8> = line[1..].trim_ascii_start().to_ascii_uppercase();
    let (name, rest) = match memchr::memchr(b',', &text) {
        Some(at) => (&text[..at], &text[at + 1..]),
        None => (&text[..], &b""[..]),
    };
    let name = String::from_utf8_lossy(name.trim_ascii()).into_owned();
    let has = |word: &str| memmem::find(rest, word.as_bytes()).is_some();
    ONLY_THERE.contains(&name.as_str())
        || name == "ELEMENT" && has("TYPE")
        || name == "NODE" && (has("NSET") || has("SYSTEM"))
        || name == "PART" && has("NAME")
        || name == "MATERIAL" && has("NAME")
}

/// `solid` and a facet, or the end of an empty solid, not far below.
fn is_solid(first: &[u8], head: &[u8]) -> bool {
    let begins = first
        .get(..5)
        .is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let sample = head[..head.len().min(SAMPLE)].to_ascii_lowercase();
    let has = |word: &[u8]| memmem::find(&sample, word).is_some();
    begins && (has(b"facet") || has(b"endsolid") || has(b"vertex"))
}

/// A line that only an OBJ has. The name lets single letters count that other texts have too.
fn is_obj_line(line: &[u8], is_named: bool) -> bool {
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let first = words.next().unwrap_or_default().to_ascii_lowercase();
    let is_number = |word: &[u8]| word.iter().any(u8::is_ascii_digit);
    let n_numbers = words.clone().take_while(|word| is_number(word)).count();
    match first.as_slice() {
        b"v" | b"vn" | b"f" => n_numbers >= 3,
        b"vt" => n_numbers >= 1,
        b"mtllib" | b"usemtl" => true,
        b"o" | b"g" | b"s" => is_named,
        _ => false,
    }
}
