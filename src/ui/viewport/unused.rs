//! The parts of a deck that are not used for the match, grey and faint around those that are. They are only seen:
//! nothing points at them, fits a camera to them, measures or maps them. The section plane cuts them too.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::frame::ViewFrame;
use super::visible_parts::{GHOST, PartInstance, style};
use crate::app::{AppState, Part};
use crate::formats::Selection;
use crate::geometry::{Plane, Point3, Similarity, TriMesh, Vector3, section};
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::render::{
    COARSE, COARSE_ON_PROCESSOR, Drawable, MeshInput, PartLook, Polyline, RenderMesh, Style,
};
use crate::role::Role;
use crate::ui::background::{Background, Task};
use crate::ui::theme::Look;

/// Whose unused parts: the role and the number of what was read with this choice of parts.
type Key = (Role, u64);

/// Width of their outlines in the section plane.
const LINE: f32 = 1.2;

/// The unused parts of a deck in the unit of its file.
struct Unused {
    drawn: Arc<RenderMesh>,
    mesh: TriMesh,
    /// Index of the part of each triangle in the deck.
    part_of_triangle: Vec<u32>,
}

/// What outlines were cut of.
#[derive(Debug, Clone, PartialEq)]
struct CutKey {
    window: Role,
    of: Key,
    plane: Plane,
    world_from_mesh: Similarity,
    /// Those of the parts of the deck, in its order, that are not hidden.
    visible: Vec<bool>,
}

/// Outlines in the space of the crash model.
pub(super) type Lines = Vec<Vec<Point3>>;

/// The unused parts of the decks as they are drawn, made off the frame.
pub(super) struct UnusedStore {
    background: Background<Key, Option<Unused>>,
    /// Nothing where no triangle can be drawn.
    ready: Vec<(Key, Option<Arc<Unused>>)>,
    n_coarse: usize,
    cutting: Background<CutKey, Lines>,
    /// The newest outlines of each window and role.
    cuts: BTreeMap<(Role, Role), (CutKey, Arc<Lines>)>,
}

impl UnusedStore {
    /// `is_on_processor`: a software driver draws them.
    pub fn new(is_on_processor: bool) -> Self {
        Self {
            background: Background::new("unused parts"),
            ready: Vec::new(),
            n_coarse: if is_on_processor {
                COARSE_ON_PROCESSOR
            } else {
                COARSE
            },
            cutting: Background::new("sections of unused parts"),
            cuts: BTreeMap::new(),
        }
    }

    /// The unused parts around those that a window shows, once they are made.
    pub fn drawables(
        &mut self,
        (state, view): (&AppState, &ViewFrame),
        look: &Look,
        shown: &[PartInstance],
        wake: &egui::Context,
    ) -> Vec<Drawable> {
        self.ready.retain(|((role, revision), _)| {
            let part = state.document.part(*role);
            part.is_some_and(|part| part.revision == *revision)
        });
        let around = around(state, shown);
        self.make(view.window, &around, wake);
        self.cut(view.window, state, &around, wake);
        let style = Style {
            element_edges: false,
            points: false,
            ..style(state, view)
        };
        let drawn = around.into_iter().filter_map(|(instance, part)| {
            let unused = self.found((instance.role, part.revision))?;
            Some(Drawable {
                world_from_mesh: world_from_deck(instance, part),
                offset: instance.offset,
                opacity: GHOST,
                wipe: instance.wipe,
                style,
                parts: Some(looks(part)),
                ..Drawable::new(Arc::clone(&unused.drawn), look.ghost(instance.role))
            })
        });
        drawn.collect()
    }

    /// Asks for what is not there yet.
    fn make(&mut self, window: Role, around: &[(&PartInstance, &Part)], wake: &egui::Context) {
        let mut wanted: Vec<Task<Key, Option<Unused>>> = Vec::new();
        for (instance, part) in around {
            let key = (instance.role, part.revision);
            let is_known = self.ready.iter().any(|(of, _)| *of == key);
            if is_known || wanted.iter().any(|task| task.key == key) {
                continue;
            }
            let (ids, n_coarse) = (part.unused().collect(), self.n_coarse);
            let loaded = part.loaded.to_arc();
            wanted.push(Task {
                key,
                work: Box::new(move || Unused::new(&loaded, ids, n_coarse)),
            });
        }
        for (key, mesh) in self.background.exchange(window, wanted, wake) {
            self.ready.push((key, mesh.flatten().map(Arc::new)));
        }
    }

    fn found(&self, key: Key) -> Option<&Arc<Unused>> {
        let (_, unused) = self.ready.iter().find(|(of, _)| *of == key)?;
        unused.as_ref()
    }

    /// Asks for the outlines in the section plane that are not there yet.
    fn cut(
        &mut self,
        window: Role,
        state: &AppState,
        around: &[(&PartInstance, &Part)],
        wake: &egui::Context,
    ) {
        let plane = state.inspect.section.shown();
        self.cuts.retain(|(of, role), _| {
            let is_shown = around.iter().any(|(instance, _)| instance.role == *role);
            plane.is_some() && (*of != window || is_shown)
        });
        let mut wanted = Vec::new();
        for (instance, part) in around {
            let of = (instance.role, part.revision);
            let (Some(plane), Some(unused)) = (plane, self.found(of)) else {
                continue;
            };
            let parts = part.loaded.model.parts.iter();
            let key = CutKey {
                window,
                of,
                plane,
                world_from_mesh: world_from_deck(instance, part),
                visible: parts.map(|part_of| part.is_visible(part_of.id)).collect(),
            };
            let last = self.cuts.get(&(window, instance.role));
            if last.is_none_or(|(of, _)| *of != key) {
                let (unused, cut) = (Arc::clone(unused), key.clone());
                let work = Box::new(move || unused.outlines(&cut));
                wanted.push(Task { key, work });
            }
        }
        for (key, lines) in self.cutting.exchange(window, wanted, wake) {
            let place = (key.window, key.of.0);
            self.cuts
                .insert(place, (key, Arc::new(lines.unwrap_or_default())));
        }
    }

    /// The outlines of the unused parts in the section plane as a window shows them, thin and grey.
    pub fn outlines(&self, window: Role, look: &Look, shown: &[PartInstance]) -> Vec<Polyline> {
        let mut drawn = Vec::new();
        for ((of, role), (_, lines)) in &self.cuts {
            let instance = shown.iter().find(|instance| instance.role == *role);
            let Some(instance) = instance.filter(|_| *of == window) else {
                continue;
            };
            let [red, green, blue] = look.ghost(*role);
            let moved = |line: &Vec<Point3>| -> Vec<Point3> {
                let offset: &Vector3 = &instance.offset;
                line.iter().map(|point| point + offset).collect()
            };
            let line = |line| Polyline::new(moved(line), [red, green, blue, 255], LINE);
            drawn.extend(lines.iter().map(line));
        }
        drawn
    }

    /// The outlines that are laid flat: those of the window that shows both parts before those of the other.
    pub fn flat(&self) -> Vec<(Role, Arc<Lines>)> {
        let newest = |role| {
            let windows = [Role::Crash, Role::Stamped].into_iter();
            let found = windows
                .filter_map(|window| self.cuts.get(&(window, role)))
                .next()?;
            Some((role, Arc::clone(&found.1)))
        };
        Role::ALL.into_iter().filter_map(newest).collect()
    }

    /// True while they are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting() || self.cutting.is_waiting()
    }
}

/// The parts around which unused ones are shown.
fn around<'a>(state: &'a AppState, shown: &'a [PartInstance]) -> Vec<(&'a PartInstance, &'a Part)> {
    let is_on = state.view.display.has_unused;
    let around = shown.iter().filter(|instance| {
        let part = state.document.part(instance.role);
        is_on && instance.further.is_none() && part.is_some_and(Part::has_unused)
    });
    around
        .filter_map(|instance| Some((instance, state.document.part(instance.role)?)))
        .collect()
}

/// From the unit of its file to where a window shows a deck.
fn world_from_deck(instance: &PartInstance, part: &Part) -> Similarity {
    let in_crash_unit = Similarity::from_scale(part.length_factor());
    instance.world_from_part.after(&in_crash_unit)
}

impl Unused {
    /// Some parts of a deck. O(elements).
    fn new(part: &LoadedPart, ids: Vec<u64>, n_coarse: usize) -> Option<Self> {
        let selection = Selection::Parts(ids);
        let surface = part.model.build_surface(&selection, &Monitor::silent());
        let surface = surface.ok()?;
        let drawn = RenderMesh::new(MeshInput {
            mesh: &surface.mesh,
            part_of_triangle: Some(&surface.triangle_part),
            element_of_triangle: Some(&surface.triangle_element),
            n_coarse,
        });
        Some(Self {
            drawn: Arc::new(drawn),
            mesh: surface.mesh,
            part_of_triangle: surface.triangle_part,
        })
    }

    /// The outlines of the parts that are not hidden. O(triangles).
    fn outlines(&self, key: &CutKey) -> Lines {
        let mesh_from_world = key.world_from_mesh.inverse();
        let plane = Plane::new(
            mesh_from_world.apply(&key.plane.point),
            &mesh_from_world.rotate(&key.plane.normal),
        );
        let is_visible = |triangle: u32| {
            let part = self.part_of_triangle.get(triangle as usize);
            part.and_then(|&part| key.visible.get(part as usize))
                .copied()
                .unwrap_or(true)
        };
        let mut lines = Lines::new();
        for line in section(&self.mesh, &plane) {
            let mut points = line.points;
            points
                .iter_mut()
                .for_each(|point| *point = key.world_from_mesh.apply(point));
            if line.is_closed {
                points.extend(points.first().copied());
            }
            let mut run = Vec::new();
            for (piece, &triangle) in points.windows(2).zip(&line.triangles) {
                if is_visible(triangle) {
                    let is_first = run.is_empty();
                    run.extend(piece.iter().skip(usize::from(!is_first)));
                } else if !run.is_empty() {
                    lines.push(std::mem::take(&mut run));
                }
            }
            lines.push(run);
        }
        lines.retain(|line| !line.is_empty());
        lines
    }
}

/// What the user hid stays hidden.
fn looks(part: &Part) -> Arc<[PartLook]> {
    let parts = part.loaded.model.parts.iter();
    let look = |visible| PartLook {
        visible,
        ..PartLook::default()
    };
    parts.map(|of| look(part.is_visible(of.id))).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::time::{Duration, Instant};

    use super::*;
    use crate::formats::Model;
    use crate::geometry::{Camera, Point3, TriMesh};
    use crate::jobs::{PartFacts, PartSource};
    use crate::pipeline::load::{LoadSettings, prepare};
    use crate::ui::viewport::visible_parts::visible_parts;

    /// A crash deck in metres with the parts 1 and 2, a triangle each, of which one is used.
    fn with_neighbour() -> AppState {
        let corner = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let corners = [0.0, 10.0].map(|x| [corner(x, 0.0), corner(x + 4.0, 0.0), corner(x, 3.0)]);
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let mesh = TriMesh::new(corners.concat(), triangles).unwrap();
        let mut model = Model::from_mesh(&mesh, "used");
        let mut second = model.parts[0].clone();
        model.parts[0].id = 1;
        second.id = 2;
        model.parts.push(second);
        model.shells[1].part = 1;
        let (path, monitor) = (Path::new("deck.k"), Monitor::silent());
        let settings = LoadSettings {
            selection: Selection::Parts(vec![1]),
            length_factor: 1000.0,
            ..LoadSettings::default()
        };
        let part = prepare(path, Arc::new(model), &settings, &monitor).unwrap();
        let facts = PartFacts::of(&part, &monitor).unwrap();
        let source = PartSource::File(path.to_path_buf());
        let part = Part::new(Arc::new(part), Arc::new(facts), source, 1);
        let mut state = AppState::default();
        state.document.parts.crash = Some(part);
        state
    }

    fn crash_window() -> ViewFrame {
        ViewFrame {
            window: Role::Crash,
            camera: Camera::default(),
            aspect: 1.0,
            pose: Similarity::identity(),
            over: 0.0,
            is_bare: false,
        }
    }

    /// Draws until all that was asked for is there.
    fn wait(store: &mut UnusedStore, draw: impl Fn(&mut UnusedStore)) {
        let begin = Instant::now();
        while store.is_waiting() {
            assert!(begin.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(1));
            draw(store);
        }
    }

    #[test]
    fn unused_parts_are_drawn_on_request_faint_and_where_they_lie() {
        let mut state = with_neighbour();
        let mut store = UnusedStore::new(true);
        let (look, ctx) = (Look::of(true), egui::Context::default());
        let view = crash_window();
        let mut drawn = |state: &AppState| {
            let shown = visible_parts(state, &view);
            assert_eq!(shown.len(), 1);
            store.drawables((state, &view), &look, &shown, &ctx);
            wait(&mut store, |store| {
                store.drawables((state, &view), &look, &shown, &ctx);
            });
            store.drawables((state, &view), &look, &shown, &ctx)
        };
        assert_eq!(drawn(&state).len(), 0);
        state.view.display.has_unused = true;
        let [unused] = &drawn(&state)[..] else {
            panic!("no neighbour");
        };
        let [red, green, blue] = unused.color;
        assert!(red == green && green == blue && unused.opacity <= GHOST);
        assert!(unused.field.is_none() && unused.sheet.is_none());
        let bounds = unused.bounds();
        assert!((bounds.min.x - 10_000.0).abs() < 1.0 && (bounds.max.x - 14_000.0).abs() < 1.0);
        // One that is hidden stays so.
        let crash = state.document.parts.crash.as_mut().expect("loaded");
        crash.hidden.insert(2);
        let [unused] = &drawn(&state)[..] else {
            panic!("no neighbour");
        };
        let parts = unused.parts.as_ref().expect("looks");
        assert!(parts[0].visible && !parts[1].visible);
    }

    /// The plane y = 1 meets the neighbour, a triangle from (10, 0) to (14, 0) and (10, 3), along a line.
    #[test]
    fn the_section_cuts_unused_parts_that_are_shown_and_not_hidden() {
        let mut state = with_neighbour();
        let mut store = UnusedStore::new(true);
        let (look, ctx) = (Look::of(true), egui::Context::default());
        let view = crash_window();
        let mut cut = |state: &AppState| {
            let shown = visible_parts(state, &view);
            // The outlines are asked for once the mesh is there.
            for _ in 0..2 {
                store.drawables((state, &view), &look, &shown, &ctx);
                wait(&mut store, |store| {
                    store.drawables((state, &view), &look, &shown, &ctx);
                });
            }
            (store.outlines(Role::Crash, &look, &shown), store.flat())
        };
        let middle = Point3::new(5000.0, 1000.0, 0.0);
        let plane = Plane::new(middle, &Vector3::y());
        state.inspect.section.plane = Some(plane);
        state.inspect.section.is_on = true;
        assert!(cut(&state).0.is_empty());
        state.view.display.has_unused = true;
        let (lines, flat) = cut(&state);
        let [line] = &lines[..] else {
            panic!("{} lines", lines.len());
        };
        let mut ends = [line.points[0].x, line.points[1].x];
        ends.sort_by(f64::total_cmp);
        assert!(
            (ends[0] - 10_000.0).abs() < 1e-6 && ends[1] > 12_000.0,
            "{ends:?}"
        );
        let [red, green, blue, _] = line.color;
        assert!(red == green && green == blue && line.width < 2.0);
        let n_flat: usize = flat.iter().map(|(_, lines)| lines.len()).sum();
        assert_eq!((n_flat, flat[0].0), (1, Role::Crash));
        let crash = state.document.parts.crash.as_mut().expect("loaded");
        crash.hidden.insert(2);
        assert!(cut(&state).0.is_empty());
    }
}
