//! Reducing the car floor sample and taking levels out of a recording:
//! `cargo bench --no-default-features --bench simplify`. One thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use shapematch::geometry::weld;
use shapematch::monitor::Monitor;
use shapematch::samples::{SampleSettings, generate};
use shapematch::simplify::{CollapseSequence, SimplifySettings, Speed, simplify};

fn reduce_floor(criterion: &mut Criterion) {
    let mesh = weld(
        &generate(&SampleSettings::default()).stamped.to_trimesh(),
        0.0,
    )
    .mesh;
    let monitor = Monitor::silent();
    let mut group = criterion.benchmark_group("simplify");
    group.sample_size(20);
    for speed in [Speed::Exact, Speed::Fast] {
        for max_triangles in [20_000, 10_000, 1_000, 100] {
            let settings = SimplifySettings {
                speed,
                ..SimplifySettings::to_triangles(max_triangles)
            };
            group.bench_function(format!("{speed:?} {max_triangles}"), |bencher| {
                bencher.iter(|| black_box(simplify(&mesh, &settings, &monitor)));
            });
        }
    }
    let settings = SimplifySettings::to_triangles(100);
    let sequence = CollapseSequence::record(&mesh, &settings, &monitor)
        .expect("the default settings are valid and nobody cancels");
    for max_triangles in [20_000, 1_000] {
        group.bench_function(format!("level {max_triangles}"), |bencher| {
            bencher.iter(|| black_box(sequence.level(max_triangles)));
        });
    }
    group.finish();
}

criterion_group!(benches, reduce_floor);
criterion_main!(benches);
