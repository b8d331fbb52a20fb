//! Nodes.

use crate::render::mesh::Node;
use crate::render::pipeline::{Depth, Layouts, OVER, PipelineSpec, shader};
use crate::render::prepare::PreparedDrawable;
use crate::render::slice::Slice;

/// Nodes as dots.
#[derive(Debug)]
pub(in crate::render) struct Points {
    pipeline: wgpu::RenderPipeline,
}

const NODE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Node>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32],
};

const NODE_FIELD_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 4,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![2 => Float32],
};

impl Points {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(device, "points", include_str!("../shaders/points.wgsl"));
        let pipeline = PipelineSpec {
            layouts: &[&layouts.frame, &layouts.drawable],
            buffers: &[Some(NODE_LAYOUT), Some(NODE_FIELD_LAYOUT)],
            depth: Depth::Write,
            blend: OVER,
            ..PipelineSpec::new("points", &shader)
        }
        .build(device);
        Self { pipeline }
    }

    /// Draws the nodes if they are wanted, or if there is nothing else to see of the mesh.
    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        let mesh = &drawable.mesh;
        let wanted = drawable.style.points || mesh.corners.is_none();
        if let (true, Some(nodes)) = (wanted, &mesh.nodes) {
            let now = slice.take(nodes.count);
            if !now.is_empty() {
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(1, &drawable.group, &[]);
                pass.set_vertex_buffer(0, nodes.buffer.slice(..));
                // Without a field the shader reads no values, but the slot wants a buffer that is long enough.
                let field = drawable.field.as_deref();
                let field = field.map_or(nodes.buffer.slice(..), |field| {
                    field.slice(mesh.nodes_begin()..)
                });
                pass.set_vertex_buffer(1, field);
                pass.draw(0..6, now);
            }
        }
    }
}
