//! Walks the tree of included files and hands each block to the reader of its keyword.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::diagnostic::{Diagnostic, DiagnosticKind};
use super::super::model::{Model, ReadFile};
use super::super::source::{Bytes, FileSource, open_unpacked, tidy};
use super::super::{FormatError, ReadOptions};
use super::assemble::{Assembly, Motion, Origin};
use super::block::{Block, Blocks, SourceFile};
use super::card::Layout;
use super::forming::{is_forming, read_block};
use super::include::{
    Context, Include, SearchPath, layout_of_keyword, read_include_transform, read_includes,
    read_paths,
};
use super::mesh::{ElementKeyword, element_keyword};
use super::parameter::ParameterTable;
use super::parts::{read_parts, read_shell_sections};
use super::results::FormingCount;
use super::sets::{SetKind, read_set};
use super::transform::Transformation;
use super::{chunks, nodes, shells, solids};
use crate::monitor::{Cancelled, Monitor};

/// Includes may be nested this deep.
const MAX_DEPTH: usize = 64;
/// So many files may be included; a deck that includes twice in each of many levels asks for more.
const MAX_FILES: usize = 5_000;

/// Reads the deck at `path` and everything it includes. What cannot be understood is told in the
/// model's diagnostics.
pub fn read(
    source: &dyn FileSource,
    path: &Path,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    let bytes = open_unpacked(source, path).map_err(|error| FormatError::open(path, &error))?;
    read_opened(source, path, bytes, options, monitor)
}

/// Reads a deck whose bytes are at hand; includes are looked for by `source`.
pub fn read_opened(
    source: &dyn FileSource,
    path: &Path,
    bytes: Bytes,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    if let Some(what) = binary_kind(&bytes) {
        let path = path.to_path_buf();
        return Err(FormatError::Unsupported { what, path });
    }
    let master = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut reader = Reader {
        source,
        monitor,
        search: SearchPath {
            master,
            folders: Vec::new(),
        },
        option_folders: &options.include_folders,
        parameters: ParameterTable::new(),
        assembly: Assembly::default(),
        open: vec![tidy(path)],
        n_bytes: 0,
    };
    let file = Arc::new(SourceFile::new(path, bytes));
    reader.file(&file, Context::default())?;
    reader.monitor.check()?;
    Ok(reader.assembly.finish(monitor)?)
}

/// What a file of results is that is no keyword file; `None` for text.
pub(crate) fn binary_kind(bytes: &[u8]) -> Option<&'static str> {
    let head = &bytes[..bytes.len().min(512)];
    // An LSDA file begins with the sizes of its own integers: header length 8, lengths, offsets.
    let is_lsda = matches!(head, [8, 8, 8, 1, 1, ..] | [7 | 8, 4 | 8, 4 | 8, 1, ..]);
    if is_lsda {
        return Some("a binary dynain (LSDA)");
    }
    let n_control = head
        .iter()
        .filter(|&&b| b < 9 || (14..27).contains(&b))
        .count();
    (head.contains(&0) && n_control * 20 > head.len()).then_some("a binary file")
}

struct Reader<'a> {
    source: &'a dyn FileSource,
    monitor: &'a Monitor,
    search: SearchPath,
    option_folders: &'a [PathBuf],
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
        });
        let mut context = context;
        if context.length == 1.0 {
            self.assembly.unit_clues.read_head(file);
        }
        let mut blocks = Blocks::new(file, context.layout);
        self.report_encrypted(file, &blocks);
        while let Some(block) = blocks.next() {
            self.monitor.check()?;
            match block.name.as_str() {
                "END" => break,
                "KEYWORD" => {
                    context.layout = self.layout(&block, &context);
                    blocks.set_layout(context.layout);
                }
                _ => self.block(file, &block, &context)?,
            }
        }
        self.n_bytes += file.bytes().len() as u64;
        self.monitor.progress("read deck", self.n_bytes, None);
        Ok(())
    }

    fn report_encrypted(&mut self, file: &SourceFile, blocks: &Blocks<'_>) {
        if let Some(first) = blocks.first_encrypted() {
            let n = blocks.n_encrypted();
            let s = if n == 1 { "" } else { "s" };
            let message = format!("{n} encrypted block{s} skipped");
            let finding = Diagnostic::new(DiagnosticKind::Encrypted, message);
            self.assembly.found.push(finding.at(file.position(first)));
        }
    }

    /// The layout after a `*KEYWORD` line: the suffix of the include wins over the file's own wish,
    /// and that over the including file's layout.
    fn layout(&mut self, block: &Block<'_>, context: &Context) -> Layout {
        let Some(own) = layout_of_keyword(block.remark) else {
            return context.layout;
        };
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
            self.parameters.define(block, &mut self.assembly.found);
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

    /// Nodes and elements.
    fn mesh(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        context: &Context,
    ) -> Result<(), Cancelled> {
        let parameters = &self.parameters;
        let assembly = &mut self.assembly;
        let block = &Block {
            parameters: Some(parameters),
            ..block.clone()
        };
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
                let message = format!("*{} is not known and is skipped", block.name);
                let kind = DiagnosticKind::Unsupported;
                assembly
                    .found
                    .push_with(kind, || block.diagnose(kind, message));
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
        let assembly = &mut self.assembly;
        let block = &Block {
            parameters: Some(&self.parameters),
            ..block.clone()
        };
        if name == "TITLE" {
            let title = block.cards().next().map(|card| card.line_text());
            let title = title.unwrap_or_default().trim().to_owned();
            if assembly.title.is_empty() && self.open.len() == 1 {
                assembly.unit_clues.read_text(&title);
                assembly.title = title;
            }
        } else if name == "PART" || name.starts_with("PART_") {
            let parts = read_parts(block, &context.parts(), &mut assembly.found);
            assembly.add_parts(parts, file);
        } else if name == "SECTION_SHELL" || name.starts_with("SECTION_SHELL_") {
            let sections = read_shell_sections(block, &context.parts(), &mut assembly.found);
            assembly.sections.extend(sections);
        } else if let Some(kind) = SetKind::of_keyword(name) {
            let set = read_set(block, kind, &context.sets(), &mut assembly.found);
            assembly.sets.extend(set);
        } else if name.starts_with("DEFINE_TRANSFORMATION") {
            let read = Transformation::from_block(block, &mut assembly.found);
            if let Some((id, mut transformation)) = read {
                transformation.offset_nodes(context.offsets.node);
                let id = nodes::shifted(id, context.offsets.define);
                assembly.transformations.insert(id, transformation);
            }
        } else if is_forming(name) {
            let units = context.results();
            read_block(block, units, &mut assembly.forming, &mut assembly.found);
        } else if context.length == 1.0 {
            assembly.unit_clues.read_block(block);
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
                    self.included(file, block, &include, context)?;
                }
            }
            "INCLUDE_TRANSFORM" => {
                let by = context.offsets.define;
                let found = &mut self.assembly.found;
                if let Some(include) = read_include_transform(&with_parameters, by, found) {
                    self.included(file, block, &include, context)?;
                }
            }
            "INCLUDE_PATH" => {
                let paths = read_paths(block).into_iter().map(PathBuf::from);
                self.search.folders.extend(paths);
            }
            "INCLUDE_PATH_RELATIVE" => {
                let master = self.search.master.clone();
                let paths = read_paths(block).into_iter().map(|path| master.join(path));
                self.search.folders.extend(paths);
            }
            name => {
                let kind = DiagnosticKind::Unsupported;
                let message = format!("*{name} is not carried out");
                self.assembly
                    .found
                    .push_with(kind, || block.diagnose(kind, message));
            }
        }
        Ok(())
    }

    /// Reads one included file and notes how its nodes are moved.
    fn included(
        &mut self,
        file: &Arc<SourceFile>,
        block: &Block<'_>,
        include: &Include,
        context: &Context,
    ) -> Result<(), Cancelled> {
        let Some(child) = self.open_include(file, include) else {
            return Ok(());
        };
        let first_node = self.assembly.n_nodes();
        let first_result = FormingCount::of(&self.assembly.forming);
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
                results: first_result..FormingCount::of(&self.assembly.forming),
                transformation: include.transformation,
                position: file.position(include.at),
            });
        }
        Ok(())
    }

    /// Finds and opens an included file and notes it as open; says so if that cannot be done.
    fn open_include(&mut self, file: &SourceFile, include: &Include) -> Option<Arc<SourceFile>> {
        let name = self.parameters.substitute(&include.name).into_owned();
        let folder = file.path().parent().unwrap_or(Path::new(""));
        let mut search = self.search.clone();
        search.folders.extend(self.option_folders.iter().cloned());
        let path = search.find(self.source, folder, &name);
        let result = match path {
            None => Err((DiagnosticKind::MissingInclude, "is not found".to_owned())),
            Some(path) if self.open.contains(&tidy(&path)) => {
                Err((DiagnosticKind::IncludeCycle, "includes itself".to_owned()))
            }
            Some(_) if self.open.len() >= MAX_DEPTH || self.assembly.files.len() >= MAX_FILES => {
                let message = "is left out because there are too many includes";
                Err((DiagnosticKind::IncludeCycle, message.to_owned()))
            }
            Some(path) => match open_unpacked(self.source, &path) {
                Ok(bytes) => match binary_kind(&bytes) {
                    Some(what) => Err((DiagnosticKind::Unsupported, format!("is {what}"))),
                    None => Ok((path, bytes)),
                },
                Err(error) => {
                    let message = format!("cannot be read ({error})");
                    Err((DiagnosticKind::MissingInclude, message))
                }
            },
        };
        match result {
            Ok((path, bytes)) => {
                self.open.push(tidy(&path));
                Some(Arc::new(SourceFile::new(path, bytes)))
            }
            Err((kind, what)) => {
                let finding = Diagnostic::new(kind, format!("the included file {what}"));
                let finding = finding.at(file.position(include.at)).found(name);
                self.assembly.found.push(finding);
                None
            }
        }
    }
}

/// `*NODE_TRANSFORM` and `*NODE_THICKNESS`.
fn node_keyword(assembly: &mut Assembly, file: &SourceFile, block: &Block<'_>, context: &Context) {
    let offsets = context.offsets;
    if block.name.starts_with("NODE_THICKNESS") {
        let rows =
            nodes::read_node_thickness(block, offsets.node, offsets.set, &mut assembly.found);
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
