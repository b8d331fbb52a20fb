//! `*INCLUDE` and its relatives: file names, where they are looked for, offsets and units.

use std::path::{Path, PathBuf};

use super::super::diagnostic::Diagnostics;
use super::super::model::{IncludedAs, StampedInclude};
use super::super::source::{FileSource, tidy};
use super::block::{Block, Cards};
use super::card::{Card, EIGHT_BY_10, Layout};
use super::forming::ResultUnits;
use super::nodes::shifted;
use super::parts::PartOffsets;
use super::sets::SetOffsets;
use super::shells::ElementOffsets;
use crate::geometry::Matrix3;

/// What `*INCLUDE_TRANSFORM` adds to the ids of a file, summed over all files around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Offsets {
    pub node: i64,
    pub element: i64,
    pub part: i64,
    pub material: i64,
    pub set: i64,
    pub function: i64,
    pub define: i64,
    pub other: i64,
}

impl Offsets {
    /// The offsets of a file included by one that has offsets itself.
    #[must_use]
    fn plus(self, inner: Self) -> Self {
        Self {
            node: self.node.saturating_add(inner.node),
            element: self.element.saturating_add(inner.element),
            part: self.part.saturating_add(inner.part),
            material: self.material.saturating_add(inner.material),
            set: self.set.saturating_add(inner.set),
            function: self.function.saturating_add(inner.function),
            define: self.define.saturating_add(inner.define),
            other: self.other.saturating_add(inner.other),
        }
    }
}

/// The circumstances under which a file is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Context {
    /// Width of fields unless a keyword says otherwise.
    pub layout: Layout,
    /// True if the suffix of the include line demands the layout.
    pub layout_is_fixed: bool,
    pub offsets: Offsets,
    /// Factor on lengths that are not coordinates: thicknesses.
    pub length: f64,
    /// Factor on stresses.
    pub stress: f64,
    /// Factor on densities.
    pub density: f64,
}

impl Default for Context {
    fn default() -> Self {
        Self {
            layout: Layout::Standard,
            layout_is_fixed: false,
            offsets: Offsets::default(),
            length: 1.0,
            stress: 1.0,
            density: 1.0,
        }
    }
}

impl Context {
    /// True if nothing is converted, so that what the file says of its units is true of the whole deck.
    pub(crate) fn keeps_units(&self) -> bool {
        [self.length, self.stress, self.density] == [1.0; 3]
    }

    pub(crate) fn results(&self) -> ResultUnits {
        ResultUnits {
            element: self.offsets.element,
            set: self.offsets.set,
            stress: self.stress,
        }
    }

    pub(crate) fn elements(&self) -> ElementOffsets {
        ElementOffsets {
            element: self.offsets.element,
            part: self.offsets.part,
            node: self.offsets.node,
            length: self.length,
        }
    }

    pub(crate) fn parts(&self) -> PartOffsets {
        PartOffsets {
            part: self.offsets.part,
            section: self.offsets.other,
            material: self.offsets.material,
            length: self.length,
        }
    }

    pub(crate) fn sets(&self) -> SetOffsets {
        SetOffsets {
            set: self.offsets.set,
            part: self.offsets.part,
            element: self.offsets.element,
            node: self.offsets.node,
        }
    }

    /// What the model keeps of the circumstances.
    pub(crate) fn included_as(&self) -> IncludedAs {
        IncludedAs {
            layout: self.layout,
            layout_is_fixed: self.layout_is_fixed,
            element_offset: self.offsets.element,
            node_offset: self.offsets.node,
            part_offset: self.offsets.part,
            set_offset: self.offsets.set,
            system_offset: self.offsets.define,
            length_factor: self.length,
            stress_factor: self.stress,
            is_mirrored: false,
            rotation: Matrix3::identity(),
        }
    }

    /// The circumstances of a file that this one includes.
    pub(crate) fn inside(&self, include: &Include, suffix: Option<Layout>) -> Self {
        Self {
            layout: suffix.unwrap_or(self.layout),
            layout_is_fixed: suffix.is_some(),
            offsets: self.offsets.plus(include.offsets),
            length: self.length * include.length,
            stress: self.stress * include.stress,
            density: self.density * include.density,
        }
    }
}

/// One file to be included.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Include {
    pub name: String,
    /// Byte offset of the name in the including file.
    pub at: usize,
    /// What the including file's own offsets are not part of.
    pub offsets: Offsets,
    /// FCTLEN: factor on coordinates and thicknesses.
    pub length: f64,
    /// FCTMAS / (FCTLEN · FCTTIM²): factor on stresses.
    pub stress: f64,
    /// FCTMAS / FCTLEN³: factor on densities.
    pub density: f64,
    /// TRANID with the including file's offset, or 0.
    pub transformation: u64,
}

impl Include {
    fn plain(name: String, at: usize) -> Self {
        Self {
            name,
            at,
            offsets: Offsets::default(),
            length: 1.0,
            stress: 1.0,
            density: 1.0,
            transformation: 0,
        }
    }
}

/// The files of an `*INCLUDE` block: one or more names.
pub(crate) fn read_includes(block: &Block<'_>) -> Vec<Include> {
    let mut cards = block.cards();
    let mut includes = Vec::new();
    while let Some((name, at)) = file_name(&mut cards) {
        includes.push(Include::plain(name, at));
    }
    includes
}

/// The folders of an `*INCLUDE_PATH` block, with slashes between their pieces on every system.
pub(crate) fn read_paths(block: &Block<'_>) -> Vec<String> {
    let includes = read_includes(block).into_iter();
    includes
        .map(|include| include.name.replace('\\', "/"))
        .collect()
}

/// The file of an `*INCLUDE_STAMPED_…` block with the part or set of parts it is mapped onto; `None` for other
/// blocks.
pub(crate) fn read_stamped_include(block: &Block<'_>, offsets: &Offsets) -> Option<StampedInclude> {
    let options = block.name.strip_prefix("INCLUDE_STAMPED_")?;
    let is_set = options.split('_').any(|option| option == "SET");
    let mut cards = block.cards();
    let (file, _) = file_name(&mut cards)?;
    let id = cards.next()?.required_id(EIGHT_BY_10, 0).ok()?;
    let offset = if is_set { offsets.set } else { offsets.part };
    Some(StampedInclude {
        file,
        onto: shifted(id, offset),
        is_set,
        position: block.position(),
    })
}

/// The file of an `*INCLUDE_TRANSFORM` block. Cards at the end may be missing.
pub(crate) fn read_include_transform(
    block: &Block<'_>,
    define_offset: i64,
    found: &mut Diagnostics,
) -> Option<Include> {
    let mut cards = block.cards();
    let (name, at) = file_name(&mut cards)?;
    let mut include = Include::plain(name, at);
    let mut report = |card: &Card<'_>, error| {
        let what = "the transformed include";
        found.push(card.diagnose(&error, what));
    };
    if let Some(card) = cards.next() {
        let offsets = &mut include.offsets;
        let fields = [
            &mut offsets.node,
            &mut offsets.element,
            &mut offsets.part,
            &mut offsets.material,
            &mut offsets.set,
            &mut offsets.function,
            &mut offsets.define,
        ];
        for (index, field) in fields.into_iter().enumerate() {
            match card.int_or_zero(EIGHT_BY_10, index) {
                Ok(value) => *field = value,
                Err(error) => report(&card, error),
            }
        }
    }
    if let Some(card) = cards.next() {
        match card.int_or_zero(EIGHT_BY_10, 0) {
            Ok(value) => include.offsets.other = value,
            Err(error) => report(&card, error),
        }
    }
    if let Some(card) = cards.next() {
        let [mass, time, length] = [0, 1, 2].map(|index| {
            let factor = card.real_or_zero(EIGHT_BY_10, index);
            let factor = factor.unwrap_or_else(|error| {
                report(&card, error);
                1.0
            });
            if factor == 0.0 { 1.0 } else { factor }
        });
        include.length = length;
        include.stress = mass / (length * time * time);
        include.density = mass / length.powi(3);
    }
    if let Some(card) = cards.next() {
        match card.id(EIGHT_BY_10, 0) {
            Ok(id) => include.transformation = shifted(id, define_offset),
            Err(error) => report(&card, error),
        }
    }
    Some(include)
}

/// A file name, joined over lines that end in ` +`, and where it begins.
fn file_name(cards: &mut Cards<'_>) -> Option<(String, usize)> {
    let mut name = String::new();
    let mut at = None;
    for card in cards.by_ref() {
        if card.is_blank() && at.is_none() {
            continue;
        }
        at.get_or_insert(card.offset());
        let text = card.line_text();
        match text.strip_suffix(" +") {
            Some(piece) => name.push_str(if name.is_empty() {
                piece.trim_start()
            } else {
                piece
            }),
            None => {
                name.push_str(if name.is_empty() {
                    text.trim_start()
                } else {
                    &text
                });
                break;
            }
        }
    }
    let name = name.trim_end();
    let unquoted = name
        .strip_prefix('"')
        .and_then(|name| name.strip_suffix('"'));
    Some((unquoted.unwrap_or(name).to_owned(), at?))
}

/// A longer name, or one in more folders, is no file's.
const LONGEST_NAME: usize = 4096;
const MOST_FOLDERS: usize = 64;
/// After so many places without a file, further ones are looked for near the deck alone: a short deck may name
/// thousands of files and folders that are not there.
const MOST_TRIED: usize = 50_000;

/// Where included files are looked for.
#[derive(Debug, Clone, Default)]
pub(crate) struct SearchPath {
    /// The folder of the file that was asked for.
    pub master: PathBuf,
    /// `*INCLUDE_PATH` and `*INCLUDE_PATH_RELATIVE` in the order of the deck, then the options'.
    pub folders: Vec<PathBuf>,
    /// Places where files that are not there were looked for.
    pub n_tried: usize,
}

impl SearchPath {
    /// A folder of `*INCLUDE_PATH`, which the solver takes from where it runs. That is seldom where this program does,
    /// and mostly the folder of the deck.
    pub(crate) fn add_folder(&mut self, folder: &Path) {
        self.folders.push(folder.to_path_buf());
        if folder.is_relative() && !self.master.as_os_str().is_empty() {
            self.add_relative_folder(folder);
        }
    }

    /// A folder of `*INCLUDE_PATH_RELATIVE`.
    pub(crate) fn add_relative_folder(&mut self, folder: &Path) {
        self.folders.push(self.master.join(folder));
    }

    /// The number of places where a name is looked for.
    pub(crate) fn n_places(&self, name: &str) -> usize {
        self.names(name).len() * (2 + self.folders.len())
    }

    fn is_exhausted(&self) -> bool {
        self.n_tried >= MOST_TRIED
    }

    fn names(&self, name: &str) -> Vec<String> {
        let mut names = names_of(name);
        if self.is_exhausted() {
            names.truncate(2);
        }
        names
    }

    /// The file that `name` means in a file of `folder`: as given, beside the including file,
    /// beside the master, in the folders; then the same with Windows separators, and with ever
    /// fewer of its leading folders, because decks carry the paths of the machine they come from
    /// and whole trees are moved.
    pub(crate) fn find(
        &self,
        source: &dyn FileSource,
        folder: &Path,
        name: &str,
    ) -> Option<PathBuf> {
        self.names(name).into_iter().find_map(|name| {
            let name = Path::new(&name);
            if name.is_absolute() {
                return source.find(name);
            }
            let mut folders = self.folders(folder);
            folders.find_map(|folder| source.find(&tidy(&folder.join(name))))
        })
    }

    /// What stands where [`SearchPath::find`] looks for a file and is none, in words.
    pub(crate) fn other_than_file(
        &self,
        source: &dyn FileSource,
        folder: &Path,
        name: &str,
    ) -> Option<&'static str> {
        self.names(name).into_iter().find_map(|name| {
            let mut folders = self.folders(folder);
            folders.find_map(|folder| source.other_than_file(&tidy(&folder.join(&name))))
        })
    }

    /// What [`SearchPath::find`] tries, in words.
    pub(crate) fn tried(&self, folder: &Path, name: &str) -> String {
        const MAX_LISTED: usize = 4;
        if is_no_name(name) {
            return format!(
                "nothing, as the name has more than {LONGEST_NAME} characters or {MOST_FOLDERS} folders"
            );
        }
        let listed = |all: Vec<String>| {
            let n_more = all.len().saturating_sub(MAX_LISTED);
            let mut text = all[..all.len() - n_more].join(", ");
            if n_more > 0 {
                text += &format!(" and {n_more} more");
            }
            text
        };
        let names = self.names(name).into_iter().map(|name| format!("{name:?}"));
        let mut folders: Vec<String> = Vec::new();
        for folder in self.folders(folder) {
            let folder = match folder.display().to_string() {
                empty if empty.is_empty() => "the deck's folder".to_owned(),
                folder => folder,
            };
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        format!("{} in {}", listed(names.collect()), listed(folders))
    }

    fn folders<'a>(&'a self, folder: &'a Path) -> impl Iterator<Item = &'a Path> {
        let near = [folder, &self.master];
        let n = if self.is_exhausted() {
            0
        } else {
            self.folders.len()
        };
        near.into_iter()
            .chain(self.folders[..n].iter().map(PathBuf::as_path))
    }
}

fn is_no_name(name: &str) -> bool {
    let n_folders = name.matches(['/', '\\']).count();
    name.len() > LONGEST_NAME || n_folders > MOST_FOLDERS
}

/// A file name as given, with slashes, and with ever fewer leading folders; nothing of one that is too long.
fn names_of(name: &str) -> Vec<String> {
    if is_no_name(name) {
        return Vec::new();
    }
    let with_slashes = name.replace('\\', "/");
    let mut names = vec![name.to_owned()];
    let mut rest = with_slashes.as_str();
    loop {
        if !rest.is_empty() && !names.iter().any(|known| known == rest) {
            names.push(rest.to_owned());
        }
        match rest.split_once('/') {
            Some((_, after)) => rest = after,
            None => break,
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// What a `*KEYWORD` line, also one with an option (`_ID`), says about the width of fields: `LONG=Y`, `I10 = Y`.
/// `None` for other blocks.
pub(crate) fn layout_of_keyword(block: &Block<'_>) -> Option<Layout> {
    if block.name.split('_').next() != Some("KEYWORD") {
        return None;
    }
    let text = String::from_utf8_lossy(block.remark).to_ascii_uppercase();
    let value_of = |option: &str| {
        // Job names, too, may hold these letters.
        text.match_indices(option).find_map(|(at, _)| {
            let is_word =
                !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '=');
            let rest = text[at + option.len()..].trim_start().strip_prefix('=')?;
            rest.trim_start().chars().next().filter(|_| is_word)
        })
    };
    match (value_of("LONG"), value_of("I10")) {
        // `LONG=S` asks for standard input and a long structured file.
        (Some('Y' | 'K'), _) => Some(Layout::Long),
        (_, Some('Y')) => Some(Layout::I10),
        (Some(_), _) | (_, Some(_)) => Some(Layout::Standard),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::source::Memory;
    use super::super::block::Blocks;
    use super::super::source_file::SourceFile;
    use super::*;

    fn names(text: &str) -> Vec<String> {
        let file = SourceFile::new("t.k", text);
        let block = Blocks::new(&file, Layout::Standard).next().unwrap();
        read_includes(&block).into_iter().map(|i| i.name).collect()
    }

    #[test]
    fn names_may_be_several_or_run_over_lines() {
        assert_eq!(
            names("*INCLUDE\na b,c.k\n$ comment\nd.k\n"),
            ["a b,c.k", "d.k"]
        );
        assert_eq!(
            names("*INCLUDE\nlong/ +\n$ c\n path +\n/x.k\ny.k"),
            ["long/ path/x.k", "y.k"]
        );
        assert_eq!(names("*INCLUDE\n\"q.k\"\n\n"), ["q.k"]);
        assert!(names("*INCLUDE\n").is_empty());
    }

    #[test]
    fn the_keyword_line_tells_the_width_of_fields() {
        let cases: &[(&str, Option<Layout>)] = &[
            ("LONG=Y", Some(Layout::Long)),
            ("long = k", Some(Layout::Long)),
            ("LONG=S", Some(Layout::Standard)),
            ("I10=Y", Some(Layout::I10)),
            ("MEMORY=5000 I10= y NCPU=4", Some(Layout::I10)),
            ("MEMORY=500000000 NCPU=16", None),
            ("", None),
        ];
        let asked = |line: String| {
            let file = SourceFile::new("t.k", line);
            layout_of_keyword(&Blocks::new(&file, Layout::Standard).next().unwrap())
        };
        for (remark, layout) in cases {
            assert_eq!(asked(format!("*KEYWORD {remark}\n")), *layout, "{remark}");
            assert_eq!(asked(format!("*KEYWORD_ID {remark}\nrun")), *layout);
            assert_eq!(asked(format!("*KEYWORDS {remark}\n")), None);
        }
    }

    #[test]
    fn files_are_looked_for_near_and_far() {
        let source = Memory::new()
            .with("m/sub/near.k", "")
            .with("m/master.k", "")
            .with("lib/far.k", "")
            .with("m/Mesh.K", "");
        let search = SearchPath {
            master: "m".into(),
            folders: vec!["lib".into()],
            n_tried: 0,
        };
        let find = |name| search.find(&source, Path::new("m/sub"), name);
        assert_eq!(find("near.k"), Some("m/sub/near.k".into()));
        assert_eq!(find("../master.k"), Some("m/master.k".into()));
        assert_eq!(find("master.k"), Some("m/master.k".into()));
        assert_eq!(find("far.k"), Some("lib/far.k".into()));
        assert_eq!(find("D:\\work\\mesh.k"), Some("m/Mesh.K".into()));
        let moved = "Z:\\project\\m\\sub\\near.k";
        let from_elsewhere = search.find(&source, Path::new(""), moved);
        assert_eq!(from_elsewhere, Some("m/sub/near.k".into()));
        assert_eq!(
            search.tried(Path::new("m"), "Z:\\a\\x.k"),
            r#""Z:\\a\\x.k", "Z:/a/x.k", "a/x.k", "x.k" in m, lib"#
        );
        assert_eq!(find("nowhere.k"), None);
    }

    #[test]
    fn a_relative_folder_is_that_of_the_program_or_of_the_deck() {
        let source = Memory::new()
            .with("m/lib/near.k", "")
            .with("far/lib/far.k", "")
            .with("lib/far.k", "");
        let mut search = SearchPath {
            master: "m".into(),
            ..SearchPath::default()
        };
        search.add_folder(Path::new("lib"));
        let find = |name| search.find(&source, Path::new("m"), name);
        assert_eq!(find("far.k"), Some("lib/far.k".into()));
        assert_eq!(find("near.k"), Some("m/lib/near.k".into()));
        search.add_folder(Path::new("/far/lib"));
        assert_eq!(search.folders.len(), 3);
    }

    #[test]
    fn the_search_for_what_is_not_there_is_bounded() {
        assert!(names_of(&"a/".repeat(MOST_FOLDERS + 1)).is_empty());
        assert_eq!(names_of(&"a/".repeat(MOST_FOLDERS)).len(), MOST_FOLDERS);
        let source = Memory::new().with("m/near.k", "").with("lib/far.k", "");
        let mut search = SearchPath {
            master: "m".into(),
            folders: vec!["lib".into()],
            n_tried: 0,
        };
        let find = |search: &SearchPath, name| search.find(&source, Path::new("m"), name);
        assert!(find(&search, "far.k").is_some());
        assert_eq!(search.n_places("a/b/far.k"), 9);
        search.n_tried = MOST_TRIED;
        assert_eq!(find(&search, "far.k"), None);
        assert_eq!(find(&search, "near.k"), Some("m/near.k".into()));
    }
}
