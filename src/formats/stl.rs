//! STL, binary and ASCII.

use std::path::Path;

use super::FormatError;
use super::keyword::number::parse_real;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Bytes before the triangles of a binary file: text and their number.
pub(super) const HEADER: usize = 84;
/// Bytes of each triangle: normal, three corners, two bytes of attributes.
const RECORD: usize = 50;
/// Triangles between two questions to the monitor.
const CHUNK: usize = 1 << 14;

/// Reads either kind. Each solid becomes a part; equal points are not joined. What cannot be read
/// is named and left out.
pub fn read(bytes: &[u8], path: &Path, monitor: &Monitor) -> Result<Model, FormatError> {
    let mut polygons = Polygons::new(path);
    if is_binary(bytes) {
        read_binary(bytes, &mut polygons, monitor)?;
    } else {
        let mut text = Text {
            words: Words::new(bytes),
            corners: Vec::new(),
            is_in_solid: false,
            is_in_facet: false,
            polygons,
        };
        text.read(monitor)?;
        polygons = text.polygons;
    }
    if polygons.n_shells() == 0 {
        let reason = match polygons.first_diagnostic() {
            Some(first) => format!("it holds no triangle; {first}"),
            None => "it holds no triangle".to_owned(),
        };
        return Err(FormatError::Broken {
            reason,
            path: path.to_path_buf(),
        });
    }
    Ok(polygons.finish(bytes.len()))
}

/// The number of triangles that a binary file states.
fn stated_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

/// True if the length is that of a binary file with as many triangles as it states.
pub(super) fn has_binary_length(bytes: &[u8]) -> bool {
    stated_count(bytes).is_some_and(|n| bytes.len() == HEADER + n * RECORD)
}

/// Binary files may begin with `solid` too; what no text holds tells them then.
fn is_binary(bytes: &[u8]) -> bool {
    let begins_as_text = bytes.trim_ascii_start().get(..5);
    let begins_as_text = begins_as_text.is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let sample = &bytes[..bytes.len().min(512)];
    has_binary_length(bytes) || bytes.len() >= HEADER && (!begins_as_text || sample.contains(&0))
}

fn read_binary(bytes: &[u8], polygons: &mut Polygons, monitor: &Monitor) -> Result<(), Cancelled> {
    let stated = stated_count(bytes).unwrap_or(0);
    let body = &bytes[HEADER..];
    let held = body.len() / RECORD;
    // Some programs write the number last and, when they are stopped, never.
    let n = if stated == 0 { held } else { stated.min(held) };
    for (index, record) in body.chunks_exact(RECORD).take(n).enumerate() {
        if index.is_multiple_of(CHUNK) {
            monitor.check()?;
        }
        let coordinate = |i: usize| {
            let at = 12 + 4 * i;
            let four = [record[at], record[at + 1], record[at + 2], record[at + 3]];
            f64::from(f32::from_le_bytes(four))
        };
        let corners = [0, 3, 6].map(|i| [coordinate(i), coordinate(i + 1), coordinate(i + 2)]);
        add(polygons, None, &corners);
    }
    if stated > held {
        polygons.warn(None, || {
            format!("the file ends after {held} of {stated} triangles")
        });
    } else if body.len() > n * RECORD || stated != n {
        polygons.warn(None, || {
            let n_more = body.len() - n * RECORD;
            format!("its header states {stated} triangles; {n} were read, {n_more} bytes left out")
        });
    }
    Ok(())
}

fn add(polygons: &mut Polygons, line: Option<usize>, corners: &[[f64; 3]]) {
    let first = polygons.n_points() as u32;
    for &corner in corners {
        polygons.point(line, Point3::from(corner));
    }
    let corners: Vec<u32> = (0..corners.len() as u32).map(|i| first + i).collect();
    polygons.polygon(line, &corners);
}

/// The words of a text with their lines.
#[derive(Clone)]
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes,
            line: 1,
        }
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        let blank = |b: &u8| b.is_ascii_whitespace();
        let start = self.rest.iter().position(|b| !blank(b))?;
        self.line += memchr::memchr_iter(b'\n', &self.rest[..start]).count();
        let rest = &self.rest[start..];
        let (word, rest) = rest.split_at(rest.iter().position(blank).unwrap_or(rest.len()));
        self.rest = rest;
        Some(word)
    }

    /// The next word if `is_wanted`; else it stays.
    fn next_if<T>(&mut self, is_wanted: impl Fn(&[u8]) -> Option<T>) -> Option<T> {
        let mut ahead = self.clone();
        let value = is_wanted(ahead.next()?)?;
        *self = ahead;
        Some(value)
    }

    /// The rest of the line, up to a word that begins something else in a file of one line.
    fn name(&mut self) -> &'a [u8] {
        let all = self.rest;
        let (mut at, mut end) = (0, 0);
        // A file of one line has many names, so none is looked for beyond its end.
        loop {
            let is_blank = |b: &u8| b.is_ascii_whitespace() && *b != b'\n';
            let ahead = all[at..].iter().position(|b| !is_blank(b));
            at = ahead.map_or(all.len(), |n| at + n);
            let rest = &all[at..];
            let n = rest.iter().position(u8::is_ascii_whitespace);
            let word = &rest[..n.unwrap_or(rest.len())];
            let begins_other = [&b"facet"[..], b"solid", b"endsolid"];
            if word.is_empty() || begins_other.contains(&&word.to_ascii_lowercase()[..]) {
                self.rest = &all[end..];
                return all[..end].trim_ascii();
            }
            at += word.len();
            end = at;
        }
    }
}

/// An ASCII file that is being read. Its words may stand on any lines.
struct Text<'a> {
    words: Words<'a>,
    corners: Vec<[f64; 3]>,
    /// A solid, a facet that has begun and not ended.
    is_in_solid: bool,
    is_in_facet: bool,
    polygons: Polygons,
}

impl Text<'_> {
    fn read(&mut self, monitor: &Monitor) -> Result<(), Cancelled> {
        let mut n = 0usize;
        while let Some(word) = self.words.next() {
            if n.is_multiple_of(CHUNK) {
                monitor.check()?;
            }
            n += 1;
            let line = Some(self.words.line);
            match word.to_ascii_lowercase().as_slice() {
                b"solid" => {
                    let name = self.words.name();
                    self.polygons.begin_part(name);
                    self.is_in_solid = true;
                }
                b"endsolid" => {
                    self.words.name();
                    self.is_in_solid = false;
                }
                b"vertex" => self.vertex(),
                b"endfacet" => self.end_facet(),
                b"normal" | b"color" => while self.words.next_if(real).is_some() {},
                b"facet" => self.begin_facet(),
                b"outer" | b"loop" | b"endloop" => {}
                _ => self.polygons.warn(line, || {
                    let text = String::from_utf8_lossy(word).into_owned();
                    format!("{text:?} is not a word of STL")
                }),
            }
        }
        let cut = if self.is_in_facet || !self.corners.is_empty() {
            "the file ends within a facet, which is left out; the rest of it is probably missing"
        } else if self.is_in_solid {
            "the file ends without endsolid; facets at its end may be missing"
        } else {
            return Ok(());
        };
        let line = Some(self.words.line);
        self.polygons.warn(line, || cut.to_owned());
        Ok(())
    }

    fn vertex(&mut self) {
        let line = Some(self.words.line);
        let mut corner = [0.0; 3];
        for (n, coordinate) in corner.iter_mut().enumerate() {
            let Some(value) = self.words.next_if(real) else {
                self.polygons
                    .warn(line, || format!("a vertex has {n} coordinates, expected 3"));
                return;
            };
            *coordinate = value;
        }
        self.corners.push(corner);
    }

    fn begin_facet(&mut self) {
        if self.is_in_facet {
            let line = Some(self.words.line);
            let text = || "a facet ends without endfacet; its vertices are left out".to_owned();
            self.polygons.warn(line, text);
            self.corners.clear();
        }
        self.is_in_facet = true;
    }

    fn end_facet(&mut self) {
        let line = Some(self.words.line);
        let n = self.corners.len();
        if n < 3 {
            self.polygons
                .warn(line, || format!("a facet has {n} vertices, expected 3"));
        } else {
            add(&mut self.polygons, line, &self.corners);
        }
        self.corners.clear();
        self.is_in_facet = false;
    }
}

/// A number, also one that is not finite, which is named when the point is added.
fn real(word: &[u8]) -> Option<f64> {
    parse_real(word).or_else(|| std::str::from_utf8(word).ok()?.parse().ok())
}

/// Binary STL: 32-bit coordinates, so 5 m from the origin they are rounded to 0.0005 mm.
pub fn write_binary(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.n_triangles() as u32).to_le_bytes());
    for t in 0..mesh.n_triangles() {
        let corners = mesh.corners(t).map(|p| p.coords);
        for v in [mesh.normal(t), corners[0], corners[1], corners[2]] {
            let v: Vector3 = v;
            bytes.extend(v.iter().flat_map(|&x| (x as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}
