//! Reads a deck and puts the model together.

use std::path::Path;

use super::super::diagnostic::{Diagnostic, DiagnosticKind};
use super::super::model::{Model, Nodes, Part, ReadFile, Shell};
use super::super::source::{FileSource, open_unpacked};
use super::super::{FormatError, ReadOptions};
use super::block::{Blocks, SourceFile};
use super::card::{EIGHT_BY_10, Layout};
use super::mesh::{RawShell, read_nodes, read_shells};
use crate::monitor::Monitor;

/// Reads the deck at `path`.
pub fn read(
    source: &dyn FileSource,
    path: &Path,
    _options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    let bytes = open_unpacked(source, path).map_err(|error| FormatError::open(path, &error))?;
    let file = SourceFile::new(path, bytes);
    let mut model = Model::default();
    let (mut nodes, mut shells): (Vec<_>, Vec<RawShell>) = (Vec::new(), Vec::new());
    for block in Blocks::new(&file, Layout::Standard) {
        monitor.check()?;
        match block.name.as_str() {
            "NODE" => read_nodes(&block, &mut nodes, &mut model.diagnostics),
            "ELEMENT_SHELL" => read_shells(&block, &mut shells, &mut model.diagnostics),
            "PART" => {
                let mut cards = block.cards();
                while let (Some(title), Some(card)) = (cards.next(), cards.next()) {
                    if let Ok(id) = card.id(EIGHT_BY_10, 0) {
                        model.parts.push(Part {
                            id,
                            title: title.line_text().trim().to_owned(),
                            section_id: card.id(EIGHT_BY_10, 1).unwrap_or(0),
                            thickness: None,
                            is_defined: true,
                        });
                    }
                }
            }
            "END" => break,
            _ => {}
        }
    }
    let (ids, positions) = nodes.into_iter().unzip();
    model.nodes = Nodes::new(ids, positions).0;
    for shell in shells {
        add_shell(&mut model, &shell);
    }
    model.files.push(ReadFile {
        path: path.to_path_buf(),
        n_bytes: file.bytes().len() as u64,
    });
    Ok(model)
}

fn add_shell(model: &mut Model, shell: &RawShell) {
    let found = shell.nodes.map(|id| model.nodes.index_of(id));
    let [Some(a), Some(b), Some(c), Some(d)] = found else {
        let kind = DiagnosticKind::MissingNode;
        let message = format!("shell {} names a node that is not defined", shell.id);
        model.diagnostics.push(Diagnostic::new(kind, message));
        return;
    };
    let part = model.part_index(shell.part).unwrap_or_else(|| {
        model.parts.push(Part {
            id: shell.part,
            ..Part::default()
        });
        model.parts.len() as u32 - 1
    });
    model.shells.push(Shell {
        id: shell.id,
        nodes: [a, b, c, d],
        part,
    });
}
