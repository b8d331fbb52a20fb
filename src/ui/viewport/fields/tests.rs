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

#[test]
fn a_summary_weighs_by_area_and_counts_what_is_known() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [6.0, 0.0]];
    let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    // A square of two triangles and a triangle as large as it.
    let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]];
    let mesh = TriMesh::new(positions, triangles).unwrap();
    let elements = [0, 0, 1];
    let found = Summary::of_elements(&mesh, &elements, &[1.0, 4.0]).unwrap();
    assert_eq!((found.min, found.max, found.n), (1.0, 4.0, 2));
    assert!((found.mean() - 2.5).abs() < 1e-6);
    let one = Summary::of_elements(&mesh, &elements, &[f64::NAN, 4.0]).unwrap();
    assert_eq!((one.min, one.n, one.mean()), (4.0, 1, 4.0));
    assert_eq!(Summary::of_elements(&mesh, &elements, &[]), None);
    let at_nodes = [3.0, 3.0, 3.0, f32::NAN, 3.0];
    let found = Summary::of_nodes(&mesh, &at_nodes).unwrap();
    assert_eq!((found.n, found.is_of_elements), (4, false));
    assert!((found.mean() - 3.0).abs() < 1e-6);
    assert_eq!(Summary::of_nodes(&mesh, &[f32::NAN; 5]), None);
}

#[test]
fn differences_that_are_all_rounding_are_none() {
    let sizes = || [0.8, 1.4, f64::NAN].into_iter();
    let equal = without_rounding(vec![1e-7, f64::NAN, -2e-7], sizes());
    assert!(equal[0] == 0.0 && equal[1].is_nan() && equal[2] == 0.0);
    let differ = vec![1e-7, 0.01];
    assert_eq!(without_rounding(differ.clone(), sizes()), differ);
}

/// The colours at the nodes between elements are means, the figures are those of the elements themselves: the same as
/// in record and report.
#[test]
fn figures_of_a_quantity_are_those_of_its_elements() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let values = [0.8, 1.2];
    let found = Summary::of_elements(&mesh, &[0, 1], &values).unwrap();
    let areas = values.map(|value| (value, 2.0));
    let stated = crate::mapping::distribution(areas.into_iter()).unwrap();
    assert_eq!((found.min, found.max), (stated.min, stated.max));
    assert!((found.mean() - stated.mean).abs() < 1e-12);
    assert!(found.is_of_elements);
}
