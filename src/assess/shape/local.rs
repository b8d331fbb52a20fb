//! Does one part have a bead, an emboss or a dent that the other lacks? It may be too small to show in the figures of
//! most of the area.

use std::cell::OnceCell;

use crate::assess::contact::Contact;
use crate::assess::evidence::PoseEvidence;
use crate::assess::fit::Fit;
use crate::assess::shape::{BentEnd, ShapeReason};
use crate::assess::tolerance::{ShapeTolerance, is_source_smaller};
use crate::geometry::{Border, Point3, Vector3};
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
/// What lies beside more than this share of the outline is no end either, but the whole rim: the part is drawn deeper
/// or less deep.
const ALL_ROUND: f64 = 0.75;
/// A closed border shorter than this share of the longest is that of a cut-out, such as the slit of a louvre: the sheet
/// around it holds it, and no end lies there.
const CUT_OUT: f64 = 0.3;
/// What springback bends turns about a line: in the mean it lies beyond the tolerance by half of what it does at its
/// edge, and by three quarters where it is two elements wide. A flange that lies off by more than this share of it in
/// the mean was shifted as a whole, …
const SHIFTED: f64 = 0.8;
/// … if it is so many sizes of what places stand for wide, …
const ROWS: f64 = 1.5;
/// … beside it hardly more than this share of the tolerance is left, …
const STILL: f64 = 0.35;
/// … and its edge lies off by so many tolerances.
const SURELY_OFF: f64 = 1.5;
/// Another layer fits at a place if places of at least this share of its area do, …
const LAYERED: f64 = 0.3;
/// … so near, in sizes of what places stand for, that they are none beside it in the same layer.
const OVER: f64 = 0.7;

/// More nodes that lie far apart are no local difference: the places show them.
const MOST_FAR: usize = 4000;

/// Between and beside the places, motion, bends and offset may explain so many times as much as at any of them.
const BEYOND_PLACES: f64 = 1.5;

/// Distances are measured to about a hundredth of themselves: a second layer of the sheet, a thickness away, is no more
/// than a thickness away.
const MEASURED: f64 = 1.01;

/// A node is looked at closely if a rough estimate of what nothing explains there comes so near the limit, and confirms
/// a narrow difference if that does.
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
    /// The parts meet there; else the smaller one meets nothing.
    meets: bool,
    /// Edge of the square that it stands for.
    size: f64,
    /// Its number among the contacts that the parts are compared at, if it is one of them.
    number: Option<usize>,
}

impl Apart<'_> {
    /// Whether a point lies within so many sizes of it along the sheet: a node of the other part there lies off it by
    /// the gap.
    fn is_beside(&self, at: &Point3, sizes: f64) -> bool {
        let away = at - self.contact.point;
        let height = away.dot(&self.contact.normal);
        let near = sizes * self.size;
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
#[derive(Debug, Clone)]
struct Difference {
    by: f64,
    limit: f64,
    at: Point3,
    is_end: bool,
    /// Those of its places that have one.
    numbers: Vec<usize>,
}

impl Difference {
    /// Whether it is more than is accepted.
    fn is_beyond(&self) -> bool {
        self.by > MEASURED * self.limit
    }
}

impl From<Difference> for ShapeReason {
    fn from(found: Difference) -> Self {
        let Difference {
            by,
            limit,
            at,
            is_end,
            ..
        } = found;
        Self::Local {
            by,
            limit,
            at,
            is_end,
        }
    }
}

/// Where a node lies off the other part, and by how much.
type Off = (Point3, f64);

/// What is found at single places.
#[derive(Default)]
pub(super) struct LocalDifferences {
    /// The largest that is more than is accepted.
    pub(super) reason: Option<ShapeReason>,
    /// The end that is bent most of those that springback explains.
    pub(super) bent_end: Option<BentEnd>,
    /// The contacts of these ends, by their numbers.
    pub(super) at_ends: Vec<usize>,
}

/// Groups of neighbouring places at which what neither bends nor facets explain exceeds the tolerance to one side, at
/// an end that of springback, and which elements cutting short does not explain either. A piece that lies too far from
/// its counterpart to meet it, or turns away from it, counts too. The places are nodes of the smaller part; where all
/// nodes were measured, those of either part that lie far apart are places too, because a fine mesh has more nodes than
/// are looked at, and an element of the smaller part may span a bead of the larger one.
/// O(nodes that meet nothing · log triangles + k² + (k + outlines) · log outlines) for k places beyond the limit, and
/// O(nodes of the larger part) where a group is narrow.
pub(super) fn local_differences(
    evidence: &PoseEvidence<'_>,
    fit: &Fit,
    tolerance: &ShapeTolerance,
) -> LocalDifferences {
    let search = LocalSearch {
        evidence,
        fit,
        tolerance,
        outlines: OnceCell::new(),
    };
    let mut found = search.among_places();
    found.extend(search.among_far());
    let (beyond, within): (Vec<_>, Vec<_>) = found.into_iter().partition(Difference::is_beyond);
    let largest = |found: Vec<Difference>| found.into_iter().max_by(|a, b| a.by.total_cmp(&b.by));
    let ends: Vec<Difference> = within.into_iter().filter(|found| found.is_end).collect();
    let numbers = ends.iter().flat_map(|end| &end.numbers);
    LocalDifferences {
        reason: largest(beyond).map(ShapeReason::from),
        at_ends: numbers.copied().collect(),
        bent_end: largest(ends).map(|Difference { by, at, .. }| BentEnd { by, at }),
    }
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
    fn among_places(&self) -> Vec<Difference> {
        let contacts = &self.evidence.contacts;
        let displaced = self.evidence.displaced();
        let met = contacts.list.iter().zip(&self.fit.left).enumerate();
        let met = met.filter_map(|(number, (contact, &left))| {
            let apart = self.apart(contact, left, true)?;
            Some(Apart {
                number: Some(number),
                ..apart
            })
        });
        let others = displaced.iter().filter_map(|contact| {
            let left = self.fit.left_at(contact, contacts);
            self.apart(contact, left, false)
        });
        let astray = self.evidence.astray(self.tolerance.springback);
        let astray = astray
            .iter()
            .filter_map(|contact| self.apart(contact, contact.gap, false));
        let places: Vec<Apart> = met.chain(others).chain(astray).collect();
        let [of_source, of_target] = self.edges();
        let edge = if self.is_source_smaller() {
            of_target
        } else {
            of_source
        };
        let nearly = ROUGHLY * self.tolerance.remainder;
        self.differences(&places, edge, |slim| {
            let is_asked = |at: &Point3| slim.iter().any(|(g, _)| g.has_beside(at, |_| true));
            let nodes = self.evidence.of_larger(is_asked).into_iter();
            let off = nodes.map(|node| (node.point, self.fit.left_at(&node, contacts)));
            off.filter(|(_, left)| left.abs() > nearly).collect()
        })
    }

    /// What the nodes say that lie far apart.
    fn among_far(&self) -> Vec<Difference> {
        let contacts = &self.evidence.contacts;
        let nearly = ROUGHLY * self.tolerance.remainder;
        let is_asked = |point: &Point3, normal: &Vector3, gap: f64| {
            let left = self.fit.left_of((point, normal), gap, contacts);
            left.abs() > nearly
        };
        let least = nearly - BEYOND_PLACES * self.fit.most_explained();
        let met = self.evidence.of_near(least, is_asked, MOST_FAR);
        let lefts = met.each_ref().map(|contacts| {
            let left = |contact| self.fit.left_at(contact, &self.evidence.contacts);
            contacts.iter().map(left).collect::<Vec<f64>>()
        });
        let [of_source, of_target] = [0, 1].map(|side| {
            let contacts = met[side].iter().zip(&lefts[side]);
            let apart = contacts.filter_map(|(contact, &left)| self.apart(contact, left, true));
            apart.collect::<Vec<Apart>>()
        });
        let seen = |side: usize| {
            let contacts = met[side].iter().zip(&lefts[side]);
            let off = contacts.filter(|(_, left)| left.abs() > nearly);
            off.map(|(contact, left)| (contact.point, *left)).collect()
        };
        let [edge_of_source, edge_of_target] = self.edges();
        let mut found = self.differences(&of_source, edge_of_target, |_| seen(1));
        found.extend(self.differences(&of_target, edge_of_source, |_| seen(0)));
        found
    }

    /// A contact as a place apart, if it is one.
    fn apart<'b>(&self, contact: &'b Contact, left: f64, meets: bool) -> Option<Apart<'b>> {
        self.is_beyond(left).then(|| Apart {
            contact,
            left,
            meets,
            size: contact.weight.sqrt(),
            number: None,
        })
    }

    fn is_beyond(&self, left: f64) -> bool {
        left.abs() > self.tolerance.remainder
    }

    /// What the groups say that elements cutting short do not explain; `edge` is the mean edge of the mesh that the
    /// places were measured against, and `seen` tells where nodes of that mesh lie off beside some groups.
    fn differences<'b>(
        &self,
        places: &[Apart<'b>],
        edge: f64,
        seen: impl FnOnce(&[(Group<'_, 'b>, Difference)]) -> Vec<Off>,
    ) -> Vec<Difference> {
        if places.len() < LEAST_PLACES {
            return Vec::new();
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
        found
            .into_iter()
            .map(|(_, difference)| difference)
            .collect()
    }

    /// What a group says; `None` of an empty one.
    fn difference(&self, group: &Group<'_, '_>) -> Option<Difference> {
        let worst = group.worst()?;
        let outlines = || PointTree::build(outlines(self.evidence));
        let is_end = group.is_end(self.outlines.get_or_init(outlines))
            && !self.is_shifted(group)
            && !self.is_all_round(group);
        let limit = if is_end {
            self.tolerance.springback
        } else {
            self.tolerance.remainder
        };
        Some(Difference {
            by: worst.left.abs(),
            limit,
            at: worst.contact.point,
            is_end,
            numbers: group.places.iter().filter_map(|p| p.number).collect(),
        })
    }

    /// Whether a group was shifted as a whole, with a step beside it, and not turned about a line. No other layer of
    /// the sheet fits there: at a hem one does, and which of both is compared with which is chance.
    fn is_shifted(&self, group: &Group<'_, '_>) -> bool {
        if !group.is_off_as_a_whole(self.tolerance.remainder) {
            return false;
        }
        let contacts = &self.evidence.contacts;
        let (mut over, mut beside, mut left_beside) = (0.0, 0.0, 0.0);
        for (contact, left) in contacts.list.iter().zip(&self.fit.left) {
            if self.is_beyond(*left) {
                continue;
            }
            if group.is_within(contact, OVER) {
                over += contact.weight;
            } else if group.is_within(contact, BESIDE) {
                beside += contact.weight;
                left_beside += contact.weight * left.abs();
            }
        }
        over < LAYERED * group.area() && left_beside <= STILL * self.tolerance.remainder * beside
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

    /// Whether a group lies beside nearly all of the outline of the smaller part.
    fn is_all_round(&self, group: &Group<'_, '_>) -> bool {
        let PoseEvidence {
            source,
            target,
            pose,
            ..
        } = self.evidence;
        let outline: Vec<Point3> = if self.is_source_smaller() {
            outline(source).map(|at| pose.apply(&at)).collect()
        } else {
            outline(target).collect()
        };
        let beside = outline.iter().filter(|at| group.has_beside(at, |_| true));
        beside.count() as f64 > ALL_ROUND * outline.len() as f64
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
                .any(|place| place.is_beside(at, BESIDE) && is_asked(place))
    }

    /// Whether a place lies within so many sizes along the sheet of one of the group.
    fn is_within(&self, contact: &Contact, sizes: f64) -> bool {
        let at = &contact.point;
        *at >= self.low
            && *at <= self.high
            && self.places.iter().any(|place| place.is_beside(at, sizes))
    }

    /// What its places stand for.
    fn area(&self) -> f64 {
        self.places.iter().map(|place| place.size.powi(2)).sum()
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

    /// Whether all of it lies about as far off, where what lies off by less than `tolerance` belongs to no group, and
    /// it is wide enough to tell.
    fn is_off_as_a_whole(&self, tolerance: f64) -> bool {
        let beyond = |place: &Apart<'_>| place.left.abs() - tolerance;
        let weighted = self.places.iter().map(|p| p.size.powi(2) * beyond(p));
        let mean = weighted.sum::<f64>() / self.area();
        let most = self.places.iter().map(|p| beyond(p)).fold(0.0, f64::max);
        let size = (self.area() / self.places.len() as f64).sqrt();
        tolerance + most > SURELY_OFF * tolerance
            && mean > SHIFTED * most
            && self.width() > ROWS * size
    }

    /// Whether elements that cut edges short cannot explain it, because the parts do not even meet there.
    fn is_displaced(&self) -> bool {
        self.places.iter().filter(|place| !place.meets).count() >= LEAST_PLACES
    }

    /// Mean width of what the places stand for.
    fn width(&self) -> f64 {
        let points = || self.places.iter().map(|place| place.contact.point);
        let sum: Vector3 = points().map(|point| point.coords).sum();
        let middle = Point3::from(sum / self.places.len() as f64);
        let arms = points().map(|point| (point - middle).norm());
        self.area() / (2.0 * arms.fold(0.0, f64::max))
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
    let borders = || surface.borders().iter().filter(|border| !border.is_hole);
    let longest = borders().map(|border| border.length).fold(0.0, f64::max);
    let is_outer = move |border: &&Border| !border.closed || border.length >= CUT_OUT * longest;
    let outlines = borders().filter(is_outer);
    let vertices = outlines.flat_map(|border| &border.vertices);
    vertices.map(|&vertex| surface.mesh().positions()[vertex as usize])
}
