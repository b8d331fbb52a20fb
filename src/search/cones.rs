//! Cones that hold the normals below a node, for questions that let only triangles of some directions count:
//! a sheet that faces another way is passed over as a whole.

use glam::{BVec4A, Vec3A, Vec4};

use super::NormalFilter;
use super::pack::TrianglePack;
use super::wide::{Node, WIDTH, WideTree};
use crate::geometry::chunks::map_chunks;
use crate::monitor::{Cancelled, Monitor};

/// A number from −1 to 1 in one byte.
const STEPS: f32 = 127.0;
/// How far the cosine with an axis in three bytes can be off (half a step on each axis), and rounding.
const SLACK: f32 = 0.008;

/// One cone per child: its axis and the cosine of half its angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cones {
    axis: [[i8; WIDTH]; 3],
    cos: [i8; WIDTH],
}

/// A filter as it is put to cones.
#[derive(Debug, Clone, Copy)]
pub(super) struct ConeFilter {
    /// Unit direction over [`STEPS`].
    direction: Vec3A,
    min_cos: f32,
    /// Sine of the same angle.
    sin: f32,
}

impl ConeFilter {
    pub(super) fn of(filter: &NormalFilter) -> Self {
        let [x, y, z] = filter.direction.map(|x| x as f32).into();
        let min_cos = (filter.min_cos as f32).clamp(-1.0, 1.0);
        Self {
            direction: Vec3A::new(x, y, z) / STEPS,
            min_cos,
            sin: (1.0 - min_cos * min_cos).sqrt(),
        }
    }
}

impl Cones {
    /// Cones that hold every direction.
    pub(super) fn of_all_directions() -> Self {
        Self {
            axis: [[0; WIDTH]; 3],
            cos: [-STEPS as i8; WIDTH],
        }
    }

    /// The children below which a triangle may pass the filter.
    #[inline]
    pub(super) fn may_pass(&self, filter: &ConeFilter) -> BVec4A {
        let lanes = |bytes: &[i8; WIDTH]| Vec4::from_array(bytes.map(f32::from));
        let [x, y, z] = self.axis.each_ref().map(lanes);
        let cos_with_axis =
            x * filter.direction.x + y * filter.direction.y + z * filter.direction.z;
        let cos = lanes(&self.cos) * (1.0 / STEPS);
        let sin_sq = (Vec4::ONE - cos * cos).max(Vec4::ZERO);
        let sin = Vec4::from_array(sin_sq.to_array().map(f32::sqrt));
        // Cosine of the largest angle between axis and direction at which the cone and that of the filter meet;
        // where both fill more than half a turn, they always do.
        let limit = cos * filter.min_cos - sin * filter.sin - Vec4::splat(SLACK);
        cos_with_axis.cmpge(limit) | cos.cmple(Vec4::splat(SLACK - filter.min_cos))
    }

    pub(super) fn set(&mut self, slot: usize, cone: &Cone) {
        let axis = (cone.axis * STEPS).round();
        for (bytes, value) in self.axis.iter_mut().zip(axis.to_array()) {
            bytes[slot] = value as i8;
        }
        self.cos[slot] = (cone.cos * STEPS).floor() as i8;
    }

    pub(super) fn copy(&mut self, slot: usize, other: &Self, from: usize) {
        for (bytes, others) in self.axis.iter_mut().zip(&other.axis) {
            bytes[slot] = others[from];
        }
        self.cos[slot] = other.cos[from];
    }
}

/// A unit axis and the cosine of half the angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cone {
    axis: Vec3A,
    cos: f32,
}

impl Cone {
    const ALL: Self = Self {
        axis: Vec3A::ZERO,
        cos: -1.0,
    };

    /// Around the normals of a leaf. Of a triangle that is too narrow for them to be known, all directions.
    fn of_pack(pack: &TrianglePack) -> Self {
        if pack.needles() & pack.used() != 0 {
            return Self::ALL;
        }
        let used = (0..WIDTH).filter(|slot| pack.used() & (1 << slot) != 0);
        Self::around(used.map(|slot| Self {
            axis: pack.normal(slot),
            cos: 1.0,
        }))
    }

    /// Around other cones.
    fn around(cones: impl Iterator<Item = Self> + Clone) -> Self {
        let sum: Vec3A = cones.clone().map(|cone| cone.axis).sum();
        let Some(axis) = sum.try_normalize() else {
            return Self::ALL;
        };
        let angle = |cone: Self| {
            let between = axis.dot(cone.axis).clamp(-1.0, 1.0).acos();
            between + cone.cos.clamp(-1.0, 1.0).acos()
        };
        let half_angle = cones.map(angle).fold(0.0, f32::max);
        if half_angle >= std::f32::consts::PI {
            return Self::ALL;
        }
        Self {
            axis,
            cos: half_angle.cos(),
        }
    }
}

/// Gives every node of a tree the cones of its children.
pub(super) fn add_cones(
    tree: &mut WideTree<TrianglePack>,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let packs = &tree.packs;
    let of_leaves = map_chunks(packs.len(), monitor, |leaf| Cone::of_pack(&packs[leaf]))?;
    let mut of_nodes = vec![Cone::ALL; tree.nodes.len()];
    // Children stand behind their parents.
    for number in (0..tree.nodes.len()).rev() {
        let node: &mut Node = &mut tree.nodes[number];
        let used = node.used();
        let cone_of = |slot: usize| match node.child[slot].leaf() {
            Ok(leaf) => of_leaves[leaf],
            Err(below) => of_nodes[below],
        };
        let cones: [Cone; WIDTH] = std::array::from_fn(|slot| {
            if used & (1 << slot) != 0 {
                cone_of(slot)
            } else {
                Cone::ALL
            }
        });
        let children = (0..WIDTH).filter(|slot| used & (1 << slot) != 0);
        of_nodes[number] = Cone::around(children.map(|slot| cones[slot]));
        for (slot, cone) in cones.iter().enumerate() {
            node.cones.set(slot, cone);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Bvh;
    use super::super::wide::Link;
    use super::*;
    use crate::geometry::{Point3, TriMesh, Vector3};

    /// A rolled sheet with a needle in it.
    fn roll() -> TriMesh {
        let (n, m) = (60_u32, 8_u32);
        let at = |i: u32, j: u32| {
            let turn = 0.2 * f64::from(i);
            let radius = 10.0 + turn;
            Point3::new(radius * turn.cos(), radius * turn.sin(), f64::from(j))
        };
        let nodes = (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j)));
        let mut positions: Vec<Point3> = nodes.map(|(i, j)| at(i, j)).collect();
        let cells = (0..n).flat_map(|i| (0..m).map(move |j| [i, j].map(u64::from)));
        let mut triangles: Vec<[u32; 3]> = cells
            .flat_map(|[i, j]| {
                let a = (i * u64::from(m + 1) + j) as u32;
                let b = a + m + 1;
                [[a, b, b + 1], [a, b + 1, a + 1]]
            })
            .collect();
        let last = positions.len() as u32;
        positions.push(positions[0] + Vector3::new(0.0, 0.5, 1e-13));
        triangles.push([0, 1, last]);
        TriMesh::new(positions, triangles).unwrap()
    }

    fn triangles_below(tree: &Bvh, link: Link) -> Vec<u32> {
        match link.leaf() {
            Ok(leaf) => tree.tree.packs[leaf].real_ids().collect(),
            Err(node) => {
                let node = &tree.tree.nodes[node];
                let used = (0..WIDTH).filter(|slot| node.used() & (1 << slot) != 0);
                used.flat_map(|slot| triangles_below(tree, node.child[slot]))
                    .collect()
            }
        }
    }

    #[test]
    fn no_triangle_that_counts_is_passed_over_and_many_others_are() {
        let mesh = roll();
        let tree = Bvh::build(mesh.clone());
        let (mut n_open, mut n_closed) = (0, 0);
        for k in 0..60 {
            let k = f64::from(k);
            let direction = Vector3::new((0.7 * k).sin(), (1.1 * k).cos(), 0.4 * (0.3 * k).sin());
            for min_cos in [-0.9, -0.2, 0.5, 0.9, 1.0] {
                let filter = NormalFilter {
                    direction: direction.normalize(),
                    min_cos,
                };
                for node in &tree.tree.nodes {
                    let open = node.cones.may_pass(&ConeFilter::of(&filter)).bitmask();
                    for slot in (0..WIDTH).filter(|slot| node.used() & (1 << slot) != 0) {
                        let below = triangles_below(&tree, node.child[slot]);
                        let counts = below.iter().any(|&t| filter.accepts(&mesh, t as usize));
                        let is_open = open & (1 << slot) != 0;
                        assert!(is_open || !counts, "{direction} {min_cos}");
                        n_open += usize::from(is_open);
                        n_closed += usize::from(!is_open);
                    }
                }
            }
        }
        assert!(n_closed > n_open / 2, "{n_closed} of {}", n_closed + n_open);
    }
}
