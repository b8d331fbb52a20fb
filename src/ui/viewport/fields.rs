//! Numbers shown as colours: thickness, forming results and error of the reduction, made off the frame and
//! kept while they are shown; distance between the parts and overlap, which the worker measures.

mod elements;
mod summary;

use std::sync::Arc;

use super::identity::Identity;
use super::map_fields;
use super::meshes::ShownMesh;
use super::visible_parts::PartInstance;
use crate::app::{AppState, ColorBy, Coloring, MapPicture};
use crate::assess::Assessment;
use crate::colormap::{ColorMap, ColorScale};
use crate::geometry::{Point3, Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::pipeline::forming_values::{FormingValue, forming_values, has_forming_value};
use crate::pipeline::map::{MapRun, OtherResult, ShownValue};
use crate::render::FieldLook;
use crate::role::{PerRole, Role};
use crate::search::{Bvh, closest_many};
use crate::ui::background::{Background, Task};
use elements::{at_corners, thickness, vertex_means};
pub(super) use summary::Summary;
use summary::{robust_range, without_rounding};

/// Fields kept although nothing shows them now.
const KEPT: usize = 6;

/// What a field says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldKind {
    Thickness,
    ReductionError,
    Deviation,
    Overlap,
    Uncertainty,
    Forming(FormingValue),
    Map(MapPicture),
}

impl FieldKind {
    /// The field that is asked for, if it is one.
    pub fn of(color_by: ColorBy) -> Option<Self> {
        match color_by {
            ColorBy::Thickness => Some(Self::Thickness),
            ColorBy::ReductionError => Some(Self::ReductionError),
            ColorBy::Deviation => Some(Self::Deviation),
            ColorBy::Overlap => Some(Self::Overlap),
            ColorBy::Uncertainty => Some(Self::Uncertainty),
            other => {
                let picture = other.map_picture().map(Self::Map);
                picture.or(other.forming().map(Self::Forming))
            }
        }
    }

    /// True for distances with a side.
    pub fn is_signed(self) -> bool {
        self == Self::Deviation
    }

    /// True for what the colours of values with a sign are put on, besides the deviation.
    pub fn has_signed_colors(self) -> bool {
        use MapPicture::{Angle, Confidence, File, Status};
        matches!(self, Self::Map(picture) if !matches!(picture, Angle | Confidence | File | Status))
    }

    /// True for differences of a quantity, which may all be rounding.
    pub fn is_difference(self) -> bool {
        matches!(self, Self::Map(MapPicture::Difference | MapPicture::Other))
    }

    /// Title of the legend.
    pub fn label(self) -> &'static str {
        match self {
            Self::Thickness => "Thickness",
            Self::ReductionError => "Distance reduced to full",
            Self::Deviation => "Deviation",
            Self::Overlap => "Overlap",
            Self::Uncertainty => "The pose may be off by",
            Self::Forming(value) => value.label(),
            Self::Map(picture) => picture.label(),
        }
    }
}

/// A field by what it was made of.
#[derive(Debug, Clone, PartialEq)]
struct FieldKey {
    kind: FieldKind,
    mesh: Identity,
    /// What it is made of besides: the other mesh of a reduction error, results, or an assessment.
    other: Option<Identity>,
    /// What is shown of results.
    shown: Option<ShownValue>,
}

/// A finished field.
struct Field {
    values: Arc<[f32]>,
    is_by_corner: bool,
    /// What the colours should span; nothing where no value is known.
    range: Option<[f64; 2]>,
    summary: Option<Summary>,
}

/// The fields of both windows.
pub(super) struct FieldStore {
    background: Background<FieldKey, Field>,
    /// Most recently used last.
    ready: Vec<(FieldKey, Arc<Field>)>,
    /// Those that could not be made, as long as someone holds what they are made of.
    failed: Vec<FieldKey>,
    /// Ranges of what each window shows, so that both have one scale. A window without any value says
    /// nothing of it.
    ranges: PerRole<Option<(FieldKind, Option<[f64; 2]>)>>,
    /// Figures of what each window shows.
    summaries: PerRole<Option<Summary>>,
    /// How many parts each window shows.
    n_shown: PerRole<usize>,
}

impl FieldKey {
    /// True while someone holds all that the field is made of.
    fn is_there(&self) -> bool {
        self.mesh.is_there() && self.other.as_ref().is_none_or(Identity::is_there)
    }
}

impl FieldStore {
    pub fn new() -> Self {
        Self {
            background: Background::new("fields"),
            ready: Vec::new(),
            failed: Vec::new(),
            ranges: PerRole::default(),
            summaries: PerRole::default(),
            n_shown: PerRole::default(),
        }
    }

    /// The fields of a window's meshes; `None` where there is none, or none yet.
    pub fn get(
        &mut self,
        window: Role,
        state: &AppState,
        drawn: &[(Arc<ShownMesh>, PartInstance)],
        wake: &egui::Context,
    ) -> Vec<Option<FieldLook>> {
        let kind = FieldKind::of(state.color_by(window));
        if let Some(kind @ (FieldKind::Deviation | FieldKind::Overlap)) = kind {
            self.forget(window);
            let of = |(mesh, instance): &(Arc<ShownMesh>, PartInstance)| {
                compared(kind, state, instance.role, mesh)
            };
            return drawn.iter().map(of).collect();
        }
        let orders: Vec<_> = drawn
            .iter()
            .map(|(mesh, instance)| Order::new(kind?, state, instance, mesh))
            .collect();
        let is_missing = |order: &&Order| {
            let is_ready = self.ready.iter().any(|(key, _)| *key == order.key);
            !is_ready && !self.failed.contains(&order.key)
        };
        let wanted = orders.iter().flatten().filter(is_missing);
        let wanted = wanted.map(|order| order.clone().task()).collect();
        for (key, field) in self.background.exchange(window, wanted, wake) {
            match field {
                Some(field) => self.ready.push((key, Arc::new(field))),
                None => self.failed.push(key),
            }
        }
        let found = orders.iter().map(|order| self.find(order.as_ref()?));
        let found: Vec<_> = found.collect();
        *self.ranges.get_mut(window) =
            kind.filter(|_| found.iter().any(Option::is_some))
                .map(|kind| {
                    let ranges = found.iter().flatten().filter_map(|field| field.range);
                    (kind, ranges.reduce(union))
                });
        let summaries = found.iter().flatten().filter_map(|field| field.summary);
        *self.summaries.get_mut(window) = summaries.reduce(Summary::and);
        *self.n_shown.get_mut(window) = drawn.len();
        let n_shown = self.n_shown.crash + self.n_shown.stamped;
        let n = self.ready.len().saturating_sub(KEPT + n_shown);
        self.ready.drain(..n);
        self.failed.retain(FieldKey::is_there);
        let scale = self.scale(window, state);
        let look = |field: Arc<Field>| {
            Some(FieldLook {
                values: Arc::clone(&field.values),
                is_by_corner: field.is_by_corner,
                scale: scale?,
            })
        };
        found.into_iter().map(|field| look(field?)).collect()
    }

    /// A window draws nothing: its last values say nothing of the colours in the other.
    pub fn forget(&mut self, window: Role) {
        *self.ranges.get_mut(window) = None;
        *self.summaries.get_mut(window) = None;
        *self.n_shown.get_mut(window) = 0;
    }

    /// Figures of the values that a window shows; those of deviation and overlap are measured elsewhere.
    pub fn summary(&self, window: Role) -> Option<Summary> {
        *self.summaries.get(window)
    }

    /// True while fields are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting()
    }

    /// The scale of what a window shows; the same in both if they show the same.
    pub fn scale(&self, window: Role, state: &AppState) -> Option<ColorScale> {
        let by = state.color_by(window);
        let kind = FieldKind::of(by)?;
        let display = &state.view.display;
        Some(match kind {
            FieldKind::Deviation => state.deviation_scale()?,
            FieldKind::Overlap => ColorScale::new(ColorMap::Classes, 0.0, 1.0),
            FieldKind::Map(MapPicture::Status) => ColorScale::statuses(),
            FieldKind::Map(MapPicture::File) => ColorScale::files(),
            FieldKind::Thickness
            | FieldKind::ReductionError
            | FieldKind::Uncertainty
            | FieldKind::Forming(_)
            | FieldKind::Map(_) => {
                display.limited(by, self.scale_of_values(kind, &display.coloring)?)
            }
        })
    }

    /// The scale of a map as its values give it.
    fn scale_of_values(&self, kind: FieldKind, coloring: &Coloring) -> Option<ColorScale> {
        if kind == FieldKind::Map(MapPicture::Confidence) {
            return Some(coloring.on_scale(ColorScale::new(ColorMap::Viridis, 0.0, 1.0)));
        }
        let ranges = self.ranges.iter().filter_map(|(_, range)| *range);
        let [low, high] = common_range(ranges.filter(|(of, _)| *of == kind).map(|(_, r)| r))?;
        if kind == FieldKind::Map(MapPicture::Angle) {
            // Normals that agree to a tenth of a degree are one colour.
            let scale = ColorScale::new(ColorMap::Viridis, 0.0, high.max(0.1));
            return Some(coloring.on_scale(scale));
        }
        if kind.has_signed_colors() {
            return Some(coloring.on_signed_scale(low.abs().max(high.abs())));
        }
        let low = match kind {
            FieldKind::ReductionError | FieldKind::Uncertainty => 0.0,
            // From nothing upwards, where nothing is below.
            FieldKind::Forming(_) if low > 0.0 => 0.0,
            _ => low,
        };
        Some(coloring.on_scale(ColorScale::new(ColorMap::Viridis, low, high)))
    }

    /// The field, or the last one of this mesh and kind, which is shown until the new one is there.
    fn find(&mut self, order: &Order) -> Option<Arc<Field>> {
        let newest =
            |is_it: &dyn Fn(&FieldKey) -> bool| self.ready.iter().rposition(|(key, _)| is_it(key));
        let same = |key: &FieldKey| key.kind == order.key.kind && key.mesh == order.key.mesh;
        let at = newest(&|key| *key == order.key).or_else(|| newest(&same))?;
        let found = self.ready.remove(at);
        let field = Arc::clone(&found.1);
        self.ready.push(found);
        Some(field)
    }
}

/// True if a part is to be coloured by a field in a window.
pub(super) fn is_wanted(state: &AppState, window: Role, instance: &PartInstance) -> bool {
    if instance.is_ghost {
        return false;
    }
    let display = &state.view.display;
    let (role, kind) = (instance.role, FieldKind::of(state.color_by(window)));
    if let Some(file) = &instance.further {
        return match kind {
            Some(FieldKind::Forming(value)) => {
                has_forming_value(&file.loaded, value, state.flat_thickness()).is_ok()
            }
            kind => kind == Some(FieldKind::Thickness),
        };
    }
    match kind {
        Some(FieldKind::Deviation) => *display.coloring.on.get(role) && has_both(state),
        Some(FieldKind::Overlap) => has_both(state),
        Some(FieldKind::Map(MapPicture::Other)) => {
            role == Role::Crash && state.missing_for(ColorBy::MapOther).is_none()
        }
        Some(FieldKind::Uncertainty) => role == Role::Stamped && state.has_uncertainty().is_ok(),
        Some(FieldKind::Map(_)) => {
            role == Role::Crash && state.document.current_mapping().is_some()
        }
        Some(FieldKind::Forming(value)) => {
            if role == Role::Crash && state.mapped_for(value.into()).is_some() {
                return true;
            }
            let part = state.document.part(role);
            let nominal = state.flat_thickness();
            part.is_some_and(|part| has_forming_value(&part.loaded, value, nominal).is_ok())
        }
        Some(_) => true,
        None => false,
    }
}

/// True for what a part carries by itself.
fn is_of_part(kind: FieldKind) -> bool {
    matches!(kind, FieldKind::Thickness | FieldKind::Forming(_))
}

fn has_both(state: &AppState) -> bool {
    state.document.both().is_some()
}

/// The values of a mesh in the last comparison.
fn compared(kind: FieldKind, state: &AppState, role: Role, mesh: &ShownMesh) -> Option<FieldLook> {
    let coloring = &state.view.display.coloring;
    let comparison = state.comparison()?;
    let drawn = comparison.drawn(mesh.source.mesh())?;
    match kind {
        FieldKind::Deviation if *coloring.on.get(role) => Some(FieldLook {
            values: Arc::clone(&drawn.signed),
            is_by_corner: false,
            scale: state.deviation_scale()?,
        }),
        FieldKind::Overlap => Some(FieldLook {
            values: Arc::clone(&drawn.overlap),
            is_by_corner: false,
            scale: ColorScale::new(ColorMap::Classes, 0.0, 1.0),
        }),
        _ => None,
    }
}

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// What the colours of both windows span: the ranges that are known, or 0 to 1 where there are fields
/// without any value.
fn common_range(ranges: impl Iterator<Item = Option<[f64; 2]>>) -> Option<[f64; 2]> {
    let either = |a: Option<[f64; 2]>, b: Option<[f64; 2]>| match (a, b) {
        (Some(a), Some(b)) => Some(union(a, b)),
        (a, b) => a.or(b),
    };
    ranges
        .reduce(either)
        .map(|range| range.unwrap_or([0.0, 1.0]))
}

/// A field that is asked for, with everything it is made of.
#[derive(Clone)]
struct Order {
    key: FieldKey,
    mesh: Arc<ShownMesh>,
    /// What distances are measured to.
    other: Option<Arc<TriMesh>>,
    /// The mapping whose values the crash part carries instead of its own.
    mapped: Option<Arc<MapRun>>,
    /// What the mapping is compared with.
    compared: Option<Arc<OtherResult>>,
    /// The uncertainty of the pose.
    stated: Option<Stated>,
}

/// An assessment with the pose it speaks of.
type Stated = (Arc<Assessment>, Similarity);

impl Order {
    fn new(
        kind: FieldKind,
        state: &AppState,
        instance: &PartInstance,
        mesh: &Arc<ShownMesh>,
    ) -> Option<Self> {
        let role = instance.role;
        if instance.further.is_some() && !is_of_part(kind) {
            return None;
        }
        let part = state.document.part(role)?;
        let other = match kind {
            FieldKind::ReductionError => {
                let level = &part.level.as_ref()?.level.mesh;
                let is_full = mesh.source.level.is_none();
                Some(Arc::clone(if is_full { level } else { &part.loaded.mesh }))
            }
            _ => None,
        };
        let by = match kind {
            FieldKind::Thickness => Some(ColorBy::Thickness),
            FieldKind::Forming(value) => Some(value.into()),
            FieldKind::Map(_) => Some(state.map_quantity()),
            _ => None,
        };
        let mapped = by.filter(|_| role == Role::Crash);
        let mapped = mapped.and_then(|by| state.mapped_for(by));
        if mapped.is_none() && matches!(kind, FieldKind::Map(_)) {
            return None;
        }
        let stated = match kind {
            FieldKind::Uncertainty if role == Role::Stamped => {
                let assessment = Arc::clone(state.uncertain_assessment()?);
                Some((assessment, *state.document.crash_from_stamped()))
            }
            FieldKind::Uncertainty => return None,
            _ => None,
        };
        let shown = by.map(|by| ShownValue {
            layer: match role {
                Role::Crash => state.shown_layer(by),
                Role::Stamped => state.stamped_layer(by, instance.number()),
            },
            ..state.shown_value(by)
        });
        let compared = match kind {
            FieldKind::Map(MapPicture::Other) => {
                let result = state.document.current_mapping();
                result.and_then(|result| Some(result.other.as_ref()?.to_arc()))
            }
            _ => None,
        };
        let of_mesh = other.as_ref().map(Identity::of);
        let of_assessment = stated
            .as_ref()
            .map(|(assessment, _)| Identity::of(assessment));
        let of_results = compared.as_ref().map(Identity::of);
        let of_results = of_results.or(mapped.as_ref().map(Identity::of));
        let key = FieldKey {
            kind,
            mesh: mesh.key(),
            other: of_mesh.or(of_assessment).or(of_results),
            shown,
        };
        Some(Self {
            key,
            mesh: Arc::clone(mesh),
            other,
            mapped,
            compared,
            stated,
        })
    }

    fn task(self) -> Task<FieldKey, Field> {
        Task {
            key: self.key.clone(),
            work: Box::new(move || self.make()),
        }
    }

    fn make(self) -> Field {
        let is_by_corner = matches!(self.key.kind, FieldKind::Map(_));
        let (values, summary) = match self.at_nodes() {
            Some(values) => {
                let summary = Summary::of_nodes(self.mesh.mesh(), &values);
                (values, summary)
            }
            // The figures are those of the elements whatever is drawn of them, as in the report.
            None => {
                let by_element = self.by_element();
                let part = &self.mesh.source.part;
                let summary = Summary::of_elements(&part.mesh, part.ids.elements(), &by_element);
                let values = if is_by_corner {
                    at_corners(&self.mesh, &by_element)
                } else {
                    vertex_means(&self.mesh, &by_element)
                };
                (values, summary)
            }
        };
        Field {
            range: robust_range(&values),
            summary,
            is_by_corner,
            values: values.into(),
        }
    }

    /// What is known at the nodes of the drawn mesh; `None` for what the elements have.
    fn at_nodes(&self) -> Option<Vec<f32>> {
        let points = self.mesh.mesh().positions();
        if let Some((assessment, pose)) = &self.stated {
            return Some(uncertainties(assessment, points, pose));
        }
        let other = self.other.as_ref()?;
        let full = &self.mesh.source.part.surface;
        Some(if Arc::ptr_eq(other, full.mesh()) {
            distances(full.bvh(), points)
        } else {
            distances(&Bvh::build(Arc::clone(other)), points)
        })
    }

    /// The value of each element of the deck; NaN where there is none.
    fn by_element(&self) -> Vec<f64> {
        let Some(shown) = &self.key.shown else {
            return Vec::new();
        };
        let mut values = self.results(shown);
        // Other pictures of the mapping show no quantity.
        let is_of_quantity = match self.key.kind {
            FieldKind::Map(picture) => picture.color_by().speaks_of_quantity(),
            _ => true,
        };
        let factor = shown.value.map_or(1.0, FormingValue::shown_factor);
        if is_of_quantity && factor != 1.0 {
            values.iter_mut().for_each(|value| *value *= factor);
        }
        values
    }

    fn results(&self, shown: &ShownValue) -> Vec<f64> {
        let part = &self.mesh.source.part;
        let n_elements = part.model.shells.len();
        match (&self.mapped, self.key.kind) {
            (Some(run), FieldKind::Map(picture)) => {
                let results = (run.as_ref(), self.compared.as_deref());
                let values = map_fields::by_element(n_elements, results, picture, shown);
                if !self.key.kind.is_difference() {
                    return values;
                }
                let sizes = (0..run.shells.len()).map(|element| run.shown(element, shown).abs());
                without_rounding(values, sizes)
            }
            (Some(run), _) => {
                let mut values = vec![f64::NAN; n_elements];
                for (element, &shell) in run.shells.iter().enumerate() {
                    if let Some(slot) = values.get_mut(shell as usize) {
                        *slot = run.shown(element, shown);
                    }
                }
                values
            }
            (None, FieldKind::Forming(value)) => {
                forming_values(part, value, shown.flat, shown.layer).unwrap_or_default()
            }
            (None, _) => thickness(part),
        }
    }
}

/// How far the pose may be off at points of the stamped part.
fn uncertainties(assessment: &Assessment, points: &[Point3], pose: &Similarity) -> Vec<f32> {
    let stated = assessment.uncertainty();
    let values = stated.map_or_else(Vec::new, |stated| stated.field(points, pose));
    values.into_iter().map(|value| value as f32).collect()
}

/// Distances of points from a surface.
fn distances(tree: &Bvh, points: &[Point3]) -> Vec<f32> {
    let found = closest_many(tree, points, f64::INFINITY, &Monitor::silent());
    // A silent monitor is never cancelled.
    let found = found.unwrap_or_default().into_iter();
    let distance = |hit: Option<crate::search::SurfaceHit>| {
        hit.map_or(f32::NAN, |hit| hit.distance_sq.sqrt() as f32)
    };
    found.map(distance).collect()
}

#[cfg(test)]
mod tests;
