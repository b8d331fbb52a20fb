//! Neighbours in fans and about crowded edges, and which side a sheet faces.

use super::*;
use crate::geometry::Point3;

fn square(corners: [[f64; 3]; 4]) -> [Point3; 4] {
    corners.map(Point3::from)
}

#[test]
fn a_fan_takes_no_memory_by_the_square_of_its_elements() {
    let n = 20_000_u32;
    let mut positions = vec![Point3::origin()];
    positions.extend((0..n).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        Point3::new(1000.0 * angle.cos(), 1000.0 * angle.sin(), 0.0)
    }));
    let rim = |i: u32| 1 + i % n;
    let corners = (0..n).map(|i| [0, rim(i), rim(i + 1), rim(i + 1)]);
    let mesh = ShellMesh::new(positions, corners.collect(), vec![0; n as usize]).unwrap();
    let links = mesh.links(&Monitor::silent()).unwrap();
    assert_eq!(links.neighbours.lists.items.len(), 2 * n as usize);
    for element in 0..n {
        let mut beside = [(element + n - 1) % n, (element + 1) % n];
        beside.sort_unstable();
        assert_eq!(links.neighbours.of(element as usize), beside);
        assert_eq!(links.border_edges[element as usize], 0b010);
    }
    assert!(!links.is_border_node(0) && links.is_border_node(1));
}

#[test]
fn where_many_elements_share_an_edge_none_of_them_are_neighbours() {
    let n = 20_000_u32;
    let mut positions = vec![Point3::origin(), Point3::new(0.0, 0.0, 10.0)];
    positions.extend((0..n).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        Point3::new(1000.0 * angle.cos(), 1000.0 * angle.sin(), 5.0)
    }));
    let corners = (0..n).map(|i| [0, 1, 2 + i, 2 + i]);
    let mesh = ShellMesh::new(positions, corners.collect(), vec![0; n as usize]).unwrap();
    let links = mesh.links(&Monitor::silent()).unwrap();
    assert!(links.neighbours.lists.items.is_empty());
    // Their common edge is no border.
    assert!(links.border_edges.iter().all(|&bits| bits == 0b110));
}

#[test]
fn a_fan_of_usual_size_has_all_its_elements_beside_each_other() {
    let n = MOST_AT_NODE as u32;
    let mut positions = vec![Point3::origin()];
    positions.extend((0..=n).map(|i| {
        let angle = f64::from(i) / f64::from(n);
        Point3::new(10.0 * angle.cos(), 10.0 * angle.sin(), 0.0)
    }));
    let corners = (0..n).map(|i| [0, i + 1, i + 2, i + 2]).collect();
    let mesh = ShellMesh::new(positions, corners, vec![0; n as usize]).unwrap();
    let links = mesh.links(&Monitor::silent()).unwrap();
    let neighbours = &links.neighbours;
    assert!((0..n as usize).all(|element| neighbours.of(element).len() == MOST_AT_NODE - 1));
}

/// Two squares side by side, a third one upright on their common edge, and one beside the first whose corners go
/// the other way round. Which side the upright one is on does not depend on the order of the elements.
#[test]
fn no_element_is_reversed_over_an_edge_of_three() {
    let elements = [
        square([
            [-1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 1.0, 0.0],
        ]),
        square([
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ]),
        square([
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
            [0.0, 0.0, 1.0],
        ]),
        square([
            [-1.5, 0.0, 0.0],
            [-1.5, 1.0, 0.0],
            [-1.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
        ]),
    ];
    for order in [[0, 1, 2, 3], [1, 0, 2, 3], [2, 1, 0, 3], [3, 2, 1, 0]] {
        let positions = order.map(|element| elements[element]).concat();
        let corners = (0..4).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]);
        let mesh = ShellMesh::new(positions, corners.collect(), vec![0; 4]).unwrap();
        let links = mesh.links(&Monitor::silent()).unwrap();
        let neighbours = &links.neighbours;
        assert!(neighbours.any_opposed());
        for (a, of_a) in order.into_iter().enumerate() {
            for (b, of_b) in order.into_iter().enumerate() {
                let is_one_reversed = (of_a == 3) != (of_b == 3);
                assert_eq!(neighbours.are_opposed(a, b), is_one_reversed, "{order:?}");
            }
        }
        assert_eq!(neighbours.reversed(), order.map(|element| element == 3));
    }
}
