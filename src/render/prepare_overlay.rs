//! Lines, markers and fills of a frame as vertex buffers.

use wgpu::util::DeviceExt as _;

use super::frame::Frame;
use super::scene::{DepthMode, Fill, Marker, MarkerShape, Polyline, Rgba};
use super::uniforms::screen_size;
use crate::geometry::{Camera, Point3};

/// Length and width of an arrow head in line widths.
const ARROW_HEAD: [f32; 2] = [7.0, 5.0];

/// One of each: fills first, because lines and markers lie on them.
#[derive(Debug)]
pub(super) struct Kinds<T> {
    pub(super) fills: T,
    pub(super) lines: T,
    pub(super) markers: T,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct LinePiece {
    from: [f32; 3],
    to: [f32; 3],
    widths: [f32; 2],
    dash: [f32; 2],
    color: Rgba,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct MarkerSpot {
    position: [f32; 3],
    size: f32,
    shape: u32,
    color: Rgba,
    rim: Rgba,
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
        0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x2, 4 => Unorm8x4
    ],
};
pub(super) const MARKER_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<MarkerSpot>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32, 2 => Uint32, 3 => Unorm8x4, 4 => Unorm8x4
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
    pub(super) tested: Kinds<Option<(wgpu::Buffer, u32)>>,
    pub(super) faint: Kinds<Option<(wgpu::Buffer, u32)>>,
    pub(super) on_top: Kinds<Option<(wgpu::Buffer, u32)>>,
}

impl PreparedOverlay {
    pub(super) fn new(device: &wgpu::Device, frame: &Frame<'_>) -> Self {
        let of_mode = |mode| {
            let overlay = &frame.scene.overlay;
            let fills = overlay.fills.iter().filter(|fill| fill.depth == mode);
            let lines = overlay.polylines.iter().filter(|line| line.depth == mode);
            let markers = overlay.markers.iter().filter(|marker| marker.depth == mode);
            let corners: Vec<_> = fills
                .flat_map(|fill| fill_corners(fill, frame.camera))
                .collect();
            let pieces: Vec<_> = lines.flat_map(|line| line_pieces(line, frame)).collect();
            let spots: Vec<_> = markers.map(|marker| marker_spot(marker, frame)).collect();
            Kinds {
                fills: buffer_of(device, &corners),
                lines: buffer_of(device, &pieces),
                markers: buffer_of(device, &spots),
            }
        };
        Self {
            tested: of_mode(DepthMode::Tested),
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

fn marker_spot(marker: &Marker, frame: &Frame<'_>) -> MarkerSpot {
    let shape = match marker.shape {
        MarkerShape::Disc => 0,
        MarkerShape::Ring => 1,
        MarkerShape::Square => 2,
        MarkerShape::Triangle => 3,
        MarkerShape::Cross => 4,
    };
    MarkerSpot {
        position: in_view(&marker.position, frame.camera),
        size: marker.size * frame.scene.scale_factor(),
        shape,
        color: marker.color,
        rim: marker.rim,
    }
}

/// The line in straight pieces; an arrow's last piece stops where its head begins.
fn line_pieces(line: &Polyline, frame: &Frame<'_>) -> Vec<LinePiece> {
    let scale = frame.scene.scale_factor();
    let width = line.width * scale;
    let screen = screen_size(frame.size);
    let mut points = line.points.clone();
    let head = if line.arrow {
        cut_head(&mut points, width, frame)
    } else {
        None
    };
    let mut so_far = 0.0;
    let mut pieces = Vec::with_capacity(points.len());
    let piece = |from: &Point3, to: &Point3, widths, dash| LinePiece {
        from: in_view(from, frame.camera),
        to: in_view(to, frame.camera),
        widths,
        dash,
        color: line.color,
    };
    for pair in points.windows(2) {
        let dash = [line.dash * scale, so_far as f32];
        pieces.push(piece(&pair[0], &pair[1], [width; 2], dash));
        let ends = [&pair[0], &pair[1]].map(|p| frame.camera.project(p, screen));
        if let [Some(a), Some(b)] = ends {
            so_far += (b.x - a.x).hypot(b.y - a.y);
        }
    }
    if let Some([base, tip]) = head {
        pieces.push(piece(&base, &tip, [ARROW_HEAD[1] * width, 0.0], [0.0; 2]));
    }
    pieces
}

/// Shortens the last piece by the arrow head, or by all of it if it is shorter; returns the head's
/// ends. `None` for a line without pieces.
fn cut_head(points: &mut [Point3], width: f32, frame: &Frame<'_>) -> Option<[Point3; 2]> {
    let [.., from, tip] = points else {
        return None;
    };
    let pixel = frame.camera.pixel_size(screen_size(frame.size), tip);
    let length = (*tip - *from).norm();
    let head = (f64::from(ARROW_HEAD[0] * width) * pixel).min(length);
    let end = *tip;
    if length > 0.0 {
        *tip -= (*tip - *from) * (head / length);
    }
    Some([*tip, end])
}
