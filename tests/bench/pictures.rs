//! Preparing and drawing meshes, and finding what lies under the pointer:
//! `cargo bench --features ui-tests --bench pictures`. On the graphics adapter that the tests take.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use eframe::egui_wgpu::RendererOptions;
use shapematch::geometry::camera::OrbitStyle;
use shapematch::geometry::{Camera, Point3, Topology, TriMesh};
use shapematch::render::{Drawable, Frame, MeshInput, RenderMesh, Renderer, Scene, ViewTarget};
use shapematch::search::Bvh;

/// One 3D window of the program's first size.
const SIZE: [u32; 2] = [530, 660];

/// A beaded sheet of n × n cells of two triangles.
fn sheet(n: u32) -> Arc<TriMesh> {
    let step = 1000.0 / f64::from(n);
    let positions = (0..(n + 1) * (n + 1)).map(|k| {
        let (x, y) = (f64::from(k / (n + 1)) * step, f64::from(k % (n + 1)) * step);
        Point3::new(x, y, 12.0 * (x / 40.0).sin() * (y / 90.0).cos())
    });
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
    };
    let triangles = (0..n * n).flat_map(cell).collect();
    Arc::new(TriMesh::new(positions.collect(), triangles).expect("a sheet"))
}

fn renderer() -> Renderer {
    let setup = egui_kittest::wgpu::default_wgpu_setup();
    let state = egui_kittest::wgpu::create_render_state(setup, RendererOptions::PREDICTABLE);
    Renderer::new(&state.device, &state.queue, state.target_format)
}

fn pictures(criterion: &mut Criterion) {
    let mut renderer = renderer();
    let mut group = criterion.benchmark_group("pictures");
    group.sample_size(10);
    for (name, n) in [("35k", 132), ("1M", 707)] {
        let mesh = sheet(n);
        group.bench_function(format!("edges {name}"), |bencher| {
            bencher.iter(|| black_box(Topology::of(&mesh)));
        });
        group.bench_function(format!("prepare {name}"), |bencher| {
            bencher.iter(|| black_box(RenderMesh::new(MeshInput::plain(&mesh))));
        });
        let drawn = Arc::new(RenderMesh::new(MeshInput::plain(&mesh)));
        let scene = Scene {
            drawables: vec![Drawable::new(drawn, [0x56, 0xB4, 0xE9])],
            ..Scene::default()
        };
        let center = scene.bounds().center();
        let mut camera = Camera::default();
        camera.fit_to_points(&scene.bounds().corners(), 0.8);
        let mut target = ViewTarget::new();
        group.bench_function(format!("orbit frame {name}"), |bencher| {
            bencher.iter(|| {
                camera.orbit(OrbitStyle::Turntable, &center, 0.01, 0.0);
                orbit_frame(&mut renderer, &mut target, &scene, &camera);
            });
        });
        let tree = Bvh::build(Arc::clone(&mesh));
        let direction = camera.forward();
        let start = center - direction * 5000.0;
        group.bench_function(format!("hover {name}"), |bencher| {
            bencher.iter(|| black_box(tree.first_hit(&start, &direction)));
        });
    }
    group.finish();
}

/// Records a frame, draws it and waits for the end.
fn orbit_frame(renderer: &mut Renderer, target: &mut ViewTarget, scene: &Scene, camera: &Camera) {
    let frame = Frame {
        scene,
        camera,
        size: SIZE,
    };
    let device = renderer.device().clone();
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    assert!(renderer.draw(target, &mut encoder, &frame), "it moved");
    assert!(renderer.submit_and_wait(encoder), "drawn");
}

criterion_group!(benches, pictures);
criterion_main!(benches);
