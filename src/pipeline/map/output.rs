//! The mapped state as decks: an include, the part's elements, or a copy of the crash deck.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::{MapRun, PipelineError};
use crate::formats::keyword::card::Layout;
use crate::formats::keyword::exchange::{Exchange, ExchangedDeck, exchange_thickness};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::keyword::state_cards::{ShellState, StateFormat, write_states};
use crate::formats::keyword::write::{WriteOptions, write};
use crate::formats::{self, Disk, Memory, Model, ReadOptions};
use crate::mapping::{LayerRule, Status};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;
use crate::report::build_id;

/// Digits of a small card differ from the values by up to this share of the largest.
const SMALL_ROUNDING: f64 = 5.1e-4;
/// Digits of a large card differ from the values by up to this share.
const LARGE_ROUNDING: f64 = 1e-8;

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
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapOutput {
    /// Which files.
    pub kind: WriteKind,
    /// Where the first of them goes.
    pub path: PathBuf,
    /// 16 columns a number instead of 10.
    pub is_large: bool,
}

/// What was written, read back and compared.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFiles {
    /// The files with their bytes, not yet on disk.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// Elements that got a thickness.
    pub n_thickness: usize,
    /// Elements with a stress card.
    pub n_stress: usize,
    /// Elements with a strain card.
    pub n_strain: usize,
    /// Mapped elements whose thickness could not be put in, because they have plies of their own.
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
    let writer = MapWriter {
        run,
        model: &crash.model,
        is_large: output.is_large,
        thickness: thickness_by_id(run, &crash.model, crash.settings.length_factor),
        monitor,
    };
    let decks = writer.decks(crash, output.kind)?;
    let n_thickness: usize = decks.iter().map(|(_, deck)| deck.n_exchanged).sum();
    let n_composite: usize = decks.iter().map(|(_, deck)| deck.n_composite).sum();
    let n_wanted = writer.thickness.len();
    if n_thickness + n_composite < n_wanted {
        let missing = n_wanted - n_thickness - n_composite;
        return Err(PipelineError::MapOutput(format!(
            "{missing} of {n_wanted} elements are not found under their id in {}; are ids shifted by an include \
             with offsets? Write the states alone (--quantities without thickness) or map onto a deck \
             without offsets",
            crash.path.display()
        )));
    }
    let mut replaces = None;
    let head = writer.head(comments);
    let files = match output.kind {
        WriteKind::Include => writer.include(&head, &decks, &output.path)?,
        WriteKind::Part => vec![(output.path.clone(), writer.part(&head, &decks)?)],
        WriteKind::Deck => {
            let holders: Vec<&(PathBuf, ExchangedDeck)> = decks
                .iter()
                .filter(|(_, deck)| deck.n_exchanged > 0)
                .collect();
            let [(path, deck)] = holders[..] else {
                let names = holders.iter().map(|(path, _)| path.display().to_string());
                let names: Vec<String> = names.collect();
                return Err(PipelineError::MapOutput(format!(
                    "the elements stand in {} files ({}); write an include instead (--write include)",
                    names.len(),
                    names.join(", ")
                )));
            };
            replaces = Some(path.clone());
            vec![(output.path.clone(), deck.bytes.clone())]
        }
    };
    let mut files = MapFiles {
        files,
        n_thickness,
        n_stress: run
            .mapped
            .states
            .as_ref()
            .map_or(0, |states| states.n_present()),
        n_strain: run
            .mapped
            .strains
            .as_ref()
            .map_or(0, |strains| strains.n_present()),
        n_composite,
        read_back_error: 0.0,
        replaces,
    };
    files.read_back_error = writer.read_back(&files)?;
    Ok(files)
}

/// New thickness of the mapped elements in the deck's own unit, by element id.
fn thickness_by_id(run: &MapRun, model: &Model, length_factor: f64) -> HashMap<u64, f64> {
    let values = run.shells.iter().zip(&run.mapped.thickness);
    values
        .filter(|(_, thickness)| thickness.is_finite())
        .map(|(&shell, thickness)| (model.shells[shell as usize].id, thickness / length_factor))
        .collect()
}

struct MapWriter<'a> {
    run: &'a MapRun,
    model: &'a Model,
    is_large: bool,
    thickness: HashMap<u64, f64>,
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
        let of_part: HashMap<u64, ()> = self
            .run
            .shells
            .iter()
            .map(|&shell| (self.model.shells[shell as usize].id, ()))
            .collect();
        let exchange = |id: u64| match self.thickness.get(&id) {
            Some(&thickness) => Exchange::Thickness([thickness; 4]),
            None if kind == WriteKind::Part && of_part.contains_key(&id) => Exchange::Listed,
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
        for file in &crash.model.files {
            let bytes = formats::read_text(&Disk, &file.path, &crash.settings.read, self.monitor)?;
            let source = SourceFile::new(&file.path, bytes);
            let deck = exchange_thickness(&source, &exchange, &states, self.monitor)?;
            decks.push((file.path.clone(), deck));
        }
        Ok(decks)
    }

    fn head(&self, comments: &[String]) -> String {
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
        head.push_str(&format!(
            "$ elements: {}\n$ {}\n",
            words.join(", "),
            build_id()
        ));
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

    fn states(&self, layout: Layout) -> Result<Vec<u8>, Cancelled> {
        let surfaces = LayerRule::surfaces();
        let mapped = &self.run.mapped;
        let state_of = |element: usize| {
            let rule = &self.run.target.rules[self.run.target.rule_of[element] as usize];
            let strain_rule = if mapped.strains_are_at_surfaces {
                &surfaces
            } else {
                rule
            };
            ShellState {
                id: self.model.shells[self.run.shells[element] as usize].id,
                places: rule.places(),
                states: mapped
                    .states
                    .as_ref()
                    .map_or(&[][..], |states| states.of(element)),
                history: &[],
                strain_places: strain_rule.places(),
                strains: mapped
                    .strains
                    .as_ref()
                    .map_or(&[][..], |strains| strains.of(element)),
            }
        };
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
                self.read_with_nodes(bytes)?
            };
            n_stress += read.forming.n_stress();
            n_strain += read.forming.n_strain();
            largest = largest.max(self.stress_error(&read));
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

    /// Reads a file as an include of a deck that holds the crash model's nodes.
    fn read_with_nodes(&self, bytes: &[u8]) -> Result<Model, PipelineError> {
        let nodes = Model {
            nodes: self.model.nodes.clone(),
            ..Model::default()
        };
        let mut deck = write(&nodes, &WriteOptions::default(), self.monitor)?;
        deck.truncate(deck.len() - b"*END\n".len());
        deck.extend_from_slice(b"*INCLUDE\nmapped.k\n*END\n");
        let memory = Memory::new()
            .with("nodes.k", deck)
            .with("mapped.k", bytes.to_vec());
        let options = ReadOptions::default();
        let path = Path::new("nodes.k");
        Ok(formats::read_from(&memory, path, &options, self.monitor)?)
    }

    /// Largest difference of a stress or plastic strain, relative to the largest of its kind.
    fn stress_error(&self, read: &Model) -> f64 {
        let Some(states) = &self.run.mapped.states else {
            return 0.0;
        };
        let ids = self
            .run
            .shells
            .iter()
            .map(|&shell| self.model.shells[shell as usize].id);
        let element_of: HashMap<u64, usize> = ids.zip(0..).collect();
        let (mut stress, mut plastic) = ([0.0_f64; 2], [0.0_f64; 2]);
        for card in read.forming.stresses() {
            let Some(&element) = element_of.get(&card.element_id) else {
                continue;
            };
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
        relative(stress).max(relative(plastic))
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
