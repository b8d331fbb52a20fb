//! Wavefront OBJ, read by `tobj`.

use std::io::{BufRead, Cursor, Read, Result};
use std::path::Path;

use super::FormatError;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh};

/// Reads objects and groups as parts, quads as quads. Materials, normals, lines and points are
/// passed over.
pub fn read(bytes: &[u8], path: &Path) -> std::result::Result<Model, FormatError> {
    let options = tobj::LoadOptions {
        ignore_lines: true,
        ignore_points: true,
        ..tobj::LoadOptions::default()
    };
    let text = String::from_utf8_lossy(bytes);
    let mut reader = LineCounter {
        inner: Cursor::new(text.as_bytes()),
        n_lines: 0,
    };
    // Materials would be files of their own and say nothing about shape.
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let loaded = tobj::load_obj_buf(&mut reader, &options, no_materials);
    let broken = |reason: String| FormatError::Broken {
        reason,
        path: path.to_path_buf(),
    };
    let (objects, _) =
        loaded.map_err(|error| broken(format!("{error} in line {}", reader.n_lines)))?;
    let mut polygons = Polygons::new(path);
    for object in &objects {
        polygons.begin_part(&object.name);
        add(&mut polygons, &object.mesh);
    }
    if polygons.n_shells() == 0 {
        return Err(broken("it holds no face".to_owned()));
    }
    Ok(polygons.finish(bytes.len()))
}

fn add(polygons: &mut Polygons, mesh: &tobj::Mesh) {
    let first = polygons.n_points() as u32;
    for point in mesh.positions.chunks_exact(3) {
        polygons.point(Point3::new(point[0], point[1], point[2]));
    }
    let mut rest = &mesh.indices[..];
    // Without a list of sizes all faces are triangles.
    let mut sizes = mesh.face_arities.iter();
    while !rest.is_empty() {
        let size = sizes.next().map_or(3, |&n| n as usize).min(rest.len());
        let (corners, after) = rest.split_at(size);
        let corners: Vec<u32> = corners.iter().map(|c| c.saturating_add(first)).collect();
        polygons.polygon(&corners);
        rest = after;
    }
}

/// Counts the lines that were taken, because the library's errors do not say where they are.
struct LineCounter<R> {
    inner: R,
    n_lines: usize,
}

impl<R: BufRead> Read for LineCounter<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let n = self.fill_buf()?.read(buffer)?;
        self.consume(n);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for LineCounter<R> {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, n: usize) {
        if let Ok(taken) = self.inner.fill_buf() {
            let taken = &taken[..n.min(taken.len())];
            self.n_lines += memchr::memchr_iter(b'\n', taken).count();
        }
        self.inner.consume(n);
    }
}

/// OBJ with coordinates that read back bit-equal.
pub fn write(mesh: &TriMesh, name: &str) -> Vec<u8> {
    let name = name.lines().next().unwrap_or_default();
    let mut text = format!("o {name}\n");
    for p in mesh.positions() {
        text += &format!("v {:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
        text += &format!("f {a} {b} {c}\n");
    }
    text.into_bytes()
}
