//! Reducing the car floor sample and taking levels out of a recording:
//! `cargo bench --no-default-features --bench simplify`. One thread.

mod reduction;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use shapematch::geometry::weld;
use shapematch::monitor::Monitor;
use shapematch::samples::{SampleSettings, generate};
use shapematch::simplify::Speed;

fn reduce_floor(criterion: &mut Criterion) {
    let pair = generate(&SampleSettings::default());
    let joined = weld(pair.stamped.to_trimesh(), &Monitor::silent());
    let mesh = joined.expect("nobody cancels").mesh;
    let mut group = criterion.benchmark_group("simplify");
    group.sample_size(20);
    for speed in [Speed::Exact, Speed::Fast] {
        for max_triangles in [20_000, 10_000, 1_000, 100] {
            group.bench_function(format!("{speed:?} {max_triangles}"), |bencher| {
                bencher.iter(|| black_box(reduction::reduce(&mesh, speed, max_triangles)));
            });
        }
    }
    let sequence = reduction::record(&mesh, 100);
    for max_triangles in [20_000, 1_000] {
        group.bench_function(format!("level {max_triangles}"), |bencher| {
            bencher.iter(|| black_box(sequence.level(max_triangles)));
        });
    }
    group.finish();
}

criterion_group!(benches, reduce_floor);
criterion_main!(benches);
