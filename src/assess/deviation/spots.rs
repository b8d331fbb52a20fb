//! The places where the parts lie farthest apart.

use super::DeviationField;
use crate::geometry::Point3;
use crate::registration::Surface;

/// A place where the deviation is larger than everywhere around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Vertex of the mesh the surface was made of.
    pub vertex: u32,
    /// The deviation there, as in [`DeviationField::signed`].
    pub value: f64,
    /// Its position in the part's own frame.
    pub position: Point3,
}

/// Up to `n` local extrema of the distance, the largest first, any two at least `separation` apart
/// (in target length units; `scale` turns the surface's lengths into them). Places without a
/// counterpart do not count. O(vertices · log vertices).
pub fn worst_spots(
    field: &DeviationField,
    surface: &Surface,
    scale: f64,
    separation: f64,
    n: usize,
) -> Vec<Spot> {
    let mut given = vec![u32::MAX; surface.mesh().n_vertices()];
    for (vertex, &of_surface) in surface.vertex_of().iter().enumerate().rev() {
        if let Some(slot) = given.get_mut(of_surface as usize) {
            *slot = vertex as u32;
        }
    }
    let value = |v: u32| field.compared(given[v as usize] as usize);
    let mut peaks = peaks(surface, value);
    // Of equal ones the first wins, so that the list depends on the mesh alone.
    peaks.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let apart = separation / scale;
    let mut spots: Vec<Spot> = Vec::new();
    for (vertex, value) in peaks {
        if spots.len() == n {
            break;
        }
        let position = surface.mesh().positions()[vertex as usize];
        let is_free = |spot: &Spot| (spot.position - position).norm() >= apart;
        if spots.iter().all(is_free) {
            let vertex = given[vertex as usize];
            spots.push(Spot {
                vertex,
                value,
                position,
            });
        }
    }
    spots
}

/// Vertices with no neighbour that deviates more; of equal neighbours the first.
fn peaks(surface: &Surface, value: impl Fn(u32) -> Option<f64>) -> Vec<(u32, f64)> {
    let mut is_peak = vec![true; surface.mesh().n_vertices()];
    for &[a, b, c] in surface.mesh().triangles() {
        for (u, v) in [(a, b), (b, c), (c, a)] {
            let (first, second) = (u.min(v), u.max(v));
            if let (Some(a), Some(b)) = (value(first), value(second)) {
                let lower = if b.abs() > a.abs() { first } else { second };
                is_peak[lower as usize] = false;
            }
        }
    }
    let vertices = 0..is_peak.len() as u32;
    let peaks = vertices.filter(|&v| is_peak[v as usize]);
    let with_value = peaks.filter_map(|v| Some((v, value(v)?)));
    with_value.filter(|(_, value)| *value != 0.0).collect()
}
