//! Puts together what the blocks of a deck hold: ids become indices, includes are moved, parts get
//! their thickness, and what does not fit is reported with its place.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::Arc;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position};
use super::super::model::{
    Material, Part, RawTitles, ReadFile, Section, Shell, ShellControl, ShellExtra, Solid,
    StampedInclude,
};
use super::block::Block;
use super::card::Layout;
use super::forming::RawForming;
use super::include::Context;
use super::nodes::{NodeChunk, NodeThickness, find_node};
use super::parts::RawPart;
use super::results::FormingCount;
use super::sets::RawSet;
use super::shells::{ElementOffsets, PackedIds, PartIds, ShellChunk, ShellOffsets, find_element};
use super::solids::{RawSolid, SolidChunk};
use super::source_file::{Place, SourceFile};
use super::transform::Transformation;
use super::unit_clues::UnitClues;
use crate::geometry::Point3;

/// Where a run of nodes or elements comes from, so that a diagnostic can name its line.
#[derive(Clone)]
pub(crate) struct Origin {
    file: Arc<SourceFile>,
    range: Range<usize>,
    layout: Layout,
    elements: ElementOffsets,
    /// Where the block ends of which the run is a piece.
    block_end: usize,
    has_encrypted: bool,
    /// Index of the run's first node or element.
    first: usize,
}

impl Origin {
    pub(crate) fn new(file: &Arc<SourceFile>, block: &Block<'_>, context: &Context) -> Self {
        Self {
            file: file.clone(),
            range: block.body.clone(),
            layout: block.layout,
            elements: context.elements(),
            block_end: block.body.end,
            has_encrypted: block.has_encrypted,
            first: 0,
        }
    }

    /// The same for a piece of the block.
    pub(crate) fn of(&self, range: Range<usize>) -> Self {
        Self {
            range,
            ..self.clone()
        }
    }

    /// How many more there will be in the block if it goes on as in this run, which has `n`.
    fn n_expected(&self, n: usize) -> usize {
        let rest = self.block_end.saturating_sub(self.range.start);
        // One in fifty more than that, so that the estimate does not fail by a hair.
        let n = (n as f64 * rest as f64 / self.range.len().max(1) as f64 * 1.02).ceil();
        n as usize
    }

    fn block(&self) -> Block<'_> {
        Block {
            file: &self.file,
            name: String::new(),
            remark: b"",
            suffix: None,
            layout: self.layout,
            offset: self.range.start,
            body: self.range.clone(),
            has_encrypted: self.has_encrypted,
            parameters: None,
        }
    }

    /// The line of a node; that of the run's first line if the node's own uses parameters.
    fn node(&self, id: u64) -> Position {
        let found = find_node(&self.block(), self.range.clone(), id, self.elements.node);
        self.file.position(found.unwrap_or(self.range.start))
    }

    fn element(&self, id: u64, part: u64) -> Position {
        let range = self.range.clone();
        let found = find_element(&self.block(), range, id, part, &self.elements);
        self.file.position(found.unwrap_or(self.range.start))
    }
}

/// Makes room for the rest of a block at once: doubling would copy and hold up to twice as much.
fn make_room<T>(list: &mut Vec<T>, n: usize, n_expected: usize) {
    if list.capacity() - list.len() < n {
        list.reserve(n_expected.max(n));
    }
}

/// The origin of the node or element at `index`.
fn origin_of(origins: &[Origin], index: usize) -> Option<&Origin> {
    let after = origins.partition_point(|origin| origin.first <= index);
    origins[..after].last()
}

/// A motion of nodes, carried out when all files are read, in the order of this list.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Motion {
    /// A unit factor on the coordinates of a file and those it includes.
    Scale {
        nodes: Range<usize>,
        factor: f64,
        position: Position,
    },
    /// The transformation of an include.
    Include {
        nodes: Range<usize>,
        /// The shells and the solids, by their number, and the forming results in the file and those it includes.
        shells: Range<usize>,
        solids: Range<usize>,
        results: Range<FormingCount>,
        /// The file and those it includes.
        files: Range<usize>,
        transformation: u64,
        position: Position,
    },
    /// `*NODE_TRANSFORM`.
    NodeSet {
        set: u64,
        /// How many nodes were read before, if only these are moved, and at once; all motions of
        /// includes come first otherwise.
        at_once: Option<usize>,
        transformation: u64,
        position: Position,
    },
}

/// Everything that was read so far, with ids.
#[derive(Default)]
pub(crate) struct Assembly {
    /// Width of fields of the file that was asked for, behind its last `*KEYWORD` line.
    pub layout: Layout,
    pub title: String,
    /// The bytes of titles that are not written back as they are shown.
    pub raw_titles: RawTitles,
    pub files: Vec<ReadFile>,
    pub found: Diagnostics,
    pub unit_clues: UnitClues,
    pub forming: RawForming,
    pub(super) sections: Vec<Section>,
    section_places: HashMap<u64, (usize, Place)>,
    pub materials: Vec<Material>,
    pub shell_control: ShellControl,
    pub offsets: ShellOffsets,
    pub sets: Vec<(Arc<SourceFile>, RawSet)>,
    pub(super) transformations: BTreeMap<u64, (Transformation, Place)>,
    pub node_thickness: Vec<NodeThickness>,
    pub stamped_includes: Vec<StampedInclude>,
    pub(super) node_ids: Vec<u64>,
    pub(super) positions: Vec<Point3>,
    pub(super) node_origins: Vec<Origin>,
    /// Their nodes are packed ids.
    pub(super) shells: Vec<Shell>,
    pub(super) packed: PackedIds,
    pub(super) shell_origins: Vec<Origin>,
    pub(super) mid_side: Vec<(u32, [u64; 4])>,
    pub(super) extras: Vec<ShellExtra>,
    /// Plies of shells, each stack once, and where a stack is, by its bits.
    pub(super) ply_stacks: Vec<Vec<f64>>,
    stack_index: HashMap<Vec<u64>, u32>,
    pub(super) solids: Vec<RawSolid>,
    pub(super) solid_origins: Vec<Origin>,
    part_index: HashMap<u64, u32>,
    part_ids: Vec<u64>,
    pub(super) parts: Vec<Part>,
    pub(super) part_positions: Vec<Option<Position>>,
    pub(super) motions: Vec<Motion>,
    /// Parts with a text label in place of an id.
    labelled: Vec<(String, Position, RawPart)>,
    told_tabs: bool,
}

/// What to do about a text label.
const NUMBER_INSTEAD: &str = "a number in place of the text label";

impl Assembly {
    /// Number of nodes so far.
    pub(crate) fn n_nodes(&self) -> usize {
        self.node_ids.len()
    }

    /// Number of shells so far.
    pub(crate) fn n_shells(&self) -> usize {
        self.shells.len()
    }

    /// Number of solids so far.
    pub(crate) fn n_solids(&self) -> usize {
        self.solids.len()
    }

    pub(crate) fn add_motion(&mut self, motion: Motion) {
        self.motions.push(motion);
    }

    pub(crate) fn add_nodes(&mut self, chunk: NodeChunk, mut origin: Origin) {
        origin.first = self.node_ids.len();
        self.tell_tabs(chunk.had_tabs, &origin);
        let n_expected = origin.n_expected(chunk.ids.len());
        make_room(&mut self.node_ids, chunk.ids.len(), n_expected);
        make_room(&mut self.positions, chunk.ids.len(), n_expected);
        self.node_ids.extend(chunk.ids);
        self.positions.extend(chunk.positions);
        self.found.append(chunk.diagnostics);
        self.node_origins.push(origin);
    }

    pub(crate) fn add_shells(&mut self, chunk: ShellChunk, mut origin: Origin) {
        let first = self.shells.len();
        origin.first = first;
        self.tell_tabs(chunk.had_tabs, &origin);
        let n_expected = origin.n_expected(chunk.shells.len());
        make_room(&mut self.shells, chunk.shells.len(), n_expected);
        let n_expected = origin.n_expected(chunk.extras.len());
        make_room(&mut self.extras, chunk.extras.len(), n_expected);
        let parts = self.part_numbers(&chunk.parts);
        let moved = self.packed.append(chunk.packed);
        self.shells
            .extend(chunk.shells.into_iter().map(|shell| Shell {
                id: shell.id,
                nodes: shell.nodes.map(&moved),
                part: parts[shell.part as usize],
            }));
        let by = first as u32;
        let mid_side = chunk.mid_side.into_iter();
        self.mid_side
            .extend(mid_side.map(|(shell, nodes)| (shell + by, nodes)));
        let stacks = chunk.stacks.into_iter();
        let stacks: Vec<u32> = stacks.map(|stack| self.stack_number(stack)).collect();
        let extras = chunk.extras.into_iter().map(|extra| ShellExtra {
            shell: extra.shell + by,
            plies: extra.plies.map(|stack| stacks[stack as usize]),
            ..extra
        });
        self.extras.extend(extras);
        self.offsets.add(by, chunk.offsets);
        self.found.append(chunk.diagnostics);
        self.shell_origins.push(origin);
    }

    pub(crate) fn add_solids(&mut self, chunk: SolidChunk, mut origin: Origin) {
        origin.first = self.solids.len();
        let parts = self.part_numbers(&chunk.parts);
        self.solids
            .extend(chunk.solids.into_iter().map(|solid| RawSolid {
                part: parts[solid.part as usize],
                ..solid
            }));
        self.found.append(chunk.diagnostics);
        self.solid_origins.push(origin);
    }

    /// Adds parts; of parts with the same id the first counts.
    pub(crate) fn add_parts(&mut self, parts: Vec<RawPart>, file: &SourceFile) {
        for mut raw in parts {
            if let Some(label) = raw.label.take() {
                self.labelled.push((label, file.position(raw.at), raw));
                continue;
            }
            let index = self.part_number(raw.id) as usize;
            if self.parts[index].is_defined {
                let kind = DiagnosticKind::DuplicatePart;
                let first = self.part_positions[index].as_ref();
                self.found.push_with(kind, || {
                    let before =
                        first.map_or(String::new(), |first| format!(" (first at {first})"));
                    let message = format!("part {} is defined again{before}", raw.id);
                    Diagnostic::new(kind, message).at(file.position(raw.at))
                });
                continue;
            }
            if let Some(label) = &raw.section_label {
                let kind = DiagnosticKind::Unsupported;
                let message = format!(
                    "part {} names its section by a text label and has no thickness",
                    raw.id
                );
                self.found.push_with(kind, || {
                    let diagnostic = Diagnostic::new(kind, message).at(file.position(raw.at));
                    diagnostic.found(label).expected(NUMBER_INSTEAD)
                });
            }
            self.part_positions[index] = Some(file.position(raw.at));
            self.parts[index] = Part {
                id: raw.id,
                title: self.raw_titles.add(&raw.title),
                section_id: raw.section_id,
                material_id: raw.material_id,
                thickness: raw.thickness(),
                plies: raw.plies,
                is_defined: true,
            };
        }
    }

    /// Adds sections, each with the byte offset of its card; of sections with the same id the first counts.
    pub(crate) fn add_sections(&mut self, sections: Vec<(Section, usize)>, file: &Arc<SourceFile>) {
        for (section, at) in sections {
            let id = section.id;
            let Some((index, first)) = self.section_places.get(&id) else {
                let place = (self.sections.len(), Place::new(file, at));
                self.section_places.insert(id, place);
                self.sections.push(section);
                continue;
            };
            if self.sections[*index] != section {
                let kind = DiagnosticKind::DuplicateSection;
                self.found.push_with(kind, || {
                    let first = first.position();
                    let message =
                        format!("section {id} is defined again and differently (first at {first}), the first counts");
                    Diagnostic::new(kind, message).at(file.position(at))
                });
            }
        }
    }

    /// Adds a transformation. One that is defined again and differently stops the solver; of these the first counts.
    pub(crate) fn add_transformation(&mut self, id: u64, new: Transformation, place: Place) {
        let Some((known, first)) = self.transformations.get(&id) else {
            self.transformations.insert(id, (new, place));
            return;
        };
        if *known != new {
            let kind = DiagnosticKind::BadTransformation;
            self.found.push_with(kind, || {
                let first = first.position();
                let message = format!(
                    "transformation {id} is defined again and differently (first at {first}), which LS-DYNA refuses; \
                     the first counts"
                );
                Diagnostic::new(kind, message).at(place.position())
            });
        }
    }

    /// Gives the parts with text labels ids that no other part has, now that all are known.
    pub(super) fn number_labelled_parts(&mut self) {
        let mut seen: HashMap<String, Position> = HashMap::new();
        let mut last_id = self.part_ids.iter().max().copied().unwrap_or(0);
        for (label, position, raw) in std::mem::take(&mut self.labelled) {
            if let Some(first) = seen.get(&label) {
                let message = format!("part {label:?} is defined again (first at {first})");
                let diagnostic = Diagnostic::new(DiagnosticKind::DuplicatePart, message);
                self.found.push(diagnostic.at(position));
                continue;
            }
            seen.insert(label.clone(), position.clone());
            last_id = last_id.saturating_add(1);
            let id = last_id;
            let title = self.raw_titles.add(&raw.title);
            let index = self.part_number(id) as usize;
            let kind = DiagnosticKind::Unsupported;
            let message = format!(
                "part {title:?} has a text label for an id; it is kept as part {id}, but elements \
                 can name it by a number only"
            );
            let diagnostic = Diagnostic::new(kind, message).at(position.clone());
            self.found
                .push(diagnostic.found(label).expected(NUMBER_INSTEAD));
            self.part_positions[index] = Some(position);
            self.parts[index] = Part {
                id,
                title,
                section_id: raw.section_id,
                material_id: raw.material_id,
                thickness: raw.thickness(),
                plies: raw.plies,
                is_defined: true,
            };
        }
    }

    /// Index of a stack of plies.
    fn stack_number(&mut self, stack: Vec<f64>) -> u32 {
        let bits = stack.iter().map(|ply| ply.to_bits()).collect();
        *self.stack_index.entry(bits).or_insert_with(|| {
            self.ply_stacks.push(stack);
            (self.ply_stacks.len() - 1) as u32
        })
    }

    /// Index of a part id; a part that only elements name so far is added.
    fn part_number(&mut self, id: u64) -> u32 {
        *self.part_index.entry(id).or_insert_with(|| {
            let part = Part {
                id,
                ..Part::default()
            };
            self.parts.push(part);
            self.part_ids.push(id);
            self.part_positions.push(None);
            (self.parts.len() - 1) as u32
        })
    }

    fn part_numbers(&mut self, parts: &PartIds) -> Vec<u32> {
        parts.ids.iter().map(|&id| self.part_number(id)).collect()
    }

    fn tell_tabs(&mut self, had_tabs: bool, origin: &Origin) {
        if had_tabs && !self.told_tabs {
            self.told_tabs = true;
            let message = "one tab between numbers separates them; other tabs are taken as steps to the next multiple of \
                           eight columns";
            let diagnostic = Diagnostic::new(DiagnosticKind::Tabs, message);
            let place = origin.file.position(origin.range.start);
            self.found.push(diagnostic.at(place));
        }
    }

    pub(super) fn node_position(&self, index: usize, id: u64) -> Option<Position> {
        origin_of(&self.node_origins, index).map(|origin| origin.node(id))
    }

    pub(super) fn shell_position(&self, index: usize, shell: &Shell) -> Option<Position> {
        let part = self.part_ids[shell.part as usize];
        origin_of(&self.shell_origins, index).map(|origin| origin.element(shell.id, part))
    }

    /// Tells origins and motions which shells are left: `n_kept[i]` of the first `i`.
    pub(super) fn renumber_shells(&mut self, n_kept: &[usize]) {
        for origin in &mut self.shell_origins {
            origin.first = n_kept[origin.first];
        }
        for motion in &mut self.motions {
            if let Motion::Include { shells, .. } = motion {
                *shells = n_kept[shells.start]..n_kept[shells.end];
            }
        }
    }

    /// Tells motions which solids are left, likewise.
    pub(super) fn renumber_solids(&mut self, n_kept: &[usize]) {
        for motion in &mut self.motions {
            if let Motion::Include { solids, .. } = motion {
                *solids = n_kept[solids.start]..n_kept[solids.end];
            }
        }
    }

    /// For solids that are not linked to their nodes yet.
    pub(super) fn raw_solid_position(&self, index: usize) -> Option<Position> {
        let solid = &self.solids[index];
        let part = self.part_ids[solid.part as usize];
        origin_of(&self.solid_origins, index).map(|origin| origin.element(solid.id, part))
    }

    /// For linked solids. Those before it that were left out make the line that of a piece.
    pub(super) fn solid_position(&self, index: usize, solid: &Solid) -> Option<Position> {
        let part = self.part_ids[solid.part as usize];
        origin_of(&self.solid_origins, index).map(|origin| origin.element(solid.id, part))
    }
}
