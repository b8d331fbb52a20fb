//! Holes that both parts have, and those that one lacks.

use super::PARALLEL;
use crate::assess::border_curve::BorderCurve;
use crate::geometry::{Aabb, Circle, Matrix3, Point3, Similarity, Vector3};
use crate::registration::Surface;
use crate::search::ClosestPoint;

/// Holes whose radii differ by more than this factor are not the same hole.
const SAME_RADIUS: f64 = 1.6;
/// A hole of another form, or one that is turned, reaches differently far in some direction by more than this share of
/// its radius: a slot of 62 by 28 mm that is turned by 90° by 0.7 of it. What elements cut from the ends of slots is
/// less.
const ANOTHER_FORM: f64 = 0.4;
/// Of holes that overlap and are not the same, one is a pilot hole or an opening cut later if its radius is so many
/// times smaller.
const ANOTHER_KIND: f64 = 4.0;
/// Such holes lie about one middle if theirs lie apart by less than this share of the smaller radius.
const ONE_MIDDLE: f64 = 0.5;
/// Over a curved sheet the middle of a hole floats by up to this share of its radius.
const FLOATING: f64 = 0.5;
/// A hole belongs to a layer behind another one of its part if that lies at most this share of the way to the middle of
/// the hole away from the place of the other part.
const BEHIND: f64 = 0.5;

/// A hole in the target's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hole {
    pub(in crate::assess) center: Point3,
    /// Mean distance of its border from the centre.
    pub(in crate::assess) radius: f64,
    /// The circle that a round one is.
    pub(super) circle: Option<Circle>,
    /// Of its border.
    pub(super) length: f64,
    /// Mean of r rᵀ over its border, r from its middle.
    pub(super) moment: Matrix3,
    /// Of the sheet around it.
    pub(crate) normal: Vector3,
}

/// A hole that both parts have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HolePair {
    /// The target's.
    pub(crate) hole: Hole,
    /// From its middle to that of the source's.
    pub(crate) off: Vector3,
    /// Difference of the radii, or of how far they reach in some direction where the forms differ beyond doubt.
    pub(in crate::assess) wider: f64,
    /// How far the nodes of both lie off their circles; `None` unless both are round and have enough of them.
    pub(in crate::assess) out_of_round: Option<f64>,
}

impl Hole {
    /// How much its radius is larger than another's. Chords of the few edges of a coarse mesh make a round hole
    /// smaller, not its circle; a square with a node at each corner only has a circle too.
    fn wider_than(&self, other: &Self) -> f64 {
        match (self.circle, other.circle) {
            (Some(own), Some(others)) => own.radius - others.radius,
            _ => self.radius - other.radius,
        }
    }

    /// How much farther one of two holes reaches in some direction than the other, where their forms differ beyond
    /// doubt; 0 of two round ones.
    fn differs_in_form_by(&self, other: &Self) -> f64 {
        if self.circle.is_some() && other.circle.is_some() {
            return 0.0;
        }
        let radius = self.radius.min(other.radius);
        let by = (self.moment - other.moment).norm() / radius;
        if by > ANOTHER_FORM * radius { by } else { 0.0 }
    }

    /// What of a shift lies within the sheet: across it the middle of a hole moves with the surface, which is compared
    /// by itself.
    pub(in crate::assess) fn within_sheet(&self, shift: &Vector3) -> Vector3 {
        shift - self.normal * shift.dot(&self.normal)
    }
}

impl HolePair {
    pub(super) fn of(of_source: &Hole, of_target: &Hole) -> Self {
        let deviation = |hole: &Hole| hole.circle?.deviation;
        Self {
            hole: *of_target,
            off: of_source.center - of_target.center,
            wider: (of_source.wider_than(of_target).abs())
                .max(of_source.differs_in_form_by(of_target)),
            out_of_round: deviation(of_source)
                .zip(deviation(of_target))
                .map(|(a, b)| a + b),
        }
    }
}

/// For each hole of the source the hole of the target of about its size that is the same: of all pairs that lie near
/// each other the closest first, and of equally close ones the first.
pub(super) fn partners(of_source: &[Hole], of_target: &[Hole], near: f64) -> Vec<Option<usize>> {
    let is_same_size = |hole: &Hole, other: &Hole| {
        let ratio = other.radius / hole.radius;
        ratio < SAME_RADIUS && ratio * SAME_RADIUS > 1.0
    };
    // A perforated sheet has thousands, of which few lie near each other along any axis.
    let bounds = Aabb::of_points(of_target.iter().map(|hole| &hole.center));
    let axis = bounds.extents().imax();
    let mut along: Vec<(f64, usize)> = (of_target.iter().enumerate())
        .map(|(j, hole)| (hole.center[axis], j))
        .collect();
    along.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, hole) in of_source.iter().enumerate() {
        let (reach, at) = (near.max(hole.radius), hole.center[axis]);
        let first = along.partition_point(|(other, _)| *other <= at - reach);
        let beside = along[first..].iter();
        let beside = beside.take_while(|(other, _)| *other < at + reach);
        let alike = beside.filter(|(_, j)| is_same_size(hole, &of_target[*j]));
        let off = alike.map(|&(_, j)| ((of_target[j].center - hole.center).norm(), i, j));
        pairs.extend(off.filter(|(off, ..)| *off < reach));
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partners = vec![None; of_source.len()];
    let mut is_used = vec![false; of_target.len()];
    for (_, i, j) in pairs {
        if partners[i].is_none() && !is_used[j] {
            partners[i] = Some(j);
            is_used[j] = true;
        }
    }
    partners
}

/// Whether two holes cross each other, or lie about one middle, and are of one kind.
pub(super) fn overlaps(hole: &Hole, other: &Hole) -> bool {
    let [small, large] = if hole.radius < other.radius {
        [hole.radius, other.radius]
    } else {
        [other.radius, hole.radius]
    };
    let off = (hole.center - other.center).norm();
    let crosses = off < small + large && off > large - small;
    let is_in_one_sheet = hole.normal.dot(&other.normal).abs() > PARALLEL;
    is_in_one_sheet && (crosses || off < ONE_MIDDLE * small) && large < ANOTHER_KIND * small
}

/// The holes of a part at whose middle the other one is solid, and the rest. Each part comes with the motion to its
/// frame from that of the holes. Holes of a layer that lies behind another one of their own part, as where parts of an
/// assembly are joined, say nothing of what lies on that and are left out. So are holes no larger than the elements of
/// the other part where that has none as small as they are, `smallest` being the radius of its smallest hole: its mesh
/// leaves them out.
pub(super) fn solid_at(
    mut holes: Vec<Hole>,
    (own, own_from_holes): (&Surface, &Similarity),
    (other, other_from_holes): (&Surface, &Similarity),
    near: f64,
    smallest: f64,
) -> (Vec<Hole>, Vec<Hole>) {
    let solid_place = |hole: &Hole| {
        let at = other_from_holes.apply(&hole.center);
        let reach = (FLOATING * hole.radius + near) * other_from_holes.scale;
        let hit = other.bvh().closest(&at, reach, None, None)?;
        let facing = other_from_holes
            .rotate(&hole.normal)
            .dot(&other.normal_at(&hit));
        let is_solid = !other.is_on_border(&hit) && facing.abs() > PARALLEL;
        is_solid.then(|| (other_from_holes.inverse().apply(&hit.point), hit.triangle))
    };
    let is_too_small = |hole: &Hole| {
        let has_none_as_small = smallest > SAME_RADIUS * hole.radius;
        let is_no_larger = |(_, triangle): (Point3, u32)| {
            // Half of a square element.
            let element = (2.0 * other.mesh().area_vector(triangle as usize).norm()).sqrt();
            hole.radius * other_from_holes.scale < element
        };
        has_none_as_small && solid_place(hole).is_some_and(is_no_larger)
    };
    let is_behind = |hole: &Hole| {
        solid_place(hole).is_some_and(|(place, _)| {
            let reach = BEHIND * (place - hole.center).norm() * own_from_holes.scale;
            let at = own_from_holes.apply(&place);
            own.bvh().closest(&at, reach, None, None).is_some()
        })
    };
    holes.retain(|hole| !is_behind(hole) && !is_too_small(hole));
    holes
        .into_iter()
        .partition(|hole| solid_place(hole).is_some())
}

/// Radius of the smallest hole, infinite of none.
pub(super) fn smallest_radius(holes: &[Hole]) -> f64 {
    let radii = holes.iter().map(|hole| hole.radius);
    radii.fold(f64::INFINITY, f64::min)
}

pub(super) fn hole(border: &BorderCurve, target_from_border: &Similarity) -> Hole {
    let normal = border.normal().try_normalize(0.0).unwrap_or_default();
    Hole {
        center: target_from_border.apply(&border.center),
        radius: border.radius() * target_from_border.scale,
        circle: border
            .circle
            .map(|circle| circle.scaled(target_from_border.scale)),
        length: border.length * target_from_border.scale,
        moment: target_from_border.rotation
            * border.moment()
            * target_from_border.rotation.transpose()
            * target_from_border.scale.powi(2),
        normal: target_from_border.rotate(&normal),
    }
}
