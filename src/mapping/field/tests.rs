//! Gradients, limits and layers of fields on small sheets.

use super::*;
use crate::geometry::Point3;
use crate::mapping::layered::Layered;
use crate::mapping::shells::ShellMesh;
use crate::monitor::Monitor;

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

fn scalars(mesh: &ShellMesh, f: impl Fn(&Point3) -> f64) -> Vec<f64> {
    mesh.centroids().iter().map(f).collect()
}

/// The field of one number around every element; slots are element numbers.
fn fitted(mesh: &ShellMesh, numbers: &[f64], gauge: &[f64]) -> Fields {
    let mut patch = Patch::default();
    let links = mesh.links(&Monitor::silent()).unwrap();
    patch.load(0..mesh.len() as u32, mesh, &links.neighbours, gauge);
    Fields::of_thickness(patch, numbers)
}

/// The number as the first of six, which are not limited.
struct First<'a>(&'a [f64]);

impl Numbers<6> for First<'_> {
    fn n_layers(&self) -> usize {
        1
    }

    fn has(&self, _element: usize) -> bool {
        true
    }

    fn push(&self, element: usize, out: &mut Vec<[f64; 6]>) {
        out.push([self.0[element], 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn a_linear_field_has_its_gradient() {
    let mesh = sheet(6);
    let f = |p: &Point3| 3.0 + 2.0 * p.x - 0.7 * p.y;
    let numbers = scalars(&mesh, f);
    let mut fields = fitted(&mesh, &numbers, &[]);
    let mut field = Field::default();
    let first = First(&numbers);
    field.load([&first; 2], &fields.patch);
    fields.strains = Some(field);
    fields.fit();
    let field = fields.strains.unwrap();
    for slot in 0..mesh.len() {
        let at = mesh.corner_points(slot)[1];
        let offset = fields.patch.corners(slot)[1];
        let axes = fields.patch.frame(slot);
        let out_of_frame = Turn::new(&Matrix3::from_columns(axes));
        let value = from_local(&field.weighted(slot, 0, 1.0, &offset), &out_of_frame);
        assert!((value[0] - f(&at)).abs() < 1e-12, "{slot}: {value:?}");
        assert!(value[1..].iter().all(|x| x.abs() < 1e-12), "{value:?}");
    }
}

#[test]
fn a_limited_field_stays_within_its_neighbours() {
    let mesh = sheet(8);
    let step = |p: &Point3| if p.x > 4.0 { 2.0 } else { 1.0 };
    let fields = fitted(&mesh, &scalars(&mesh, step), &[]);
    let field = fields.thickness.unwrap();
    for slot in 0..mesh.len() {
        for offset in fields.patch.corners(slot) {
            let value = field.weighted(slot, 0, 1.0, offset)[0];
            assert!((1.0 - 1e-12..=2.0 + 1e-12).contains(&value), "{value}");
        }
    }
}

#[test]
fn a_weld_line_is_no_slope() {
    let mesh = sheet(8);
    let step = |p: &Point3| if p.x > 4.0 { 2.0 } else { 1.0 };
    let gauge = scalars(&mesh, step);
    let field = fitted(&mesh, &gauge, &gauge).thickness.unwrap();
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
fn thinning_is_no_weld_line_however_steep() {
    let mesh = sheet(12);
    // Up to 14 % from one element to the next.
    let neck = |p: &Point3| 1.0 - 0.4 * (-((p.x - 6.0) / 2.0).powi(2)).exp();
    let thickness = scalars(&mesh, neck);
    let slopes = |gauge: &[f64]| {
        let field = fitted(&mesh, &thickness, gauge).thickness.unwrap();
        field.gradients.concat().concat()
    };
    let pairs = slopes(&thickness).into_iter().zip(slopes(&[]));
    let apart = pairs.fold(0.0_f64, |apart, (own, all)| apart.max((own - all).abs()));
    // Where the neck begins a neighbour may be left out.
    assert!(apart < 0.02, "{apart}");
}

#[test]
fn a_weld_line_is_seen_where_both_gauges_have_thinned() {
    let mesh = sheet(8);
    let gauge = |p: &Point3| if p.x > 4.0 { 1.2 } else { 1.0 };
    let thickness = scalars(&mesh, |p| gauge(p) * (1.0 - 0.02 * p.x));
    let field = fitted(&mesh, &thickness, &thickness).thickness.unwrap();
    let slopes = field.gradients.iter().flatten().flatten();
    let steepest = slopes.fold(0.0_f64, |steepest, slope| steepest.max(slope.abs()));
    assert!(steepest < 0.04, "{steepest}");
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

#[test]
fn a_spin_within_the_plane_is_the_smallest_rotation_between_planes() {
    use crate::geometry::tensor::{smallest_rotation, von_mises_sq as global_mises_sq};
    let mut mesh = sheet(3);
    let bend = |p: &Point3| Point3::new(p.x, p.y, 0.2 * p.x * p.x - 0.1 * p.x * p.y);
    let positions = mesh.positions().iter().map(bend).collect();
    mesh = ShellMesh::new(positions, mesh.corners().to_vec(), mesh.parts().to_vec()).unwrap();
    let mut patch = Patch::default();
    let links = mesh.links(&Monitor::silent()).unwrap();
    patch.load(0..mesh.len() as u32, &mesh, &links.neighbours, &[]);
    let tensor = [120.0, -35.0, 4.0, 22.0, -7.0, 13.0];
    let mut n_links = 0;
    for slot in 0..mesh.len() {
        for link in patch.links(slot) {
            let other = link.slot as usize;
            let into = patch.frame(other).map(|axis| axis.transpose());
            let local = into_local(&tensor, &Turn::new(&Matrix3::from_rows(&into)));
            let out = Turn::new(&Matrix3::from_columns(patch.frame(slot)));
            let found = from_local(&spun(local, &link.spin), &out);
            let turn = smallest_rotation(&mesh.normals()[other], &mesh.normals()[slot]).unwrap();
            let expected = Turn::new(&turn).apply(&tensor);
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-12 * 120.0, "{found:?} {expected:?}");
            }
            let squares = [von_mises_sq(&local), global_mises_sq(&tensor)];
            assert!((squares[0] - squares[1]).abs() < 1e-12 * squares[1]);
            n_links += 1;
        }
    }
    assert!(n_links > 20);
}

/// A sheet folded flat onto itself, with its normals in one sense along it and with all of them upwards.
#[test]
fn a_fold_is_no_neighbour_seen_from_below() {
    let flat = sheet(6);
    let is_beyond = |p: &Point3| p.x > 3.5;
    let fold = |p: &Point3| {
        if is_beyond(p) {
            Point3::new(6.0 - p.x, p.y, 0.05 * (p.x - 2.0))
        } else {
            *p
        }
    };
    let positions: Vec<Point3> = flat.positions().iter().map(fold).collect();
    let own = |element: usize| flat.centroids()[element].x > 3.0;
    let upwards = (0..flat.len()).map(|element| {
        let [a, b, c, d] = flat.corners()[element];
        if own(element) {
            [a, d, c, b]
        } else {
            [a, b, c, d]
        }
    });
    let upwards: Vec<[u32; 4]> = upwards.collect();
    for (corners, n_opposed) in [(flat.corners().to_vec(), 0), (upwards, 16)] {
        let mesh = ShellMesh::new(positions.clone(), corners, flat.parts().to_vec()).unwrap();
        let links = mesh.links(&Monitor::silent()).unwrap();
        let neighbours = &links.neighbours;
        let pairs = (0..mesh.len()).flat_map(|a| neighbours.of(a).iter().map(move |&b| (a, b)));
        let opposed =
            pairs.filter(|&(a, b)| a < b as usize && neighbours.are_opposed(a, b as usize));
        assert_eq!(opposed.count(), n_opposed);
        let mut patch = Patch::default();
        patch.load(0..mesh.len() as u32, &mesh, neighbours, &[]);
        for slot in 0..mesh.len() {
            for link in patch.links(slot) {
                let seen = patch.seen()[link.slot as usize];
                assert!(!seen.from_below);
                assert_eq!(own(seen.element as usize), own(slot));
            }
        }
    }
}
