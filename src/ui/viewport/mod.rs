//! The two 3D windows: crash left, stamped right. They draw what the state says and turn mouse and
//! keys into commands.

mod background;
mod cast;
mod gpu;
mod look;
mod meshes;
mod motion;
mod navigation;
mod overlay;
mod stage;

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::{EventFilter, Rect, Response, Sense, Ui, WidgetInfo};

use crate::app::{AppState, Command, PartCommand, PartRef, ViewCommand};
use crate::geometry::{Camera, Point3};
use crate::jobs::{PerRole, Role};
use cast::Stage;
use gpu::{Gpu, ViewCallback};
use look::Look;
use meshes::{MeshSource, MeshStore, ShownMesh};
use motion::{Crossing, SmoothCamera, SmoothPose};
use navigation::{Navigator, View};
use stage::{Hit, Layer, Picture};

/// The 3D windows with everything they remember between frames.
pub struct Viewports {
    render_state: Option<RenderState>,
    meshes: MeshStore,
    crossing: Crossing,
    pose: SmoothPose,
    windows: PerRole<Window>,
}

/// What one window remembers.
#[derive(Default)]
struct Window {
    camera: SmoothCamera,
    navigator: Navigator,
    /// The meshes that were drawn last, shown until newer ones are ready.
    shown: PerRole<Option<Arc<ShownMesh>>>,
    /// The part that was told to be under the pointer.
    hovered: Option<PartRef>,
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
        let stage = self.stage(ui, role, state, rect);
        let picture = self.picture(ui, &stage, state, &look);
        self.tell_window(&response, role, state, commands);
        let camera = self.navigate(ui, &response, state, &stage, &picture, commands);
        let stage = Stage { camera, ..stage };
        self.paint(ui, rect, &stage, &picture, &look);
        let hit = self.point(ui, &response, state, &stage, &picture, commands);
        let view = overlay::Overlay {
            rect,
            look: &look,
            state,
            stage: &stage,
            picture: &picture,
            drag: self.windows.get(role).navigator.drag(),
            hit: hit.as_ref(),
            is_focused: response.has_focus(),
        };
        overlay::show(ui, &view, commands);
        self.keep_moving(ui, role);
    }

    /// Cameras and poses as they are shown in this frame.
    fn stage(&mut self, ui: &Ui, role: Role, state: &AppState, rect: Rect) -> Stage {
        let now = ui.input(|i| i.time);
        let may_move = !state.settings.reduce_motion;
        let center = state.document.part(Role::Stamped).map(|part| part.bounds());
        let center = center
            .filter(|b| !b.is_empty())
            .map_or(Point3::origin(), |b| b.center());
        // What the hand or the running match moves must not lag behind.
        let is_driven = state.live_pose.is_some()
            || state.view.move_tool.is_some()
            || state.view.scrubbed_iteration.is_some()
            || ui.input(|i| i.pointer.any_down());
        let pose = state.shown_pose();
        let pose = self
            .pose
            .follow(&pose, &center, now, may_move && !is_driven);
        let over = self
            .crossing
            .follow(state.view.is_moved_over, now, may_move);
        let is_linked_drag =
            state.view.are_linked && self.windows.get(role.other()).navigator.drag().is_some();
        let window = self.windows.get_mut(role);
        let may_fly = may_move && window.has_picture && !is_linked_drag;
        Stage {
            window: role,
            camera: window
                .camera
                .follow(state.view.cameras.get(role), now, may_fly),
            aspect: f64::from(rect.width() / rect.height()),
            pose,
            over,
        }
    }

    /// The window's scene, from the meshes that are ready.
    fn picture(&mut self, ui: &Ui, stage: &Stage, state: &AppState, look: &Look) -> Picture {
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
        let layers = ready
            .into_iter()
            .zip(actors)
            .filter_map(|(mesh, (part, actor))| {
                let last = shown.get_mut(actor.role);
                if mesh.is_some() {
                    last.clone_from(&mesh);
                }
                let is_same_part =
                    |mesh: &&Arc<ShownMesh>| Arc::ptr_eq(&mesh.source.part, &part.loaded.to_arc());
                let mesh = mesh.or_else(|| last.as_ref().filter(is_same_part).cloned())?;
                Some(Layer {
                    role: actor.role,
                    mesh,
                    field: None,
                    actor,
                })
            });
        let layers = layers.collect();
        Picture::new(state, stage, look, layers, ui.pixels_per_point())
    }

    /// Tells the state what it needs to know about the window.
    fn tell_window(
        &mut self,
        response: &Response,
        role: Role,
        state: &AppState,
        commands: &mut Vec<Command>,
    ) {
        let aspect = f64::from(response.rect.width() / response.rect.height());
        if (*state.view.aspects.get(role) - aspect).abs() > 1e-3 {
            commands.push(ViewCommand::SetAspect(role, aspect).into());
        }
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
            let memory = |m: &mut egui::Memory| m.set_focus_lock_filter(response.id, filter);
            response.ctx.memory_mut(memory);
        }
    }

    /// The camera after this frame's input.
    fn navigate(
        &mut self,
        ui: &Ui,
        response: &Response,
        state: &AppState,
        stage: &Stage,
        picture: &Picture,
        commands: &mut Vec<Command>,
    ) -> Camera {
        let role = stage.window;
        let view = View {
            rect: response.rect,
            camera: stage.camera,
            picture,
            pivot: *state.view.pivot.get(role),
            style: state.view.orbit_style,
            scheme: state.settings.mouse,
        };
        let window = self.windows.get_mut(role);
        window.has_picture = !picture.is_empty();
        match window.navigator.update(ui, response, &view, false) {
            Some(camera) => {
                window.camera.jump(camera);
                commands.push(ViewCommand::SetCamera(role, camera).into());
                camera
            }
            None => stage.camera,
        }
    }

    fn paint(&self, ui: &Ui, rect: Rect, stage: &Stage, picture: &Picture, look: &Look) {
        if self.render_state.is_none() {
            overlay::placeholder(ui, rect, look);
            return;
        }
        let callback = ViewCallback {
            role: stage.window,
            scene: Arc::clone(&picture.scene),
            camera: stage.camera,
            rect,
        };
        ui.painter_at(rect).add(callback.shape());
    }

    /// Hovering and selecting.
    fn point(
        &mut self,
        ui: &Ui,
        response: &Response,
        state: &AppState,
        stage: &Stage,
        picture: &Picture,
        commands: &mut Vec<Command>,
    ) -> Option<Hit> {
        let role = stage.window;
        let window = self.windows.get_mut(role);
        let is_dragged = window.navigator.drag().is_some();
        let pos = response.hover_pos().filter(|_| !is_dragged);
        let screen = navigation::screen_of(response.rect);
        let at = |pos| navigation::pixel_of(response.rect, pos);
        let hit = pos.and_then(|pos| picture.hit(&stage.camera, at(pos), screen));
        let part = hit.as_ref().and_then(|hit| hit.part);
        if !is_dragged && window.hovered != part {
            window.hovered = part;
            commands.push(PartCommand::Hover(part).into());
        }
        if response.clicked() {
            let is_toggled = ui.input(|i| i.modifiers.command) && state.view.selected == part;
            let selected = part.filter(|_| !is_toggled);
            commands.push(PartCommand::Select(selected).into());
        }
        if response.double_clicked() {
            commands.push(PartCommand::Select(part).into());
            commands.push(ViewCommand::Focus(role).into());
        }
        hit
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
        Role::Stamped if state.view.is_moved_over => ", moved to the left window",
        _ => "",
    };
    format!("{name}, {n} triangles{with}")
}
