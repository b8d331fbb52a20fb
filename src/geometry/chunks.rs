//! Long loops in pieces, so that a cancel request is seen within a few milliseconds.

use std::ops::Range;

use rayon::prelude::*;

use crate::monitor::{Cancelled, Monitor};

/// Items per piece. Fixed, so that nothing depends on the number of threads.
pub(crate) const CHUNK: usize = 1 << 14;
/// Items that all threads make together between two questions, and that one of them takes at least.
const WAVE: usize = 4 * CHUNK;
const LEAST: usize = 1 << 10;

/// Hands consecutive ranges that cover `0..n` to `work`, asking `monitor` before each.
pub(crate) fn for_chunks(
    n: usize,
    monitor: &Monitor,
    mut work: impl FnMut(Range<usize>),
) -> Result<(), Cancelled> {
    for start in (0..n).step_by(CHUNK) {
        monitor.check()?;
        work(start..n.min(start + CHUNK));
    }
    Ok(())
}

/// `make(0)`, `make(1)`, … on all threads.
pub(crate) fn map_chunks<T: Send>(
    n: usize,
    monitor: &Monitor,
    make: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    let mut made = Vec::with_capacity(n);
    for start in (0..n).step_by(WAVE) {
        monitor.check()?;
        let wave = (start..n.min(start + WAVE)).into_par_iter();
        made.par_extend(wave.with_min_len(LEAST).map(&make));
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_comes_once_and_in_its_place() {
        let n = 2 * WAVE + 7;
        let monitor = Monitor::silent();
        let mut next = 0;
        for_chunks(n, &monitor, |range| {
            assert_eq!(range.start, next);
            next = range.end;
        })
        .unwrap();
        assert_eq!(next, n);
        let squares = map_chunks(n, &monitor, |i| i * i).unwrap();
        assert!(squares.iter().enumerate().all(|(i, &s)| s == i * i));
    }

    #[test]
    fn a_cancel_request_ends_both() {
        let monitor = Monitor::silent();
        monitor.request_cancel();
        assert_eq!(for_chunks(1, &monitor, |_| panic!("ran")), Err(Cancelled));
        assert_eq!(map_chunks(1, &monitor, |i| i), Err(Cancelled));
    }
}
