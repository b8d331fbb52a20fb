//! The parts of a deck that are not used for the match, grey and faint around those that are. They are only seen:
//! nothing points at them, fits a camera to them, measures or maps them.

use std::sync::Arc;

use super::frame::ViewFrame;
use super::visible_parts::{GHOST, PartInstance, style};
use crate::app::{AppState, Part};
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::render::{
    COARSE, COARSE_ON_PROCESSOR, Drawable, MeshInput, PartLook, RenderMesh, Style,
};
use crate::role::Role;
use crate::ui::background::{Background, Task};
use crate::ui::theme::Look;

/// Whose unused parts: the role and the number of what was read with this choice of parts.
type Key = (Role, u64);

/// The unused parts of the decks as they are drawn, made off the frame.
pub(super) struct UnusedStore {
    background: Background<Key, Option<RenderMesh>>,
    /// Nothing where no triangle can be drawn.
    ready: Vec<(Key, Option<Arc<RenderMesh>>)>,
    n_coarse: usize,
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
        let is_on = state.view.display.has_unused;
        let around = shown.iter().filter(|instance| {
            let part = state.document.part(instance.role);
            is_on && instance.further.is_none() && part.is_some_and(Part::has_unused)
        });
        let around: Vec<(&PartInstance, &Part)> = around
            .filter_map(|instance| Some((instance, state.document.part(instance.role)?)))
            .collect();
        self.make(view.window, &around, wake);
        let style = Style {
            element_edges: false,
            points: false,
            ..style(state, view)
        };
        let drawn = around.into_iter().filter_map(|(instance, part)| {
            let key = (instance.role, part.revision);
            let (_, mesh) = self.ready.iter().find(|(of, _)| *of == key)?;
            let in_crash_unit = Similarity::from_scale(part.length_factor());
            Some(Drawable {
                world_from_mesh: instance.world_from_part.after(&in_crash_unit),
                offset: instance.offset,
                opacity: GHOST,
                wipe: instance.wipe,
                style,
                parts: Some(looks(part)),
                ..Drawable::new(Arc::clone(mesh.as_ref()?), look.ghost(instance.role))
            })
        });
        drawn.collect()
    }

    /// Asks for what is not there yet.
    fn make(&mut self, window: Role, around: &[(&PartInstance, &Part)], wake: &egui::Context) {
        let mut wanted: Vec<Task<Key, Option<RenderMesh>>> = Vec::new();
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
                work: Box::new(move || mesh(&loaded, ids, n_coarse)),
            });
        }
        for (key, mesh) in self.background.exchange(window, wanted, wake) {
            self.ready.push((key, mesh.flatten().map(Arc::new)));
        }
    }

    /// True while they are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting()
    }
}

/// Some parts of a deck, in the unit of its file. O(elements).
fn mesh(part: &LoadedPart, ids: Vec<u64>, n_coarse: usize) -> Option<RenderMesh> {
    let selection = Selection::Parts(ids);
    let surface = part.model.build_surface(&selection, &Monitor::silent());
    let surface = surface.ok()?;
    Some(RenderMesh::new(MeshInput {
        mesh: &surface.mesh,
        part_of_triangle: Some(&surface.triangle_part),
        element_of_triangle: Some(&surface.triangle_element),
        n_coarse,
    }))
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

    #[test]
    fn unused_parts_are_drawn_on_request_faint_and_where_they_lie() {
        let mut state = with_neighbour();
        let mut store = UnusedStore::new(true);
        let (look, ctx) = (Look::of(true), egui::Context::default());
        let view = ViewFrame {
            window: Role::Crash,
            camera: Camera::default(),
            aspect: 1.0,
            pose: Similarity::identity(),
            over: 0.0,
            is_bare: false,
        };
        let mut drawn = |state: &AppState| {
            let shown = visible_parts(state, &view);
            assert_eq!(shown.len(), 1);
            store.drawables((state, &view), &look, &shown, &ctx);
            let begin = Instant::now();
            while store.is_waiting() {
                assert!(begin.elapsed() < Duration::from_secs(60));
                std::thread::sleep(Duration::from_millis(1));
                store.drawables((state, &view), &look, &shown, &ctx);
            }
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
}
