//! PLY, ASCII and binary of both byte orders, read by `ply-rs-bw`.

use std::path::Path;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::FormatError;
use super::model::Model;
use super::polygon::Polygons;
use crate::geometry::{Point3, TriMesh};

/// Reads vertices and faces of any number type; other elements and properties are passed over.
pub fn read(bytes: &[u8], path: &Path) -> Result<Model, FormatError> {
    let broken = |reason: String| FormatError::Broken {
        reason,
        path: path.to_path_buf(),
    };
    let failed = |error: ply_rs_bw::parser::ParseError| {
        let text = error.to_string();
        broken(text.lines().next().unwrap_or_default().trim().to_owned())
    };
    let mut reader = Reader::new(bytes);
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(failed)?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (name, definition) in &header.elements {
        // Every element takes bytes, so a count beyond the file's length is a lie.
        if definition.count > bytes.len() {
            let n = definition.count;
            return Err(broken(format!("its header promises {n} elements {name:?}")));
        }
        match name.as_str() {
            "vertex" => {
                let parser = Parser::<Vertex>::new();
                let read = parser.read_payload_for_element(&mut reader, definition, &header);
                vertices = read.map_err(failed)?;
            }
            "face" => {
                let parser = Parser::<Face>::new();
                let read = parser.read_payload_for_element(&mut reader, definition, &header);
                faces = read.map_err(failed)?;
            }
            _ => {
                let parser = Parser::<Skipped>::new();
                let read = parser.read_payload_for_element(&mut reader, definition, &header);
                read.map_err(failed)?;
            }
        }
    }
    let mut polygons = Polygons::new(path);
    for Vertex(position) in vertices {
        polygons.point(Point3::from(position));
    }
    for Face(corners) in faces {
        polygons.polygon(&corners);
    }
    if polygons.n_shells() == 0 {
        return Err(broken("it holds no face".to_owned()));
    }
    Ok(polygons.finish(bytes.len()))
}

struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([f64::NAN; 3])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match property {
            Property::Double(value) => value,
            other => match other.to_f32_lossy() {
                Some(value) => f64::from(value),
                None => return PropertyAccessResult::UnsupportedType,
            },
        };
        PropertyAccessResult::Set
    }
}

struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        // A negative index becomes one that no vertex has.
        self.0 = property.to_u32_list().unwrap_or_else(|| vec![u32::MAX; 3]);
        PropertyAccessResult::Set
    }
}

/// An element that is read past.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
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
