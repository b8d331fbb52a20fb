//! A rough mesh of few triangles in one pass over a fine one: vertices are merged by the cells of a grid
//! (Rossignac and Borrel 1993). For pictures only; what is measured comes from `simplify`.

use std::collections::{HashMap, HashSet};

use super::{Aabb, Point3, TriMesh, Vector3};

/// Triangles a sheet has in each cell it passes through.
const PER_CELL: f64 = 2.0;

/// A mesh whose vertices were merged, and where its pieces come from.
#[derive(Debug, Clone)]
pub struct MergedMesh {
    /// The rough mesh.
    pub mesh: TriMesh,
    /// A vertex of the fine mesh for each of its vertices.
    pub vertex_of: Vec<u32>,
    /// The triangle of the fine mesh for each of its triangles.
    pub triangle_of: Vec<u32>,
}

/// One cell of the grid with what lies in it.
struct Cell {
    sum: Vector3,
    n: f64,
    /// The first vertex in it.
    vertex: u32,
}

impl MergedMesh {
    /// A mesh of about `n_triangles` triangles; `None` where the fine one has no area, or is so thin and
    /// long that the cells cannot be counted. O(triangles).
    pub fn of(mesh: &TriMesh, n_triangles: usize) -> Option<Self> {
        let bounds = mesh.aabb();
        let side = (PER_CELL * mesh.area() / n_triangles.max(1) as f64).sqrt();
        let steps = bounds.diagonal() / side;
        if !(side > 0.0 && steps.is_finite() && steps < 1e6) {
            return None;
        }
        let (cells, cell_of) = cells(mesh, &bounds, side);
        let mut triangle_of = Vec::new();
        let mut triangles = Vec::new();
        let mut seen = HashSet::new();
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = corners.map(|v| cell_of[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            let mut key = [a, b, c];
            key.sort_unstable();
            if seen.insert(key) {
                triangles.push([a, b, c]);
                triangle_of.push(t as u32);
            }
        }
        let center = |cell: &Cell| Point3::from(cell.sum / cell.n);
        let mesh = TriMesh::new(cells.iter().map(center).collect(), triangles).ok()?;
        Some(Self {
            mesh,
            vertex_of: cells.iter().map(|cell| cell.vertex).collect(),
            triangle_of,
        })
    }
}

/// The cells that hold vertices, in the order of their first vertex, and the cell of each vertex.
fn cells(mesh: &TriMesh, bounds: &Aabb, side: f64) -> (Vec<Cell>, Vec<u32>) {
    let low = bounds.center() - 0.5 * bounds.extents();
    let mut numbers: HashMap<[i32; 3], u32> = HashMap::new();
    let mut cells: Vec<Cell> = Vec::new();
    let place = |(vertex, p): (usize, &Point3)| {
        let key: [i32; 3] = ((p - low) / side).map(|x| x.floor() as i32).into();
        let number = *numbers.entry(key).or_insert_with(|| {
            cells.push(Cell {
                sum: Vector3::zeros(),
                n: 0.0,
                vertex: vertex as u32,
            });
            cells.len() as u32 - 1
        });
        let cell = &mut cells[number as usize];
        cell.sum += p.coords;
        cell.n += 1.0;
        number
    };
    let cell_of = mesh.positions().iter().enumerate().map(place).collect();
    (cells, cell_of)
}
