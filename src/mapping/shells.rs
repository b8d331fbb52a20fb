//! Shell elements as the mapping needs them: corners, normals, sizes, neighbours, and the same
//! sheet as triangles.

use std::sync::{Arc, OnceLock};

use super::links::Links;
use crate::geometry::chunks::for_chunks;
use crate::geometry::{MeshError, Point3, Similarity, TriMesh, Vector3, first_at_place};
use crate::monitor::{Cancelled, Monitor};

/// Shells of one sheet, three or four corners each; a triangle repeats its third corner.
#[derive(Debug, Clone)]
pub struct ShellMesh {
    positions: Vec<Point3>,
    corners: Vec<[u32; 4]>,
    parts: Vec<u32>,
    centroids: Vec<Point3>,
    normals: Vec<Vector3>,
    areas: Vec<f64>,
    /// Made when they are first asked for: several steps of a mapping need them.
    links: OnceLock<Arc<Links>>,
}

impl ShellMesh {
    /// Takes nodes and elements; `parts` gives each element a number of the caller's. The normal of
    /// an element is (x₃ − x₁) × (x₄ − x₂), its centroid the mean of its corners, which is where a
    /// one-point element holds its value. An error if a corner names no node or a node is not finite.
    pub fn new(
        positions: Vec<Point3>,
        corners: Vec<[u32; 4]>,
        parts: Vec<u32>,
    ) -> Result<Self, MeshError> {
        assert_eq!(corners.len(), parts.len(), "one part for each element");
        let halves = corners.iter().map(|&[a, b, c, _]| [a, b, c]);
        let other_halves = corners.iter().map(|&[a, _, c, d]| [a, c, d]);
        // The triangle mesh checks indices and coordinates.
        let checked = TriMesh::new(positions, halves.chain(other_halves).collect())?;
        let (positions, _) = checked.into_parts();
        let mut mesh = Self {
            positions,
            corners,
            parts,
            centroids: Vec::new(),
            normals: Vec::new(),
            areas: Vec::new(),
            links: OnceLock::new(),
        };
        let measures = (0..mesh.len()).map(|element| mesh.measure(element));
        let (centroids, (normals, areas)) = measures.unzip();
        (mesh.centroids, mesh.normals, mesh.areas) = (centroids, normals, areas);
        Ok(mesh)
    }

    fn measure(&self, element: usize) -> (Point3, (Vector3, f64)) {
        let x = self.corner_points(element);
        let n = if self.is_triangle(element) { 3 } else { 4 };
        let mean = x[..n].iter().map(|p| p.coords).sum::<Vector3>() / n as f64;
        // Half the cross product of the diagonals is the area of a quad and, with x₄ = x₃, of a
        // triangle.
        let area = (x[2] - x[0]).cross(&(x[3] - x[1])) * 0.5;
        let normal = area.try_normalize(0.0).unwrap_or_default();
        (Point3::from(mean), (normal, area.norm()))
    }

    /// The mesh moved by `target_from_source`. The normals are the moved ones, also under a mirror,
    /// so that the top side of the sheet stays its top side.
    pub fn moved(&self, target_from_source: &Similarity) -> Self {
        let points = self.positions.iter();
        let area_factor = target_from_source.scale * target_from_source.scale;
        let normals = self.normals.iter();
        Self {
            positions: points.map(|p| target_from_source.apply(p)).collect(),
            corners: self.corners.clone(),
            parts: self.parts.clone(),
            centroids: self
                .centroids
                .iter()
                .map(|p| target_from_source.apply(p))
                .collect(),
            normals: normals.map(|n| target_from_source.rotate(n)).collect(),
            areas: self.areas.iter().map(|area| area * area_factor).collect(),
            // Nodes that differ may lie at one place once they are moved.
            links: OnceLock::new(),
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// True if there are no elements.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Positions of the nodes.
    pub fn positions(&self) -> &[Point3] {
        &self.positions
    }

    /// Node indices of the corners of each element.
    pub fn corners(&self) -> &[[u32; 4]] {
        &self.corners
    }

    /// The caller's part number of each element.
    pub fn parts(&self) -> &[u32] {
        &self.parts
    }

    /// Means of the corners.
    pub fn centroids(&self) -> &[Point3] {
        &self.centroids
    }

    /// Unit normals; zero for an element without area.
    pub fn normals(&self) -> &[Vector3] {
        &self.normals
    }

    /// Area of each element.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// True for an element of three corners.
    pub fn is_triangle(&self, element: usize) -> bool {
        let [_, _, c, d] = self.corners[element];
        c == d
    }

    /// Positions of the corners; the fourth of a triangle is its third.
    pub fn corner_points(&self, element: usize) -> [Point3; 4] {
        self.corners[element].map(|node| self.positions[node as usize])
    }

    /// Edge length of a square of the element's area (of two such triangles for a triangle).
    pub fn size(&self, element: usize) -> f64 {
        let cells = if self.is_triangle(element) { 2.0 } else { 1.0 };
        (self.areas[element] * cells).sqrt()
    }

    /// Sum of the areas.
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// The sheet as triangles, quads cut along the shorter diagonal, with the element of each and
    /// normals on the side of the element's. Elements without area are left out.
    pub fn triangles(&self, monitor: &Monitor) -> Result<(TriMesh, Vec<u32>), Cancelled> {
        let mut triangles = Vec::with_capacity(2 * self.len());
        let mut elements = Vec::with_capacity(2 * self.len());
        for_chunks(self.len(), monitor, |range| {
            for element in range {
                for triangle in self.halves(element).into_iter().flatten() {
                    triangles.push(triangle);
                    elements.push(element as u32);
                }
            }
        })?;
        let mesh = TriMesh::new(self.positions.clone(), triangles);
        let mesh = mesh.expect("corners and nodes were checked when the shells were taken");
        Ok((mesh, elements))
    }

    /// The triangles of an element that have an area.
    pub(super) fn halves(&self, element: usize) -> [Option<[u32; 3]>; 2] {
        let own = &self.normals[element];
        if *own == Vector3::zeros() {
            return [None; 2];
        }
        let faced = |mut triangle: [u32; 3]| {
            let [p, q, r] = triangle.map(|node| self.positions[node as usize]);
            let normal = (q - p).cross(&(r - p));
            if normal.dot(own) < 0.0 {
                triangle.swap(1, 2);
            }
            (normal != Vector3::zeros()).then_some(triangle)
        };
        let [a, b, c, d] = self.corners[element];
        let x = self.corner_points(element);
        if c == d {
            [faced([a, b, c]), None]
        } else if (x[2] - x[0]).norm_squared() <= (x[3] - x[1]).norm_squared() {
            [faced([a, b, c]), faced([a, c, d])]
        } else {
            [faced([a, b, d]), faced([b, c, d])]
        }
    }

    /// For each node, the first node at the same position: meshes whose parts do not share nodes
    /// then have no border between them. [`u32::MAX`] for nodes that no element names, or only elements that are
    /// a line or a point.
    pub fn merged_nodes(&self, monitor: &Monitor) -> Result<Vec<u32>, Cancelled> {
        let mut merged = first_at_place(&self.positions, &self.corners, monitor)?;
        let mut is_used = vec![false; merged.len()];
        for_chunks(self.len(), monitor, |range| {
            for corners in &self.corners[range] {
                let [a, b, c, d] = corners.map(|node| merged[node as usize]);
                for [a, b, c] in [[a, b, c], [a, c, d]] {
                    if a != b && b != c && c != a {
                        for node in [a, b, c] {
                            is_used[node as usize] = true;
                        }
                    }
                }
            }
        })?;
        for first in &mut merged {
            if !is_used.get(*first as usize).is_some_and(|&is_used| is_used) {
                *first = u32::MAX;
            }
        }
        Ok(merged)
    }

    /// Neighbours and border of the sheet, through doubled nodes. O(elements) the first time, O(1) then.
    pub fn links(&self, monitor: &Monitor) -> Result<Arc<Links>, Cancelled> {
        if let Some(links) = self.links.get() {
            return Ok(Arc::clone(links));
        }
        let links = Arc::new(Links::of(self, monitor)?);
        Ok(Arc::clone(self.links.get_or_init(|| links)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares side by side that do not share nodes, and a triangle on the right.
    fn strip() -> ShellMesh {
        let at = |x: f64, y: f64| Point3::new(x, y, 1.0);
        let positions = vec![
            at(0.0, 0.0),
            at(1.0, 0.0),
            at(1.0, 1.0),
            at(0.0, 1.0),
            at(1.0, 0.0),
            at(2.0, 0.0),
            at(2.0, 1.0),
            at(1.0, 1.0),
            at(3.0, 0.0),
        ];
        let corners = vec![[0, 1, 2, 3], [4, 5, 6, 7], [5, 8, 6, 6]];
        ShellMesh::new(positions, corners, vec![0; 3]).unwrap()
    }

    #[test]
    fn measures_of_quads_and_triangles() {
        let mesh = strip();
        assert_eq!(mesh.areas(), [1.0, 1.0, 0.5]);
        assert_eq!(mesh.centroids()[0], Point3::new(0.5, 0.5, 1.0));
        assert_eq!(mesh.normals(), [Vector3::z(); 3]);
        assert_eq!(mesh.size(2), 1.0);
        let (triangles, elements) = mesh.triangles(&Monitor::silent()).unwrap();
        assert_eq!(elements, [0, 0, 1, 1, 2]);
        assert_eq!(triangles.area(), 2.5);
    }

    #[test]
    fn neighbours_and_borders_look_through_doubled_nodes() {
        let mesh = strip();
        let links = mesh.links(&Monitor::silent()).unwrap();
        assert_eq!(links.neighbours.of(0), [1]);
        assert_eq!(links.neighbours.of(1), [0, 2]);
        // The left square has three free edges, the middle one two, the triangle two.
        let count = |element: usize| {
            let corners = mesh.corners()[element];
            let n = if mesh.is_triangle(element) { 3 } else { 4 };
            let ends = (0..n).map(|i| [corners[i], corners[(i + 1) % n]]);
            ends.filter(|&ends| links.is_border_edge(element, &corners, ends))
                .count()
        };
        assert_eq!([count(0), count(1), count(2)], [3, 2, 2]);
        let [a, _, c, _] = mesh.corners()[0];
        assert!(!links.is_border_edge(0, &mesh.corners()[0], [a, c]));
        assert!((0..9).all(|node| links.is_border_node(node)));
    }

    #[test]
    fn cracks_between_large_and_small_elements_are_no_border() {
        // A square of 2 with two squares of 1 on its right side, where one of their nodes hangs.
        let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let positions = [
            [0, 0],
            [2, 0],
            [2, 2],
            [0, 2],
            [2, 1],
            [3, 0],
            [3, 1],
            [3, 2],
        ];
        let positions = positions
            .map(|[x, y]| at(f64::from(x), f64::from(y)))
            .to_vec();
        let corners = vec![[0, 1, 2, 3], [1, 5, 6, 4], [4, 6, 7, 2]];
        let mesh = ShellMesh::new(positions, corners, vec![0; 3]).unwrap();
        let links = mesh.links(&Monitor::silent()).unwrap();
        let is_border = |element: usize, ends: [u32; 2]| {
            links.is_border_edge(element, &mesh.corners()[element], ends)
        };
        assert!(!is_border(0, [1, 2]) && !is_border(1, [4, 1]) && !is_border(2, [2, 4]));
        assert!(is_border(0, [0, 1]) && is_border(1, [5, 6]) && is_border(2, [7, 2]));
        assert!(!links.is_border_node(4) && links.is_border_node(1));
    }

    #[test]
    fn a_mirror_keeps_the_top_side() {
        let mesh = strip().moved(&Similarity::mirror_x());
        assert_eq!(mesh.normals()[0], Vector3::z());
        let (triangles, _) = mesh.triangles(&Monitor::silent()).unwrap();
        assert_eq!(triangles.mean_normal(), Vector3::z());
    }
}
