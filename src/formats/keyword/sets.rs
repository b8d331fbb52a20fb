//! `*SET_PART…`, `*SET_SHELL…`, `*SET_NODE…`.

use super::super::diagnostic::{DiagnosticKind, Diagnostics};
use super::super::text;
use super::block::Block;
use super::card::{Card, EIGHT_BY_10, FieldError};
use super::nodes::shifted;

/// What a set is a set of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SetKind {
    Part,
    Shell,
    Node,
}

impl SetKind {
    /// Each kind with the start of its keyword.
    pub(crate) const ALL: &[(Self, &str)] = &[
        (Self::Part, "SET_PART"),
        (Self::Shell, "SET_SHELL"),
        (Self::Node, "SET_NODE"),
    ];

    /// The kind of a set keyword.
    pub(crate) fn of_keyword(name: &str) -> Option<Self> {
        let starts = |word: &str| {
            let rest = name.strip_prefix(word);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
        };
        let row = Self::ALL.iter().find(|(_, word)| starts(word));
        row.map(|&(kind, _)| kind)
    }

    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Part => "part",
            Self::Shell => "shell",
            Self::Node => "node",
        }
    }
}

/// One piece of what a set is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Member {
    /// Ids from the first to the last in steps.
    Range { first: u64, last: u64, step: u64 },
    /// The ids of another set of the same kind.
    Set(u64),
    /// The ids that are not in another set of the same kind are taken out again.
    Within(u64),
    /// The ids of all other sets of the same kind whose own ids lie in a range.
    Sets { first: u64, last: u64 },
    /// Every id there is.
    All,
    /// The elements, or their nodes, of a part.
    OfPart(u64),
    /// The elements, or their nodes, of the parts in a part set.
    OfPartSet(u64),
    /// The ids in a range are taken out again.
    Without { first: u64, last: u64 },
    /// The elements, or their nodes, of a part are taken out again.
    WithoutPart(u64),
}

/// A set as its cards have it; its members are looked up when everything is read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RawSet {
    pub kind: SetKind,
    pub id: u64,
    /// The title, byte by byte.
    pub title: Vec<u8>,
    pub members: Vec<Member>,
    /// Joined with other sets of the same id.
    pub is_collected: bool,
    /// Byte offset of its first card.
    pub at: usize,
}

/// What an include adds to ids on set cards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SetOffsets {
    pub set: i64,
    pub part: i64,
    pub element: i64,
    pub node: i64,
}

/// Reads one set; `None` if its id cannot be read.
pub(crate) fn read_set(
    block: &Block<'_>,
    kind: SetKind,
    offsets: &SetOffsets,
    found: &mut Diagnostics,
) -> Option<RawSet> {
    let mut cards = block.cards();
    let unknown = unknown_option(block, kind);
    if let Some(option) = unknown {
        let unsupported = DiagnosticKind::Unsupported;
        found.push_with(unsupported, || {
            let message = format!("*{} is not carried out; the set has no members", block.name);
            block.diagnose(unsupported, message).found(option)
        });
    }
    let title = if block.has_option("TITLE") {
        cards.next()?.title().to_owned()
    } else {
        Vec::new()
    };
    let first = cards.next()?;
    let id = match first.required_id(EIGHT_BY_10, 0) {
        Ok(id) => shifted(id, offsets.set),
        Err(mut error) => {
            if !block.has_option("TITLE") && error.kind == DiagnosticKind::BadField {
                error.expected = "an id; a line with a title needs _TITLE in the keyword";
            }
            found.push_with(error.kind, || first.diagnose(&error, "the set's id"));
            return None;
        }
    };
    let form = Form::of_block(block, kind);
    let of_member = match kind {
        SetKind::Part => offsets.part,
        SetKind::Shell => offsets.element,
        SetKind::Node => offsets.node,
    };
    let mut members = Vec::new();
    for card in cards.filter(|_| unknown.is_none()) {
        if let Err(error) = form.members(&card, of_member, offsets, &mut members) {
            let what = format!("{} set {id}", kind.label());
            found.push_with(error.kind, || card.diagnose(&error, &what));
        }
    }
    Some(RawSet {
        kind,
        id,
        title,
        members,
        is_collected: block.has_option("COLLECT"),
        at: first.offset(),
    })
}

/// Options that are read, besides those of which sets there are.
const OPTIONS: &[&str] = &[
    "ADD",
    "ADVANCED",
    "COLLECT",
    "COLUMN",
    "GENERAL",
    "GENERATE",
    "INCREMENT",
    "INTERSECT",
    "LIST",
    "SMOOTH",
    "TITLE",
];

/// An option whose cards may be of any form.
fn unknown_option<'a>(block: &'a Block<'_>, kind: SetKind) -> Option<&'a str> {
    let (_, word) = SetKind::ALL.iter().find(|(known, _)| *known == kind)?;
    let options = block.name.strip_prefix(word)?.split('_');
    let mut options = options.filter(|option| !option.is_empty());
    options.find(|option| !OPTIONS.contains(option))
}

/// How the cards after the first list members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Eight ids a card.
    List,
    /// One id a card, with attributes.
    Column,
    /// Pairs of first and last id.
    Generate,
    /// First, last, step.
    GenerateIncrement,
    /// Ids of sets.
    Add,
    /// Ids of sets; a negative one ends a range that the id before it begins.
    AddRanges,
    /// Pairs of a set's id and of a number for its kind.
    AddAdvanced,
    /// Ids of sets, of which the members that are in all of them are meant.
    Intersect,
    /// An option and up to seven ids.
    General,
}

impl Form {
    fn of_block(block: &Block<'_>, kind: SetKind) -> Self {
        let has = |option| block.has_option(option);
        if has("INCREMENT") {
            Self::GenerateIncrement
        } else if has("GENERATE") {
            Self::Generate
        } else if has("ADD") && has("ADVANCED") {
            Self::AddAdvanced
        } else if has("ADD") && kind == SetKind::Part {
            Self::AddRanges
        } else if has("ADD") {
            Self::Add
        } else if has("INTERSECT") {
            Self::Intersect
        } else if has("GENERAL") {
            Self::General
        } else if has("COLUMN") || kind == SetKind::Part && !has("LIST") {
            Self::Column
        } else {
            Self::List
        }
    }

    fn members(
        self,
        card: &Card<'_>,
        by: i64,
        offsets: &SetOffsets,
        into: &mut Vec<Member>,
    ) -> Result<(), FieldError> {
        let id = |index| Ok(shifted(card.id(EIGHT_BY_10, index)?, by));
        let single = |id| Member::Range {
            first: id,
            last: id,
            step: 1,
        };
        match self {
            Self::List => {
                for index in 0..8 {
                    into.extend(Some(id(index)?).filter(|&id| id != 0).map(single));
                }
            }
            Self::Column => into.extend(Some(id(0)?).filter(|&id| id != 0).map(single)),
            Self::Generate => {
                for index in [0, 2, 4, 6] {
                    let (first, last) = (id(index)?, id(index + 1)?);
                    if first != 0 {
                        into.push(Member::Range {
                            first,
                            last,
                            step: 1,
                        });
                    }
                }
            }
            Self::GenerateIncrement => {
                let (first, last) = (id(0)?, id(1)?);
                let step = card.id(EIGHT_BY_10, 2)?.max(1);
                if first != 0 {
                    into.push(Member::Range { first, last, step });
                }
            }
            Self::Add | Self::Intersect => {
                for index in 0..8 {
                    let set = shifted(card.id(EIGHT_BY_10, index)?, offsets.set);
                    let member = if self == Self::Add || into.is_empty() {
                        Member::Set(set)
                    } else {
                        Member::Within(set)
                    };
                    into.extend((set != 0).then_some(member));
                }
            }
            Self::AddRanges => {
                for index in 0..8 {
                    let number = card.int_or_zero(EIGHT_BY_10, index)?;
                    let set = shifted(number.unsigned_abs(), offsets.set);
                    if number > 0 {
                        into.push(Member::Set(set));
                    } else if number < 0 {
                        let Some(&Member::Set(first)) = into.last() else {
                            let field = card.field(EIGHT_BY_10, index);
                            return Err(FieldError {
                                kind: DiagnosticKind::BadField,
                                column: field.column,
                                found: text::decoded(field.text).into_owned(),
                                expected: "before a negative id, which ends a range of sets, the positive one \
                                           that begins it",
                            });
                        };
                        into.push(Member::Sets { first, last: set });
                    }
                }
            }
            Self::AddAdvanced => advanced_members(card, offsets, into)?,
            Self::General => general_members(card, by, offsets, into)?,
        }
        Ok(())
    }
}

/// A card of an `_ADD_ADVANCED` set: ids of sets, each with the number of its kind.
fn advanced_members(
    card: &Card<'_>,
    offsets: &SetOffsets,
    into: &mut Vec<Member>,
) -> Result<(), FieldError> {
    for index in [0, 2, 4, 6] {
        let set = shifted(card.id(EIGHT_BY_10, index)?, offsets.set);
        let of_nodes = matches!(card.int_or_zero(EIGHT_BY_10, index + 1)?, 0 | 1);
        if set != 0 && !of_nodes {
            let field = card.field(EIGHT_BY_10, index + 1);
            return Err(FieldError {
                kind: DiagnosticKind::Unsupported,
                column: field.column,
                found: text::decoded(field.text).into_owned(),
                expected: "1, the set of nodes",
            });
        }
        into.extend(Some(set).filter(|&id| id != 0).map(Member::Set));
    }
    Ok(())
}

/// A card of a `_GENERAL` set: an option in ten columns and up to seven ids.
fn general_members(
    card: &Card<'_>,
    by: i64,
    offsets: &SetOffsets,
    into: &mut Vec<Member>,
) -> Result<(), FieldError> {
    let option = card.text(EIGHT_BY_10, 0)?.to_ascii_uppercase();
    if option.is_empty() {
        return Ok(());
    }
    if option == "ALL" {
        into.push(Member::All);
        return Ok(());
    }
    let ids = |offset: i64| -> Result<Vec<u64>, FieldError> {
        let all: Result<Vec<u64>, _> = (1..8).map(|i| card.id(EIGHT_BY_10, i)).collect();
        let given = all?.into_iter().filter(|&id| id != 0);
        Ok(given.map(|id| shifted(id, offset)).collect())
    };
    match option.as_str() {
        "ELEM" | "NODE" | "OPTION" => {
            into.extend(ids(by)?.into_iter().map(|id| Member::Range {
                first: id,
                last: id,
                step: 1,
            }));
        }
        "DELEM" | "DNODE" => {
            into.extend(ids(by)?.into_iter().map(|id| Member::Without {
                first: id,
                last: id,
            }));
        }
        "PART" => into.extend(ids(offsets.part)?.into_iter().map(Member::OfPart)),
        "DPART" => into.extend(ids(offsets.part)?.into_iter().map(Member::WithoutPart)),
        "SET_PART" | "SET_PAR" => {
            into.extend(ids(offsets.set)?.into_iter().map(Member::OfPartSet));
        }
        _ => {
            let field = card.field(EIGHT_BY_10, 0);
            return Err(FieldError {
                kind: DiagnosticKind::Unsupported,
                column: field.column,
                found: option,
                expected: "ALL, ELEM, DELEM, NODE, DNODE, PART, DPART or SET_PART",
            });
        }
    }
    Ok(())
}
