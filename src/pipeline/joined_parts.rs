//! Crash parts that share nodes: pieces of one sheet, as those of a tailored blank, are parts of their own in a model.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::Model;

/// Of more parts than this at one node only so many are looked at: they are no pieces of one sheet.
const MOST_AT_NODE: usize = 16;
/// Parts that share fewer nodes share no edge.
const LEAST_SHARED: usize = 2;

/// The groups of two or more of the `chosen` parts, but for all of them, that are joined along common nodes: all that
/// hang together, and each two of more than two. Ids in ascending order. O(shells + groups).
pub fn joined_parts(model: &Model, chosen: &BTreeSet<u64>) -> BTreeSet<Vec<u64>> {
    let is_chosen = model.parts.iter().map(|part| chosen.contains(&part.id));
    let is_chosen: Vec<bool> = is_chosen.collect();
    let mut first_at: Vec<Option<u32>> = vec![None; model.nodes.len()];
    let mut further_at: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for shell in model.shells.iter().filter(|s| is_chosen[s.part as usize]) {
        for node in shell.nodes {
            let first = *first_at[node as usize].get_or_insert(shell.part);
            if first != shell.part {
                further_at.entry(node).or_default().insert(shell.part);
            }
        }
    }
    let mut n_shared: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (node, mut parts) in further_at {
        parts.extend(first_at[node as usize]);
        for &a in parts.iter().take(MOST_AT_NODE) {
            for &b in parts.range(a + 1..).take(MOST_AT_NODE) {
                *n_shared.entry((a, b)).or_default() += 1;
            }
        }
    }
    let joined = n_shared.into_iter().filter(|(_, n)| *n >= LEAST_SHARED);
    let pairs: Vec<(u32, u32)> = joined.map(|(pair, _)| pair).collect();
    let mut groups = hanging_together(&pairs);
    groups.extend(pairs.iter().map(|&(a, b)| BTreeSet::from([a, b])));
    let ids = |group: BTreeSet<u32>| {
        let mut ids: Vec<u64> = group.iter().map(|&p| model.parts[p as usize].id).collect();
        ids.sort_unstable();
        ids
    };
    let groups = groups.into_iter().map(ids);
    groups.filter(|ids| ids.len() < chosen.len()).collect()
}

/// What hangs together by pairs.
fn hanging_together(pairs: &[(u32, u32)]) -> Vec<BTreeSet<u32>> {
    let mut beside: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &(a, b) in pairs {
        beside.entry(a).or_default().push(b);
        beside.entry(b).or_default().push(a);
    }
    let mut groups = Vec::new();
    while let Some((first, others)) = beside.pop_first() {
        let mut group = BTreeSet::from([first]);
        let mut open = others;
        while let Some(part) = open.pop() {
            if group.insert(part) {
                open.extend(beside.remove(&part).unwrap_or_default());
            }
        }
        groups.push(group);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::model::{Nodes, Part, Shell};
    use crate::geometry::Point3;

    /// Squares in a row, each of a part; the corners of two beside each other are the same nodes unless they are cut.
    fn row(parts: &[u64], cut_after: &[usize]) -> Model {
        let mut n_nodes = 2;
        let mut shells = Vec::new();
        for at in 0..parts.len() {
            if at > 0 && cut_after.contains(&(at - 1)) {
                n_nodes += 2;
            }
            let a = n_nodes as u32 - 2;
            shells.push(Shell {
                id: at as u64 + 1,
                nodes: [a, a + 2, a + 3, a + 1],
                part: at as u32,
            });
            n_nodes += 2;
        }
        let ids = (1..=n_nodes as u64).collect();
        Model {
            nodes: Nodes::new(ids, vec![Point3::origin(); n_nodes]).0,
            shells,
            parts: parts
                .iter()
                .map(|&id| Part {
                    id,
                    ..Part::default()
                })
                .collect(),
            ..Model::default()
        }
    }

    #[test]
    fn parts_that_share_an_edge_are_joined() {
        let model = row(&[30, 10, 20, 40, 50], &[2]);
        let joined = |model: &Model, chosen: &[u64]| -> Vec<Vec<u64>> {
            let chosen = chosen.iter().copied().collect();
            joined_parts(model, &chosen).into_iter().collect()
        };
        let groups = joined(&model, &[10, 20, 30, 40, 50]);
        let expected = [vec![10, 20], vec![10, 20, 30], vec![10, 30], vec![40, 50]];
        assert_eq!(groups, expected);
        // Of three parts at an edge each two share it, in any order.
        let mut at_an_edge = row(&[1, 2, 3], &[]);
        at_an_edge.shells[2].nodes = [2, 6, 7, 3];
        let each_two = [vec![1, 2], vec![1, 3], vec![2, 3]];
        assert_eq!(
            joined(&at_an_edge, &[1, 2, 3, 9]),
            [vec![1, 2], vec![1, 2, 3], vec![1, 3], vec![2, 3]]
        );
        at_an_edge.shells.rotate_left(1);
        assert!(
            each_two
                .iter()
                .all(|two| joined(&at_an_edge, &[1, 2, 3, 9]).contains(two))
        );
        // Parts that meet at one node share no edge.
        let mut at_a_corner = row(&[1, 2, 3], &[0, 1]);
        at_a_corner.shells[1].nodes[0] = 3;
        assert!(joined(&at_a_corner, &[1, 2, 3]).is_empty());
        at_a_corner.shells[1].nodes[3] = 2;
        assert_eq!(joined(&at_a_corner, &[1, 2, 3]), [[1, 2]]);
        // All that are chosen are no group among them.
        assert!(joined(&at_a_corner, &[1, 2]).is_empty());
        // What is not chosen joins nothing.
        let without = joined(&model, &[20, 30, 40]);
        assert!(without.is_empty(), "{without:?}");
    }
}
