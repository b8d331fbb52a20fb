//! Tests of ranges and distances.

use super::*;

#[test]
fn ranges_leave_out_tails_and_what_is_missing() {
    let mut values: Vec<f32> = (0..1000).map(|i| i as f32 / 1000.0).collect();
    values.extend([f32::NAN, 1e9]);
    let [low, high] = robust_range(&values).unwrap();
    assert!((0.0..0.01).contains(&low) && (0.99..1.0).contains(&high));
    let [low, high] = robust_range(&[2.0, 2.0]).unwrap();
    assert!(low < 2.0 && high > 2.0);
}

#[test]
fn a_part_without_values_leaves_the_colours_to_the_other() {
    let none = robust_range(&[f32::NAN, f32::INFINITY]);
    assert_eq!((none, robust_range(&[])), (None, None));
    let values = Some([0.02, 0.15]);
    assert_eq!(common_range([values, none].into_iter()), values);
    assert_eq!(common_range([none, values].into_iter()), values);
    assert_eq!(common_range([none, none].into_iter()), Some([0.0, 1.0]));
    assert_eq!(common_range(std::iter::empty()), None);
    let both = common_range([values, Some([-0.1, 0.1])].into_iter());
    assert_eq!(both, Some([-0.1, 0.15]));
}

#[test]
fn distances_are_those_to_the_surface() {
    let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
    let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let mesh = Arc::new(TriMesh::new(positions, vec![[0, 1, 2]]).unwrap());
    let points = [0.5, -0.25].map(|z| Point3::new(1.0, 1.0, z));
    assert_eq!(distances(&Bvh::build(mesh), &points), [0.5, 0.25]);
}
