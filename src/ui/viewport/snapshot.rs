//! Pictures for files: what the windows show, in twice the size and without what lies over it.

use std::sync::Arc;

use image::RgbaImage;
use image::imageops::replace;

use super::Viewports;
use super::gpu::Gpu;
use crate::app::AppState;
use crate::geometry::Camera;
use crate::jobs::Role;
use crate::render::{Background, Frame, Scene};

/// How much larger than on the screen.
const SCALE: u32 = 2;
/// Longest side of one window's picture.
const MAX_SIDE: u32 = 4096;
/// Pixels between the two windows.
const GAP: u32 = 8;

/// What a window drew last.
pub(super) struct Shot {
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub size: [u32; 2],
}

impl Viewports {
    /// A picture of what the windows show: side by side, or the left one alone when the stamped part
    /// is moved over. `None` before the first frame, without a graphics adapter, or if it fails.
    /// Waits for the graphics card.
    pub fn picture(&mut self, state: &AppState, is_transparent: bool) -> Option<RgbaImage> {
        let left = self.window_picture(Role::Crash, is_transparent);
        if state.view.is_moved_over {
            return left;
        }
        let right = self.window_picture(Role::Stamped, is_transparent);
        match (left, right) {
            (Some(left), Some(right)) => Some(side_by_side(&left, &right)),
            (left, right) => left.or(right),
        }
    }

    /// A picture of one window.
    pub fn window_picture(&mut self, role: Role, is_transparent: bool) -> Option<RgbaImage> {
        let shot = self.windows.get(role).shot.as_ref()?;
        let longest = shot.size[0].max(shot.size[1]).max(1);
        let scale = SCALE.min(MAX_SIDE / longest).max(1);
        let mut scene = (*shot.scene).clone();
        scene.pixels_per_point *= scale as f32;
        if is_transparent {
            scene.background = Background::Transparent;
        }
        let frame = Frame {
            scene: &scene,
            camera: &shot.camera,
            size: shot.size.map(|side| side * scale),
        };
        let mut renderer = self.render_state.as_ref()?.renderer.write();
        let gpu = renderer.callback_resources.get_mut::<Gpu>()?;
        gpu.renderer.picture(&frame).ok()
    }
}

fn side_by_side(left: &RgbaImage, right: &RgbaImage) -> RgbaImage {
    let width = left.width() + GAP + right.width();
    let mut both = RgbaImage::new(width, left.height().max(right.height()));
    replace(&mut both, left, 0, 0);
    replace(&mut both, right, i64::from(left.width() + GAP), 0);
    both
}
