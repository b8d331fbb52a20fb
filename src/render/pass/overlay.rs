//! Lines and fills over the parts.

use crate::render::pipeline::{Depth, Layouts, OVER, PipelineSpec, shader};
use crate::render::prepare_overlay::{FILL_LAYOUT, Kinds, LINE_LAYOUT, PreparedOverlay};

/// Opacity of [`DepthMode::Faint`](crate::render::DepthMode::Faint) things behind a part.
const FAINTNESS: f64 = 0.22;
/// Lines and fills.
#[derive(Debug)]
pub(in crate::render) struct OverlayPass {
    tested: Kinds<wgpu::RenderPipeline>,
    faint: Kinds<wgpu::RenderPipeline>,
    on_top: Kinds<wgpu::RenderPipeline>,
}

impl OverlayPass {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let shader = shader(device, "overlay", include_str!("../shaders/overlay.wgsl"));
        let kinds = |depth, faintness: f64| {
            let build = |vertex, fragment, buffer| {
                PipelineSpec {
                    layouts: &[&layouts.frame],
                    vertex,
                    fragment,
                    buffers: &[Some(buffer)],
                    depth,
                    blend: OVER,
                    constants: &[("faintness", faintness)],
                    ..PipelineSpec::new("overlay", &shader)
                }
                .build(device)
            };
            Kinds {
                fills: build("vs_fill", "fs_fill", FILL_LAYOUT),
                lines: build("vs_line", "fs_line", LINE_LAYOUT),
            }
        };
        Self {
            tested: kinds(Depth::Test, 1.0),
            faint: kinds(Depth::Ignore, FAINTNESS),
            on_top: kinds(Depth::Ignore, 1.0),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, overlay: &PreparedOverlay) {
        draw_kinds(&self.faint, pass, &overlay.faint);
        draw_kinds(&self.tested, pass, &overlay.faint);
        draw_kinds(&self.on_top, pass, &overlay.on_top);
    }
}

fn draw_kinds(
    pipelines: &Kinds<wgpu::RenderPipeline>,
    pass: &mut wgpu::RenderPass<'_>,
    data: &Kinds<Option<(wgpu::Buffer, u32)>>,
) {
    if let Some((buffer, count)) = &data.fills {
        pass.set_pipeline(&pipelines.fills);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..*count, 0..1);
    }
    if let Some((buffer, count)) = &data.lines {
        pass.set_pipeline(&pipelines.lines);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..6, 0..*count);
    }
}
