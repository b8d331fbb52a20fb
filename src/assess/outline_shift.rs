//! Do outlines and holes agree on where a part belongs? The holes of one version may all lie farther along than
//! those of another, and where the surfaces leave the part free to slide, the pose follows them.

use super::borders::{BorderPair, Borders, PairKind};
use super::contact::Contacts;
use super::evidence::PoseEvidence;
use super::fit::Fit;
use super::least_squares::NormalEquations;
use super::trims::BorderApart;
use crate::geometry::{Matrix3, Plane, Point3, Vector3};

/// A shift of the outline must explain this share of how far it lies apart, or it was trimmed elsewhere.
const EXPLAINED: f64 = 0.75;
/// Of the border across the shift at least this share faces each way: a single end may be trimmed elsewhere.
const EACH_WAY: f64 = 0.25;
/// Cosine of the largest angle between a shift and the directions across borders that it moves apart.
const ACROSS: f64 = 0.5;
/// A shift of less than this share of what is accepted has no direction.
const LEAST_SHIFT: f64 = 0.5;
/// Fewer holes may have been pierced elsewhere.
const LEAST_HOLES: usize = 3;

/// How far the outline lies aside of the holes, if by more than `limit`; `None` where no shift explains how it lies,
/// and where surfaces do not leave the part free to be shifted so: they agree with the holes then, and both sides were
/// trimmed elsewhere. `fit` is that of the evidence. O(places).
pub(super) fn outline_aside_of_holes(
    evidence: &PoseEvidence<'_>,
    fit: &Fit,
    limit: f64,
) -> Option<BorderApart> {
    let borders = &evidence.borders;
    if fit.holes.len() < LEAST_HOLES {
        return None;
    }
    let outline = Outline::of(borders, fit);
    let shift = outline.shift();
    let of_holes = fit.holes.iter().map(|hole| hole.off).sum::<Vector3>();
    let of_holes = of_holes / fit.holes.len() as f64;
    let along = shift.try_normalize(LEAST_SHIFT * limit)?;
    let by = (shift - of_holes).dot(&along);
    let is_aside = by > limit && outline.explained_by(&shift);
    if !is_aside || by * resistance(&evidence.contacts, &along) > limit {
        return None;
    }
    let at = outline.place_across(&along)?;
    Some(BorderApart { by, at })
}

/// How far surfaces come apart by a unit shift along this direction, root mean square, whatever other small motion
/// goes with it.
fn resistance(contacts: &Contacts, along: &Vector3) -> f64 {
    // The shift's first number is that along the direction.
    const ALONG: usize = 3;
    let [right, up] = Plane::new(contacts.center, along).axes();
    let axes = Matrix3::from_columns(&[*along, right, up]);
    let mut equations = NormalEquations::<6>::default();
    let (mut area, mut alone) = (0.0, 0.0);
    for contact in &contacts.list {
        let mut row = contacts.row(&contact.point, &contact.normal);
        let ways = axes.tr_mul(&contact.normal);
        row.fixed_rows_mut::<3>(ALONG).copy_from(&ways);
        equations.add(&row, 0.0, contact.weight);
        area += contact.weight;
        alone += contact.weight * row[ALONG].powi(2);
    }
    let own = equations.imitated(ALONG).own_share.max(0.0) * alone;
    (own / area.max(f64::MIN_POSITIVE)).sqrt()
}

/// The places along the outlines of both parts, each with what is left of the distance across it.
struct Outline<'a>(Vec<(&'a BorderPair, f64)>);

impl<'a> Outline<'a> {
    fn of(borders: &'a Borders, fit: &Fit) -> Self {
        let places = borders.pairs().iter().zip(fit.borders.iter().copied());
        let of_outlines = places.filter(|(pair, _)| pair.kind == PairKind::Outlines);
        Self(of_outlines.collect())
    }

    /// The shift that brings both outlines closest together, in least squares.
    fn shift(&self) -> Vector3 {
        let mut equations = NormalEquations::<3>::default();
        for (pair, left) in &self.0 {
            equations.add(&pair.across, *left, pair.weight);
        }
        equations.solved()
    }

    /// Whether the shift leaves little of how far the outlines lie apart.
    fn explained_by(&self, shift: &Vector3) -> bool {
        let (mut before, mut after) = (0.0, 0.0);
        for (pair, left) in &self.0 {
            before += pair.weight * left.powi(2);
            after += pair.weight * (left - pair.across.dot(shift)).powi(2);
        }
        after < (1.0 - EXPLAINED) * before
    }

    /// A place that a shift along this direction moves apart most; `None` where most of them face one way.
    fn place_across(&self, along: &Vector3) -> Option<Point3> {
        let cosines = self
            .0
            .iter()
            .map(|(pair, _)| (pair, pair.across.dot(along)));
        let across: Vec<_> = cosines.filter(|(_, cos)| cos.abs() > ACROSS).collect();
        let total: f64 = across.iter().map(|(pair, _)| pair.weight).sum();
        let forth = across.iter().filter(|(_, cos)| *cos > 0.0);
        let forth: f64 = forth.map(|(pair, _)| pair.weight).sum();
        let is_both_ways = forth.min(total - forth) >= EACH_WAY * total;
        let most = across.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        is_both_ways.then_some(most.0.point)
    }
}
