//! One colour over a whole area of the window.

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
            if self.is_linear { linear(value) } else { value }
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_blend_constant(wgpu::Color { r, g, b, a: 1.0 });
        pass.draw(0..3, 0..1);
    }
}

/// The linear value of an sRGB value (IEC 61966-2-1), both 0 to 1.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}
