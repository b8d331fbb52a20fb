//! What the crash deck has of mapped elements already: stresses and strains, with copies of its files without
//! them, and cards that let the solver map.

use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use super::includes::include_copies;
use super::output::{MapFile, MapWriter};
use super::{MapRun, PipelineError};
use crate::formats::keyword::exchange::{
    Exchange, ExchangeRules, ExchangedDeck, ResultCards, exchange_thickness,
};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::model::ReadFile;
use crate::formats::{self, Model, Replaced};
use crate::geometry::chunks::for_chunks;
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::names::file_name;
use crate::pipeline::outputs::{Content, Target, overwritten_inputs};
use crate::pipeline::read_again::ReadAgain;
use crate::text::parts_by_id;

/// Elements that get stresses, and elements that get strains, by their ids in the crash deck.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NewStates {
    pub(super) stressed: HashSet<u64>,
    pub(super) strained: HashSet<u64>,
}

impl NewStates {
    /// Adds those of another mapping.
    pub fn add(&mut self, other: &Self) {
        self.stressed.extend(&other.stressed);
        self.strained.extend(&other.strained);
    }

    /// Elements of which the deck has a card of the same kind already.
    pub(super) fn n_old(&self, model: &Model) -> usize {
        let all = cards_of(model);
        let old = all.filter(|(is_stress, id)| self.of(*is_stress).contains(id));
        old.map(|(_, id)| id).collect::<BTreeSet<u64>>().len()
    }

    /// Elements of the mapping of which the deck has a card that nothing takes the place of.
    pub(super) fn n_kept(&self, run: &MapRun, model: &Model) -> usize {
        let all = cards_of(model);
        let other = all.filter(|(is_stress, id)| !self.of(*is_stress).contains(id));
        let other: HashSet<u64> = other.map(|(_, id)| id).collect();
        if other.is_empty() {
            return 0;
        }
        let ids = run.shells.iter();
        let ids = ids.map(|&shell| model.shells[shell as usize].id);
        ids.filter(|id| other.contains(id)).count()
    }

    /// Cards of stresses and of strains in the deck that nothing takes the place of.
    pub(super) fn n_other_cards(&self, model: &Model) -> [usize; 2] {
        [true, false].map(|of_stress| {
            let all = cards_of(model).filter(|(is_stress, _)| *is_stress == of_stress);
            all.filter(|(_, id)| !self.of(of_stress).contains(id))
                .count()
        })
    }

    fn of(&self, is_stress: bool) -> &HashSet<u64> {
        if is_stress {
            &self.stressed
        } else {
            &self.strained
        }
    }
}

/// Every card of the deck: whether it is one of stresses, and the element.
fn cards_of(model: &Model) -> impl Iterator<Item = (bool, u64)> {
    let stresses = model.forming.stresses();
    let strains = model.forming.strains();
    let stresses = stresses.map(|card| (true, card.element_id));
    stresses.chain(strains.map(|card| (false, card.element_id)))
}

/// Decides which results of a deck are left out of its copies.
pub(super) struct LeftOut<'a> {
    model: &'a Model,
    new: &'a NewStates,
    /// Sets of which some elements have new states and some not.
    split: RefCell<Vec<u64>>,
    /// Ids of all shells of the deck, collected for the first set.
    elements: OnceCell<HashSet<u64>>,
}

impl<'a> LeftOut<'a> {
    pub(super) fn new(model: &'a Model, new: &'a NewStates) -> Self {
        Self {
            model,
            new,
            split: RefCell::default(),
            elements: OnceCell::new(),
        }
    }

    pub(super) fn leaves_out(&self, cards: &ResultCards) -> bool {
        let new = self.new.of(cards.is_stress);
        if !cards.is_of_set {
            return new.contains(&cards.id);
        }
        let members = self.model.sets.shells.get(&cards.id);
        let ids = members.map_or(&[][..], |set| &set.ids);
        let is_there = self.elements.get_or_init(|| {
            let shells = self.model.shells.iter();
            shells.map(|shell| shell.id).collect()
        });
        // A range of ids usually has gaps.
        let there = ids.iter().filter(|id| is_there.contains(id));
        let (n_there, n_new) = there.fold((0, 0), |(n, n_new), id| {
            (n + 1, n_new + usize::from(new.contains(id)))
        });
        if n_new > 0 && n_new < n_there {
            self.split.borrow_mut().push(cards.id);
        }
        n_new > 0 && n_new == n_there
    }

    /// An error if results of the file could not be left out as they should.
    pub(super) fn check(&self, file: &ReadFile, copy: &ExchangedDeck) -> Result<(), PipelineError> {
        let name = file.path.display();
        if let Some(line) = copy.unread_results {
            return Err(PipelineError::MapOutput(format!(
                "{name}, line {line}: these initial stresses or strains cannot be read and may be those of \
                 mapped elements; correct them or take them out first"
            )));
        }
        if let Some(set) = self.split.borrow().first() {
            return Err(PipelineError::MapOutput(format!(
                "{name} gives all elements of shell set {set} one initial state, and only some of them are \
                 mapped; give the others cards of their own first"
            )));
        }
        Ok(())
    }
}

/// Copies of the files of the crash deck that hold stresses or strains which the new ones take the place of,
/// without these and byte for byte else; not of the file `except`. They are to lie beside `beside`, under names
/// that are neither among `taken` nor those of files of the deck. O(bytes of the deck).
pub(super) fn copies_without_states(
    crash: &LoadedPart,
    new: &NewStates,
    [beside, except]: [&Path; 2],
    taken: &[PathBuf],
    monitor: &Monitor,
) -> Result<Vec<MapFile>, PipelineError> {
    let model = &crash.model;
    let left_out = LeftOut::new(model, new);
    let mut copies: Vec<MapFile> = Vec::new();
    let again = ReadAgain::new(crash);
    for (index, file) in model.files.iter().enumerate() {
        if file.path == except {
            continue;
        }
        let source = SourceFile::new(&file.path, again.text(file, monitor)?);
        let rules = ExchangeRules {
            included_as: file.included_as,
            list_layout: None,
            exchange_of: &|_| Exchange::Other,
            leaves_out: Some(&|cards| left_out.leaves_out(cards)),
            states: &|_| Ok(Vec::new()),
        };
        let copy = exchange_thickness(&source, &rules, monitor)?;
        left_out.check(file, &copy)?;
        if copy.n_left_out == 0 {
            continue;
        }
        let mut others = model.files.iter().enumerate();
        if others.any(|(other, twice)| other != index && twice.path == file.path) {
            return Err(PipelineError::MapOutput(format!(
                "{} holds initial states and is included several times, and its copy would change all of \
                 them",
                file.path.display()
            )));
        }
        let is_free = |path: &PathBuf| {
            let target = Target {
                name: String::new(),
                path: path.clone(),
                content: Content::Deck,
            };
            let is_taken = taken.contains(path) || copies.iter().any(|copy| copy.path == *path);
            !is_taken && overwritten_inputs(&[target], &crash.files()).is_empty()
        };
        let mut names = (1..).map(|n| copy_path(beside, &file.path, n));
        let path = names.find(is_free).unwrap_or_default();
        copies.push(MapFile {
            path,
            bytes: copy.bytes,
            replaces: Some(file.path.clone()),
            included_by: None,
            is_left_out: false,
        });
    }
    Ok(copies)
}

/// `mapped.k` and `car.k` → `mapped_car.k`, then `mapped_2_car.k`. The copy is not packed.
fn copy_path(beside: &Path, file: &Path, n: usize) -> PathBuf {
    let stem = beside.file_stem().unwrap_or_default().to_string_lossy();
    let name = file_name(file);
    let name = name.trim_end_matches(".gz");
    beside.with_file_name(match n {
        1 => format!("{stem}_{name}"),
        n => format!("{stem}_{n}_{name}"),
    })
}

/// Cards of the crash deck with which the solver maps stamped files onto the chosen parts itself, each in a
/// sentence.
pub fn mapped_by_solver(crash: &LoadedPart) -> Vec<String> {
    let ids = crash.chosen_part_ids();
    let sets = &crash.model.sets.parts;
    let told = crash.model.stamped_includes.iter().filter_map(|include| {
        let set = sets.get(&include.onto).filter(|_| include.is_set);
        let onto = if include.is_set {
            set.map_or(&[][..], |set| &set.ids)
        } else {
            std::slice::from_ref(&include.onto)
        };
        let own: Vec<u64> = onto.iter().copied().filter(|id| ids.contains(id)).collect();
        (!own.is_empty()).then(|| {
            format!(
                "{}: the crash deck lets the solver map {} onto {} too, over what is mapped here; take that \
                 card out of it",
                include.position,
                include.file,
                parts_by_id(&own)
            )
        })
    });
    told.collect()
}

/// The copies that take the place of files of a crash deck onto which several mappings were made, read back.
pub fn car_copies(
    crash: &LoadedPart,
    new: &NewStates,
    beside: &Path,
    taken: &[PathBuf],
    monitor: &Monitor,
) -> Result<Vec<MapFile>, PipelineError> {
    let mut copies = copies_without_states(crash, new, [beside, Path::new("")], taken, monitor)?;
    if let Some(read) = read_copies(crash, &copies, monitor)? {
        let found = NewStates::default().n_other_cards(&read);
        let wanted = new.n_other_cards(&crash.model);
        if found != wanted {
            return Err(PipelineError::MapOutput(format!(
                "the copies without old states read back differently: {found:?} cards of stresses and strains \
                 instead of {wanted:?}"
            )));
        }
    }
    include_copies(&mut copies, crash);
    Ok(copies)
}

/// The crash deck with the copies in the place of its files; `None` without copies.
pub(super) fn read_copies(
    crash: &LoadedPart,
    files: &[MapFile],
    monitor: &Monitor,
) -> Result<Option<Model>, PipelineError> {
    let replaced = files.iter().filter_map(|file| {
        let path = file.replaces.as_deref()?;
        Some((path, &file.bytes[..]))
    });
    let replaced: Vec<(&Path, &[u8])> = replaced.collect();
    if replaced.is_empty() {
        return Ok(None);
    }
    let again = ReadAgain::new(crash);
    let source = Replaced {
        others: again.source(),
        files: &replaced,
    };
    let read = formats::read_from(&source, &crash.path, &crash.settings.read, monitor)?;
    Ok(Some(read))
}

impl MapWriter<'_> {
    /// Elements that get a card of stresses, and elements that get one of strains.
    pub(super) fn new_states(&self) -> Result<NewStates, Cancelled> {
        // Without room for all it would grow in one long step.
        let room = || HashSet::with_capacity(self.run.shells.len());
        let mut new = NewStates {
            stressed: room(),
            strained: room(),
        };
        for_chunks(self.run.shells.len(), self.monitor, |range| {
            for state in range.map(|element| self.state_of(element)) {
                if !state.states.is_empty() {
                    new.stressed.insert(state.id);
                }
                if !state.strains.is_empty() {
                    new.strained.insert(state.id);
                }
            }
        })?;
        Ok(new)
    }
}
