//! A scene as bind groups and buffers, ready for the passes.

use std::sync::Arc;

use wgpu::util::DeviceExt as _;

use super::frame::Frame;
use super::mesh::RenderMesh;
use super::mesh_cache::{GpuMesh, MeshCache};
use super::pipeline::Gpu;
use super::prepare_overlay::PreparedOverlay;
use super::scene::{Background, Drawable, PartLook, Sheet, Style};
use super::uniforms::{DrawableUniform, FrameUniform};
use crate::colormap::{ColorScale, Pattern};

/// Parts per row of the table; the smallest largest texture of all backends is 2048 wide and high.
const PARTS_PER_ROW: usize = 256;
/// Colours of a field's table; mirrors `FIELD_STEPS` of `surface.wgsl`.
const FIELD_STEPS: usize = 1024;

/// Which picture of large meshes is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// The meshes themselves.
    Exact,
    /// What stands for them while the view moves.
    Coarse,
}

impl Detail {
    fn of(self, mesh: &Arc<RenderMesh>) -> &Arc<RenderMesh> {
        match self {
            Self::Exact => mesh,
            Self::Coarse => mesh.coarse().unwrap_or(mesh),
        }
    }
}

/// One frame on the graphics card.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) frame: wgpu::BindGroup,
    uniform: wgpu::Buffer,
    /// Solid drawables, the one pushed back furthest first; then transparent ones from far to near.
    pub(super) solid: Vec<PreparedDrawable>,
    pub(super) clear: Vec<PreparedDrawable>,
    pub(super) overlay: PreparedOverlay,
    pub(super) has_selection: bool,
    pub(super) opaque_background: bool,
}

/// One drawable on the graphics card.
#[derive(Debug)]
pub(super) struct PreparedDrawable {
    pub(super) mesh: Arc<GpuMesh>,
    pub(super) field: Option<Arc<wgpu::Buffer>>,
    pub(super) group: wgpu::BindGroup,
    pub(super) style: Style,
    /// Set if it may coincide with the other sheet.
    pub(super) sheet: Option<Sheet>,
}

impl Prepared {
    /// Uploads what is new and makes the bind groups for drawing the frame. `sheets` are the depths of the
    /// two sheets.
    pub(super) fn new(
        gpu: Gpu<'_>,
        cache: &mut MeshCache,
        (frame, detail): (&Frame<'_>, Detail),
        sheets: [&wgpu::TextureView; 2],
    ) -> Self {
        let uniform = FrameUniform::new(frame);
        let uniform = uniform_buffer(gpu.device, bytemuck::bytes_of(&uniform));
        let pixel = frame.camera.height / f64::from(frame.size[1].max(1));
        let mut solid = Vec::new();
        let mut clear = Vec::new();
        for (index, drawable) in frame.scene.drawables.iter().enumerate() {
            if drawable.opacity <= 0.0 {
                continue;
            }
            let prepared = prepare_drawable(gpu, cache, (frame, detail), index);
            if drawable.opacity >= 1.0 {
                let push = drawable.push_back_length + f64::from(drawable.push_back) * pixel;
                solid.push((push, prepared));
            } else {
                let depth = frame.camera.view_point(&drawable.bounds().center()).z;
                clear.push((depth, prepared));
            }
        }
        solid.sort_by(|a, b| b.0.total_cmp(&a.0));
        clear.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            frame: frame_group(gpu, &uniform, sheets),
            uniform,
            solid: solid.into_iter().map(|(_, prepared)| prepared).collect(),
            clear: clear.into_iter().map(|(_, prepared)| prepared).collect(),
            overlay: PreparedOverlay::new(gpu.device, frame),
            has_selection: frame.scene.drawables.iter().any(Drawable::has_selection),
            opaque_background: frame.scene.background != Background::Transparent,
        }
    }

    /// The frame's numbers with other depths of the sheets.
    pub(super) fn frame_group(
        &self,
        gpu: Gpu<'_>,
        sheets: [&wgpu::TextureView; 2],
    ) -> wgpu::BindGroup {
        frame_group(gpu, &self.uniform, sheets)
    }

    /// Solid and transparent drawables.
    pub(super) fn all(&self) -> impl Iterator<Item = &PreparedDrawable> {
        self.solid.iter().chain(&self.clear)
    }
}

fn frame_group(
    gpu: Gpu<'_>,
    uniform: &wgpu::Buffer,
    [first, second]: [&wgpu::TextureView; 2],
) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("frame"),
        layout: &gpu.layouts.frame,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: uniform.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::TextureView(first),
            },
            wgpu::BindGroupEntry {
                binding: 2,
                resource: wgpu::BindingResource::TextureView(second),
            },
        ],
    })
}

fn prepare_drawable(
    gpu: Gpu<'_>,
    cache: &mut MeshCache,
    (frame, detail): (&Frame<'_>, Detail),
    index: usize,
) -> PreparedDrawable {
    let drawable = &frame.scene.drawables[index];
    let sheet = drawable.sheet.filter(|sheet| drawable.is_solid_of(*sheet));
    let both = sheet.zip(frame.scene.coinciding());
    let other_sheet = both.map(|(sheet, colors)| colors[sheet.other() as usize]);
    let uniform = DrawableUniform::new(frame, index, other_sheet);
    let buffer = uniform_buffer(gpu.device, bytemuck::bytes_of(&uniform));
    let parts = parts_table(gpu, drawable.parts.as_deref().unwrap_or(&[]));
    let colors = field_table(gpu, drawable);
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("drawable"),
        layout: &gpu.layouts.drawable,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: buffer.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::TextureView(&parts),
            },
            wgpu::BindGroupEntry {
                binding: 2,
                resource: wgpu::BindingResource::TextureView(&colors),
            },
        ],
    });
    let mesh = detail.of(&drawable.mesh);
    let field = drawable.field.as_ref();
    PreparedDrawable {
        mesh: cache.mesh(gpu.device, mesh),
        field: field.and_then(|field| cache.field(gpu.device, mesh, field)),
        group,
        style: drawable.style,
        sheet: both.map(|(sheet, _)| sheet),
    }
}

fn uniform_buffer(device: &wgpu::Device, contents: &[u8]) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("uniform"),
        contents,
        usage: wgpu::BufferUsages::UNIFORM,
    })
}

/// Colours and states of the parts as a texture, because OpenGL has no storage buffers.
fn parts_table(gpu: Gpu<'_>, parts: &[PartLook]) -> wgpu::TextureView {
    let n_rows = parts.len().div_ceil(PARTS_PER_ROW).max(1);
    let mut texels: Vec<[u8; 4]> = parts.iter().map(part_texel).collect();
    texels.resize(n_rows * PARTS_PER_ROW, [0; 4]);
    let size = [PARTS_PER_ROW as u32, n_rows as u32];
    table_texture(gpu, size, wgpu::TextureFormat::Rgba8Uint, &texels)
}

fn part_texel(part: &PartLook) -> [u8; 4] {
    let [r, g, b] = part.color.unwrap_or_default();
    let bits = [
        part.visible,
        part.selected,
        part.hovered,
        part.color.is_some(),
    ];
    let bits = bits
        .iter()
        .enumerate()
        .map(|(bit, &on)| u8::from(on) << bit);
    [r, g, b, bits.sum()]
}

/// The field's colours from end to end; one texel without a field.
fn field_table(gpu: Gpu<'_>, drawable: &Drawable) -> wgpu::TextureView {
    let texels: Vec<[u8; 4]> = match &drawable.field {
        Some(field) => field_texels(&field.scale),
        None => vec![[0; 4]],
    };
    let size = [texels.len() as u32, 1];
    table_texture(gpu, size, wgpu::TextureFormat::Rgba8Unorm, &texels)
}

/// Colours from end to end; the fourth byte names the pattern over them, as `surface.wgsl` reads it.
fn field_texels(scale: &ColorScale) -> Vec<[u8; 4]> {
    let middle = |i: usize| scale.value_at((i as f64 + 0.5) / FIELD_STEPS as f64);
    let patterns = (0..FIELD_STEPS).map(|i| match scale.pattern(middle(i)) {
        Pattern::Plain => 255,
        Pattern::Lines => 0,
        Pattern::Dots => 50,
        Pattern::Rising => 100,
        Pattern::Falling => 150,
        Pattern::Crossed => 200,
    });
    let colors = scale.table(FIELD_STEPS).into_iter().zip(patterns);
    colors.map(|([r, g, b], p)| [r, g, b, p]).collect()
}

fn table_texture(
    gpu: Gpu<'_>,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    texels: &[[u8; 4]],
) -> wgpu::TextureView {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("table"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let texture = gpu.device.create_texture_with_data(
        gpu.queue,
        &descriptor,
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(texels),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
