//! The stamped part made ready: moved once, resampled to the target's layers, with its fields.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::field::{Field, Fields};
use super::history::SourceHistory;
use super::layered::{AtLayers, Layered, PLASTIC_STRAIN, PerElement};
use super::layers::LayerBalance;
use super::links::{Links, Neighbours};
use super::options::MapOptions;
use super::patch::{Patch, is_weld_line};
use super::rule::LayerRule;
use super::shared::ON_EDGE;
use super::shells::ShellMesh;
use super::target::Facing;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::search::{Bvh, ClosestPoint, Feature, Nearby, NormalFilter, SurfaceHit};

/// Gauges smaller than this share of the sheet belong to their surroundings.
const SMALLEST_GAUGE: f64 = 0.01;
/// Elements of one gauge that are found between two questions to the monitor.
const CHECKED_AFTER: usize = 1 << 14;
/// Matrices between rules of the source and rules of the target are made beforehand if there are no more than these;
/// where every element has rules of its own they would take memory by the square of them.
const MOST_MATRICES: usize = 4096;

/// A stamped part with its forming results, in its own frame.
#[derive(Debug, Clone)]
pub struct SourcePart {
    /// Elements the values belong to.
    pub mesh: ShellMesh,
    /// Thickness at the corners in the target's length unit; NaN or 0 where it is not known. The fourth of a
    /// triangle is the mean of its three. Empty if there is none at all.
    pub thickness: Vec<[f64; 4]>,
    /// Stress xx, yy, zz, xy, yz, zx and effective plastic strain at each layer.
    pub states: Layered<7>,
    /// Strain xx, yy, zz, xy, yz, zx (tensor shear) at each layer or at both surfaces.
    pub strains: Layered<6>,
    /// History variables.
    pub history: SourceHistory,
    /// Material law of the parts (as [`ShellMesh::parts`] numbers them) whose law is known.
    pub laws: BTreeMap<u32, String>,
}

impl SourcePart {
    /// Mean of the corner thicknesses of an element; NaN if one is not known.
    pub fn mean_thickness(&self, element: usize) -> f64 {
        self.thickness.get(element).map_or(f64::NAN, mean_thickness)
    }

    /// Effective plastic strain of an element, weighted over its layers; NaN if it has none.
    pub fn mean_plastic_strain(&self, element: usize) -> f64 {
        self.states.mean(element, PLASTIC_STRAIN)
    }
}

/// Mean of the corners of an element that has a thickness at all of them, else NaN.
pub(super) fn mean_thickness(corners: &[f64; 4]) -> f64 {
    if corners.iter().all(|t| t.is_finite() && *t > 0.0) {
        corners.iter().sum::<f64>() / 4.0
    } else {
        f64::NAN
    }
}

/// The point of a source that a point of the target takes its values from.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourcePoint {
    pub element: u32,
    pub point: Point3,
    pub distance_sq: f64,
    /// The closest point lies on the border of the sheet.
    pub is_on_border: bool,
    /// The normals point to opposite sides.
    pub is_flipped: bool,
    /// Thickness interpolated between corners that differ, else NaN.
    pub uneven_thickness: f64,
}

/// A source in the frame of the target, ready to be asked.
pub(super) struct PreparedSource<'a> {
    part: &'a SourcePart,
    /// Fields stay in the source's frame until they reach an element of the target.
    pub pose: Similarity,
    /// The pose mirrors.
    pub is_mirrored: bool,
    pub mesh: ShellMesh,
    bvh: Bvh,
    triangle_element: Vec<u32>,
    links: Arc<Links>,
    /// Which sheet of one gauge each element belongs to.
    pub gauge: Vec<u32>,
    is_uneven: Vec<bool>,
    /// Mean thickness of each element, NaN where it is not known; empty if there is none.
    thickness: Vec<f64>,
    wants_thickness: bool,
    /// Smallest and largest thickness that occurs.
    pub thickness_range: (f64, f64),
    /// One for each layer rule of the target.
    states: Vec<AtLayers<'a, 7>>,
    strains: Vec<AtLayers<'a, 6>>,
}

impl<'a> PreparedSource<'a> {
    /// Moves the sheet and makes it ready for questions. `rules` are those of the target,
    /// `strain_rules` where it wants its strains. O(elements).
    pub fn new(
        part: &'a SourcePart,
        target_from_source: &Similarity,
        rules: &[LayerRule],
        strain_rules: &[LayerRule],
        options: &MapOptions,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mesh = part.mesh.moved(target_from_source);
        monitor.check()?;
        let thickness: Vec<f64> = part.thickness.iter().map(mean_thickness).collect();
        let (of_tree, of_links) = rayon::join(
            || {
                let (triangles, triangle_element) = mesh.triangles(monitor)?;
                let bvh = Bvh::build_for(triangles.into(), monitor)?;
                Ok((bvh, triangle_element))
            },
            || {
                let links = mesh.links(monitor)?;
                let gauge = gauges(&mesh, &links.neighbours, &thickness, monitor)?;
                Ok((links, gauge))
            },
        );
        let ((bvh, triangle_element), (links, gauge)) = (of_tree?, of_links?);
        monitor.check()?;
        let states = if options.quantities.needs_states() && part.states.n_present() > 0 {
            // Plastic strains are always linear.
            let mut balances = [options.stress_balance(); 7];
            balances[PLASTIC_STRAIN] = LayerBalance::Linear;
            at_layers(&part.states, rules, balances)
        } else {
            Vec::new()
        };
        monitor.check()?;
        let strains = if options.quantities.strain && part.strains.n_present() > 0 {
            at_layers(&part.strains, strain_rules, [LayerBalance::Linear; 6])
        } else {
            Vec::new()
        };
        let at_corners = part.thickness.as_flattened().iter();
        let known = at_corners.filter(|t| t.is_finite());
        let thickness_range = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
            (low.min(*t), high.max(*t))
        });
        Ok(Self {
            part,
            pose: *target_from_source,
            is_mirrored: target_from_source.rotation.determinant() < 0.0,
            wants_thickness: options.quantities.thickness && thickness_range.0.is_finite(),
            is_uneven: part.thickness.iter().map(is_uneven).collect(),
            thickness,
            bvh,
            triangle_element,
            links,
            gauge,
            thickness_range,
            states,
            strains,
            mesh,
        })
    }

    /// Room for the fields.
    pub fn fields(&self) -> Fields {
        Fields {
            patch: Patch::default(),
            thickness: self.wants_thickness.then(Field::default),
            states: self.states.first().map(|_| Field::default()),
            strains: self.strains.first().map(|_| Field::default()),
        }
    }

    /// Fits the fields anew around `elements`, at layer rules of the target: that of the states and that of the
    /// strains, each with what it is from the other side of the sheet. O(elements · layers).
    pub fn load(
        &self,
        fields: &mut Fields,
        elements: impl Iterator<Item = u32>,
        [rules, strain_rules]: [[usize; 2]; 2],
    ) {
        let patch = &mut fields.patch;
        patch.load(
            elements,
            &self.part.mesh,
            &self.links.neighbours,
            &self.thickness,
        );
        if let Some(field) = &mut fields.thickness {
            let thickness = PerElement(&self.thickness);
            field.load([&thickness; 2], patch);
        }
        if let Some(field) = &mut fields.states {
            field.load(rules.map(|rule| &self.states[rule]), patch);
            // Extrapolated plastic strains may be negative.
            field.change(|value| value[PLASTIC_STRAIN] = value[PLASTIC_STRAIN].max(0.0));
        }
        if let Some(field) = &mut fields.strains {
            field.load(strain_rules.map(|rule| &self.strains[rule]), patch);
        }
        fields.fit();
    }

    /// The layer values of an element as they are, in the source's frame; `None` if it has none. Those of one of
    /// its points in the plane, where it has four and one is asked for.
    pub fn states_of(
        &self,
        rule: usize,
        element: usize,
        plane: Option<usize>,
    ) -> Option<Vec<[f64; 7]>> {
        self.states.get(rule)?.of(element, plane)
    }

    /// The same for strains, whose points in the plane are not told apart.
    pub fn strains_of(&self, rule: usize, element: usize) -> Option<Vec<[f64; 6]>> {
        self.strains.get(rule)?.of(element, None)
    }

    /// A displacement in the target's frame as it is in the source's.
    pub fn in_source(&self, displacement: &Vector3) -> Vector3 {
        self.pose.rotation.tr_mul(displacement) / self.pose.scale
    }

    /// The elements around each element.
    pub fn neighbours(&self) -> &Neighbours {
        &self.links.neighbours
    }

    /// The closest point within `max_distance` whose element's normal is within the angle of
    /// `normal`; of both signs the nearer one if both count.
    pub fn closest(
        &self,
        query: &Point3,
        filter: &PartnerFilter,
        max_distance: f64,
        hint: Option<u32>,
    ) -> Option<(u32, SourcePoint)> {
        self.nearer(filter, max_distance, |is_flipped, reach| {
            let cone = filter.cone(is_flipped);
            self.bvh.closest(query, reach, hint, Some(&cone))
        })
    }

    /// Collects what can be closest to points within `radius` of `center`, whose own closest point is
    /// at `distance`. False if it is too much to be worth it.
    pub fn collect(
        &self,
        (center, distance): (&Point3, f64),
        radius: f64,
        filter: &PartnerFilter,
        around: &mut Around,
    ) -> bool {
        around.distance = distance;
        around.center = *center;
        around.rounding = 1e-9 * radius;
        let reach = (distance + 2.0 * radius) * (1.0 + 1e-6);
        distance <= radius
            && [false, true].into_iter().all(|is_flipped| {
                let nearby = &mut around.nearby[usize::from(is_flipped)];
                !filter.facing.takes(is_flipped)
                    || self
                        .bvh
                        .collect(center, reach, &filter.cone(is_flipped), nearby)
            })
    }

    /// The same answer as [`Self::closest`] from what was collected.
    pub fn closest_of(
        &self,
        around: &Around,
        query: &Point3,
        filter: &PartnerFilter,
        max_distance: f64,
    ) -> Option<(u32, SourcePoint)> {
        // The closest point of the centre is a candidate for every point.
        let known = around.distance + (query - around.center).norm() + around.rounding;
        self.nearer(filter, max_distance.min(known), |is_flipped, reach| {
            let nearby = &around.nearby[usize::from(is_flipped)];
            self.bvh.closest_of(nearby, query, reach)
        })
    }

    /// The nearer of the facings that count; of equal ones the one that is not flipped.
    fn nearer(
        &self,
        filter: &PartnerFilter,
        max_distance: f64,
        ask: impl Fn(bool, f64) -> Option<SurfaceHit>,
    ) -> Option<(u32, SourcePoint)> {
        let first = !filter.facing.takes(false);
        let hit = ask(first, max_distance);
        if first || !filter.facing.takes(true) {
            return hit.map(|hit| (hit.triangle, self.source_point(&hit, first, filter)));
        }
        let reach = hit.map_or(max_distance, |hit| hit.distance_sq.sqrt());
        let flipped = ask(true, reach);
        let is_nearer =
            |other: &SurfaceHit| hit.is_none_or(|hit| other.distance_sq < hit.distance_sq);
        match (flipped.filter(is_nearer), hit) {
            (Some(hit), _) => Some((hit.triangle, self.source_point(&hit, true, filter))),
            (None, Some(hit)) => Some((hit.triangle, self.source_point(&hit, false, filter))),
            (None, None) => None,
        }
    }

    /// Corner thicknesses of an element, as the part gives them.
    pub fn corner_thickness(&self, element: usize) -> Option<&[f64; 4]> {
        self.part.thickness.get(element)
    }

    /// Mean thickness of an element; NaN if it is not known.
    pub fn mean_thickness(&self, element: usize) -> f64 {
        self.thickness.get(element).copied().unwrap_or(f64::NAN)
    }

    /// How many of the quantities that are mapped an element has: thickness, states, strains.
    pub fn n_known(&self, element: usize) -> usize {
        let has_thickness = self.wants_thickness && self.mean_thickness(element).is_finite();
        let has_states = !self.states.is_empty() && self.part.states.of(element).is_some();
        let has_strains = !self.strains.is_empty() && self.part.strains.of(element).is_some();
        [has_thickness, has_states, has_strains]
            .into_iter()
            .filter(|has| *has)
            .count()
    }

    /// Distance to the sheet whatever its normal, if within `max_distance`.
    pub fn distance(&self, query: &Point3, max_distance: f64) -> Option<f64> {
        let hit = self.bvh.closest(query, max_distance, None, None)?;
        Some(hit.distance_sq.sqrt())
    }

    /// Along a unit `direction` from a place and the other way, the nearest element beyond a distance and within
    /// `reach`, with its distance: a second sheet.
    pub fn next_sheets(
        &self,
        from: &Point3,
        direction: &Vector3,
        beyond: [f64; 2],
        reach: f64,
    ) -> [Option<(u32, f64)>; 2] {
        let hits = self
            .bvh
            .first_hits_both_ways(from, direction, beyond, reach);
        hits.map(|hit| hit.map(|hit| (self.triangle_element[hit.triangle as usize], hit.distance)))
    }

    fn source_point(
        &self,
        hit: &SurfaceHit,
        is_flipped: bool,
        filter: &PartnerFilter,
    ) -> SourcePoint {
        let triangle = hit.triangle as usize;
        let own = self.triangle_element[triangle];
        let nodes = &self.bvh.mesh().triangles()[triangle];
        let is_on_border = match hit.feature {
            Feature::Face => false,
            Feature::Edge(edge) => {
                let ends = [nodes[edge as usize], nodes[(edge as usize + 1) % 3]];
                let corners = &self.mesh.corners()[own as usize];
                self.links.is_border_edge(own as usize, corners, ends)
            }
            Feature::Vertex(corner) => self.links.is_border_node(nodes[corner as usize]),
        };
        let corners = || -> [(Point3, f64); 3] {
            std::array::from_fn(|i| {
                let position = self.mesh.positions()[nodes[i] as usize];
                (position, hit.barycentric[i])
            })
        };
        let (element, is_flipped) = if hit.barycentric.iter().all(|weight| *weight > ON_EDGE) {
            (own, is_flipped)
        } else {
            self.lowest_sharing((own, is_flipped), &corners(), filter)
        };
        let is_uneven = self.is_uneven.get(element as usize);
        SourcePoint {
            element,
            point: hit.point,
            distance_sq: hit.distance_sq,
            is_on_border,
            is_flipped,
            uneven_thickness: match is_uneven {
                Some(true) => self.thickness_between(element, &corners()),
                _ => f64::NAN,
            },
        }
    }
}

/// Which normals count as partners.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartnerFilter {
    /// Normal of the target element.
    pub normal: Vector3,
    pub min_cos: f64,
    pub facing: Facing,
}

impl PartnerFilter {
    fn cone(&self, is_flipped: bool) -> NormalFilter {
        NormalFilter {
            direction: if is_flipped {
                -self.normal
            } else {
                self.normal
            },
            min_cos: self.min_cos,
        }
    }
}

/// The triangles of a source around the centre of a target element, for its points.
#[derive(Default)]
pub(super) struct Around {
    /// Normals on the same side, on the opposite side.
    nearby: [Nearby; 2],
    center: Point3,
    /// Distance of the centre.
    distance: f64,
    /// Generously, for sums of distances.
    rounding: f64,
}

fn is_uneven(corners: &[f64; 4]) -> bool {
    let mean = mean_thickness(corners);
    mean.is_finite() && corners.iter().any(|t| (t - mean).abs() > 1e-9 * mean)
}

/// Values at each of the rules of a target.
fn at_layers<'a, const N: usize>(
    values: &'a Layered<N>,
    rules: &[LayerRule],
    balances: [LayerBalance; N],
) -> Vec<AtLayers<'a, N>> {
    let keeps_matrices = values.rules().len() * rules.len() <= MOST_MATRICES;
    let at = |rule| values.at_layers(rule, balances, keeps_matrices);
    rules.iter().map(at).collect()
}

/// Numbers the sheets of one gauge: elements that are linked by smooth neighbours. A small island as a whole
/// joins the large sheet with which most of its elements' edges are shared, because a spot of strong thinning
/// is no weld line.
fn gauges(
    mesh: &ShellMesh,
    neighbours: &Neighbours,
    thickness: &[f64],
    monitor: &Monitor,
) -> Result<Vec<u32>, Cancelled> {
    let mut gauge = vec![u32::MAX; mesh.len()];
    let mut areas = Vec::new();
    let mut waiting = Vec::new();
    for first in 0..mesh.len() {
        if gauge[first] != u32::MAX {
            continue;
        }
        let number = areas.len() as u32;
        areas.push(0.0);
        gauge[first] = number;
        waiting.push(first);
        let mut n_found = 0_usize;
        while let Some(element) = waiting.pop() {
            if n_found.is_multiple_of(CHECKED_AFTER) {
                monitor.check()?;
            }
            n_found += 1;
            areas[number as usize] += mesh.areas()[element];
            for &other in neighbours.of(element) {
                let other = other as usize;
                if gauge[other] == u32::MAX
                    && !is_weld_line((mesh, neighbours, thickness), element, other)
                {
                    gauge[other] = number;
                    waiting.push(other);
                }
            }
        }
    }
    let least = SMALLEST_GAUGE * areas.iter().sum::<f64>();
    let is_large = |number: u32| areas[number as usize] >= least;
    let mut shared: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for element in (0..mesh.len()).filter(|&element| !is_large(gauge[element])) {
        let beside = neighbours.of(element).iter().map(|&n| gauge[n as usize]);
        for large in beside.filter(|&number| is_large(number)) {
            *shared.entry((gauge[element], large)).or_default() += 1;
        }
    }
    let mut joined: BTreeMap<u32, (u32, usize)> = BTreeMap::new();
    for ((island, large), n_edges) in shared {
        let most = joined.entry(island).or_insert((large, n_edges));
        if n_edges > most.1 {
            *most = (large, n_edges);
        }
    }
    for number in &mut gauge {
        *number = joined.get(number).map_or(*number, |(large, _)| *large);
    }
    Ok(gauge)
}
