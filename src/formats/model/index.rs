//! From an id to its dense index.

/// Ids per page. Small pages keep decks with many separate id ranges cheap.
const PAGE: u64 = 256;
/// The directory may have this many pages; wider ranges of ids are searched instead.
const MAX_DIRECTORY: u64 = 1 << 22;
/// Marks an id nobody has.
const NONE: u32 = u32::MAX;

/// Finds the index of an id: two array look-ups for ids in ranges, a binary search for scattered
/// ones. Of equal ids the first counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdIndex {
    form: Form,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Form {
    Paged {
        first_page: u64,
        /// Number of the page's table, or `NONE`.
        directory: Vec<u32>,
        tables: Vec<u32>,
    },
    Sorted(Vec<(u64, u32)>),
}

impl Default for IdIndex {
    fn default() -> Self {
        Self {
            form: Form::Sorted(Vec::new()),
        }
    }
}

impl IdIndex {
    /// Indexes `ids`; the second value lists the indices of ids that an earlier index has already.
    pub fn new(ids: &[u64]) -> (Self, Vec<u32>) {
        let first_page = ids.iter().min().copied().unwrap_or(0) / PAGE;
        let last_page = ids.iter().max().copied().unwrap_or(0) / PAGE;
        let n_pages = last_page - first_page + 1;
        if n_pages > MAX_DIRECTORY {
            return Self::sorted(ids);
        }
        let mut directory = vec![NONE; n_pages as usize];
        let mut n_tables = 0usize;
        for &id in ids {
            let slot = &mut directory[(id / PAGE - first_page) as usize];
            if *slot == NONE {
                *slot = n_tables as u32;
                n_tables += 1;
            }
        }
        // Scattered ids would waste most of each page.
        if n_tables * PAGE as usize > 8 * ids.len() + 65_536 {
            return Self::sorted(ids);
        }
        let mut tables = vec![NONE; n_tables * PAGE as usize];
        let mut repeated = Vec::new();
        for (index, &id) in ids.iter().enumerate() {
            let table = directory[(id / PAGE - first_page) as usize] as usize;
            let slot = &mut tables[table * PAGE as usize + (id % PAGE) as usize];
            if *slot == NONE {
                *slot = index as u32;
            } else {
                repeated.push(index as u32);
            }
        }
        let form = Form::Paged {
            first_page,
            directory,
            tables,
        };
        (Self { form }, repeated)
    }

    fn sorted(ids: &[u64]) -> (Self, Vec<u32>) {
        let mut pairs: Vec<(u64, u32)> = ids.iter().copied().zip(0..).collect();
        pairs.sort_unstable();
        let mut repeated = Vec::new();
        pairs.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                repeated.push(later.1);
            }
            same
        });
        repeated.sort_unstable();
        let form = Form::Sorted(pairs);
        (Self { form }, repeated)
    }

    /// The index of an id.
    #[inline]
    pub fn get(&self, id: u64) -> Option<u32> {
        match &self.form {
            Form::Paged {
                first_page,
                directory,
                tables,
            } => {
                let page = (id / PAGE).checked_sub(*first_page)?;
                let table = *directory.get(usize::try_from(page).ok()?)?;
                if table == NONE {
                    return None;
                }
                let index = tables[table as usize * PAGE as usize + (id % PAGE) as usize];
                (index != NONE).then_some(index)
            }
            Form::Sorted(pairs) => {
                let at = pairs.binary_search_by_key(&id, |pair| pair.0).ok()?;
                Some(pairs[at].1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;
    use std::collections::hash_map::Entry;

    fn check(ids: &[u64], probes: &[u64]) {
        let (index, repeated) = IdIndex::new(ids);
        let mut expected: HashMap<u64, u32> = HashMap::new();
        let mut twice = Vec::new();
        for (i, &id) in ids.iter().enumerate() {
            match expected.entry(id) {
                Entry::Occupied(_) => twice.push(i as u32),
                Entry::Vacant(slot) => {
                    slot.insert(i as u32);
                }
            }
        }
        for id in ids.iter().chain(probes) {
            assert_eq!(index.get(*id), expected.get(id).copied(), "{id}");
        }
        assert_eq!(repeated, twice);
    }

    #[test]
    fn dense_gapped_and_scattered_ids() {
        check(&[], &[0, 1, u64::MAX]);
        check(&[7], &[0, 6, 8, 263, u64::MAX]);
        check(&[u64::MAX, 0, 5, 5], &[1, 255, 256]);
        let tiles: Vec<u64> = (0..40)
            .flat_map(|t| (1..500).map(move |i| t * 100_000 + i))
            .collect();
        check(&tiles, &[0, 500, 99_999, 100_500, 5_000_000]);
        let scattered: Vec<u64> = (0..2000u64)
            .map(|i| i * 7919 * 104_729 % 1_000_000_007)
            .collect();
        check(&scattered, &[1, 2, 3]);
    }

    proptest! {
        #[test]
        fn as_a_hash_map_answers(
            ids in proptest::collection::vec(0u64..3000, 0..400),
            far in proptest::collection::vec(any::<u64>(), 0..50),
        ) {
            check(&ids, &far);
            let both: Vec<u64> = ids.iter().chain(&far).copied().collect();
            check(&both, &[1, 2, 3]);
        }
    }
}
