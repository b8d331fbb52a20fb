//! One target element: its points, their partners, and the values they give.

use super::blend::Blend;
use super::gather::{Centre, Group, gauge_of};
use super::options::{MapMethod, MapOptions, Status};
use super::points::PointRules;
use super::source::{PartnerFilter, PreparedSource};
use super::target::{ElementReport, Partner, TargetPart};
use super::uniqueness::AMBIGUOUS_RATIO;

/// Corners closer than this share of the element's size are the same.
const SAME_CORNER: f64 = 1e-6;

/// What all elements of a mapping share.
pub(super) struct Context<'a> {
    pub sources: &'a [PreparedSource],
    pub target: &'a TargetPart,
    pub options: &'a MapOptions,
    pub senses: &'a [Option<bool>],
    pub points: PointRules,
    pub min_cos: f64,
    pub strains_at_surfaces: bool,
    /// For each source the largest element size that counts for the search radius.
    pub source_sizes: &'a [f64],
}

/// Values of one element, put behind each other in the buffers of a chunk.
#[derive(Default)]
pub(super) struct Buffers {
    pub reports: Vec<ElementReport>,
    pub limits: Vec<Limits>,
    pub thickness: Vec<f64>,
    pub states: Vec<[f64; 7]>,
    pub n_states: Vec<u32>,
    pub strains: Vec<[f64; 6]>,
    pub n_strains: Vec<u32>,
}

/// What the confidence of an element is made of besides its report.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Limits {
    pub max_distance: f64,
    /// 1 without a second sheet near by, falling to 0.
    pub uniqueness: f64,
}

impl Context<'_> {
    /// Maps one element and appends what it found.
    pub fn map_element(&self, element: usize, hints: &mut [Option<u32>], out: &mut Buffers) {
        let mesh = &self.target.mesh;
        let centre_point = mesh.centroids()[element];
        let normal = mesh.normals()[element];
        let centre = self.partner_of_centre(element, hints);
        let reach = self.reach(element, centre.as_ref());
        let copied = centre.filter(|centre| self.is_same_element(element, centre));
        let found = match (copied, self.options.method, centre) {
            (Some(same), _, _) => self.one_group(element, &same),
            (None, MapMethod::Nearest, Some(near))
                if self.is_valid(element, &near.point, reach) =>
            {
                self.one_group(element, &near)
            }
            _ => self.gather(element, reach, centre.as_ref(), hints),
        };
        let owner = found.owner(self.sources);
        let groups: Vec<Group> = match owner {
            Some(owner) => {
                let is_owned = |group: &&Group| gauge_of(self.sources, group) == owner;
                found.groups.iter().filter(is_owned).copied().collect()
            }
            None => Vec::new(),
        };
        let coverage = if found.area > 0.0 {
            found.covered / found.area
        } else {
            0.0
        };
        let mut status = found.status(coverage);
        let partner = self.partner(centre.as_ref(), owner, &groups, copied.is_some());
        let uniqueness = match (&centre, status) {
            (Some(centre), Status::Mapped | Status::Partly) => {
                self.uniqueness(element, centre, reach)
            }
            _ => 1.0,
        };
        if status.has_values() && found.in_conflict {
            status = Status::Conflict;
        } else if status.has_values() && uniqueness < 2.0 * (1.0 - AMBIGUOUS_RATIO) {
            status = Status::TwoLayers;
        }
        if status.has_values() && !self.push_values(element, &groups, copied.is_some(), out) {
            status = Status::NoData;
        }
        if !status.has_values() {
            self.push_nothing(out);
        }
        let apart = centre.map(|centre| centre.point.point - centre_point);
        let normal_distance = apart.map_or(f64::NAN, |apart| apart.dot(&normal));
        out.limits.push(Limits {
            max_distance: reach,
            uniqueness,
        });
        out.reports.push(ElementReport {
            status,
            normal_distance,
            tangential_distance: apart
                .map_or(f64::NAN, |apart| (apart - normal * normal_distance).norm()),
            angle_deg: centre.map_or(f64::NAN, |centre| {
                let cos = self.side_normal(&centre.point, centre.source).dot(&normal);
                cos.clamp(-1.0, 1.0).acos().to_degrees()
            }),
            coverage,
            confidence: 0.0,
            partner: partner.filter(|_| status.has_values()),
        });
    }

    pub(super) fn filter(&self, element: usize, source: usize) -> PartnerFilter {
        PartnerFilter {
            normal: self.target.mesh.normals()[element],
            min_cos: self.min_cos,
            sense: self.senses[source],
        }
    }

    /// The nearest compatible point of all sources to the centre, within twice the largest distance.
    fn partner_of_centre(&self, element: usize, hints: &mut [Option<u32>]) -> Option<Centre> {
        let query = self.target.mesh.centroids()[element];
        let size = self.target.mesh.size(element);
        let mut best: Option<Centre> = None;
        for (source, prepared) in self.sources.iter().enumerate() {
            let own = size.max(self.source_sizes[source]);
            let reach = 2.0 * self.options.max_distance.unwrap_or(own);
            let filter = self.filter(element, source);
            let found = prepared.closest(&query, &filter, reach, hints[source]);
            let Some((triangle, point)) = found else {
                continue;
            };
            hints[source] = Some(triangle);
            if best.is_none_or(|best| point.distance_sq < best.point.distance_sq) {
                let source = source as u32;
                best = Some(Centre { source, point });
            }
        }
        best
    }

    /// The largest distance of a partner.
    fn reach(&self, element: usize, centre: Option<&Centre>) -> f64 {
        self.options.max_distance.unwrap_or_else(|| {
            let size = self.target.mesh.size(element);
            let of_source = centre.map_or(0.0, |centre| {
                let source = &self.sources[centre.source as usize];
                source.mesh.size(centre.point.element as usize)
            });
            size.max(of_source)
        })
    }

    /// True if target and source element have the same corners.
    fn is_same_element(&self, element: usize, centre: &Centre) -> bool {
        let ours = &self.target.mesh;
        let theirs = &self.sources[centre.source as usize].mesh;
        let other = centre.point.element as usize;
        let n = if ours.is_triangle(element) { 3 } else { 4 };
        if ours.is_triangle(element) != theirs.is_triangle(other) {
            return false;
        }
        let limit = SAME_CORNER * ours.size(element);
        let corners = theirs.corner_points(other);
        ours.corner_points(element)[..n]
            .iter()
            .all(|corner| corners[..n].iter().any(|c| (c - corner).norm() <= limit))
    }

    fn partner(
        &self,
        centre: Option<&Centre>,
        owner: Option<(u32, u32)>,
        groups: &[Group],
        is_copy: bool,
    ) -> Option<Partner> {
        let owner = owner?;
        let of_centre = centre.filter(|centre| {
            let source = &self.sources[centre.source as usize];
            let gauge = source.gauge[centre.point.element as usize];
            (centre.source, gauge) == owner
                && groups
                    .iter()
                    .any(|group| group.element == centre.point.element)
        });
        if let Some(centre) = of_centre {
            return Some(Partner {
                source: centre.source,
                element: centre.point.element,
                is_flipped: centre.point.is_flipped,
                is_copy,
            });
        }
        let largest = groups.iter().max_by(|a, b| a.area.total_cmp(&b.area))?;
        Some(Partner {
            source: largest.source,
            element: largest.element,
            is_flipped: largest.is_flipped,
            is_copy,
        })
    }

    fn push_nothing(&self, out: &mut Buffers) {
        out.thickness.push(f64::NAN);
        out.n_states.push(0);
        out.n_strains.push(0);
    }

    /// Appends the element's values; false, and nothing appended, if its partners have none.
    fn push_values(
        &self,
        element: usize,
        groups: &[Group],
        is_copy: bool,
        out: &mut Buffers,
    ) -> bool {
        let thickness = self.thickness(groups);
        let layers = self.target.rules[self.target.rule_of[element] as usize].len();
        let blend = Blend {
            context: self,
            element,
            groups,
            is_copy,
        };
        let mut states = blend.states(layers);
        if !self.options.quantities.stress {
            states.iter_mut().for_each(|value| value[..6].fill(0.0));
        }
        if !self.options.quantities.plastic_strain {
            states.iter_mut().for_each(|value| value[6] = 0.0);
        }
        let strain_layers = if self.strains_at_surfaces { 2 } else { layers };
        let strains = blend.strains(strain_layers);
        if thickness.is_nan() && states.is_empty() && strains.is_empty() {
            return false;
        }
        out.thickness.push(thickness);
        out.n_states.push(states.len() as u32);
        out.states.extend_from_slice(&states);
        out.n_strains.push(strains.len() as u32);
        out.strains.extend_from_slice(&strains);
        true
    }
}
