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
/// Buckets in all.
pub(super) const N_BUCKETS: usize = 1 << (24 - SHIFT);

/// Ends a list of entries.
const END: u32 = u32::MAX;

/// A bucket queue: prices within a sixteenth of an octave share a bucket, whose latest entry comes
/// out first. Full order by price gains nothing: the errors of the reduced car floor sample are the
/// same, to the scatter of a few percent that any change of the order brings.
#[derive(Debug)]
pub(super) struct Queue {
    buckets: Vec<Bucket>,
    /// Entries, each with the one after it in its bucket or among the free ones.
    slots: Vec<(Entry, u32)>,
    free: u32,
    /// Index of the cheapest bucket that may have entries.
    first: usize,
}

#[derive(Debug, Clone, Copy)]
struct Bucket {
    latest: u32,
    len: u32,
}

impl Queue {
    pub(super) fn new() -> Self {
        let nothing = Bucket {
            latest: END,
            len: 0,
        };
        Self {
            buckets: vec![nothing; N_BUCKETS],
            slots: Vec::new(),
            free: END,
            first: 0,
        }
    }

    pub(super) fn push(&mut self, entry: Entry) {
        let index = (entry.key() >> SHIFT) as usize;
        self.first = self.first.min(index);
        let bucket = &mut self.buckets[index];
        let slot = (entry, bucket.latest);
        bucket.len += 1;
        if self.free == END {
            bucket.latest = self.slots.len() as u32;
            self.slots.push(slot);
        } else {
            bucket.latest = self.free;
            let free = &mut self.slots[self.free as usize];
            self.free = free.1;
            *free = slot;
        }
    }

    /// The cheapest bucket that may have entries: that of the entry that came out last, if nothing
    /// was put in since.
    pub(super) fn first(&self) -> usize {
        self.first
    }

    /// Entries in a bucket.
    pub(super) fn len_of(&self, bucket: usize) -> usize {
        self.buckets[bucket].len as usize
    }

    /// Takes an entry from the cheapest bucket if that comes before `end`, see [`N_BUCKETS`].
    pub(super) fn pop_before(&mut self, end: usize) -> Option<Entry> {
        loop {
            let bucket = self.buckets[..end].get_mut(self.first)?;
            if bucket.latest == END {
                self.first += 1;
                continue;
            }
            let at = bucket.latest;
            let slot = &mut self.slots[at as usize];
            bucket.latest = slot.1;
            bucket.len -= 1;
            slot.1 = self.free;
            self.free = at;
            return Some(slot.0);
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
            let entry = queue.pop_before(N_BUCKETS).unwrap();
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
        assert_eq!(queue.pop_before(N_BUCKETS), None);
    }
}
