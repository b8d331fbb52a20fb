//! The two 3D windows: crash left, stamped right. They draw what the state says and turn mouse and
//! keys into commands.

pub(in crate::ui) mod background;
mod cast;
mod fields;
mod gpu;
mod look;
mod meshes;
mod motion;
mod navigation;
mod overlay;
mod picking;
mod pointing;
mod sections;
mod snapshot;
mod stage;
mod tools;

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::{EventFilter, Rect, Response, Sense, Ui, WidgetInfo};

use crate::app::{AppState, Command, Preview, StampedPose, ViewCommand};
use crate::geometry::{Camera, Point3, Rotation};
use crate::jobs::{PerRole, Role};
use cast::Stage;
use fields::{FieldKind, FieldStore};
use gpu::{Gpu, ViewCallback};
use look::Look;
pub use look::part_color;
use meshes::{MeshSource, MeshStore, ShownMesh};
use motion::{Crossing, SmoothCamera, SmoothPose};
use navigation::{Navigator, View};
pub use overlay::free_choice;
use picking::Picker;
use pointing::{Pointing, Target};
use sections::SectionStore;
use snapshot::Shot;
use stage::{Layer, Picture};
use tools::{Bench, Tools};

/// A pair smaller than this share of the picture's height is fitted again when its pose changes.
const SMALL: f64 = 0.4;
/// A part that turned by more is looked at anew, radians.
const LARGE_TURN: f64 = 0.35;

/// The 3D windows with everything they remember between frames.
pub struct Viewports {
    render_state: Option<RenderState>,
    meshes: MeshStore,
    fields: FieldStore,
    sections: SectionStore,
    crossing: Crossing,
    pose: SmoothPose,
    windows: PerRole<Window>,
}

/// What one window remembers.
#[derive(Default)]
struct Window {
    camera: SmoothCamera,
    navigator: Navigator,
    tools: Tools,
    pointing: Pointing,
    /// The meshes that were drawn last, shown until newer ones are ready.
    shown: PerRole<Option<Arc<ShownMesh>>>,
    /// Revision of the part that was shown last.
    known_part: u64,
    /// The pose the camera has followed the part to.
    followed: StampedPose,
    /// The project whose cameras were taken over last.
    known_restored: u64,
    /// A project was opened just now: everything is where it belongs at once.
    is_restored: bool,
    /// What was drawn last, for pictures in files.
    shot: Option<Shot>,
    has_picture: bool,
}

impl Viewports {
    /// Compiles the shaders. Without a render state (tests of logic) pictures are left out and a
    /// text stands in their place.
    pub fn new(render_state: Option<&RenderState>) -> Self {
        if let Some(render_state) = render_state {
            Gpu::install(render_state);
        }
        Self {
            render_state: render_state.cloned(),
            meshes: MeshStore::new(),
            fields: FieldStore::new(),
            sections: SectionStore::new(),
            crossing: Crossing::default(),
            pose: SmoothPose::default(),
            windows: PerRole::default(),
        }
    }

    /// Shows one window in the rest of `ui`.
    pub fn show(&mut self, ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
        let rect = ui.available_rect_before_wrap();
        ui.advance_cursor_after_rect(rect);
        if rect.width() < 1.0 || rect.height() < 1.0 {
            return;
        }
        let id = ui.make_persistent_id(("viewport", role.word()));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, summary(state, role)));
        let look = Look::of(ui.visuals().dark_mode);
        let window = self.windows.get_mut(role);
        window.notice_restored(role, state);
        window.tell_aspect(rect, role, state, commands);
        tell_focus(&response, state.camera_of(role), state, commands);
        let stage = self.stage(ui, role, state, rect, commands);
        let picture = self.picture_of(ui, &stage, state, &look);
        let frame = InFrame {
            response: &response,
            state,
            stage: &stage,
            picture: &picture,
            look: &look,
        };
        let camera = self.navigate(ui, &frame, commands);
        let stage = Stage { camera, ..stage };
        let frame = InFrame {
            stage: &stage,
            ..frame
        };
        self.paint(ui, &frame);
        self.interact(ui, &frame, commands);
        self.keep_moving(ui, role);
    }

    /// True while the stamped part flies from one window to the other.
    pub fn is_crossing(&self, now: f64) -> bool {
        self.crossing.is_moving(now)
    }

    /// True while meshes or colours are being made that a window wants to show. For tests and
    /// pictures that must not be taken too early.
    pub fn is_waiting(&self) -> bool {
        self.meshes.is_waiting() || self.fields.is_waiting() || self.sections.is_waiting()
    }

    /// Cameras and poses as they are shown in this frame.
    fn stage(
        &mut self,
        ui: &Ui,
        role: Role,
        state: &AppState,
        rect: Rect,
        commands: &mut Vec<Command>,
    ) -> Stage {
        let now = ui.input(|i| i.time);
        let may_move = !state.settings.reduce_motion && !self.windows.get(role).is_restored;
        let bounds = state.document.part(Role::Stamped).map(|part| part.bounds());
        let bounds = bounds.filter(|bounds| !bounds.is_empty());
        let center = bounds.map_or(Point3::origin(), |bounds| bounds.center());
        // What the hand or the running match moves must not lag behind.
        let is_driven = state.live_pose.is_some()
            || state.view.move_tool.is_some()
            || matches!(state.preview(), Some(Preview::Step { .. }))
            || self
                .windows
                .iter()
                .any(|(_, window)| window.tools.is_moving());
        let may_glide = may_move && !is_driven;
        let pose = self
            .pose
            .follow(&state.shown_pose(), &center, now, may_glide);
        let over = self
            .crossing
            .follow(state.view.is_moved_over, now, may_move);
        let is_linked = state.view.are_linked || state.view.is_moved_over;
        let is_linked_drag = is_linked && self.windows.get(role.other()).navigator.drag().is_some();
        let window = self.windows.get_mut(role);
        // A part that flies away is seen by its own camera to the end.
        let of = if over < 1.0 {
            role
        } else {
            state.camera_of(role)
        };
        let mut camera = *state.view.cameras.get(of);
        if role == Role::Crash {
            window.fit_pair(state, is_driven, commands);
        }
        match window.follow_part(role, state, rect, is_driven) {
            Some(Following::Carried(followed)) => {
                camera = followed;
                if !self.pose.is_moving(now) {
                    // The part is there already; a flight would lose it from sight.
                    window.camera.jump(camera);
                }
                commands.push(ViewCommand::SetCamera(role, camera).into());
            }
            Some(Following::Beside(turned)) => {
                commands.push(ViewCommand::SetCamera(role, turned).into());
                commands.push(ViewCommand::FitAll(role).into());
            }
            None => {}
        }
        let may_fly = may_move && window.has_picture && !is_linked_drag;
        Stage {
            window: role,
            camera: window.camera.follow(&camera, now, may_fly),
            aspect: f64::from(rect.width() / rect.height()),
            pose,
            over,
            is_bare: window.navigator.drag().is_some_and(|drag| drag.is_bare),
        }
    }

    /// The window's scene, from the meshes that are ready.
    fn picture_of(&mut self, ui: &Ui, stage: &Stage, state: &AppState, look: &Look) -> Picture {
        let actors: Vec<_> = cast::cast(state, stage)
            .into_iter()
            .filter_map(|actor| Some((state.document.part(actor.role)?, actor)))
            .collect();
        let sources: Vec<_> = actors
            .iter()
            .map(|(part, actor)| MeshSource::of(part, actor.is_detailed))
            .collect();
        let ready = self.meshes.get(stage.window, &sources, ui.ctx());
        let shown = &mut self.windows.get_mut(stage.window).shown;
        let drawn = ready
            .into_iter()
            .zip(actors)
            .filter_map(|(mesh, (part, actor))| {
                let last = shown.get_mut(actor.role);
                if mesh.is_some() {
                    last.clone_from(&mesh);
                }
                let loaded = part.loaded.to_arc();
                let is_same_part = |mesh: &&Arc<ShownMesh>| Arc::ptr_eq(&mesh.source.part, &loaded);
                let mesh = mesh.or_else(|| last.as_ref().filter(is_same_part).cloned())?;
                Some((mesh, actor))
            });
        let drawn: Vec<_> = drawn.collect();
        let meshes: Vec<_> = drawn
            .iter()
            .map(|(mesh, actor)| (actor.role, Arc::clone(mesh)))
            .collect();
        let placed: Vec<_> = drawn
            .iter()
            .map(|(mesh, actor)| (actor.role, Arc::clone(mesh), actor.world_from_part))
            .collect();
        self.sections.update(stage.window, state, &placed, ui.ctx());
        let cuts = self.sections.cuts(state);
        let fields = self.fields.get(stage.window, state, &meshes, ui.ctx());
        let layers = drawn
            .into_iter()
            .zip(fields)
            .map(|((mesh, actor), field)| Layer {
                role: actor.role,
                mesh,
                field,
                wants_field: fields::is_wanted(state, stage.window, actor.role),
                actor,
            });
        let layers = layers.collect();
        let mut picture = Picture::new(state, stage, look, layers, ui.pixels_per_point());
        picture.cut(state, stage, look, &cuts);
        picture
    }

    /// The camera after this frame's input.
    fn navigate(&mut self, ui: &Ui, frame: &InFrame<'_>, commands: &mut Vec<Command>) -> Camera {
        let InFrame {
            response,
            state,
            stage,
            picture,
            ..
        } = *frame;
        let role = stage.window;
        let camera_of = state.camera_of(role);
        let view = View {
            rect: response.rect,
            camera: stage.camera,
            picture,
            pivot: *state.view.pivot.get(camera_of),
            style: state.view.orbit_style,
            scheme: state.settings.mouse,
        };
        let window = self.windows.get_mut(role);
        window.has_picture = !picture.is_empty();
        let is_left_taken = window.tools.takes_left();
        match window.navigator.update(ui, response, &view, is_left_taken) {
            Some(camera) => {
                window.camera.jump(camera);
                commands.push(ViewCommand::SetCamera(camera_of, camera).into());
                camera
            }
            None => stage.camera,
        }
    }

    fn paint(&mut self, ui: &Ui, frame: &InFrame<'_>) {
        let rect = frame.response.rect;
        if self.render_state.is_none() {
            overlay::placeholder(ui, rect, frame.look);
            return;
        }
        let role = frame.stage.window;
        let callback = ViewCallback {
            role,
            scene: Arc::clone(&frame.picture.scene),
            camera: frame.stage.camera,
            rect,
        };
        let size = rect.size() * ui.pixels_per_point();
        self.windows.get_mut(role).shot = Some(Shot {
            scene: Arc::clone(&frame.picture.scene),
            camera: frame.stage.camera,
            size: [size.x.round() as u32, size.y.round() as u32],
        });
        ui.painter_at(rect).add(callback.shape());
    }

    /// Tools, pointing, and what lies over the picture.
    fn interact(&mut self, ui: &mut Ui, frame: &InFrame<'_>, commands: &mut Vec<Command>) {
        let InFrame {
            response,
            state,
            stage,
            picture,
            look,
        } = *frame;
        let window = self.windows.get_mut(stage.window);
        let bench = Bench {
            ui,
            response,
            state,
            stage,
        };
        window.tools.update(&bench, commands);
        let target = Target {
            ui,
            response,
            state,
            stage,
            picture,
            is_busy: window.navigator.drag().is_some() || window.tools.takes_left(),
        };
        let hit = window.pointing.update(&target, commands);
        let picker = Picker {
            response,
            state,
            camera: &stage.camera,
            picture,
            window: stage.window,
            is_busy: target.is_busy || state.view.move_tool.is_some(),
        };
        let pick = picker.update(commands);
        window.tools.paint(&bench);
        let kind = FieldKind::of(state.color_by(stage.window));
        let view = overlay::Overlay {
            rect: response.rect,
            look,
            state,
            stage,
            picture,
            drag: window.navigator.drag(),
            hit: hit.as_ref(),
            cuts: &self.sections.cuts(state),
            scale: kind.and_then(|kind| Some((kind, self.fields.scale(stage.window, state)?))),
            kind,
            hint: window.tools.hint(state),
            pick,
            is_focused: response.has_focus(),
            is_hovered: response.contains_pointer(),
            is_preparing: is_preparing(state, stage, picture),
        };
        overlay::show(ui, &view, commands);
    }

    fn keep_moving(&self, ui: &Ui, role: Role) {
        let now = ui.input(|i| i.time);
        let is_moving = self.windows.get(role).camera.is_moving(now)
            || self.crossing.is_moving(now)
            || self.pose.is_moving(now);
        if is_moving {
            ui.ctx().request_repaint();
        }
    }
}

/// What a window shows in one frame.
#[derive(Clone, Copy)]
struct InFrame<'a> {
    response: &'a Response,
    state: &'a AppState,
    stage: &'a Stage,
    picture: &'a Picture,
    look: &'a Look,
}

impl Window {
    /// A project brings its own cameras: parts and pose that came with it are neither fitted nor
    /// followed.
    fn notice_restored(&mut self, role: Role, state: &AppState) {
        let n_restored = state.view.n_restored;
        self.is_restored = std::mem::replace(&mut self.known_restored, n_restored) != n_restored;
        if self.is_restored {
            self.known_part = state.document.part(role).map_or(0, |part| part.revision);
            self.followed = state.document.pose;
        }
    }

    /// Tells the state how wide the window is. A part that was fitted before that was known is fitted
    /// again.
    fn tell_aspect(
        &mut self,
        rect: Rect,
        role: Role,
        state: &AppState,
        commands: &mut Vec<Command>,
    ) {
        let revision = state.document.part(role).map_or(0, |part| part.revision);
        let is_new = std::mem::replace(&mut self.known_part, revision) != revision;
        let aspect = f64::from(rect.width() / rect.height());
        if (*state.view.aspects.get(role) - aspect).abs() > 1e-3 {
            commands.push(ViewCommand::SetAspect(role, aspect).into());
            if is_new {
                commands.push(ViewCommand::FitAll(role).into());
            }
        }
    }

    /// A match may take the stamped part far away or turn it over. Then both windows show the parts
    /// from the same side. Where another step does so, the camera goes with the part, so that it looks
    /// as it did.
    fn follow_part(
        &mut self,
        role: Role,
        state: &AppState,
        rect: Rect,
        is_driven: bool,
    ) -> Option<Following> {
        let pose = state.document.pose;
        let is_alone = role == Role::Stamped && !state.view.is_moved_over;
        if !is_alone || is_driven || pose.revision == self.followed.revision {
            return None;
        }
        let before = std::mem::replace(&mut self.followed, pose);
        let center = state.document.stamped_center()?;
        let camera = *state.view.cameras.get(role);
        let seen = navigation::pos_of(rect, &camera, &center);
        let is_inside = seen.is_some_and(|at| rect.shrink2(rect.size() * 0.2).contains(at));
        let turn = before.crash_from_stamped.angle_to(&pose.crash_from_stamped);
        if is_inside && turn < LARGE_TURN {
            None
        } else if state.document.current_result().is_some() {
            let side = state.view.cameras.crash.world_from_view;
            Some(Following::Beside(Camera {
                world_from_view: side,
                ..camera
            }))
        } else if state.view.are_linked {
            // Turning the camera would turn the other window's too.
            Some(Following::Beside(camera))
        } else {
            Some(Following::Carried(carried(&camera, &before, &pose)))
        }
    }

    /// Two parts that came together out of a great distance are small in the picture: fits it again.
    fn fit_pair(&mut self, state: &AppState, is_driven: bool, commands: &mut Vec<Command>) {
        let pose = state.document.pose;
        if !state.view.is_moved_over || is_driven || pose.revision == self.followed.revision {
            return;
        }
        self.followed = pose;
        let size = state.visible_bounds(Role::Crash).diagonal();
        if size < SMALL * state.view.cameras.crash.height {
            commands.push(ViewCommand::FitAll(Role::Crash).into());
        }
    }
}

/// How a window's camera takes part in a move of its part.
enum Following {
    /// It goes with the part.
    Carried(Camera),
    /// It looks from here, fitted to the part.
    Beside(Camera),
}

/// The camera that shows a part at its new pose as this one did at the old pose.
fn carried(camera: &Camera, before: &StampedPose, now: &StampedPose) -> Camera {
    let motion = now
        .crash_from_stamped
        .after(&before.crash_from_stamped.inverse());
    let target = motion.apply(&camera.target);
    if motion.is_mirrored() {
        return Camera { target, ..*camera };
    }
    let turn = nalgebra::Rotation3::from_matrix_unchecked(motion.rotation);
    Camera {
        target,
        world_from_view: Rotation::from_rotation_matrix(&turn) * camera.world_from_view,
        height: camera.height * motion.scale,
        ..*camera
    }
}

/// True if the window should show something and nothing of it is ready.
fn is_preparing(state: &AppState, stage: &Stage, picture: &Picture) -> bool {
    picture.is_empty()
        && cast::cast(state, stage)
            .iter()
            .any(|actor| state.document.part(actor.role).is_some())
}

/// Tells the state which window has the keys.
fn tell_focus(response: &Response, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    let is_pressed = response.is_pointer_button_down_on();
    if is_pressed {
        response.request_focus();
    }
    if (is_pressed || response.gained_focus()) && state.view.focus != role {
        commands.push(ViewCommand::SetFocus(role).into());
    }
    if response.has_focus() {
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        let set_filter = |m: &mut egui::Memory| m.set_focus_lock_filter(response.id, filter);
        response.ctx.memory_mut(set_filter);
    }
}

/// What a screen reader says about a window.
fn summary(state: &AppState, role: Role) -> String {
    let name = match role {
        Role::Crash => "Crash part",
        Role::Stamped => "Stamped part",
    };
    let Some(part) = state.document.part(role) else {
        return format!("{name}, nothing loaded");
    };
    let n = overlay::grouped(part.reduced_mesh().n_triangles());
    let with = match role {
        Role::Crash if state.view.is_moved_over => ", with the stamped part",
        _ => "",
    };
    if let Some(free) = state.free_window().filter(|_| role == Role::Stamped) {
        return format!("{name}, moved to the left window; here: {}", free.label());
    }
    format!("{name}, {n} triangles{with}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::rotation_about;
    use crate::geometry::Vector3;
    use crate::geometry::camera::ScreenSize;

    #[test]
    fn a_carried_camera_shows_the_part_as_before() {
        let pose = |angle| StampedPose {
            crash_from_stamped: rotation_about(
                &Point3::new(500.0, 0.0, 20.0),
                &Vector3::new(1.0, 2.0, -0.5),
                angle,
            ),
            revision: 1,
        };
        let (before, now) = (pose(0.3), pose(2.0));
        let camera = Camera {
            height: 80.0,
            ..Camera::default()
        };
        let carried = carried(&camera, &before, &now);
        let screen = ScreenSize::new(400, 300);
        for point in [Point3::new(3.0, 4.0, 5.0), Point3::new(-20.0, 0.0, 7.0)] {
            let seen = |camera: &Camera, pose: &StampedPose| {
                let at = camera.project(&pose.crash_from_stamped.apply(&point), screen);
                at.map(|at| [at.x, at.y]).unwrap()
            };
            let [old, new] = [seen(&camera, &before), seen(&carried, &now)];
            assert!((old[0] - new[0]).hypot(old[1] - new[1]) < 1e-6);
        }
    }
}
