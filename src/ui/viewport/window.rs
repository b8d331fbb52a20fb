//! What one 3D window remembers between frames, and how its camera follows the parts.

use std::sync::Arc;

use egui::{EventFilter, Rect, Response, Vec2};

use super::meshes::ShownMesh;
use super::motion::SmoothCamera;
use super::navigation::{Navigator, pos_of};
use super::pointing::Pointing;
use super::snapshot::LastFrame;
use super::tools::Tools;
use crate::app::{AppState, Command, StampedPose, ViewCommand};
use crate::geometry::{Camera, Rotation};
use crate::role::{PerRole, Role};
use crate::text::counted;

/// A pair smaller than this share of the picture's height is fitted again when its pose changes.
const SMALL: f64 = 0.4;
/// A part that turned by more is looked at anew, radians.
const LARGE_TURN: f64 = 0.35;

/// What one window remembers.
#[derive(Default)]
pub(super) struct Window {
    pub camera: SmoothCamera,
    pub navigator: Navigator,
    pub tools: Tools,
    pub pointing: Pointing,
    /// The meshes that were drawn last, shown until newer ones are ready.
    pub shown: PerRole<Option<Arc<ShownMesh>>>,
    /// The pose the camera has followed the part to.
    followed: StampedPose,
    /// The project whose cameras were taken over last.
    known_restored: u64,
    /// A project was opened just now: everything is where it belongs at once.
    pub is_restored: bool,
    /// What was drawn last, for pictures in files.
    pub last_frame: Option<LastFrame>,
    pub has_picture: bool,
    /// Its size, and for how many frames it has had it.
    size: Vec2,
    n_frames: u32,
}

/// A camera is fitted to a new size in the frame after it, and once more when its legend has its place.
const FRAMES_TO_FIT: u32 = 3;

impl Window {
    /// A project brings its own cameras: parts and pose that came with it are neither fitted nor
    /// followed.
    pub fn notice_restored(&mut self, state: &AppState) {
        let n_restored = state.view.n_restored;
        self.is_restored = std::mem::replace(&mut self.known_restored, n_restored) != n_restored;
        if self.is_restored {
            self.followed = state.document.pose;
        }
    }

    /// False right after the window got another size: a flight to the camera that is fitted to it would show the part
    /// cut, for long where frames are slow. To be asked once in a frame.
    pub fn has_settled(&mut self, rect: Rect) -> bool {
        if self.size == rect.size() {
            self.n_frames = self.n_frames.saturating_add(1);
        } else {
            self.size = rect.size();
            self.n_frames = 0;
        }
        self.n_frames >= FRAMES_TO_FIT
    }

    /// A match may take the stamped part far away or turn it over. Then both windows show the parts
    /// from the same side. Where another step takes it away, the camera goes with the part, so that it
    /// looks as it did.
    pub fn follow_part(
        &mut self,
        role: Role,
        state: &AppState,
        rect: Rect,
        is_driven: bool,
    ) -> Option<Following> {
        let pose = state.document.pose;
        let is_alone = role == Role::Stamped && !state.view.is_moved_over;
        if !is_alone || is_driven || pose.revision == self.followed.revision {
            return None;
        }
        let before = std::mem::replace(&mut self.followed, pose);
        let center = state.document.stamped_center()?;
        let camera = *state.view.cameras.get(role);
        let seen = pos_of(rect, &camera, &center);
        let is_inside = seen.is_some_and(|at| rect.shrink2(rect.size() * 0.2).contains(at));
        let turn = before.crash_from_stamped.angle_to(&pose.crash_from_stamped);
        if is_inside && turn < LARGE_TURN {
            None
        } else if state.document.current_result().is_some() {
            let side = state.view.cameras.crash.world_from_view;
            Some(Following::Beside(Camera {
                world_from_view: side,
                ..camera
            }))
        } else if is_inside {
            // It turned in its place: that is what is to be seen, so the camera does not turn with it.
            let is_fitted = state.view.is_fitted(role);
            is_fitted.then_some(Following::Beside(camera))
        } else if state.view.are_linked {
            // Turning the camera would turn the other window's too.
            Some(Following::Beside(camera))
        } else {
            let carried = carried(&camera, &before, &pose);
            // A window that shows the part whole goes on to do so. It may have been fitted to the new
            // pose already, and would lose the part if it were moved once more.
            Some(if state.view.is_fitted(role) {
                Following::Beside(Camera {
                    world_from_view: carried.world_from_view,
                    ..camera
                })
            } else {
                Following::Carried(carried)
            })
        }
    }

    /// Two parts that came together out of a great distance are small in the picture: fits it again.
    pub fn fit_pair(&mut self, state: &AppState, is_driven: bool, commands: &mut Vec<Command>) {
        let pose = state.document.pose;
        if !state.view.is_moved_over || is_driven || pose.revision == self.followed.revision {
            return;
        }
        self.followed = pose;
        let size = state.visible_bounds(Role::Crash).diagonal();
        if size < SMALL * state.view.cameras.crash.height {
            commands.push(ViewCommand::FitAll(Role::Crash).into());
        }
    }
}

/// How a window's camera takes part in a move of its part.
pub(super) enum Following {
    /// It goes with the part.
    Carried(Camera),
    /// It looks from here, fitted to the part.
    Beside(Camera),
}

/// The camera that shows a part at its new pose as this one did at the old pose.
fn carried(camera: &Camera, before: &StampedPose, now: &StampedPose) -> Camera {
    let motion = now
        .crash_from_stamped
        .after(&before.crash_from_stamped.inverse());
    let target = motion.apply(&camera.target);
    if motion.is_mirrored() {
        return Camera { target, ..*camera };
    }
    let turn = nalgebra::Rotation3::from_matrix_unchecked(motion.rotation);
    Camera {
        target,
        world_from_view: Rotation::from_rotation_matrix(&turn) * camera.world_from_view,
        height: camera.height * motion.scale,
        ..*camera
    }
}

/// Tells the state which window has the keys.
pub(super) fn tell_focus(
    response: &Response,
    role: Role,
    state: &AppState,
    commands: &mut Vec<Command>,
) {
    // A quick click is over before its frame is drawn.
    let is_pressed = response.is_pointer_button_down_on() || response.clicked();
    if is_pressed {
        response.request_focus();
    }
    if (is_pressed || response.gained_focus()) && state.view.focus != role {
        commands.push(ViewCommand::SetFocus(role).into());
    }
    if response.has_focus() {
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        let set_filter = |m: &mut egui::Memory| m.set_focus_lock_filter(response.id, filter);
        response.ctx.memory_mut(set_filter);
    }
}

/// What a screen reader says about a window.
pub(super) fn summary(state: &AppState, role: Role) -> String {
    let name = match role {
        Role::Crash => "Crash part",
        Role::Stamped => "Stamped part",
    };
    let Some(part) = state.document.part(role) else {
        return format!("{name}, nothing loaded");
    };
    let triangles = counted(part.reduced_mesh().n_triangles(), "triangle");
    let with = match role {
        Role::Crash if state.view.is_moved_over => ", with the stamped part",
        _ => "",
    };
    if let Some(free) = state.free_window().filter(|_| role == Role::Stamped) {
        return format!("{name}, moved to the left window; here: {}", free.label());
    }
    let camera = state.view.cameras.get(state.view.camera_of(role));
    let view = camera.standard_view().map_or_else(String::new, |view| {
        format!(", {} view", view.label().to_lowercase())
    });
    let prompt = state.distance_prompt();
    let prompt = prompt.map_or_else(String::new, |prompt| format!(". {prompt}"));
    format!("{name}, {triangles}{with}{view}{prompt}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::rotation_about;
    use crate::geometry::camera::ScreenSize;
    use crate::geometry::{Point3, Vector3};

    #[test]
    fn cameras_fly_once_the_window_has_kept_its_size() {
        let mut window = Window::default();
        let sized = |width: f32| Rect::from_min_size(egui::Pos2::ZERO, Vec2::new(width, 300.0));
        for width in [400.0, 600.0] {
            let flies = [0, 1, 2, 3].map(|_| window.has_settled(sized(width)));
            assert_eq!(flies, [false, false, false, true], "{width}");
        }
        // It may lie elsewhere.
        let moved = sized(600.0).translate(Vec2::new(40.0, 0.0));
        assert!(window.has_settled(moved));
    }

    #[test]
    fn a_carried_camera_shows_the_part_as_before() {
        let pose = |angle| StampedPose {
            crash_from_stamped: rotation_about(
                &Point3::new(500.0, 0.0, 20.0),
                &Vector3::new(1.0, 2.0, -0.5),
                angle,
            ),
            revision: 1,
        };
        let (before, now) = (pose(0.3), pose(2.0));
        let camera = Camera {
            height: 80.0,
            ..Camera::default()
        };
        let carried = carried(&camera, &before, &now);
        let screen = ScreenSize::new(400, 300);
        for point in [Point3::new(3.0, 4.0, 5.0), Point3::new(-20.0, 0.0, 7.0)] {
            let seen = |camera: &Camera, pose: &StampedPose| {
                let at = camera.project(&pose.crash_from_stamped.apply(&point), screen);
                at.map(|at| [at.x, at.y]).unwrap()
            };
            let [old, new] = [seen(&camera, &before), seen(&carried, &now)];
            assert!((old[0] - new[0]).hypot(old[1] - new[1]) < 1e-6);
        }
    }
}
