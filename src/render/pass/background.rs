//! The ground behind the parts.

use crate::render::pipeline::{Depth, Layouts, PipelineSpec, shader};

/// The gradient behind everything.
#[derive(Debug)]
pub(in crate::render) struct Background {
    pipeline: wgpu::RenderPipeline,
}

impl Background {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(
            device,
            "background",
            include_str!("../shaders/background.wgsl"),
        );
        let pipeline = PipelineSpec {
            layouts: &[&layouts.frame],
            depth: Depth::Ignore,
            ..PipelineSpec::new("background", &shader)
        }
        .build(device);
        Self { pipeline }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
