//! Round holes of parts whose outlines are ragged.

use std::collections::HashMap;

use shapematch::assess::*;
use shapematch::geometry::{Point3, TriMesh, Vector3};

use super::assess::judge;
use super::drawn_pan::{pan, placement};

/// Middle of the hole.
const AT: [f64; 2] = [20.0, 5.0];

fn from_middle(p: &Point3) -> Vector3 {
    Vector3::new(p.x - AT[0], p.y - AT[1], 0.0)
}

/// A pan with steps of an element for an outline, and a hole of this radius whose nodes lie on its circle.
fn pierced(pitch: f64, turn: f64, radius: f64) -> TriMesh {
    let is_solid = |x: f64, y: f64| (x - AT[0]).hypot(y - AT[1]) > radius;
    let mesh = pan(pitch, turn, is_solid);
    let mut n_sides: HashMap<[u32; 2], u32> = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *n_sides.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let mut positions = mesh.positions().to_vec();
    let borders = n_sides.into_iter().filter(|(_, n)| *n == 1);
    for vertex in borders.flat_map(|(edge, _)| edge) {
        let p = &mut positions[vertex as usize];
        let arm = from_middle(p);
        if arm.norm() < radius + 3.0 * pitch {
            *p += arm * (radius / arm.norm() - 1.0);
        }
    }
    TriMesh::new(positions, mesh.triangles().to_vec()).unwrap()
}

fn judged(stamped: &TriMesh, crash: &TriMesh) -> Assessment {
    let stamped = stamped.transformed(&placement(9).inverse());
    judge(&stamped, crash).1
}

#[test]
fn a_round_hole_that_is_wider_is_told_however_ragged_the_outlines_are() {
    let crash = pierced(7.0, 0.35, 22.0);
    let same = judged(&pierced(6.0, 0.1, 22.0), &crash);
    assert_eq!(same.verdict, Verdict::Good, "{:?}", same.reasons);
    let wider = judged(&pierced(6.0, 0.1, 25.0), &crash);
    let hole = wider.reasons.iter().find_map(|reason| match reason {
        Reason::Shape {
            difference: ShapeReason::Hole { by, limit, .. },
        } => Some((*by, *limit)),
        _ => None,
    });
    let (by, limit) = hole.unwrap_or_else(|| panic!("{:?}", wider.reasons));
    assert!((by - 3.0).abs() < 0.8 && limit < 1.5, "{by} {limit}");
}
