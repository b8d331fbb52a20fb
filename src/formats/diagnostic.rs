//! What a reader could not understand, where it stood, and what was expected there.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// A place in a text file. Line and column count from 1; 0 where they are not known.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// The file, as it was opened.
    pub file: Arc<Path>,
    /// Line, from 1.
    pub line: u64,
    /// Column in bytes, from 1.
    pub column: u32,
}

impl Position {
    /// The file as a whole.
    pub fn file(file: &Arc<Path>) -> Self {
        Self {
            file: file.clone(),
            line: 0,
            column: 0,
        }
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
            if self.column > 0 {
                write!(f, ":{}", self.column)?;
            }
        }
        Ok(())
    }
}

/// How much a diagnostic matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; nothing is missing from what was read.
    Note,
    /// Read, but perhaps not as meant.
    Warning,
    /// Something the file asks for is missing from what was read.
    Error,
}

impl Severity {
    /// The word shown before the message.
    pub fn label(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident, $severity:ident, $label:literal $(, $n_kept:literal)?;)*) => {
        /// What went wrong. Diagnostics are counted per kind, and each kind has one severity.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum DiagnosticKind { $($(#[$doc])* $kind,)* }

        impl DiagnosticKind {
            /// Every kind, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$kind,)*];

            /// A short name, for example `"missing node"`.
            pub fn label(self) -> &'static str {
                match self { $(Self::$kind => $label,)* }
            }

            /// How much diagnostics of this kind matter.
            pub fn severity(self) -> Severity {
                match self { $(Self::$kind => Severity::$severity,)* }
            }

            /// How many of this kind are kept with their text.
            fn n_kept(self) -> u64 {
                match self { $(Self::$kind => [$($n_kept,)? Diagnostics::KEPT_PER_KIND][0],)* }
            }
        }
    };
}

kinds! {
    /// A field holds something that is not what it should be.
    BadField, Error, "unreadable field";
    /// A card that must be there is not.
    MissingCard, Error, "missing card";
    /// Cards that would be right with fields of another width; told once.
    ShiftedColumns, Error, "columns look shifted", 1;
    /// A keyword that does not begin in the first column and is therefore data.
    MisplacedKeyword, Error, "keyword not in the first column";
    /// A number is NaN or infinite.
    NotFinite, Error, "number not finite";
    /// A length beyond any unit.
    NumberTooLarge, Error, "number too large";
    /// A limit on what is read was reached; the rest was left out.
    LimitReached, Error, "limit reached";
    /// `&name` with no such parameter.
    UnresolvedParameter, Error, "unresolved parameter";
    /// A parameter whose definition cannot be used.
    BadParameter, Error, "unusable parameter";
    /// An element names a node that no file defines.
    MissingNode, Error, "missing node";
    /// A node that lies absurdly far from all others.
    StrayNode, Error, "node far from all others";
    /// A parameter is defined twice.
    DuplicateParameter, Warning, "duplicate parameter";
    /// A node id is defined twice at different places.
    DuplicateNode, Warning, "duplicate node id";
    /// A node id is defined twice at the same place.
    RepeatedNode, Note, "node repeated at the same place";
    /// An element id is defined twice.
    DuplicateElement, Warning, "duplicate element id";
    /// An element is defined twice with the same part and nodes.
    RepeatedElement, Warning, "element repeated at the same nodes";
    /// A part id is defined twice.
    DuplicatePart, Warning, "duplicate part id";
    /// A section id is defined twice with different cards.
    DuplicateSection, Warning, "duplicate section id";
    /// A set id is defined twice with different members.
    DuplicateSet, Warning, "duplicate set id";
    /// An element without area.
    ZeroArea, Warning, "element without area";
    /// A quad whose edges cross: two of its nodes are exchanged.
    CrossedEdges, Warning, "crossed edges";
    /// A shell with fewer than three different nodes.
    DegenerateElement, Warning, "degenerate element";
    /// Shells whose nodes do not lie in their mid-surface, for which they are taken all the same.
    OffMidSurface, Warning, "nodes off the mid-surface";
    /// Parts that lie on each other, as a sheet and its tools do, and are taken as one.
    StackedParts, Warning, "parts that lie on each other";
    /// An element names a part that no file defines.
    UndefinedPart, Note, "undefined part";
    /// An included file cannot be found or read.
    MissingInclude, Error, "missing include";
    /// A file includes itself, directly or through others.
    IncludeCycle, Error, "include cycle";
    /// The file's own `*KEYWORD` asks for another number format than the include line.
    FormatMismatch, Warning, "number format mismatch";
    /// A transformation that is undefined or cannot be carried out.
    BadTransformation, Error, "unusable transformation";
    /// Forming results that contradict themselves.
    BadForming, Error, "unusable forming result";
    /// Forming results that are taken, though perhaps not as they were meant.
    DoubtfulForming, Warning, "doubtful forming result";
    /// Strains that are left out because they are in the axes of their element.
    LocalStrains, Warning, "strains in element axes";
    /// A set that is undefined or refers to itself.
    BadSet, Warning, "unusable set";
    /// A keyword that matters to the mesh but is not carried out.
    Unsupported, Warning, "keyword not carried out";
    /// Encrypted text was skipped.
    Encrypted, Note, "encrypted block skipped";
    /// Encrypted text whose last line is missing, which takes the rest of the file with it.
    EncryptedNoEnd, Error, "encrypted block without an end";
    /// Tabs were expanded to columns of eight.
    Tabs, Note, "tabs expanded";
    /// A mesh file's own oddities (STL, OBJ, PLY).
    Mesh, Warning, "mesh file";
    /// The file's name speaks for another format than its content.
    MisleadingName, Warning, "name of another format";
    /// Other bytes follow the gzip data of the file.
    AfterGzip, Warning, "bytes behind gzip data";
    /// A word after `*` that LS-DYNA does not know.
    UnknownKeyword, Warning, "unknown keyword";
    /// Units in a comment that are not those of the materials.
    OtherUnits, Warning, "contradicting units";
    /// A deck without shells and solids.
    NoElements, Warning, "no elements";
    /// A deck that begins with `*KEYWORD` ends among nodes, elements or results, without `*END`.
    NoEnd, Warning, "deck without an end";
    /// Keywords follow `*END`.
    BehindEnd, Warning, "keywords behind the end";
}

impl DiagnosticKind {
    /// Whether such an error may concern the geometry.
    fn is_of_geometry(self) -> bool {
        self.severity() == Severity::Error && self != Self::BadForming
    }
}

/// One diagnostic: where, what was found, what was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What went wrong.
    pub kind: DiagnosticKind,
    /// Where, as far as it is known.
    pub position: Option<Position>,
    /// What went wrong, in one sentence.
    pub message: String,
    /// The text that stood there.
    pub found: Option<String>,
    /// What should have stood there.
    pub expected: Option<String>,
}

impl Diagnostic {
    /// A diagnostic with a message only.
    pub fn new(kind: DiagnosticKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            position: None,
            message: message.into(),
            found: None,
            expected: None,
        }
    }

    /// Adds the position in the file.
    #[must_use]
    pub fn at(mut self, position: Position) -> Self {
        self.position = Some(position);
        self
    }

    /// Says what stood there.
    #[must_use]
    pub fn found(mut self, found: impl Into<String>) -> Self {
        self.found = Some(found.into());
        self
    }

    /// Says what should have stood there.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// How much it matters.
    pub fn severity(&self) -> Severity {
        self.kind.severity()
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(position) = &self.position {
            write!(f, "{position}: ")?;
        }
        write!(f, "{}: {}", self.severity().label(), self.message)?;
        if let Some(found) = &self.found {
            write!(f, ", found {found:?}")?;
        }
        if let Some(expected) = &self.expected {
            write!(f, ", expected {expected}")?;
        }
        Ok(())
    }
}

/// Diagnostics in the order they were made. Of each kind the first [`Diagnostics::KEPT_PER_KIND`]
/// are kept (of some only one) and all are counted, so a deck with a million broken lines costs no
/// memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostics {
    kept: Vec<Diagnostic>,
    counts: Vec<u64>,
    /// Errors that concern no geometry although others of their kind do.
    n_aside: u64,
}

impl Default for Diagnostics {
    fn default() -> Self {
        Self {
            kept: Vec::new(),
            counts: vec![0; DiagnosticKind::ALL.len()],
            n_aside: 0,
        }
    }
}

impl Diagnostics {
    /// How many diagnostics of one kind are kept with their text.
    pub const KEPT_PER_KIND: u64 = 20;

    /// Adds a diagnostic.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.push_with(diagnostic.kind, || diagnostic);
    }

    /// Counts a diagnostic; `describe` is called only if it will be kept.
    pub fn push_with(&mut self, kind: DiagnosticKind, describe: impl FnOnce() -> Diagnostic) {
        self.counts[kind as usize] += 1;
        if self.counts[kind as usize] <= kind.n_kept() {
            self.kept.push(describe());
        }
    }

    /// Adds the diagnostics of a later piece of the same work.
    pub fn append(&mut self, later: Self) {
        let mut room: Vec<u64> = DiagnosticKind::ALL
            .iter()
            .zip(&self.counts)
            .map(|(kind, &count)| kind.n_kept().saturating_sub(count))
            .collect();
        for diagnostic in later.kept {
            let room = &mut room[diagnostic.kind as usize];
            if *room > 0 {
                *room -= 1;
                self.kept.push(diagnostic);
            }
        }
        for (count, later) in self.counts.iter_mut().zip(later.counts) {
            *count += later;
        }
        self.n_aside += later.n_aside;
    }

    /// Reads what says nothing of where nodes and elements lie: no error in it is one of the geometry. What a
    /// missing include or a parameter without value is needed for is an error of its own.
    pub(crate) fn beside_geometry<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.n_geometry_errors();
        let result = read(self);
        self.n_aside += self.n_geometry_errors() - before;
        result
    }

    /// The kept diagnostics in the order they were made.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.kept.iter()
    }

    /// The kept diagnostic that matters most; among equals the first.
    pub fn most_severe(&self) -> Option<&Diagnostic> {
        self.iter().reduce(|most_severe, one| {
            if one.severity() > most_severe.severity() {
                one
            } else {
                most_severe
            }
        })
    }

    /// How many diagnostics of a kind were made.
    pub fn count(&self, kind: DiagnosticKind) -> u64 {
        self.counts[kind as usize]
    }

    /// Kinds that occurred, with their number.
    pub fn counts(&self) -> impl Iterator<Item = (DiagnosticKind, u64)> + '_ {
        let both = DiagnosticKind::ALL.iter().zip(&self.counts);
        both.map(|(&kind, &count)| (kind, count))
            .filter(|&(_, count)| count > 0)
    }

    /// How many errors concern where nodes and elements lie, or leave some out.
    pub fn n_geometry_errors(&self) -> u64 {
        let of_geometry = self.counts().filter(|(kind, _)| kind.is_of_geometry());
        of_geometry.map(|(_, n)| n).sum::<u64>() - self.n_aside
    }

    /// How many diagnostics were made in all.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// True if nothing was found.
    pub fn is_empty(&self) -> bool {
        self.total() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_of_one_kind_are_counted_and_few_are_kept() {
        let mut all = Diagnostics::default();
        for part in 0..3 {
            let mut later = Diagnostics::default();
            for i in 0..15 {
                let text = format!("{part} {i}");
                later.push(Diagnostic::new(DiagnosticKind::MissingNode, text));
            }
            later.push(Diagnostic::new(DiagnosticKind::ZeroArea, "flat"));
            all.append(later);
        }
        assert_eq!(all.count(DiagnosticKind::MissingNode), 45);
        assert_eq!(all.total(), 48);
        assert_eq!(all.iter().count(), 23);
        assert_eq!(all.counts().count(), 2);
        assert_eq!(all.n_geometry_errors(), 45);
    }

    #[test]
    fn errors_beside_the_geometry_are_counted_apart() {
        let bad = |text: &str| Diagnostic::new(DiagnosticKind::BadField, text);
        let mut all = Diagnostics::default();
        all.push(bad("a node"));
        all.beside_geometry(|found| {
            found.push(bad("a material"));
            found.push(Diagnostic::new(DiagnosticKind::BadForming, "a stress"));
        });
        let mut both = all.clone();
        both.append(all);
        assert_eq!((both.n_geometry_errors(), both.total()), (2, 6));
    }

    #[test]
    fn a_diagnostic_reads_as_one_line() {
        let file: Arc<Path> = Arc::from(Path::new("a.k"));
        let position = Position {
            file,
            line: 3,
            column: 9,
        };
        let diagnostic = Diagnostic::new(DiagnosticKind::BadField, "the part id is not a number")
            .at(position)
            .found("x1")
            .expected("an integer");
        assert_eq!(
            diagnostic.to_string(),
            "a.k:3:9: error: the part id is not a number, found \"x1\", expected an integer"
        );
    }
}
