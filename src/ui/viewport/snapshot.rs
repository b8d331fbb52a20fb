//! Pictures for files: what the windows show, in any size and without what lies over it.

use std::sync::Arc;

use image::RgbaImage;
use image::imageops::replace;

use super::Viewports;
use super::gpu::Gpu;
use crate::app::{AppState, FreeWindow, PictureChoice, PictureSize, PictureWindows};
use crate::geometry::Camera;
use crate::render::{Background, Frame, Scene};
use crate::report::picture::Picture;
use crate::role::Role;

/// Pixels between the two windows.
const GAP: u32 = 8;

/// What a window drew last.
pub(super) struct LastFrame {
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub size: [u32; 2],
}

impl Viewports {
    /// A picture of what the windows show: as chosen, or side by side, or the left one alone when nothing
    /// is in the right one. `None` before the first frame, without a graphics adapter, or if it
    /// fails. Waits for the graphics card.
    pub fn picture(&mut self, state: &AppState, choice: &PictureChoice) -> Option<Picture> {
        let is_alone = state.free_window() == Some(FreeWindow::Nothing);
        let roles: &[Role] = match choice.windows {
            PictureWindows::AsShown if is_alone => &[Role::Crash],
            PictureWindows::AsShown => &Role::ALL,
            PictureWindows::Left => &[Role::Crash],
            PictureWindows::Right => &[Role::Stamped],
        };
        let mut pictures = Vec::new();
        for &role in roles {
            pictures.extend(self.window_picture(role, choice, roles.len() as u32));
        }
        let picture = match &pictures[..] {
            [] => return None,
            [one] => one.clone(),
            [left, right, ..] => side_by_side(left, right),
        };
        Some(Picture {
            width: picture.width() as usize,
            height: picture.height() as usize,
            rgba: picture.into_raw(),
        })
    }

    /// A picture of one of `n_windows` that share the width.
    pub fn window_picture(
        &mut self,
        role: Role,
        choice: &PictureChoice,
        n_windows: u32,
    ) -> Option<RgbaImage> {
        let last_frame = self.windows.get(role).last_frame.as_ref()?;
        let size = size_of(last_frame.size, choice.size, (role, n_windows));
        let mut scene = (*last_frame.scene).clone();
        scene.pixels_per_point *= size[1] as f32 / last_frame.size[1].max(1) as f32;
        if choice.is_transparent {
            scene.background = Background::Transparent;
        }
        let mut camera = last_frame.camera;
        camera.height *= widened(last_frame.size, size);
        let frame = Frame {
            scene: &scene,
            camera: &camera,
            size,
        };
        let mut renderer = self.render_state.as_ref()?.renderer.write();
        let gpu = renderer.callback_resources.get_mut::<Gpu>()?;
        gpu.renderer.picture(&frame).ok()
    }
}

/// Pixels of the picture of one of `n_windows`, neither side above the largest. Of a width that cannot be halved the
/// left one has the pixel more.
fn size_of(shown: [u32; 2], wanted: PictureSize, (role, n_windows): (Role, u32)) -> [u32; 2] {
    let largest = *PictureSize::SIDES.end();
    match wanted {
        PictureSize::Window(factor) => {
            let longest = shown[0].max(shown[1]).max(1);
            let factor = factor.min(largest / longest).max(1);
            shown.map(|side| (side * factor).max(1))
        }
        PictureSize::Pixels([width, height]) => {
            let both = width.saturating_sub(GAP * (n_windows - 1));
            let own = match role {
                Role::Crash => both.div_ceil(n_windows),
                Role::Stamped => both / n_windows,
            };
            [own, height].map(|side| side.clamp(1, largest))
        }
    }
}

/// How much higher the view must be so that a narrower picture shows all that the window does.
fn widened(shown: [u32; 2], size: [u32; 2]) -> f64 {
    let aspect = |[width, height]: [u32; 2]| f64::from(width.max(1)) / f64::from(height.max(1));
    (aspect(shown) / aspect(size)).max(1.0)
}

fn side_by_side(left: &RgbaImage, right: &RgbaImage) -> RgbaImage {
    let width = left.width() + GAP + right.width();
    let mut both = RgbaImage::new(width, left.height().max(right.height()));
    replace(&mut both, left, 0, 0);
    replace(&mut both, right, i64::from(left.width() + GAP), 0);
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_the_size_that_was_chosen() {
        let shown = [500, 400];
        let [left, right] = [Role::Crash, Role::Stamped];
        let four = PictureSize::Window(4);
        assert_eq!(size_of(shown, four, (left, 2)), [2000, 1600]);
        for width in [1920, 1921] {
            let full = PictureSize::Pixels([width, 1080]);
            for role in Role::ALL {
                assert_eq!(size_of(shown, full, (role, 1)), [width, 1080]);
            }
            let both = [left, right].map(|role| size_of(shown, full, (role, 2)));
            assert_eq!(both[0][0] + GAP + both[1][0], width);
            assert_eq!(both.map(|size| size[1]), [1080; 2]);
        }
        assert_eq!(size_of([3000, 10], four, (left, 1)), [3000, 10]);
    }

    #[test]
    fn nothing_that_was_seen_is_cut_off() {
        assert_eq!(widened([500, 400], [1000, 400]), 1.0);
        assert_eq!(widened([500, 400], [250, 400]), 2.0);
    }
}
