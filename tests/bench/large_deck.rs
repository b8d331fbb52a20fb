//! A large deck of nodes and shells in the standard format, made as it is needed.

use std::io::Write as _;

/// Nodes in a row of the grid.
const WIDTH: usize = 1000;
/// Bytes of a node's line and a shell's line together.
const PER_NODE: usize = 73 + 81;

/// About `n_bytes` of a wavy grid of quads: `*NODE` with all six fields, `*ELEMENT_SHELL` with all
/// ten, one part. As many nodes as shells but for the border.
pub fn large_deck(n_bytes: usize) -> Vec<u8> {
    let n_rows = (n_bytes / (PER_NODE * WIDTH)).max(2);
    let mut deck = Vec::with_capacity(n_rows * WIDTH * PER_NODE + 200);
    deck.extend(b"*KEYWORD\n*PART\nsheet\n         1\n*NODE\n");
    for i in 0..n_rows * WIDTH {
        let (x, y) = ((i % WIDTH) as f64 * 2.37, (i / WIDTH) as f64 * 1.93);
        let z = 40.0 * (x * 0.01).sin() * (y * 0.013).cos();
        writeln!(deck, "{:8}{x:16.7}{y:16.7}{z:16.9}       0       0", i + 1)
            .expect("writing to memory does not fail");
    }
    deck.extend(b"*ELEMENT_SHELL\n");
    let mut id = 0;
    for row in 0..n_rows - 1 {
        for column in 0..WIDTH - 1 {
            id += 1;
            let a = row * WIDTH + column + 1;
            let (b, c, d) = (a + 1, a + WIDTH + 1, a + WIDTH);
            writeln!(
                deck,
                "{id:8}{:8}{a:8}{b:8}{c:8}{d:8}       0       0       0       0",
                1
            )
            .expect("writing to memory does not fail");
        }
    }
    deck.extend(b"*END\n");
    deck
}
