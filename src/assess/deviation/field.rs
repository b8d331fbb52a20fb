//! Signed distances of the nodes of one part from the other.

use super::DeviationSettings;
use super::offset::{ConstantPart, Sample};
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::geometry::{Similarity, Topology, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;
use crate::search::{Feature, SurfaceHit, closest_many};

/// A place of a part seen from the other one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum OverlapClass {
    /// The other part is there, within the limit.
    Matched,
    /// The other part faces it, but farther away than the limit.
    OffByMore,
    /// The other part ends before it comes here, or is out of reach.
    OnlyHere,
}

impl OverlapClass {
    /// All, from good to nothing.
    pub const ALL: [Self; 3] = [Self::Matched, Self::OffByMore, Self::OnlyHere];
}

/// One value for every vertex of one part: how far the other part is away.
///
/// Vertices are those of the mesh the [`Surface`] was made of, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationField {
    /// Signed distance in target length units: positive where the source lies in front of the
    /// target (on the side of the target's normals), negative behind it, for both directions. Without
    /// sign if `is_signed` is false. Beside a border it is the height over the sheet, so that a trim
    /// line a little farther out is no deviation. For `OnlyHere` the distance to whatever is
    /// nearest; infinite where nothing is within reach.
    pub signed: Vec<f64>,
    /// What the value means.
    pub class: Vec<OverlapClass>,
    /// Area around each vertex in target units squared; 0 for one that no triangle uses.
    pub area: Vec<f64>,
    /// False if the target cannot be oriented, so that there is no side.
    pub is_signed: bool,
    /// Distance up to which a place is matched, in target length units.
    pub limit: f64,
    /// Distance beyond which nothing is a counterpart.
    pub reach: f64,
    /// The constant part of the distances, apart from what a small rigid move would change; `None`
    /// where the two are not separable, as on a flat plate, or where there is no sign.
    pub constant: Option<ConstantPart>,
}

impl DeviationField {
    /// The value of a vertex that has a counterpart.
    pub fn compared(&self, vertex: usize) -> Option<f64> {
        (self.class[vertex] != OverlapClass::OnlyHere).then(|| self.signed[vertex])
    }

    /// Share of the whole area in each class, in the order of [`OverlapClass::ALL`].
    pub fn class_shares(&self) -> [f64; 3] {
        let mut shares = [0.0; 3];
        for (class, area) in self.class.iter().zip(&self.area) {
            shares[*class as usize] += area;
        }
        let total: f64 = shares.iter().sum();
        shares.map(|area| if total > 0.0 { area / total } else { 0.0 })
    }
}

/// Surfaces that turn away from each other by more than this are no counterparts: a flange that
/// bends down where the other part ends does not lie over it. Cosine of 60°.
const MIN_FACING: f64 = 0.5;

/// Both directions, that of the source's vertices first, as [`source_on_target`] and [`target_on_source`] give them.
/// O(n · log n).
pub fn both_ways(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    settings: &DeviationSettings,
    monitor: &Monitor,
) -> Result<[DeviationField; 2], Cancelled> {
    let pair = Pair::of([source, target], target_from_source, settings, monitor)?;
    Ok([
        pair.source_on_target(monitor)?,
        pair.target_on_source(monitor)?,
    ])
}

/// Every vertex of the source against the triangles of the target. O(n · log n).
pub fn source_on_target(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    settings: &DeviationSettings,
    monitor: &Monitor,
) -> Result<DeviationField, Cancelled> {
    let pair = Pair::of([source, target], target_from_source, settings, monitor)?;
    pair.source_on_target(monitor)
}

/// Every vertex of the target against the triangles of the source. O(n · log n).
pub fn target_on_source(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    settings: &DeviationSettings,
    monitor: &Monitor,
) -> Result<DeviationField, Cancelled> {
    let pair = Pair::of([source, target], target_from_source, settings, monitor)?;
    pair.target_on_source(monitor)
}

/// Two parts under a pose, and what holds for both directions.
struct Pair<'a> {
    source: &'a Surface,
    target: &'a Surface,
    pose: Similarity,
    /// The sides of the target.
    sides: Sides,
    limit: f64,
    reach: f64,
}

impl<'a> Pair<'a> {
    fn of(
        [source, target]: [&'a Surface; 2],
        pose: &Similarity,
        settings: &DeviationSettings,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        Ok(Self {
            source,
            target,
            pose: *pose,
            sides: Sides::of(target, monitor)?,
            limit: settings.limit_for(source, target, pose.scale),
            reach: settings.reach_for(source, target, pose.scale),
        })
    }

    fn source_on_target(&self, monitor: &Monitor) -> Result<DeviationField, Cancelled> {
        let way = Way {
            data: self.source,
            model: self.target,
            world_from_data: self.pose,
            world_from_model: Similarity::identity(),
            sides: &self.sides,
            is_data_source: true,
        };
        way.measure(self.limit, self.reach, monitor)
    }

    fn target_on_source(&self, monitor: &Monitor) -> Result<DeviationField, Cancelled> {
        let way = Way {
            data: self.target,
            model: self.source,
            world_from_data: Similarity::identity(),
            world_from_model: self.pose,
            sides: &self.sides,
            is_data_source: false,
        };
        way.measure(self.limit, self.reach, monitor)
    }
}

/// One of the two directions. "World" is the target's frame.
struct Way<'a> {
    data: &'a Surface,
    model: &'a Surface,
    world_from_data: Similarity,
    world_from_model: Similarity,
    /// The sides of the target.
    sides: &'a Sides,
    is_data_source: bool,
}

impl Way<'_> {
    fn measure(
        &self,
        limit: f64,
        reach: f64,
        monitor: &Monitor,
    ) -> Result<DeviationField, Cancelled> {
        let model_from_data = self.world_from_model.inverse().after(&self.world_from_data);
        let positions = self.data.mesh().positions();
        let queries = map_chunks(positions.len(), monitor, |vertex| {
            model_from_data.apply(&positions[vertex])
        })?;
        let within = reach / self.world_from_model.scale;
        let hits = closest_many(self.model.bvh(), &queries, within, monitor)?;
        let found = map_chunks(hits.len(), monitor, |vertex| match &hits[vertex] {
            Some(hit) => self.judge(vertex, hit, limit),
            None => Judged::NOTHING,
        })?;
        monitor.check()?;
        let constant = if self.sides.are_known {
            let samples = self.samples(&found);
            monitor.check()?;
            ConstantPart::of(&samples)
        } else {
            None
        };
        monitor.check()?;
        let mut field = self.as_given(&found, limit, reach);
        field.constant = constant;
        Ok(field)
    }

    /// Places that have a counterpart, for the constant part.
    fn samples(&self, found: &[Judged]) -> Vec<Sample> {
        let vertices = found.iter().enumerate();
        let compared = vertices.filter(|(_, judged)| judged.class != OverlapClass::OnlyHere);
        let sample = |(vertex, judged): (usize, &Judged)| Sample {
            point: self
                .world_from_data
                .apply(&self.data.mesh().positions()[vertex]),
            normal: judged.front,
            distance: judged.signed,
            weight: self.data.vertex_areas()[vertex],
        };
        compared.map(sample).collect()
    }

    /// Value and class of a vertex whose closest point is `hit`.
    fn judge(&self, vertex: usize, hit: &SurfaceHit, limit: f64) -> Judged {
        let at = self
            .world_from_data
            .apply(&self.data.mesh().positions()[vertex]);
        let away = at - self.world_from_model.apply(&hit.point);
        let own = self.data.vertex_normals()[vertex];
        let own = self.world_from_data.rotate(&own);
        let other = self.world_from_model.rotate(&self.normal_at(hit));
        let height = away.dot(&other);
        let (to_source, front) = if self.is_data_source {
            (away, other)
        } else {
            (-away, own)
        };
        let sign = if self.sides.are_known && to_source.dot(&front) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let mut distance = away.norm();
        if self.model.is_on_border(hit) {
            let beside = (away - other * height).norm();
            if beside > limit {
                return Judged {
                    signed: sign * distance,
                    class: OverlapClass::OnlyHere,
                    front,
                };
            }
            distance = height.abs();
        }
        let class = if distance <= limit {
            OverlapClass::Matched
        } else if own.dot(&other).abs() < MIN_FACING {
            OverlapClass::OnlyHere
        } else {
            OverlapClass::OffByMore
        };
        Judged {
            signed: sign * distance,
            class,
            front,
        }
    }

    /// The normal that determines on which side of the model a point lies whose closest point is `hit`:
    /// that of the face, the sum of both at an edge, the angle-weighted mean at a corner
    /// (Bærentzen and Aanæs 2005).
    fn normal_at(&self, hit: &SurfaceHit) -> Vector3 {
        let triangle = hit.triangle as usize;
        let mesh = self.model.mesh();
        let flat = mesh.normal(triangle);
        let normal = match hit.feature {
            Feature::Face => flat,
            Feature::Edge(_) if !self.is_data_source => flat,
            Feature::Edge(edge) => match self.sides.beyond[triangle][usize::from(edge)] {
                NOBODY => flat,
                other => flat + mesh.normal(other as usize),
            },
            Feature::Vertex(corner) => {
                let vertex = mesh.triangles()[triangle][usize::from(corner)];
                self.model.vertex_normals()[vertex as usize]
            }
        };
        let normal = normal.try_normalize(1e-12);
        normal.unwrap_or_else(|| self.model.normal_at(hit))
    }

    /// Values of the vertices the surface was made of.
    fn as_given(&self, found: &[Judged], limit: f64, reach: f64) -> DeviationField {
        let unit = self.world_from_data.scale * self.world_from_data.scale;
        let mut areas: Vec<f64> = self.data.vertex_areas().iter().map(|a| a * unit).collect();
        let given = self.data.vertex_of();
        let mut field = DeviationField {
            signed: Vec::with_capacity(given.len()),
            class: Vec::with_capacity(given.len()),
            area: Vec::with_capacity(given.len()),
            is_signed: self.sides.are_known,
            limit,
            reach,
            constant: None,
        };
        for &vertex in given {
            let known = found.get(vertex as usize).copied();
            let judged = known.unwrap_or(Judged::NOTHING);
            field.signed.push(judged.signed);
            field.class.push(judged.class);
            // Of several vertices at one place the first has the area.
            let area = areas.get_mut(vertex as usize).map(std::mem::take);
            field.area.push(area.unwrap_or(0.0));
        }
        field
    }
}

/// What was found about one vertex.
#[derive(Debug, Clone, Copy)]
struct Judged {
    signed: f64,
    class: OverlapClass,
    /// Unit normal of the target's front there.
    front: Vector3,
}

impl Judged {
    /// A vertex with nothing in reach.
    const NOTHING: Self = Self {
        signed: f64::INFINITY,
        class: OverlapClass::OnlyHere,
        front: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// Number that stands for no triangle.
const NOBODY: u32 = u32::MAX;

/// What is needed to distinguish the sides of a surface.
struct Sides {
    /// For each edge of each triangle the triangle beyond it; [`NOBODY`] at borders and where three
    /// or more meet.
    beyond: Vec<[u32; 3]>,
    /// False if neighbours run along their common edge in the same direction: a Möbius strip, which
    /// [`Surface`] could not orient either.
    are_known: bool,
}

impl Sides {
    fn of(surface: &Surface, monitor: &Monitor) -> Result<Self, Cancelled> {
        let mesh = surface.mesh();
        let topology = Topology::build(mesh, monitor)?;
        let mut beyond = vec![[NOBODY; 3]; mesh.n_triangles()];
        let mut are_known = true;
        for_chunks(topology.edges.len(), monitor, |range| {
            for edge in range {
                let [u, v] = topology.edges[edge];
                let &[s, t] = topology.triangles_of(edge) else {
                    continue;
                };
                // Which edge of a triangle it is, and whether the triangle runs along it from u to v.
                let side = |triangle: u32| {
                    let corners = mesh.triangles()[triangle as usize];
                    (0..3).find_map(|i| match [corners[i], corners[(i + 1) % 3]] {
                        [a, b] if [a, b] == [u, v] => Some((i, true)),
                        [a, b] if [a, b] == [v, u] => Some((i, false)),
                        _ => None,
                    })
                };
                if let (Some((i, forth)), Some((j, back))) = (side(s), side(t)) {
                    beyond[s as usize][i] = t;
                    beyond[t as usize][j] = s;
                    are_known &= forth != back;
                }
            }
        })?;
        Ok(Self { beyond, are_known })
    }
}
