//! What is joined to what, as groups.

/// Group number of each of `n` things of which the pairs in `joined` belong together, counted from 0 in order of each
/// group's first member, and how many groups there are. O(n + pairs), nearly.
pub fn groups(n: usize, joined: impl IntoIterator<Item = [u32; 2]>) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..n as u32).collect();
    for [a, b] in joined {
        let (a, b) = (find(&mut parent, a), find(&mut parent, b));
        // The smaller root wins, so a group's root is its first member.
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut number = vec![u32::MAX; n];
    let mut count = 0;
    for member in 0..n as u32 {
        let root = find(&mut parent, member) as usize;
        if number[root] == u32::MAX {
            number[root] = count;
            count += 1;
        }
        number[member as usize] = number[root];
    }
    (number, count as usize)
}

fn find(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let above = parent[parent[node as usize] as usize];
        parent[node as usize] = above;
        node = above;
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_counted_in_order_of_their_first_members() {
        let (number, count) = groups(6, [[4, 2], [5, 1], [2, 5]]);
        assert_eq!((number, count), (vec![0, 1, 1, 2, 1, 1], 3));
        assert_eq!(groups(0, []), (vec![], 0));
    }
}
