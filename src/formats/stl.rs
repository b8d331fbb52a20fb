//! STL, binary and ASCII.
//!
//! Binary files go through `stl_io`. ASCII is read here, because `stl_io` ends after the first
//! solid, rounds to 32 bits and cannot tell the line of an error.

use std::io::Cursor;
use std::path::Path;

use super::FormatError;
use super::keyword::number::parse_real;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh, Vector3};

/// Bytes before the triangles of a binary file, and of each triangle.
const HEADER: usize = 84;
const RECORD: usize = 50;

/// Reads either kind. Each solid becomes a part; equal points are not joined.
pub fn read(bytes: &[u8], path: &Path) -> Result<Model, FormatError> {
    let mut polygons = Polygons::new(path);
    if is_binary(bytes) {
        read_binary(bytes, &mut polygons);
    } else {
        read_ascii(bytes, &mut polygons);
    }
    if polygons.n_shells() == 0 {
        return Err(FormatError::Broken {
            reason: "it holds no triangle".to_owned(),
            path: path.to_path_buf(),
        });
    }
    Ok(polygons.finish(bytes.len()))
}

/// A count that fits the length decides; binary files may begin with `solid` too.
fn is_binary(bytes: &[u8]) -> bool {
    let Some(&[a, b, c, d]) = bytes.get(80..HEADER) else {
        return false;
    };
    let count = u32::from_le_bytes([a, b, c, d]) as usize;
    let begins_as_text = bytes.trim_ascii_start().get(..5);
    let begins_as_text = begins_as_text.is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    bytes.len() == HEADER + count * RECORD || !begins_as_text
}

fn read_binary(bytes: &[u8], polygons: &mut Polygons) {
    // The library takes a header that begins with `solid` for text.
    let neutral;
    let bytes = if bytes.starts_with(b"solid") {
        neutral = [&[b' '; 80][..], &bytes[80..]].concat();
        &neutral[..]
    } else {
        bytes
    };
    let mut cursor = Cursor::new(bytes);
    let reader = match stl_io::create_stl_reader(&mut cursor) {
        Ok(reader) => reader,
        Err(error) => {
            polygons.warn(None, error.to_string());
            return;
        }
    };
    for triangle in reader {
        let Ok(triangle) = triangle else {
            let n = polygons.n_shells();
            polygons.warn(
                None,
                format!("the file ends after {n} triangles, before its own count"),
            );
            return;
        };
        add(polygons, triangle.vertices.map(|v| v.0.map(f64::from)));
    }
}

fn add(polygons: &mut Polygons, corners: [[f64; 3]; 3]) {
    let first = polygons.n_points() as u32;
    for corner in corners {
        polygons.point(Point3::from(corner));
    }
    polygons.polygon(&[first, first + 1, first + 2]);
}

fn read_ascii(bytes: &[u8], polygons: &mut Polygons) {
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut lines = 0;
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        lines = index + 1;
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|w| !w.is_empty());
        let Some(first) = words.next() else {
            continue;
        };
        match first.to_ascii_lowercase().as_slice() {
            b"solid" => {
                let title = line.trim_ascii()[5..].trim_ascii();
                polygons.begin_part(&String::from_utf8_lossy(title));
            }
            b"vertex" => match vertex(words) {
                Some(corner) => corners.push(corner),
                None => {
                    let text = String::from_utf8_lossy(line.trim_ascii()).into_owned();
                    polygons.warn(Some(lines), format!("{text:?} is not a vertex"));
                }
            },
            b"endfacet" => {
                match <[[f64; 3]; 3]>::try_from(corners.as_slice()) {
                    Ok(corners) => add(polygons, corners),
                    Err(_) => {
                        let n = corners.len();
                        polygons.warn(Some(lines), format!("a facet has {n} vertices, expected 3"));
                    }
                }
                corners.clear();
            }
            b"facet" | b"outer" | b"endloop" | b"endsolid" | b"color" => {}
            _ => {
                let text = String::from_utf8_lossy(first).into_owned();
                polygons.warn(Some(lines), format!("{text:?} is not a word of STL"));
            }
        }
    }
    if !corners.is_empty() {
        polygons.warn(Some(lines), "the file ends within a facet");
    }
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<[f64; 3]> {
    let mut corner = [0.0; 3];
    for coordinate in &mut corner {
        *coordinate = parse_real(words.next()?)?;
    }
    words.next().is_none().then_some(corner)
}

/// Binary STL: 32-bit coordinates, so 5 m from the origin they are rounded to 0.0005 mm.
pub fn write_binary(mesh: &TriMesh) -> Vec<u8> {
    let vector = |v: Vector3| [v.x as f32, v.y as f32, v.z as f32];
    let triangles: Vec<stl_io::Triangle> = (0..mesh.n_triangles())
        .map(|t| stl_io::Triangle {
            normal: stl_io::Normal::new(vector(mesh.normal(t))),
            vertices: mesh
                .corners(t)
                .map(|p| stl_io::Vertex::new(vector(p.coords))),
        })
        .collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter()).expect("writing to memory does not fail");
    bytes
}

/// ASCII STL with coordinates that read back bit-equal.
pub fn write_ascii(mesh: &TriMesh, name: &str) -> Vec<u8> {
    let name = name.lines().next().unwrap_or_default();
    let mut text = format!("solid {name}\n");
    for t in 0..mesh.n_triangles() {
        let n = mesh.normal(t);
        text += &format!("facet normal {:?} {:?} {:?}\n outer loop\n", n.x, n.y, n.z);
        for p in mesh.corners(t) {
            text += &format!("  vertex {:?} {:?} {:?}\n", p.x, p.y, p.z);
        }
        text += " endloop\nendfacet\n";
    }
    text += &format!("endsolid {name}\n");
    text.into_bytes()
}
