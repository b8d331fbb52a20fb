//! The handles checked against closed forms.

use super::*;
use crate::geometry::camera::{Camera, Projection, ScreenSize, StandardView};
use crate::geometry::{Matrix3, Point3};

const PIVOT: Point3 = Point3::new(5000.0, -3000.0, 800.0);

struct Scene {
    camera: Camera,
    frame: MoveFrame,
    gizmo: Gizmo,
}

const SCREEN: ScreenSize = ScreenSize {
    width: 800.0,
    height: 600.0,
};

impl Scene {
    fn new(view: StandardView, projection: Projection) -> Self {
        let mut camera = Camera {
            target: PIVOT,
            height: 1200.0,
            projection,
            ..Camera::default()
        };
        camera.set_standard_view(view);
        let axes = *camera.world_from_view.to_rotation_matrix().matrix();
        let frame = MoveFrame::new(PIVOT, &Similarity::identity(), axes);
        Self {
            camera,
            frame,
            gizmo: Gizmo::default(),
        }
    }

    fn interact(&mut self, pointer: PointerInput) -> Option<GizmoDelta> {
        let view = GizmoView {
            camera: &self.camera,
            screen: SCREEN,
            frame: &self.frame,
            axes: AxisFrame::Global,
        };
        self.gizmo.interact(&view, &pointer)
    }

    fn hover(&mut self, at: [f64; 2]) -> Option<Handle> {
        self.interact(PointerInput {
            position: Some(at),
            ..PointerInput::default()
        });
        self.gizmo.active()
    }

    fn press(&mut self, at: [f64; 2]) {
        self.interact(PointerInput {
            position: Some(at),
            is_pressed: true,
            is_down: true,
            ..PointerInput::default()
        });
    }

    fn drag(&mut self, at: [f64; 2], shift: bool, ctrl: bool) -> Option<(Similarity, String)> {
        let delta = self.interact(PointerInput {
            position: Some(at),
            is_down: true,
            shift,
            ctrl,
            ..PointerInput::default()
        });
        match delta {
            Some(GizmoDelta::Drag { delta, name, .. }) => Some((delta, name)),
            _ => None,
        }
    }

    /// The pixel of a point that lies off the pivot.
    fn pixel(&self, offset: Vector3) -> [f64; 2] {
        let at = self.camera.project(&(PIVOT + offset), SCREEN).unwrap();
        [at.x, at.y]
    }

    /// World length of so many pixels at the pivot.
    fn pixels(&self, n: f64) -> f64 {
        n * self.camera.pixel_size(SCREEN, &PIVOT)
    }
}

fn both() -> [Projection; 2] {
    [Projection::Orthographic, Projection::perspective()]
}

#[test]
fn an_arrow_keeps_the_grabbed_point_under_the_pointer() {
    for projection in both() {
        for axis in Axis::ALL {
            let mut scene = Scene::new(StandardView::Isometric, projection);
            let direction = scene.frame.axis(axis, AxisFrame::Global);
            let grab = direction * scene.pixels(60.0);
            assert_eq!(scene.hover(scene.pixel(grab)), Some(Handle::Arrow(axis)));
            scene.press(scene.pixel(grab));
            for distance in [10.0, -37.5, 123.25] {
                let (delta, name) = scene
                    .drag(scene.pixel(grab + direction * distance), false, false)
                    .unwrap();
                let expected = direction * distance;
                assert!((delta.translation - expected).norm() < 1e-6, "{delta:?}");
                let letter = axis.letter();
                assert_eq!(
                    name,
                    format!("Move {} along {letter}", short_number(distance))
                );
                assert_eq!(
                    scene.gizmo.motion_name(),
                    Some(name),
                    "shown while it goes on"
                );
            }
        }
    }
}

#[test]
fn a_press_alone_moves_nothing() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
    let at = scene.pixel(Vector3::x() * scene.pixels(60.0));
    scene.press([at[0] + 3.0, at[1] + 4.0]);
    assert!(scene.gizmo.is_dragging());
    assert_eq!(scene.drag([at[0] + 3.0, at[1] + 4.0], false, false), None);
    let end = scene.interact(PointerInput {
        position: Some(at),
        ..PointerInput::default()
    });
    assert_eq!(end, Some(GizmoDelta::End));
    assert!(!scene.gizmo.is_dragging());
    assert_eq!(scene.gizmo.motion_name(), None);
}

#[test]
fn a_square_moves_in_its_plane() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::perspective());
    let inside = scene.pixels(37.0);
    let grab = Vector3::new(inside, inside, 0.0);
    assert_eq!(
        scene.hover(scene.pixel(grab)),
        Some(Handle::Square(Axis::Z))
    );
    scene.press(scene.pixel(grab));
    let moved = Vector3::new(40.0, -25.0, 0.0);
    let (delta, _) = scene.drag(scene.pixel(grab + moved), false, false).unwrap();
    assert!((delta.translation - moved).norm() < 1e-6);
}

#[test]
fn a_ring_turns_by_the_angle_that_was_swept() {
    for projection in both() {
        let mut scene = Scene::new(StandardView::Top, projection);
        let radius = scene.pixels(80.0);
        let on_ring = |degrees: f64| {
            let angle = degrees.to_radians();
            Vector3::new(angle.cos(), angle.sin(), 0.0) * radius
        };
        assert_eq!(
            scene.hover(scene.pixel(on_ring(20.0))),
            Some(Handle::Ring(Axis::Z))
        );
        scene.press(scene.pixel(on_ring(20.0)));
        let mut last = None;
        // More than half a turn, in steps, counts on.
        for degrees in [60.0, 110.0, 170.0, 230.0, 250.0] {
            last = scene.drag(scene.pixel(on_ring(degrees)), false, false);
        }
        let (delta, name) = last.unwrap();
        assert_eq!(name, "Rotate 230° about Z");
        let expected = rotation_about(&PIVOT, &Vector3::z(), 230f64.to_radians());
        assert!((delta.to_matrix4() - expected.to_matrix4()).amax() < 1e-6);
        assert!((delta.apply(&PIVOT) - PIVOT).norm() < 1e-9);
    }
}

#[test]
fn a_ring_seen_from_its_edge_still_turns() {
    let mut scene = Scene::new(StandardView::Front, Projection::Orthographic);
    let grab = scene.pixel(Vector3::x() * scene.pixels(50.0));
    // From the front the ring about z is a line along x, as is the arrow; take the far side.
    let left = scene.pixel(Vector3::x() * scene.pixels(-50.0));
    assert_eq!(scene.hover(left), Some(Handle::Ring(Axis::Z)));
    scene.press(left);
    let (delta, _) = scene.drag([left[0] + 40.0, left[1]], false, false).unwrap();
    // The near side of the wheel goes right, that is along +x, seen from −y: about +z.
    let expected = rotation_about(&PIVOT, &Vector3::z(), 0.5);
    assert!((delta.to_matrix4() - expected.to_matrix4()).amax() < 1e-6);
    assert_ne!(grab, left);
}

#[test]
fn the_outer_ring_turns_about_the_line_of_sight() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
    let (center, radius) = ([400.0, 300.0], RADIUS);
    let at = |degrees: f64| {
        let angle = degrees.to_radians();
        [
            center[0] + radius * angle.cos(),
            center[1] - radius * angle.sin(),
        ]
    };
    assert_eq!(scene.hover(at(10.0)), Some(Handle::ViewRing));
    scene.press(at(10.0));
    let (delta, name) = scene.drag(at(55.0), false, false).unwrap();
    assert_eq!(name, "Rotate 45° about the view axis");
    let axis = -scene.camera.forward();
    let expected = rotation_about(&PIVOT, &axis, 45f64.to_radians());
    assert!((delta.to_matrix4() - expected.to_matrix4()).amax() < 1e-6);
}

#[test]
fn modifiers_before_the_press_belong_to_the_camera() {
    for (shift, ctrl) in [(true, false), (false, true)] {
        let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
        let position = Some(scene.pixel(Vector3::x() * scene.pixels(60.0)));
        scene.interact(PointerInput {
            position,
            is_pressed: true,
            is_down: true,
            shift,
            ctrl,
            ..PointerInput::default()
        });
        assert!(!scene.gizmo.is_dragging());
    }
}

#[test]
fn after_the_press_shift_slows_down_and_ctrl_snaps() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
    let grab = Vector3::x() * scene.pixels(60.0);
    let to = |scene: &Scene, x: f64| scene.pixel(grab + Vector3::x() * x);
    scene.press(scene.pixel(grab));
    let (delta, _) = scene.drag(to(&scene, 100.0), true, false).unwrap();
    assert!((delta.translation.x - 10.0).abs() < 1e-6);
    let (delta, _) = scene.drag(to(&scene, 200.0), false, false).unwrap();
    assert!((delta.translation.x - 110.0).abs() < 1e-6);
    // 2 units a pixel: six pixels are 12, so the step is 100, with Shift 10.
    let (delta, _) = scene.drag(to(&scene, 233.0), false, true).unwrap();
    assert!((delta.translation.x - 100.0).abs() < 1e-9);
    let (delta, _) = scene.drag(to(&scene, 233.0), true, true).unwrap();
    assert!((delta.translation.x - 140.0).abs() < 1e-9);
}

#[test]
fn the_camera_may_move_during_a_drag() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
    let grab = Vector3::x() * scene.pixels(60.0);
    scene.press(scene.pixel(grab));
    scene.drag(scene.pixel(grab + Vector3::x() * 50.0), false, false);
    let held = scene.pixel(grab + Vector3::x() * 50.0);
    scene.camera.height *= 0.5;
    assert_eq!(
        scene.drag(held, false, false),
        None,
        "zooming moves nothing"
    );
}

#[test]
fn escape_takes_the_drag_back() {
    let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
    let grab = Vector3::x() * scene.pixels(60.0);
    scene.press(scene.pixel(grab));
    scene.drag(scene.pixel(grab * 2.0), false, false);
    let end = scene.interact(PointerInput {
        position: Some(scene.pixel(grab)),
        is_down: true,
        is_abandoned: true,
        ..PointerInput::default()
    });
    assert!(matches!(end, Some(GizmoDelta::Abandon(_))), "{end:?}");
}

#[test]
fn nothing_is_hit_beside_the_handles_and_size_ignores_the_zoom() {
    for height in [1.0, 1e3, 1e6] {
        let mut scene = Scene::new(StandardView::Isometric, Projection::Orthographic);
        scene.camera.height = height;
        assert_eq!(
            scene.hover([400.0 + RADIUS + 7.0, 300.0]),
            Some(Handle::ViewRing)
        );
        assert_eq!(scene.hover([400.0 + RADIUS + 9.0, 300.0]), None);
        assert_eq!(scene.hover([400.0, 300.0]), Some(Handle::Dot));
    }
}

#[test]
fn an_arrow_towards_the_viewer_cannot_be_grabbed() {
    let mut scene = Scene::new(StandardView::Top, Projection::Orthographic);
    let hits: Vec<_> = (0..120)
        .filter_map(|i| scene.hover([400.0 + f64::from(i), 300.0 - f64::from(i)]))
        .collect();
    assert!(!hits.contains(&Handle::Arrow(Axis::Z)));
    assert_eq!(scene.frame.part, Matrix3::identity());
}
