//! What every pass is built from: texture formats, bind group layouts, shaders, pipelines.

/// Format of every picture; shaders write sRGB values into it. A view of another format would be
/// simpler, but OpenGL has none.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Bits of a depth; as a float it could not be drawn to everywhere.
pub(super) const SHEET_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
pub(super) const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// Samples per pixel; every device has four.
pub(super) const SAMPLES: u32 = 4;

/// The device and the layouts, which every preparation needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gpu<'a> {
    pub(super) device: &'a wgpu::Device,
    pub(super) queue: &'a wgpu::Queue,
    pub(super) layouts: &'a Layouts,
}

/// Bind groups that several passes share.
#[derive(Debug)]
pub(super) struct Layouts {
    /// Group 0: the frame's numbers and the depths of the two sheets.
    pub(super) frame: wgpu::BindGroupLayout,
    /// Group 1: a drawable's numbers, its parts table and its field's colours.
    pub(super) drawable: wgpu::BindGroupLayout,
    /// Group 1 of the outline: the mask of the selected area.
    pub(super) mask: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries,
            })
        };
        let table = wgpu::TextureSampleType::Uint;
        let colors = wgpu::TextureSampleType::Float { filterable: false };
        Self {
            frame: layout(
                "frame",
                &[
                    uniform_entry(0),
                    texture_entry(1, wgpu::ShaderStages::FRAGMENT, table),
                    texture_entry(2, wgpu::ShaderStages::FRAGMENT, table),
                ],
            ),
            drawable: layout(
                "drawable",
                &[
                    uniform_entry(0),
                    texture_entry(1, wgpu::ShaderStages::VERTEX, table),
                    texture_entry(2, wgpu::ShaderStages::FRAGMENT, colors),
                ],
            ),
            mask: layout(
                "mask",
                &[texture_entry(0, wgpu::ShaderStages::FRAGMENT, colors)],
            ),
        }
    }
}

fn uniform_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

pub(super) fn texture_entry(
    binding: u32,
    visibility: wgpu::ShaderStages,
    sample_type: wgpu::TextureSampleType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

/// Compiles a shader with `common.wgsl` in front of it.
pub(super) fn shader(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    let common = include_str!("shaders/common.wgsl");
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(format!("{common}\n{source}").into()),
    })
}

/// How a pipeline uses the depth buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    /// Nearest wins, and later things know it.
    Write,
    /// Hidden where something is in front.
    Test,
    /// Everything is drawn, with a depth buffer attached.
    Ignore,
    /// No depth buffer attached.
    Absent,
}

/// The few ways in which our pipelines differ.
#[derive(Debug)]
pub(super) struct PipelineSpec<'a> {
    pub(super) label: &'a str,
    pub(super) layouts: &'a [&'a wgpu::BindGroupLayout],
    pub(super) shader: &'a wgpu::ShaderModule,
    pub(super) vertex: &'a str,
    pub(super) fragment: &'a str,
    pub(super) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) topology: wgpu::PrimitiveTopology,
    pub(super) cull: Option<wgpu::Face>,
    pub(super) depth: Depth,
    /// Pushes faces back so that lines on them win.
    pub(super) biased: bool,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) format: wgpu::TextureFormat,
    pub(super) samples: u32,
    pub(super) constants: &'a [(&'a str, f64)],
}

impl<'a> PipelineSpec<'a> {
    /// Opaque triangles into the multisampled picture.
    pub(super) fn new(label: &'a str, shader: &'a wgpu::ShaderModule) -> Self {
        Self {
            label,
            layouts: &[],
            shader,
            vertex: "vs_main",
            fragment: "fs_main",
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            depth: Depth::Write,
            biased: false,
            blend: None,
            format: COLOR_FORMAT,
            samples: SAMPLES,
            constants: &[],
        }
    }

    pub(super) fn build(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let layouts: Vec<_> = self.layouts.iter().map(|&layout| Some(layout)).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let compilation = || wgpu::PipelineCompilationOptions {
            constants: self.constants,
            ..Default::default()
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.vertex),
                compilation_options: compilation(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: self.topology,
                cull_mode: self.cull,
                ..Default::default()
            },
            depth_stencil: self.depth_state(),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(self.fragment),
                compilation_options: compilation(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: self.format,
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn depth_state(&self) -> Option<wgpu::DepthStencilState> {
        let compare = match self.depth {
            Depth::Absent => return None,
            Depth::Ignore => wgpu::CompareFunction::Always,
            Depth::Write | Depth::Test => wgpu::CompareFunction::GreaterEqual,
        };
        let bias = if self.biased {
            // Depth falls away from the viewer, so backwards is negative.
            wgpu::DepthBiasState {
                constant: -2,
                slope_scale: -1.5,
                clamp: 0.0,
            }
        } else {
            wgpu::DepthBiasState::default()
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(self.depth == Depth::Write),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias,
        })
    }
}

/// Adds premultiplied colours on top.
pub(super) const OVER: Option<wgpu::BlendState> =
    Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
