//! A priority queue by price, as exact as collapses need it.

/// An edge with its price.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// A bucket queue: prices within a sixteenth of an octave share a bucket, whose latest entry comes
/// out first. Full order by price gains nothing: the errors of the reduced car floor sample are the
/// same, to the scatter of a few percent that any change of the order brings.
#[derive(Debug)]
pub(super) struct Queue {
    buckets: Vec<Vec<Entry>>,
    /// Index of the cheapest bucket that may have entries.
    first: usize,
}

impl Queue {
    pub(super) fn new() -> Self {
        Self {
            buckets: vec![Vec::new(); N_BUCKETS],
            first: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.first = 0;
    }

    pub(super) fn push(&mut self, entry: Entry) {
        let bucket = (entry.key() >> SHIFT) as usize;
        self.first = self.first.min(bucket);
        self.buckets[bucket].push(entry);
    }

    /// Takes an entry from the cheapest bucket.
    pub(super) fn pop(&mut self) -> Option<Entry> {
        loop {
            let bucket = self.buckets.get_mut(self.first)?;
            if let Some(entry) = bucket.pop() {
                return Some(entry);
            }
            self.first += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn everything_comes_out_once_and_cheap_before_dear() {
        let key = |i: u32| key_of(f64::from(i * 7919 % 1000) * 1e-9);
        let mut queue = Queue::new();
        let mut waiting = BTreeSet::new();
        let take = |queue: &mut Queue, waiting: &mut BTreeSet<u32>| {
            let entry = queue.pop().unwrap();
            let cheapest = waiting.iter().map(|&i| key(i)).min().unwrap();
            assert_eq!(entry.key() >> SHIFT, cheapest >> SHIFT);
            assert!(waiting.remove(&entry.edge()));
        };
        for i in 0..300 {
            for j in [2 * i, 2 * i + 1] {
                queue.push(Entry::new(key(j), j));
                waiting.insert(j);
            }
            take(&mut queue, &mut waiting);
        }
        while !waiting.is_empty() {
            take(&mut queue, &mut waiting);
        }
        assert_eq!(queue.pop(), None);
    }
}
