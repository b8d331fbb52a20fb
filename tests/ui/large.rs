//! Large parts: the picture in steps is the picture at once, and there is something to see before it.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui::{Shape, vec2};
use egui_kittest::Harness;
use image::RgbaImage;
use shapematch::app::Command;
use shapematch::colormap::{ColorMap, ColorScale};
use shapematch::geometry::camera::{OrbitStyle, StandardView};
use shapematch::geometry::{Camera, Point3, Similarity, TriMesh, Vector3};
use shapematch::jobs::{JobEvent, JobId, JobKey, JobStage, Live, PartSource};
use shapematch::monitor::{Monitor, Observer};
use shapematch::pipeline::load::LoadSettings;
use shapematch::render::{
    Drawable, Drawn, FieldLook, Frame, MeshInput, PartLook, RenderMesh, Renderer, Scene, Sheet,
    Style, ViewTarget,
};
use shapematch::role::Role;

use super::render::new_renderer;
use super::story::window;

const SIZE: [u32; 2] = [160, 120];
const PATIENCE: Duration = Duration::from_secs(120);

/// A wavy sheet of 280 × 280 squares, in two triangles each.
pub(super) fn wavy() -> TriMesh {
    let n = 280_u32;
    let height = |x: f64, y: f64| 9.0 * (x / 40.0).sin() * (y / 33.0).cos();
    let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (f64::from(i), f64::from(j))));
    let positions = places.map(|(x, y)| Point3::new(x, y, height(x, y)));
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    TriMesh::new(positions.collect(), (0..n * n).flat_map(cell).collect()).unwrap()
}

/// Looks of a mesh of one part.
fn selected(selected: bool) -> Arc<[PartLook]> {
    Arc::new([PartLook {
        selected,
        ..PartLook::default()
    }])
}

/// Two sheets that cut through each other, one of them selected and coloured by a field.
fn two_sheets(mesh: &Arc<RenderMesh>, n_vertices: usize) -> Scene {
    let values: Arc<[f32]> = (0..n_vertices).map(|v| (v % 281) as f32).collect();
    let field = FieldLook {
        values,
        is_by_corner: false,
        scale: ColorScale::new(ColorMap::Viridis, 0.0, 280.0),
    };
    let style = Style {
        element_edges: true,
        points: true,
        ..Style::default()
    };
    let first = Drawable {
        sheet: Some(Sheet::First),
        style,
        ..Drawable::new(Arc::clone(mesh), [0x56, 0xB4, 0xE9])
    };
    let lifted = Similarity {
        translation: Vector3::new(3.0, 5.0, 0.5),
        ..Similarity::identity()
    };
    let second = Drawable {
        world_from_mesh: lifted,
        field: Some(field),
        parts: Some(selected(true)),
        sheet: Some(Sheet::Second),
        ..Drawable::new(Arc::clone(mesh), [0xE6, 0x9F, 0x00])
    };
    let clear = Drawable {
        opacity: 0.4,
        offset: Vector3::z() * 30.0,
        ..Drawable::new(Arc::clone(mesh), [0x40, 0xC0, 0x40])
    };
    Scene {
        drawables: vec![first, second, clear],
        coincidence: Some(0.6),
        ..Scene::default()
    }
}

fn frame<'a>(scene: &'a Scene, camera: &'a Camera) -> Frame<'a> {
    Frame {
        scene,
        camera,
        size: SIZE,
    }
}

fn camera() -> Camera {
    let mut camera = Camera::default();
    camera.set_standard_view(StandardView::Isometric);
    camera.fit(
        &shapematch::geometry::Aabb::of_points(&[
            Point3::new(0.0, 0.0, -9.0),
            Point3::new(280.0, 280.0, 40.0),
        ]),
        4.0 / 3.0,
    );
    camera
}

/// One frame of a window: what it shows, and how far the picture is.
fn step(renderer: &mut Renderer, target: &mut ViewTarget, frame: &Frame<'_>) -> (Drawn, RgbaImage) {
    let mut encoder = renderer
        .device()
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let drawn = renderer.draw_step(target, &mut encoder, frame);
    (drawn, renderer.read(target, encoder).unwrap())
}

/// Frames until the picture is exact: the picture, and how many there were.
fn settle(
    renderer: &mut Renderer,
    target: &mut ViewTarget,
    frame: &Frame<'_>,
) -> (RgbaImage, usize) {
    let begin = Instant::now();
    for n in 1.. {
        match step(renderer, target, frame) {
            (Drawn::Exact, picture) => return (picture, n),
            (Drawn::Partly(pause), _) => std::thread::sleep(pause),
        }
        assert!(begin.elapsed() < PATIENCE, "the picture is never exact");
    }
    unreachable!()
}

/// Share of pixels that differ by more than rounding.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let pairs = a.pixels().zip(b.pixels());
    let is_other = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        let off = |i: usize| a.0[i].abs_diff(b.0[i]);
        (0..4).any(|i| off(i) > 24)
    };
    pairs.filter(is_other).count() as f64 / f64::from(a.width() * a.height())
}

#[test]
fn a_large_picture_in_steps_is_the_picture_at_once() {
    let mesh = wavy();
    let drawn = Arc::new(RenderMesh::new(MeshInput::plain(&mesh)));
    assert!(drawn.coarse().is_some());
    let mut scene = two_sheets(&drawn, mesh.n_vertices());
    let mut camera = camera();
    let mut renderer = new_renderer();
    let mut target = ViewTarget::new();
    let empty = renderer
        .picture(&frame(&Scene::default(), &camera))
        .unwrap();

    let (first, coarse) = step(&mut renderer, &mut target, &frame(&scene, &camera));
    assert!(matches!(first, Drawn::Partly(_)));
    let (whole, n) = settle(&mut renderer, &mut target, &frame(&scene, &camera));
    assert!(n > 4, "{n} steps");
    let at_once = renderer.picture(&frame(&scene, &camera)).unwrap();
    assert_eq!(whole, at_once);
    let rough = difference(&coarse, &at_once);
    assert!(rough < 0.5 * difference(&empty, &at_once), "{rough}");

    // Other looks leave the picture until they are drawn; a turn shows at once.
    scene.drawables[1].parts = Some(selected(false));
    let (partly, before) = step(&mut renderer, &mut target, &frame(&scene, &camera));
    assert!(matches!(partly, Drawn::Partly(_)));
    assert_eq!(before, at_once);
    let pivot = camera.target;
    camera.orbit(OrbitStyle::Turntable, &pivot, 0.4, 0.1);
    let (partly, turned) = step(&mut renderer, &mut target, &frame(&scene, &camera));
    assert!(matches!(partly, Drawn::Partly(_)));
    assert!(difference(&turned, &at_once) > 0.05);
    let (whole, _) = settle(&mut renderer, &mut target, &frame(&scene, &camera));
    assert_eq!(whole, renderer.picture(&frame(&scene, &camera)).unwrap());
    let (again, _) = step(&mut renderer, &mut target, &frame(&scene, &camera));
    assert_eq!(again, Drawn::Exact);
}

#[derive(Default)]
struct Shapes(Mutex<Vec<Vec<[f64; 3]>>>);

impl Observer for Shapes {
    fn shape(&self, points: Vec<[f64; 3]>) {
        self.0.lock().unwrap().push(points);
    }
}

#[test]
fn a_processor_draws_coarse_pictures_with_fewer_pixels() {
    let mesh = wavy();
    let drawn = Arc::new(RenderMesh::new(MeshInput::plain(&mesh)));
    let scene = Scene {
        drawables: vec![Drawable::new(drawn, [0x56, 0xB4, 0xE9])],
        ..Scene::default()
    };
    let mut renderer = new_renderer();
    let mut camera = camera();
    let mut target = ViewTarget::on_processor();
    for _ in 0..2 {
        let expected = renderer.picture(&frame(&scene, &camera)).unwrap();
        let (partly, coarse) = step(&mut renderer, &mut target, &frame(&scene, &camera));
        assert!(matches!(partly, Drawn::Partly(_)));
        assert_eq!(coarse.dimensions(), (54, 40), "a third on each axis");
        // Stretched over the window it shows the same, up to lines.
        let stretched = image::imageops::resize(
            &coarse,
            SIZE[0],
            SIZE[1],
            image::imageops::FilterType::Triangle,
        );
        let off = difference(&stretched, &expected);
        assert!(off < 0.2, "{off}");
        let (exact, _) = settle(&mut renderer, &mut target, &frame(&scene, &camera));
        assert_eq!(exact.dimensions(), (SIZE[0], SIZE[1]));
        assert_eq!(difference(&exact, &expected), 0.0);
        // And again once the view moves.
        let pivot = camera.target;
        camera.orbit(OrbitStyle::Turntable, &pivot, 0.4, 0.1);
    }
}

#[test]
fn a_part_is_seen_as_points_while_it_is_read() {
    let shapes = Arc::new(Shapes::default());
    let monitor = Monitor::with_observer(Arc::clone(&shapes) as Arc<dyn Observer>);
    let part = PartSource::Example.load(Role::Crash, &LoadSettings::default(), &monitor);
    let part = part.unwrap();
    let told = shapes.0.lock().unwrap();
    let [points] = &told[..] else {
        panic!("told {} times", told.len());
    };
    assert!((500..6000).contains(&points.len()), "{}", points.len());
    let bounds = part.mesh.aabb();
    let seen = shapematch::geometry::Aabb::of_points(
        &points.iter().map(|p| Point3::from(*p)).collect::<Vec<_>>(),
    );
    assert!((seen.diagonal() / bounds.diagonal() - 1.0).abs() < 0.05);

    let mut window = window();
    let ctx = window.ctx.clone();
    // The state alone: no worker takes it up.
    let stamp = window.state().state().document.stamp();
    let event = |stage| JobEvent {
        id: JobId(1),
        key: JobKey::Load(Role::Crash),
        stamp,
        elapsed: Duration::ZERO,
        stage,
    };
    let live = Live {
        job: Some(JobId(1)),
        shape: Some(points.clone().into()),
        ..Live::default()
    };
    let commands = vec![
        Command::from(event(JobStage::Started)),
        Command::Live(Box::new(live)),
    ];
    window.state_mut().run_commands(commands, &ctx);
    let before = dots(&window);
    window.run_steps(1);
    assert!(dots(&window) >= before + points.len() / 2, "no points");
}

/// Small squares that were painted.
fn dots(window: &Harness<'static, shapematch::ui::Shell>) -> usize {
    let is_dot = |shape: &Shape| match shape {
        Shape::Rect(rect) => rect.rect.size() == vec2(2.0, 2.0),
        _ => false,
    };
    let shapes = &window.output().shapes;
    shapes
        .iter()
        .filter(|clipped| is_dot(&clipped.shape))
        .count()
}
