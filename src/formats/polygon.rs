//! What STL, OBJ and PLY have in common: points and polygons that become a model.

use std::path::Path;
use std::sync::Arc;

use super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position};
use super::model::{Model, Nodes, Part, ReadFile, Shell};
use crate::geometry::Point3;

/// Collects points and polygons; [`Polygons::finish`] makes the model. Ids count from 1.
pub(super) struct Polygons {
    positions: Vec<Point3>,
    shells: Vec<Shell>,
    parts: Vec<Part>,
    diagnostics: Diagnostics,
    file: Arc<Path>,
}

impl Polygons {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            positions: Vec::new(),
            shells: Vec::new(),
            parts: Vec::new(),
            diagnostics: Diagnostics::default(),
            file: Arc::from(file),
        }
    }

    pub(super) fn n_points(&self) -> usize {
        self.positions.len()
    }

    pub(super) fn n_shells(&self) -> usize {
        self.shells.len()
    }

    /// Begins a part; polygons belong to the part begun last.
    pub(super) fn begin_part(&mut self, title: &str) {
        // A part without polygons is a name only and gives way to the next one.
        let last_used = self.shells.last().map(|shell| shell.part as usize + 1);
        self.parts.truncate(last_used.unwrap_or(0));
        self.parts.push(Part {
            id: self.parts.len() as u64 + 1,
            title: title.trim().to_owned(),
            is_defined: true,
            ..Part::default()
        });
    }

    /// Adds a point. One that is not finite is named, and polygons that use it are left out.
    pub(super) fn point(&mut self, position: Point3) {
        if !position.iter().all(|x| x.is_finite()) {
            let kind = DiagnosticKind::NotFinite;
            let n = self.positions.len() + 1;
            let file = &self.file;
            self.diagnostics.push_with(kind, || {
                let message = format!("point {n} has a coordinate that is not finite");
                Diagnostic::new(kind, message).at(Position::file(file))
            });
        }
        self.positions.push(position);
    }

    /// Adds a polygon of three or more corners; beyond four it is cut into a fan.
    pub(super) fn polygon(&mut self, corners: &[u32]) {
        let usable = |&corner: &u32| {
            let point = self.positions.get(corner as usize);
            point.is_some_and(|p| p.iter().all(|x| x.is_finite()))
        };
        if corners.len() < 3 || !corners.iter().all(usable) {
            let n = self.shells.len() + 1;
            let message = if corners.len() < 3 {
                format!(
                    "the polygon after element {} has fewer than three corners",
                    n - 1
                )
            } else {
                format!(
                    "the polygon after element {} names a point that cannot be used",
                    n - 1
                )
            };
            self.warn(None, message);
            return;
        }
        if self.parts.is_empty() {
            self.begin_part("");
        }
        match *corners {
            [a, b, c] => self.shell([a, b, c, c]),
            [a, b, c, d] => self.shell([a, b, c, d]),
            _ => {
                for pair in corners[1..].windows(2) {
                    self.shell([corners[0], pair[0], pair[1], pair[1]]);
                }
            }
        }
    }

    fn shell(&mut self, nodes: [u32; 4]) {
        self.shells.push(Shell {
            id: self.shells.len() as u64 + 1,
            nodes,
            part: self.parts.len() as u32 - 1,
        });
    }

    /// Names an oddity of the file, with its line if that is known.
    pub(super) fn warn(&mut self, line: Option<usize>, message: impl Into<String>) {
        let mut position = Position::file(&self.file);
        position.line = line.unwrap_or(0) as u64;
        let kind = DiagnosticKind::Mesh;
        let finding = || Diagnostic::new(kind, message).at(position);
        self.diagnostics.push_with(kind, finding);
    }

    /// The model. Points that are not finite are nowhere used and stand at the origin.
    pub(super) fn finish(mut self, n_bytes: usize) -> Model {
        for position in &mut self.positions {
            if !position.iter().all(|x| x.is_finite()) {
                *position = Point3::origin();
            }
        }
        let ids = (1..=self.positions.len() as u64).collect();
        let title = self.parts.first().map(|part| part.title.clone());
        Model {
            title: title.unwrap_or_default(),
            nodes: Nodes::new(ids, self.positions).0,
            shells: self.shells,
            parts: self.parts,
            diagnostics: self.diagnostics,
            files: vec![ReadFile {
                path: self.file.to_path_buf(),
                n_bytes: n_bytes as u64,
                hash: None,
            }],
            ..Model::default()
        }
    }
}
