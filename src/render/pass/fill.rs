//! One colour over a whole area of the window.

use crate::colormap::linear_of_srgb;
use crate::render::pipeline::{Depth, PipelineSpec};
use crate::render::scene::Rgba;

/// The colour comes from the pass's blend constant, so that there is no buffer to keep.
const CONSTANT: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Constant,
    dst_factor: wgpu::BlendFactor::Zero,
    operation: wgpu::BlendOperation::Add,
};

/// Fills areas of the window.
#[derive(Debug)]
pub(in crate::render) struct Fill {
    pipeline: wgpu::RenderPipeline,
    /// The target encodes to sRGB itself.
    is_linear: bool,
}

impl Fill {
    pub(in crate::render) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("fill"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../shaders/fill.wgsl").into()),
        });
        let pipeline = PipelineSpec {
            depth: Depth::Absent,
            blend: Some(wgpu::BlendState {
                color: CONSTANT,
                alpha: CONSTANT,
            }),
            format,
            samples: 1,
            ..PipelineSpec::new("fill", &shader)
        }
        .build(device);
        Self {
            pipeline,
            is_linear: format.is_srgb(),
        }
    }

    /// Fills the viewport of the pass with a colour; its opacity counts as full.
    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, [r, g, b, _]: Rgba) {
        let [r, g, b] = [r, g, b].map(|value| {
            let value = f64::from(value) / 255.0;
            if self.is_linear {
                linear_of_srgb(value)
            } else {
                value
            }
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_blend_constant(wgpu::Color { r, g, b, a: 1.0 });
        pass.draw(0..3, 0..1);
    }
}
