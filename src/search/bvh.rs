//! The tree over the triangles of a mesh.

use std::sync::Arc;

use glam::{BVec4A, Vec4};

use super::cones::{ConeFilter, add_cones};
use super::pack::{TrianglePack, rename};
use super::traverse::{Admit, All, Nearest, OUT_OF_SIGHT, Walk};
use super::tree_items::TreeItems;
use super::wide::{LocalFrame, Node, Query, WideTree, box_around};
use super::{
    ClosestPoint, NormalFilter, SurfaceHit, TrianglePoint, brute, closest_point_on_triangle,
};
use crate::geometry::{Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// Rounding of a normal's cosine in `f32`, generously.
const COS_SLACK: f32 = 4e-6;

/// A tree of boxes over the triangles of a mesh: built piece by piece with obvhs, folded to four children per node
/// and four triangles per leaf (after Wald, Benthin and Boulos 2008).
///
/// The tree works in `f32` about the mesh's centre and only rules triangles out, with all rounding
/// allowed for. Distances are decided in `f64`, so the answers are those of
/// [`super::BruteForce`], bit for bit, with and without hint and for any number of threads.
/// That includes meshes far from the origin. A query more than a million mesh sizes away is
/// answered by asking every triangle.
#[derive(Debug, Clone)]
pub struct Bvh {
    mesh: Arc<TriMesh>,
    pub(super) frame: LocalFrame,
    pub(super) tree: WideTree<TrianglePack>,
}

impl Bvh {
    /// [`Bvh::build_for`] for meshes of a bounded size, which nobody needs to cancel.
    pub fn build(mesh: impl Into<Arc<TriMesh>>) -> Self {
        Self::build_for(mesh.into(), &Monitor::silent()).expect("nobody cancels a silent monitor")
    }

    /// Builds the tree over a mesh. O(triangles · log triangles), on all threads; asks `monitor`
    /// every few ten milliseconds.
    pub fn build_for(mesh: Arc<TriMesh>, monitor: &Monitor) -> Result<Self, Cancelled> {
        let frame = LocalFrame::around(&mesh.aabb());
        let corners = |t: u32| mesh.corners(t as usize).map(|p| frame.to_local(&p));
        let box_of = |t: u32| box_around(&corners(t));
        let mut tree: WideTree<TrianglePack> = match TreeItems::of(&mesh, &frame, monitor)? {
            None => WideTree::build(mesh.n_triangles(), box_of, corners, monitor)?,
            Some(items) => {
                let box_of = |item: u32| items.box_of(item);
                let of_item = |item: u32| corners(items.triangle_of[item as usize]);
                let mut tree = WideTree::build(items.len(), box_of, of_item, monitor)?;
                rename(&mut tree.packs, &items.triangle_of);
                tree
            }
        };
        add_cones(&mut tree, monitor)?;
        Ok(Self { mesh, frame, tree })
    }

    /// The exact answer for one triangle, if it counts.
    pub(super) fn exact(
        &self,
        query: &Point3,
        max_distance: f64,
        triangle: u32,
    ) -> Option<Nearest<TrianglePoint>> {
        let found = closest_point_on_triangle(query, &self.mesh.corners(triangle as usize));
        (found.distance_sq.sqrt() <= max_distance).then_some(Nearest {
            distance_sq: found.distance_sq,
            id: triangle,
            found,
        })
    }

    /// Walks the tree, with the triangles that `admit` lets count.
    fn walk(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
        admit: impl Admit<TrianglePack>,
    ) -> Option<Nearest<TrianglePoint>> {
        let local = self.frame.to_local(query);
        let exact = |triangle| self.exact(query, max_distance, triangle);
        let limit = max_distance * self.frame.scale;
        let mut walk = Walk::new(&self.tree, &local, limit, admit, exact);
        if let Some(near) = hint.and_then(exact) {
            let distance = near.distance_sq.sqrt() * self.frame.scale;
            walk.start_from(near, distance);
        }
        walk.run()
    }

    /// Of the marked triangles of a leaf, those that a filter lets through.
    pub(super) fn admitted(&self, filter: &NormalFilter, pack: &TrianglePack, marked: u32) -> u32 {
        let cos = pack.normal_cos(&Query::at(&filter.direction));
        let beyond = cos - Vec4::splat(filter.min_cos as f32);
        let slack = Vec4::splat(COS_SLACK);
        let in_doubt = pack.needles() | beyond.abs().cmple(slack).bitmask();
        let mut admitted = marked & !in_doubt & beyond.cmpgt(slack).bitmask();
        let mut asked = marked & in_doubt;
        while asked != 0 {
            let slot = asked.trailing_zeros();
            asked &= asked - 1;
            let accepted = filter.accepts(&self.mesh, pack.id(slot as usize) as usize);
            admitted |= u32::from(accepted) << slot;
        }
        admitted
    }
}

/// The triangles that a filter lets through.
struct FacingTriangles<'a> {
    tree: &'a Bvh,
    filter: &'a NormalFilter,
    cones: ConeFilter,
}

impl Admit<TrianglePack> for FacingTriangles<'_> {
    #[inline]
    fn items(&self, pack: &TrianglePack, marked: u32) -> u32 {
        self.tree.admitted(self.filter, pack, marked)
    }

    #[inline]
    fn children(&self, node: &Node) -> BVec4A {
        node.cones.may_pass(&self.cones)
    }
}

impl ClosestPoint for Bvh {
    fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    fn closest(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
        filter: Option<&NormalFilter>,
    ) -> Option<SurfaceHit> {
        if !query.iter().all(|x| x.is_finite()) || max_distance.is_nan() || max_distance < 0.0 {
            return None;
        }
        if self.frame.to_local(query).amax() > OUT_OF_SIGHT {
            return brute::closest(&self.mesh, query, max_distance, filter);
        }
        let accepted = |t: &u32| {
            (*t as usize) < self.mesh.n_triangles()
                && filter.is_none_or(|f| f.accepts(&self.mesh, *t as usize))
        };
        let hint = hint.filter(accepted);
        let nearest = match filter {
            None => self.walk(query, max_distance, hint, All),
            Some(filter) => {
                let facing = FacingTriangles {
                    tree: self,
                    filter,
                    cones: ConeFilter::of(filter),
                };
                self.walk(query, max_distance, hint, facing)
            }
        };
        nearest.map(|nearest| SurfaceHit::on_triangle(nearest.id, nearest.found))
    }
}
