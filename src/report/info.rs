//! What a file holds, as a record for JSON and for people.

use std::collections::HashSet;

use serde::Serialize;

use crate::formats::{Diagnostic, Model};
use crate::units::KnownUnits;

/// What a file holds. The JSON form has exactly these keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelInfo {
    /// The format of this record.
    pub schema: &'static str,
    /// The deck's title.
    pub title: String,
    /// The units it states or that follow from its materials, in words; absent if it says none.
    pub units: Option<String>,
    /// Files that were read, the one asked for first.
    pub files: Vec<FileInfo>,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of shells.
    pub shells: usize,
    /// Number of solids and thick shells.
    pub solids: usize,
    /// The parts in the order of the file.
    pub parts: Vec<PartInfo>,
    /// Box around everything that is meshed, in the file's unit; absent for an empty file.
    pub bounds: Option<Bounds>,
    /// Forming results.
    pub forming: FormingInfo,
    /// What could not be understood.
    pub diagnostics: Vec<DiagnosticInfo>,
    /// How many diagnostics were made in all; of each kind only the first are listed.
    pub n_diagnostics: u64,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileInfo {
    /// Path of the file.
    pub path: String,
    /// Its length, unpacked.
    pub bytes: u64,
}

/// Counts and sizes of one part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartInfo {
    /// The deck's part id.
    pub id: u64,
    /// Title; empty if none was given.
    pub title: String,
    /// Number of shells.
    pub shells: usize,
    /// Number of solids and thick shells.
    pub solids: usize,
    /// Triangles the shells are cut into.
    pub triangles: usize,
    /// Mean thickness, if known.
    pub thickness: Option<f64>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
}

/// Forming results, counted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FormingInfo {
    /// Shells with their own corner thickness.
    pub thickness: usize,
    /// Shells with stresses and effective plastic strain.
    pub stress: usize,
    /// Shells with strain tensors.
    pub strain: usize,
    /// Solids and thick shells with stresses or strains, counted but not kept.
    pub others: usize,
    /// Largest number of history variables at a point.
    pub history_variables: usize,
    /// Smallest and largest corner thickness.
    pub thickness_range: Option<[f64; 2]>,
    /// Smallest and largest effective plastic strain.
    pub plastic_strain_range: Option<[f64; 2]>,
}

/// One diagnostic of the reader.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosticInfo {
    /// `note`, `warning` or `error`.
    pub severity: &'static str,
    /// What kind of diagnostic, in two or three words.
    pub kind: &'static str,
    /// The file, if known.
    pub file: Option<String>,
    /// The line, from 1, if known.
    pub line: Option<u64>,
    /// The column, from 1, if known.
    pub column: Option<u32>,
    /// What went wrong.
    pub message: String,
    /// What stood there.
    pub found: Option<String>,
    /// What should have stood there.
    pub expected: Option<String>,
}

impl ModelInfo {
    /// Collects the record. O(elements).
    pub fn of(model: &Model) -> Self {
        let aabb = model.bounds();
        let bounds = Bounds {
            min: aabb.min.into(),
            max: aabb.max.into(),
        };
        let parts = model.part_summaries().into_iter().map(|part| PartInfo {
            id: part.id,
            title: part.title,
            shells: part.n_shells,
            solids: part.n_solids,
            triangles: part.n_triangles,
            thickness: part.thickness,
        });
        let files = model.files.iter().map(|file| FileInfo {
            path: file.path.display().to_string(),
            bytes: file.n_bytes,
        });
        Self {
            schema: "shapematch.info/1",
            title: model.title.clone(),
            units: model.stated_units.map(KnownUnits::words),
            files: files.collect(),
            nodes: model.nodes.len(),
            shells: model.shells.len(),
            solids: model.solids.len(),
            parts: parts.collect(),
            bounds: (!aabb.is_empty()).then_some(bounds),
            forming: FormingInfo::of(model),
            diagnostics: model.diagnostics.iter().map(DiagnosticInfo::of).collect(),
            n_diagnostics: model.diagnostics.total(),
        }
    }
}

impl FormingInfo {
    /// Counts the forming results of a model. O(elements).
    pub fn of(model: &Model) -> Self {
        let with_thickness = || {
            model
                .shell_extras
                .iter()
                .filter(|extra| extra.thickness != [0.0; 4])
        };
        // A corner without a thickness of its own has that of the section.
        let corners = with_thickness().flat_map(|extra| {
            let n = model.shells[extra.shell as usize].corners().len();
            let corners = model.shell_thickness(extra.shell).into_iter();
            corners.flat_map(move |corners| corners.into_iter().take(n))
        });
        let corners = corners.filter(|corner| *corner != 0.0);
        // A deck without shells has results for those of another.
        let known: HashSet<u64> = model.shells.iter().map(|shell| shell.id).collect();
        let is_own = |id: u64| known.is_empty() || known.contains(&id);
        let stresses = model.forming.stresses();
        let plastic_strains = stresses
            .filter(|stress| is_own(stress.element_id))
            .flat_map(|stress| stress.points.iter().map(|point| point.plastic_strain));
        let others = &model.forming.others;
        Self {
            thickness: with_thickness().count(),
            stress: n_shells(model.forming.stresses().map(|s| s.element_id), is_own),
            strain: n_shells(model.forming.strains().map(|s| s.element_id), is_own),
            others: others.solid_stress.max(others.solid_strain)
                + others.thick_shell_stress.max(others.thick_shell_strain),
            history_variables: model
                .forming
                .stresses()
                .map(|s| s.n_history)
                .max()
                .unwrap_or(0),
            thickness_range: range(corners),
            plastic_strain_range: range(plastic_strains),
        }
    }

    /// True if there is nothing.
    pub fn is_empty(&self) -> bool {
        self.thickness + self.stress + self.strain + self.others == 0
    }
}

/// How many shells of the deck results with these ids belong to.
fn n_shells(ids: impl Iterator<Item = u64>, is_own: impl Fn(u64) -> bool) -> usize {
    let ids: HashSet<u64> = ids.filter(|&id| is_own(id)).collect();
    ids.len()
}

fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, x| match range {
        None => Some([x, x]),
        Some([low, high]) => Some([low.min(x), high.max(x)]),
    })
}

impl DiagnosticInfo {
    /// The severity at the begin of a line.
    pub(super) fn severity_title(&self) -> &'static str {
        match self.severity {
            "error" => "Error",
            "warning" => "Warning",
            _ => "Note",
        }
    }

    /// The diagnostic field by field.
    pub fn of(diagnostic: &Diagnostic) -> Self {
        let position = diagnostic.position.as_ref();
        Self {
            severity: diagnostic.severity().label(),
            kind: diagnostic.kind.label(),
            file: position.map(|p| p.file.display().to_string()),
            line: position.map(|p| p.line).filter(|&line| line > 0),
            column: position.map(|p| p.column).filter(|&column| column > 0),
            message: diagnostic.message.clone(),
            found: diagnostic.found.clone(),
            expected: diagnostic.expected.clone(),
        }
    }
}
