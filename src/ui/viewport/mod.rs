//! The two 3D windows: crash left, stamped right. They draw what the state says and turn mouse and
//! keys into commands.

mod coordinates;
mod drawing;
mod fields;
mod frame;
mod gpu;
mod identity;
mod map_fields;
mod meshes;
mod motion;
mod navigation;
mod outlines;
mod overlay;
mod picking;
mod picture;
mod pointing;
mod sections;
mod shape;
mod snapshot;
mod tools;
mod unused;
mod visible_parts;
mod window;

use std::sync::Arc;
use std::time::Duration;

use eframe::egui_wgpu::RenderState;
use egui::{Rect, Sense, Ui, WidgetInfo};

use crate::app::{AppState, Command, Preview, ViewCommand};
use crate::geometry::{Camera, Point3};
use crate::role::{PerRole, Role};
use crate::ui::pictures::is_screen_taken;
use crate::ui::theme::Look;
use fields::{FieldKind, FieldStore};
use frame::{FrameContext, ViewFrame};
use gpu::{Gpu, Stopwatch, Took, Unfinished, ViewCallback};
use meshes::{MeshStore, ShownMesh};
use motion::{Crossing, SmoothPose};
use overlay::FreeRoom;
pub use overlay::free_choice;
use picture::{Layer, Picture};
use sections::SectionStore;
pub use shape::read_points;
use snapshot::LastFrame;
use unused::UnusedStore;
use window::{Following, Window};

/// The 3D windows with everything they remember between frames.
pub struct Viewports {
    render_state: Option<RenderState>,
    meshes: MeshStore,
    unused: UnusedStore,
    fields: FieldStore,
    sections: SectionStore,
    crossing: Crossing,
    pose: SmoothPose,
    windows: PerRole<Window>,
    /// How long the last frame took.
    took: Took,
    unfinished: Unfinished,
}

impl Viewports {
    /// Compiles the shaders. Without a render state (tests of logic) pictures are left out and a
    /// text stands in their place.
    pub fn new(render_state: Option<&RenderState>) -> Self {
        if let Some(render_state) = render_state {
            Gpu::install(render_state);
        }
        let is_on_processor = render_state.is_some_and(gpu::is_software);
        Self {
            render_state: render_state.cloned(),
            meshes: MeshStore::new(is_on_processor),
            unused: UnusedStore::new(is_on_processor),
            fields: FieldStore::new(),
            sections: SectionStore::new(),
            crossing: Crossing::default(),
            pose: SmoothPose::default(),
            windows: PerRole::default(),
            took: Took::default(),
            unfinished: Unfinished::default(),
        }
    }

    /// True if every pixel of the window costs the processor time, as with a software driver.
    pub fn is_on_processor(&self) -> bool {
        self.render_state.as_ref().is_some_and(gpu::is_software)
    }

    /// How long the window may wait before it shows how far a job is. Where a processor draws, every frame
    /// takes time from the job.
    pub fn progress_pause(&self) -> Duration {
        if self.is_on_processor() {
            Duration::from_millis(100)
        } else {
            Duration::ZERO
        }
    }

    /// A large area in one opaque colour.
    pub fn fill(&self, rect: Rect, color: egui::Color32) -> egui::Shape {
        if self.render_state.is_some() {
            gpu::fill(rect, color)
        } else {
            egui::Shape::rect_filled(rect, 0.0, color)
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
        // The edges of the panels around it are gripped from both sides.
        let grip = ui.style().interaction.resize_grab_radius_side;
        let sensed = rect.shrink(grip.min(0.25 * rect.size().min_elem()));
        let mut response = ui.interact(sensed, id, Sense::click_and_drag());
        response.rect = rect;
        response.widget_info(|| {
            WidgetInfo::labeled(egui::Role::Canvas, true, window::summary(state, role))
        });
        let look = Look::of(ui.visuals().dark_mode);
        let window = self.windows.get_mut(role);
        window.notice_restored(state);
        window::tell_focus(&response, state.view.camera_of(role), state, commands);
        let view = self.view_frame(ui, role, state, rect, commands);
        let picture = self.picture_of(ui, &view, state, &look);
        let frame = FrameContext {
            response: &response,
            state,
            view: &view,
            picture: &picture,
            look: &look,
        };
        let camera = self.navigate(ui, &frame, commands);
        let view = ViewFrame { camera, ..view };
        let frame = FrameContext {
            view: &view,
            ..frame
        };
        self.paint(ui, &frame);
        self.interact(ui, &frame, commands);
        self.keep_moving(ui, role);
    }

    /// A window shows something else than parts.
    pub fn show_none(&mut self, role: Role) {
        self.fields.forget(role);
    }

    /// The section laid flat, in the rest of `ui`.
    pub fn section_ui(&self, ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
        let Some(plane) = state.inspect.section.shown() else {
            drawing::nothing_ui(ui);
            return;
        };
        let gaps = self.sections.gaps(state);
        let drawing = drawing::Drawing {
            state,
            look: &Look::of(ui.visuals().dark_mode),
            plane,
            cuts: &self.sections.cuts(Role::Crash, state),
            unused: &self.unused.flat(),
            gaps: gaps.as_deref(),
            is_cutting: self.sections.is_cutting(&plane) || self.meshes.is_waiting(),
        };
        drawing.show(ui, commands);
    }

    /// True while the stamped part flies from one window to the other.
    pub fn is_crossing(&self, now: f64) -> bool {
        self.crossing.is_moving(now)
    }

    /// True while meshes or colours are being made that a window wants to show. For tests and
    /// pictures that must not be taken too early.
    pub fn is_waiting(&self) -> bool {
        let is_waiting = self.meshes.is_waiting() || self.unused.is_waiting();
        is_waiting || self.fields.is_waiting() || self.sections.is_waiting()
    }

    /// True if a picture that was drawn since the last call is not the exact one, of which large parts have
    /// slices drawn in several frames.
    pub fn take_unfinished(&self) -> bool {
        self.unfinished.take()
    }

    /// Cameras and poses as they are shown in this frame.
    fn view_frame(
        &mut self,
        ui: &Ui,
        role: Role,
        state: &AppState,
        rect: Rect,
        commands: &mut Vec<Command>,
    ) -> ViewFrame {
        let now = ui.input(|i| i.time);
        let may_move = !state.settings.reduce_motion && !self.windows.get(role).is_restored;
        let bounds = state.document.part(Role::Stamped).map(|part| part.bounds());
        let bounds = bounds.filter(|bounds| !bounds.is_empty());
        let center = bounds.map_or(Point3::origin(), |bounds| bounds.center());
        // What the hand or the running match moves must not lag behind.
        let is_driven = state.previews.live.is_some()
            || state.moving.tool.is_some()
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
            state.view.camera_of(role)
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
        let has_settled = window.has_settled(rect);
        let may_fly = may_move && window.has_picture && has_settled && !is_linked_drag;
        let mut shown = window.camera.follow(&camera, now, may_fly);
        if role == Role::Stamped && over >= 1.0 {
            // What is shown beside the left window is seen by its camera in every frame, also while that one is
            // fitted again and again because the part that is matched moves.
            shown = self.windows.crash.camera.at(now).unwrap_or(camera);
            self.windows.stamped.camera.jump(shown);
        }
        let window = self.windows.get_mut(role);
        ViewFrame {
            window: role,
            camera: shown,
            aspect: f64::from(rect.width() / rect.height()),
            pose,
            over,
            is_bare: window.navigator.drag().is_some_and(|drag| drag.is_bare),
        }
    }

    /// The window's scene, from the meshes that are ready.
    fn picture_of(&mut self, ui: &Ui, view: &ViewFrame, state: &AppState, look: &Look) -> Picture {
        let shown = visible_parts::visible_parts(state, view);
        let unused = self.unused.drawables((state, view), look, &shown, ui.ctx());
        let unused_outlines = self.unused.outlines(view.window, look, &shown);
        let only_cut = visible_parts::only_cut(state, view, &shown);
        let instances: Vec<_> = shown
            .into_iter()
            .chain(only_cut.iter().cloned())
            .filter_map(|instance| Some((instance.source(state)?, instance)))
            .collect();
        let sources: Vec<_> = instances.iter().map(|(source, _)| source.clone()).collect();
        let ready = self.meshes.get(view.window, &sources, ui.ctx());
        let shown = &mut self.windows.get_mut(view.window).shown;
        let drawn = ready
            .into_iter()
            .zip(instances)
            .filter_map(|(mesh, (source, instance))| {
                if instance.further.is_some() {
                    return Some((mesh?, instance));
                }
                let last = shown.get_mut(instance.role);
                if mesh.is_some() {
                    last.clone_from(&mesh);
                }
                let is_same_part =
                    |mesh: &&Arc<ShownMesh>| mesh.source.part.is_same_surface(&source.part);
                let mesh = mesh.or_else(|| last.as_ref().filter(is_same_part).cloned())?;
                Some((mesh, instance))
            });
        let mut drawn: Vec<_> = drawn.collect();
        let placed: Vec<_> = drawn
            .iter()
            .map(|(mesh, instance)| {
                let pose = instance.world_from_part;
                (instance.role, instance.number(), Arc::clone(mesh), pose)
            })
            .collect();
        self.sections.update(view.window, state, &placed, ui.ctx());
        let cuts = self.sections.cuts(view.window, state);
        drawn.retain(|(_, instance)| !only_cut.contains(instance));
        let fields = self.fields.get(view.window, state, &drawn, ui.ctx());
        let layers = drawn
            .into_iter()
            .zip(fields)
            .map(|((mesh, instance), field)| Layer {
                role: instance.role,
                mesh,
                // A ghost has none.
                field: field.filter(|_| !instance.is_ghost),
                wants_field: fields::is_wanted(state, view.window, &instance),
                instance,
            });
        let layers = layers.collect();
        let mut picture = Picture::new(state, view, look, layers, density(ui.ctx()));
        picture.cut(state, look, &cuts);
        picture.add(unused, unused_outlines);
        picture
    }

    /// The camera after this frame's input.
    fn navigate(
        &mut self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        commands: &mut Vec<Command>,
    ) -> Camera {
        let window = self.windows.get_mut(frame.view.window);
        window.has_picture = !frame.picture.is_empty();
        let is_left_taken = window.tools.takes_left_now(ui, frame);
        match window.navigator.update(ui, frame, is_left_taken) {
            Some(camera) => {
                window.camera.jump(camera);
                if frame.view.over >= 1.0 {
                    // Both windows have this camera.
                    let other = frame.view.window.other();
                    self.windows.get_mut(other).camera.jump(camera);
                }
                commands.push(ViewCommand::SetCamera(frame.camera_role(), camera).into());
                camera
            }
            None => frame.view.camera,
        }
    }

    fn paint(&mut self, ui: &Ui, frame: &FrameContext<'_>) {
        let rect = frame.rect();
        if self.render_state.is_none() {
            overlay::placeholder(ui, rect, frame.look);
            return;
        }
        let role = frame.view.window;
        let callback = ViewCallback {
            role,
            scene: Arc::clone(&frame.picture.scene),
            camera: frame.view.camera,
            rect,
            watch: Stopwatch::start(&self.took),
            unfinished: self.unfinished.clone(),
            ctx: ui.ctx().clone(),
        };
        let size = rect.size() * ui.pixels_per_point();
        self.windows.get_mut(role).last_frame = Some(LastFrame {
            scene: Arc::clone(&frame.picture.scene),
            camera: frame.view.camera,
            size: [size.x.round() as u32, size.y.round() as u32],
        });
        ui.painter_at(rect).add(callback.shape());
    }

    /// Tools, pointing, and what lies over the picture.
    fn interact(&mut self, ui: &mut Ui, frame: &FrameContext<'_>, commands: &mut Vec<Command>) {
        let (state, role) = (frame.state, frame.view.window);
        let window = self.windows.get_mut(role);
        window.tools.update(ui, frame, commands);
        let is_busy = window.navigator.drag().is_some()
            || window.tools.takes_left()
            || state.moving.tool.is_some();
        let hit = window.pointing.update(ui, frame, is_busy, commands);
        let pick = if is_busy {
            None
        } else {
            picking::update(frame, commands)
        };
        let kind = FieldKind::of(state.color_by(role));
        // What is under the pointer is no part of a picture that is saved.
        let is_pointed = !is_screen_taken(ui.ctx());
        let over = overlay::Overlay {
            frame,
            drag: window.navigator.drag(),
            hit: hit.as_ref().filter(|_| is_pointed),
            scale: kind.and_then(|kind| Some((kind, self.fields.scale(role, state)?))),
            kind,
            summary: self.fields.summary(role),
            hint: window.tools.hint(state).filter(|_| is_pointed),
            pick: pick.filter(|_| is_pointed),
            is_preparing: is_preparing(state, frame.view, frame.picture),
        };
        window.tools.paint(ui, frame, &FreeRoom::of(ui, &over));
        overlay::show(ui, &over, commands);
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

/// Pixels per point of the screen alone: lines and points in the picture do not grow with the text.
fn density(ctx: &egui::Context) -> f32 {
    ctx.pixels_per_point() / ctx.zoom_factor()
}

/// True if the window should show something and nothing of it is ready.
fn is_preparing(state: &AppState, view: &ViewFrame, picture: &Picture) -> bool {
    picture.is_empty()
        && visible_parts::visible_parts(state, view)
            .iter()
            .any(|instance| state.document.part(instance.role).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_do_not_grow_with_the_text() {
        let ctx = egui::Context::default();
        for scale in [1.0, 2.5] {
            ctx.set_zoom_factor(scale);
            let mut input = egui::RawInput::default();
            let screen = input.viewports.get_mut(&egui::ViewportId::ROOT);
            screen.expect("the window").native_pixels_per_point = Some(1.5);
            let mut found = 0.0;
            let mut output = ctx.run_ui(input, |ui| found = density(ui.ctx()));
            output.textures_delta.clear();
            assert!((found - 1.5).abs() < 1e-6, "{found} at {scale}");
        }
    }
}
