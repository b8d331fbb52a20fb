//! Between egui and the renderer: draws a viewport's picture before egui's pass, lays it into it, and fills large
//! areas.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use egui::epaint::ViewportInPixels;

use crate::geometry::Camera;
use crate::render::{Drawn, Frame, Renderer, Scene, ViewTarget};
use crate::role::{PerRole, Role};

/// What is kept on the graphics card, kept among egui's own resources.
pub(super) struct Gpu {
    pub renderer: Renderer,
    targets: PerRole<ViewTarget>,
    /// Whose picture was not exact when it was drawn last.
    are_partly: PerRole<bool>,
}

/// True if the driver draws with the processor.
pub(super) fn is_software(state: &RenderState) -> bool {
    state.adapter.get_info().device_type == wgpu::DeviceType::Cpu
}

impl Gpu {
    /// Compiles the shaders and leaves everything with egui.
    pub fn install(state: &RenderState) {
        let target = |_| {
            if is_software(state) {
                ViewTarget::on_processor()
            } else {
                ViewTarget::new()
            }
        };
        let gpu = Self {
            renderer: Renderer::new(&state.device, &state.queue, state.target_format),
            targets: PerRole::from_fn(target),
            are_partly: PerRole::default(),
        };
        state.renderer.write().callback_resources.insert(gpu);
    }
}

/// How long the last frame took, in milliseconds; zero before the first.
#[derive(Debug, Clone, Default)]
pub(super) struct Took(Arc<AtomicU64>);

/// Measures a frame to its end: what was painted is dropped when it is shown, and a software driver has drawn
/// it by then.
pub(super) struct Stopwatch {
    since: Instant,
    took: Took,
}

impl Stopwatch {
    pub fn start(took: &Took) -> Self {
        Self {
            since: Instant::now(),
            took: took.clone(),
        }
    }

    /// The time of the frame before.
    fn last(&self) -> Duration {
        Duration::from_millis(self.took.0.load(Ordering::Relaxed))
    }
}

impl Drop for Stopwatch {
    fn drop(&mut self) {
        let millis = self.since.elapsed().as_millis() as u64;
        self.took.0.store(millis, Ordering::Relaxed);
    }
}

/// Set when a picture of a frame is coarse, of before, or not yet whole.
#[derive(Debug, Clone, Default)]
pub(super) struct Unfinished(Arc<AtomicBool>);

impl Unfinished {
    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was set since the last call.
    pub fn take(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}

/// One viewport's picture in one frame. The renderer itself notices if nothing has changed.
pub(super) struct ViewCallback {
    pub role: Role,
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub rect: egui::Rect,
    pub watch: Stopwatch,
    pub unfinished: Unfinished,
    /// To be asked for the next step of a picture that takes several.
    pub ctx: egui::Context,
}

impl ViewCallback {
    /// As a shape for egui's painter.
    pub fn shape(self) -> egui::Shape {
        let rect = self.rect;
        eframe::egui_wgpu::Callback::new_paint_callback(rect, self).into()
    }
}

impl CallbackTrait for ViewCallback {
    fn prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(gpu) = resources.get_mut::<Gpu>() else {
            return Vec::new();
        };
        // The very rounding of egui, so that one texel is one pixel.
        let area = ViewportInPixels::from_points(
            &self.rect,
            screen.pixels_per_point,
            screen.size_in_pixels,
        );
        let size = [area.width_px, area.height_px].map(|side| side.max(1).unsigned_abs());
        let frame = Frame {
            scene: &self.scene,
            camera: &self.camera,
            size,
        };
        let target = gpu.targets.get_mut(self.role);
        target.adapt(self.watch.last());
        let drawn = gpu.renderer.draw_step(target, encoder, &frame);
        let is_partly = matches!(drawn, Drawn::Partly(_));
        let was_partly = std::mem::replace(gpu.are_partly.get_mut(self.role), is_partly);
        match drawn {
            Drawn::Partly(next) => {
                self.unfinished.set();
                self.ctx.request_repaint_after(next);
            }
            // The window learns of it in its next frame.
            Drawn::Exact if was_partly => self.ctx.request_repaint(),
            Drawn::Exact => {}
        }
        Vec::new()
    }

    fn paint(
        &self,
        _: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(gpu) = resources.get::<Gpu>() {
            gpu.renderer.paint(gpu.targets.get(self.role), pass);
        }
    }
}

/// One colour over an area of the window. egui samples its texture for every pixel of a filled rectangle, which
/// is most of what a frame costs a software driver.
struct FillCallback {
    color: egui::Color32,
}

/// An area filled with an opaque colour, as a shape for egui's painter.
pub(super) fn fill(rect: egui::Rect, color: egui::Color32) -> egui::Shape {
    let callback = FillCallback { color };
    eframe::egui_wgpu::Callback::new_paint_callback(rect, callback).into()
}

impl CallbackTrait for FillCallback {
    fn paint(
        &self,
        _: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(gpu) = resources.get::<Gpu>() {
            gpu.renderer.fill(self.color.to_array(), pass);
        }
    }
}
