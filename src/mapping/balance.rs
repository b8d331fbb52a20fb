//! Balance of the membrane forces. Stresses of a sheet that was sprung back hold each other; once mapped they do
//! so only as far as both meshes allow, and what is left moves the nodes when a calculation starts.

use super::shells::ShellMesh;
use crate::geometry::Vector3;
use crate::geometry::chunks::for_chunks;
use crate::geometry::tensor::{Tensor, matrix};
use crate::monitor::{Cancelled, Monitor};

/// Sums over the nodes inside a sheet, for one or several meshes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForceBalance {
    /// Squares of what is left of the forces of the elements around each node, in the plane of the sheet.
    left_sq: f64,
    /// Squares of these forces themselves.
    all_sq: f64,
}

impl ForceBalance {
    /// Of one mesh. `force_of` gives thickness times stress, mean over the layers; nodes beside elements without
    /// are left out, and those on the border, which may be held there. O(elements).
    pub fn of(
        mesh: &ShellMesh,
        force_of: impl Fn(usize) -> Option<Tensor>,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let merged = mesh.merged_nodes(monitor)?;
        let links = mesh.links(monitor)?;
        let mut nodes = vec![AtNode::default(); merged.len()];
        for_chunks(mesh.len(), monitor, |range| {
            for element in range {
                let force = force_of(element).map(|force| matrix(&force));
                let corners = mesh.corners()[element];
                let n_corners = if mesh.is_triangle(element) { 3 } else { 4 };
                let normals = edge_normals(mesh, element);
                for (&corner, edge) in corners.iter().zip(normals).take(n_corners) {
                    // Nodes of elements without area alone have no number.
                    let Some(node) = nodes.get_mut(merged[corner as usize] as usize) else {
                        continue;
                    };
                    node.is_left_out |= force.is_none() || links.is_border_node(corner);
                    let own = force.unwrap_or_default() * edge;
                    node.sum += own;
                    node.all_sq += own.norm_squared();
                    let normal = mesh.normals()[element] * mesh.areas()[element];
                    let side = if node.normal.dot(&normal) < 0.0 {
                        -1.0
                    } else {
                        1.0
                    };
                    node.normal += normal * side;
                }
            }
        })?;
        let mut balance = Self::default();
        for node in nodes.iter().filter(|node| !node.is_left_out) {
            let normal = node.normal.try_normalize(0.0).unwrap_or_default();
            // Across a bent sheet bending holds the membrane forces.
            let left = node.sum - normal * node.sum.dot(&normal);
            balance.left_sq += left.norm_squared();
            balance.all_sq += node.all_sq;
        }
        Ok(balance)
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            left_sq: self.left_sq + other.left_sq,
            all_sq: self.all_sq + other.all_sq,
        }
    }

    /// What is left over what the elements bring, root mean square: 0 in balance, about 1 where neighbours know
    /// nothing of each other. `None` without forces.
    pub fn share(self) -> Option<f64> {
        (self.all_sq > 0.0).then(|| (self.left_sq / self.all_sq).sqrt())
    }
}

/// What the elements around a node bring to it.
#[derive(Debug, Clone, Copy, Default)]
struct AtNode {
    sum: Vector3,
    all_sq: f64,
    /// Area-weighted, of whatever side.
    normal: Vector3,
    is_left_out: bool,
}

/// Area times gradient of the shape function of each corner, at the middle of the element.
fn edge_normals(mesh: &ShellMesh, element: usize) -> [Vector3; 4] {
    let [a, b, c, d] = mesh.corner_points(element);
    let normal = mesh.normals()[element];
    let across = |edge: Vector3| edge.cross(&normal) * 0.5;
    if mesh.is_triangle(element) {
        return [
            across(b - c),
            across(c - a),
            across(a - b),
            Vector3::zeros(),
        ];
    }
    let (of_a, of_b) = (across(b - d), across(c - a));
    [of_a, of_b, -of_a, -of_b]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    /// 12 × 12 squares whose inner nodes are moved, every third of them cut in two.
    fn sheet() -> ShellMesh {
        let n = 12_u32;
        let inner = |i: u32| f64::from(u8::from(i > 0 && i < n));
        let nodes = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        let positions = nodes.map(|(i, j)| {
            let moved = 0.2 * inner(i) * inner(j);
            let (x, y) = (f64::from(i), f64::from(j));
            Point3::new(
                x + moved * (3.0 * y).sin(),
                y + moved * (2.0 * x).cos(),
                0.0,
            )
        });
        let node = |i: u32, j: u32| i * (n + 1) + j;
        let mut corners = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [
                node(i, j),
                node(i + 1, j),
                node(i + 1, j + 1),
                node(i, j + 1),
            ];
            match (i + j) % 3 {
                0 => corners.extend([[a, b, c, c], [d, a, c, c]]),
                1 => corners.push([a, b, c, d]),
                // The other way round, with its normal on the other side.
                _ => corners.push([a, d, c, b]),
            }
        }
        let parts = vec![0; corners.len()];
        ShellMesh::new(positions.collect(), corners, parts).unwrap()
    }

    fn share(of: impl Fn(usize) -> Option<Tensor>) -> Option<f64> {
        let balance = ForceBalance::of(&sheet(), of, &Monitor::silent());
        balance.unwrap().share()
    }

    #[test]
    fn uniform_forces_hold_each_other_and_scattered_ones_do_not() {
        let uniform = [120.0, -40.0, 0.0, 30.0, 0.0, 0.0];
        assert!(share(|_| Some(uniform)).unwrap() < 1e-14);
        let scattered = |element: usize| {
            let x = (element as f64 * 1.7).sin();
            Some([100.0 * x, -60.0 * x, 0.0, 20.0 * x, 0.0, 0.0])
        };
        let found = share(scattered).unwrap();
        assert!((0.5..1.5).contains(&found), "{found}");
        // The nodes of an element without forces are left out.
        assert!(share(|element| (element != 40).then_some(uniform)).unwrap() < 1e-14);
        assert_eq!(share(|_| None), None);
    }
}
