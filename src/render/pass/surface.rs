//! Triangles.

use crate::render::mesh::Corner;
use crate::render::pipeline::{
    Depth, Layouts, MASK_FORMAT, OVER, PipelineSpec, SAMPLES, SHEET_FORMAT, shader,
};
use crate::render::prepare::PreparedDrawable;
use crate::render::slice::Slice;

/// Triangles: lit and solid, as glass, as the mask of the selection, as depths of a sheet.
#[derive(Debug)]
pub(in crate::render) struct Surface {
    solid: wgpu::RenderPipeline,
    clear_backs: wgpu::RenderPipeline,
    clear_fronts: wgpu::RenderPipeline,
    selected: wgpu::RenderPipeline,
    depth: wgpu::RenderPipeline,
}

/// Attributes of [`Corner`].
pub(super) const CORNER_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Corner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x2, 2 => Uint32],
};

pub(super) const FIELD_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 4,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![3 => Float32],
};

impl Surface {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(device, "surface", include_str!("../shaders/surface.wgsl"));
        let layouts = [&layouts.frame, &layouts.drawable];
        let buffers = [Some(CORNER_LAYOUT), Some(FIELD_LAYOUT)];
        let spec = |label, fragment| PipelineSpec {
            layouts: &layouts,
            fragment,
            buffers: &buffers,
            biased: true,
            ..PipelineSpec::new(label, &shader)
        };
        let clear = |cull| PipelineSpec {
            cull: Some(cull),
            depth: Depth::Test,
            blend: OVER,
            ..spec("clear surface", "fs_clear")
        };
        Self {
            solid: spec("solid surface", "fs_opaque").build(device),
            clear_backs: clear(wgpu::Face::Front).build(device),
            clear_fronts: clear(wgpu::Face::Back).build(device),
            selected: PipelineSpec {
                depth: Depth::Absent,
                biased: false,
                format: MASK_FORMAT,
                samples: SAMPLES,
                ..spec("selection mask", "fs_selected")
            }
            .build(device),
            depth: PipelineSpec {
                biased: false,
                format: SHEET_FORMAT,
                samples: 1,
                ..spec("sheet depth", "fs_depth")
            }
            .build(device),
        }
    }

    pub(super) fn draw_solid(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        draw_with(&self.solid, pass, drawable, slice);
    }

    /// Back sides first, so that a part seen through itself looks right without sorting triangles.
    pub(super) fn draw_clear(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        draw_with(&self.clear_backs, pass, drawable, slice);
        draw_with(&self.clear_fronts, pass, drawable, slice);
    }

    pub(in crate::render) fn draw_selected(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        draw_with(&self.selected, pass, drawable, slice);
    }

    pub(in crate::render) fn draw_depth(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        draw_with(&self.depth, pass, drawable, slice);
    }
}

fn draw_with(
    pipeline: &wgpu::RenderPipeline,
    pass: &mut wgpu::RenderPass<'_>,
    drawable: &PreparedDrawable,
    slice: &mut Slice,
) {
    let Some(corners) = &drawable.mesh.corners else {
        return;
    };
    if !drawable.style.surface {
        return;
    }
    let triangles = slice.take(corners.count / 3);
    if triangles.is_empty() {
        return;
    }
    pass.set_pipeline(pipeline);
    pass.set_bind_group(1, &drawable.group, &[]);
    pass.set_vertex_buffer(0, corners.buffer.slice(..));
    // Without a field the shader reads no values, but the slot wants a buffer that is long enough.
    let field = drawable.field.as_deref().unwrap_or(&corners.buffer);
    pass.set_vertex_buffer(1, field.slice(..));
    pass.draw(3 * triangles.start..3 * triangles.end, 0..1);
}
