//! Does one part have a bead, an emboss or a dent that the other lacks? It may be too small to show in what
//! most of the area says.

use crate::assess::contact::Contact;
use crate::assess::evidence::PoseEvidence;
use crate::assess::tolerance::is_source_smaller;
use crate::geometry::{Point3, Vector3};
use crate::registration::Surface;

/// Places beside each other that differ by as much are no noise from this number on.
const LEAST_PLACES: usize = 5;
/// Places lie beside each other within so many times the size of what they stand for.
const BESIDE: f64 = 1.7;
/// What begins within so many sizes of an outline is not told: springback bends ends most, and there an
/// outline may have been cut.
const FROM_OUTLINE: f64 = 2.0;

/// Elements cut narrow beads and the edges of wide ones short. A group that is not so many edges wide may be that: edges
/// of the mesh that the places were measured against, because the places themselves are nodes, which lie on the sheet.
const LEAST_WIDTH: f64 = 2.5;

/// A group of places in the middle of the sheet where the surfaces lie apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalDifference {
    /// The largest distance.
    pub(super) by: f64,
    /// Where that is, in the target's frame.
    pub(super) at: Point3,
}

/// The largest group of neighbouring places, away from the outlines of both parts and wider than the elements cut
/// short, at which `left`, what neither bends nor facets explain, exceeds `limit` to one side.
/// O(k² + k · outlines) for k places beyond the limit.
pub(super) fn local_difference(
    evidence: &PoseEvidence<'_>,
    left: &[f64],
    limit: f64,
) -> Option<LocalDifference> {
    let contacts = &evidence.contacts;
    let beyond: Vec<(&Contact, f64)> = contacts
        .list
        .iter()
        .zip(left.iter().copied())
        .filter(|(_, left)| left.abs() > limit)
        .collect();
    if beyond.len() < LEAST_PLACES {
        return None;
    }
    let size = |contact: &Contact| (contact.weight * contacts.nodes_per_place).sqrt();
    let outlines = outlines(evidence);
    let is_inside = |group: &[usize]| {
        group.iter().all(|&place| {
            let contact = beyond[place].0;
            let far = FROM_OUTLINE * size(contact);
            let is_far = |at: &Point3| (at - contact.point).norm_squared() > far * far;
            outlines.iter().all(is_far)
        })
    };
    let (source, target, scale) = (evidence.source, evidence.target, evidence.pose.scale);
    let narrow = LEAST_WIDTH
        * if is_source_smaller(source, target, scale) {
            target.measures().mean_edge_length
        } else {
            source.measures().mean_edge_length * scale
        };
    let is_wide = |group: &[usize]| {
        let places = || group.iter().map(|&place| beyond[place].0);
        let area: f64 = places().map(|contact| size(contact).powi(2)).sum();
        let sum: Vector3 = places().map(|contact| contact.point.coords).sum();
        let middle = Point3::from(sum / group.len() as f64);
        let arm = |contact: &Contact| (contact.point - middle).norm();
        let length = 2.0 * places().map(arm).fold(0.0, f64::max);
        area >= narrow * length
    };
    let groups = groups(&beyond, size);
    let inside = groups
        .into_iter()
        .filter(|group| group.len() >= LEAST_PLACES && is_wide(group) && is_inside(group));
    let largest_of = |group: Vec<usize>| {
        let places = group.into_iter().map(|place| beyond[place]);
        places.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    let worst = inside
        .filter_map(largest_of)
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(LocalDifference {
        by: worst.1.abs(),
        at: worst.0.point,
    })
}

/// Places that lie beside each other and differ to the same side, group by group.
fn groups(places: &[(&Contact, f64)], size: impl Fn(&Contact) -> f64) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = (0..places.len()).collect();
    let mut groups = Vec::new();
    while let Some(first) = open.pop() {
        let mut group = vec![first];
        let mut done = 0;
        while let Some(&place) = group.get(done) {
            let (contact, left) = places[place];
            open.retain(|&other| {
                let (there, left_there) = places[other];
                let near = BESIDE * size(contact).max(size(there));
                let is_beside = left.signum() == left_there.signum()
                    && (there.point - contact.point).norm_squared() <= near * near;
                if is_beside {
                    group.push(other);
                }
                !is_beside
            });
            done += 1;
        }
        groups.push(group);
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
