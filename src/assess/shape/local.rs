//! Does one part have a bead, an emboss or a dent that the other lacks? It may be too small to show in the figures of
//! most of the area.

use std::cell::OnceCell;

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
/// Nodes of the other part that must say so too where elements may have cut edges short.
const LEAST_SEEN: usize = 2;
/// Places lie beside each other within so many times the size of what they stand for.
const BESIDE: f64 = 1.7;
/// What reaches an outline over less than this share of how far it reaches inward is a bead that runs out there. What
/// reaches it over more is an end, and springback bends ends most: of them as much is accepted as of the whole part.
const LEAST_OF_END: f64 = 0.5;

/// More nodes that lie far apart are no local difference: the places show them.
const MOST_FAR: usize = 4000;

/// Between and beside the places, motion, bends and offset may explain so many times as much as at any of them.
const BEYOND_PLACES: f64 = 1.5;

/// Distances are measured to about a hundredth of themselves: a second layer of the sheet, a thickness away, is no more
/// than a thickness away.
const MEASURED: f64 = 1.01;

/// A node is looked at closely if a rough estimate of what nothing explains there comes so near the limit.
const ROUGHLY: f64 = 0.7;

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

/// A group of places that lie apart by more than a limit.
#[derive(Debug, Clone, Copy)]
struct Difference {
    by: f64,
    limit: f64,
    at: Point3,
    is_end: bool,
}

/// Where a node lies off the other part, and by how much.
type Off = (Point3, f64);

/// The largest group of neighbouring places at which what neither bends nor facets explain exceeds the tolerance to
/// one side, at an end that of springback, and which elements cutting short does not explain either. A piece that lies
/// too far from its counterpart to meet it counts too. The places are nodes of the smaller part; where all nodes were
/// measured, those of either part that lie far apart are places too, because a fine mesh has more nodes than are looked
/// at, and an element of the smaller part may span a bead of the larger one.
/// O(nodes that meet nothing · log triangles + k² + (k + outlines) · log outlines) for k places beyond the limit, and
/// O(nodes of the larger part) where a group is narrow.
pub(super) fn local_difference(
    evidence: &PoseEvidence<'_>,
    fit: &Fit,
    tolerance: &ShapeTolerance,
) -> Option<ShapeReason> {
    let search = LocalSearch {
        evidence,
        fit,
        tolerance,
        outlines: OnceCell::new(),
    };
    let found = search.among_places().into_iter().chain(search.among_far());
    let largest = found.max_by(|a, b| a.by.total_cmp(&b.by))?;
    let Difference {
        by,
        limit,
        at,
        is_end,
    } = largest;
    Some(ShapeReason::Local {
        by,
        limit,
        at,
        is_end,
    })
}

/// Two parts whose local differences are looked for.
struct LocalSearch<'a> {
    evidence: &'a PoseEvidence<'a>,
    fit: &'a Fit,
    tolerance: &'a ShapeTolerance,
    /// Built when first asked for.
    outlines: OnceCell<PointTree>,
}

impl LocalSearch<'_> {
    /// What the places say that the parts are compared at.
    fn among_places(&self) -> Option<Difference> {
        let contacts = &self.evidence.contacts;
        let displaced = self.evidence.displaced();
        let met = contacts.list.iter().zip(&self.fit.left);
        let met = met.filter_map(|(contact, &left)| self.apart(contact, left, true));
        let others = displaced.iter().filter_map(|contact| {
            let left = self.fit.left_at(contact, contacts);
            self.apart(contact, left, false)
        });
        let places: Vec<Apart> = met.chain(others).collect();
        let [of_source, of_target] = self.edges();
        let edge = if self.is_source_smaller() {
            of_target
        } else {
            of_source
        };
        self.largest(&places, edge, |slim| {
            let is_asked = |at: &Point3| slim.iter().any(|(g, _)| g.has_beside(at, |_| true));
            let nodes = self.evidence.of_larger(is_asked).into_iter();
            let off = nodes.map(|node| (node.point, self.fit.left_at(&node, contacts)));
            off.filter(|(_, left)| self.is_beyond(*left)).collect()
        })
    }

    /// What the nodes say that lie far apart.
    fn among_far(&self) -> Vec<Difference> {
        let contacts = &self.evidence.contacts;
        let is_asked = |point: &Point3, normal: &Vector3, gap: f64| {
            let left = self.fit.left_of((point, normal), gap, contacts);
            left.abs() > ROUGHLY * self.tolerance.remainder
        };
        let least = ROUGHLY * self.tolerance.remainder - BEYOND_PLACES * self.fit.most_explained();
        let met = self.evidence.of_near(least, is_asked, MOST_FAR);
        let [of_source, of_target] = [0, 1].map(|side| {
            let apart = |contact| {
                let left = self.fit.left_at(contact, &self.evidence.contacts);
                self.apart(contact, left, true)
            };
            met[side].iter().filter_map(apart).collect::<Vec<Apart>>()
        });
        let [edge_of_source, edge_of_target] = self.edges();
        let seen = |places: &[Apart]| places.iter().map(|p| (p.contact.point, p.left)).collect();
        let of_source_nodes = self.largest(&of_source, edge_of_target, |_| seen(&of_target));
        let of_target_nodes = self.largest(&of_target, edge_of_source, |_| seen(&of_source));
        of_source_nodes.into_iter().chain(of_target_nodes).collect()
    }

    /// A contact as a place apart, if it is one.
    fn apart<'b>(&self, contact: &'b Contact, left: f64, meets: bool) -> Option<Apart<'b>> {
        self.is_beyond(left).then(|| Apart {
            contact,
            left,
            meets,
            size: contact.weight.sqrt(),
        })
    }

    fn is_beyond(&self, left: f64) -> bool {
        left.abs() > self.tolerance.remainder
    }

    /// The largest of the groups that are no end within the tolerance of one and that elements cutting short do not
    /// explain; `edge` is the mean edge of the mesh that the places were measured against, and `seen` tells where nodes
    /// of that mesh lie off beside some groups.
    fn largest<'b>(
        &self,
        places: &[Apart<'b>],
        edge: f64,
        seen: impl FnOnce(&[(Group<'_, 'b>, Difference)]) -> Vec<Off>,
    ) -> Option<Difference> {
        if places.len() < LEAST_PLACES {
            return None;
        }
        let groups = groups(places).into_iter();
        let groups = groups.filter(|group| group.places.len() >= LEAST_PLACES);
        let found = groups.filter_map(|group| self.difference(&group).map(|found| (group, found)));
        let (mut found, mut slim): (Vec<_>, Vec<_>) = found
            .partition(|(group, _)| group.is_displaced() || group.width() >= LEAST_WIDTH * edge);
        if !slim.is_empty() {
            let nodes = seen(&slim);
            slim.retain(|(group, _)| group.is_seen_by(&nodes));
        }
        found.append(&mut slim);
        let found = found.into_iter().map(|(_, difference)| difference);
        found.max_by(|a, b| a.by.total_cmp(&b.by))
    }

    /// What a group says, if it is more than springback explains of an end.
    fn difference(&self, group: &Group<'_, '_>) -> Option<Difference> {
        let outlines = || PointTree::build(outlines(self.evidence));
        let is_end = group.is_end(self.outlines.get_or_init(outlines));
        let limit = if is_end {
            self.tolerance.springback
        } else {
            self.tolerance.remainder
        };
        let worst = group.worst()?;
        let found = Difference {
            by: worst.left.abs(),
            limit,
            at: worst.contact.point,
            is_end,
        };
        (found.by > MEASURED * limit).then_some(found)
    }

    fn is_source_smaller(&self) -> bool {
        let PoseEvidence {
            source,
            target,
            pose,
            ..
        } = self.evidence;
        is_source_smaller(source, target, pose.scale)
    }

    /// Mean edges of both meshes, in the target's unit.
    fn edges(&self) -> [f64; 2] {
        let PoseEvidence {
            source,
            target,
            pose,
            ..
        } = self.evidence;
        [
            source.measures().mean_edge_length * pose.scale,
            target.measures().mean_edge_length,
        ]
    }
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

    /// Whether nodes of the other part lie off beside it to the same side. Nodes lie on the sheet and facets cut it
    /// short, so that of one sheet the nodes of each part would lie in front of the other's facets. Where the other
    /// part has large elements, a few of its nodes and many places are as much.
    fn is_seen_by(&self, nodes: &[Off]) -> bool {
        let is_alike = |(at, left): &&Off| self.has_beside(at, |place| left * place.left > 0.0);
        let n_seen = nodes.iter().filter(is_alike).count();
        n_seen >= LEAST_SEEN && n_seen + self.places.len() >= 2 * LEAST_PLACES
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
