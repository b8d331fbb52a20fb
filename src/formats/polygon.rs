//! What STL, OBJ and PLY have in common: points and polygons that become a model.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position};
use super::model::{Model, Nodes, Part, ReadFile, Shell};
use super::triangulate::{is_convex, triangulated};
use super::{MAX_LENGTH, text};
use crate::geometry::Point3;

/// More points than indices of 32 bits can name, which leaves the last one free.
const MAX_POINTS: usize = u32::MAX as usize - 1;

/// Collects points and polygons; [`Polygons::finish`] makes the model. Ids count from 1.
pub(super) struct Polygons {
    positions: Vec<Point3>,
    shells: Vec<Shell>,
    /// Polygons so far, those that were left out as well.
    n_polygons: usize,
    parts: Vec<Part>,
    /// Index of the part that polygons belong to; `None` until its first polygon makes it.
    current: Option<u32>,
    title: String,
    /// The last part of each title.
    last_of_title: HashMap<String, u32>,
    diagnostics: Diagnostics,
    file: Arc<Path>,
}

impl Polygons {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            positions: Vec::new(),
            shells: Vec::new(),
            n_polygons: 0,
            parts: Vec::new(),
            current: None,
            title: String::new(),
            last_of_title: HashMap::new(),
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

    /// Begins a part; polygons belong to the part begun last. One without polygons is not kept.
    pub(super) fn begin_part(&mut self, title: &[u8]) {
        self.title = text::shown(title);
        self.current = None;
    }

    /// Goes on with the last part of this title, or begins it.
    pub(super) fn resume_part(&mut self, title: &[u8]) {
        self.begin_part(title);
        self.current = self.last_of_title.get(&self.title).copied();
    }

    fn part(&mut self) -> u32 {
        *self.current.get_or_insert_with(|| {
            self.parts.push(Part {
                id: self.parts.len() as u64 + 1,
                title: self.title.clone(),
                is_defined: true,
                ..Part::default()
            });
            let last = self.parts.len() as u32 - 1;
            self.last_of_title.insert(self.title.clone(), last);
            last
        })
    }

    /// Adds a point. One that is no place is named, and polygons that use it are left out.
    pub(super) fn point(&mut self, line: Option<usize>, position: Point3) {
        if self.positions.len() == MAX_POINTS {
            self.add_diagnostic(DiagnosticKind::LimitReached, line, || {
                format!("points beyond the first {MAX_POINTS} are left out")
            });
            return;
        }
        if !is_place(&position) {
            let n = self.positions.len() + 1;
            if position.iter().all(|x| x.is_finite()) {
                self.add_diagnostic(DiagnosticKind::NumberTooLarge, line, || {
                    format!("point {n} has a coordinate beyond {MAX_LENGTH:e}")
                });
            } else {
                self.add_diagnostic(DiagnosticKind::NotFinite, line, || {
                    format!("point {n} has a coordinate that is not finite")
                });
            }
        }
        self.positions.push(position);
    }

    /// Adds a polygon of three or more corners; a concave one, and one of more than four corners,
    /// is cut into triangles.
    pub(super) fn polygon(&mut self, line: Option<usize>, corners: &[u32]) {
        let usable = |&corner: &u32| {
            let point = self.positions.get(corner as usize);
            point.is_some_and(is_place)
        };
        self.n_polygons += 1;
        let which = format!("polygon {}", self.n_polygons);
        if corners.len() < 3 {
            self.warn(line, || format!("{which} has fewer than three corners"));
            return;
        }
        if !corners.iter().all(usable) {
            self.warn(line, || {
                format!("{which} names a point that cannot be used")
            });
            return;
        }
        if let [a, b, c] = *corners {
            self.shell([a, b, c, c]);
            return;
        }
        let points: Vec<Point3> = corners
            .iter()
            .map(|&corner| self.positions[corner as usize])
            .collect();
        if let [a, b, c, d] = *corners
            && is_convex(&points)
        {
            self.shell([a, b, c, d]);
            return;
        }
        let Some(triangles) = triangulated(&points) else {
            let n_corners = corners.len();
            self.warn(line, || {
                format!(
                    "{which} is concave, has {n_corners} corners and is \
                     left out"
                )
            });
            return;
        };
        for triangle in triangles {
            let [a, b, c] = triangle.map(|i| corners[i]);
            self.shell([a, b, c, c]);
        }
    }

    fn shell(&mut self, nodes: [u32; 4]) {
        let part = self.part();
        self.shells.push(Shell {
            id: self.shells.len() as u64 + 1,
            nodes,
            part,
        });
    }

    /// Names an oddity of the file, with its line if that is known.
    pub(super) fn warn(&mut self, line: Option<usize>, message: impl FnOnce() -> String) {
        self.add_diagnostic(DiagnosticKind::Mesh, line, message);
    }

    fn add_diagnostic(
        &mut self,
        kind: DiagnosticKind,
        line: Option<usize>,
        message: impl FnOnce() -> String,
    ) {
        let file = &self.file;
        self.diagnostics.push_with(kind, || {
            let mut position = Position::file(file);
            position.line = line.unwrap_or(0) as u64;
            Diagnostic::new(kind, message()).at(position)
        });
    }

    /// The first diagnostic, which may be why a file holds nothing.
    pub(super) fn first_diagnostic(&self) -> Option<String> {
        let first = self.diagnostics.iter().next()?;
        Some(match &first.position {
            Some(position) if position.line > 0 => {
                format!("line {}: {}", position.line, first.message)
            }
            _ => first.message.clone(),
        })
    }

    /// The model. Points that are no place are nowhere used and stand at the origin.
    pub(super) fn finish(mut self, n_bytes: usize) -> Model {
        for position in &mut self.positions {
            if !is_place(position) {
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
                ..ReadFile::default()
            }],
            ..Model::default()
        }
    }
}

/// True for coordinates that a mesh can have; false for NaN.
fn is_place(position: &Point3) -> bool {
    position.iter().all(|x| x.abs() <= MAX_LENGTH)
}
