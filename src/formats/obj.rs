//! Wavefront OBJ.
//!
//! A reader of our own, because those at hand stop at the first oddity that exporters write: a
//! `usemtl` without a name, colours at some vertices only, one index of no vertex. They also make
//! triangles of lines and points and divide coordinates by a fourth one, which is the weight of
//! curves and no part of a polygon's place.

use std::path::Path;

use super::FormatError;
use super::keyword::number::parse_real;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh};
use crate::monitor::Monitor;

/// Lines between two questions to the monitor.
const CHUNK: usize = 1 << 14;

/// Reads objects and groups as parts, quads as quads. Materials, normals, lines, points and curves
/// are passed over. What cannot be read is named and left out.
pub fn read(bytes: &[u8], path: &Path, monitor: &Monitor) -> Result<Model, FormatError> {
    let mut faces = Faces::default();
    let mut polygons = Polygons::new(path);
    let mut lines = Lines { rest: bytes, n: 0 };
    let mut joined = Vec::new();
    let mut n_read = 0usize;
    while let Some((line, number)) = lines.next(&mut joined) {
        if n_read.is_multiple_of(CHUNK) {
            monitor.check()?;
        }
        n_read += 1;
        read_line(line, number, &mut polygons, &mut faces);
    }
    for (index, group) in faces.groups.iter().enumerate() {
        polygons.resume_part(&group.title);
        let end = faces.groups.get(index + 1);
        let end = end.map_or(faces.faces.len(), |next| next.first_face);
        for (count, face) in faces.faces[group.first_face..end].iter().enumerate() {
            if count.is_multiple_of(CHUNK) {
                monitor.check()?;
            }
            let corners = &faces.corners[face.first..][..face.n];
            polygons.polygon(Some(face.line), corners);
        }
    }
    if polygons.n_shells() == 0 {
        let reason = match polygons.first_diagnostic() {
            Some(first) => format!("it holds no face; {first}"),
            None => "it holds no face".to_owned(),
        };
        return Err(FormatError::Broken {
            reason,
            path: path.to_path_buf(),
        });
    }
    Ok(polygons.finish(bytes.len()))
}

/// Faces with the indices of their corners from 0, to be made when all vertices are known.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    faces: Vec<Face>,
    groups: Vec<Group>,
}

struct Face {
    line: usize,
    first: usize,
    n: usize,
}

struct Group {
    title: Vec<u8>,
    first_face: usize,
}

/// Lines without comments, continued ones joined.
struct Lines<'a> {
    rest: &'a [u8],
    n: usize,
}

impl<'a> Lines<'a> {
    /// The next line and its number, from 1; `joined` holds the text of continued lines.
    fn next<'b>(&mut self, joined: &'b mut Vec<u8>) -> Option<(&'b [u8], usize)>
    where
        'a: 'b,
    {
        let line = self.piece()?;
        let number = self.n;
        let Some(begun) = line.strip_suffix(b"\\") else {
            return Some((line, number));
        };
        joined.clear();
        joined.extend_from_slice(begun);
        while let Some(line) = self.piece() {
            joined.push(b' ');
            match line.strip_suffix(b"\\") {
                Some(more) => joined.extend_from_slice(more),
                None => {
                    joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some((joined, number))
    }

    fn piece(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr::memchr(b'\n', self.rest);
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &b""[..]),
        };
        self.rest = rest;
        self.n += 1;
        // A name may hold the sign; a comment has it at its start.
        let mut signs = memchr::memchr_iter(b'#', line);
        let comment = signs.find(|&at| at == 0 || line[at - 1].is_ascii_whitespace());
        Some(line[..comment.unwrap_or(line.len())].trim_ascii())
    }
}

fn read_line(line: &[u8], number: usize, polygons: &mut Polygons, faces: &mut Faces) {
    let end = line.iter().position(u8::is_ascii_whitespace);
    let (word, rest) = line.split_at(end.unwrap_or(line.len()));
    match word {
        b"v" | b"V" => vertex(rest, number, polygons),
        b"f" | b"F" | b"fo" => face(rest, number, polygons, faces),
        b"o" | b"O" | b"g" | b"G" => faces.groups.push(Group {
            title: rest.trim_ascii().to_vec(),
            first_face: faces.faces.len(),
        }),
        _ => {}
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// Three coordinates; a fourth is a weight, and colours may follow. A vertex that cannot be read
/// keeps its number, so that the faces name the right ones.
fn vertex(line: &[u8], number: usize, polygons: &mut Polygons) {
    let mut position = [f64::NAN; 3];
    let mut words = words(line);
    let mut is_good = true;
    for coordinate in &mut position {
        let word = words.next().unwrap_or_default();
        *coordinate = match parse_real(word) {
            Some(value) => value,
            None => {
                is_good &= is_not_finite_word(word);
                f64::NAN
            }
        };
    }
    if !is_good {
        polygons.warn(Some(number), || {
            let text = String::from_utf8_lossy(line.trim_ascii()).into_owned();
            format!("{text:?} is not a vertex")
        });
    }
    polygons.point(Some(number), Point3::from(position));
}

fn is_not_finite_word(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").unwrap_or(word).to_ascii_lowercase();
    word.starts_with(b"nan") || word.starts_with(b"inf")
}

/// Corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative ones count back from the last vertex.
/// An index of no vertex stays one, and the polygon is left out when it is made.
fn face(line: &[u8], number: usize, polygons: &mut Polygons, faces: &mut Faces) {
    const NO_VERTEX: u32 = u32::MAX;
    if faces.groups.is_empty() {
        faces.groups.push(Group {
            title: Vec::new(),
            first_face: 0,
        });
    }
    let n_points = polygons.n_points() as i64;
    let first = faces.corners.len();
    for word in words(line) {
        let index = word.split(|&b| b == b'/').next().unwrap_or_default();
        let index = std::str::from_utf8(index).ok().and_then(|i| i.parse().ok());
        let index: i64 = index.unwrap_or(0);
        let from_zero = if index < 0 {
            n_points + index
        } else {
            index - 1
        };
        let corner = u32::try_from(from_zero).unwrap_or(NO_VERTEX);
        // Some exporters repeat a corner in place of a triangle's fourth.
        if faces.corners[first..].last() != Some(&corner) {
            faces.corners.push(corner);
        }
    }
    if faces.corners.len() - first > 3 && faces.corners.last() == faces.corners.get(first) {
        faces.corners.pop();
    }
    faces.faces.push(Face {
        line: number,
        first,
        n: faces.corners.len() - first,
    });
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
