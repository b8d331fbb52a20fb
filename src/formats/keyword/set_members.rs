//! The ids of sets: ranges, whole parts and other sets put together.
//!
//! A set is built in the order of its cards, each id once. Ranges that were added are kept as
//! disjoint intervals, so that overlapping ones cost only what is new in them; work is near linear
//! in the ids that come out. Chains of sets are followed without recursion.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{IdIndex, Model, Set};
use super::sets::{Member, RawSet, SetKind};
use super::source_file::{Place, SourceFile};
use crate::monitor::{Cancelled, Monitor};

/// A range of at most this many steps is listed as it is; of a longer one, which may span
/// billions, only the ids that exist.
const LISTED_AS_IT_IS: u64 = 1024;
/// Ids between two questions to the monitor.
const CHUNK: u64 = 1 << 14;

type Key = (SetKind, u64);

/// What resolving needs besides the sets.
pub(crate) struct Surroundings<'a> {
    pub model: &'a Model,
    /// Ids that all sets may list together.
    pub max_ids: u64,
    pub monitor: &'a Monitor,
}

/// Looks up the members of all sets. What they name and is not there is told with the line of the
/// set that names it.
pub(crate) fn resolve_sets(
    raw: &[(Arc<SourceFile>, RawSet)],
    around: &Surroundings<'_>,
    found: &mut Diagnostics,
) -> Result<BTreeMap<Key, Set>, Cancelled> {
    let mut by_id: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
    for (index, (_, set)) in raw.iter().enumerate() {
        let same = by_id.entry((set.kind, set.id)).or_default();
        // The last definition counts, unless sets are collected.
        if !set.is_collected {
            if let Some(&earlier) = same.last() {
                tell_other_members(&raw[earlier], &raw[index], found);
            }
            same.clear();
        }
        same.push(index);
    }
    let mut resolver = Resolver {
        raw,
        by_id: &by_id,
        existing: Existing::new(around.model),
        n_left: around.max_ids,
        max_ids: around.max_ids,
        monitor: around.monitor,
        found,
        resolved: BTreeMap::new(),
    };
    for &key in by_id.keys() {
        resolver.resolve(key)?;
    }
    Ok(resolver.resolved)
}

/// Names a set that is defined again with other members.
fn tell_other_members(
    (first_file, first): &(Arc<SourceFile>, RawSet),
    (file, set): &(Arc<SourceFile>, RawSet),
    found: &mut Diagnostics,
) {
    if first.members == set.members {
        return;
    }
    let kind = DiagnosticKind::DuplicateSet;
    found.push_with(kind, || {
        let (label, id) = (set.kind.label(), set.id);
        let before = Place::new(first_file, first.at).position();
        let message =
            format!("{label} set {id} is defined again with other members (before at {before}), the last counts");
        Diagnostic::new(kind, message).at(Place::new(file, set.at).position())
    });
}

struct Resolver<'a> {
    raw: &'a [(Arc<SourceFile>, RawSet)],
    by_id: &'a BTreeMap<Key, Vec<usize>>,
    existing: Existing<'a>,
    /// Ids that may still be looked at.
    n_left: u64,
    max_ids: u64,
    monitor: &'a Monitor,
    found: &'a mut Diagnostics,
    /// Sets may name each other many times over; each is worked out once.
    resolved: BTreeMap<Key, Set>,
}

/// A set whose references are being followed: each with the definition that names it.
struct Open {
    key: Key,
    references: std::vec::IntoIter<(Key, usize)>,
}

impl Resolver<'_> {
    /// Works out a set and before it those it names.
    fn resolve(&mut self, key: Key) -> Result<(), Cancelled> {
        if self.resolved.contains_key(&key) {
            return Ok(());
        }
        let mut is_open = BTreeSet::from([key]);
        let mut open = vec![self.open(key)];
        while let Some(top) = open.last_mut() {
            self.monitor.check()?;
            let Some((next, definition)) = top.references.next() else {
                let key = top.key;
                open.pop();
                is_open.remove(&key);
                let set = self.build(key)?;
                self.resolved.insert(key, set);
                continue;
            };
            if self.resolved.contains_key(&next) {
                continue;
            }
            if !self.by_id.contains_key(&next) {
                self.tell(definition, next, "is not defined");
            } else if is_open.contains(&next) {
                self.tell(definition, next, "contains itself");
            } else {
                is_open.insert(next);
                let opened = self.open(next);
                open.push(opened);
            }
        }
        Ok(())
    }

    fn open(&self, key: Key) -> Open {
        let mut references = BTreeMap::new();
        let mut covered = Intervals::default();
        for &definition in &self.by_id[&key] {
            for member in &self.raw[definition].1.members {
                let reference = match *member {
                    Member::Set(id) | Member::Within(id) => (key.0, id),
                    Member::OfPartSet(id) => (SetKind::Part, id),
                    Member::Sets { first, last } => {
                        for (first, last) in covered.cover_if_range(first, last) {
                            for other in self.sets_in(key, first, last) {
                                references.entry(other).or_insert(definition);
                            }
                        }
                        continue;
                    }
                    _ => continue,
                };
                references.entry(reference).or_insert(definition);
            }
        }
        let references: Vec<(Key, usize)> = references.into_iter().collect();
        Open {
            key,
            references: references.into_iter(),
        }
    }

    /// The sets of the kind of `key` with ids in a range, without itself.
    fn sets_in(&self, key: Key, first: u64, last: u64) -> impl Iterator<Item = Key> + use<'_> {
        let range = (first <= last).then(|| self.by_id.range((key.0, first)..=(key.0, last)));
        let keys = range.into_iter().flatten().map(|(&other, _)| other);
        keys.filter(move |&other| other != key)
    }

    fn tell(&mut self, definition: usize, (kind, id): Key, what: &str) {
        let (file, by) = &self.raw[definition];
        let diagnostic_kind = DiagnosticKind::BadSet;
        self.found.push_with(diagnostic_kind, || {
            let (label, by_label) = (kind.label(), by.kind.label());
            let message = if (by.kind, by.id) == (kind, id) || what == "contains itself" {
                format!("{label} set {id} {what}")
            } else {
                format!(
                    "{by_label} set {} names {label} set {id}, which {what}",
                    by.id
                )
            };
            Diagnostic::new(diagnostic_kind, message).at(Place::new(file, by.at).position())
        });
    }

    /// The ids of a set whose references are resolved, each once, in the order of the deck.
    fn build(&mut self, (kind, id): Key) -> Result<Set, Cancelled> {
        let definitions = &self.by_id[&(kind, id)];
        let mut builder = Builder::default();
        let mut title = None;
        for &definition in definitions {
            let set = &self.raw[definition].1;
            title.get_or_insert_with(|| super::super::text::shown(&set.title));
            for member in &set.members {
                self.monitor.check()?;
                if self.n_left == 0 {
                    self.tell_limit(definition);
                    break;
                }
                if let Member::Sets { first, last } = *member
                    && self.sets_in((kind, id), first, last).next().is_none()
                {
                    let what = "begins a range of ids in which no set is defined";
                    self.tell(definition, (kind, first), what);
                }
                self.add((kind, id), *member, &mut builder)?;
            }
        }
        Ok(Set {
            title: title.unwrap_or_default(),
            ids: builder.finish(),
        })
    }

    fn tell_limit(&mut self, definition: usize) {
        let (file, set) = &self.raw[definition];
        let kind = DiagnosticKind::LimitReached;
        let n = self.max_ids;
        self.found.push_with(kind, || {
            let message = format!(
                "the sets list more than {n} ids, the limit; from {} set {} on they are \
                 incomplete; raise it with --read-limit or in the preferences",
                set.kind.label(),
                set.id
            );
            Diagnostic::new(kind, message).at(Place::new(file, set.at).position())
        });
    }

    fn add(&mut self, own: Key, member: Member, to: &mut Builder) -> Result<(), Cancelled> {
        let (kind, _) = own;
        match member {
            Member::Range { first, last, step } => self.add_range(kind, [first, last, step], to),
            Member::Set(id) => self.add_set(kind, id, to),
            Member::Sets { first, last } => {
                let new = to.sets.cover_if_range(first, last).into_iter();
                let sets = new.flat_map(|(first, last)| self.sets_in(own, first, last));
                let sets: Vec<Key> = sets.collect();
                // Empty sets take time too.
                self.n_left = self.n_left.saturating_sub(sets.len() as u64);
                sets.into_iter()
                    .try_for_each(|(kind, id)| self.add_set(kind, id, to))
            }
            Member::All => {
                if to.whole.insert((kind, None, false)) {
                    let ids = self.existing.all(kind);
                    self.push_all(ids, to)?;
                }
                Ok(())
            }
            Member::OfPart(part) => self.add_part(kind, part, to),
            Member::OfPartSet(id) => {
                let parts = self.resolved.get(&(SetKind::Part, id));
                let parts = parts.map(|set| set.ids.clone()).unwrap_or_default();
                // Those without elements cost time too.
                self.n_left = self.n_left.saturating_sub(parts.len() as u64);
                parts
                    .into_iter()
                    .try_for_each(|part| self.add_part(kind, part, to))
            }
            Member::Within(id) => {
                let ids = self.resolved.get(&(kind, id)).map(|set| &set.ids);
                let ids: BTreeSet<u64> = ids.into_iter().flatten().copied().collect();
                self.n_left = self.n_left.saturating_sub(ids.len() as u64);
                to.keep(&ids);
                Ok(())
            }
            Member::Without { first, last } => {
                to.remove(first, last);
                Ok(())
            }
            Member::WithoutPart(part) => {
                let ids = self.existing.of_part(kind, part);
                self.n_left = self.n_left.saturating_sub(ids.len() as u64);
                for id in ids {
                    to.remove(id, id);
                }
                Ok(())
            }
        }
    }

    fn add_set(&mut self, kind: SetKind, id: u64, to: &mut Builder) -> Result<(), Cancelled> {
        if to.whole.insert((kind, Some(id), true)) {
            let ids = self.resolved.get(&(kind, id)).map(|set| set.ids.clone());
            self.push_all(ids.unwrap_or_default(), to)?;
        }
        Ok(())
    }

    fn add_part(&mut self, kind: SetKind, part: u64, to: &mut Builder) -> Result<(), Cancelled> {
        if to.whole.insert((kind, Some(part), false)) {
            let ids = self.existing.of_part(kind, part);
            self.push_all(ids, to)?;
        }
        Ok(())
    }

    fn push_all(
        &mut self,
        ids: impl IntoIterator<Item = u64>,
        to: &mut Builder,
    ) -> Result<(), Cancelled> {
        for id in ids {
            if self.n_left == 0 {
                break;
            }
            self.n_left -= 1;
            if self.n_left.is_multiple_of(CHUNK) {
                self.monitor.check()?;
            }
            to.push(id);
        }
        Ok(())
    }

    fn add_range(
        &mut self,
        kind: SetKind,
        [first, last, step]: [u64; 3],
        to: &mut Builder,
    ) -> Result<(), Cancelled> {
        if last < first {
            return Ok(());
        }
        let n_steps = (last - first) / step;
        if n_steps == 0 {
            return self.push_all([first], to);
        }
        if n_steps < LISTED_AS_IT_IS {
            if step > 1 {
                let ids = (0..=n_steps).map(|i| first + i * step);
                return self.push_all(ids, to);
            }
            to.existing.cover(first, last);
            for (first, last) in to.listed.cover(first, last) {
                self.push_all(first..=last, to)?;
            }
            return Ok(());
        }
        if step > 1 {
            let ids = self.existing.in_range(kind, first, last).to_vec();
            self.n_left = self.n_left.saturating_sub(ids.len() as u64);
            let ids = ids.into_iter();
            return self.push_all(ids.filter(|id| (id - first).is_multiple_of(step)), to);
        }
        for (first, last) in to.existing.cover(first, last) {
            let ids = self.existing.in_range(kind, first, last).to_vec();
            self.push_all(ids, to)?;
        }
        Ok(())
    }
}

/// A set that is being built.
#[derive(Default)]
struct Builder {
    /// In the order they came; 0, which is no id, where one was taken out.
    ids: Vec<u64>,
    /// Place in `ids`.
    place: BTreeMap<u64, usize>,
    /// Ranges of which every id is in the set.
    listed: Intervals,
    /// Ranges of which every existing id is in the set.
    existing: Intervals,
    /// Ranges of ids of sets that were added.
    sets: Intervals,
    /// Parts (or everything) and sets that were added whole.
    whole: BTreeSet<(SetKind, Option<u64>, bool)>,
}

impl Builder {
    fn push(&mut self, id: u64) {
        let next = self.ids.len();
        if *self.place.entry(id).or_insert(next) == next {
            self.ids.push(id);
        }
    }

    fn remove(&mut self, first: u64, last: u64) {
        if last < first {
            return;
        }
        let removed: Vec<u64> = self.place.range(first..=last).map(|(&id, _)| id).collect();
        for id in removed {
            if let Some(place) = self.place.remove(&id) {
                self.ids[place] = 0;
            }
        }
        self.listed.uncover(first, last);
        self.existing.uncover(first, last);
        self.sets = Intervals::default();
        self.whole.clear();
    }

    /// Takes out what is not among `ids`.
    fn keep(&mut self, ids: &BTreeSet<u64>) {
        self.ids.retain(|id| ids.contains(id));
        let places = self.ids.iter().enumerate();
        self.place = places.map(|(place, &id)| (id, place)).collect();
        (self.listed, self.existing, self.sets) = Default::default();
        self.whole.clear();
    }

    fn finish(mut self) -> Vec<u64> {
        self.ids.retain(|&id| id != 0);
        self.ids
    }
}

/// Disjoint closed intervals, by their first number.
#[derive(Debug, Default)]
pub(super) struct Intervals(BTreeMap<u64, u64>);

impl Intervals {
    /// [`Intervals::cover`] of a range that may be none.
    fn cover_if_range(&mut self, first: u64, last: u64) -> Vec<(u64, u64)> {
        if first <= last {
            self.cover(first, last)
        } else {
            Vec::new()
        }
    }

    /// Adds `first..=last`; gives the parts of it that were not covered before. O(log n) and what
    /// it joins.
    pub(super) fn cover(&mut self, first: u64, last: u64) -> Vec<(u64, u64)> {
        let (mut gaps, mut next) = (Vec::new(), Some(first));
        let (mut from, mut to) = (first, last);
        let before = self.0.range(..=first).next_back();
        let before = before.filter(|&(_, &end)| end >= first).map(|(&a, _)| a);
        let start = before.unwrap_or(first);
        let touched: Vec<(u64, u64)> = self.0.range(start..=last).map(|(&a, &b)| (a, b)).collect();
        for (a, b) in touched {
            if let Some(at) = next.filter(|&at| at < a) {
                gaps.push((at, a - 1));
            }
            next = b.checked_add(1);
            (from, to) = (from.min(a), to.max(b));
            self.0.remove(&a);
        }
        if let Some(at) = next.filter(|&at| at <= last) {
            gaps.push((at, last));
        }
        self.0.insert(from, to);
        gaps
    }

    /// Takes `first..=last` out.
    fn uncover(&mut self, first: u64, last: u64) {
        self.cover(first, last);
        let Some((&a, &b)) = self.0.range(..=first).next_back() else {
            return;
        };
        self.0.remove(&a);
        if a < first {
            self.0.insert(a, first - 1);
        }
        if b > last {
            self.0.insert(last + 1, b);
        }
    }
}

/// The ids that exist, found by range and by part. Tables are made when they are first needed.
struct Existing<'a> {
    model: &'a Model,
    sorted: [OnceCell<Vec<u64>>; 3],
    part_index: OnceCell<IdIndex>,
    shells_of: OnceCell<Vec<Vec<u32>>>,
    solids_of: OnceCell<Vec<Vec<u32>>>,
}

impl<'a> Existing<'a> {
    fn new(model: &'a Model) -> Self {
        Self {
            model,
            sorted: Default::default(),
            part_index: OnceCell::new(),
            shells_of: OnceCell::new(),
            solids_of: OnceCell::new(),
        }
    }

    /// In the order of the deck.
    fn all(&self, kind: SetKind) -> Vec<u64> {
        match kind {
            SetKind::Part => self.model.parts.iter().map(|part| part.id).collect(),
            SetKind::Shell => self.model.shells.iter().map(|shell| shell.id).collect(),
            SetKind::Node => self.model.nodes.ids().to_vec(),
        }
    }

    fn in_range(&self, kind: SetKind, first: u64, last: u64) -> &[u64] {
        let sorted = self.sorted[kind as usize].get_or_init(|| {
            let mut ids = self.all(kind);
            ids.sort_unstable();
            ids.dedup();
            ids
        });
        let from = sorted.partition_point(|&id| id < first);
        let to = sorted.partition_point(|&id| id <= last);
        &sorted[from..to.max(from)]
    }

    fn of_part(&self, kind: SetKind, part: u64) -> Vec<u64> {
        let model = self.model;
        let index = self.part_index.get_or_init(|| {
            let ids: Vec<u64> = model.parts.iter().map(|part| part.id).collect();
            IdIndex::new(&ids).0
        });
        let Some(part_index) = index.get(part) else {
            return Vec::new();
        };
        let lists = |parts: &mut dyn Iterator<Item = u32>| {
            let mut lists = vec![Vec::new(); model.parts.len()];
            for (element, part) in (0u32..).zip(parts) {
                lists[part as usize].push(element);
            }
            lists
        };
        let shells = || {
            let make = || lists(&mut model.shells.iter().map(|shell| shell.part));
            let list = &self.shells_of.get_or_init(make)[part_index as usize];
            list.iter().map(|&i| &model.shells[i as usize])
        };
        match kind {
            SetKind::Part => vec![part],
            SetKind::Shell => shells().map(|shell| shell.id).collect(),
            SetKind::Node => {
                let make = || lists(&mut model.solids.iter().map(|solid| solid.part));
                let solids = &self.solids_of.get_or_init(make)[part_index as usize];
                let of_solids = solids.iter().flat_map(|&i| model.solids[i as usize].nodes);
                let of_shells = shells().flat_map(|shell| shell.nodes);
                let mut nodes: Vec<u32> = of_shells.chain(of_solids).collect();
                nodes.sort_unstable();
                nodes.dedup();
                nodes
                    .iter()
                    .map(|&n| model.nodes.ids()[n as usize])
                    .collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn covered(intervals: &Intervals) -> BTreeSet<u64> {
        let ranges = intervals.0.iter();
        ranges.flat_map(|(&a, &b)| a..=b).collect()
    }

    proptest! {
        #[test]
        fn intervals_are_sets_of_numbers(
            steps in proptest::collection::vec((any::<bool>(), 0u64..60, 0u64..12), 0..60),
        ) {
            let mut intervals = Intervals::default();
            let mut expected = BTreeSet::new();
            for (is_added, first, length) in steps {
                let range = first..=first + length;
                if is_added {
                    let gaps = intervals.cover(first, first + length);
                    let new: Vec<u64> = gaps.into_iter().flat_map(|(a, b)| a..=b).collect();
                    let missing = range.clone().filter(|id| !expected.contains(id));
                    prop_assert_eq!(new, missing.collect::<Vec<_>>());
                    expected.extend(range);
                } else {
                    intervals.uncover(first, first + length);
                    expected.retain(|id| !range.contains(id));
                }
                prop_assert_eq!(covered(&intervals), expected.clone());
            }
        }
    }

    #[test]
    fn intervals_reach_to_the_last_number() {
        let mut intervals = Intervals::default();
        assert_eq!(intervals.cover(5, u64::MAX), [(5, u64::MAX)]);
        assert_eq!(intervals.cover(0, u64::MAX), [(0, 4)]);
        intervals.uncover(7, u64::MAX);
        assert_eq!(intervals.cover(6, 8), [(7, 8)]);
    }
}
