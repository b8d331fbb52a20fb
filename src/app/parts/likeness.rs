//! The parts of the decks in the order of their likeness to one of them.

use std::collections::BTreeMap;

use super::{PartRef, PartsState};
use crate::app::{AppState, Document, OfParts};
use crate::formats::Selection;
use crate::pipeline::likeness::{Moments, Signature, joined_signatures, more_alike};
use crate::role::{PerRole, Role};

/// A crash model of so many parts is sorted as soon as the stamped part is known.
const MANY: usize = 20;
/// Of parts that are equally alike so many are named.
const N_NAMED: usize = 4;

/// What parts are compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LikeWhat {
    /// All parts of a deck that are matched, taken together.
    Used(Role),
    /// One part of a deck.
    Part(PartRef),
}

impl LikeWhat {
    /// The deck it belongs to; the parts of the other deck are compared with it.
    pub fn role(self) -> Role {
        match self {
            Self::Used(role) => role,
            Self::Part(part) => part.role,
        }
    }
}

/// How like each part of one deck is to something of the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeness {
    /// What they are compared with.
    pub to: LikeWhat,
    /// From 1, the same, towards 0; by id.
    pub of_part: BTreeMap<u64, f64>,
    /// The ids, the most alike first; those without area come last.
    pub order: Vec<u64>,
    parts: PerRole<u64>,
}

impl AppState {
    /// The likenesses that the part list is sorted by, if they are those of the loaded parts.
    pub fn current_likeness(&self) -> Option<&Likeness> {
        let parts = self.document.stamp().parts;
        self.parts.likeness.as_ref().filter(|l| l.parts == parts)
    }
}

/// The part of the crash model that is more like the stamped part than all that are matched together, or several that
/// are about equally alike. Parts that share nodes count as one, too.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MoreAlike {
    /// The ids of each.
    pub choices: Vec<Vec<u64>>,
    /// Crash parts that are matched now.
    pub n_used: usize,
}

impl MoreAlike {
    /// The ids, if only one choice is most alike.
    pub fn only(&self) -> Option<&[u64]> {
        match &self.choices[..] {
            [ids] => Some(ids),
            _ => None,
        }
    }

    /// The titles of the parts of a choice: "2000041 Pillar outer + 2000042 Pillar inner".
    pub fn titles(&self, document: &Document, place: usize) -> String {
        let ids = self.choices.get(place).into_iter().flatten();
        let role = Role::Crash;
        let titles = ids.map(|&id| document.part_title(PartRef { role, id }));
        titles.collect::<Vec<_>>().join(" + ")
    }

    /// The title of one part, or the numbers of several: "2000040, 2000041 + 2000042 and 3 more".
    pub fn title(&self, document: &Document) -> String {
        if let Some(&[id]) = self.only() {
            let role = Role::Crash;
            return document.part_title(PartRef { role, id });
        }
        let named = self.choices.iter().take(N_NAMED);
        let named: Vec<String> = named.map(|ids| together(ids)).collect();
        let named = named.join(", ");
        match self.choices.len().saturating_sub(N_NAMED) {
            0 => named,
            more => format!("{named} and {more} more"),
        }
    }
}

/// Parts that are matched as one: "2000041 + 2000042".
pub fn together(ids: &[u64]) -> String {
    let ids: Vec<String> = ids.iter().map(u64::to_string).collect();
    ids.join(" + ")
}

impl AppState {
    /// The parts of the crash model of which some should be matched alone, where all of several are.
    pub fn more_alike(&self) -> Option<&MoreAlike> {
        self.parts.more_alike.as_ref()?.current(&self.document)
    }

    /// [`AppState::more_alike`] until the user said which parts are matched, or a match was made.
    pub fn part_question(&self) -> Option<&MoreAlike> {
        let crash = self.document.part(Role::Crash);
        let is_chosen = crash.is_some_and(|crash| {
            let selection = &crash.loaded.settings.selection;
            !matches!(selection, Selection::All | Selection::Sheet)
        });
        let is_answered = is_chosen || self.document.are_all_meant();
        let result = self.document.result.as_ref();
        let parts = self.document.stamp().parts;
        let is_matched = result.is_some_and(|result| result.stamp.parts == parts);
        self.more_alike().filter(|_| !is_answered && !is_matched)
    }

    /// True if a match first finds the crash part: while the user has not said which are matched, and on full
    /// meshes only, which each of them has.
    pub(in crate::app) fn is_part_open(&self) -> bool {
        let both = self.document.both();
        let is_full =
            both.is_some_and(|both| both.crash.level.is_none() && both.stamped.level.is_none());
        is_full && self.part_question().is_some()
    }
}

impl PartsState {
    pub(super) fn order_like(&mut self, document: &Document, to: Option<LikeWhat>) {
        self.likeness = to.and_then(|to| document.likeness_to(to));
    }

    /// After a part came or went, or a step in the history: the same comparison again, or the obvious one for a whole
    /// car.
    pub(in crate::app) fn refresh_likeness(&mut self, document: &Document) {
        let is_car = document
            .part(Role::Crash)
            .is_some_and(|part| part.facts.parts.len() > MANY);
        let of_car = is_car.then_some(LikeWhat::Used(Role::Stamped));
        let to = self.likeness.as_ref().map(|l| l.to).or(of_car);
        self.order_like(document, to);
        let more_alike = document.more_alike();
        self.more_alike = more_alike.map(|more| OfParts::new(document, more));
    }
}

impl Document {
    /// True if the user said that all parts of the crash model are meant.
    pub(in crate::app) fn are_all_meant(&self) -> bool {
        self.all_meant_for == Some(self.stamp().parts)
    }

    /// The user says so, or said so of the same parts.
    pub(in crate::app) fn mean_all(&mut self) {
        self.all_meant_for = Some(self.stamp().parts);
    }

    /// O(parts · log parts).
    fn more_alike(&self) -> Option<MoreAlike> {
        let both = self.both()?;
        let n_used = both.crash.facts.used.len();
        if n_used < 2 {
            return None;
        }
        let stamped = self.signature(LikeWhat::Used(Role::Stamped))?;
        let together = self.signature(LikeWhat::Used(Role::Crash))?;
        let found = self.likeness_to(LikeWhat::Used(Role::Stamped))?;
        let used = found.order.iter().filter(|id| both.crash.is_used(**id));
        let of_used = used.filter_map(|id| Some((vec![*id], *found.of_part.get(id)?)));
        let facts = &both.crash.facts;
        let thickness = |id| facts.parts.iter().find(|row| row.id == id)?.thickness;
        let joined = joined_signatures(&facts.joined, &facts.moments, thickness);
        let of_joined = joined
            .into_iter()
            .map(|(ids, own)| (ids, stamped.likeness(&own)));
        // Solids beside shells, such as adhesive, are no part of the sheet.
        let with_shells = both.crash.facts.used.iter().copied();
        let with_shells: Vec<u64> = with_shells
            .filter(|id| facts.moments.contains_key(id))
            .collect();
        let of_all = stamped.likeness(&together);
        let (sheets, least) = if with_shells.len() < n_used {
            (Some((with_shells, of_all)), 0.0)
        } else {
            (None, of_all)
        };
        let all = of_used
            .chain(of_joined)
            .chain(sheets.filter(|(ids, _)| ids.len() > 1));
        let choices = more_alike(all, least);
        (!choices.is_empty()).then_some(MoreAlike { choices, n_used })
    }

    /// Title of a part of a deck with its number, or the number alone.
    pub fn part_title(&self, part: PartRef) -> String {
        let rows = self.part(part.role).map(|p| &p.facts.parts);
        let row = rows.and_then(|rows| rows.iter().find(|row| row.id == part.id));
        match row {
            Some(row) if !row.title.is_empty() => format!("{} {}", part.id, row.title),
            _ => format!("part {}", part.id),
        }
    }

    /// O(parts · log parts).
    fn likeness_to(&self, to: LikeWhat) -> Option<Likeness> {
        let given = self.signature(to)?;
        let part = self.part(to.role().other())?;
        let facts = &part.facts;
        let mut of_part = BTreeMap::new();
        for row in &facts.parts {
            let moments = facts.moments.get(&row.id);
            let thickness = row.thickness;
            if let Some(signature) = moments.and_then(|m| m.signature(thickness)) {
                of_part.insert(row.id, given.likeness(&signature));
            }
        }
        let rank = |id: &u64| of_part.get(id).copied().unwrap_or(-1.0);
        let mut order: Vec<u64> = facts.parts.iter().map(|row| row.id).collect();
        order.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
        Some(Likeness {
            to,
            of_part,
            order,
            parts: self.stamp().parts,
        })
    }

    fn signature(&self, what: LikeWhat) -> Option<Signature> {
        let part = self.part(what.role())?;
        let facts = &part.facts;
        match what {
            LikeWhat::Used(_) => {
                let used = facts.used.iter().filter_map(|id| facts.moments.get(id));
                let together = used.fold(Moments::default(), |sum, m| sum.and(m));
                together.signature(facts.thickness)
            }
            LikeWhat::Part(of) => {
                let row = facts.parts.iter().find(|row| row.id == of.id)?;
                let thickness = row.thickness;
                facts.moments.get(&of.id)?.signature(thickness)
            }
        }
    }
}
