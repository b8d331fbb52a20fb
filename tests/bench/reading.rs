//! Reading the nodes and shells of a large standard deck from disk (warm cache) into a model:
//! `cargo bench --no-default-features --bench reading`.
//!
//! `SHAPEMATCH_BENCH_BYTES` sets the size of the deck, 20,000,000 by default. A second row gives the
//! CPU time of all threads together (Linux only), which other work on the machine hardly changes.

mod large_deck;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shapematch::formats::{self, ReadOptions};
use shapematch::monitor::Monitor;

const DEFAULT_BYTES: usize = 20_000_000;

/// User and system time of all threads so far, as the scheduler counts it.
fn cpu_time() -> Option<Duration> {
    let mut total = Duration::ZERO;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        let on_cpu = text.split_whitespace().next()?;
        total += Duration::from_nanos(on_cpu.parse().ok()?);
    }
    Some(total)
}

fn reading(c: &mut Criterion) {
    let wanted = std::env::var("SHAPEMATCH_BENCH_BYTES");
    let n_bytes = wanted.ok().and_then(|text| text.parse().ok());
    let deck = large_deck::large_deck(n_bytes.unwrap_or(DEFAULT_BYTES));
    let folder = tempfile::tempdir().expect("a folder for the deck");
    let path = folder.path().join("large.k");
    std::fs::write(&path, &deck).expect("room for the deck");
    let read = || {
        let read = formats::read(&path, &ReadOptions::default(), &Monitor::silent());
        black_box(read.expect("the deck is readable"))
    };
    let mut group = c.benchmark_group("reading");
    group.sample_size(10);
    group.throughput(Throughput::Bytes(deck.len() as u64));
    group.bench_function("nodes and shells, wall time", |b| b.iter(read));
    if cpu_time().is_some() {
        group.bench_function("nodes and shells, CPU time", |b| {
            b.iter_custom(|n| {
                let before = cpu_time().unwrap_or_default();
                (0..n).for_each(|_| drop(read()));
                cpu_time().unwrap_or_default().saturating_sub(before)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
