//! The mapped state as decks: an include, the part's elements, or a copy of the crash deck.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::compare::read_beside_nodes;
use super::{DefaultThickness, MapRun, PipelineError, PlacedPart};
use crate::formats::keyword::card::Layout;
use crate::formats::keyword::exchange::{Exchange, ExchangedDeck, exchange_thickness};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::keyword::state_cards::{ShellState, StateFormat, write_states};
use crate::formats::{self, Memory, Model, ReadOptions};
use crate::geometry::chunks::{CHUNK, for_chunks};
use crate::mapping::Status;
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;
use crate::report::build_id;

/// Digits of a small card differ from the values by up to this share of the largest.
const SMALL_ROUNDING: f64 = 5.1e-4;
/// Digits of a large card differ from the values by up to this share.
const LARGE_ROUNDING: f64 = 1e-8;

/// Where strains of the two surfaces stand.
const SURFACES: [f64; 2] = [-1.0, 1.0];

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
}

/// What was written, read back and compared.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFiles {
    /// The files with their bytes, not yet on disk.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// Elements that got a thickness.
    pub n_thickness: usize,
    /// Those of them that carry no values and got the default one.
    pub n_default: usize,
    /// Elements with a stress card.
    pub n_stress: usize,
    /// Elements with a strain card.
    pub n_strain: usize,
    /// Mapped elements that were left as they are, because they have plies of their own.
    pub n_composite: usize,
    /// Largest difference between a value and what reading the files gives, relative to the largest
    /// value of its kind.
    pub read_back_error: f64,
    /// The crash file that the deck copy replaces.
    pub replaces: Option<PathBuf>,
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
    let factor = crash.settings.length_factor;
    let mut thickness = thickness_by_id(run, &crash.model, factor, monitor)?;
    let n_mapped = thickness.len();
    for (element, value) in output.default_thickness.of(run) {
        if !is_composite(run, &crash.model, element) {
            let id = crash.model.shells[run.shells[element] as usize].id;
            thickness.insert(id, [value / factor; 4]);
        }
    }
    let n_default = thickness.len() - n_mapped;
    let writer = MapWriter {
        run,
        model: &crash.model,
        is_large: output.is_large,
        thickness,
        monitor,
    };
    let has_values = |element: &usize| run.mapped.elements[*element].status.has_values();
    let n_composite = (0..run.shells.len())
        .filter(|element| has_values(element) && is_composite(run, &crash.model, *element))
        .count();
    if output.kind == WriteKind::Part && n_composite > 0 {
        return Err(PipelineError::MapOutput(format!(
            "{n_composite} elements have plies of their own (_COMPOSITE), which a file of all elements \
             would lose; write an include or a deck instead (--write)"
        )));
    }
    let decks = writer.decks(crash, output.kind)?;
    let n_thickness: usize = decks.iter().map(|(_, deck)| deck.n_exchanged).sum();
    let n_wanted = writer.thickness.len();
    if n_thickness < n_wanted {
        let missing = n_wanted - n_thickness;
        return Err(PipelineError::MapOutput(format!(
            "{missing} of {n_wanted} elements are not found under their id in {}; are ids shifted by an include \
             with offsets? Write the states alone (--quantities without thickness) or map onto a deck \
             without offsets",
            crash.path.display()
        )));
    }
    let mut replaces = None;
    let head = writer.head(comments, n_default);
    let files = match output.kind {
        WriteKind::Include => writer.include(&head, &decks, &output.path)?,
        WriteKind::Part => vec![(output.path.clone(), writer.part(&head, &decks)?)],
        WriteKind::Deck => {
            let mut holders = decks;
            holders.retain(|(_, deck)| deck.n_exchanged > 0);
            if holders.len() != 1 {
                let names = holders.iter().map(|(path, _)| path.display().to_string());
                let names: Vec<String> = names.collect();
                return Err(PipelineError::MapOutput(format!(
                    "the elements stand in {} files ({}); write an include instead (--write include)",
                    names.len(),
                    names.join(", ")
                )));
            }
            let (path, deck) = holders.swap_remove(0);
            replaces = Some(path);
            vec![(output.path.clone(), deck.bytes)]
        }
    };
    monitor.check()?;
    let mut files = MapFiles {
        files,
        n_thickness,
        n_default,
        n_stress: writer.count(|state| !state.states.is_empty()),
        n_strain: writer.count(|state| !state.strains.is_empty()),
        n_composite,
        read_back_error: 0.0,
        replaces,
    };
    files.read_back_error = writer.read_back(&files)?;
    Ok(files)
}

/// What decks say of where their values come from: the files, and the pose of each stamped part.
pub fn deck_comments(crash: &LoadedPart, placed: &[PlacedPart<'_>]) -> Vec<String> {
    let mut lines = vec![format!("forming results mapped onto {}", crash.file_name())];
    for placed in placed {
        lines.push(format!(
            "from {}, crash = c R stamped + t with rows:",
            placed.part.file_name()
        ));
        for row in placed.crash_from_stamped.to_rows() {
            lines.push(format!("  {} {} {} {}", row[0], row[1], row[2], row[3]));
        }
        let factor = placed.part.settings.length_factor;
        if factor != 1.0 {
            lines.push(format!("  its lengths multiplied by {factor}"));
        }
    }
    lines
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

/// True if an element has plies, which are its layers, whatever its section says.
fn is_composite(run: &MapRun, model: &Model, element: usize) -> bool {
    let extra = model.shell_extra(run.shells[element]);
    extra.is_some_and(|extra| extra.n_plies > 0)
}

struct MapWriter<'a> {
    run: &'a MapRun,
    model: &'a Model,
    is_large: bool,
    thickness: HashMap<u64, [f64; 4]>,
    monitor: &'a Monitor,
}

impl MapWriter<'_> {
    /// Every file of the crash deck with its elements exchanged; none if there is no thickness to put in
    /// and no copy is asked for.
    fn decks(
        &self,
        crash: &LoadedPart,
        kind: WriteKind,
    ) -> Result<Vec<(PathBuf, ExchangedDeck)>, PipelineError> {
        if self.thickness.is_empty() && kind == WriteKind::Include {
            return Ok(Vec::new());
        }
        // A file of all elements has those without values too.
        let of_part = if kind == WriteKind::Part {
            self.elements_by_id()?
        } else {
            HashMap::new()
        };
        let exchange = |id: u64| match self.thickness.get(&id) {
            Some(&thickness) => Exchange::Thickness(thickness),
            None if of_part.contains_key(&id) => Exchange::Listed,
            None => Exchange::Other,
        };
        let states = |layout| -> Result<Vec<u8>, Cancelled> {
            if kind == WriteKind::Deck {
                self.states(layout)
            } else {
                Ok(Vec::new())
            }
        };
        let mut decks = Vec::new();
        let from = crash.file_source();
        for file in &crash.model.files {
            let bytes = formats::read_text(&*from, &file.path, &crash.settings.read, self.monitor)?;
            let source = SourceFile::new(&file.path, bytes);
            let deck = exchange_thickness(&source, &exchange, &states, self.monitor)?;
            decks.push((file.path.clone(), deck));
        }
        Ok(decks)
    }

    /// The number of each element in the run by its id in the deck.
    fn elements_by_id(&self) -> Result<HashMap<u64, usize>, Cancelled> {
        let shells = &self.run.shells;
        let mut by_id = HashMap::with_capacity(shells.len());
        for_chunks(shells.len(), self.monitor, |range| {
            by_id.extend(range.map(|n| (self.model.shells[shells[n] as usize].id, n)));
        })?;
        Ok(by_id)
    }

    fn head(&self, comments: &[String], n_default: usize) -> String {
        let mut head = String::new();
        for line in comments.iter().flat_map(|comment| comment.lines()) {
            head.push_str(&format!("$ {line}\n"));
        }
        let counts = self.run.mapped.counts();
        let words = Status::ALL
            .iter()
            .zip(counts)
            .filter(|(_, count)| *count > 0);
        let words: Vec<String> = words
            .map(|(status, n)| format!("{n} {}", status.label()))
            .collect();
        head.push_str(&format!("$ elements: {}\n", words.join(", ")));
        if n_default > 0 {
            head.push_str(&format!(
                "$ {n_default} of them carry no values and have the default thickness\n"
            ));
        }
        head.push_str(&format!("$ {}\n", build_id()));
        head
    }

    fn include(
        &self,
        head: &str,
        decks: &[(PathBuf, ExchangedDeck)],
        path: &Path,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, PipelineError> {
        let layout = decks.first().map_or(self.layout(), |(_, deck)| deck.layout);
        let mut states = keyword_line(layout).into_bytes();
        states.extend_from_slice(head.as_bytes());
        let beside = elements_path(path);
        if !self.thickness.is_empty() {
            let name = beside.file_name().unwrap_or_default().to_string_lossy();
            let hint = format!(
                "$ The thickness of the elements is in {name}: include it too and take the same elements\n\
                 $ out of the crash deck, because the card defines them anew.\n"
            );
            states.extend_from_slice(hint.as_bytes());
        }
        states.extend_from_slice(&self.states(layout)?);
        states.extend_from_slice(b"*END\n");
        let mut files = vec![(path.to_path_buf(), states)];
        if !self.thickness.is_empty() {
            files.push((beside, self.elements(head, decks)));
        }
        Ok(files)
    }

    fn part(
        &self,
        head: &str,
        decks: &[(PathBuf, ExchangedDeck)],
    ) -> Result<Vec<u8>, PipelineError> {
        let layout = decks.first().map_or(self.layout(), |(_, deck)| deck.layout);
        let mut text = self.elements(head, decks);
        text.truncate(text.len() - b"*END\n".len());
        text.extend_from_slice(&self.states(layout)?);
        text.extend_from_slice(b"*END\n");
        Ok(text)
    }

    fn elements(&self, head: &str, decks: &[(PathBuf, ExchangedDeck)]) -> Vec<u8> {
        let layout = decks.first().map_or(self.layout(), |(_, deck)| deck.layout);
        let mut text = keyword_line(layout).into_bytes();
        text.extend_from_slice(head.as_bytes());
        for (_, deck) in decks {
            text.extend_from_slice(&deck.elements);
        }
        text.extend_from_slice(b"*END\n");
        text
    }

    /// The narrowest layout that holds the ids.
    fn layout(&self) -> Layout {
        let ids = self
            .run
            .shells
            .iter()
            .map(|&shell| self.model.shells[shell as usize].id);
        match ids.max().unwrap_or(0) {
            0..=99_999_999 => Layout::Standard,
            100_000_000..=9_999_999_999 => Layout::I10,
            _ => Layout::Long,
        }
    }

    /// What is written for an element; no values for one that has plies of its own.
    fn state_of(&self, element: usize) -> ShellState<'_> {
        let mapped = &self.run.mapped;
        let rule = &self.run.target.rules[self.run.target.rule_of[element] as usize];
        let strain_places = if mapped.strains_are_at_surfaces {
            &SURFACES[..]
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
        if is_composite(self.run, self.model, element) {
            return state;
        }
        if let Some(states) = &mapped.states {
            state.states = states.of(element);
        }
        if let Some(history) = &mapped.history {
            let kept = history.of(element);
            (state.history, state.tensors) = (kept.values, kept.tensors);
        }
        if let Some(strains) = &mapped.strains {
            state.strains = strains.of(element);
        }
        state
    }

    fn count(&self, has: impl Fn(&ShellState<'_>) -> bool) -> usize {
        let all = 0..self.run.shells.len();
        all.filter(|&element| has(&self.state_of(element))).count()
    }

    fn states(&self, layout: Layout) -> Result<Vec<u8>, Cancelled> {
        let state_of = |element: usize| self.state_of(element);
        let format = StateFormat {
            layout,
            is_large: self.is_large,
        };
        write_states(self.run.shells.len(), state_of, format, self.monitor)
    }

    /// Reads the states back and compares counts and values.
    fn read_back(&self, files: &MapFiles) -> Result<f64, PipelineError> {
        let failed = |what: String| {
            PipelineError::MapOutput(format!("the written state reads back differently: {what}"))
        };
        let mut largest = 0.0_f64;
        let mut n_stress = 0;
        let mut n_strain = 0;
        let mut n_thickness = 0;
        for (path, bytes) in &files.files {
            let read = if files.replaces.is_some() {
                let memory = Memory::new().with(path, bytes.clone());
                formats::read_from(&memory, path, &ReadOptions::default(), self.monitor)?
            } else {
                read_beside_nodes(self.model, bytes, self.monitor)?
            };
            n_stress += read.forming.n_stress();
            n_strain += read.forming.n_strain();
            largest = largest.max(self.stress_error(&read)?);
            if files.replaces.is_none() {
                n_thickness += read.shell_extras.len();
            }
        }
        let kept = if files.replaces.is_some() {
            self.model.forming.n_stress()
        } else {
            0
        };
        if n_stress < files.n_stress || n_stress > files.n_stress + kept {
            return Err(failed(format!(
                "{n_stress} stress cards instead of {}",
                files.n_stress
            )));
        }
        let kept = if files.replaces.is_some() {
            self.model.forming.n_strain()
        } else {
            0
        };
        if n_strain < files.n_strain || n_strain > files.n_strain + kept {
            return Err(failed(format!(
                "{n_strain} strain cards instead of {}",
                files.n_strain
            )));
        }
        if files.replaces.is_none() && n_thickness < files.n_thickness {
            let wanted = files.n_thickness;
            return Err(failed(format!(
                "{n_thickness} thicknesses instead of {wanted}"
            )));
        }
        let limit = if self.is_large {
            LARGE_ROUNDING
        } else {
            SMALL_ROUNDING
        };
        if largest > limit {
            return Err(failed(format!(
                "a value is off by {largest:.1e} of the largest"
            )));
        }
        Ok(largest)
    }

    /// Largest difference of a stress or plastic strain, relative to the largest of its kind.
    fn stress_error(&self, read: &Model) -> Result<f64, Cancelled> {
        let Some(states) = &self.run.mapped.states else {
            return Ok(0.0);
        };
        let element_of = self.elements_by_id()?;
        let (mut stress, mut plastic) = ([0.0_f64; 2], [0.0_f64; 2]);
        let (mut values, mut tensors) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (n_before, card) in read.forming.stresses().enumerate() {
            if n_before % CHUNK == 0 {
                self.monitor.check()?;
            }
            let Some(&element) = element_of.get(&card.element_id) else {
                continue;
            };
            let kept = self.state_of(element);
            let n_plane = card.n_plane.max(1);
            compare(
                &mut values,
                kept.history,
                card.n_history,
                n_plane,
                card.history,
            );
            let n_tensor = 6 * card.n_tensors;
            let read = card.tensors.as_flattened();
            compare(
                &mut tensors,
                kept.tensors.as_flattened(),
                n_tensor,
                n_plane,
                read,
            );
            for (own, point) in states.of(element).iter().zip(card.points) {
                for (a, b) in own[..6].iter().zip(point.stress) {
                    stress = [stress[0].max((a - b).abs()), stress[1].max(a.abs())];
                }
                let difference = (own[6] - point.plastic_strain).abs();
                plastic = [plastic[0].max(difference), plastic[1].max(own[6].abs())];
            }
        }
        let relative =
            |[difference, size]: [f64; 2]| if size > 0.0 { difference / size } else { 0.0 };
        let kinds = [stress, plastic, values, tensors].map(relative);
        Ok(kinds.into_iter().fold(0.0, f64::max))
    }
}

/// Largest difference and largest value of what each layer has `n` of, against what was read for each
/// of its `n_plane` points. A wrong number of values is a difference without bound.
fn compare(largest: &mut [f64; 2], own: &[f64], n: usize, n_plane: usize, read: &[f64]) {
    if own.len() * n_plane != read.len() {
        largest[0] = f64::INFINITY;
        return;
    }
    let layers = own.chunks(n.max(1)).zip(read.chunks((n * n_plane).max(1)));
    for (own, points) in layers {
        for (a, b) in points
            .chunks(n.max(1))
            .flat_map(|point| own.iter().zip(point))
        {
            *largest = [largest[0].max((a - b).abs()), largest[1].max(a.abs())];
        }
    }
}

fn keyword_line(layout: Layout) -> String {
    match layout {
        Layout::Standard => "*KEYWORD\n".to_owned(),
        Layout::I10 => "*KEYWORD I10=Y\n".to_owned(),
        Layout::Long => "*KEYWORD LONG=Y\n".to_owned(),
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
