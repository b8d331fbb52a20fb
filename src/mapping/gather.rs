//! The points of a target element and the source elements that they take their values from.

use std::cmp::Ordering;

use super::blend::LEAST_COVERAGE;
use super::element::Context;
use super::nodal::around_nodes;
use super::options::{MapMethod, Overlap, Status};
use super::points::{ElementPoint, MAX_ORDER};
use super::source::{Around, PreparedSource, SourcePoint};
use crate::geometry::{Point3, Vector3};

/// A point beyond the border of the source by more than this share of the element's size is
/// outside the sheet.
const BORDER_REACH: f64 = 0.25;

/// Sheets that are given twice differ in their distance by less than this share of their thickness, …
const SAME_PLACE: f64 = 0.5;
/// … or where that is not known of the size of their elements.
const SAME_PLACE_OF_SIZE: f64 = 0.1;

/// Elements with more points than this cover so many source elements that each point had better walk
/// through the tree by itself.
const MOST_COLLECTED: usize = 9;

/// Points of one target element that take their values from one source element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    pub source: u32,
    pub element: u32,
    pub is_flipped: bool,
    /// `None` where the group counts for the whole element.
    pub quadrant: Option<u8>,
    pub area: f64,
    /// Area-weighted sum of the partners' places relative to the source element's centroid.
    pub offset: Vector3,
    pub uneven_thickness: f64,
}

impl Group {
    /// Adds it to the group of the same element and quadrant, or to the list.
    fn join(self, groups: &mut Vec<Self>) {
        let is_same = |group: &&mut Self| {
            group.source == self.source
                && group.element == self.element
                && group.is_flipped == self.is_flipped
                && group.quadrant == self.quadrant
        };
        if let Some(group) = groups.iter_mut().find(is_same) {
            group.area += self.area;
            group.offset += self.offset;
            group.uneven_thickness += self.uneven_thickness;
        } else {
            groups.push(self);
        }
    }
}

/// What the points of an element found together.
#[derive(Default)]
pub(super) struct Found {
    pub groups: Vec<Group>,
    pub covered: f64,
    pub area: f64,
    /// Area of the points without partner, by reason.
    pub far: f64,
    pub angle: f64,
    pub outside: f64,
    /// A second source has a partner too.
    pub in_conflict: bool,
}

/// What earlier questions leave to later ones.
#[derive(Default)]
pub(super) struct Search {
    pub trails: Vec<Trail>,
    points: Vec<ElementPoint>,
}

/// The same for one source.
#[derive(Default)]
pub(super) struct Trail {
    /// The last triangle found.
    pub hint: Option<u32>,
    /// The partner of the element's centre, if it has one.
    pub centre: Option<SourcePoint>,
    around: Around,
    is_collected: bool,
}

/// The partner of the element's centre with its source.
#[derive(Debug, Clone, Copy)]
pub(super) struct Centre {
    pub source: u32,
    pub point: SourcePoint,
}

impl Context<'_> {
    /// All of the element from one source element.
    pub(super) fn one_group(&self, element: usize, centre: &Centre) -> Found {
        let source = &self.sources[centre.source as usize];
        let group = Group {
            source: centre.source,
            element: centre.point.element,
            is_flipped: centre.point.is_flipped,
            quadrant: None,
            area: 1.0,
            offset: Vector3::zeros(),
            uneven_thickness: f64::NAN,
        };
        debug_assert!((group.element as usize) < source.mesh.len());
        let area = self.target.mesh.areas()[element];
        Found {
            groups: vec![group],
            covered: area,
            area,
            ..Found::default()
        }
    }

    /// Asks every point of the element for its partner.
    pub(super) fn gather(
        &self,
        element: usize,
        reach: f64,
        centre: Option<&Centre>,
        search: &mut Search,
    ) -> Found {
        let mesh = &self.target.mesh;
        let corners = mesh.corner_points(element);
        let order = self.order(element, centre);
        let Search { trails, points } = search;
        points.clear();
        if mesh.is_triangle(element) {
            points.extend(self.points.triangle(&corners, order));
        } else {
            points.extend(self.points.quad(&corners, order));
        }
        let mut found = Found {
            groups: Vec::with_capacity(points.len()),
            ..Found::default()
        };
        let centre = mesh.centroids()[element];
        let radius_sq = points.iter().fold(0.0, |radius_sq: f64, point| {
            radius_sq.max((point.position - centre).norm_squared())
        });
        for (source, trail) in trails.iter_mut().enumerate() {
            let filter = self.filter(element, source);
            trail.is_collected = trail.centre.is_some_and(|partner| {
                let of_centre = (&centre, partner.distance_sq.sqrt());
                points.len() <= MOST_COLLECTED
                    && self.sources[source].collect(
                        of_centre,
                        radius_sq.sqrt(),
                        &filter,
                        &mut trail.around,
                    )
            });
        }
        for point in points.iter() {
            self.ask(element, reach, point, trails, &mut found);
        }
        found
    }

    /// Points along an edge: more where the target element covers many source elements.
    fn order(&self, element: usize, centre: Option<&Centre>) -> usize {
        let ratio = centre.map_or(1.0, |centre| {
            let source = &self.sources[centre.source as usize].mesh;
            self.target.mesh.size(element) / source.size(centre.point.element as usize)
        });
        let order = match ratio {
            r if r < 0.5 => 2,
            r if r <= 3.0 => 3,
            r if r <= 6.0 => 4,
            r => (r.ceil() as usize).min(MAX_ORDER),
        };
        if self.target.planes(element) == 4 {
            order.next_multiple_of(2)
        } else {
            order
        }
    }

    fn ask(
        &self,
        element: usize,
        reach: f64,
        point: &ElementPoint,
        trails: &mut [Trail],
        found: &mut Found,
    ) {
        found.area += point.area;
        let mut best: Option<Centre> = None;
        let mut n_inside = 0;
        let mut is_beyond_border = false;
        let mut is_far = false;
        for (source, prepared) in self.sources.iter().enumerate() {
            let filter = self.filter(element, source);
            let trail = &mut trails[source];
            let nearest = if trail.is_collected {
                prepared.closest_of(&trail.around, &point.position, &filter, 2.0 * reach)
            } else {
                prepared.closest(&point.position, &filter, 2.0 * reach, trail.hint)
            };
            let Some((triangle, partner)) = nearest else {
                continue;
            };
            trail.hint = Some(triangle);
            if self.is_outside(element, &point.position, &partner) {
                is_beyond_border = true;
            } else if partner.distance_sq > reach * reach {
                is_far = true;
            } else {
                let source = source as u32;
                let candidate = Centre {
                    source,
                    point: partner,
                };
                n_inside += usize::from(self.competes(&candidate));
                if best.is_none_or(|best| self.is_preferred(&candidate, &best)) {
                    best = Some(candidate);
                }
            }
        }
        found.in_conflict |= n_inside > 1;
        if let Some(partner) = best {
            found.covered += point.area;
            // A quadrant matters only where it is a point of its own.
            let quadrant = (self.target.planes(element) == 4).then_some(point.quadrant);
            self.add_to_group(&partner, (point, quadrant), &mut found.groups);
        } else if is_beyond_border {
            found.outside += point.area;
        } else if self.any_sheet_within(&point.position, reach) {
            found.angle += point.area;
        } else if is_far || self.is_over_sheet(element, &point.position) {
            found.far += point.area;
        } else {
            found.outside += point.area;
        }
    }

    fn any_sheet_within(&self, query: &Point3, reach: f64) -> bool {
        let mut sources = self.sources.iter();
        sources.any(|source| source.distance(query, reach).is_some())
    }

    /// True if a compatible sheet lies over the point as near as sheets are looked for where no largest distance is
    /// given: what lies beyond a small one is still not outside of the sheet.
    fn is_over_sheet(&self, element: usize, query: &Point3) -> bool {
        if self.options.max_distance.is_none() {
            return false;
        }
        let size = self.target.mesh.size(element);
        let mut sources = self.sources.iter().enumerate();
        sources.any(|(source, prepared)| {
            let reach = 2.0 * size.max(self.source_sizes[source]);
            let filter = self.filter(element, source);
            let nearest = prepared.closest(query, &filter, reach, None);
            nearest.is_some_and(|(_, partner)| !self.is_outside(element, query, &partner))
        })
    }

    pub(super) fn is_valid(&self, element: usize, partner: &SourcePoint, reach: f64) -> bool {
        let centre = self.target.mesh.centroids()[element];
        partner.distance_sq <= reach * reach && !self.is_outside(element, &centre, partner)
    }

    /// True if the partner is the border of a sheet that ends before the point.
    fn is_outside(&self, element: usize, query: &Point3, partner: &SourcePoint) -> bool {
        if !partner.is_on_border {
            return false;
        }
        let normal = self.target.mesh.normals()[element];
        let apart = partner.point - query;
        let across = apart - normal * apart.dot(&normal);
        across.norm() > BORDER_REACH * self.target.mesh.size(element)
    }

    /// True if of two valid partners in different sources the first is taken: where both lie in one place the one that
    /// has more of the quantities that are mapped, else the one that the options say.
    pub(super) fn is_preferred(&self, candidate: &Centre, best: &Centre) -> bool {
        let n_known = |of: &Centre| {
            let source = &self.sources[of.source as usize];
            source.n_known(of.point.element as usize)
        };
        let by_results = n_known(candidate).cmp(&n_known(best));
        if by_results != Ordering::Equal && self.are_in_one_place(candidate, best) {
            return by_results == Ordering::Greater;
        }
        match self.options.overlap {
            Overlap::First => false,
            Overlap::Nearest => candidate.point.distance_sq < best.point.distance_sq,
            Overlap::Thicker => {
                // An unknown one is less than any other.
                let thickness = |of: &Centre| {
                    let source = &self.sources[of.source as usize];
                    source.mean_thickness(of.point.element as usize).max(0.0)
                };
                thickness(candidate) > thickness(best)
            }
        }
    }

    /// True if values could be taken from there as well. Beside a weld line the border of the neighbour lies within
    /// reach too.
    pub(super) fn competes(&self, partner: &Centre) -> bool {
        let source = &self.sources[partner.source as usize];
        !partner.point.is_on_border && source.n_known(partner.point.element as usize) > 0
    }

    /// True if two partners are one sheet that was given twice, and not two sheets on each other.
    fn are_in_one_place(&self, a: &Centre, b: &Centre) -> bool {
        let [of_a, of_b] = [a, b].map(|of| {
            let source = &self.sources[of.source as usize];
            let element = of.point.element as usize;
            (source.mean_thickness(element), source.mesh.size(element))
        });
        // NaN is no maximum.
        let thickness = of_a.0.max(of_b.0);
        let apart = if thickness.is_finite() {
            SAME_PLACE * thickness
        } else {
            SAME_PLACE_OF_SIZE * of_a.1.min(of_b.1)
        };
        (a.point.distance_sq.sqrt() - b.point.distance_sq.sqrt()).abs() <= apart
    }

    fn add_to_group(
        &self,
        partner: &Centre,
        (point, quadrant): (&ElementPoint, Option<u8>),
        groups: &mut Vec<Group>,
    ) {
        let source = &self.sources[partner.source as usize];
        let at = &partner.point;
        if self.options.method == MapMethod::Shape {
            around_nodes(source, at, |element, is_flipped, weight| {
                let area = weight * point.area;
                let of_element = Group {
                    source: partner.source,
                    element,
                    is_flipped,
                    quadrant,
                    area,
                    offset: Vector3::zeros(),
                    uneven_thickness: at.uneven_thickness * area,
                };
                of_element.join(groups);
            });
            return;
        }
        let of_point = Group {
            source: partner.source,
            element: at.element,
            is_flipped: at.is_flipped,
            quadrant,
            area: point.area,
            offset: (at.point - source.mesh.centroids()[at.element as usize]) * point.area,
            uneven_thickness: at.uneven_thickness * point.area,
        };
        of_point.join(groups);
    }

    /// Where the sheet lies over the element, and its unit normal on the side of the target's: at the partner of the
    /// centre, or at the mean place of the largest group where the centre has none.
    pub(super) fn place_of_sheet(
        &self,
        centre: Option<&Centre>,
        groups: &[Group],
    ) -> Option<(Point3, Vector3)> {
        let mesh = |source: u32| &self.sources[source as usize].mesh;
        let (place, normal, is_flipped) = if let Some(Centre { source, point }) = centre {
            let normal = mesh(*source).normals()[point.element as usize];
            (point.point, normal, point.is_flipped)
        } else {
            let group = largest(groups)?;
            let (mesh, own) = (mesh(group.source), group.element as usize);
            let place = mesh.centroids()[own] + group.offset / group.area;
            (place, mesh.normals()[own], group.is_flipped)
        };
        Some((place, if is_flipped { -normal } else { normal }))
    }
}

impl Found {
    /// The sheet of one gauge that owns most of the covered area; of equal ones the first.
    pub(super) fn owner(&self, sources: &[PreparedSource<'_>]) -> Option<(u32, u32)> {
        let first = gauge_of(sources, self.groups.first()?);
        let mut others = self.groups.iter();
        if others.all(|group| gauge_of(sources, group) == first) {
            return Some(first);
        }
        let mut areas: Vec<((u32, u32), f64)> = Vec::new();
        for group in &self.groups {
            let gauge = gauge_of(sources, group);
            match areas.iter_mut().find(|(other, _)| *other == gauge) {
                Some((_, area)) => *area += group.area,
                None => areas.push((gauge, group.area)),
            }
        }
        areas.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        areas.first().map(|(gauge, _)| *gauge)
    }

    pub(super) fn status(&self, coverage: f64) -> Status {
        if self.area <= 0.0 {
            return Status::Outside;
        }
        if coverage >= 1.0 - 1e-9 {
            return Status::Mapped;
        }
        if coverage >= LEAST_COVERAGE {
            return Status::Partly;
        }
        let reasons = [
            (self.far, Status::Far),
            (self.angle, Status::Angle),
            (self.outside, Status::Outside),
        ];
        let worst = reasons.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        worst.map_or(Status::Outside, |(_, status)| status)
    }
}

/// The group that counts for most of the area; of equal ones the last.
pub(super) fn largest(groups: &[Group]) -> Option<&Group> {
    groups.iter().max_by(|a, b| a.area.total_cmp(&b.area))
}

pub(super) fn gauge_of(sources: &[PreparedSource<'_>], group: &Group) -> (u32, u32) {
    let source = &sources[group.source as usize];
    (group.source, source.gauge[group.element as usize])
}
