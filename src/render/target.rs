//! The textures of a viewport.

use super::context::Context;
use super::frame::Frame;
use super::mesh_cache::MeshCache;
use super::pipeline::{COLOR_FORMAT, DEPTH_FORMAT, Gpu, MASK_FORMAT, SAMPLES};
use super::prepare::Prepared;
use super::scene::Scene;
use super::sheets::Sheets;
use super::texture::{attachment, texture, view};
use super::uniforms::Region;
use crate::geometry::Camera;

/// The textures of one viewport and what was last drawn into them.
#[derive(Debug, Default)]
pub struct ViewTarget {
    textures: Option<Textures>,
    drawn: Option<(Scene, Camera)>,
}

#[derive(Debug)]
struct Textures {
    size: [u32; 2],
    /// Multisampled colour and depth.
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// The finished picture.
    picture: wgpu::Texture,
    picture_view: wgpu::TextureView,
    /// For laying the picture on the window.
    composite: wgpu::BindGroup,
    /// Made when two sheets may coincide for the first time.
    sheets: Option<Sheets>,
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

    /// Size of the picture in pixels; `None` before the first.
    pub fn size(&self) -> Option<[u32; 2]> {
        self.textures.as_ref().map(|textures| textures.size)
    }

    /// Forgets the picture, so that the next call draws in any case.
    pub fn invalidate(&mut self) {
        self.drawn = None;
    }

    pub(super) fn picture(&self) -> Option<&wgpu::Texture> {
        self.textures.as_ref().map(|textures| &textures.picture)
    }

    pub(super) fn composite(&self) -> Option<&wgpu::BindGroup> {
        self.textures.as_ref().map(|textures| &textures.composite)
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
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let size = frame.size.map(|pixels| pixels.clamp(1, limit));
        if self.size() != Some(size) {
            self.textures = Some(Textures::new(gpu.device, context, size));
            self.drawn = None;
        }
        let same =
            |(scene, camera): &(Scene, Camera)| scene == frame.scene && camera == frame.camera;
        if self.drawn.as_ref().is_some_and(same) {
            return false;
        }
        let frame = Frame { size, ..*frame };
        if let Some(textures) = &mut self.textures {
            let sheets = textures.sheets(gpu.device, &frame);
            let views = sheets.unwrap_or(&context.no_sheets).views();
            let prepared = Prepared::new(gpu, cache, &frame, Region::whole(size), views);
            if let Some(sheets) = sheets {
                // The frame's own group reads what is drawn here.
                let group = prepared.frame_group(gpu, context.no_sheets.views());
                sheets.draw(&context.passes.surface, &group, encoder, &prepared);
            }
            textures.draw(gpu, context, encoder, &prepared);
        }
        self.drawn = Some((frame.scene.clone(), *frame.camera));
        true
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

    /// Textures for the depths of the two sheets, if they may coincide.
    fn sheets(&mut self, device: &wgpu::Device, frame: &Frame<'_>) -> Option<&Sheets> {
        frame.scene.coinciding()?;
        let size = self.size;
        Some(self.sheets.get_or_insert_with(|| Sheets::new(device, size)))
    }

    fn draw(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
    ) {
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("picture"),
                color_attachments: &[Some(attachment(
                    &self.color,
                    Some(&self.picture_view),
                    wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                ))],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            context.passes.draw(&mut pass, prepared);
        }
        if prepared.has_selection {
            self.draw_selection(gpu, context, encoder, prepared);
        }
    }

    fn draw_selection(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
    ) {
        let size = self.size;
        let mask = self.mask.get_or_insert_with(|| Mask::new(gpu, size));
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("selection mask"),
                color_attachments: &[Some(attachment(
                    &mask.color,
                    Some(&mask.resolved),
                    wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                ))],
                ..Default::default()
            });
            pass.set_bind_group(0, &prepared.frame, &[]);
            for drawable in prepared.all() {
                context.passes.surface.draw_selected(&mut pass, drawable);
            }
        }
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
