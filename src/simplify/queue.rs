//! A priority queue for prices that seldom fall.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An edge with its price, ordered by price, then by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    /// An entry for `edge` at the price `key`, see [`key_of`].
    pub(super) fn new(key: u32, edge: u32) -> Self {
        Self(u64::from(key) << 32 | u64::from(edge))
    }

    pub(super) fn key(self) -> u32 {
        (self.0 >> 32) as u32
    }

    pub(super) fn edge(self) -> u32 {
        self.0 as u32
    }
}

/// The cost as an integer that sorts alike: exponent and 15 bits of the fraction. Costs that
/// differ by rounding alone are equal, and the vertex numbers decide.
pub(super) fn key_of(cost: f64) -> u32 {
    (cost as f32).to_bits() >> 8
}

/// The key of four times the price, and never so small that a price of zero stays where it is.
pub(super) fn later_than(key: u32) -> u32 {
    key.max(key_of(1e-24)) + (2 << 15)
}

/// Buckets per factor of two in price.
const BUCKETS_PER_OCTAVE_LOG2: u32 = 4;
const SHIFT: u32 = 15 - BUCKETS_PER_OCTAVE_LOG2;
const N_BUCKETS: usize = 1 << (24 - SHIFT);

/// A bucket queue: entries wait unsorted in buckets by price, and a bucket is sorted when its turn
/// comes. Entries that belong to the current bucket or an earlier one go to a small heap, so the
/// order is that of a full heap, at a fraction of its cost while most entries go to later buckets.
#[derive(Debug)]
pub(super) struct Queue {
    buckets: Vec<Vec<Entry>>,
    /// Index of the next bucket to be opened.
    next_bucket: usize,
    /// The open bucket, dearest first.
    open: Vec<Entry>,
    late: BinaryHeap<Reverse<Entry>>,
}

impl Queue {
    pub(super) fn new() -> Self {
        Self {
            buckets: vec![Vec::new(); N_BUCKETS],
            next_bucket: 0,
            open: Vec::new(),
            late: BinaryHeap::new(),
        }
    }

    pub(super) fn clear(&mut self) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.next_bucket = 0;
        self.open.clear();
        self.late.clear();
    }

    pub(super) fn push(&mut self, entry: Entry) {
        let bucket = (entry.key() >> SHIFT) as usize;
        if bucket < self.next_bucket {
            self.late.push(Reverse(entry));
        } else {
            self.buckets[bucket].push(entry);
        }
    }

    /// The cheapest entry.
    pub(super) fn peek(&mut self) -> Option<Entry> {
        while self.open.is_empty() && self.late.is_empty() && self.next_bucket < N_BUCKETS {
            std::mem::swap(&mut self.open, &mut self.buckets[self.next_bucket]);
            self.next_bucket += 1;
            self.open.sort_unstable_by(|x, y| y.cmp(x));
        }
        match (self.open.last(), self.late.peek()) {
            (Some(open), Some(late)) => Some(late.0.min(*open)),
            (open, late) => open.copied().or(late.map(|late| late.0)),
        }
    }

    /// Takes the cheapest entry.
    pub(super) fn pop(&mut self) -> Option<Entry> {
        let entry = self.peek()?;
        if self.open.last() == Some(&entry) {
            self.open.pop();
        } else {
            self.late.pop();
        }
        Some(entry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_out_in_order_whatever_goes_in_when() {
        let entry = |i: u32| Entry::new(key_of(f64::from(i * 7919 % 1000) * 1e-9), i);
        let mut queue = Queue::new();
        let mut plain = std::collections::BTreeSet::new();
        for i in 0..3000 {
            for j in [2 * i, 2 * i + 1] {
                queue.push(entry(j));
                plain.insert(entry(j));
            }
            assert_eq!(queue.pop(), plain.pop_first());
        }
        while let Some(first) = plain.pop_first() {
            assert_eq!(queue.pop(), Some(first));
        }
        assert_eq!(queue.pop(), None);
    }
}
