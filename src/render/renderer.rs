//! The renderer of one device.

use super::context::Context;
use super::frame::Frame;
use super::mesh_cache::MeshCache;
use super::pipeline::Gpu;
use super::readback::{Download, ReadbackError, unpremultiply};
use super::scene::Rgba;
use super::steps::Drawn;
use super::target::ViewTarget;

/// Draws scenes on one device. Keeps the pipelines and the uploaded meshes; any number of
/// [`ViewTarget`]s share them.
#[derive(Debug)]
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    context: Context,
    cache: MeshCache,
}

impl Renderer {
    /// Compiles the shaders. `window_format` is the format of the target that [`Renderer::paint`]
    /// and [`Renderer::fill`] paint to; pictures themselves do not depend on it.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        window_format: wgpu::TextureFormat,
    ) -> Self {
        Self {
            context: Context::new(device, window_format),
            device: device.clone(),
            queue: queue.clone(),
            cache: MeshCache::default(),
        }
    }

    /// Records the drawing of a frame into the viewport's textures, if anything changed since the
    /// last time; returns whether it did. Meshes seen for the first time are uploaded here, and those
    /// that nobody holds any more are freed.
    pub fn draw(
        &mut self,
        target: &mut ViewTarget,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> bool {
        let gpu = Gpu {
            device: &self.device,
            queue: &self.queue,
            layouts: &self.context.layouts,
        };
        let drawn = target.draw(gpu, &self.context, &mut self.cache, encoder, frame);
        if drawn {
            self.cache.sweep();
        }
        drawn
    }

    /// [`Renderer::draw`] for a window that must not stand still: large meshes are drawn coarsely while
    /// the view moves and exactly, in slices, once it rests; they are uploaded off the frame.
    pub fn draw_step(
        &mut self,
        target: &mut ViewTarget,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Drawn {
        let gpu = Gpu {
            device: &self.device,
            queue: &self.queue,
            layouts: &self.context.layouts,
        };
        let drawn = target.draw_step(gpu, &self.context, &mut self.cache, encoder, frame);
        self.cache.sweep();
        drawn
    }

    /// Lays the viewport's picture over the whole of the pass's viewport; nothing before the first
    /// [`Renderer::draw`]. The pass must have the window format, one sample and no depth.
    pub fn paint(&self, target: &ViewTarget, pass: &mut wgpu::RenderPass<'_>) {
        if let Some((group, is_stretched)) = target.composite() {
            self.context.composite.draw(pass, group, is_stretched);
        }
    }

    /// Fills the pass's viewport with a colour, opaque. The pass must be as for [`Renderer::paint`].
    pub fn fill(&self, color: Rgba, pass: &mut wgpu::RenderPass<'_>) {
        self.context.fill.draw(pass, color);
    }

    /// Draws a frame and waits for it: for pictures in files. Opacity is not premultiplied.
    pub fn picture(&mut self, frame: &Frame<'_>) -> Result<image::RgbaImage, ReadbackError> {
        let mut target = ViewTarget::new();
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("picture"),
            });
        self.draw(&mut target, &mut encoder, frame);
        self.read(&target, encoder)
    }

    /// What a viewport shows after the recorded commands: waits for them. Opacity is not premultiplied.
    pub fn read(
        &self,
        target: &ViewTarget,
        mut encoder: wgpu::CommandEncoder,
    ) -> Result<image::RgbaImage, ReadbackError> {
        let picture = target.picture().ok_or(ReadbackError::Device)?;
        let mut download = Download::record(&self.device, &mut encoder, picture);
        self.queue.submit([encoder.finish()]);
        download.start();
        let mut rgba = download.wait(&self.device)?;
        unpremultiply(&mut rgba);
        image::RgbaImage::from_raw(picture.width(), picture.height(), rgba)
            .ok_or(ReadbackError::Device)
    }

    /// Submits recorded commands and waits for their end, for measurements. False if the device did not
    /// answer.
    pub fn submit_and_wait(&self, encoder: wgpu::CommandEncoder) -> bool {
        self.queue.submit([encoder.finish()]);
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .is_ok()
    }

    /// The device that everything lives on.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Number of meshes on the graphics card.
    pub fn n_meshes(&self) -> usize {
        self.cache.n_meshes()
    }
}
