//! The camera checked against closed forms.

use super::*;

const SCREEN: ScreenSize = ScreenSize {
    width: 640.0,
    height: 400.0,
};

fn cameras() -> Vec<Camera> {
    let rotation = Rotation::new(Vector3::new(0.4, -0.8, 0.3));
    let camera = |projection| Camera {
        target: Point3::new(5000.0, -200.0, 900.0),
        world_from_view: rotation,
        height: 300.0,
        projection,
    };
    vec![
        camera(Projection::Orthographic),
        camera(Projection::perspective()),
    ]
}

fn scene() -> Aabb {
    Aabb {
        min: Point3::new(4900.0, -250.0, 850.0),
        max: Point3::new(5100.0, -150.0, 950.0),
    }
}

fn assert_same_pixel(a: Option<ScreenPoint>, b: Option<ScreenPoint>) {
    let (a, b) = (a.unwrap(), b.unwrap());
    assert!(
        (a.x - b.x).abs() < 1e-6 && (a.y - b.y).abs() < 1e-6,
        "{a:?} {b:?}"
    );
}

#[test]
fn rays_and_points_meet() {
    for camera in cameras() {
        for corner in scene().corners() {
            let seen = camera.project(&corner, SCREEN).unwrap();
            let back = camera.unproject([seen.x, seen.y], SCREEN, &corner);
            assert!((back - corner).norm() < 1e-9);
            let ray = camera.ray([seen.x, seen.y], SCREEN, &scene());
            let along = (corner - ray.origin).dot(&ray.direction);
            assert!(along > 0.0, "the ray starts in front of the scene");
            assert!((ray.origin + ray.direction * along - corner).norm() < 1e-9);
        }
    }
}

#[test]
fn the_clip_matrix_agrees_with_project() {
    for camera in cameras() {
        let clip = camera.clip_from_view(SCREEN.aspect(), &scene());
        for corner in scene().corners() {
            let seen = camera.project(&corner, SCREEN).unwrap();
            let c = clip * camera.view_point(&corner).push(1.0);
            let x = (c.x / c.w + 1.0) / 2.0 * SCREEN.width;
            let y = (1.0 - c.y / c.w) / 2.0 * SCREEN.height;
            assert!((x - seen.x).abs() < 1e-6 && (y - seen.y).abs() < 1e-6);
            assert!((0.0..=1.0).contains(&(c.z / c.w)), "{}", c.z / c.w);
        }
        let (far, near) = camera.depth_range(&scene());
        let depth = |z: f64| {
            let c = clip * nalgebra::Vector4::new(0.0, 0.0, z, 1.0);
            c.z / c.w
        };
        assert!((depth(near) - 1.0).abs() < 1e-9 && depth(far).abs() < 1e-9);
    }
}

#[test]
fn orbiting_keeps_the_pivot_on_its_pixel() {
    let pivot = Point3::new(5040.0, -170.0, 880.0);
    for style in [OrbitStyle::Turntable, OrbitStyle::Free] {
        for mut camera in cameras() {
            let before = camera.project(&pivot, SCREEN);
            for _ in 0..50 {
                camera.orbit(style, &pivot, 0.11, 0.07);
            }
            assert_same_pixel(camera.project(&pivot, SCREEN), before);
            camera.roll(&pivot, 0.5);
            assert_same_pixel(camera.project(&pivot, SCREEN), before);
        }
    }
}

#[test]
fn dragging_right_moves_the_near_side_right() {
    for style in [OrbitStyle::Turntable, OrbitStyle::Free] {
        let mut camera = Camera::default();
        let near = Point3::from(-camera.forward() * 0.1);
        camera.orbit(style, &Point3::origin(), 0.1, 0.0);
        assert!(camera.view_point(&near).x > 0.0, "{style:?}");
        let near = Point3::from(-camera.forward() * 0.1);
        camera.orbit(style, &Point3::origin(), 0.0, 0.1);
        assert!(camera.view_point(&near).y > 0.0, "{style:?}");
    }
}

#[test]
fn the_turntable_keeps_the_horizon_and_passes_the_pole() {
    let mut camera = Camera::default();
    for _ in 0..40 {
        camera.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.3, 0.1);
        assert!(camera.right().z.abs() < 1e-12);
    }
    let mut over = Camera::default();
    over.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.0, -2.0);
    assert!(over.up().z < 0.0, "upside down beyond the pole");
    let near = Point3::from(-over.forward() * 0.1);
    over.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.1, 0.0);
    assert!(
        over.view_point(&near).x > 0.0,
        "the mouse is still followed"
    );
}

#[test]
fn the_turntable_does_not_care_how_a_drag_is_cut() {
    let (mut fine, mut coarse) = (Camera::default(), Camera::default());
    for _ in 0..100 {
        fine.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.002, 0.001);
    }
    coarse.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.2, 0.1);
    assert!(fine.world_from_view.angle_to(&coarse.world_from_view) < 1e-7);
}

#[test]
fn zooming_keeps_the_point_under_the_cursor_and_has_limits() {
    let anchor = Point3::new(5040.0, -170.0, 880.0);
    for mut camera in cameras() {
        let before = camera.project(&anchor, SCREEN);
        for factor in [0.8, 0.5, 1.7] {
            camera.zoom(factor, &anchor, &scene());
            assert_same_pixel(camera.project(&anchor, SCREEN), before);
        }
        let diagonal = scene().diagonal();
        camera.zoom(1e9, &anchor, &scene());
        assert!((camera.height - 20.0 * diagonal).abs() < 1e-6);
        camera.zoom(1e-9, &anchor, &scene());
        assert!((camera.height - diagonal / 1000.0).abs() < 1e-9);
        assert_same_pixel(camera.project(&anchor, SCREEN), before);
        let kept = camera;
        camera.zoom(f64::NAN, &anchor, &scene());
        camera.zoom(0.0, &anchor, &scene());
        assert_eq!(camera, kept);
    }
}

#[test]
fn panning_follows_the_mouse() {
    let anchor = Point3::new(5040.0, -170.0, 880.0);
    for mut camera in cameras() {
        let before = camera.project(&anchor, SCREEN).unwrap();
        let to = [before.x + 33.0, before.y - 21.0];
        camera.pan([before.x, before.y], to, SCREEN, &anchor);
        let after = camera.project(&anchor, SCREEN).unwrap();
        assert!((after.x - to[0]).abs() < 1e-9 && (after.y - to[1]).abs() < 1e-9);
    }
}

#[test]
fn fitting_leaves_five_percent_of_air() {
    for mut camera in cameras() {
        for view in StandardView::ALL {
            camera.set_standard_view(view);
            camera.fit(&scene(), SCREEN.aspect());
            let mut reach: f64 = 0.0;
            for corner in scene().corners() {
                let p = camera.project(&corner, SCREEN).unwrap();
                let dx = (2.0 * p.x / SCREEN.width - 1.0).abs();
                let dy = (2.0 * p.y / SCREEN.height - 1.0).abs();
                reach = reach.max(dx).max(dy);
            }
            assert!(reach <= 0.9 + 1e-9, "{view:?}: {reach}");
            assert!(reach > 0.85, "{view:?}: {reach}");
        }
    }
}

#[test]
fn fitting_keeps_clear_of_what_lies_over_the_picture() {
    let covered = Covered {
        left: 0.0,
        right: 0.3,
        top: 0.15,
        bottom: 0.1,
        ..Covered::default()
    };
    let free = [
        0.0,
        0.7 * SCREEN.width,
        0.15 * SCREEN.height,
        0.9 * SCREEN.height,
    ];
    for mut camera in cameras() {
        for view in StandardView::ALL {
            camera.set_standard_view(view);
            camera.fit_to_points_within(&scene().corners(), SCREEN.aspect(), &covered);
            let air = [0.05 * 0.7 * SCREEN.width, 0.05 * 0.75 * SCREEN.height];
            let mut least = f64::INFINITY;
            for corner in scene().corners() {
                let p = camera.project(&corner, SCREEN).unwrap();
                let room = [p.x - free[0], free[1] - p.x, p.y - free[2], free[3] - p.y];
                for (index, room) in room.into_iter().enumerate() {
                    least = least.min(room - air[index / 2]);
                }
            }
            // All inside, and as large as they can be.
            assert!(least.abs() < 1e-6, "{view:?}: {least}");
        }
    }
    // What is covered as a whole is fitted all the same.
    let all = Covered {
        left: 0.8,
        right: 0.8,
        ..Covered::default()
    };
    let mut camera = Camera::default();
    camera.fit_to_points_within(&scene().corners(), 1.0, &all);
    assert!(
        camera.height.is_finite() && camera.height < 2000.0,
        "{}",
        camera.height
    );
}

#[test]
fn a_legend_takes_the_strip_that_leaves_the_part_larger() {
    // As high as it is wide, so that the strip above it is the smaller one.
    let covered = Covered {
        top: 0.1,
        beside: [0.0, 0.42],
        above: 0.4,
        ..Covered::default()
    };
    let fitted = |size: [f64; 3], covered: &Covered| {
        let bounds = Aabb::of_points(&[Point3::origin(), Point3::from(size)]);
        let mut camera = Camera::default();
        camera.set_standard_view(StandardView::Front);
        camera.fit_to_points_within(&bounds.corners(), 1.0, covered);
        camera
    };
    let side = Covered {
        top: 0.1,
        right: 0.42,
        ..Covered::default()
    };
    let above = Covered {
        top: 0.4,
        ..Covered::default()
    };
    let (high, wide) = ([200.0, 1.0, 1000.0], [1000.0, 1.0, 200.0]);
    assert_eq!(fitted(high, &covered), fitted(high, &side));
    assert_eq!(fitted(wide, &covered), fitted(wide, &above));
    // A part that is hardly larger below the legend stays in the middle beside it.
    let nearly = [1000.0, 1.0, 1000.0];
    assert!(fitted(nearly, &above).height < fitted(nearly, &side).height);
    assert_eq!(fitted(nearly, &covered), fitted(nearly, &side));
    // A strip that would leave too little is not taken, as long as the other one leaves enough.
    let low = Covered {
        above: 0.8,
        ..covered
    };
    assert_eq!(fitted(wide, &low), fitted(wide, &side));
}

#[test]
fn fitting_keeps_out_of_a_corner_and_is_no_smaller_where_nothing_is_there() {
    let covered = Covered {
        corner: [0.15, 0.2],
        ..Covered::default()
    };
    let corners = scene().corners();
    for mut camera in cameras() {
        let mut n_untouched = 0;
        for view in StandardView::ALL {
            camera.set_standard_view(view);
            let mut plain = camera;
            plain.fit_to_points(&corners, SCREEN.aspect());
            camera.fit_to_points_within(&corners, SCREEN.aspect(), &covered);
            let seen = corners.map(|corner| camera.project(&corner, SCREEN).unwrap());
            let is_in = |at: &ScreenPoint| {
                at.x < 0.15 * SCREEN.width - 1e-6 && at.y > 0.8 * SCREEN.height + 1e-6
            };
            assert!(!seen.iter().any(is_in), "{view:?}: {seen:?}");
            assert!(camera.height < 1.3 * plain.height, "{view:?}");
            n_untouched += usize::from(camera == plain);
        }
        assert!((1..7).contains(&n_untouched), "{n_untouched}");
    }
}

#[test]
fn directions_of_the_cube_have_z_up_and_those_of_the_keys_are_the_same_views() {
    for x in -1..=1_i8 {
        for y in -1..=1_i8 {
            for z in -1..=1_i8 {
                let mut camera = Camera::default();
                let before = camera;
                camera.look_from([x, y, z]);
                if [x, y, z] == [0; 3] {
                    assert_eq!(camera, before);
                    continue;
                }
                let back = Vector3::new(f64::from(x), f64::from(y), f64::from(z));
                // The arc cosine of an angle knows a direction to eight digits only.
                assert!((camera.forward() + back.normalize()).norm() < 1e-12);
                if x != 0 || y != 0 {
                    assert!(camera.up().z > 0.0 && camera.right().z.abs() < 1e-12);
                }
                let named = StandardView::from_direction([x, y, z]);
                assert_eq!(camera.standard_view(), named);
            }
        }
    }
    for view in StandardView::ALL {
        let mut camera = Camera::default();
        camera.set_standard_view(view);
        assert_eq!(camera.standard_view(), Some(view));
    }
}

#[test]
fn scenes_without_size_do_not_fail() {
    let point = Point3::new(1e6, -2e6, 3e6);
    for mut camera in cameras() {
        let height = camera.height;
        camera.fit(&Aabb::of_points([&point]), 1.0);
        assert!((camera.target - point).norm() < 1e-6);
        assert_eq!(camera.height, height);
        let clip = camera.clip_from_view(1.0, &Aabb::of_points([&point]));
        assert!(clip.iter().all(|x| x.is_finite()));
        camera.fit(&Aabb::empty(), 1.0);
        camera.zoom(0.5, &point, &Aabb::empty());
        assert_eq!(camera.height, height / 2.0);
        let clip = camera.clip_from_view(1.0, &Aabb::empty());
        assert!(clip.iter().all(|x| x.is_finite()));
        camera.look_along(&Vector3::zeros(), &[]);
        camera.look_along(&Vector3::z(), &[point]);
        assert!(camera.right().norm() > 0.9);
        assert!(camera.project(&point, ScreenSize::new(0, 0)).is_some());
    }
}

#[test]
fn an_eye_inside_the_part_keeps_a_sound_depth_range() {
    let mut camera = cameras()[1];
    camera.height = 1e-3;
    let (far, near) = camera.depth_range(&scene());
    let distance = camera.eye_distance().unwrap();
    assert!(far < near && near < distance);
}

#[test]
fn standard_views_show_the_axes_where_engineers_expect_them() {
    let axes = |view: StandardView| {
        let camera = Camera {
            world_from_view: view.world_from_view(),
            ..Camera::default()
        };
        camera.axes_in_view()
    };
    let close = |a: Vector3, b: Vector3| (a - b).norm() < 1e-12;
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    assert!(close(axes(StandardView::Front)[0], x) && close(axes(StandardView::Front)[2], y));
    assert!(close(axes(StandardView::Right)[1], x) && close(axes(StandardView::Right)[2], y));
    assert!(close(axes(StandardView::Top)[0], x) && close(axes(StandardView::Top)[1], y));
    assert!(close(axes(StandardView::Back)[0], -x) && close(axes(StandardView::Left)[1], -x));
    assert!(close(axes(StandardView::Bottom)[0], x) && close(axes(StandardView::Bottom)[2], -z));
    let iso = axes(StandardView::Isometric);
    assert!(iso[0].x > 0.0 && iso[1].x > 0.0 && iso[2].y > 0.0);
    assert!(iso[0].z > 0.0 && iso[1].z < 0.0 && iso[2].z > 0.0);
}

#[test]
fn looking_along_a_direction_lays_the_longest_side_flat() {
    let along = Vector3::new(0.3, 0.9, 0.2).normalize();
    let points: Vec<Point3> = (0..50)
        .map(|i| Point3::new(1e4, 2e4, 3e4) + along * f64::from(i))
        .collect();
    for direction in [Vector3::x(), -Vector3::z(), Vector3::new(1.0, 0.2, -0.3)] {
        let mut camera = Camera::default();
        camera.look_along(&direction, &points);
        assert!((camera.forward() - direction.normalize()).norm() < 1e-12);
        assert!(camera.view_direction(&along).y.abs() < 1e-9);
        assert!(camera.up().dot(&upright(&direction)) > -1e-9);
    }
}

fn upright(direction: &Vector3) -> Vector3 {
    if direction.normalize().z.abs() > 0.99 {
        Vector3::y()
    } else {
        Vector3::z()
    }
}

#[test]
fn a_flight_starts_and_ends_exactly_and_survives_half_turns() {
    let from = Camera {
        world_from_view: StandardView::Front.world_from_view(),
        ..Camera::default()
    };
    let to = Camera {
        world_from_view: StandardView::Back.world_from_view(),
        height: 16.0,
        target: Point3::new(2.0, 0.0, 0.0),
        ..Camera::default()
    };
    let flight = CameraFlight { from, to };
    assert_eq!(flight.at(1.0), to);
    assert_eq!(flight.at(7.0), to);
    assert!(
        flight
            .at(0.0)
            .world_from_view
            .angle_to(&from.world_from_view)
            < 1e-12
    );
    let middle = flight.at(0.5);
    assert!((middle.height - 4.0).abs() < 1e-12);
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!((middle.world_from_view.angle_to(&from.world_from_view) - quarter).abs() < 1e-9);
}

#[test]
fn switching_the_projection_keeps_sizes_at_the_target() {
    let mut camera = cameras()[0];
    let before = camera.pixel_size(SCREEN, &camera.target);
    camera.toggle_projection();
    assert!((camera.pixel_size(SCREEN, &camera.target) - before).abs() < 1e-12);
}

#[test]
fn linked_cameras_share_rotation_and_zoom_only() {
    let mut camera = Camera::default();
    camera.link_to(&cameras()[1]);
    assert_eq!(camera.target, Point3::origin());
    assert_eq!(camera.world_from_view, cameras()[1].world_from_view);
    assert_eq!(camera.height, 300.0);
}

#[test]
fn scale_bars_are_round() {
    let bar = scale_bar(0.731, 120.0).unwrap();
    assert_eq!(bar.length, 50.0);
    assert!((bar.pixels - 50.0 / 0.731).abs() < 1e-12);
    assert_eq!(scale_bar(1.0, 100.0).unwrap().length, 100.0);
    assert_eq!(scale_bar(0.0, 100.0), None);
    assert_eq!(scale_bar(f64::NAN, 100.0), None);
}
