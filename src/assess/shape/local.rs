//! Does one part have a bead, an emboss or a dent that the other lacks? It may be too small to show in the figures of
//! most of the area.

use std::cell::LazyCell;

use crate::assess::contact::Contact;
use crate::assess::evidence::PoseEvidence;
use crate::assess::fit::Fit;
use crate::assess::shape::ShapeReason;
use crate::assess::tolerance::{ShapeTolerance, is_source_smaller};
use crate::geometry::{Point3, Vector3};
use crate::registration::Surface;
use crate::search::PointTree;

/// Places that lie beside each other and differ by as much are no noise from this number on.
const LEAST_PLACES: usize = 5;
/// Places lie beside each other within so many times the size of what they stand for.
const BESIDE: f64 = 1.7;
/// What reaches an outline over less than this share of how far it reaches inward is a bead that runs out there. What
/// reaches it over more is an end, and springback bends ends most: of them as much is accepted as of the whole part.
const LEAST_OF_END: f64 = 0.5;

/// Elements cut narrow beads and the edges of wide ones short. A group that is not so many edges wide may be that:
/// edges of the mesh that the places were measured against, because the places themselves are nodes, which lie on the
/// sheet.
const LEAST_WIDTH: f64 = 2.5;

/// A place where the surfaces lie apart by more than the limit.
struct Apart<'a> {
    contact: &'a Contact,
    /// What neither bends nor facets explain of the distance.
    left: f64,
    /// The parts meet there; else neither meets anything near it.
    meets: bool,
    /// Edge of the square that it stands for.
    size: f64,
}

impl Apart<'_> {
    /// Whether a point lies beside it within the sheet: a node of the other part there lies off it by the gap.
    fn is_beside(&self, at: &Point3) -> bool {
        let away = at - self.contact.point;
        let height = away.dot(&self.contact.normal);
        let near = BESIDE * self.size;
        height.abs() <= self.contact.gap.abs() + near
            && away.norm_squared() - height * height <= near * near
    }
}

/// Places beside each other that lie apart to one side.
struct Group<'a, 'b> {
    places: Vec<&'a Apart<'b>>,
    low: Point3,
    high: Point3,
}

/// The largest group of neighbouring places at which what neither bends nor facets explain exceeds the tolerance to
/// one side, at an end that of springback, and which elements cutting short does not explain either. A piece that lies
/// too far from its counterpart to meet it counts too.
/// O(nodes that meet nothing · log triangles + k² + (k + outlines) · log outlines) for k places beyond the limit, and
/// O(nodes of the larger part) where a group is narrow.
pub(super) fn local_difference(
    evidence: &PoseEvidence<'_>,
    fit: &Fit,
    tolerance: &ShapeTolerance,
) -> Option<ShapeReason> {
    let contacts = &evidence.contacts;
    let displaced = evidence.displaced();
    let left_there = displaced.iter().map(|place| fit.left_at(place, contacts));
    let places = contacts.list.iter().zip(fit.left.iter().copied());
    let places = places.map(|(contact, left)| (contact, left, true));
    let places = places.chain(
        displaced
            .iter()
            .zip(left_there)
            .map(|(p, left)| (p, left, false)),
    );
    let beyond = places.filter(|(_, left, _)| left.abs() > tolerance.remainder);
    let beyond = beyond.map(|(contact, left, meets)| Apart {
        contact,
        left,
        meets,
        size: (contact.weight * contacts.nodes_per_place).sqrt(),
    });
    let beyond: Vec<Apart> = beyond.collect();
    if beyond.len() < LEAST_PLACES {
        return None;
    }
    let outlines = LazyCell::new(|| PointTree::build(outlines(evidence)));
    let groups = groups(&beyond).into_iter();
    let groups = groups.filter(|group| group.places.len() >= LEAST_PLACES);
    let found = groups.filter_map(|group| {
        let is_end = group.is_end(&outlines);
        let limit = if is_end {
            tolerance.springback
        } else {
            tolerance.remainder
        };
        let worst = group.worst()?;
        let reason = ShapeReason::Local {
            by: worst.left.abs(),
            limit,
            at: worst.contact.point,
            is_end,
        };
        (worst.left.abs() > limit).then_some((group, reason))
    });
    let narrow = LEAST_WIDTH * edge_measured_against(evidence);
    let (mut found, slim): (Vec<_>, Vec<_>) =
        found.partition(|(group, _)| group.is_displaced() || group.width() >= narrow);
    found.extend(seen_by_the_larger(evidence, fit, tolerance.remainder, slim));
    let largest = |group: &Group| group.worst().map_or(0.0, |worst| worst.left.abs());
    let found = found
        .into_iter()
        .max_by(|a, b| largest(&a.0).total_cmp(&largest(&b.0)));
    found.map(|(_, reason)| reason)
}

/// Mean edge of the larger part's mesh.
fn edge_measured_against(evidence: &PoseEvidence<'_>) -> f64 {
    let (source, target, scale) = (evidence.source, evidence.target, evidence.pose.scale);
    if is_source_smaller(source, target, scale) {
        target.measures().mean_edge_length
    } else {
        source.measures().mean_edge_length * scale
    }
}

/// Those of the groups where nodes of the larger part lie apart to the same side too. Nodes lie on the sheet and
/// facets cut it short, so that of one sheet the nodes of each part would lie in front of the other's facets.
fn seen_by_the_larger<'a, 'b>(
    evidence: &PoseEvidence<'_>,
    fit: &Fit,
    limit: f64,
    mut found: Vec<(Group<'a, 'b>, ShapeReason)>,
) -> Vec<(Group<'a, 'b>, ShapeReason)> {
    if found.is_empty() {
        return found;
    }
    let nodes = evidence.of_larger(|at| {
        found
            .iter()
            .any(|(group, _)| group.has_beside(at, |_| true))
    });
    let nodes = nodes.iter().map(|node| {
        let left = fit.left_at(node, &evidence.contacts);
        (node.point, left)
    });
    let nodes: Vec<(Point3, f64)> = nodes.filter(|(_, left)| left.abs() > limit).collect();
    found.retain(|(group, _)| {
        let is_alike =
            |(at, left): &&(Point3, f64)| group.has_beside(at, |place| left * place.left > 0.0);
        nodes.iter().filter(is_alike).count() >= LEAST_PLACES
    });
    found
}

impl<'a, 'b> Group<'a, 'b> {
    fn new(places: Vec<&'a Apart<'b>>) -> Self {
        let (mut low, mut high) = (
            Point3::from([f64::INFINITY; 3]),
            Point3::from([f64::NEG_INFINITY; 3]),
        );
        for place in &places {
            let at = place.contact.point;
            let near = Vector3::repeat(place.contact.gap.abs() + BESIDE * place.size);
            low = low.inf(&(at - near));
            high = high.sup(&(at + near));
        }
        Self { places, low, high }
    }

    /// The place where the surfaces lie farthest apart.
    fn worst(&self) -> Option<&'a Apart<'b>> {
        let places = self.places.iter().copied();
        places.max_by(|a, b| a.left.abs().total_cmp(&b.left.abs()))
    }

    /// Whether a point lies beside a place of the group that `is_asked` accepts.
    fn has_beside(&self, at: &Point3, is_asked: impl Fn(&Apart) -> bool) -> bool {
        *at >= self.low
            && *at <= self.high
            && self
                .places
                .iter()
                .any(|place| place.is_beside(at) && is_asked(place))
    }

    /// Whether it is an end of a part rather than a place in the middle or a bead that runs out at an outline.
    fn is_end(&self, outlines: &PointTree) -> bool {
        let (mut along, mut inward) = (0.0_f64, 0.0_f64);
        for place in &self.places {
            let nearest = outlines.nearest(&place.contact.point, f64::INFINITY, None);
            let distance = nearest.map_or(f64::INFINITY, |nearest| nearest.distance_sq.sqrt());
            if distance <= place.size {
                along += place.size;
            }
            inward = inward.max(distance);
        }
        along > LEAST_OF_END * inward
    }

    /// Whether elements that cut edges short cannot explain it, because the parts do not even meet there.
    fn is_displaced(&self) -> bool {
        self.places.iter().filter(|place| !place.meets).count() >= LEAST_PLACES
    }

    /// Mean width of what the places stand for.
    fn width(&self) -> f64 {
        let area: f64 = self.places.iter().map(|place| place.size.powi(2)).sum();
        let points = || self.places.iter().map(|place| place.contact.point);
        let sum: Vector3 = points().map(|point| point.coords).sum();
        let middle = Point3::from(sum / self.places.len() as f64);
        let arms = points().map(|point| (point - middle).norm());
        area / (2.0 * arms.fold(0.0, f64::max))
    }
}

/// Places that lie beside each other and differ to the same side, group by group.
fn groups<'a, 'b>(places: &'a [Apart<'b>]) -> Vec<Group<'a, 'b>> {
    let mut open: Vec<&Apart> = places.iter().collect();
    let mut groups = Vec::new();
    while let Some(first) = open.pop() {
        let mut group = vec![first];
        let mut done = 0;
        while let Some(&place) = group.get(done) {
            open.retain(|&there| {
                let near = BESIDE * place.size.max(there.size);
                let apart = there.contact.point - place.contact.point;
                let is_beside = place.left.signum() == there.left.signum()
                    && apart.norm_squared() <= near * near;
                if is_beside {
                    group.push(there);
                }
                !is_beside
            });
            done += 1;
        }
        groups.push(Group::new(group));
    }
    groups
}

/// Vertices of the outlines of both parts, in the target's frame.
fn outlines(evidence: &PoseEvidence<'_>) -> Vec<Point3> {
    let of_source = outline(evidence.source).map(|at| evidence.pose.apply(&at));
    of_source.chain(outline(evidence.target)).collect()
}

fn outline(surface: &Surface) -> impl Iterator<Item = Point3> {
    let outlines = surface.borders().iter().filter(|border| !border.is_hole);
    let vertices = outlines.flat_map(|border| &border.vertices);
    vertices.map(|&vertex| surface.mesh().positions()[vertex as usize])
}
