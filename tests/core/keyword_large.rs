//! Decks too large to be read in one piece: nothing is lost, whatever the number of threads.

use std::path::Path;

use shapematch::formats::{self, DiagnosticKind, Memory, Model, ReadOptions, Selection};
use shapematch::monitor::Monitor;

#[path = "../bench/large_deck.rs"]
mod large_deck;

use large_deck::large_deck;

fn read(deck: Vec<u8>, n_threads: usize) -> Model {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
    let files = Memory::new().with("large.k", deck);
    let options = ReadOptions::default();
    pool.build().unwrap().install(|| {
        formats::read_from(&files, Path::new("large.k"), &options, &Monitor::silent()).unwrap()
    })
}

#[test]
fn the_deck_of_the_benchmark_is_read_as_it_was_made() {
    let model = read(large_deck(2_500_000), 2);
    assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    let (width, n_rows) = (1000, 16);
    assert_eq!(model.nodes.len(), width * n_rows);
    assert_eq!(model.shells.len(), (width - 1) * (n_rows - 1));
    let last = model.shells.last().unwrap();
    let n = model.nodes.len() as u32;
    assert_eq!(last.nodes, [n - 1002, n - 1001, n - 1, n - 2]);
    let surface = model.surface(&Selection::All).unwrap();
    assert_eq!(surface.mesh.n_triangles(), 2 * model.shells.len());
}

#[test]
fn the_model_does_not_depend_on_the_number_of_threads() {
    let mut deck = large_deck(3_500_000);
    // Faults in several pieces: their order and places are part of what must be the same.
    for at in [400_000, 900_000, 1_300_000, 2_000_000, 2_600_000, 3_100_000] {
        let line = at + memchr::memchr(b'\n', &deck[at..]).unwrap() + 1;
        deck[line + 20..line + 23].copy_from_slice(b"x.y");
    }
    let one = read(deck.clone(), 1);
    let four = read(deck, 4);
    assert_eq!(one.diagnostics.count(DiagnosticKind::BadField), 6);
    assert!(one.diagnostics.count(DiagnosticKind::MissingNode) > 0);
    assert!(one == four, "the models differ");
}
