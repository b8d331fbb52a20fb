//! A whole match after reading, nine starts and both signs, finish on the full meshes:
//! `cargo bench --no-default-features --bench matching`.
//!
//! The pair is the floor sample: 34,808 stamped triangles on the crash side's own mesh. "prepare"
//! joins, orients, measures and builds both trees; "match" is the search and the finish; "assess"
//! is the independent check. `RESULTS.md` holds the figures with their machine.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use shapematch::assess::{AssessSettings, assess};
use shapematch::monitor::Monitor;
use shapematch::registration::{MatchInput, MatchSettings, Method, Surface, match_surfaces};
use shapematch::samples::{SamplePart, SampleSettings, generate};
use shapematch::settings::Choice;

fn matching(c: &mut Criterion) {
    let monitor = Monitor::silent();
    let mut group = c.benchmark_group("matching");
    group.sample_size(10);
    for part in [SamplePart::Floor, SamplePart::Rail] {
        let pair = generate(&SampleSettings {
            part,
            ..SampleSettings::default()
        });
        let meshes = [pair.stamped.to_trimesh(), pair.crash.to_trimesh()];
        let prepare = || {
            let [source, target] = &meshes;
            rayon::join(
                || Surface::new(source, "source"),
                || Surface::new(target, "target"),
            )
        };
        let (source, target) = prepare();
        let (source, target) = (source.expect("has area"), target.expect("has area"));
        let input = MatchInput {
            source: &source,
            target: &target,
            reduced: None,
        };
        let name = part.name();
        group.bench_function(format!("{name}: prepare"), |b| {
            b.iter(|| black_box(prepare()));
        });
        for method in [Method::Fractional, Method::Icp] {
            let settings = MatchSettings::of(method);
            group.bench_function(format!("{name}: match, {}", method.name()), |b| {
                b.iter(|| match_surfaces(black_box(&input), &settings, &monitor));
            });
        }
        let outcome = match_surfaces(&input, &MatchSettings::default(), &monitor);
        let outcome = outcome.expect("the sample parts match");
        group.bench_function(format!("{name}: assess"), |b| {
            b.iter(|| {
                assess(
                    &source,
                    &target,
                    &outcome,
                    &AssessSettings::default(),
                    &monitor,
                )
            });
        });
    }
    group.finish();
}

criterion_group!(benches, matching);
criterion_main!(benches);
