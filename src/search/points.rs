//! The tree over points.

use std::sync::Arc;

use super::pack::{PointPack, rename};
use super::traverse::{All, Nearest, OUT_OF_SIGHT, Walk};
use super::wide::{LocalFrame, WideTree, box_around};
use crate::geometry::{Aabb, Point3};
use crate::monitor::{Cancelled, Monitor};

/// The point of a set that is closest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// Index of the point; of several equally close ones, the lowest.
    pub index: u32,
    /// Squared distance from the query.
    pub distance_sq: f64,
}

/// A tree over points, for pairing nodes with nodes.
///
/// The same tree as [`super::Bvh`] with points for triangles, and as exact: its answers are those
/// of a plain loop, bit for bit.
#[derive(Debug, Clone)]
pub struct PointTree {
    points: Arc<[Point3]>,
    frame: LocalFrame,
    tree: WideTree<PointPack>,
}

impl PointTree {
    /// Builds the tree. Points that are not finite are never found. O(points · log points).
    pub fn build(points: impl Into<Arc<[Point3]>>) -> Self {
        Self::build_for(points, &Monitor::silent()).expect("nobody cancels a silent monitor")
    }

    /// [`PointTree::build`] that ends when `monitor` is cancelled.
    pub fn build_for(
        points: impl Into<Arc<[Point3]>>,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let points: Arc<[Point3]> = points.into();
        let finite: Vec<u32> = (0..points.len() as u32)
            .filter(|&i| points[i as usize].iter().all(|x| x.is_finite()))
            .collect();
        let frame = LocalFrame::around(&Aabb::of_points(
            finite.iter().map(|&i| &points[i as usize]),
        ));
        let local = |i: u32| frame.to_local(&points[i as usize]);
        let item = |i: u32| local(finite[i as usize]);
        let box_of = |i: u32| box_around(&[item(i)]);
        let mut tree = WideTree::<PointPack>::build(finite.len(), box_of, item, monitor)?;
        if finite.len() < points.len() {
            rename(&mut tree.packs, &finite);
        }
        Ok(Self {
            points,
            frame,
            tree,
        })
    }

    /// The closest point within `max_distance` (may be infinite), or `None` if there is none or
    /// the query is not finite. `hint` names a point that is probably close; it changes the speed,
    /// never the answer.
    pub fn nearest(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
    ) -> Option<NearestPoint> {
        self.nearest_of(|_| true, query, max_distance, hint)
    }

    /// [`PointTree::nearest`] of the points that are `accepted`, by their indices.
    pub fn nearest_of(
        &self,
        accepted: impl Fn(u32) -> bool,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
    ) -> Option<NearestPoint> {
        if !query.iter().all(|x| x.is_finite()) || max_distance.is_nan() || max_distance < 0.0 {
            return None;
        }
        let exact = |index: u32| {
            let distance_sq = (query - self.points[index as usize]).norm_squared();
            let is_near = distance_sq.sqrt() <= max_distance;
            (is_near && accepted(index)).then_some(Nearest {
                distance_sq,
                id: index,
                found: (),
            })
        };
        let local = self.frame.to_local(query);
        let nearest = if local.amax() > OUT_OF_SIGHT {
            let mut best = None;
            for near in (0..self.points.len() as u32).filter_map(exact) {
                if near.beats(best.as_ref()) {
                    best = Some(near);
                }
            }
            best
        } else {
            let limit = max_distance * self.frame.scale;
            let mut walk = Walk::new(&self.tree, &local, limit, All, exact);
            let hint = hint.filter(|&i| (i as usize) < self.points.len());
            if let Some(near) = hint.and_then(exact) {
                let distance = near.distance_sq.sqrt() * self.frame.scale;
                walk.start_from(near, distance);
            }
            walk.run()
        };
        nearest.map(|nearest| NearestPoint {
            index: nearest.id,
            distance_sq: nearest.distance_sq,
        })
    }
}
