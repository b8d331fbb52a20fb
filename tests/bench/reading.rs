//! Reading the nodes and shells of a large standard deck from disk (warm cache) into a model:
//! `cargo bench --no-default-features --bench reading`.
//!
//! `SHAPEMATCH_BENCH_BYTES` sets the size of the deck, 20,000,000 by default. A second row reads
//! with one thread; its time is the CPU time of the work.

mod large_deck;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shapematch::formats::{self, ReadOptions};
use shapematch::monitor::Monitor;

const DEFAULT_BYTES: usize = 20_000_000;

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
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.expect("a thread can be started");
    let mut group = c.benchmark_group("reading");
    group.sample_size(10);
    group.throughput(Throughput::Bytes(deck.len() as u64));
    group.bench_function("nodes and shells, all threads", |b| b.iter(read));
    group.bench_function("nodes and shells, one thread", |b| {
        b.iter(|| one.install(read));
    });
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
