//! Where two parts meet under a pose: what the uncertainty of the pose and the statement about the
//! shape are computed from.

mod displaced;

use std::sync::Arc;

use rayon::iter::Either;
use rayon::prelude::*;

use super::least_squares::quantile;
use super::scaled::Scaled;
use super::small_motion::{self, Six, turn_and_shift};
use super::tolerance::is_source_smaller;
use crate::geometry::{Point3, Rotation, Similarity, Vector3};
use crate::registration::{Motion, Surface, WeightedNode, fit_pairs};
use crate::search::{ClosestPoint, SurfaceHit};

/// Nodes of the smaller part that are looked at; more change no figure by a percent.
pub(crate) const MAX_NODES: usize = 6000;
/// Nodes of the smaller part that poses are compared on.
pub(crate) const FEW_NODES: usize = 1500;
/// Differences of the surfaces are stated at this share of the area: what lies farther apart at few places is looked
/// for by itself.
pub(crate) const STATED_SHARE: f64 = 0.95;
/// Surfaces that turn away from each other by more than this do not lie on each other: cosine of 50°.
const MIN_FACING: f64 = 0.64;
/// A point lies beside the place closest to it, and not above, if the way there leads off the normal by more than this:
/// sine of 30°.
const BESIDE: f64 = 0.5;
/// A place beside a border by less than this share of the mean edge length lies on it.
const ON_THE_BORDER: f64 = 0.02;

/// A place of the smaller part beside the other part, in the target's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    /// Point of the surface, in the target's frame.
    pub(super) point: Point3,
    /// Unit normal on the target's side.
    pub(super) normal: Vector3,
    /// How far the source lies in front of the target along the normal.
    pub(super) gap: f64,
    /// Area it stands for.
    pub(super) weight: f64,
    /// How much of the gap the facets of the other part may explain.
    pub(super) facet: f64,
}

/// All places where the parts meet.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contacts {
    pub(super) list: Vec<Contact>,
    /// Nodes of the smaller part that were looked at and meet nothing.
    unmet: Vec<WeightedNode>,
    /// Share of the smaller part's area that meets the other part.
    pub(crate) share: f64,
    /// Middle of the places, and their mean distance from it.
    pub(super) center: Point3,
    pub(super) radius: f64,
}

/// How two parts meet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting {
    /// Share of the smaller part that meets the other.
    pub(crate) share: f64,
    /// How far the surfaces lie apart there, root mean square.
    pub(crate) gap: f64,
}

/// The search for the places where two parts meet, under one pose after another.
#[derive(Debug, Clone)]
pub(crate) struct ContactSearch<'a> {
    source: &'a Surface,
    target: &'a Surface,
    /// Whether the source is the smaller part, whose nodes are looked at.
    of_source: bool,
    /// Distance in target units beyond which parts do not meet.
    reach: f64,
    /// The nodes that are looked at.
    nodes: Arc<[WeightedNode]>,
    /// Of each of them the triangle that was closest to it under the last pose.
    closest: Vec<Option<u32>>,
}

impl<'a> ContactSearch<'a> {
    /// Prepares for poses of this scale; about `max_nodes` nodes of the smaller part are looked at.
    pub(crate) fn new(
        [source, target]: [&'a Surface; 2],
        scale: f64,
        reach: f64,
        max_nodes: usize,
    ) -> Self {
        let of_source = is_source_smaller(source, target, scale);
        let data = if of_source { source } else { target };
        let nodes = data.even_nodes(max_nodes);
        Self {
            source,
            target,
            of_source,
            reach,
            closest: vec![None; nodes.len()],
            nodes,
        }
    }

    /// Source and target.
    pub(super) fn surfaces(&self) -> [&'a Surface; 2] {
        [self.source, self.target]
    }

    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// The places where the parts meet under a pose. O(nodes · log triangles), less for a pose near the
    /// last one.
    pub(crate) fn at(&mut self, pose: &Similarity) -> Option<Contacts> {
        self.at_scaled(pose, None)
    }

    /// The same with the source under the pose scaled along axes. A place of the source is given where scaling takes
    /// it; one of the target is given where it lies, with the gap that is measured after scaling is undone.
    pub(super) fn at_scaled(
        &mut self,
        pose: &Similarity,
        scaled: Option<&Scaled>,
    ) -> Option<Contacts> {
        let sides = NodesOnSurface::new([self.source, self.target], pose, self.of_source);
        let reach = self.reach;
        let nodes = self.nodes.par_iter().zip(&mut self.closest);
        let (list, unmet) = nodes.partition_map(|(&node, closest)| {
            match sides.contact(node, reach, scaled, closest) {
                Some(contact) => Either::Left(contact),
                None => Either::Right(node),
            }
        });
        let total = self.nodes.iter().map(|node| node.area).sum();
        Contacts::of(list, unmet, total)
    }

    /// The scale that would fit the source best to the places of the target that it meets under a pose, times that of
    /// the pose; `None` where they do not meet. An offset of the sheets by at most `offset` is no scale: a tube is
    /// wider at its outer skin. O(nodes · log triangles).
    pub(crate) fn best_scale(&mut self, pose: &Similarity, offset: f64) -> Option<f64> {
        let met = self.at(pose)?;
        let side = if self.of_source { -1.0 } else { 1.0 };
        let beside =
            |(contact, gap): (&Contact, f64)| contact.point + contact.normal * (side * gap);
        let gaps = met.without_offset(offset).into_iter();
        let others: Vec<Point3> = met.list.iter().zip(gaps).map(beside).collect();
        let pairs = met.list.iter().zip(&others);
        let pairs = pairs.map(|(contact, other)| (&contact.point, other, contact.weight));
        let scale = fit_pairs(pairs, Motion::Rigid).ok()?.scale;
        Some(pose.scale * if self.of_source { scale } else { 1.0 / scale })
    }

    /// Where nodes of the larger part meet the smaller one under a pose: those that lie where `is_asked` says.
    /// O(nodes + places · log triangles).
    pub(super) fn of_larger(
        &self,
        pose: &Similarity,
        is_asked: impl Fn(&Point3) -> bool + Sync,
    ) -> Vec<Contact> {
        let sides = NodesOnSurface::new([self.source, self.target], pose, !self.of_source);
        let positions = sides.data.mesh().positions();
        let asked = (0..positions.len()).into_par_iter().filter(|&vertex| {
            is_asked(&if sides.of_source {
                pose.apply(&positions[vertex])
            } else {
                positions[vertex]
            })
        });
        let nodes = asked.map(|vertex| WeightedNode::of(sides.data, vertex as u32));
        let list = nodes.filter_map(|node| sides.contact(node, self.reach, None, &mut None));
        list.collect()
    }

    /// Where nodes of one part, the source or the target, meet the other under a pose. O(nodes · log triangles).
    pub(super) fn of_nodes(
        &self,
        pose: &Similarity,
        of_source: bool,
        nodes: &[WeightedNode],
    ) -> Vec<Contact> {
        let sides = NodesOnSurface::new([self.source, self.target], pose, of_source);
        let met = |&node: &WeightedNode| sides.contact(node, self.reach, None, &mut None);
        nodes.par_iter().filter_map(met).collect()
    }

    /// Share of the smaller part's area that lies beyond the borders of the other part under a pose: its closest
    /// place there is a border that lies off its reach or beside it. O(nodes · log triangles).
    pub(crate) fn overhang(&self, pose: &Similarity) -> f64 {
        let NodesOnSurface {
            data,
            model,
            model_from_data,
            unit,
            ..
        } = NodesOnSurface::new([self.source, self.target], pose, self.of_source);
        let reach = self.reach / unit;
        let areas = self.nodes.par_iter().map(|node| {
            let moved = model_from_data.apply(&data.mesh().positions()[node.vertex as usize]);
            let hit = model.bvh().closest(&moved, f64::INFINITY, None, None);
            let is_beyond = hit.is_some_and(|hit| {
                model.is_on_border(&hit)
                    && ((moved - hit.point).norm() > reach || is_beside(model, &hit, &moved))
            });
            (if is_beyond { node.area } else { 0.0 }, node.area)
        });
        // Summed in one order, whatever the number of threads.
        let areas: Vec<(f64, f64)> = areas.collect();
        let (beyond, total) = areas
            .into_iter()
            .fold((0.0, 0.0), |(b, t), (beyond, area)| (b + beyond, t + area));
        if total > 0.0 { beyond / total } else { 0.0 }
    }
}

/// Whose nodes are looked at under a pose, and the surface that they are measured against.
struct NodesOnSurface<'a> {
    pose: &'a Similarity,
    of_source: bool,
    data: &'a Surface,
    model: &'a Surface,
    model_from_data: Similarity,
    /// Length of a unit of the model in target units.
    unit: f64,
}

impl<'a> NodesOnSurface<'a> {
    fn new([source, target]: [&'a Surface; 2], pose: &'a Similarity, of_source: bool) -> Self {
        let (data, model, model_from_data, unit) = if of_source {
            (source, target, *pose, 1.0)
        } else {
            (target, source, pose.inverse(), pose.scale)
        };
        Self {
            pose,
            of_source,
            data,
            model,
            model_from_data,
            unit,
        }
    }

    /// Where a node meets the model within `reach`, in target units; `closest` is the triangle to begin with, and
    /// becomes the one found.
    fn contact(
        &self,
        node: WeightedNode,
        reach: f64,
        scaled: Option<&Scaled>,
        closest: &mut Option<u32>,
    ) -> Option<Contact> {
        let Self {
            data,
            model,
            model_from_data,
            unit,
            ..
        } = self;
        let (vertex, weight) = (node.vertex as usize, node.area);
        if weight <= 0.0 {
            return None;
        }
        let position = data.mesh().positions()[vertex];
        let moved = match scaled {
            None => model_from_data.apply(&position),
            Some(scaled) if self.of_source => scaled.apply(&model_from_data.apply(&position)),
            Some(scaled) => model_from_data.apply(&scaled.undo(&position)),
        };
        let own = model_from_data.rotate(&data.vertex_normals()[vertex]);
        let hit = model.bvh().closest(&moved, reach / unit, *closest, None)?;
        *closest = Some(hit.triangle);
        let other = model.normal_at(&hit);
        let facing = own.dot(&other);
        let is_off_the_border = model.is_on_border(&hit) && is_beside(model, &hit, &moved);
        if facing.abs() < MIN_FACING || is_off_the_border {
            return None;
        }
        let height = (moved - model.curved_point(&hit)).dot(&other);
        let facet = facet_error(model, hit.triangle as usize, &own) * unit;
        Some(if self.of_source {
            Contact {
                point: moved,
                normal: other,
                gap: height,
                weight,
                facet,
            }
        } else {
            // Measured from the source; turned to the target's side.
            let side = facing.signum();
            Contact {
                point: position,
                normal: self.pose.rotate(&other) * side,
                gap: -height * side * unit,
                weight,
                facet,
            }
        })
    }
}

impl Contacts {
    /// Places where parts meet, of which the smaller has the area `total` at the nodes looked at.
    fn of(list: Vec<Contact>, unmet: Vec<WeightedNode>, total: f64) -> Option<Self> {
        let sum: f64 = list.iter().map(|c| c.weight).sum();
        let origin = list.first()?.point;
        let mean: Vector3 = list.iter().map(|c| (c.point - origin) * c.weight).sum();
        let center = origin + mean / sum;
        let arm = |c: &Contact| (c.point - center).norm() * c.weight;
        let radius = list.iter().map(arm).sum::<f64>() / sum;
        (radius > 0.0).then_some(Self {
            share: sum / total,
            list,
            unmet,
            center,
            radius,
        })
    }

    /// The distances of the surfaces where they meet, without an offset of all of them by at most `offset`: skin and
    /// mid-surface lie apart at the right pose too.
    pub(crate) fn without_offset(&self, offset: f64) -> Vec<f64> {
        let weight: f64 = self.list.iter().map(|c| c.weight).sum();
        let mean = self.list.iter().map(|c| c.weight * c.gap).sum::<f64>() / weight;
        let offset = mean.clamp(-offset, offset);
        self.list.iter().map(|c| c.gap - offset).collect()
    }

    /// The root mean square of the distances [`Contacts::without_offset`].
    pub(crate) fn typical_gap(&self, offset: f64) -> f64 {
        let weight: f64 = self.list.iter().map(|c| c.weight).sum();
        let gaps = self.without_offset(offset).into_iter();
        let squares = gaps.zip(&self.list).map(|(gap, c)| c.weight * gap.powi(2));
        (squares.sum::<f64>() / weight).sqrt()
    }

    /// How the parts meet, apart from an offset as in [`Contacts::without_offset`].
    pub(crate) fn meeting(&self, offset: f64) -> Meeting {
        Meeting {
            share: self.share,
            gap: self.typical_gap(offset),
        }
    }

    /// The size that these values, one for each place, do not exceed over this share of the area.
    pub(crate) fn at_share(&self, values: &[f64], share: f64) -> f64 {
        let sizes = values.iter().map(|v| v.abs());
        let sizes = sizes.zip(self.list.iter().map(|c| c.weight));
        quantile(&mut sizes.collect::<Vec<_>>(), share)
    }

    /// How a small motion moves a place along a direction, turns about `center` and in lengths at `radius`.
    pub(super) fn row(&self, point: &Point3, direction: &Vector3) -> Six {
        small_motion::row(&((point - self.center) / self.radius), direction)
    }

    /// The motion that undoes a small one of the source, given as in [`Contacts::row`].
    pub(super) fn undo(&self, motion: &Six) -> Similarity {
        let [turn, shift] = turn_and_shift(motion);
        let rotation = Rotation::new(turn / -self.radius);
        let rotation = *rotation.to_rotation_matrix().matrix();
        Similarity {
            rotation,
            ..Similarity::identity()
        }
        .taking(&self.center, &(self.center - shift))
    }

    /// The places cut by repeated halving at the median into `1 << levels` patches; for each place
    /// its patch, counted from 0. Fewer patches where there are few places, none without any.
    pub(super) fn patches(&self, levels: u32) -> Vec<usize> {
        let mut patch = vec![0; self.list.len()];
        let mut all: Vec<usize> = (0..self.list.len()).collect();
        self.halve(&mut all, levels, &mut 0, &mut patch);
        patch
    }

    /// Patches are numbered on from `next`.
    fn halve(&self, places: &mut [usize], levels: u32, next: &mut usize, patch: &mut [usize]) {
        if levels == 0 || places.len() < 2 {
            for &place in places.iter() {
                patch[place] = *next;
            }
            *next += usize::from(!places.is_empty());
            return;
        }
        let at = |place: usize| &self.list[place].point;
        let extent = |axis: usize| {
            let values = places.iter().map(|&i| at(i)[axis]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
            high - low
        };
        let extents = [extent(0), extent(1), extent(2)];
        let longest = (0..3).max_by(|&a, &b| extents[a].total_cmp(&extents[b]));
        let axis = longest.unwrap_or(0);
        let middle = places.len() / 2;
        let in_order = |a: &usize, b: &usize| at(*a)[axis].total_cmp(&at(*b)[axis]).then(a.cmp(b));
        places.select_nth_unstable_by(middle, in_order);
        let (low, high) = places.split_at_mut(middle);
        self.halve(low, levels - 1, next, patch);
        self.halve(high, levels - 1, next, patch);
    }
}

/// Whether a point lies rather beside the place of a surface closest to it than above. One that is beside it by
/// [`ON_THE_BORDER`] at most lies on it: the direction of a distance that small is that of rounding.
fn is_beside(model: &Surface, hit: &SurfaceHit, point: &Point3) -> bool {
    let (away, normal) = (point - hit.point, model.normal_at(hit));
    let beside = (away - normal * away.dot(&normal)).norm();
    beside > BESIDE * away.norm() && beside > ON_THE_BORDER * model.measures().mean_edge_length
}

/// How far a facet may lie off the smooth surface it stands for, whose normal here is `normal`: the
/// sagitta of an arc over its longest edge that turns by twice the angle between both normals.
fn facet_error(model: &Surface, triangle: usize, normal: &Vector3) -> f64 {
    let [a, b, c] = model.mesh().corners(triangle);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let facet = model.mesh().normal(triangle);
    let corners = model.mesh().triangles()[triangle].map(|v| &model.vertex_normals()[v as usize]);
    let cos = corners
        .into_iter()
        .chain([normal])
        .map(|n| facet.dot(n).abs());
    longest * cos.fold(1.0, f64::min).acos() / 4.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    #[test]
    fn patches_of_a_few_places_have_numbers_of_their_own() {
        let contacts = |n: usize| {
            let list = (0..n).map(|i| Contact {
                point: Point3::new(i as f64, 0.0, 0.0),
                normal: Vector3::z(),
                gap: 0.0,
                weight: 1.0,
                facet: 0.0,
            });
            Contacts::of(list.collect(), Vec::new(), n as f64).unwrap()
        };
        let n_patches = [(3, 3), (5, 5), (9, 9), (16, 16), (17, 16), (40, 16)];
        for (n, expected) in n_patches {
            let mut patches = contacts(n).patches(4);
            assert!(patches.is_sorted(), "{patches:?}");
            patches.dedup();
            assert_eq!(patches, (0..expected).collect::<Vec<_>>(), "{n}");
        }
    }

    /// A sheet of 80 by `length` with cells of 1 by 1 for x below 40 and of 10 by 10 beyond.
    fn graded_sheet(length: usize) -> Surface {
        let columns: Vec<f64> = (0..40)
            .map(f64::from)
            .chain([40.0, 50.0, 60.0, 70.0, 80.0])
            .collect();
        let n = columns.len();
        let points = (0..=length).flat_map(|y| {
            columns.iter().map(move |&x| {
                let y = if x > 40.0 { y / 10 * 10 } else { y };
                Point3::new(x, y as f64, 0.0)
            })
        });
        let cells = (0..length).flat_map(|y| (0..n - 1).map(move |x| (x, y)));
        let triangles = cells.flat_map(|(x, y)| {
            let a = (y * n + x) as u32;
            let up = a + n as u32;
            [[a, a + 1, up + 1], [a, up + 1, up]]
        });
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn the_share_that_meets_is_that_of_the_area_however_a_mesh_is_graded() {
        let sheet = graded_sheet(200);
        // Lengthwise: the two halves of it are meshed alike, and across: one is fine and one is coarse.
        for (shift, met) in [
            (Vector3::y() * 50.0, 0.75),
            (Vector3::x() * 15.0, 0.8125),
            (Vector3::x() * 60.0, 0.25),
        ] {
            let pose = Similarity::from_translation(shift);
            for max_nodes in [100_000, 400] {
                let mut search = ContactSearch::new([&sheet, &sheet], 1.0, 0.5, max_nodes);
                let share = search.at(&pose).unwrap().share;
                let overhang = search.overhang(&pose);
                assert!((share - met).abs() < 0.03, "{shift:?} {max_nodes}: {share}");
                assert!(
                    (overhang - (1.0 - met)).abs() < 0.03,
                    "{shift:?} {max_nodes}: {overhang}"
                );
            }
        }
    }
}
