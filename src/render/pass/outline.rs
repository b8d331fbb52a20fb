//! The outline of what is selected.

use crate::render::pipeline::{Depth, Layouts, OVER, PipelineSpec, shader};

/// The line around what is selected, drawn over the finished picture.
#[derive(Debug)]
pub(in crate::render) struct Outline {
    pipeline: wgpu::RenderPipeline,
}

impl Outline {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(device, "outline", include_str!("../shaders/outline.wgsl"));
        let pipeline = PipelineSpec {
            layouts: &[&layouts.frame, &layouts.mask],
            depth: Depth::Absent,
            blend: OVER,
            samples: 1,
            ..PipelineSpec::new("outline", &shader)
        }
        .build(device);
        Self { pipeline }
    }

    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, mask: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, mask, &[]);
        pass.draw(0..3, 0..1);
    }
}
