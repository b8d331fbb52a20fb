//! `*SET_PART…`, `*SET_SHELL…`, `*SET_NODE…`.

use std::collections::{BTreeMap, BTreeSet};

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::Set;
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

    fn label(self) -> &'static str {
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
    pub title: String,
    pub members: Vec<Member>,
    /// Joined with other sets of the same id.
    pub is_collected: bool,
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
    let title = if block.has_option("TITLE") {
        cards.next()?.line_text().trim().to_owned()
    } else {
        String::new()
    };
    let first = cards.next()?;
    let id = match first.required_id(EIGHT_BY_10, 0) {
        Ok(id) => shifted(id, offsets.set),
        Err(error) => {
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
    for card in cards {
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
    })
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
        } else if has("ADD") {
            Self::Add
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
            Self::Add => {
                for index in 0..8 {
                    let set = shifted(card.id(EIGHT_BY_10, index)?, offsets.set);
                    into.extend(Some(set).filter(|&id| id != 0).map(Member::Set));
                }
            }
            Self::General => general_members(card, by, offsets, into)?,
        }
        Ok(())
    }
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

/// What the members of sets can refer to.
pub(crate) trait Members {
    /// Every id of a kind.
    fn all(&self, kind: SetKind) -> Vec<u64>;
    /// The ids of a kind that belong to a part.
    fn of_part(&self, kind: SetKind, part: u64) -> Vec<u64>;
}

/// Looks up the members of all sets.
pub(crate) fn resolve_sets(
    raw: &[RawSet],
    model: &dyn Members,
    found: &mut Diagnostics,
) -> BTreeMap<(SetKind, u64), Set> {
    let mut by_id: BTreeMap<(SetKind, u64), Vec<&RawSet>> = BTreeMap::new();
    for set in raw {
        let same = by_id.entry((set.kind, set.id)).or_default();
        // The last definition counts, unless sets are collected.
        if !set.is_collected {
            same.clear();
        }
        same.push(set);
    }
    let mut resolver = Resolver {
        by_id: &by_id,
        model,
        found,
        open: Vec::new(),
        known: BTreeMap::new(),
    };
    let mut sets = BTreeMap::new();
    for (&key, definitions) in &by_id {
        let ids = resolver.ids(key);
        let title = definitions.first().map(|set| set.title.clone());
        let title = title.unwrap_or_default();
        sets.insert(key, Set { title, ids });
    }
    sets
}

struct Resolver<'a> {
    by_id: &'a BTreeMap<(SetKind, u64), Vec<&'a RawSet>>,
    model: &'a dyn Members,
    found: &'a mut Diagnostics,
    open: Vec<(SetKind, u64)>,
    /// Sets may name each other many times over; each is worked out once.
    known: BTreeMap<(SetKind, u64), Vec<u64>>,
}

impl Resolver<'_> {
    /// The ids of a set, each once, in the order of the deck.
    fn ids(&mut self, key: (SetKind, u64)) -> Vec<u64> {
        let (kind, id) = key;
        if let Some(ids) = self.known.get(&key) {
            return ids.clone();
        }
        let Some(definitions) = self.by_id.get(&key) else {
            let message = format!("{} set {id} is not defined", kind.label());
            self.found
                .push(Diagnostic::new(DiagnosticKind::BadSet, message));
            return Vec::new();
        };
        if self.open.contains(&key) {
            let message = format!("{} set {id} contains itself", kind.label());
            self.found
                .push(Diagnostic::new(DiagnosticKind::BadSet, message));
            return Vec::new();
        }
        self.open.push(key);
        let mut ids = Vec::new();
        let members = definitions.iter().flat_map(|set| &set.members);
        for member in members {
            self.add(kind, *member, &mut ids);
        }
        self.open.pop();
        let mut seen = BTreeSet::new();
        ids.retain(|&id| seen.insert(id));
        self.known.insert(key, ids.clone());
        ids
    }

    fn add(&mut self, kind: SetKind, member: Member, ids: &mut Vec<u64>) {
        match member {
            Member::Range { first, last, step } => self.add_range(kind, first, last, step, ids),
            Member::Set(set) => {
                let more = self.ids((kind, set));
                ids.extend(more);
            }
            Member::All => ids.extend(self.model.all(kind)),
            Member::OfPart(part) => ids.extend(self.model.of_part(kind, part)),
            Member::OfPartSet(set) => {
                for part in self.ids((SetKind::Part, set)) {
                    ids.extend(self.model.of_part(kind, part));
                }
            }
            Member::Without { first, last } => ids.retain(|id| !(first..=last).contains(id)),
            Member::WithoutPart(part) => {
                let out: BTreeSet<u64> = self.model.of_part(kind, part).into_iter().collect();
                ids.retain(|id| !out.contains(id));
            }
        }
    }

    /// A range may span billions; only ids that exist are listed then.
    fn add_range(&self, kind: SetKind, first: u64, last: u64, step: u64, ids: &mut Vec<u64>) {
        const LISTED_AS_IT_IS: u64 = 1024;
        if last.saturating_sub(first) / step < LISTED_AS_IT_IS {
            ids.extend((first..=last).step_by(step as usize));
            return;
        }
        let mut existing = self.model.all(kind);
        existing.retain(|id| (first..=last).contains(id) && (id - first).is_multiple_of(step));
        existing.sort_unstable();
        existing.dedup();
        ids.extend(existing);
    }
}
