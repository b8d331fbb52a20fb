//! What moves by itself: cameras on their way, the part flying over, the pose gliding. Time is the
//! caller's, in seconds; without motion everything is where it belongs at once.

use crate::geometry::camera::CameraFlight;
use crate::geometry::{Camera, Point3, Rotation, Similarity};

/// Seconds the part takes from one window to the other.
const FLY_SECS: f64 = 0.3;
/// Seconds the part takes to a new pose.
const GLIDE_SECS: f64 = 0.2;

/// A change from one value to another over time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Transition<T> {
    from: T,
    since: f64,
}

impl<T> Transition<T> {
    /// 0 … 1, `None` when it is over.
    fn progress(&self, now: f64, secs: f64) -> Option<f64> {
        let t = (now - self.since) / secs;
        (t < 1.0).then_some(t.max(0.0))
    }
}

/// Slow, fast, slow.
fn eased(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// A camera that follows the one of the state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SmoothCamera {
    goal: Option<Camera>,
    flight: Option<Transition<Camera>>,
}

impl SmoothCamera {
    /// The camera to show now. Jumps become flights if `may_fly`.
    pub fn follow(&mut self, goal: &Camera, now: f64, may_fly: bool) -> Camera {
        if self.goal != Some(*goal) {
            let from = self.at(now);
            self.flight = from
                .filter(|_| may_fly)
                .map(|from| Transition { from, since: now });
            self.goal = Some(*goal);
        }
        self.at(now).unwrap_or(*goal)
    }

    /// Takes a camera that is already shown, as after a drag, so that no flight begins.
    pub fn jump(&mut self, camera: Camera) {
        *self = Self {
            goal: Some(camera),
            flight: None,
        };
    }

    /// True while the camera is on its way.
    pub fn is_moving(&self, now: f64) -> bool {
        let flight = self.flight.as_ref();
        flight.is_some_and(|flight| flight.progress(now, CameraFlight::SECS).is_some())
    }

    /// The camera that is shown at a time, once there is one.
    pub fn at(&self, now: f64) -> Option<Camera> {
        let to = self.goal?;
        let flight = self.flight.as_ref();
        let progress = flight.and_then(|f| Some((f.from, f.progress(now, CameraFlight::SECS)?)));
        Some(match progress {
            Some((from, t)) => CameraFlight { from, to }.at(t),
            None => to,
        })
    }
}

/// The way of the stamped part from the right window (0) to the left one (1).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Crossing {
    is_over: bool,
    transition: Option<Transition<f64>>,
}

impl Crossing {
    /// Where it is now.
    pub fn follow(&mut self, is_over: bool, now: f64, may_fly: bool) -> f64 {
        if is_over != self.is_over {
            let from = self.at(now);
            self.transition = may_fly.then_some(Transition { from, since: now });
            self.is_over = is_over;
        }
        self.at(now)
    }

    /// True while it flies.
    pub fn is_moving(&self, now: f64) -> bool {
        let transition = self.transition.as_ref();
        transition.is_some_and(|t| t.progress(now, FLY_SECS).is_some())
    }

    fn at(&self, now: f64) -> f64 {
        let to = f64::from(u8::from(self.is_over));
        let transition = self.transition.as_ref();
        let progress = transition.and_then(|t| Some((t.from, t.progress(now, FLY_SECS)?)));
        progress.map_or(to, |(from, t)| from + (to - from) * eased(t))
    }
}

/// A pose that follows the one of the state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SmoothPose {
    goal: Option<Similarity>,
    glide: Option<Transition<Similarity>>,
}

impl SmoothPose {
    /// The pose to show now; `center` (of the part, in its own space) goes the straight way.
    pub fn follow(
        &mut self,
        goal: &Similarity,
        center: &Point3,
        now: f64,
        may_glide: bool,
    ) -> Similarity {
        if self.goal != Some(*goal) {
            let from = self.at(center, now);
            self.glide = from
                .filter(|_| may_glide)
                .map(|from| Transition { from, since: now });
            self.goal = Some(*goal);
        }
        self.at(center, now).unwrap_or(*goal)
    }

    /// True while it glides.
    pub fn is_moving(&self, now: f64) -> bool {
        let glide = self.glide.as_ref();
        glide.is_some_and(|glide| glide.progress(now, GLIDE_SECS).is_some())
    }

    fn at(&self, center: &Point3, now: f64) -> Option<Similarity> {
        let to = self.goal?;
        let glide = self.glide.as_ref();
        let progress = glide.and_then(|g| Some((g.from, g.progress(now, GLIDE_SECS)?)));
        Some(match progress {
            Some((from, t)) => between(&from, &to, center, eased(t)),
            None => to,
        })
    }
}

/// The pose at a share of the way: `center` moves straight, the part turns about it by the shortest
/// arc. Poses of different hand have nothing between them.
fn between(from: &Similarity, to: &Similarity, center: &Point3, t: f64) -> Similarity {
    let turn = to.rotation * from.rotation.transpose();
    if turn.determinant() < 0.0 {
        return *to;
    }
    let turn = nalgebra::Rotation3::from_matrix_unchecked(turn);
    let angle = Rotation::from_rotation_matrix(&turn).scaled_axis() * t;
    let rotation = Rotation::new(angle).to_rotation_matrix().into_inner() * from.rotation;
    let scale = from.scale * (to.scale / from.scale).powf(t);
    let (here, there) = (from.apply(center), to.apply(center));
    let now = here + (there - here) * t;
    Similarity {
        rotation,
        scale,
        ..*to
    }
    .taking(center, &now)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;

    fn turned(angle: f64, shift: Vector3) -> Similarity {
        let rotation = Rotation::new(Vector3::z() * angle);
        Similarity {
            rotation: rotation.to_rotation_matrix().into_inner(),
            translation: shift,
            scale: 1.0,
        }
    }

    #[test]
    fn a_glide_ends_at_its_goal_and_takes_the_centre_straight_there() {
        let center = Point3::new(3.0, -1.0, 2.0);
        let (from, to) = (
            turned(0.0, Vector3::zeros()),
            turned(2.0, Vector3::x() * 100.0),
        );
        let mut pose = SmoothPose::default();
        assert_eq!(
            pose.follow(&from, &center, 0.0, true),
            from,
            "no glide to the first pose"
        );
        assert_eq!(pose.follow(&to, &center, 1.0, true), from);
        let half = pose.follow(&to, &center, 1.0 + GLIDE_SECS / 2.0, true);
        let middle = nalgebra::center(&from.apply(&center), &to.apply(&center));
        assert!((half.apply(&center) - middle).norm() < 1e-9);
        assert!((half.angle_to(&from) - 1.0).abs() < 1e-9);
        assert_eq!(pose.follow(&to, &center, 2.0, true), to);
        assert!(!pose.is_moving(2.0));
        assert_eq!(
            pose.follow(&from, &center, 3.0, false),
            from,
            "at once without motion"
        );
    }

    #[test]
    fn a_crossing_can_be_turned_round_on_its_way() {
        let mut crossing = Crossing::default();
        assert_eq!(crossing.follow(true, 0.0, true), 0.0);
        let on_its_way = crossing.follow(true, 0.1, true);
        assert!(on_its_way > 0.1 && on_its_way < 0.5);
        assert!((crossing.follow(false, 0.1, true) - on_its_way).abs() < 1e-12);
        assert_eq!(crossing.follow(false, 1.0, true), 0.0);
    }

    #[test]
    fn a_camera_flies_to_jumps_and_stays_where_it_was_dragged() {
        let mut camera = SmoothCamera::default();
        let first = Camera::default();
        assert_eq!(camera.follow(&first, 0.0, true), first);
        let next = Camera {
            height: 4.0,
            ..first
        };
        assert_eq!(camera.follow(&next, 1.0, true), first);
        assert!((camera.follow(&next, 1.1, true).height - 2.0).abs() < 1e-9);
        let dragged = Camera {
            height: 3.0,
            ..first
        };
        camera.jump(dragged);
        assert_eq!(camera.follow(&dragged, 1.1, true), dragged);
    }
}
