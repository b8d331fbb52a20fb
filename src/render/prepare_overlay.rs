//! Lines and fills of a frame as vertex buffers.

use wgpu::util::DeviceExt as _;

use super::frame::Frame;
use super::scene::{DepthMode, Fill, Polyline, Rgba};
use super::uniforms::screen_size;
use crate::geometry::{Camera, Point3};

/// One of each: fills first, because lines lie on them.
#[derive(Debug)]
pub(super) struct Kinds<T> {
    pub(super) fills: T,
    pub(super) lines: T,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct LinePiece {
    from: [f32; 3],
    to: [f32; 3],
    width: f32,
    dash: [f32; 2],
    color: Rgba,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct FillCorner {
    position: [f32; 3],
    color: Rgba,
}

pub(super) const LINE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<LinePiece>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32, 3 => Float32x2, 4 => Unorm8x4
    ],
};
pub(super) const FILL_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<FillCorner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4],
};

/// The overlay of one frame in buffers, by depth mode.
#[derive(Debug)]
pub(super) struct PreparedOverlay {
    pub(super) faint: Kinds<Option<(wgpu::Buffer, u32)>>,
    pub(super) on_top: Kinds<Option<(wgpu::Buffer, u32)>>,
}

impl PreparedOverlay {
    pub(super) fn new(device: &wgpu::Device, frame: &Frame<'_>) -> Self {
        let of_mode = |mode| {
            let overlay = &frame.scene.overlay;
            let fills = overlay.fills.iter().filter(|fill| fill.depth == mode);
            let lines = overlay.polylines.iter().filter(|line| line.depth == mode);
            let corners: Vec<_> = fills
                .flat_map(|fill| fill_corners(fill, frame.camera))
                .collect();
            let pieces: Vec<_> = lines.flat_map(|line| line_pieces(line, frame)).collect();
            Kinds {
                fills: buffer_of(device, &corners),
                lines: buffer_of(device, &pieces),
            }
        };
        Self {
            faint: of_mode(DepthMode::Faint),
            on_top: of_mode(DepthMode::OnTop),
        }
    }
}

fn buffer_of<T: bytemuck::NoUninit>(
    device: &wgpu::Device,
    data: &[T],
) -> Option<(wgpu::Buffer, u32)> {
    if data.is_empty() {
        return None;
    }
    let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("overlay"),
        contents: bytemuck::cast_slice(data),
        usage: wgpu::BufferUsages::VERTEX,
    });
    Some((buffer, data.len() as u32))
}

fn in_view(point: &Point3, camera: &Camera) -> [f32; 3] {
    camera.view_point(point).map(|x| x as f32).into()
}

fn fill_corners(fill: &Fill, camera: &Camera) -> Vec<FillCorner> {
    let corner = |point| FillCorner {
        position: in_view(point, camera),
        color: fill.color,
    };
    fill.triangles.iter().flatten().map(corner).collect()
}

/// The line in straight pieces.
fn line_pieces(line: &Polyline, frame: &Frame<'_>) -> Vec<LinePiece> {
    let scale = frame.scene.scale_factor();
    let width = line.width * scale;
    let screen = screen_size(frame.size);
    let mut so_far = 0.0;
    let mut pieces = Vec::with_capacity(line.points.len());
    for pair in line.points.windows(2) {
        pieces.push(LinePiece {
            from: in_view(&pair[0], frame.camera),
            to: in_view(&pair[1], frame.camera),
            width,
            dash: [line.dash * scale, so_far as f32],
            color: line.color,
        });
        let ends = [&pair[0], &pair[1]].map(|p| frame.camera.project(p, screen));
        if let [Some(a), Some(b)] = ends {
            so_far += (b.x - a.x).hypot(b.y - a.y);
        }
    }
    pieces
}
