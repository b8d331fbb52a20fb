//! A mesh with far fewer triangles that stands for a large one while the view moves.

use std::sync::Arc;

use super::mesh::{MeshInput, RenderMesh};
use crate::geometry::MergedMesh;

/// Meshes of more triangles have a coarse picture.
const LARGE: usize = 150_000;
/// About so many triangles a coarse picture has.
pub const COARSE: usize = 40_000;
/// The same where a processor draws, which takes its time for each of them however small it is.
pub const COARSE_ON_PROCESSOR: usize = 12_000;
/// More lines than this are left out of a coarse picture.
const MAX_LINES: usize = 60_000;

/// The coarse picture of a large mesh, without one of its own; `None` for a mesh that can be drawn at
/// once. O(triangles).
pub(super) fn coarse(fine: &RenderMesh, input: MeshInput<'_>) -> Option<Arc<RenderMesh>> {
    if input.mesh.n_triangles() <= LARGE {
        return None;
    }
    let MergedMesh {
        mesh,
        vertex_of,
        triangle_of,
    } = MergedMesh::of(input.mesh, input.n_coarse)?;
    let parts: Option<Vec<u32>> = input.part_of_triangle.map(|parts| {
        let part = |&t: &u32| parts.get(t as usize).copied().unwrap_or_default();
        triangle_of.iter().map(part).collect()
    });
    let mut drawn = RenderMesh::whole(MeshInput {
        part_of_triangle: parts.as_deref(),
        ..MeshInput::plain(&mesh)
    });
    drawn.place_about(fine);
    // Borders and creases are those of the mesh itself, element edges are left out.
    drawn.edge_corners = Vec::new();
    (drawn.wide_edges, drawn.wide_ends) = if fine.wide_edges.len() <= MAX_LINES {
        (fine.wide_edges.clone(), fine.wide_ends.clone())
    } else {
        (Vec::new(), Vec::new())
    };
    drawn.mean_edge_length = fine.mean_edge_length;
    drawn.source_corners = triangle_of
        .iter()
        .flat_map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    for vertex in &mut drawn.corner_vertices {
        *vertex = vertex_of[*vertex as usize];
    }
    for place in &mut drawn.node_places {
        place.vertex = vertex_of[place.vertex as usize];
        place.corner = drawn.source_corners[place.corner as usize];
    }
    Some(Arc::new(drawn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh};

    /// A wavy sheet of `n` × `n` squares.
    fn wavy(n: u32) -> TriMesh {
        let height = |x: f64, y: f64| 8.0 * (x / 60.0).sin() * (y / 45.0).cos();
        let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (f64::from(i), f64::from(j))));
        let positions = places.map(|(x, y)| Point3::new(x, y, height(x, y)));
        let cell = |k: u32| {
            let a = k / n * (n + 1) + k % n;
            [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
        };
        TriMesh::new(positions.collect(), (0..n * n).flat_map(cell).collect()).unwrap()
    }

    #[test]
    fn a_large_mesh_has_a_coarse_picture_of_the_same_shape() {
        let mesh = wavy(300);
        let fine = RenderMesh::new(MeshInput::plain(&mesh));
        let coarse = fine.coarse().expect("it is large");
        let n = coarse.n_triangles();
        assert!((10_000..80_000).contains(&n), "{n}");
        assert_eq!(coarse.bounds(), fine.bounds());
        assert_eq!(coarse.n_border_edges(), fine.n_border_edges());
        let reduced = MergedMesh::of(&mesh, COARSE).unwrap().mesh;
        let area = reduced.area() / mesh.area();
        assert!((0.97..1.01).contains(&area), "{area}");
        for (&vertex, &corner) in coarse.corner_vertices.iter().zip(&coarse.source_corners) {
            assert!((vertex as usize) < mesh.n_vertices());
            assert!((corner as usize) < 3 * mesh.n_triangles());
        }
        assert_eq!(coarse.node_places.len(), coarse.nodes.len());
        for place in &coarse.node_places {
            assert!((place.vertex as usize) < mesh.n_vertices());
            assert!((place.corner as usize) < 3 * mesh.n_triangles());
        }
    }

    #[test]
    fn a_small_mesh_is_always_drawn_as_it_is() {
        let mesh = wavy(20);
        assert!(RenderMesh::new(MeshInput::plain(&mesh)).coarse().is_none());
    }
}
