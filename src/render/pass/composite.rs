//! Lays the finished picture on the window.

use crate::render::pipeline::{Depth, OVER, PipelineSpec, texture_entry};

/// Lays a finished picture on the window.
#[derive(Debug)]
pub(in crate::render) struct Composite {
    /// For pictures that have the window's pixels.
    exact: wgpu::RenderPipeline,
    /// For pictures that are stretched.
    stretched: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl Composite {
    pub(in crate::render) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("composite"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../shaders/composite.wgsl").into()),
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("composite"),
            entries: &[texture_entry(
                0,
                wgpu::ShaderStages::FRAGMENT,
                wgpu::TextureSampleType::Float { filterable: false },
            )],
        });
        let fragment = if format.is_srgb() {
            "fs_linear"
        } else {
            "fs_gamma"
        };
        let pipeline = |is_stretched: f64| {
            PipelineSpec {
                layouts: &[&layout],
                fragment,
                depth: Depth::Absent,
                blend: OVER,
                format,
                samples: 1,
                constants: &[("IS_STRETCHED", is_stretched)],
                ..PipelineSpec::new("composite", &shader)
            }
            .build(device)
        };
        Self {
            exact: pipeline(0.0),
            stretched: pipeline(1.0),
            layout,
        }
    }

    pub(in crate::render) fn bind(
        &self,
        device: &wgpu::Device,
        picture: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("composite"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(picture),
            }],
        })
    }

    /// Lays a picture over the viewport of the pass; `is_stretched` if its pixels are not the window's.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        group: &wgpu::BindGroup,
        is_stretched: bool,
    ) {
        pass.set_pipeline(if is_stretched {
            &self.stretched
        } else {
            &self.exact
        });
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
