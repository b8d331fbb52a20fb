//! Points of a surface that stand for its area: all nodes, or an even choice of them.

use super::icp::Sample;
use super::surface::Surface;
use crate::geometry::z_order_for;
use crate::monitor::{Cancelled, Monitor};

/// All vertices of the surface with the area they stand for.
pub(crate) fn all_nodes(surface: &Surface) -> Vec<Sample> {
    let areas = surface.vertex_areas().iter().enumerate();
    areas
        .map(|(vertex, &area)| sample(surface, vertex, area))
        .collect()
}

fn sample(surface: &Surface, vertex: usize, weight: f64) -> Sample {
    Sample {
        point: surface.mesh().positions()[vertex],
        normal: surface.vertex_normals()[vertex],
        weight,
    }
}

/// About `n` vertices that stand for equal areas: along a space-filling order of the vertices the
/// one is taken where the running area passes the next n-th part of the whole. Evenly spread
/// however the mesh is graded, the same for the same mesh. All vertices if there are no more.
pub(crate) fn subsample(
    surface: &Surface,
    n: usize,
    monitor: &Monitor,
) -> Result<Vec<Sample>, Cancelled> {
    let mesh = surface.mesh();
    if mesh.n_vertices() <= n {
        return Ok(all_nodes(surface));
    }
    let areas = surface.vertex_areas();
    let share = areas.iter().sum::<f64>() / n as f64;
    let mut samples: Vec<Sample> = Vec::with_capacity(n);
    let mut running = 0.0;
    let mut taken = 0usize;
    let order = z_order_for(mesh.positions(), monitor)?;
    monitor.check()?;
    for vertex in order {
        running += areas[vertex as usize];
        let passed = ((running / share + 0.5).floor() as usize).min(n);
        if passed > taken {
            let weight = share * (passed - taken) as f64;
            samples.push(sample(surface, vertex as usize, weight));
            taken = passed;
        }
    }
    Ok(samples)
}
