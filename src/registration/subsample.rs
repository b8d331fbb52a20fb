//! Nodes that stand for the area of a surface: all of them, or an even choice.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::icp::Sample;
use super::surface::Surface;
use crate::geometry::z_order_for;
use crate::monitor::{Cancelled, Monitor};

/// A vertex of a surface, and the area that it stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedNode {
    pub(crate) vertex: u32,
    pub(crate) area: f64,
}

impl WeightedNode {
    /// A vertex that stands for its own area alone.
    pub(crate) fn of(surface: &Surface, vertex: u32) -> Self {
        Self {
            vertex,
            area: surface.vertex_areas()[vertex as usize],
        }
    }
}

/// The choices of nodes that were asked of a surface so far, and the order that they are made along.
#[derive(Debug, Default)]
pub(super) struct EvenChoices {
    z_order: OnceLock<Vec<u32>>,
    /// By how many nodes were asked for.
    by_number: Mutex<BTreeMap<usize, Arc<[WeightedNode]>>>,
}

impl EvenChoices {
    /// About `n` vertices that stand for equal areas: along a space-filling order of the vertices the one is taken
    /// where the running area passes the next n-th part of the whole. Evenly spread however the mesh is graded, the
    /// same for the same mesh. All vertices in their order, each with its own area, if there are no more.
    /// O(vertices · log vertices) the first time, O(vertices) for another number, O(1) for the same one.
    pub(super) fn of(
        &self,
        surface: &Surface,
        n: usize,
        monitor: &Monitor,
    ) -> Result<Arc<[WeightedNode]>, Cancelled> {
        let lock = || {
            self.by_number
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
        };
        let areas = surface.vertex_areas();
        let n = n.min(areas.len());
        if let Some(known) = lock().get(&n) {
            return Ok(known.clone());
        }
        let choice: Arc<[WeightedNode]> = if n == areas.len() {
            let all = 0..n as u32;
            all.map(|vertex| WeightedNode::of(surface, vertex))
                .collect()
        } else {
            evenly(areas, self.z_order(surface, monitor)?, n).into()
        };
        monitor.check()?;
        lock().insert(n, choice.clone());
        Ok(choice)
    }

    fn z_order(&self, surface: &Surface, monitor: &Monitor) -> Result<&[u32], Cancelled> {
        if let Some(known) = self.z_order.get() {
            return Ok(known);
        }
        let order = z_order_for(surface.mesh().positions(), monitor)?;
        Ok(self.z_order.get_or_init(|| order))
    }
}

/// About `n` vertices along an order of all, each for the n-th parts of the area that are passed at it.
fn evenly(areas: &[f64], order: &[u32], n: usize) -> Vec<WeightedNode> {
    let share = areas.iter().sum::<f64>() / n as f64;
    let mut choice = Vec::with_capacity(n);
    let mut running = 0.0;
    let mut taken = 0usize;
    for &vertex in order {
        running += areas[vertex as usize];
        let passed = ((running / share + 0.5).floor() as usize).min(n);
        if passed > taken {
            let area = share * (passed - taken) as f64;
            choice.push(WeightedNode { vertex, area });
            taken = passed;
        }
    }
    choice
}

/// All vertices of the surface with the area they stand for.
pub(crate) fn all_nodes(surface: &Surface) -> Vec<Sample> {
    (0..surface.mesh().n_vertices() as u32)
        .map(|vertex| sample(surface, WeightedNode::of(surface, vertex)))
        .collect()
}

fn sample(surface: &Surface, node: WeightedNode) -> Sample {
    let vertex = node.vertex as usize;
    Sample {
        point: surface.mesh().positions()[vertex],
        normal: surface.vertex_normals()[vertex],
        weight: node.area,
    }
}

/// About `n` vertices that stand for equal areas, all if there are no more; see [`Surface::even_nodes_for`].
pub(crate) fn subsample(
    surface: &Surface,
    n: usize,
    monitor: &Monitor,
) -> Result<Vec<Sample>, Cancelled> {
    let nodes = surface.even_nodes_for(n, monitor)?;
    Ok(nodes.iter().map(|&node| sample(surface, node)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh};

    #[test]
    fn an_even_choice_stands_for_the_area_and_not_for_the_number_of_nodes() {
        // Some of the nodes, here and there, have nine times the area of the others.
        let is_large = |i: u32| i * i * 37 % 401 < 100;
        let areas: Vec<f64> = (0..400)
            .map(|i| if is_large(i) { 9.0 } else { 1.0 })
            .collect();
        let order: Vec<u32> = (0..400).collect();
        let choice = evenly(&areas, &order, 150);
        assert!(choice.len() <= 150);
        let sum_of = |nodes: &[WeightedNode]| nodes.iter().map(|node| node.area).sum::<f64>();
        let whole: f64 = areas.iter().sum();
        assert!((sum_of(&choice) - whole).abs() < 1e-6);
        let large: Vec<WeightedNode> = choice
            .into_iter()
            .filter(|node| is_large(node.vertex))
            .collect();
        let of_large: f64 = areas.iter().filter(|&&area| area > 1.0).sum();
        let (chosen, share) = (sum_of(&large) / whole, of_large / whole);
        assert!((chosen - share).abs() < 0.05, "{chosen} of {share}");
    }

    #[test]
    fn a_choice_is_made_once_and_is_all_nodes_where_there_are_no_more() {
        let points = (0..400u32).map(|i| Point3::new(f64::from(i % 20), f64::from(i / 20), 0.0));
        let cells = (0..19 * 19u32).map(|cell| cell / 19 * 20 + cell % 19);
        let triangles = cells.flat_map(|a| [[a, a + 1, a + 21], [a, a + 21, a + 20]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        let surface = Surface::new(&mesh, "source").unwrap();
        let few = surface.even_nodes(50);
        assert!(Arc::ptr_eq(&few, &surface.even_nodes(50)));
        let n = surface.mesh().n_vertices();
        for asked in [n, n + 1, usize::MAX] {
            let all = surface.even_nodes(asked);
            assert!(all.iter().map(|node| node.vertex).eq(0..n as u32));
            assert!(all.iter().map(|node| &node.area).eq(surface.vertex_areas()));
        }
    }
}
