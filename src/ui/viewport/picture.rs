//! A window's scene together with what is needed to find the part under the cursor.

use std::sync::Arc;

use super::frame::ViewFrame;
use super::meshes::ShownMesh;
use super::sections::{self, Cuts};
use super::visible_parts::{self, PartInstance};
use crate::app::{AppState, ColorBy, PartRef, ShownFile};
use crate::colormap::{ColorScale, Rgb};
use crate::geometry::camera::{ScreenSize, ViewRay};
use crate::geometry::{Aabb, Camera, Plane, Point3, Similarity, Vector3};
use crate::render::{Drawable, FieldLook, PartLook, Polyline, Scene, Section, Sheet};
use crate::role::Role;
use crate::ui::theme::Look;

/// How far the crash sheet lies back when two sheets coincide, in pixels and in element sizes: about
/// the chord heights of two meshes of one curved sheet.
const PUSH_BACK_PIXELS: f32 = 0.5;
const PUSH_BACK_ELEMENTS: f64 = 0.02;
/// Further stamped files lie so far between the first one and the crash part.
const FURTHER_BACK: f64 = 0.5;
/// Shares of the thickness and of the element size within which sheets coincide.
const COINCIDENT_THICKNESS: f64 = 0.5;
const COINCIDENT_ELEMENTS: f64 = 0.04;
/// Parts fainter than this are looked through when picking.
const PICKED_OPACITY: f32 = 0.15;
/// Hidden sheets a ray passes before it gives up.
const MAX_PASSED: usize = 64;

/// What is drawn in one window in one frame.
pub(super) struct Picture {
    pub scene: Arc<Scene>,
    /// One for each drawable of the scene.
    layers: Vec<Layer>,
    /// Box around what is visible.
    pub bounds: Aabb,
    /// Corners of the section plane's frame.
    pub section_frame: Option<[Point3; 4]>,
    /// What lies on the side of its normal is cut away.
    clip: Option<Plane>,
}

/// Where a part lies in a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    window_from_part: Similarity,
    offset: Vector3,
}

impl Place {
    /// A point of the part, in the window's space.
    pub fn to_window(self, point: &Point3) -> Point3 {
        self.window_from_part.apply(point) + self.offset
    }

    /// A point of the window's space, in the part's own.
    pub fn to_part(self, point: &Point3) -> Point3 {
        self.window_from_part
            .inverse()
            .apply(&(point - self.offset))
    }
}

/// What stands behind a drawable.
pub(super) struct Layer {
    pub role: Role,
    pub mesh: Arc<ShownMesh>,
    pub field: Option<FieldLook>,
    /// It is to be coloured by a field, which may not be there yet.
    pub wants_field: bool,
    pub instance: PartInstance,
}

impl Layer {
    /// True for a further stamped file.
    fn is_further(&self) -> bool {
        self.instance.further.is_some()
    }
}

/// What lies under the cursor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hit {
    /// On the surface, in the space of the window.
    pub point: Point3,
    /// The part it belongs to, and the same place in that part's own frame.
    pub role: Role,
    pub in_part: Point3,
    pub part: Option<PartRef>,
    /// Number of the element in the deck, on the full mesh.
    pub element: Option<u64>,
    /// Its place among the shells of the model, if it is one.
    pub shell: Option<u32>,
    /// The nearest corner, and its number in the deck if it is a node.
    pub node: Point3,
    pub node_id: Option<u64>,
    /// The further stamped file it belongs to.
    pub further: Option<ShownFile>,
    /// Shown value at the hit.
    pub value: Option<f64>,
}

impl Picture {
    /// Puts the scene together.
    pub fn new(
        state: &AppState,
        view: &ViewFrame,
        look: &Look,
        layers: Vec<Layer>,
        pixels_per_point: f32,
    ) -> Self {
        let drawables: Vec<Drawable> = layers
            .iter()
            .map(|layer| drawable(state, view, look, layer))
            .collect();
        let has_field = layers.iter().any(|layer| layer.field.is_some());
        let scene = Scene {
            drawables,
            background: look.background,
            lines: look.lines,
            wipe: visible_parts::divider(state, view).map(visible_parts::Divider::share),
            coincidence: (!has_field).then(|| coincidence(state)).flatten(),
            exposure: look.exposure,
            ambient: look.ambient,
            pixels_per_point,
            ..Scene::default()
        };
        let mut bounds = Aabb::empty();
        for drawable in &scene.drawables {
            bounds = bounds.union(&drawable.bounds());
        }
        Self {
            scene: Arc::new(scene),
            layers,
            bounds,
            section_frame: None,
            clip: None,
        }
    }

    /// Adds the section plane and the outlines of the parts in it.
    pub fn cut(&mut self, state: &AppState, look: &Look, cuts: &Cuts) {
        let section = &state.inspect.section;
        let Some(plane) = section.shown().filter(|_| !self.bounds.is_empty()) else {
            return;
        };
        let frame = plane.rectangle(&self.bounds);
        let mut overlay = sections::frame(look, &frame);
        for layer in &self.layers {
            let number = layer.instance.number();
            if let Some(cut) = cuts.of(layer.role, number) {
                let style = sections::style(look, layer.role, number);
                overlay.polylines.extend(sections::outline(
                    look,
                    cut,
                    style,
                    &layer.instance.offset,
                ));
            }
        }
        self.section_frame = Some(frame);
        self.clip = Some(plane).filter(|_| section.is_clipped);
        let scene = Arc::make_mut(&mut self.scene);
        scene.overlay = overlay;
        scene.section = self.clip.map(|plane| Section {
            point: plane.point,
            normal: plane.normal,
        });
    }

    /// Adds what is only seen: nothing is found at its places.
    pub fn add(&mut self, unused: Vec<Drawable>, outlines: Vec<Polyline>) {
        if !unused.is_empty() {
            let scene = Arc::make_mut(&mut self.scene);
            scene.drawables.extend(unused);
            // Below those of the parts that are used.
            scene.overlay.polylines.splice(0..0, outlines);
        }
    }

    /// True if some part carries a field, or should.
    pub fn has_colored(&self) -> bool {
        self.layers.iter().any(|layer| layer.wants_field)
    }

    /// Where a point of a part's own frame is drawn; `None` if the part is not in this window.
    pub fn world_of(&self, role: Role, point: &Point3) -> Option<Point3> {
        Some(self.place_of(role)?.to_window(point))
    }

    /// The parts that are drawn, each once, crash first.
    pub fn roles(&self) -> Vec<Role> {
        let has = |role: &Role| self.layers.iter().any(|layer| layer.role == *role);
        Role::ALL.into_iter().filter(has).collect()
    }

    /// Where a part lies in this window, if it is drawn.
    pub fn place_of(&self, role: Role) -> Option<Place> {
        self.place_of_file(role, 0)
    }

    /// Where the crash part or a stamped file lies in this window, if it is drawn.
    pub fn place_of_file(&self, role: Role, number: usize) -> Option<Place> {
        let is_it = |layer: &&Layer| layer.role == role && layer.instance.number() == number;
        let layer = self.layers.iter().find(is_it)?;
        Some(Place {
            window_from_part: layer.instance.world_from_part,
            offset: layer.instance.offset,
        })
    }

    /// True if the section cuts away what lies at a point of the window.
    pub fn is_cut_away(&self, point: &Point3) -> bool {
        self.clip.is_some_and(|plane| plane.distance(point) > 0.0)
    }

    /// True if nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// What lies under a point of the window; sheets that are hidden or hardly visible do not count.
    /// A few microseconds per sheet.
    pub fn hit(&self, camera: &Camera, pixel: [f64; 2], screen: ScreenSize) -> Option<Hit> {
        self.hit_of(None, camera, pixel, screen)
    }

    /// [`Picture::hit`] on the crash part or the first stamped one, whatever lies before it, or on all.
    pub fn hit_of(
        &self,
        only: Option<Role>,
        camera: &Camera,
        pixel: [f64; 2],
        screen: ScreenSize,
    ) -> Option<Hit> {
        let ray = camera.ray(pixel, screen, &self.bounds);
        let is_left = self
            .scene
            .wipe
            .map(|share| pixel[0] < f64::from(share) * screen.width);
        let layers = self.layers.iter().zip(&self.scene.drawables);
        let hits = layers
            .filter(|(layer, _)| only.is_none_or(|role| layer.role == role && !layer.is_further()))
            .filter(|(_, drawable)| drawable.opacity > PICKED_OPACITY)
            .filter(|(_, drawable)| is_on_side(drawable.wipe, is_left))
            .filter_map(|(layer, drawable)| {
                let (distance, hit) = hit_layer(layer, drawable, &ray, self.clip.as_ref())?;
                // Of two coincident sheets the one that is drawn in front is met.
                let pixel = camera.pixel_size(screen, &hit.point);
                let back = drawable.push_back_length + f64::from(drawable.push_back) * pixel;
                Some((distance + back, hit))
            });
        let nearest = hits.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, hit)| hit)
    }
}

fn is_on_side(wipe: crate::render::WipeSide, is_left: Option<bool>) -> bool {
    use crate::render::WipeSide;
    match (wipe, is_left) {
        (WipeSide::Both, _) | (_, None) => true,
        (WipeSide::Left, Some(is_left)) => is_left,
        (WipeSide::Right, Some(is_left)) => !is_left,
    }
}

/// How close the sheets lie together where both are shown: half their mean thickness, the distance at
/// which two real sheets would cut into each other by half; without thickness a share of the element
/// size. In the crash model's unit.
pub(super) fn coincidence(state: &AppState) -> Option<f64> {
    let both = state.document.both()?;
    let facts = [&both.crash.facts, &both.stamped.facts];
    let known = facts.iter().filter_map(|facts| facts.thickness);
    let thickness = known.reduce(f64::min).filter(|t| *t > 0.0);
    let element = facts[0].edge_length.min(facts[1].edge_length);
    let distance = thickness.map_or(COINCIDENT_ELEMENTS * element, |t| COINCIDENT_THICKNESS * t);
    (distance > 0.0).then(|| two_digits(distance))
}

/// A positive length as it is written, with two digits.
fn two_digits(length: f64) -> f64 {
    let unit = 10f64.powf(length.log10().floor() - 1.0);
    (length / unit).round() * unit
}

fn drawable(state: &AppState, view: &ViewFrame, look: &Look, layer: &Layer) -> Drawable {
    let PartInstance { role, .. } = layer.instance;
    // Of sheets that lie in each other the stamped one is seen, and through a clear crash part both.
    let behind = if visible_parts::crash_opacity(state) < 1.0 {
        Role::Stamped
    } else {
        Role::Crash
    };
    let (push_back, push_back_length) = if layer.is_further() {
        // Where stamped files overlap, the first one is seen.
        let first = state.document.part(role);
        let element = first.map_or(0.0, |part| part.facts.edge_length);
        let share = FURTHER_BACK;
        let length = PUSH_BACK_ELEMENTS * element;
        (share as f32 * PUSH_BACK_PIXELS, share * length)
    } else if role == behind {
        let part = state.document.part(role);
        let element = part.map_or(0.0, |part| part.facts.edge_length);
        (PUSH_BACK_PIXELS, PUSH_BACK_ELEMENTS * element)
    } else {
        (0.0, 0.0)
    };
    let color = if layer.instance.is_ghost {
        look.ghost(role)
    } else {
        surface_color(state, view, look, layer)
    };
    let part = state.document.part(role);
    let part = part.filter(|_| !layer.instance.is_ghost && !layer.is_further());
    let parts = part.map(|part| Arc::from(visible_parts::part_looks(state, part, role, look)));
    Drawable {
        world_from_mesh: layer.instance.world_from_part,
        offset: layer.instance.offset,
        opacity: layer.instance.opacity,
        wipe: layer.instance.wipe,
        style: visible_parts::style(state, view),
        field: layer.field.clone(),
        parts,
        push_back,
        push_back_length,
        sheet: Some(match role {
            Role::Crash => Sheet::First,
            Role::Stamped => Sheet::Second,
        }),
        ..Drawable::new(Arc::clone(&layer.mesh.drawn), color)
    }
}

/// Colour of a part where no field colours it: a stamped file has its own while files are told apart, and a
/// further one is grey beside colours that say something else.
fn surface_color(state: &AppState, view: &ViewFrame, look: &Look, layer: &Layer) -> Rgb {
    let role = layer.role;
    let by = state.color_by(view.window);
    let is_stamped = role == Role::Stamped;
    let is_told = match by {
        ColorBy::MapFile => is_stamped,
        ColorBy::Role | ColorBy::Part => layer.is_further(),
        _ if layer.is_further() => return look.ghost(role),
        _ => false,
    };
    if is_told {
        let value = ColorScale::file_value(layer.instance.number());
        ColorScale::files().color(value)
    } else {
        *look.surfaces.get(role)
    }
}

/// Distance along the ray and what is there.
fn hit_layer(
    layer: &Layer,
    drawable: &Drawable,
    ray: &ViewRay,
    clip: Option<&Plane>,
) -> Option<(f64, Hit)> {
    let pose = &drawable.world_from_mesh;
    let back = pose.inverse();
    let mut origin = back.apply(&(ray.origin - drawable.offset));
    let direction = back.rotate(&ray.direction);
    for _ in 0..MAX_PASSED {
        let hit = layer.mesh.tree().first_hit(&origin, &direction)?;
        let index = layer.mesh.part_of_triangle[hit.triangle as usize];
        let looks = drawable.parts.as_deref().unwrap_or(&[]);
        let look = looks.get(index as usize).copied();
        let point = pose.apply(&hit.point) + drawable.offset;
        let is_cut_away = clip.is_some_and(|plane| plane.distance(&point) > 0.0);
        let value = value_at(layer, &hit);
        let scale = layer.field.as_ref().map(|field| field.scale);
        let is_beyond = value.is_some_and(|value| scale.is_some_and(|scale| scale.hides(value)));
        if look.unwrap_or(PartLook::default()).visible && !is_cut_away && !is_beyond {
            let (node, node_id) = layer.mesh.nearest_node(&hit);
            let part = layer.mesh.part_id(index);
            let is_full = layer.mesh.source.level.is_none();
            let loaded = &layer.mesh.source.part;
            let element = is_full.then(|| loaded.element_id(hit.triangle));
            let shell = is_full.then(|| loaded.ids.element_of(hit.triangle));
            let is_shell = |shell: &u32| (*shell as usize) < loaded.model.shells.len();
            let hit = Hit {
                point,
                role: layer.role,
                in_part: hit.point,
                element: element.flatten(),
                shell: shell.flatten().filter(is_shell),
                // Parts that are chosen and hidden are those of the two decks.
                part: part.filter(|_| !layer.is_further()).map(|id| PartRef {
                    role: layer.role,
                    id,
                }),
                further: layer.instance.further.clone(),
                node: pose.apply(&node) + drawable.offset,
                node_id,
                value,
            };
            return Some(((point - ray.origin).norm(), hit));
        }
        // On past the hidden sheet: rounding is relative to the coordinates.
        let step = 1e-9 * (hit.point.coords.norm() + hit.distance) + f64::MIN_POSITIVE;
        origin = hit.point + direction * (step / direction.norm());
    }
    None
}

/// The field between the corners of the met triangle.
fn value_at(layer: &Layer, hit: &crate::search::RayHit) -> Option<f64> {
    let field = layer.field.as_ref()?;
    let corners = layer.mesh.mesh().triangles()[hit.triangle as usize];
    let values = std::array::from_fn::<f32, 3, _>(|i| {
        let at = if field.is_by_corner {
            3 * hit.triangle as usize + i
        } else {
            corners[i] as usize
        };
        field.values.get(at).copied().unwrap_or(f32::NAN)
    });
    let sum = (0..3)
        .map(|i| f64::from(values[i]) * hit.barycentric[i])
        .sum::<f64>();
    sum.is_finite().then_some(sum)
}
