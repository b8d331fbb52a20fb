//! Pictures on the software driver. They are small, and what is asserted is what a person would see.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

use eframe::egui_wgpu::{RenderState, RendererOptions};
use image::RgbaImage;
use shapematch::colormap::{ColorMap, ColorScale};
use shapematch::geometry::camera::{OrbitStyle, ScreenSize, StandardView};
use shapematch::geometry::{Camera, Point3, Projection, Similarity, TriMesh, Vector3};
use shapematch::render::{
    Background, DepthMode, Drawable, FieldLook, Frame, MeshInput, PartLook, Polyline, RenderMesh,
    Renderer, Scene, Section, Sheet, Style, ViewTarget, WipeSide,
};

const SIZE: [u32; 2] = [120, 90];
const BLUE: [u8; 3] = [0x56, 0xB4, 0xE9];
const ORANGE: [u8; 3] = [0xE6, 0x9F, 0x00];

/// The device that all tests share; making one is slower than any test.
pub(super) fn device() -> &'static RenderState {
    static STATE: OnceLock<RenderState> = OnceLock::new();
    STATE.get_or_init(|| {
        egui_kittest::wgpu::create_render_state(
            egui_kittest::wgpu::default_wgpu_setup(),
            RendererOptions::PREDICTABLE,
        )
    })
}

/// A renderer of its own on that device.
pub(super) fn new_renderer() -> Renderer {
    let state = device();
    Renderer::new(&state.device, &state.queue, state.target_format)
}

fn renderer() -> MutexGuard<'static, Renderer> {
    static RENDERER: OnceLock<Mutex<Renderer>> = OnceLock::new();
    let shared = RENDERER.get_or_init(|| Mutex::new(new_renderer()));
    shared.lock().unwrap_or_else(|broken| broken.into_inner())
}

/// A square of 2 × 2 about `center`, its normal along +z.
fn square(center: Point3) -> TriMesh {
    let corner = |x, y| center + Vector3::new(x, y, 0.0);
    let positions = vec![
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn plain(mesh: &TriMesh, color: [u8; 3]) -> Drawable {
    let prepared = Arc::new(RenderMesh::new(MeshInput::plain(mesh)));
    let style = Style {
        feature_edges: false,
        borders: false,
        ..Style::default()
    };
    Drawable {
        style,
        ..Drawable::new(prepared, color)
    }
}

fn scene(drawables: Vec<Drawable>) -> Scene {
    Scene {
        drawables,
        background: Background::Transparent,
        ..Scene::default()
    }
}

/// From above, 4 units high.
fn from(view: StandardView, target: Point3) -> Camera {
    Camera {
        target,
        world_from_view: view.world_from_view(),
        height: 4.0,
        projection: Projection::Orthographic,
    }
}

fn picture(scene: &Scene, camera: &Camera) -> RgbaImage {
    let frame = Frame {
        scene,
        camera,
        size: SIZE,
    };
    renderer().picture(&frame).unwrap()
}

/// Colour at a world point.
fn color_at(picture: &RgbaImage, camera: &Camera, point: &Point3) -> [u8; 4] {
    let seen = camera
        .project(point, ScreenSize::new(SIZE[0], SIZE[1]))
        .unwrap();
    picture.get_pixel(seen.x as u32, seen.y as u32).0
}

fn brightness(color: [u8; 4]) -> u32 {
    color[..3].iter().map(|&c| u32::from(c)).sum()
}

fn difference(a: [u8; 4], b: [u8; 4]) -> u8 {
    (0..4).map(|i| a[i].abs_diff(b[i])).max().unwrap()
}

#[test]
fn a_square_covers_what_the_camera_says() {
    let camera = from(StandardView::Top, Point3::origin());
    let picture = picture(
        &scene(vec![plain(&square(Point3::origin()), BLUE)]),
        &camera,
    );
    let at = |x, y| color_at(&picture, &camera, &Point3::new(x, y, 0.0));
    assert_eq!(at(1.2, 0.0)[3], 0);
    assert_eq!(at(0.0, -1.2)[3], 0);
    for (x, y) in [(0.0, 0.0), (0.9, 0.9), (-0.9, 0.9), (0.9, -0.9)] {
        assert_eq!(at(x, y)[3], 255);
    }
    let [r, g, b, _] = at(0.0, 0.0);
    assert!(b > g && g > r && b > 150, "blue stays blue: {r} {g} {b}");
}

#[test]
fn back_sides_are_darker_and_hatched() {
    let drawable = plain(&square(Point3::origin()), BLUE);
    let above = from(StandardView::Top, Point3::origin());
    let below = from(StandardView::Bottom, Point3::origin());
    let front = picture(&scene(vec![drawable.clone()]), &above);
    let back = picture(&scene(vec![drawable.clone()]), &below);
    let middle = Point3::origin();
    let (front, plain_back) = (
        brightness(color_at(&front, &above, &middle)),
        brightness(color_at(&back, &below, &middle)),
    );
    assert!(plain_back * 10 < front * 9, "{plain_back} {front}");
    let n_shades = |camera: &Camera| {
        let hatched = picture(&scene(vec![drawable.clone()]), camera);
        let row = (50..70).map(|x| brightness(hatched.get_pixel(x, 45).0));
        row.collect::<std::collections::BTreeSet<u32>>().len()
    };
    let near = Camera {
        height: 1.0,
        ..below
    };
    assert!(n_shades(&near) > 2, "a hatch");
    assert_eq!(n_shades(&below), 1, "none on small pictures");
}

#[test]
fn a_mirrored_pose_shows_the_other_side() {
    let mut drawable = plain(&square(Point3::origin()), BLUE);
    let camera = from(StandardView::Top, Point3::origin());
    let before = picture(&scene(vec![drawable.clone()]), &camera);
    drawable.world_from_mesh = Similarity::mirror_x();
    let after = picture(&scene(vec![drawable]), &camera);
    let middle = Point3::origin();
    let (a, b) = (
        color_at(&before, &camera, &middle),
        color_at(&after, &camera, &middle),
    );
    // A mirror about a plane that holds the normal keeps the upper side up.
    assert!(difference(a, b) <= 2, "{a:?} {b:?}");
}

#[test]
fn far_from_the_origin_nothing_changes() {
    let far = Vector3::new(5.0e6, -3.0e6, 2.0e6);
    for projection in [Projection::Orthographic, Projection::perspective()] {
        let shot = |shift: Vector3| {
            let mut drawable = plain(&square(Point3::origin() + shift), BLUE);
            drawable.style = Style {
                element_edges: true,
                ..Style::default()
            };
            let camera = Camera {
                projection,
                ..from(StandardView::Isometric, Point3::origin() + shift)
            };
            picture(&scene(vec![drawable]), &camera)
        };
        let (near, far) = (shot(Vector3::zeros()), shot(far));
        let differing = near
            .pixels()
            .zip(far.pixels())
            .filter(|(a, b)| difference(a.0, b.0) > 3)
            .count();
        assert_eq!(differing, 0, "{projection:?}");
    }
}

#[test]
fn the_nearer_of_coincident_sheets_wins_everywhere() {
    let mut below = Drawable {
        push_back: 1.0,
        push_back_length: 0.01,
        ..plain(&square(Point3::origin()), BLUE)
    };
    below.style.element_edges = true;
    let above = plain(&square(Point3::origin()), ORANGE);
    // Seen almost edge on, where lines of the lower sheet would shine through first.
    let mut camera = from(StandardView::Front, Point3::origin());
    camera.orbit(OrbitStyle::Turntable, &Point3::origin(), 0.3, -0.35);
    camera.height = 1.2;
    let both = picture(&scene(vec![above.clone(), below.clone()]), &camera);
    let turned = picture(&scene(vec![below, above.clone()]), &camera);
    let alone = picture(&scene(vec![above]), &camera);
    for other in [both, turned] {
        let inner = alone
            .pixels()
            .zip(other.pixels())
            .filter(|(a, _)| a.0[3] == 255);
        assert!(inner.clone().count() > 1000);
        let differing = inner.filter(|(a, b)| difference(a.0, b.0) > 2).count();
        assert_eq!(differing, 0);
    }
}

#[test]
fn sheets_that_coincide_are_striped_in_both_colours() {
    let camera = from(StandardView::Top, Point3::origin());
    let shot = |gap: f64, is_swapped: bool| {
        let mut sheets = [
            plain(&square(Point3::origin()), BLUE),
            plain(&square(Point3::new(0.0, 0.0, gap)), ORANGE),
        ];
        sheets[0].sheet = Some(Sheet::First);
        sheets[1].sheet = Some(Sheet::Second);
        if is_swapped {
            sheets.reverse();
        }
        let scene = Scene {
            coincidence: Some(0.1),
            ..scene(sheets.to_vec())
        };
        let picture = picture(&scene, &camera);
        let (mut n_blue, mut n_orange) = (0, 0);
        for x in 45..75 {
            for y in 30..60 {
                let [r, _, b, _] = picture.get_pixel(x, y).0.map(i32::from);
                n_blue += u32::from(b > r + 40);
                n_orange += u32::from(r > b + 40);
            }
        }
        (n_blue, n_orange)
    };
    for (gap, is_swapped) in [(0.02, false), (-0.02, false), (0.0, true)] {
        let (n_blue, n_orange) = shot(gap, is_swapped);
        assert!(n_blue > 250 && n_orange > 250, "{gap}: {n_blue} {n_orange}");
    }
    assert_eq!(shot(0.2, false), (0, 900), "only the upper sheet");
    assert_eq!(shot(-0.2, false), (900, 0), "only the upper sheet");
}

#[test]
fn lines_without_a_surface_have_the_colour_of_their_part() {
    let camera = from(StandardView::Top, Point3::origin());
    let mut drawable = plain(&square(Point3::origin()), ORANGE);
    drawable.style.borders = true;
    let border = Point3::new(1.0, 0.3, 0.0);
    let shot = |drawable: &Drawable| {
        let picture = picture(&scene(vec![drawable.clone()]), &camera);
        let middle = color_at(&picture, &camera, &Point3::new(0.2, 0.4, 0.0));
        (color_at(&picture, &camera, &border), middle)
    };
    let ([r, _, b, _], middle) = shot(&drawable);
    assert!(r < 60 && b < 60 && middle[3] == 255, "dark on the surface");
    drawable.style.surface = false;
    let ([r, _, b, _], middle) = shot(&drawable);
    assert!(r > 150 && b < 60 && middle[3] == 0, "{r} {b}");
}

#[test]
fn glass_blends_with_what_is_behind() {
    let camera = from(StandardView::Top, Point3::origin());
    let behind = plain(&square(Point3::new(0.0, 0.0, -1.0)), BLUE);
    let glass = Drawable {
        opacity: 0.5,
        ..plain(&square(Point3::origin()), ORANGE)
    };
    let middle = Point3::origin();
    let shot = |drawables| color_at(&picture(&scene(drawables), &camera), &camera, &middle);
    let only_behind = shot(vec![behind.clone()]);
    let only_glass = shot(vec![glass.clone()]);
    let both = shot(vec![glass, behind]);
    assert!((120..=136).contains(&only_glass[3]), "{only_glass:?}");
    for channel in 0..3 {
        let (a, b) = (
            f64::from(only_behind[channel]),
            f64::from(only_glass[channel]),
        );
        assert!((f64::from(both[channel]) - (a + b) / 2.0).abs() < 4.0);
    }
    assert_eq!(both[3], 255);
}

#[test]
fn the_section_cuts_one_side_away() {
    let camera = from(StandardView::Top, Point3::origin());
    let mut scene = scene(vec![plain(&square(Point3::origin()), BLUE)]);
    scene.section = Some(Section {
        point: Point3::new(0.2, 0.0, 0.0),
        normal: Vector3::x() * 7.0,
    });
    let cut = picture(&scene, &camera);
    assert_eq!(color_at(&cut, &camera, &Point3::new(0.4, 0.0, 0.0))[3], 0);
    assert_eq!(
        color_at(&cut, &camera, &Point3::new(-0.4, 0.0, 0.0))[3],
        255
    );
}

#[test]
fn the_wipe_line_divides_the_picture() {
    let camera = from(StandardView::Top, Point3::origin());
    let side = |wipe, color| Drawable {
        wipe,
        ..plain(&square(Point3::origin()), color)
    };
    let mut scene = scene(vec![
        side(WipeSide::Left, BLUE),
        side(WipeSide::Right, ORANGE),
    ]);
    scene.wipe = Some(0.5);
    let picture = picture(&scene, &camera);
    let [r, _, b, _] = color_at(&picture, &camera, &Point3::new(-0.3, 0.0, 0.0));
    assert!(b > r);
    let [r, _, b, _] = color_at(&picture, &camera, &Point3::new(0.3, 0.0, 0.0));
    assert!(r > b);
}

#[test]
fn parts_have_colours_and_can_be_hidden() {
    let mesh = square(Point3::origin());
    let input = MeshInput {
        part_of_triangle: Some(&[0, 300]),
        ..MeshInput::plain(&mesh)
    };
    let mut parts = vec![PartLook::default(); 301];
    parts[300].color = Some(ORANGE);
    let mut drawable = plain(&mesh, BLUE);
    drawable.mesh = Arc::new(RenderMesh::new(input));
    drawable.parts = Some(parts.clone().into());
    let camera = from(StandardView::Top, Point3::origin());
    let lower = Point3::new(0.5, -0.5, 0.0);
    let upper = Point3::new(-0.5, 0.5, 0.0);
    let both = picture(&scene(vec![drawable.clone()]), &camera);
    let [r, _, b, _] = color_at(&both, &camera, &upper);
    assert!(r > b, "the second part is orange");
    let [r, _, b, _] = color_at(&both, &camera, &lower);
    assert!(b > r, "the first is plain");
    parts[300].visible = false;
    drawable.parts = Some(parts.into());
    let one = picture(&scene(vec![drawable]), &camera);
    assert_eq!(color_at(&one, &camera, &upper)[3], 0);
    assert_eq!(color_at(&one, &camera, &lower)[3], 255);
}

#[test]
fn fields_take_the_colours_of_their_scale() {
    let mut drawable = plain(&square(Point3::origin()), BLUE);
    let scale = ColorScale::new(ColorMap::Rainbow, 0.0, 1.0);
    drawable.field = Some(FieldLook {
        values: vec![0.0, 1.0, 1.0, 0.0].into(),
        is_by_corner: false,
        scale,
    });
    let camera = from(StandardView::Top, Point3::origin());
    let shot = picture(&scene(vec![drawable.clone()]), &camera);
    for x in [-0.9, -0.4, 0.1, 0.6, 0.9] {
        let shown = color_at(&shot, &camera, &Point3::new(x, 0.3, 0.0));
        let [r, g, b] = scale.color((x + 1.0) / 2.0);
        assert!(
            difference(shown, [r, g, b, 255]) < 24,
            "{x}: {shown:?} {r} {g} {b}"
        );
    }
    // Values that are missing or not numbers are grey and hatched, up to half way to those that are not.
    drawable.field = Some(FieldLook {
        values: vec![0.0, f32::NAN].into(),
        is_by_corner: false,
        scale,
    });
    let shot = picture(&scene(vec![drawable.clone()]), &camera);
    let colors: Vec<[u8; 4]> = (45..75).map(|x| shot.get_pixel(x, 25).0).collect();
    assert!(colors.iter().all(|c| c[0].abs_diff(c[2]) < 16), "grey");
    let (low, high) = (
        colors.iter().map(|&c| brightness(c)).min().unwrap(),
        colors.iter().map(|&c| brightness(c)).max().unwrap(),
    );
    assert!(high > low + 60, "hatched");
    // Values at corners change from one triangle to the next without a slope between them.
    drawable.field = Some(FieldLook {
        values: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0].into(),
        is_by_corner: true,
        scale,
    });
    let shot = picture(&scene(vec![drawable]), &camera);
    let seen = [(0.6, -0.5), (-0.5, 0.6)].map(|(x, y)| {
        let [r, g, b, _] = color_at(&shot, &camera, &Point3::new(x, y, 0.0));
        [r, g, b]
    });
    let ends = [0.0, 1.0].map(|value| scale.color(value));
    for (shown, [r, g, b]) in seen.into_iter().zip(ends) {
        let [sr, sg, sb] = shown;
        assert!(
            difference([sr, sg, sb, 255], [r, g, b, 255]) < 24,
            "{shown:?}"
        );
    }
}

/// A field from 0 on the left to 1 on the right of a square, of which only the middle is drawn.
#[test]
fn values_beyond_the_limits_are_neither_drawn_nor_picked() {
    let mut drawable = plain(&square(Point3::origin()), BLUE);
    let whole = ColorScale::new(ColorMap::Rainbow, 0.25, 0.75);
    let look = |scale, values: &[f32]| FieldLook {
        values: values.into(),
        is_by_corner: false,
        scale,
    };
    let cut = ColorScale {
        hides_beyond: true,
        ..whole
    };
    let camera = from(StandardView::Top, Point3::origin());
    let mut covered = |scale, values: &[f32]| {
        drawable.field = Some(look(scale, values));
        let scene = scene(vec![drawable.clone()]);
        let shot = picture(&scene, &camera);
        [-0.9, -0.6, -0.4, 0.0, 0.4, 0.6, 0.9].map(|x| {
            let point = Point3::new(x, 0.3, 0.0);
            let is_drawn = color_at(&shot, &camera, &point)[3] == 255;
            // What the window asks for what lies under the pointer.
            let share = f32::midpoint(x as f32, 1.0);
            let value = values[0] + share * (values[1] - values[0]);
            assert_eq!(!scale.hides(f64::from(value)), is_drawn, "{x}");
            is_drawn
        })
    };
    let rising = [0.0, 1.0, 1.0, 0.0];
    assert_eq!(covered(whole, &rising), [true; 7]);
    let middle = [false, false, true, true, true, false, false];
    assert_eq!(covered(cut, &rising), middle);
    // Values at a limit, and places without one, stay.
    assert_eq!(covered(cut, &[0.75; 4]), [true; 7]);
    assert_eq!(covered(cut, &[f32::NAN; 4]), [true; 7]);
}

/// The same field: lines of the mesh end where the surface does.
#[test]
fn lines_of_what_is_hidden_are_not_drawn() {
    let scale = ColorScale {
        hides_beyond: true,
        ..ColorScale::new(ColorMap::Rainbow, 0.25, 0.75)
    };
    let camera = from(StandardView::Top, Point3::origin());
    let shown = |style: Style, values: &[f32], is_by_corner: bool| {
        let mut drawable = plain(&square(Point3::origin()), BLUE);
        drawable.style = style;
        drawable.field = Some(FieldLook {
            values: values.into(),
            is_by_corner,
            scale,
        });
        let shot = picture(&scene(vec![drawable]), &camera);
        // Where anything is drawn in the upper half, at some places from left to right.
        [-0.9, -0.6, -0.4, 0.4, 0.6, 0.9].map(|x| {
            let at = camera.project(&Point3::new(x, 0.0, 0.0), ScreenSize::new(SIZE[0], SIZE[1]));
            let column = at.unwrap().x as u32;
            (0..SIZE[1] / 2).any(|row| shot.get_pixel(column, row).0[3] > 0)
        })
    };
    let lines = |element_edges: bool, borders: bool| Style {
        element_edges,
        borders,
        feature_edges: borders,
        ..Style::default()
    };
    for style in [lines(true, false), lines(false, true), lines(true, true)] {
        let middle = [false, false, true, true, false, false];
        assert_eq!(shown(style, &[0.0, 1.0, 1.0, 0.0], false), middle);
        assert_eq!(shown(style, &[0.5; 4], false), [true; 6]);
        // Of two triangles with a value each, the one that is beyond is gone with its borders.
        let mut by_corner = [0.5; 6];
        by_corner[3..].fill(0.9);
        let right = [false, false, false, true, true, true];
        assert_eq!(shown(style, &by_corner, true), right);
        assert_eq!(shown(style, &[0.9; 6], true), [false; 6]);
    }
}

#[test]
fn nodes_of_what_is_hidden_are_not_drawn() {
    let scale = ColorScale {
        hides_beyond: true,
        ..ColorScale::new(ColorMap::Rainbow, 0.25, 0.75)
    };
    let camera = from(StandardView::Top, Point3::origin());
    let shown = |values: &[f32], is_by_corner: bool| {
        let mesh = square(Point3::origin());
        let mut drawable = plain(&mesh, BLUE);
        drawable.style.points = true;
        drawable.style.surface = false;
        drawable.field = Some(FieldLook {
            values: values.into(),
            is_by_corner,
            scale,
        });
        let shot = picture(&scene(vec![drawable]), &camera);
        let is_drawn = |node: &Point3| color_at(&shot, &camera, node)[3] > 0;
        mesh.positions().iter().map(is_drawn).collect::<Vec<_>>()
    };
    assert_eq!(shown(&[0.5; 4], false), [true; 4]);
    assert_eq!(
        shown(&[0.5, 0.9, f32::NAN, 0.1], false),
        [true, false, true, false]
    );
    // Of two triangles with a value each, the nodes of the shown one stay.
    let by_corner = [0.5, 0.5, 0.5, 0.9, 0.9, 0.9];
    assert_eq!(shown(&by_corner, true), [true, true, true, false]);
}

#[test]
fn equal_frames_are_drawn_once() {
    let mut renderer = renderer();
    let mut target = ViewTarget::new();
    let mut encoder = renderer
        .device()
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut scene = scene(vec![plain(&square(Point3::origin()), BLUE)]);
    let mut camera = from(StandardView::Top, Point3::origin());
    let mut draw = |scene: &Scene, camera: &Camera, size| {
        let frame = Frame {
            scene,
            camera,
            size,
        };
        renderer.draw(&mut target, &mut encoder, &frame)
    };
    assert!(draw(&scene, &camera, SIZE));
    assert!(!draw(&scene.clone(), &camera, SIZE));
    assert!(draw(&scene, &camera, [64, 64]));
    camera.height = 3.0;
    assert!(draw(&scene, &camera, [64, 64]));
    scene.drawables[0].parts = Some(Arc::new([PartLook {
        hovered: true,
        ..PartLook::default()
    }]));
    assert!(draw(&scene, &camera, [64, 64]));
    assert!(!draw(&scene, &camera, [64, 64]));
    assert!(
        draw(&scene, &camera, [0, 0]),
        "a view without area does not fail"
    );
}

#[test]
fn meshes_leave_the_graphics_card_with_their_last_owner() {
    let camera = from(StandardView::Top, Point3::origin());
    let mut renderer = new_renderer();
    let mut n_meshes_with = |scene: &Scene| {
        let frame = Frame {
            scene,
            camera: &camera,
            size: SIZE,
        };
        renderer.picture(&frame).unwrap();
        renderer.n_meshes()
    };
    let first = scene(vec![plain(&square(Point3::origin()), BLUE)]);
    assert_eq!(n_meshes_with(&first), 1);
    drop(first);
    assert_eq!(n_meshes_with(&Scene::default()), 0);
}

#[test]
fn selection_draws_a_line_around_and_not_over() {
    let mut drawable = plain(&square(Point3::origin()), BLUE);
    let camera = from(StandardView::Top, Point3::origin());
    let before = picture(&scene(vec![drawable.clone()]), &camera);
    drawable.parts = Some(Arc::new([PartLook {
        selected: true,
        ..PartLook::default()
    }]));
    let after = picture(&scene(vec![drawable]), &camera);
    let middle = Point3::origin();
    assert_eq!(
        color_at(&before, &camera, &middle),
        color_at(&after, &camera, &middle)
    );
    let outside = color_at(&after, &camera, &Point3::new(1.06, 0.0, 0.0));
    assert!(brightness(outside) > 600 && outside[3] > 200, "{outside:?}");
    assert_eq!(color_at(&after, &camera, &Point3::new(1.4, 0.0, 0.0))[3], 0);
}

#[test]
fn overlays_know_what_is_in_front() {
    let camera = from(StandardView::Top, Point3::origin());
    let mut scene = scene(vec![plain(&square(Point3::origin()), BLUE)]);
    let line = |y: f64, depth| Polyline {
        depth,
        ..Polyline::new(
            vec![Point3::new(-1.5, y, -0.5), Point3::new(1.5, y, -0.5)],
            [255, 0, 0, 255],
            4.0,
        )
    };
    scene.overlay.polylines = vec![line(0.6, DepthMode::Faint), line(-0.6, DepthMode::OnTop)];
    let shot = picture(&scene, &camera);
    let red = |x, y| color_at(&shot, &camera, &Point3::new(x, y, 0.0))[0];
    for y in [0.6, -0.6] {
        assert_eq!(red(1.3, y), 255, "beside the square both are fully visible");
    }
    assert!(
        (110..200).contains(&red(0.0, 0.6)),
        "faint: {}",
        red(0.0, 0.6)
    );
    assert_eq!(red(0.0, -0.6), 255, "on top");
}

#[test]
fn scenes_without_size_draw_nothing_and_fail_nowhere() {
    let camera = Camera::default();
    picture(&Scene::default(), &camera);
    let point = TriMesh::new(vec![Point3::origin()], vec![[0, 0, 0]]).unwrap();
    picture(&scene(vec![plain(&point, BLUE)]), &camera);
    let cloud = TriMesh::new(vec![Point3::origin()], vec![]).unwrap();
    let dots = picture(&scene(vec![plain(&cloud, BLUE)]), &camera);
    assert!(
        dots.get_pixel(60, 45).0[3] > 200,
        "a cloud is drawn as points"
    );
    let eye_inside = Camera {
        projection: Projection::perspective(),
        height: 1e-3,
        ..camera
    };
    picture(
        &scene(vec![plain(&square(Point3::origin()), BLUE)]),
        &eye_inside,
    );
}

#[test]
fn gradients_run_from_top_to_bottom() {
    let scene = Scene {
        background: Background::LIGHT,
        ..Scene::default()
    };
    let shot = picture(&scene, &Camera::default());
    let (top, bottom) = (shot.get_pixel(60, 0).0, shot.get_pixel(60, 89).0);
    assert!(difference(top, [0xF7, 0xF8, 0xFA, 255]) <= 2, "{top:?}");
    assert!(
        difference(bottom, [0xDF, 0xE3, 0xE8, 255]) <= 2,
        "{bottom:?}"
    );
}
