//! Gradients, limits and layers of fields on small sheets.

use super::*;
use crate::geometry::Point3;

/// n × n unit squares in the plane z = 0, their inner nodes moved a little.
fn sheet(n: u32) -> ShellMesh {
    let node = |i: u32, j: u32| i * (n + 1) + j;
    let mut positions = Vec::new();
    for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
        let wobble = |k: f64| 0.2 * (f64::from(i) * 1.7 + f64::from(j) * 2.9 + k).sin();
        positions.push(Point3::new(
            f64::from(i) + wobble(0.0),
            f64::from(j) + wobble(1.0),
            0.0,
        ));
    }
    let mut corners = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        corners.push([
            node(i, j),
            node(i + 1, j),
            node(i + 1, j + 1),
            node(i, j + 1),
        ]);
    }
    let parts = vec![0; corners.len()];
    ShellMesh::new(positions, corners, parts).unwrap()
}

fn scalars(mesh: &ShellMesh, f: impl Fn(&Point3) -> f64) -> LayerValues<1> {
    LayerValues {
        n_layers: 1,
        values: mesh.centroids().iter().map(|c| [f(c)]).collect(),
        is_present: vec![true; mesh.len()],
    }
}

#[test]
fn a_linear_field_has_its_gradient() {
    let mesh = sheet(6);
    let stencils = Stencils::new(&mesh, &mesh.neighbours(), &[]);
    let f = |p: &Point3| 3.0 + 2.0 * p.x - 0.7 * p.y;
    let field = Field::new(FieldKind::Strain, pad(scalars(&mesh, f)), &mesh, &stencils);
    for element in 0..mesh.len() {
        let at = mesh.corner_points(element)[1];
        let offset = stencils.in_plane(element, &(at - mesh.centroids()[element]));
        let value = field.weighted(element, 0, 1.0, &offset)[0];
        assert!((value - f(&at)).abs() < 1e-12, "{element}: {value}");
    }
}

/// The number as the first of six, which are not limited; turning does nothing in a plane.
fn pad(values: LayerValues<1>) -> LayerValues<6> {
    LayerValues {
        n_layers: 1,
        values: values
            .values
            .iter()
            .map(|v| [v[0], 0.0, 0.0, 0.0, 0.0, 0.0])
            .collect(),
        is_present: values.is_present,
    }
}

#[test]
fn a_limited_field_stays_within_its_neighbours() {
    let mesh = sheet(8);
    let stencils = Stencils::new(&mesh, &mesh.neighbours(), &[]);
    let step = |p: &Point3| if p.x > 4.0 { 2.0 } else { 1.0 };
    let field = Field::new(FieldKind::Scalars, scalars(&mesh, step), &mesh, &stencils);
    for element in 0..mesh.len() {
        for corner in mesh.corner_points(element) {
            let offset = stencils.in_plane(element, &(corner - mesh.centroids()[element]));
            let value = field.weighted(element, 0, 1.0, &offset)[0];
            assert!((1.0 - 1e-12..=2.0 + 1e-12).contains(&value), "{value}");
        }
    }
}

#[test]
fn a_weld_line_is_no_slope() {
    let mesh = sheet(8);
    let gauge: Vec<f64> = mesh
        .centroids()
        .iter()
        .map(|c| if c.x > 4.0 { 2.0 } else { 1.0 })
        .collect();
    let stencils = Stencils::new(&mesh, &mesh.neighbours(), &gauge);
    let values = scalars(&mesh, |p| if p.x > 4.0 { 2.0 } else { 1.0 });
    let field = Field::new(FieldKind::Scalars, values, &mesh, &stencils);
    assert!(
        field
            .gradients
            .iter()
            .flatten()
            .flatten()
            .all(|g| *g == 0.0)
    );
}

#[test]
fn points_of_a_layer_are_averaged_and_layers_sorted() {
    let mut layered = Layered::<1>::new(3);
    let points = [
        (0.577_350_27, 4.0),
        (-0.577_350_27, 1.0),
        (-0.577_350_27, 3.0),
        (0.577_350_27, 6.0),
    ];
    layered.set(1, points.into_iter().map(|(t, v)| (t, [v])));
    layered.set(2, [(0.0, [f64::NAN])].into_iter());
    assert_eq!(layered.of(0), None);
    assert_eq!(layered.of(2), None);
    let (rule, values) = layered.of(1).unwrap();
    assert_eq!(values, [[2.0], [5.0]]);
    assert_eq!(rule.weights(), [1.0, 1.0]);
    assert_eq!(layered.n_present(), 1);
}
