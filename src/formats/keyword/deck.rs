//! Walks the tree of included files and hands each block to the reader of its keyword.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Model, ReadFile};
use super::super::recognise::recognise;
use super::super::source::{FileSource, TooLarge, open_unpacked, tidy};
use super::super::{FileBytes, Foreign, Format, FormatError, ReadOptions, text};
use super::assemble::{Assembly, Motion, Origin};
use super::block::{Block, Blocks};
use super::card::Layout;
use super::forming::{is_forming, read_block};
use super::include::{
    Context, Include, SearchPath, layout_of_keyword, read_include_transform, read_includes,
    read_paths, read_stamped_include,
};
use super::materials::read_material;
use super::mesh::{ElementKeyword, ShellCards, element_keyword};
use super::names::{is_known, probably_meant, shapes_parts};
use super::parameter::ParameterTable;
use super::parts::{read_parts, read_shell_control, read_shell_sections};
use super::results::FormingCount;
use super::sets::{SetKind, read_set};
use super::source_file::{Place, SourceFile};
use super::transform::Transformation;
use super::{chunks, ends, nodes, resolve, shells, solids};
use crate::monitor::{Cancelled, Monitor};

/// Includes may be nested this deep.
const MAX_DEPTH: usize = 64;
/// Units that differ by more than this are a mistake.
const MAX_UNIT_FACTOR: f64 = 1e12;

/// Reads the deck at `path`, whose text is at hand, and everything it includes; includes are looked
/// for by `source`. What cannot be understood is told in the model's diagnostics.
pub(crate) fn read_opened(
    source: &dyn FileSource,
    path: &Path,
    bytes: FileBytes,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    let master = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut reader = Reader {
        source,
        monitor,
        search: SearchPath {
            master,
            ..SearchPath::default()
        },
        options,
        parameters: ParameterTable::new(),
        assembly: Assembly::default(),
        open: vec![tidy(path)],
        n_bytes: 0,
    };
    let file = Arc::new(SourceFile::new(path, bytes));
    reader.file(&file, Context::default())?;
    reader.monitor.check()?;
    Ok(resolve::finish(reader.assembly, options, monitor)?)
}

struct Reader<'a> {
    source: &'a dyn FileSource,
    monitor: &'a Monitor,
    search: SearchPath,
    options: &'a ReadOptions,
    parameters: ParameterTable,
    assembly: Assembly,
    /// The files that are being read, the innermost last.
    open: Vec<PathBuf>,
    n_bytes: u64,
}

impl Reader<'_> {
    /// Reads one file and the files it includes.
    fn file(&mut self, file: &Arc<SourceFile>, context: Context) -> Result<(), Cancelled> {
        self.assembly.files.push(ReadFile {
            path: file.path().to_path_buf(),
            n_bytes: file.bytes().len() as u64,
            hash: None,
            included_as: context.included_as(),
        });
        let mut context = context;
        if context.keeps_units() {
            self.assembly.unit_clues.read_head(file);
        }
        self.n_bytes += file.bytes().len() as u64;
        let mut blocks = Blocks::new(file, context.layout);
        ends::report_encrypted(file, &blocks, &mut self.assembly.found);
        let mut has_head = false;
        let mut last: Option<Block<'_>> = None;
        while let Some(block) = blocks.next() {
            self.monitor.check()?;
            if block.name == "END" {
                ends::report_behind(&block, blocks, &mut self.assembly.found);
                last = None;
                break;
            }
            has_head |= block.name == "KEYWORD";
            if let Some(own) = layout_of_keyword(&block) {
                context.layout = self.layout(own, &block, &context);
                blocks.set_layout(context.layout);
            }
            self.block(file, &block, &context)?;
            last = Some(block);
        }
        if self.open.len() == 1 {
            self.assembly.layout = context.layout;
        }
        // Included files and loose cards often have neither head nor end.
        if let Some(last) = last.filter(|_| has_head && self.open.len() == 1) {
            ends::report_cut(file, &last, &mut self.assembly.found);
        }
        self.monitor.progress("read deck", self.n_bytes, None);
        Ok(())
    }

    /// The layout after a `*KEYWORD` line: the suffix of the include wins over the file's `own` wish,
    /// and that over the including file's layout.
    fn layout(&mut self, own: Layout, block: &Block<'_>, context: &Context) -> Layout {
        let is_included = self.open.len() > 1;
        if is_included && own != context.layout {
            let kind = DiagnosticKind::FormatMismatch;
            let message = if context.layout_is_fixed {
                "the include line asks for another number format, which counts"
            } else {
                "the including file has another number format; this file's own counts here, but \
                 LS-DYNA takes that of the including file"
            };
            self.assembly
                .found
                .push_with(kind, || block.diagnose(kind, message));
        }
        if context.layout_is_fixed {
            context.layout
        } else {
            own
        }
    }

    fn block(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        context: &Context,
    ) -> Result<(), Cancelled> {
        let name = block.name.as_str();
        if name.starts_with("PARAMETER") {
            let found = &mut self.assembly.found;
            found.beside_geometry(|found| self.parameters.define(block, found));
            return Ok(());
        }
        if !name.is_empty() && !is_known(name) {
            self.tell_unknown(block);
        }
        if shapes_parts(name) {
            name_unsupported(block, &mut self.assembly.found);
            return Ok(());
        }
        let first_word = name.split('_').next().unwrap_or_default();
        match first_word {
            "INCLUDE" => self.include(file, block, context),
            "NODE" | "ELEMENT" => self.mesh(file, block, context),
            _ => {
                self.other(file, block, context);
                Ok(())
            }
        }
    }

    fn tell_unknown(&mut self, block: &Block<'_>) {
        let kind = DiagnosticKind::UnknownKeyword;
        self.assembly.found.push_with(kind, || {
            let name = &block.name;
            let message = match probably_meant(name) {
                Some(meant) => format!(
                    "*{name} is not an LS-DYNA keyword and is skipped; *{meant} was probably meant"
                ),
                None => format!("*{name} is not an LS-DYNA keyword and is skipped"),
            };
            block.diagnose(kind, message)
        });
    }

    /// Nodes and elements.
    fn mesh(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        context: &Context,
    ) -> Result<(), Cancelled> {
        let block = &Block {
            parameters: Some(&self.parameters),
            ..block.clone()
        };
        let assembly = &mut self.assembly;
        if is_shifted(block, &mut assembly.found) {
            return Ok(());
        }
        let origin = Origin::new(file, block, context);
        let offsets = context.elements();
        match element_keyword(block) {
            ElementKeyword::Shell(cards) => chunks::read(
                block,
                cards.cut(),
                self.monitor,
                |range, strict| shells::read_shells(block, range, cards, &offsets, strict),
                |chunk, range| assembly.add_shells(chunk, origin.of(range)),
            ),
            ElementKeyword::Solid(cards) => chunks::read(
                block,
                cards.cut(block),
                self.monitor,
                |range, _| solids::read_solids(block, range, cards, &offsets),
                |chunk, range| assembly.add_solids(chunk, origin.of(range)),
            ),
            ElementKeyword::Unknown => {
                name_unsupported(block, &mut assembly.found);
                Ok(())
            }
            ElementKeyword::Skipped if nodes::holds_nodes(&block.name) => chunks::read(
                block,
                nodes::CUT,
                self.monitor,
                |range, _| nodes::read_nodes(block, range, context.offsets.node),
                |chunk, range| assembly.add_nodes(chunk, origin.of(range)),
            ),
            ElementKeyword::Skipped => {
                node_keyword(assembly, file, block, context);
                Ok(())
            }
        }
    }

    /// Everything that is neither mesh, include nor parameter.
    fn other(&mut self, file: &Arc<SourceFile>, block: &Block<'_>, context: &Context) {
        let name = block.name.as_str();
        let (assembly, monitor) = (&mut self.assembly, self.monitor);
        let block = &Block {
            parameters: Some(&self.parameters),
            ..block.clone()
        };
        // Text begins as it likes.
        let is_text = matches!(name, "COMMENT" | "TITLE");
        if let Some(card) = block.misplaced_keyword().filter(|_| !is_text) {
            let kind = DiagnosticKind::MisplacedKeyword;
            assembly.found.push_with(kind, || card.diagnose_keyword());
        }
        if name == "TITLE" {
            let card = block.cards().next();
            if let Some(card) = card.filter(|_| assembly.title.is_empty() && self.open.len() == 1) {
                let title = assembly.raw_titles.add(card.title());
                assembly.unit_clues.read_text(&title);
                assembly.title = title;
            }
        } else if name == "PART" || name.starts_with("PART_") {
            let found = &mut assembly.found;
            let parts = found.beside_geometry(|found| read_parts(block, &context.parts(), found));
            assembly.add_parts(parts, file);
        } else if name == "SECTION_SHELL" || name.starts_with("SECTION_SHELL_") {
            let found = &mut assembly.found;
            let sections =
                found.beside_geometry(|found| read_shell_sections(block, &context.parts(), found));
            assembly.add_sections(sections, file);
        } else if name == "CONTROL_SHELL" {
            read_shell_control(block, &mut assembly.shell_control);
        } else if let Some(kind) = SetKind::of_keyword(name) {
            let set = read_set(block, kind, &context.sets(), &mut assembly.found);
            assembly.sets.extend(set.map(|set| (file.clone(), set)));
        } else if name.starts_with("DEFINE_TRANSFORMATION") {
            let read = Transformation::from_block(block, &mut assembly.found);
            if let Some((id, mut transformation)) = read {
                transformation.offset_nodes(context.offsets.node);
                transformation.scale_lengths(context.length);
                let id = nodes::shifted(id, context.offsets.define);
                let place = Place::new(file, block.offset);
                assembly.add_transformation(id, transformation, place);
            }
        } else if is_forming(name) {
            let units = context.results();
            let (into, found) = (&mut assembly.forming, &mut assembly.found);
            found.beside_geometry(|found| read_block(file, block, units, into, found, monitor));
        } else if name.starts_with("MAT_") {
            assembly.unit_clues.read_material(block, context);
            assembly.materials.extend(read_material(block, context));
        } else if name == "CONTROL_UNITS" && context.keeps_units() {
            assembly.unit_clues.read_control(block);
        }
    }

    /// The `*INCLUDE…` keywords.
    fn include(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        context: &Context,
    ) -> Result<(), Cancelled> {
        let with_parameters = Block {
            parameters: Some(&self.parameters),
            ..block.clone()
        };
        match block.name.as_str() {
            "INCLUDE" => {
                for include in read_includes(block) {
                    self.included(file, block, include, context)?;
                }
            }
            "INCLUDE_TRANSFORM" => {
                let by = context.offsets.define;
                let found = &mut self.assembly.found;
                if let Some(include) = read_include_transform(&with_parameters, by, found) {
                    self.included(file, block, include, context)?;
                }
            }
            name @ ("INCLUDE_PATH" | "INCLUDE_PATH_RELATIVE") => {
                for path in read_paths(block) {
                    let path = self.parameters.substitute(&path);
                    let path = Path::new(&*path);
                    if name == "INCLUDE_PATH" {
                        self.search.add_folder(path);
                    } else {
                        self.search.add_relative_folder(path);
                    }
                }
            }
            _ => {
                let stamped = read_stamped_include(&with_parameters, &context.offsets);
                self.assembly.stamped_includes.extend(stamped);
                name_unsupported(block, &mut self.assembly.found);
            }
        }
        Ok(())
    }

    /// Reads one included file and notes how its nodes are moved.
    fn included(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        mut include: Include,
        context: &Context,
    ) -> Result<(), Cancelled> {
        self.monitor.check()?;
        self.check_units(file, &mut include, context);
        let include = &include;
        let Some(child) = self.open_include(file, include)? else {
            return Ok(());
        };
        let assembly = &self.assembly;
        let first_node = assembly.n_nodes();
        let (first_shell, first_solid) = (assembly.n_shells(), assembly.n_solids());
        let (first_result, first_file) =
            (FormingCount::of(&assembly.forming), assembly.files.len());
        self.parameters.push_scope();
        let read = self.file(&child, context.inside(include, block.suffix));
        self.parameters.pop_scope();
        self.open.pop();
        read?;
        let nodes = first_node..self.assembly.n_nodes();
        if include.length != 1.0 {
            self.assembly.add_motion(Motion::Scale {
                nodes: nodes.clone(),
                factor: include.length,
                position: file.position(include.at),
            });
        }
        if include.transformation != 0 {
            self.assembly.add_motion(Motion::Include {
                nodes,
                shells: first_shell..self.assembly.n_shells(),
                solids: first_solid..self.assembly.n_solids(),
                results: first_result..FormingCount::of(&self.assembly.forming),
                files: first_file..self.assembly.files.len(),
                transformation: include.transformation,
                position: file.position(include.at),
            });
        }
        Ok(())
    }

    /// Unit factors of an include that are none, or that multiply up to none, count as 1.
    fn check_units(&mut self, file: &SourceFile, include: &mut Include, context: &Context) {
        let is_unit = |factor: f64| (1.0 / MAX_UNIT_FACTOR..=MAX_UNIT_FACTOR).contains(&factor);
        let refuse = |found: &mut Diagnostics, name: &str, factor: f64| {
            let kind = DiagnosticKind::BadTransformation;
            let message = format!("the include's factor on {name} is no unit factor and left out");
            found.push_with(kind, || {
                let diagnostic = Diagnostic::new(kind, message).at(file.position(include.at));
                diagnostic
                    .found(format!("{factor:e}"))
                    .expected("a positive number of at most 1e12")
            });
        };
        if !is_unit(include.length) || !is_unit(include.length * context.length) {
            refuse(&mut self.assembly.found, "lengths (FCTLEN)", include.length);
            include.length = 1.0;
        }
        // Stresses go with the square of time and may differ by more.
        let is_stress_unit = |factor: f64| factor > 0.0 && (1e-50..=1e50).contains(&factor);
        if !is_stress_unit(include.stress) || !is_stress_unit(include.stress * context.stress) {
            let found = &mut self.assembly.found;
            found.beside_geometry(|found| {
                refuse(
                    found,
                    "stresses (FCTMAS / FCTLEN / FCTTIM²)",
                    include.stress,
                );
            });
            include.stress = 1.0;
        }
    }

    /// Finds and opens an included file and notes it as open; says so if that cannot be done.
    fn open_include(
        &mut self,
        file: &SourceFile,
        include: &Include,
    ) -> Result<Option<Arc<SourceFile>>, Cancelled> {
        let name = self.parameters.substitute(&include.name).into_owned();
        let folder = file.path().parent().unwrap_or(Path::new(""));
        let mut search = self.search.clone();
        let of_options = self.options.include_folders.iter().cloned();
        search.folders.extend(of_options);
        let result = match search.find(self.source, folder, &name) {
            Some(path) => self.open_found(path),
            None => {
                let what = match search.other_than_file(self.source, folder, &name) {
                    Some(what) => format!("is {what}, not a file"),
                    None => format!("is not found; tried {}", search.tried(folder, &name)),
                };
                self.search.n_tried += search.n_places(&name);
                Err((DiagnosticKind::MissingInclude, what))
            }
        };
        self.monitor.check()?;
        match result {
            Ok((path, bytes)) => {
                self.open.push(tidy(&path));
                Ok(Some(Arc::new(SourceFile::new(path, bytes))))
            }
            Err((kind, what)) => {
                let found = &mut self.assembly.found;
                found.beside_geometry(|found| {
                    found.push_with(kind, || {
                        let message = format!("the included file {name:?} {what}");
                        Diagnostic::new(kind, message).at(file.position(include.at))
                    });
                });
                Ok(None)
            }
        }
    }

    /// The bytes of an include at a path that exists; what keeps it from being read otherwise.
    fn open_found(&self, path: PathBuf) -> Result<(PathBuf, FileBytes), (DiagnosticKind, String)> {
        if self.open.contains(&tidy(&path)) {
            return Err((DiagnosticKind::IncludeCycle, "includes itself".to_owned()));
        }
        if self.open.len() >= MAX_DEPTH {
            let message = format!("is left out: it is nested deeper than {MAX_DEPTH} includes");
            return Err((DiagnosticKind::IncludeCycle, message));
        }
        let max_files = self.options.max_files;
        if self.assembly.files.len() >= max_files {
            let message = format!(
                "is left out: {max_files} files were read, which is the limit; raise it with --read-limit or in the \
                preferences"
            );
            return Err((DiagnosticKind::LimitReached, message));
        }
        let n_left = self.options.max_bytes.saturating_sub(self.n_bytes);
        let opened = open_unpacked(self.source, &path, n_left, self.monitor);
        let (bytes, _) = opened.map_err(|error| {
            let is_limit = error.get_ref().is_some_and(|inner| inner.is::<TooLarge>());
            if is_limit {
                let max_bytes = self.options.max_bytes;
                let message = format!("is left out: {}", TooLarge { max_bytes });
                (DiagnosticKind::LimitReached, message)
            } else {
                let message = format!("cannot be read ({error})");
                (DiagnosticKind::MissingInclude, message)
            }
        })?;
        let bytes = text::normalised(bytes);
        match recognise(&path, &bytes) {
            Ok(Format::Keyword) | Err(Foreign::Empty) => Ok((path, bytes)),
            Ok(format) => Err((
                DiagnosticKind::MissingInclude,
                format!("is {} and left out", format.label()),
            )),
            Err(Foreign::Text) if is_comment(&bytes) => Ok((path, bytes)),
            Err(foreign) => Err((
                DiagnosticKind::MissingInclude,
                format!("is {foreign}; {}", foreign.advice()),
            )),
        }
    }
}

/// Names a keyword that would change the mesh or its results.
fn name_unsupported(block: &Block<'_>, found: &mut Diagnostics) {
    let kind = DiagnosticKind::Unsupported;
    found.push_with(kind, || {
        block.diagnose(kind, format!("*{} is not carried out", block.name))
    });
}

/// True if the cards of a mesh block are those of another layout; told once. Where one block
/// is such, others may look right by chance.
fn is_shifted(block: &Block<'_>, found: &mut Diagnostics) -> bool {
    let is_certain = found.count(DiagnosticKind::ShiftedColumns) > 0;
    let shifted = match element_keyword(block) {
        ElementKeyword::Shell(cards) => {
            let n_cards = if cards == ShellCards::default() { 3 } else { 1 };
            block.shifted_columns(n_cards, is_certain, shells::is_whole_shell)
        }
        ElementKeyword::Skipped if nodes::holds_nodes(&block.name) => {
            block.shifted_columns(3, is_certain, nodes::is_node)
        }
        _ => None,
    };
    let Some((card, layout)) = shifted else {
        return false;
    };
    let kind = DiagnosticKind::ShiftedColumns;
    found.push_with(kind, || card.diagnose_shifted(layout));
    true
}

/// True for a text of comments and blank lines.
fn is_comment(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&b| b == b'\n');
    lines.all(|line| line.first() == Some(&b'$') || line.trim_ascii().is_empty())
}

/// `*NODE_TRANSFORM` and `*NODE_THICKNESS`.
fn node_keyword(assembly: &mut Assembly, file: &SourceFile, block: &Block<'_>, context: &Context) {
    let offsets = context.offsets;
    if block.name.starts_with("NODE_THICKNESS") {
        let found = &mut assembly.found;
        let rows = found.beside_geometry(|found| {
            nodes::read_node_thickness(block, offsets.node, offsets.set, found)
        });
        let scaled = rows.into_iter().map(|row| nodes::NodeThickness {
            thickness: row.thickness * context.length,
            ..row
        });
        assembly.node_thickness.extend(scaled);
    } else if block.name == "NODE_TRANSFORM" {
        for (row, at) in nodes::read_node_transforms(block, &mut assembly.found) {
            let n_nodes = assembly.n_nodes();
            assembly.add_motion(Motion::NodeSet {
                at_once: row.at_once.then_some(n_nodes),
                set: nodes::shifted(row.node_set, offsets.set),
                transformation: nodes::shifted(row.transformation, offsets.define),
                position: file.position(at),
            });
        }
    }
}
