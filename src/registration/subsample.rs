//! Points of a surface that stand for its area: all nodes, or an even choice of them.

use rayon::prelude::*;

use super::icp::Sample;
use super::surface::Surface;
use crate::geometry::{Aabb, Point3};

/// All vertices of the surface with the area they stand for.
pub(crate) fn all_nodes(surface: &Surface, area_weights: bool) -> Vec<Sample> {
    let vertices = 0..surface.mesh().n_vertices();
    vertices
        .map(|v| sample(surface, v, area_weights.then(|| surface.vertex_areas()[v])))
        .collect()
}

fn sample(surface: &Surface, vertex: usize, weight: Option<f64>) -> Sample {
    Sample {
        point: surface.mesh().positions()[vertex],
        normal: surface.vertex_normals()[vertex],
        weight: weight.unwrap_or(1.0),
    }
}

/// About `n` vertices that stand for equal areas: along a space-filling order of the vertices the
/// one is taken where the running area passes the next n-th part of the whole. Evenly spread
/// however the mesh is graded, the same for the same mesh. All vertices if there are no more.
pub(crate) fn subsample(surface: &Surface, n: usize) -> Vec<Sample> {
    let mesh = surface.mesh();
    if mesh.n_vertices() <= n {
        return all_nodes(surface, true);
    }
    let areas = surface.vertex_areas();
    let share = areas.iter().sum::<f64>() / n as f64;
    let mut samples: Vec<Sample> = Vec::with_capacity(n);
    let mut running = 0.0;
    let mut taken = 0usize;
    for vertex in morton_order(mesh.positions()) {
        running += areas[vertex as usize];
        let passed = ((running / share + 0.5).floor() as usize).min(n);
        if passed > taken {
            let weight = share * (passed - taken) as f64;
            samples.push(sample(surface, vertex as usize, Some(weight)));
            taken = passed;
        }
    }
    samples
}

/// Indices in the order of a Morton curve over the box of the points.
pub(crate) fn morton_order(points: &[Point3]) -> Vec<u32> {
    let aabb = Aabb::of_points(points);
    let extent = aabb.extents().max();
    let scale = if extent > 0.0 { 1023.0 / extent } else { 0.0 };
    let mut keyed: Vec<(u32, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let cell = (p - aabb.min) * scale;
            let code =
                spread(cell.x as u32) | spread(cell.y as u32) << 1 | spread(cell.z as u32) << 2;
            (code, i as u32)
        })
        .collect();
    // No two are equal, so the order does not depend on the threads.
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Puts two zero bits between the lowest ten bits of `x`.
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00FF;
    let x = (x | x << 8) & 0x0300_F00F;
    let x = (x | x << 4) & 0x030C_30C3;
    (x | x << 2) & 0x0924_9249
}
