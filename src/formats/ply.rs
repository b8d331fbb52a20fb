//! PLY, ASCII and binary of both byte orders.
//!
//! A reader of our own, because the one at hand refuses what exporters write: numbers such as
//! `.5`, blank lines, old headers, strips of triangles, a file whose last faces are cut off.

use std::path::Path;

use super::FormatError;
use super::keyword::number::parse_real;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// Elements between two questions to the monitor.
const CHUNK: usize = 1 << 14;
/// Names of the list with the corners of a face.
const CORNERS: &[&str] = &["vertex_indices", "vertex_index", "vertex_indexes"];

/// Why the file cannot be read on.
enum Stop {
    Broken(String),
    Cancelled(Cancelled),
}

impl From<Cancelled> for Stop {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

/// Reads vertices, faces and strips of triangles of any number type; other elements and properties
/// are passed over. Faces that are cut off are named, and those before them are kept.
pub fn read(bytes: &[u8], path: &Path, monitor: &Monitor) -> Result<Model, FormatError> {
    let mut reader = Reader {
        monitor,
        polygons: Polygons::new(path),
        corners: Vec::new(),
        faces: Vec::new(),
        has_vertices: false,
    };
    let read = header(bytes).and_then(|header| reader.elements(&header, bytes));
    let read = read.and_then(|()| reader.add_faces());
    let broken = |reason| FormatError::Broken {
        reason,
        path: path.to_path_buf(),
    };
    match read {
        Ok(()) if reader.polygons.n_shells() > 0 => Ok(reader.polygons.finish(bytes.len())),
        Ok(()) => Err(broken(match reader.polygons.first_diagnostic() {
            Some(first) => format!("it holds no face; {first}"),
            None => "it holds no face".to_owned(),
        })),
        Err(Stop::Broken(reason)) => Err(broken(reason)),
        Err(Stop::Cancelled(cancelled)) => Err(cancelled.into()),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scalar {
    Int(usize),
    UInt(usize),
    Float(usize),
}

impl Scalar {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Int(1),
            "uchar" | "uint8" => Self::UInt(1),
            "short" | "int16" => Self::Int(2),
            "ushort" | "uint16" => Self::UInt(2),
            "int" | "int32" => Self::Int(4),
            "uint" | "uint32" => Self::UInt(4),
            "long" | "int64" => Self::Int(8),
            "ulong" | "uint64" => Self::UInt(8),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Int(n) | Self::UInt(n) | Self::Float(n) => n,
        }
    }

    /// The value of as many bytes as its size, the least significant first.
    fn value(self, little: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = little;
        match self {
            Self::Int(1) => f64::from(a.cast_signed()),
            Self::Int(2) => f64::from(i16::from_le_bytes([a, b])),
            Self::Int(4) => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::Int(_) => i64::from_le_bytes(little) as f64,
            Self::UInt(_) => u64::from_le_bytes(little) as f64,
            Self::Float(4) => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::Float(_) => f64::from_le_bytes(little),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Property {
    name: String,
    value: Scalar,
    /// The type of the count before the values of a list.
    count: Option<Scalar>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the first element begins, and its line.
    body: usize,
    n_lines: usize,
}

/// Reads the header. Comments and lines that are not known are passed over.
fn header(bytes: &[u8]) -> Result<Header, Stop> {
    let broken = |n: usize, what: &str| Stop::Broken(format!("line {n} of the header {what}"));
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut at, mut n, mut n_elements) = (0, 0, 0_usize);
    loop {
        let length = memchr::memchr2(b'\n', b'\r', &bytes[at..]);
        let length = length.ok_or_else(|| Stop::Broken("its header has no end_header".into()))?;
        let line = String::from_utf8_lossy(&bytes[at..at + length]).into_owned();
        at += length + 1;
        if bytes[at - 1] == b'\r' && bytes.get(at) == Some(&b'\n') {
            at += 1;
        }
        n += 1;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["end_header"] => break,
            ["format", name, ..] => {
                encoding = Some(match name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(broken(n, "names a format that is not known")),
                });
            }
            ["element", name, count] => {
                let count = count.parse::<usize>();
                let count = count.map_err(|_| broken(n, "has a count that is not a number"))?;
                // Every element takes bytes, so counts beyond the file's length are a lie.
                n_elements = n_elements.saturating_add(count);
                if n_elements > bytes.len() {
                    return Err(Stop::Broken(format!(
                        "its header promises {count} elements {name:?}"
                    )));
                }
                elements.push(Element {
                    name: name.to_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", ref words @ ..] => {
                let property = property(words);
                let property = property.ok_or_else(|| broken(n, "has a type that is not known"))?;
                let element = elements.last_mut();
                let element = element.ok_or_else(|| broken(n, "belongs to no element"))?;
                element.properties.push(property);
            }
            _ => {}
        }
    }
    let encoding = encoding.ok_or_else(|| Stop::Broken("its header names no format".into()))?;
    Ok(Header {
        encoding,
        elements,
        body: at,
        n_lines: n,
    })
}

fn property(words: &[&str]) -> Option<Property> {
    let (name, value, count) = match *words {
        ["list", count, value, name] => (name, value, Some(Scalar::of_name(count)?)),
        [value, name] => (name, value, None),
        _ => return None,
    };
    Some(Property {
        name: name.to_ascii_lowercase(),
        value: Scalar::of_name(value)?,
        count,
    })
}

/// Where the values of an element come from.
enum Values<'a> {
    Text(Text<'a>),
    Binary { rest: &'a [u8], is_big: bool },
}

/// What is missing where a value should be.
#[derive(Debug, PartialEq)]
enum Missing {
    End,
    Number { line: usize, found: String },
}

impl Values<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, Missing> {
        match self {
            Self::Text(text) => text.number(),
            Self::Binary { rest, is_big } => {
                let size = scalar.size();
                let (value, after) = rest.split_at_checked(size).ok_or(Missing::End)?;
                let mut little = [0; 8];
                little[..size].copy_from_slice(value);
                if *is_big {
                    little[..size].reverse();
                }
                *rest = after;
                Ok(scalar.value(little))
            }
        }
    }

    /// A list's count; `End` if the file cannot hold as many values.
    fn count(&mut self, count: Scalar, value: Scalar) -> Result<usize, Missing> {
        let n = self.next(count)?;
        let n_left = match self {
            Self::Text(text) => text.rest.len(),
            Self::Binary { rest, .. } => rest.len() / value.size(),
        };
        if n >= 0.0 && n <= n_left as f64 {
            Ok(n as usize)
        } else {
            Err(Missing::End)
        }
    }

    fn end_element(&mut self) {
        if let Self::Text(text) = self {
            text.end_line();
        }
    }
}

/// Words of a text, which may stand on any lines.
struct Text<'a> {
    rest: &'a [u8],
    line: usize,
}

impl Text<'_> {
    fn number(&mut self) -> Result<f64, Missing> {
        let blank = |b: &u8| b.is_ascii_whitespace();
        let start = self.rest.iter().position(|b| !blank(b));
        let start = start.ok_or(Missing::End)?;
        self.line += memchr::memchr_iter(b'\n', &self.rest[..start]).count();
        let rest = &self.rest[start..];
        let (word, rest) = rest.split_at(rest.iter().position(blank).unwrap_or(rest.len()));
        self.rest = rest;
        let value = parse_real(word).or_else(|| {
            let text = std::str::from_utf8(word).ok()?;
            text.parse::<f64>().ok()
        });
        value.ok_or_else(|| Missing::Number {
            line: self.line,
            found: String::from_utf8_lossy(word).into_owned(),
        })
    }

    /// Passes over what an element's line holds beyond its properties.
    fn end_line(&mut self) {
        let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
    }
}

struct Reader<'a> {
    monitor: &'a Monitor,
    polygons: Polygons,
    /// Corners of all faces, and for each face its first and its number.
    corners: Vec<u32>,
    faces: Vec<(usize, usize)>,
    has_vertices: bool,
}

impl Reader<'_> {
    fn elements(&mut self, header: &Header, bytes: &[u8]) -> Result<(), Stop> {
        let rest = &bytes[header.body..];
        let mut values = match header.encoding {
            Encoding::Ascii => Values::Text(Text {
                rest,
                line: header.n_lines + 1,
            }),
            encoding => Values::Binary {
                rest,
                is_big: encoding == Encoding::BigEndian,
            },
        };
        for element in &header.elements {
            let read = match element.name.as_str() {
                "vertex" => self.vertices(element, &mut values)?,
                "face" => self.lists(element, &mut values, Self::face)?,
                "tristrips" => self.lists(element, &mut values, Self::strip)?,
                _ => self.lists(element, &mut values, |_, _| {})?,
            };
            let Err((n, missing)) = read else { continue };
            let (name, count) = (&element.name, element.count);
            let what = match missing {
                Missing::End => format!("it ends after {n} of {count} elements {name:?}"),
                Missing::Number { line, found } => {
                    format!("line {line}: {found:?} is not a number")
                }
            };
            if self.faces.is_empty() {
                return Err(Stop::Broken(what));
            }
            self.polygons
                .warn(None, || format!("{what}; what was read before is kept"));
            break;
        }
        if !self.has_vertices {
            return Err(Stop::Broken("its vertices have no x, y and z".into()));
        }
        Ok(())
    }

    /// The inner error has the number of elements that were read.
    fn vertices(
        &mut self,
        element: &Element,
        values: &mut Values<'_>,
    ) -> Result<Result<(), (usize, Missing)>, Stop> {
        let axis_of = |property: &Property| {
            let axis = ["x", "y", "z"]
                .iter()
                .position(|&name| property.name == name);
            axis.filter(|_| property.count.is_none())
        };
        let axes: Vec<Option<usize>> = element.properties.iter().map(axis_of).collect();
        self.has_vertices = (0..3).all(|axis| axes.contains(&Some(axis)));
        for n in 0..element.count {
            if n.is_multiple_of(CHUNK) {
                self.monitor.check()?;
            }
            let mut position = [f64::NAN; 3];
            for (property, axis) in element.properties.iter().zip(&axes) {
                let read = match (property.count, axis) {
                    (None, Some(axis)) => {
                        let value = values.next(property.value);
                        value.map(|value| position[*axis] = value)
                    }
                    _ => pass_over(property, values),
                };
                if let Err(missing) = read {
                    return Ok(Err((n, missing)));
                }
            }
            values.end_element();
            self.polygons.point(None, Point3::from(position));
        }
        Ok(Ok(()))
    }

    /// Elements of which only a list of corners counts.
    fn lists(
        &mut self,
        element: &Element,
        values: &mut Values<'_>,
        add: impl Fn(&mut Self, &[f64]),
    ) -> Result<Result<(), (usize, Missing)>, Stop> {
        let mut list = Vec::new();
        for n in 0..element.count {
            if n.is_multiple_of(CHUNK) {
                self.monitor.check()?;
            }
            for property in &element.properties {
                let is_named = CORNERS.contains(&property.name.as_str());
                let is_corners = is_named && property.count.is_some();
                let read = if is_corners {
                    read_list(property, values, &mut list)
                } else {
                    pass_over(property, values)
                };
                if let Err(missing) = read {
                    return Ok(Err((n, missing)));
                }
                if is_corners {
                    add(self, &list);
                }
            }
            values.end_element();
        }
        Ok(Ok(()))
    }

    fn face(&mut self, list: &[f64]) {
        let first = self.corners.len();
        self.corners
            .extend(list.iter().map(|&corner| index(corner)));
        self.faces.push((first, list.len()));
    }

    /// Triangles of three neighbours each, every second one turned; a negative index begins the
    /// next strip. Repeated corners, which join strips, make none.
    fn strip(&mut self, list: &[f64]) {
        for strip in list.split(|&corner| corner < 0.0) {
            for (n, corners) in strip.windows(3).enumerate() {
                let [a, b, c] = [0, 1, 2].map(|i| index(corners[i]));
                if a != b && b != c && c != a {
                    let first = self.corners.len();
                    let corners = if n % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    self.corners.extend(corners);
                    self.faces.push((first, 3));
                }
            }
        }
    }

    /// Faces are made when all vertices are known, because they may come first.
    fn add_faces(&mut self) -> Result<(), Stop> {
        for (count, &(first, n)) in self.faces.iter().enumerate() {
            if count.is_multiple_of(CHUNK) {
                self.monitor.check()?;
            }
            self.polygons.polygon(None, &self.corners[first..][..n]);
        }
        Ok(())
    }
}

fn pass_over(property: &Property, values: &mut Values<'_>) -> Result<(), Missing> {
    let n = match property.count {
        Some(count) => values.count(count, property.value)?,
        None => 1,
    };
    for _ in 0..n {
        values.next(property.value)?;
    }
    Ok(())
}

fn read_list(
    property: &Property,
    values: &mut Values<'_>,
    list: &mut Vec<f64>,
) -> Result<(), Missing> {
    list.clear();
    let count = property.count.unwrap_or(property.value);
    for _ in 0..values.count(count, property.value)? {
        list.push(values.next(property.value)?);
    }
    Ok(())
}

/// A vertex's index; one that no vertex has for what is none.
fn index(value: f64) -> u32 {
    let is_index = value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0;
    if is_index { value as u32 } else { u32::MAX }
}

/// Binary little-endian PLY with 64-bit coordinates; the first line of `name` is its comment.
pub fn write(mesh: &TriMesh, name: &str) -> Vec<u8> {
    let name = name.lines().next().unwrap_or_default();
    let (n_vertices, n_triangles) = (mesh.n_vertices(), mesh.n_triangles());
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {name}\n\
         element vertex {n_vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {n_triangles}\nproperty list uchar uint vertex_indices\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    for coordinate in mesh.positions().iter().flat_map(|p| p.iter()) {
        bytes.extend(coordinate.to_le_bytes());
    }
    for triangle in mesh.triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}
