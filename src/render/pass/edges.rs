//! Element edges, borders and creases.

use super::surface::{CORNER_LAYOUT, FIELD_LAYOUT};
use crate::render::mesh::WideEdge;
use crate::render::pipeline::{Depth, Layouts, OVER, PipelineSpec, shader};
use crate::render::prepare::PreparedDrawable;
use crate::render::slice::Slice;

/// Element edges, creases and borders.
#[derive(Debug)]
pub(in crate::render) struct Edges {
    thin: wgpu::RenderPipeline,
    wide: wgpu::RenderPipeline,
}

const WIDE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<WideEdge>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32],
};

/// Values at both ends.
const WIDE_FIELD_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 8,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![3 => Float32x2],
};

impl Edges {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(device, "edges", include_str!("../shaders/edges.wgsl"));
        let layouts = [&layouts.frame, &layouts.drawable];
        let spec = || PipelineSpec {
            layouts: &layouts,
            depth: Depth::Test,
            blend: OVER,
            ..PipelineSpec::new("edges", &shader)
        };
        let thin = PipelineSpec {
            vertex: "vs_thin",
            fragment: "fs_thin",
            buffers: &[Some(CORNER_LAYOUT), Some(FIELD_LAYOUT)],
            topology: wgpu::PrimitiveTopology::LineList,
            ..spec()
        };
        let wide = PipelineSpec {
            vertex: "vs_wide",
            fragment: "fs_wide",
            buffers: &[Some(WIDE_LAYOUT), Some(WIDE_FIELD_LAYOUT)],
            ..spec()
        };
        Self {
            thin: thin.build(device),
            wide: wide.build(device),
        }
    }

    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        let (mesh, style) = (&drawable.mesh, drawable.style);
        pass.set_bind_group(1, &drawable.group, &[]);
        if let (true, Some(corners), Some(edges)) =
            (style.element_edges, &mesh.corners, &mesh.edges)
        {
            let lines = slice.take(edges.count / 2);
            if !lines.is_empty() {
                pass.set_pipeline(&self.thin);
                pass.set_vertex_buffer(0, corners.buffer.slice(..));
                // Without a field the shader reads no values, but the slot wants a buffer that is long enough.
                let field = drawable.field.as_deref().unwrap_or(&corners.buffer);
                pass.set_vertex_buffer(1, field.slice(..));
                pass.set_index_buffer(edges.buffer.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(2 * lines.start..2 * lines.end, 0, 0..1);
            }
        }
        // Creases come first in the buffer, borders after them.
        let first = if style.feature_edges {
            0
        } else {
            mesh.n_features
        };
        if let Some(wide) = &mesh.wide_edges {
            let end = if style.borders {
                wide.count
            } else {
                mesh.n_features
            };
            let lines = slice.take(end.saturating_sub(first));
            if !lines.is_empty() {
                pass.set_pipeline(&self.wide);
                pass.set_vertex_buffer(0, wide.buffer.slice(..));
                let field = drawable.field.as_deref();
                let field = field.map_or(wide.buffer.slice(..), |field| {
                    field.slice(mesh.ends_begin()..)
                });
                pass.set_vertex_buffer(1, field);
                pass.draw(0..6, first + lines.start..first + lines.end);
            }
        }
    }
}
