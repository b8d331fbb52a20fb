//! A model laid elsewhere by a mirror is the same sheet seen in a mirror: its surface, its sides
//! and what belongs to its corners.

use shapematch::formats::model::{Nodes, Part, Shell, ShellExtra, Solid, SolidKind, StressPoint};
use shapematch::formats::moved::moved;
use shapematch::formats::{Model, Selection};
use shapematch::geometry::{Matrix3, Point3, Pose, Similarity, Vector3};

/// A quad and a triangle, bent, with a brick, a tetrahedron and results for four points in the
/// plane of two layers.
fn model() -> Model {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [1.2, 1.0, 0.3],
        [0.0, 1.1, 0.0],
        [2.0, 0.5, 0.6],
        [0.5, 0.05, 0.0],
        [1.1, 0.5, 0.1],
        [0.6, 1.05, 0.1],
        [0.0, 0.5, 0.0],
    ];
    let lower = positions.map(Point3::from);
    let upper = lower.map(|p| p + Vector3::new(0.3, 0.2, 2.0));
    let all: Vec<Point3> = lower.into_iter().chain(upper).collect();
    let mut model = Model {
        nodes: Nodes::new((1..=18).collect(), all).0,
        parts: vec![Part {
            id: 1,
            thickness: Some([1.0, 1.1, 1.2, 1.3]),
            is_defined: true,
            ..Part::default()
        }],
        ..Model::default()
    };
    let shell = |id: u64, nodes: [u32; 4]| Shell { id, nodes, part: 0 };
    model.shells = vec![shell(1, [0, 1, 2, 3]), shell(2, [1, 4, 2, 2])];
    model.mid_side = vec![(0, [5, 6, 7, 8]), (1, [5, 6, 7, u32::MAX])];
    model.shell_extras = vec![
        ShellExtra {
            shell: 0,
            thickness: [1.0, 2.0, 3.0, 4.0],
            beta: 30.0,
            plies: None,
        },
        ShellExtra {
            shell: 1,
            thickness: [5.0, 6.0, 7.0, 0.0],
            beta: 0.0,
            plies: None,
        },
    ];
    let solid = |id: u64, nodes: [u32; 8]| Solid {
        id,
        nodes,
        part: 0,
        kind: SolidKind::Solid,
    };
    model.solids = vec![
        solid(3, [0, 1, 2, 3, 9, 10, 11, 12]),
        solid(4, [1, 4, 2, 13, 13, 13, 13, 13]),
    ];
    let point = |i: u32| StressPoint {
        t: if i < 4 { -0.5 } else { 0.5 },
        stress: [f64::from(i), 0.0, 0.0, 2.0, 0.0, 0.0],
        plastic_strain: f64::from(i),
    };
    let points: Vec<StressPoint> = (0..8).map(point).collect();
    let history: Vec<f64> = (0..16).map(f64::from).collect();
    model
        .forming
        .add_state(1, 4, &points, &history, &[])
        .unwrap();
    model.forming.others.solid_stress = 2;
    model
}

fn mirror() -> Similarity {
    let turn = Pose::new(Vector3::new(3.0, -2.0, 1.0), Vector3::new(0.4, 1.0, -0.3));
    let in_yz = Similarity {
        rotation: Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0)),
        translation: Vector3::zeros(),
        scale: 2.0,
    };
    Similarity::from(turn).after(&in_yz)
}

/// Corners of the triangles, each beginning with its smallest, sorted.
fn triangles(corners: impl Iterator<Item = [Point3; 3]>) -> Vec<[[i64; 3]; 3]> {
    let rounded = corners.map(|corners| {
        let [a, b, c] = corners.map(|p| [p.x, p.y, p.z].map(|x| (x * 1e9).round() as i64));
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
    });
    let mut all: Vec<_> = rounded.collect();
    all.sort_unstable();
    all
}

#[test]
fn the_surface_is_that_of_the_mirrored_mesh() {
    let (before, motion) = (model(), mirror());
    assert!(motion.is_mirrored());
    let after = moved(&before, &motion, motion.scale);
    for selection in [Selection::All, Selection::Parts(vec![1])] {
        let expected = before
            .surface(&selection)
            .unwrap()
            .mesh
            .transformed(&motion);
        let found = after.surface(&selection).unwrap().mesh;
        let corners = |mesh: &shapematch::geometry::TriMesh| {
            triangles((0..mesh.n_triangles()).map(|t| mesh.corners(t)))
        };
        assert_eq!(corners(&found), corners(&expected));
    }
}

#[test]
fn what_belongs_to_a_corner_stays_with_its_node() {
    let own = model();
    // The part's thickness at all corners, and at those that have none of their own.
    let mut of_part = own.clone();
    of_part.shell_extras.clear();
    let mut of_both = own.clone();
    of_both.shell_extras.remove(0);
    of_both.shell_extras[0].thickness = [0.0, 6.0, 0.0, 0.0];
    for before in [own, of_part, of_both] {
        stays_with_its_node(&before);
    }
}

#[track_caller]
fn stays_with_its_node(before: &Model) {
    let motion = mirror();
    let after = moved(before, &motion, motion.scale);
    for (index, (old, new)) in (0u32..).zip(before.shells.iter().zip(&after.shells)) {
        let thickness = |model: &Model, node: u32| {
            let shell = &model.shells[index as usize];
            let at = shell.corners().iter().position(|&n| n == node).unwrap();
            model.shell_thickness(index).unwrap()[at]
        };
        for &node in old.corners() {
            assert_eq!(thickness(&after, node), 2.0 * thickness(before, node));
        }
        assert_eq!(new.is_triangle(), old.is_triangle());
        // A mid-side node lies on the edge between the same corners.
        let edge = |shell: &Shell, mid: &[u32; 4], node: u32| {
            let n = shell.corners().len();
            let at = mid.iter().position(|&m| m == node).unwrap();
            let mut ends = [shell.corners()[at % n], shell.corners()[(at + 1) % n]];
            ends.sort_unstable();
            ends
        };
        let (old_mid, new_mid) = (
            before.mid_side[index as usize].1,
            after.mid_side[index as usize].1,
        );
        for node in old_mid.into_iter().filter(|&node| node != u32::MAX) {
            assert_eq!(edge(old, &old_mid, node), edge(new, &new_mid, node));
        }
    }
}

/// Direction of the first material axis: turned by β from the first edge about the normal.
fn material_axis(model: &Model) -> Vector3 {
    let [a, b, c, d] = model.shells[0]
        .nodes
        .map(|n| model.nodes.positions()[n as usize]);
    let normal = (c - a).cross(&(d - b)).normalize();
    let edge = b - a;
    let x = (edge - normal * edge.dot(&normal)).normalize();
    let beta = model.shell_extras[0].beta.to_radians();
    x * beta.cos() + normal.cross(&x) * beta.sin()
}

#[test]
fn the_material_axis_is_mirrored() {
    let (before, motion) = (model(), mirror());
    let after = moved(&before, &motion, motion.scale);
    let expected = motion.rotation * material_axis(&before);
    let found = material_axis(&after);
    assert!((expected.dot(&found).abs() - 1.0).abs() < 1e-12);
}

#[test]
fn results_keep_their_side_and_their_corner() {
    let (before, motion) = (model(), mirror());
    let after = moved(&before, &motion, motion.scale);
    let shell = after.forming.stress(0);
    let strains: Vec<f64> = shell.points.iter().map(|p| p.plastic_strain).collect();
    assert_eq!(strains, [1.0, 0.0, 3.0, 2.0, 5.0, 4.0, 7.0, 6.0]);
    assert_eq!(shell.history[..4], [2.0, 3.0, 0.0, 1.0]);
    let sides: Vec<f64> = shell.points.iter().map(|p| p.t).collect();
    assert_eq!(sides, [-0.5, -0.5, -0.5, -0.5, 0.5, 0.5, 0.5, 0.5]);
    // Tension across the sheet's own axis stays so: Qn·σ'·Qn = n·σ·n for any direction n.
    let tension = |stress: &[f64; 6], n: Vector3| {
        let [xx, yy, zz, xy, yz, zx] = *stress;
        let full = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        n.dot(&(full * n))
    };
    let n = Vector3::new(0.2, 0.9, -0.4);
    let old = tension(&before.forming.stress(0).points[3].stress, n);
    let new = tension(&shell.points[2].stress, motion.rotation * n);
    assert!((old - new).abs() < 1e-12);
    assert_eq!(after.forming.others, before.forming.others);
}

#[test]
fn a_mirror_carried_out_twice_is_none() {
    let (before, motion) = (model(), mirror());
    let back = moved(&moved(&before, &motion, 2.0), &motion.inverse(), 0.5);
    assert_eq!(back.shells, before.shells);
    assert_eq!(back.solids, before.solids);
    assert_eq!(back.mid_side, before.mid_side);
    assert_eq!(back.shell_extras, before.shell_extras);
    assert_eq!(back.parts, before.parts);
    let (back, before) = (back.forming.stress(0), before.forming.stress(0));
    assert_eq!(back.history, before.history);
}
