//! The textures of a viewport.

use std::time::Duration;

use super::context::Context;
use super::frame::{Frame, Seen};
use super::mesh_cache::MeshCache;
use super::pipeline::{COLOR_FORMAT, DEPTH_FORMAT, Gpu, MASK_FORMAT, SAMPLES};
use super::prepare::{Detail, Prepared};
use super::scene::{Scene, Sheet};
use super::sheets::Sheets;
use super::slice::Slice;
use super::steps::Steps;
use super::texture::{attachment, slice_pass, texture, view};

/// Pixels of the window per pixel of a coarse picture, on each axis, where a processor draws: as few as leave
/// frames quick, which are more while other work keeps it busy.
const FINE: u32 = 2;
const FIRST: u32 = 3;
const COARSEST: u32 = 4;
/// A frame with a coarse picture that took longer makes the next one coarser, a shorter one finer.
const SLOW: Duration = Duration::from_millis(80);
const QUICK: Duration = Duration::from_millis(45);

/// The textures of one viewport and what was last drawn into them.
#[derive(Debug, Default)]
pub struct ViewTarget {
    pub(super) textures: Option<Textures>,
    pub(super) drawn: Option<Seen>,
    pub(super) steps: Steps,
    /// Smaller textures for coarse pictures, and whether the last picture is in them.
    small: Option<Textures>,
    is_small: bool,
    /// Where a processor draws.
    grain: Option<Grain>,
}

/// How coarse the pictures of a moving view are.
#[derive(Debug)]
struct Grain {
    pixels: u32,
    /// The last frame had such a picture.
    is_drawn: bool,
}

impl Grain {
    fn adapt(&mut self, took: Duration) {
        if !std::mem::take(&mut self.is_drawn) {
            return;
        }
        if took > SLOW {
            self.pixels = (self.pixels + 1).min(COARSEST);
        } else if took < QUICK {
            self.pixels = (self.pixels - 1).max(FINE);
        }
    }
}

#[derive(Debug)]
pub(super) struct Textures {
    pub(super) size: [u32; 2],
    /// Multisampled colour and depth.
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// The finished picture.
    picture: wgpu::Texture,
    picture_view: wgpu::TextureView,
    /// For laying the picture on the window.
    composite: wgpu::BindGroup,
    /// Made when two sheets may coincide for the first time.
    pub(super) sheets: Option<Sheets>,
    /// Made when something is selected for the first time.
    mask: Option<Mask>,
}

/// The selected area, multisampled and resolved.
#[derive(Debug)]
struct Mask {
    color: wgpu::TextureView,
    resolved: wgpu::TextureView,
    group: wgpu::BindGroup,
}

impl ViewTarget {
    /// A viewport without a picture. Textures are made by the first drawing.
    pub fn new() -> Self {
        Self::default()
    }

    /// [`ViewTarget::new`] on a device whose time goes with the pixels, as that of a software driver: coarse
    /// pictures have a half to a quarter of the pixels on each axis.
    pub fn on_processor() -> Self {
        Self {
            grain: Some(Grain {
                pixels: FIRST,
                is_drawn: false,
            }),
            ..Self::default()
        }
    }

    /// Tells how long the last frame took: on a processor the next coarse picture takes less or more time.
    pub fn adapt(&mut self, took: Duration) {
        if let Some(grain) = &mut self.grain {
            grain.adapt(took);
        }
    }

    /// Size of the window's picture in pixels; `None` before the first.
    pub fn size(&self) -> Option<[u32; 2]> {
        self.textures.as_ref().map(|textures| textures.size)
    }

    pub(super) fn picture(&self) -> Option<&wgpu::Texture> {
        self.shown().map(|textures| &textures.picture)
    }

    fn shown(&self) -> Option<&Textures> {
        let small = self.small.as_ref().filter(|_| self.is_small);
        small.or(self.textures.as_ref())
    }

    /// The picture for laying it on the window, and whether it is to be stretched.
    pub(super) fn composite(&self) -> Option<(&wgpu::BindGroup, bool)> {
        let shown = self.shown()?;
        Some((&shown.composite, self.is_small))
    }

    /// Makes the textures for a size; true if they are new.
    pub(super) fn resize(&mut self, gpu: Gpu<'_>, context: &Context, size: [u32; 2]) -> bool {
        let is_new = self.size() != Some(size);
        if is_new {
            self.textures = Some(Textures::new(gpu.device, context, size));
            self.small = None;
            self.is_small = false;
            self.drawn = None;
        }
        is_new
    }

    /// True if the picture shows this frame, exactly.
    pub(super) fn shows(&self, frame: &Frame<'_>) -> bool {
        self.drawn.as_ref().is_some_and(|drawn| drawn.is_of(frame))
    }

    /// Records the drawing if anything changed; returns whether it did.
    pub(super) fn draw(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> bool {
        let frame = within_limit(gpu.device, frame);
        self.resize(gpu, context, frame.size);
        if self.shows(&frame) {
            return false;
        }
        if let Some(textures) = &mut self.textures {
            textures.draw_all(gpu, context, cache, encoder, (&frame, Detail::Exact));
        }
        self.show_exact(&frame);
        true
    }

    /// Records the whole coarse picture, after [`ViewTarget::resize`].
    pub(super) fn draw_coarse(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) {
        self.drawn = None;
        self.is_small = self.grain.is_some();
        let Some(grain) = &mut self.grain else {
            if let Some(textures) = &mut self.textures {
                textures.draw_all(gpu, context, cache, encoder, (frame, Detail::Coarse));
            }
            return;
        };
        grain.is_drawn = true;
        let pixels = grain.pixels;
        // Widths are in points, so that lines look as wide as ever.
        let scene = Scene {
            pixels_per_point: frame.scene.scale_factor() / pixels as f32,
            ..frame.scene.clone()
        };
        let small = Frame {
            scene: &scene,
            camera: frame.camera,
            size: frame.size.map(|side| side.div_ceil(pixels)),
        };
        self.small.take_if(|textures| textures.size != small.size);
        let textures = self
            .small
            .get_or_insert_with(|| Textures::new(gpu.device, context, small.size));
        textures.draw_all(gpu, context, cache, encoder, (&small, Detail::Coarse));
    }

    /// The picture in the large textures is finished.
    pub(super) fn show_exact(&mut self, frame: &Frame<'_>) {
        self.is_small = false;
        self.drawn = Some(Seen::of(frame));
    }
}

/// The frame, no larger than the device can draw.
pub(super) fn within_limit<'a>(device: &wgpu::Device, frame: &Frame<'a>) -> Frame<'a> {
    let limit = device.limits().max_texture_dimension_2d;
    Frame {
        size: frame.size.map(|pixels| pixels.clamp(1, limit)),
        ..*frame
    }
}

impl Textures {
    fn new(device: &wgpu::Device, context: &Context, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let picture_usage =
            usage | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let color = texture(device, size, COLOR_FORMAT, SAMPLES, usage);
        let depth = texture(device, size, DEPTH_FORMAT, SAMPLES, usage);
        let picture = texture(device, size, COLOR_FORMAT, 1, picture_usage);
        let picture_view = view(&picture);
        Self {
            size,
            color: view(&color),
            depth: view(&depth),
            composite: context.composite.bind(device, &picture_view),
            picture,
            picture_view,
            sheets: None,
            mask: None,
        }
    }

    /// Records the whole drawing, coarse or not.
    fn draw_all(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        encoder: &mut wgpu::CommandEncoder,
        (frame, detail): (&Frame<'_>, Detail),
    ) {
        let sheets = self.sheets(gpu.device, frame);
        let views = sheets.unwrap_or(&context.no_sheets).views();
        let prepared = Prepared::new(gpu, cache, (frame, detail), views);
        if let Some(sheets) = sheets {
            // The frame's own group reads what is drawn here.
            let group = prepared.frame_group(gpu, context.no_sheets.views());
            for sheet in Sheet::ALL {
                let what = (&context.passes.surface, sheet);
                sheets.draw(what, &group, encoder, &prepared, &mut Slice::all());
            }
        }
        self.draw(context, encoder, &prepared, &mut Slice::all());
        self.finish(encoder);
        if prepared.has_selection {
            self.draw_mask(gpu, context, encoder, &prepared, &mut Slice::all());
            self.draw_outline(context, encoder, &prepared);
        }
    }

    /// Textures for the depths of the two sheets, if they may coincide.
    pub(super) fn sheets(&mut self, device: &wgpu::Device, frame: &Frame<'_>) -> Option<&Sheets> {
        frame.scene.coinciding()?;
        let size = self.size;
        Some(self.sheets.get_or_insert_with(|| Sheets::new(device, size)))
    }

    /// Draws a slice of the multisampled picture.
    pub(super) fn draw(
        &self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
        slice: &mut Slice,
    ) {
        let mut pass = slice_pass(encoder, "picture", [&self.color, &self.depth], *slice);
        context.passes.draw(&mut pass, prepared, slice);
    }

    /// Shows what was drawn.
    pub(super) fn finish(&self, encoder: &mut wgpu::CommandEncoder) {
        resolve(encoder, &self.color, &self.picture_view);
    }

    /// Draws a slice of the selected area.
    pub(super) fn draw_mask(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
        slice: &mut Slice,
    ) {
        let size = self.size;
        let mask = self.mask.get_or_insert_with(|| Mask::new(gpu, size));
        let load = if slice.is_first() {
            wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT)
        } else {
            wgpu::LoadOp::Load
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("selection mask"),
            color_attachments: &[Some(attachment(&mask.color, None, load))],
            ..Default::default()
        });
        pass.set_bind_group(0, &prepared.frame, &[]);
        for drawable in prepared.all() {
            let surface = &context.passes.surface;
            surface.draw_selected(&mut pass, drawable, slice);
        }
    }

    /// Draws the line around the selected area over the picture.
    pub(super) fn draw_outline(
        &self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
    ) {
        let Some(mask) = &self.mask else { return };
        resolve(encoder, &mask.color, &mask.resolved);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("selection outline"),
            color_attachments: &[Some(attachment(
                &self.picture_view,
                None,
                wgpu::LoadOp::Load,
            ))],
            ..Default::default()
        });
        pass.set_bind_group(0, &prepared.frame, &[]);
        context.passes.outline.draw(&mut pass, &mask.group);
    }
}

/// One sample for each pixel out of four.
fn resolve(
    encoder: &mut wgpu::CommandEncoder,
    samples: &wgpu::TextureView,
    to: &wgpu::TextureView,
) {
    let load = wgpu::LoadOp::Load;
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("resolve"),
        color_attachments: &[Some(attachment(samples, Some(to), load))],
        ..Default::default()
    });
}

impl Mask {
    fn new(gpu: Gpu<'_>, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let color = texture(gpu.device, size, MASK_FORMAT, SAMPLES, usage);
        let usage = usage | wgpu::TextureUsages::TEXTURE_BINDING;
        let resolved = view(&texture(gpu.device, size, MASK_FORMAT, 1, usage));
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mask"),
            layout: &gpu.layouts.mask,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&resolved),
            }],
        });
        Self {
            color: view(&color),
            resolved,
            group,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_frames_make_coarse_pictures_coarser_and_quick_ones_finer() {
        let mut target = ViewTarget::on_processor();
        let mut after = |millis: &[u64], is_drawn: bool| {
            for &millis in millis {
                if let Some(grain) = &mut target.grain {
                    grain.is_drawn = is_drawn;
                }
                target.adapt(Duration::from_millis(millis));
            }
            target.grain.as_ref().map(|grain| grain.pixels)
        };
        assert_eq!(after(&[60, 60], true), Some(3), "quick enough");
        assert_eq!(after(&[30], true), Some(2));
        assert_eq!(after(&[300], false), Some(2), "another kind of frame");
        assert_eq!(after(&[90], true), Some(3));
        assert_eq!(after(&[90, 300, 300], true), Some(4));
        assert_eq!(after(&[60, 70], true), Some(4), "it does not swing");
        assert_eq!(after(&[30, 30, 30, 30], true), Some(2));
    }
}
