//! The mapped state as decks: an include, the part's elements, or a copy of the crash deck.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::includes::{include_copies, lost_includes};
use super::old_states::{LeftOut, NewStates, copies_without_states};
use super::{DefaultThickness, MapRun, PipelineError};
use crate::formats::Model;
use crate::formats::keyword::card::Layout;
use crate::formats::keyword::exchange::{
    Exchange, ExchangeRules, ExchangedDeck, ResultCards, exchange_thickness,
};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::keyword::state_cards::{Pieces, ShellState, StateFormat, write_states};
use crate::formats::keyword::write::keyword_line;
use crate::formats::model::{IncludedAs, ReadFile};
use crate::geometry::chunks::for_chunks;
use crate::mapping::LayerRule;
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::names::file_name;
use crate::pipeline::read_again::ReadAgain;
use crate::text::counted;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WriteKind {
    /// Stresses and strains as an include, and the elements with their thickness in a second file
    /// that takes the place of theirs.
    #[default]
    Include,
    /// One file with all elements of the part, the mapped ones with their thickness, and the states.
    Part,
    /// A copy of the file that holds the elements, with thickness and states put in and everything else
    /// byte for byte.
    Deck,
}

impl WriteKind {
    /// Every kind, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Include, Self::Part, Self::Deck];

    /// The word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Include => "include",
            Self::Part => "part",
            Self::Deck => "deck",
        }
    }
}

/// How the mapped state is written.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOutput {
    /// Include, part or whole deck.
    pub kind: WriteKind,
    /// Where the first of them goes.
    pub path: PathBuf,
    /// 16 columns a number instead of 10.
    pub is_large: bool,
    /// Thickness of the elements without values.
    pub default_thickness: DefaultThickness,
    /// Where old states are replaced: whether files of the crash deck are copied without them, which the
    /// caller does else.
    pub has_copies: bool,
}

/// One of the files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapFile {
    /// Where it goes.
    pub path: PathBuf,
    /// What it holds.
    pub bytes: Vec<u8>,
    /// The crash file that it is a copy of, whose place it takes.
    pub replaces: Option<PathBuf>,
    /// The written file that includes it in the place of that one.
    pub included_by: Option<PathBuf>,
    /// The deck includes the old file still.
    pub is_left_out: bool,
}

impl MapFile {
    /// Says whose place it takes, and what is left to do so that it does; `None` for a file that is none of
    /// the deck's.
    pub fn place_taken(&self) -> Option<String> {
        let replaced = file_name(self.replaces.as_ref()?);
        Some(match &self.included_by {
            Some(by) => format!("{} includes it instead of {replaced}", file_name(by)),
            None if self.is_left_out => format!("to be included instead of {replaced}"),
            None => format!("to be used instead of {replaced}"),
        })
    }
}

/// What was written, read back and compared.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFiles {
    /// The files, not yet on disk.
    pub files: Vec<MapFile>,
    /// Elements that got a thickness.
    pub n_thickness: usize,
    /// Those of them that carry no values and got the default one.
    pub n_default: usize,
    /// Elements with a stress card.
    pub n_stress: usize,
    /// Elements with a strain card.
    pub n_strain: usize,
    /// Mapped elements that keep their thickness, because they have plies of their own.
    pub n_composite: usize,
    /// Largest difference between a value and what reading the files gives, relative to the largest
    /// value of its kind.
    pub read_back_error: f64,
    /// Elements with cards of stresses or strains, of which the crash deck has some already.
    pub n_old_states: usize,
    /// Elements that have some in the crash deck and keep them, because none are mapped onto them.
    pub n_kept_states: usize,
    /// Elements with cards of stresses or strains.
    pub new_states: NewStates,
    /// Says which files a copy includes that are not found from where it goes.
    pub lost_includes: Option<String>,
}

/// Makes the files and reads them back. Nothing is written to disk here. An error if an element of the
/// mapping is not found in the crash deck, if the elements of a deck copy stand in several files, or
/// if the files read back differently.
pub fn write_mapping(
    run: &MapRun,
    crash: &LoadedPart,
    output: &MapOutput,
    comments: &[String],
    monitor: &Monitor,
) -> Result<MapFiles, PipelineError> {
    check_ids(run, &crash.model, monitor)?;
    let factor = crash.settings.length_factor;
    let mut thickness = thickness_by_id(run, &crash.model, factor, monitor)?;
    let n_mapped = thickness.len();
    for (element, value) in output.default_thickness.of(run, monitor)? {
        if !is_composite(run, &crash.model, element) {
            let id = crash.model.shells[run.shells[element] as usize].id;
            thickness.insert(id, [value / factor; 4]);
        }
    }
    let n_default = thickness.len() - n_mapped;
    let writer = MapWriter {
        run,
        crash,
        model: &crash.model,
        is_large: output.is_large,
        thickness,
        monitor,
    };
    let n_composite = writer.n_composite()?;
    if output.kind == WriteKind::Part && n_composite > 0 {
        return Err(PipelineError::MapOutput(format!(
            "a file of all elements would lose the plies of {} (_COMPOSITE); write an include or a \
             deck instead (--write)",
            counted(n_composite, "element")
        )));
    }
    let new_states = writer.new_states()?;
    let decks = writer.decks(output.kind, &new_states)?;
    let n_thickness: usize = decks.iter().map(|(_, deck)| deck.n_exchanged).sum();
    writer.check_elements(&decks, output.kind)?;
    let parameters = decks.iter().map(|(_, deck)| deck);
    let parameters = parameters.filter(|deck| !deck.parameters.is_empty());
    let parameters: Vec<Vec<u8>> = parameters
        .map(|deck| [keyword_line(deck.layout).as_bytes(), &deck.parameters].concat())
        .collect();
    let n_old_states = new_states.n_old(&crash.model);
    let head = writer.head(comments, n_default, n_old_states);
    let mut holder = PathBuf::new();
    let mut files = match output.kind {
        WriteKind::Include => writer.include(&head, &decks, &output.path)?,
        WriteKind::Part => vec![new_file(&output.path, writer.part(&head, &decks)?)],
        WriteKind::Deck => {
            let copy = writer.copy(decks, &output.path, n_old_states)?;
            holder = copy.replaces.clone().unwrap_or_default();
            vec![copy]
        }
    };
    if writer.replaces_states() && (output.has_copies || output.kind == WriteKind::Deck) {
        let taken: Vec<PathBuf> = files.iter().map(|file| file.path.clone()).collect();
        let places = [&*output.path, &*holder];
        files.extend(copies_without_states(
            crash,
            &new_states,
            places,
            &taken,
            monitor,
        )?);
    }
    monitor.check()?;
    let mut files = MapFiles {
        files,
        n_thickness,
        n_default,
        n_stress: new_states.stressed.len(),
        n_strain: new_states.strained.len(),
        n_composite,
        read_back_error: 0.0,
        n_old_states,
        n_kept_states: new_states.n_kept(run, &crash.model),
        new_states,
        lost_includes: None,
    };
    files.read_back_error = writer.read_back(&files, output.kind, &parameters)?;
    // Read back under the old names.
    include_copies(&mut files.files, crash);
    files.lost_includes = lost_includes(&mut files.files, crash, monitor)?;
    Ok(files)
}

/// Results are written for ids, so none may stand for two elements.
fn check_ids(run: &MapRun, model: &Model, monitor: &Monitor) -> Result<(), PipelineError> {
    let id_of = |element: usize| model.shells[run.shells[element] as usize].id;
    let mut known = HashSet::with_capacity(run.shells.len());
    let mut twice = None;
    for_chunks(run.shells.len(), monitor, |range| {
        twice = twice.or_else(|| range.map(id_of).find(|id| !known.insert(*id)));
    })?;
    match twice {
        Some(id) => Err(PipelineError::MapOutput(format!(
            "shell {id} is defined twice among the elements that are mapped onto; give each an id of its own in \
             the crash deck"
        ))),
        None => Ok(()),
    }
}

/// A file that is none of the deck's.
fn new_file(path: &Path, bytes: Vec<u8>) -> MapFile {
    MapFile {
        path: path.to_path_buf(),
        bytes,
        replaces: None,
        included_by: None,
        is_left_out: false,
    }
}

/// New corner thicknesses of the mapped elements in the deck's own unit, by element id.
fn thickness_by_id(
    run: &MapRun,
    model: &Model,
    length_factor: f64,
    monitor: &Monitor,
) -> Result<HashMap<u64, [f64; 4]>, Cancelled> {
    let corners = |element: usize, mean: f64| {
        let own = run.mapped.corners.get(element).copied();
        own.unwrap_or([mean; 4]).map(|t| t / length_factor)
    };
    let means = &run.mapped.thickness;
    let mut by_id = HashMap::with_capacity(means.len());
    for_chunks(means.len(), monitor, |range| {
        for element in range {
            let mean = means[element];
            if mean.is_finite() && !is_composite(run, model, element) {
                let id = model.shells[run.shells[element] as usize].id;
                by_id.insert(id, corners(element, mean));
            }
        }
    })?;
    Ok(by_id)
}

/// True if an element has plies, whose thicknesses are its own.
fn is_composite(run: &MapRun, model: &Model, element: usize) -> bool {
    let extra = model.shell_extra(run.shells[element]);
    extra.is_some_and(|extra| extra.plies.is_some())
}

pub(super) struct MapWriter<'a> {
    pub(super) run: &'a MapRun,
    pub(super) crash: &'a LoadedPart,
    pub(super) model: &'a Model,
    pub(super) is_large: bool,
    pub(super) thickness: HashMap<u64, [f64; 4]>,
    pub(super) monitor: &'a Monitor,
}

impl MapWriter<'_> {
    /// Every file of the crash deck with its elements exchanged; none if there is no thickness to put in
    /// and no copy is asked for.
    fn decks(
        &self,
        kind: WriteKind,
        new_states: &NewStates,
    ) -> Result<Vec<(&ReadFile, ExchangedDeck)>, PipelineError> {
        if self.thickness.is_empty() && kind == WriteKind::Include {
            return Ok(Vec::new());
        }
        // A file of all elements has those without values too, and a copy without thickness is that of
        // the file with the elements.
        let of_part = if kind == WriteKind::Part || self.thickness.is_empty() {
            self.elements_by_id()?
        } else {
            HashMap::new()
        };
        let exchange_of = |id: u64| match self.thickness.get(&id) {
            Some(&thickness) => Exchange::Thickness(thickness),
            None if of_part.contains_key(&id) => Exchange::Listed,
            None => Exchange::Other,
        };
        let left_out = LeftOut::new(self.model, new_states);
        let leaves_out: &dyn Fn(&ResultCards) -> bool = &|cards| left_out.leaves_out(cards);
        let mut decks: Vec<(&ReadFile, ExchangedDeck)> = Vec::new();
        let again = ReadAgain::new(self.crash);
        for file in &self.model.files {
            let source = SourceFile::new(&file.path, again.text(file, self.monitor)?);
            // Of a copy only the file with the elements is kept.
            let states = |found: &ExchangedDeck| -> Result<Pieces, Cancelled> {
                if kind == WriteKind::Deck && found.n_found > 0 {
                    self.states(found.layout, &file.included_as)
                } else {
                    Ok(Vec::new())
                }
            };
            let rules = ExchangeRules {
                included_as: file.included_as,
                list_layout: decks.first().map(|(_, first)| first.layout),
                exchange_of: &exchange_of,
                leaves_out: (kind == WriteKind::Deck && self.replaces_states())
                    .then_some(leaves_out),
                states: &states,
            };
            let deck = exchange_thickness(&source, &rules, self.monitor)?;
            left_out.check(file, &deck)?;
            decks.push((file, deck));
        }
        Ok(decks)
    }

    /// The copy of the file that holds the elements.
    fn copy(
        &self,
        mut holders: Vec<(&ReadFile, ExchangedDeck)>,
        path: &Path,
        n_old: usize,
    ) -> Result<MapFile, PipelineError> {
        holders.retain(|(_, deck)| deck.n_found > 0);
        if holders.len() != 1 {
            let names = holders
                .iter()
                .map(|(file, _)| file.path.display().to_string());
            let names: Vec<String> = names.collect();
            return Err(PipelineError::MapOutput(format!(
                "the elements stand in {} files ({}); write an include instead (--write include)",
                names.len(),
                names.join(", ")
            )));
        }
        let (file, deck) = holders.swap_remove(0);
        self.check_copy(file, n_old)?;
        Ok(MapFile {
            replaces: Some(file.path.clone()),
            ..new_file(path, deck.bytes)
        })
    }

    /// Every element must be found in the deck, and those that are listed beside it must be known.
    fn check_elements(
        &self,
        decks: &[(&ReadFile, ExchangedDeck)],
        kind: WriteKind,
    ) -> Result<(), PipelineError> {
        let has_cards = decks.iter().any(|(_, deck)| deck.n_found > 0);
        if !has_cards && (kind == WriteKind::Deck || !self.thickness.is_empty()) {
            return Err(PipelineError::MapOutput(format!(
                "{} holds no cards of the elements, as LS-DYNA decks have them, so none can be written; the \
                 mapping comes as a table and as a report too (--csv, --report)",
                self.crash.path.display()
            )));
        }
        let n_found: usize = decks.iter().map(|(_, deck)| deck.n_exchanged).sum();
        let n_wanted = self.thickness.len();
        if n_found > n_wanted {
            return Err(PipelineError::MapOutput(format!(
                "{} defines elements that are mapped onto more than once ({} too many); leave one card of each",
                self.crash.path.display(),
                counted(n_found - n_wanted, "card")
            )));
        }
        if n_found < n_wanted {
            let missing = n_wanted - n_found;
            return Err(PipelineError::MapOutput(format!(
                "{missing} of {} not found in {}, because the cards hold parameters or cannot be read; \
                 write the states alone (--quantities without thickness)",
                counted(n_wanted, "element"),
                self.crash.path.display()
            )));
        }
        let n_unlisted: usize = decks.iter().map(|(_, deck)| deck.n_unlisted).sum();
        if kind != WriteKind::Deck && n_unlisted > 0 {
            return Err(PipelineError::MapOutput(format!(
                "{} cannot be listed outside of the file that holds the cards, because *INCLUDE_TRANSFORM \
                 changes numbers of further cards or gives them more than ten digits; write a copy of that \
                 file (--write deck)",
                counted(n_unlisted, "element")
            )));
        }
        Ok(())
    }

    /// The number of each element in the run by its id in the deck.
    pub(super) fn elements_by_id(&self) -> Result<HashMap<u64, usize>, Cancelled> {
        let shells = &self.run.shells;
        let mut by_id = HashMap::with_capacity(shells.len());
        for_chunks(shells.len(), self.monitor, |range| {
            by_id.extend(range.map(|n| (self.model.shells[shells[n] as usize].id, n)));
        })?;
        Ok(by_id)
    }

    /// True if old states of the elements are left out of copies of the crash deck's files.
    pub(super) fn replaces_states(&self) -> bool {
        self.run.recipe.options.replace_states
    }

    /// That of the cards that define the elements anew, or that of the crash deck where none are.
    fn include_layout(&self, decks: &[(&ReadFile, ExchangedDeck)]) -> Layout {
        let of_cards = decks.first().map(|(_, deck)| deck.layout);
        of_cards.unwrap_or_else(|| self.model.layout_of_include())
    }

    fn include(
        &self,
        head: &str,
        decks: &[(&ReadFile, ExchangedDeck)],
        path: &Path,
    ) -> Result<Vec<MapFile>, PipelineError> {
        let layout = self.include_layout(decks);
        let mut cards = Vec::new();
        self.add_states(&mut cards, layout)?;
        if cards.is_empty() && self.thickness.is_empty() {
            return Err(PipelineError::NothingToWrite);
        }
        if cards.is_empty() {
            return Ok(vec![new_file(path, self.elements(head, decks))]);
        }
        let mut states = keyword_line(layout).as_bytes().to_vec();
        states.extend_from_slice(head.as_bytes());
        let beside = elements_path(path);
        if !self.thickness.is_empty() {
            let name = file_name(&beside);
            let hint = format!(
                "$ The thickness of the elements is in {name}: include it too and take the same elements\n\
                 $ out of the crash deck, because the card defines them anew.\n"
            );
            states.extend_from_slice(hint.as_bytes());
        }
        states.append(&mut cards);
        states.extend_from_slice(b"*END\n");
        let mut files = vec![new_file(path, states)];
        if !self.thickness.is_empty() {
            files.push(new_file(&beside, self.elements(head, decks)));
        }
        Ok(files)
    }

    fn part(
        &self,
        head: &str,
        decks: &[(&ReadFile, ExchangedDeck)],
    ) -> Result<Vec<u8>, PipelineError> {
        let layout = self.include_layout(decks);
        let mut text = self.elements(head, decks);
        text.truncate(text.len() - b"*END\n".len());
        self.add_states(&mut text, layout)?;
        text.extend_from_slice(b"*END\n");
        Ok(text)
    }

    fn elements(&self, head: &str, decks: &[(&ReadFile, ExchangedDeck)]) -> Vec<u8> {
        let layout = self.include_layout(decks);
        let mut text = keyword_line(layout).as_bytes().to_vec();
        text.extend_from_slice(head.as_bytes());
        for (_, deck) in decks {
            text.extend_from_slice(&deck.elements);
        }
        text.extend_from_slice(b"*END\n");
        text
    }

    /// What is written for an element.
    pub(super) fn state_of(&self, element: usize) -> ShellState<'_> {
        let mapped = &self.run.mapped;
        let rule = &self.run.target.rules[self.run.target.rule_of[element] as usize];
        let strain_places = if mapped.strains_are_at_surfaces {
            &LayerRule::SURFACES[..]
        } else {
            rule.places()
        };
        let mut state = ShellState {
            id: self.model.shells[self.run.shells[element] as usize].id,
            places: rule.places(),
            states: &[],
            history: &[],
            tensors: &[],
            strain_places,
            strains: &[],
        };
        if let Some(history) = &mapped.history {
            let kept = history.of(element);
            (state.history, state.tensors) = (kept.values, kept.tensors);
        }
        let wanted = self.run.recipe.options.quantities;
        let has_history = !state.history.is_empty() || !state.tensors.is_empty();
        // History variables need a card, whose other values are zeros where nothing else was asked for.
        if (wanted.stress || wanted.plastic_strain || has_history)
            && let Some(states) = &mapped.states
        {
            state.states = states.of(element);
        }
        if let Some(strains) = &mapped.strains {
            state.strains = strains.of(element);
        }
        state
    }

    /// Elements with a mapped thickness but plies, whose thicknesses stay.
    fn n_composite(&self) -> Result<usize, Cancelled> {
        let mut n = 0;
        for_chunks(self.run.shells.len(), self.monitor, |range| {
            let is_left = |&element: &usize| {
                self.run.mapped.elements[element].status.has_values()
                    && is_composite(self.run, self.model, element)
            };
            n += range.filter(is_left).count();
        })?;
        Ok(n)
    }

    /// Adds the cards to a file that nothing includes.
    fn add_states(&self, text: &mut Vec<u8>, layout: Layout) -> Result<(), Cancelled> {
        for piece in self.states(layout, &IncludedAs::default())? {
            self.monitor.check()?;
            text.extend_from_slice(&piece);
        }
        Ok(())
    }

    /// The cards as they stand in a file of the deck.
    fn states(&self, layout: Layout, file: &IncludedAs) -> Result<Pieces, Cancelled> {
        let state_of = |element: usize| {
            let state = self.state_of(element);
            let id = state
                .id
                .saturating_add_signed(file.element_offset.saturating_neg());
            ShellState { id, ..state }
        };
        let format = StateFormat {
            layout,
            is_large: self.is_large,
        };
        write_states(self.run.shells.len(), state_of, format, self.monitor)
    }
}

/// `mapped.k` → `mapped_elements.k`.
pub fn elements_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = match path.extension() {
        Some(extension) => format!("{stem}_elements.{}", extension.to_string_lossy()),
        None => format!("{stem}_elements"),
    };
    path.with_file_name(name)
}
