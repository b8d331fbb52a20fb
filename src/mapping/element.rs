//! One target element: its points, their partners, and the values they give.

use super::blend::Blend;
use super::field::Fields;
use super::gather::{Centre, Group, Search, Trail, gauge_of, largest};
use super::layered::PLASTIC_STRAIN;
use super::options::{MapMethod, MapOptions, Status};
use super::points::PointRules;
use super::source::{PartnerFilter, PreparedSource};
use super::target::{ElementReport, Facing, MappedLayers, Partner, TargetPart};
use super::uniqueness::AMBIGUOUS_RATIO;

/// Corners closer than this share of the element's size are the same.
const SAME_CORNER: f64 = 1e-6;

/// What all elements of a mapping share.
pub(super) struct Context<'a> {
    pub sources: &'a [PreparedSource<'a>],
    pub target: &'a TargetPart,
    pub options: &'a MapOptions,
    pub facings: &'a [Facing],
    /// For each element of the target whether its normal points to the other side than those around it; empty where
    /// none does or nothing depends on it.
    pub is_reversed: &'a [bool],
    /// For each rule the one that the other side of the sheet sees: those of the target come first.
    pub turned_over: &'a [usize],
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
    pub states: MappedLayers<7>,
    pub strains: MappedLayers<6>,
}

/// What is needed of an element besides its report once all are known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub max_distance: f64,
    /// 1 without a second sheet near by, falling to 0.
    pub uniqueness: f64,
    /// The status where its sources are in no conflict.
    pub without_conflict: Status,
}

/// Elements whose partners are known and whose values are not yet made.
#[derive(Default)]
struct Partners {
    groups: Vec<Group>,
    /// Of each element, where its groups end.
    ends: Vec<usize>,
    /// Of each element, whether it is the source's own.
    is_copy: Vec<bool>,
}

/// Room that the chunks of one thread share.
#[derive(Default)]
pub(super) struct Scratch {
    search: Search,
    partners: Partners,
    fields: ChunkFields,
}

/// The fields that the elements of a chunk take their values from.
#[derive(Default)]
struct ChunkFields {
    /// The rules that these elements have, rising.
    rules: Vec<usize>,
    /// For each source those at each rule.
    of_sources: Vec<Vec<Fields>>,
}

impl ChunkFields {
    fn of(&self, source: usize, rule: usize) -> &Fields {
        let found = self.rules.binary_search(&rule);
        &self.of_sources[source][found.expect("loaded for every element")]
    }
}

impl Context<'_> {
    /// Maps elements that lie near each other: first all partners, then the fields around these, then
    /// the values.
    pub fn map_elements(&self, elements: &[u32], scratch: &mut Scratch) -> Buffers {
        let mut out = self.buffers(elements);
        let Scratch {
            search,
            partners,
            fields,
        } = scratch;
        partners.groups.clear();
        partners.ends.clear();
        partners.is_copy.clear();
        search.trails.clear();
        search
            .trails
            .resize_with(self.sources.len(), Trail::default);
        for &element in elements {
            self.find_partners(element as usize, search, partners, &mut out);
        }
        self.load_fields(elements, partners, fields);
        let mut first = 0;
        for (at, &element) in elements.iter().enumerate() {
            let element = element as usize;
            let groups = &partners.groups[first..partners.ends[at]];
            first = partners.ends[at];
            if out.reports[at].status.has_values() {
                let fields_of = |group: &Group| -> &Fields {
                    let rule = self.rule(element, group.is_flipped);
                    fields.of(group.source as usize, rule)
                };
                let blend = Blend::new(self, element, groups, partners.is_copy[at], fields_of);
                if self.push_values(element, &blend, &mut out) {
                    continue;
                }
                let report = &mut out.reports[at];
                report.status = Status::NoData;
                report.partner = None;
            } else {
                out.thickness.push(f64::NAN);
                out.states.push(&[]);
                out.strains.push(&[]);
            }
        }
        out
    }

    /// Empty buffers with room for the elements' values.
    fn buffers(&self, elements: &[u32]) -> Buffers {
        let n = elements.len();
        let layers =
            |element: usize| self.target.rules[self.target.rule_of[element] as usize].len();
        let all =
            |values: &dyn Fn(usize) -> usize| elements.iter().map(|&e| values(e as usize)).sum();
        let wanted = self.options.quantities;
        let n_states = all(&|element| layers(element) * self.target.planes(element));
        let n_strains = all(&|element| {
            if self.strains_at_surfaces {
                2
            } else {
                layers(element)
            }
        });
        Buffers {
            reports: Vec::with_capacity(n),
            limits: Vec::with_capacity(n),
            thickness: Vec::with_capacity(n),
            states: MappedLayers::with_room(n, if wanted.needs_states() { n_states } else { 0 }),
            strains: MappedLayers::with_room(n, if wanted.strain { n_strains } else { 0 }),
        }
    }

    /// Number of the rule at whose layers a source element has what the element's layers take, in rising T of its
    /// own: that of the element, as the other side of the sheet sees it if the normals are opposite.
    pub(super) fn rule(&self, element: usize, is_flipped: bool) -> usize {
        let rule = self.target.rule_of[element] as usize;
        if is_flipped {
            self.turned_over[rule]
        } else {
            rule
        }
    }

    /// The same for strains.
    pub(super) fn strain_rule(&self, element: usize, is_flipped: bool) -> usize {
        if self.strains_at_surfaces {
            0
        } else {
            self.rule(element, is_flipped)
        }
    }

    /// Fits the fields that the elements need, each once.
    fn load_fields(&self, elements: &[u32], partners: &Partners, fields: &mut ChunkFields) {
        let ChunkFields { rules, of_sources } = fields;
        let sides_at = |at: usize| {
            let element = elements[at] as usize;
            [false, true].map(|is_flipped| self.rule(element, is_flipped))
        };
        rules.clear();
        rules.extend((0..elements.len()).flat_map(sides_at));
        rules.sort_unstable();
        rules.dedup();
        of_sources.resize_with(self.sources.len(), Vec::new);
        for (source, (prepared, fields)) in self.sources.iter().zip(of_sources).enumerate() {
            fields.resize_with(rules.len(), || prepared.fields());
            for (&rule, of_rule) in rules.iter().zip(fields) {
                let rules = [rule, self.turned_over[rule]];
                let strain_rules = if self.strains_at_surfaces {
                    [0; 2]
                } else {
                    rules
                };
                let own = (0..elements.len()).filter(|&at| sides_at(at).contains(&rule));
                let groups = own.flat_map(|at| {
                    let first = at.checked_sub(1).map_or(0, |before| partners.ends[before]);
                    let all = partners.groups[first..partners.ends[at]].iter();
                    all.filter(move |group| sides_at(at)[usize::from(group.is_flipped)] == rule)
                });
                let groups = groups.filter(|group| group.source as usize == source);
                let wanted = groups.map(|group| group.element);
                prepared.load(of_rule, wanted, [rules, strain_rules]);
            }
        }
    }

    /// Finds the partners of one element and appends its report.
    fn find_partners(
        &self,
        element: usize,
        search: &mut Search,
        partners: &mut Partners,
        out: &mut Buffers,
    ) {
        let mesh = &self.target.mesh;
        let centre_point = mesh.centroids()[element];
        let normal = mesh.normals()[element];
        let centre = self.partner_of_centre(element, &mut search.trails);
        let reach = self.reach(element, centre.as_ref());
        let (preferred, is_doubled) = self.preferred_centre(element, reach, &search.trails);
        let centre = preferred.or(centre);
        let copied = centre.filter(|centre| self.is_same_element(element, centre));
        let mut found = match (copied, self.options.method, centre) {
            (Some(same), _, _) => self.one_group(element, &same),
            (None, MapMethod::Nearest, Some(near))
                if self.is_valid(element, &near.point, reach) =>
            {
                self.one_group(element, &near)
            }
            _ => self.gather(element, reach, centre.as_ref(), search),
        };
        found.in_conflict |= is_doubled;
        let owner = found.owner(self.sources);
        let first = partners.groups.len();
        if let Some(owner) = owner {
            let is_owned = |group: &&Group| gauge_of(self.sources, group) == owner;
            partners.groups.extend(found.groups.iter().filter(is_owned));
        }
        let groups = &partners.groups[first..];
        let coverage = if found.area > 0.0 {
            found.covered / found.area
        } else {
            0.0
        };
        let mut without_conflict = found.status(coverage);
        let partner = self.partner(centre.as_ref(), owner, groups, copied.is_some());
        let uniqueness = match (&centre, without_conflict) {
            (Some(centre), Status::Mapped | Status::Partly) => {
                self.uniqueness(element, centre, reach)
            }
            _ => 1.0,
        };
        let has_values = without_conflict.has_values();
        if has_values && uniqueness < 2.0 * (1.0 - AMBIGUOUS_RATIO) {
            without_conflict = Status::TwoLayers;
        }
        let status = if has_values && found.in_conflict {
            Status::Conflict
        } else {
            without_conflict
        };
        if !status.has_values() {
            partners.groups.truncate(first);
        }
        partners.ends.push(partners.groups.len());
        partners.is_copy.push(copied.is_some());
        let sheet = self.place_of_sheet(centre.as_ref(), &partners.groups[first..]);
        let apart = sheet.map(|(place, _)| place - centre_point);
        let normal_distance = apart.map_or(f64::NAN, |apart| apart.dot(&normal));
        out.limits.push(Limits {
            max_distance: reach,
            uniqueness,
            without_conflict,
        });
        out.reports.push(ElementReport {
            status,
            normal_distance,
            tangential_distance: apart
                .map_or(f64::NAN, |apart| (apart - normal * normal_distance).norm()),
            angle_deg: sheet.map_or(f64::NAN, |(_, side)| {
                side.dot(&normal).clamp(-1.0, 1.0).acos().to_degrees()
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
            facing: self.facing(element, source),
        }
    }

    /// The side that the normals of a source point to, as an element has it: one that is reversed in its sheet belongs
    /// to the sheet all the same.
    pub(super) fn facing(&self, element: usize, source: usize) -> Facing {
        let of_sheet = self.facings[source];
        if self.is_reversed.get(element) != Some(&true) {
            of_sheet
        } else if self.sources[source].neighbours().any_opposed() {
            // The element of the source there may be reversed too.
            Facing::Mixed
        } else {
            of_sheet.turned_over()
        }
    }

    /// The nearest compatible point of all sources to the centre, within twice the largest distance.
    fn partner_of_centre(&self, element: usize, trails: &mut [Trail]) -> Option<Centre> {
        let query = self.target.mesh.centroids()[element];
        let size = self.target.mesh.size(element);
        let mut best: Option<Centre> = None;
        for (source, prepared) in self.sources.iter().enumerate() {
            let own = size.max(self.source_sizes[source]);
            let reach = 2.0 * self.options.max_distance.unwrap_or(own);
            let filter = self.filter(element, source);
            let trail = &mut trails[source];
            let found = prepared.closest(&query, &filter, reach, trail.hint);
            trail.centre = found.map(|(_, point)| point);
            let Some((triangle, point)) = found else {
                continue;
            };
            trail.hint = Some(triangle);
            if best.is_none_or(|best| point.distance_sq < best.point.distance_sq) {
                let source = source as u32;
                best = Some(Centre { source, point });
            }
        }
        best
    }

    /// Of several sources that have a partner of the centre the one that is to be taken, and whether more
    /// than one lies there.
    fn preferred_centre(
        &self,
        element: usize,
        reach: f64,
        trails: &[Trail],
    ) -> (Option<Centre>, bool) {
        if self.sources.len() < 2 {
            return (None, false);
        }
        let mut best: Option<Centre> = None;
        let mut n_inside = 0;
        for (source, trail) in (0..).zip(trails) {
            let Some(point) = trail.centre.filter(|p| self.is_valid(element, p, reach)) else {
                continue;
            };
            let candidate = Centre { source, point };
            n_inside += usize::from(self.competes(&candidate));
            if best.is_none_or(|best| self.is_preferred(&candidate, &best)) {
                best = Some(candidate);
            }
        }
        (best, n_inside > 1)
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
        let largest = largest(groups)?;
        Some(Partner {
            source: largest.source,
            element: largest.element,
            is_flipped: largest.is_flipped,
            is_copy,
        })
    }

    /// Appends the element's values; false if its partners have none.
    fn push_values(&self, element: usize, blend: &Blend<'_>, out: &mut Buffers) -> bool {
        let thickness = blend.thickness();
        out.thickness.push(thickness);
        let layers = self.target.rules[self.target.rule_of[element] as usize].len();
        let quantities = self.options.quantities;
        out.states.push_from(|states| {
            let first = states.len();
            blend.states(layers, states);
            for value in &mut states[first..] {
                if !quantities.stress {
                    value[..6].fill(0.0);
                }
                if !quantities.plastic_strain {
                    value[PLASTIC_STRAIN] = 0.0;
                }
            }
        });
        let strain_layers = if self.strains_at_surfaces { 2 } else { layers };
        out.strains
            .push_from(|strains| blend.strains(strain_layers, strains));
        let at = out.thickness.len() - 1;
        !thickness.is_nan() || !out.states.of(at).is_empty() || !out.strains.of(at).is_empty()
    }
}
