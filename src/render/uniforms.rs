//! The numbers shaders read once per frame and once per drawable. Poses and the camera meet here in
//! `f64`; only their product, small near the target, becomes `f32`.

use super::frame::Frame;
use super::scene::{Background, Drawable, Rgba, Sheet, WipeSide};
use crate::colormap::{Rgb, UNMATCHED};
use crate::geometry::camera::ScreenSize;
use crate::geometry::{Camera, Matrix4, Point3};

/// Mirrors `Frame` in `common.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct FrameUniform {
    clip_from_view: [[f32; 4]; 4],
    eye: [f32; 4],
    screen: [f32; 4],
    section: [f32; 4],
    switches: [f32; 4],
    background_top: [f32; 4],
    background_bottom: [f32; 4],
    edge_color: [f32; 4],
    feature_color: [f32; 4],
    border_color: [f32; 4],
    selection_color: [f32; 4],
    unmatched_color: [f32; 4],
    widths: [f32; 4],
}

/// Mirrors `Drawable` in `common.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct DrawableUniform {
    view_from_mesh: [[f32; 4]; 4],
    color: [f32; 4],
    other_sheet: [f32; 4],
    params: [f32; 4],
    flags: [u32; 4],
}

impl FrameUniform {
    /// The numbers of a frame.
    pub(super) fn new(frame: &Frame<'_>) -> Self {
        let (scene, camera) = (frame.scene, frame.camera);
        let screen = screen_size(frame.size);
        let bounds = scene.bounds();
        let scale = scene.scale_factor();
        let (top, bottom) = match scene.background {
            Background::Gradient { top, bottom } => (top, bottom),
            Background::Transparent => ([0; 3], [0; 3]),
        };
        let wipe = scene.wipe.map_or(-1.0, |share| share * screen.width as f32);
        let lines = &scene.lines;
        Self {
            clip_from_view: columns(&camera.clip_from_view(screen.aspect(), &bounds)),
            eye: [
                camera.eye_distance().unwrap_or(0.0) as f32,
                f32::from(camera.eye_distance().is_some()),
                (camera.height / screen.height) as f32,
                scale,
            ],
            screen: [screen.width as f32, screen.height as f32, 0.0, 0.0],
            section: section_in_view(frame),
            switches: [
                f32::from(scene.section.is_some()),
                wipe,
                scene.exposure(),
                scene.coincidence.unwrap_or(0.0) as f32,
            ],
            background_top: opaque(top),
            background_bottom: opaque(bottom),
            edge_color: unit(lines.edge),
            feature_color: unit(lines.feature),
            border_color: unit(lines.border),
            selection_color: opaque(lines.selection),
            unmatched_color: opaque(UNMATCHED),
            widths: [
                lines.feature_width * scale,
                lines.border_width * scale,
                lines.point_size * scale,
                scene.ambient.clamp(0.0, 1.0),
            ],
        }
    }
}

impl DrawableUniform {
    /// The numbers of drawable `index` of the scene. `other_sheet` is the colour of what it may
    /// coincide with.
    pub(super) fn new(frame: &Frame<'_>, index: usize, other_sheet: Option<Rgb>) -> Self {
        let (drawable, camera) = (&frame.scene.drawables[index], frame.camera);
        let height_px = f64::from(frame.size[1].max(1));
        let origin = drawable.world_from_mesh.apply(&drawable.mesh.origin) + drawable.offset;
        let (first, per_step) = match &drawable.field {
            Some(field) => (field.scale.min, 1.0 / (field.scale.max - field.scale.min)),
            None => (0.0, 0.0),
        };
        // A range of zero shows the middle of the map, as `ColorScale` does.
        let (first, per_step) = if per_step.is_finite() {
            (first, per_step)
        } else {
            (first - 1e30, 0.5e-30)
        };
        let [r, g, b, _] = opaque(drawable.color);
        let screen = ScreenSize {
            width: height_px,
            height: height_px,
        };
        let pixel = camera.pixel_size(screen, &origin);
        Self {
            view_from_mesh: columns(&view_from_mesh(drawable, camera, &origin)),
            color: [r, g, b, drawable.opacity.clamp(0.0, 1.0)],
            other_sheet: other_color(drawable, other_sheet, pixel, frame.scene.scale_factor()),
            params: [
                first as f32,
                per_step as f32,
                drawable.push_back + (drawable.push_back_length / pixel) as f32,
                edge_opacity(drawable, pixel),
            ],
            flags: [
                switches(drawable, other_sheet),
                drawable
                    .parts
                    .as_ref()
                    .map_or(0, |parts| parts.len() as u32),
                0,
                0,
            ],
        }
    }
}

fn view_from_mesh(drawable: &Drawable, camera: &Camera, origin: &Point3) -> Matrix4 {
    let view_from_world = camera.world_from_view.inverse().to_rotation_matrix();
    let turn = view_from_world.matrix() * drawable.world_from_mesh.rotation;
    let mut matrix = Matrix4::identity();
    matrix
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(turn * drawable.world_from_mesh.scale));
    matrix
        .fixed_view_mut::<3, 1>(0, 3)
        .copy_from(&camera.view_point(origin));
    matrix
}

/// Element edges closer together than a few pixels would hide the part behind a grey veil: full from
/// 9 pixels, gone below 2.5.
fn edge_opacity(drawable: &Drawable, pixel: f64) -> f32 {
    let length = drawable.mesh.mean_edge_length * drawable.world_from_mesh.scale;
    ((length / pixel - 2.5) / 6.5).clamp(0.0, 1.0) as f32
}

/// The other sheet's colour, and how strong the hatch of back sides is: full on parts larger than 240
/// points, none below 80.
fn other_color(drawable: &Drawable, other: Option<Rgb>, pixel: f64, scale: f32) -> [f32; 4] {
    let [r, g, b, _] = opaque(other.unwrap_or_default());
    let size = drawable.mesh.bounds().diagonal() * drawable.world_from_mesh.scale;
    let points = size / pixel / f64::from(scale);
    [r, g, b, ((points - 80.0) / 160.0).clamp(0.0, 1.0) as f32]
}

fn switches(drawable: &Drawable, other_sheet: Option<Rgb>) -> u32 {
    let sheet = drawable.sheet.filter(|_| other_sheet.is_some());
    [
        drawable.field.is_some(),
        drawable.world_from_mesh.is_mirrored(),
        drawable.wipe == WipeSide::Left,
        drawable.wipe == WipeSide::Right,
        sheet == Some(Sheet::First),
        sheet == Some(Sheet::Second),
        !drawable.style.surface,
        drawable
            .field
            .as_ref()
            .is_some_and(|field| field.scale.hides_beyond),
    ]
    .iter()
    .enumerate()
    .map(|(bit, &on)| u32::from(on) << bit)
    .sum()
}

/// The section plane in view space: normal and constant; nothing is cut by a zero normal.
fn section_in_view(frame: &Frame<'_>) -> [f32; 4] {
    let Some(section) = frame.scene.section else {
        return [0.0; 4];
    };
    let normal = section.normal.try_normalize(0.0).unwrap_or_default();
    let normal = frame.camera.view_direction(&normal);
    let constant = -normal.dot(&frame.camera.view_point(&section.point));
    [normal.x, normal.y, normal.z, constant].map(|x| x as f32)
}

pub(super) fn screen_size(size: [u32; 2]) -> ScreenSize {
    ScreenSize::new(size[0].max(1), size[1].max(1))
}

fn columns(matrix: &Matrix4) -> [[f32; 4]; 4] {
    matrix.map(|x| x as f32).into()
}

fn opaque([r, g, b]: Rgb) -> [f32; 4] {
    unit([r, g, b, 255])
}

fn unit(color: Rgba) -> [f32; 4] {
    color.map(|byte| f32::from(byte) / 255.0)
}
