//! Means at the nodes and shape functions between them: how most tools interpolate values of elements.

use super::patch::{LEAST_BEND_COS, cos_between};
use super::shells::ShellMesh;
use super::source::{PreparedSource, SourcePoint};
use crate::geometry::Point3;

/// Steps of Newton's method on the bilinear shape functions.
const STEPS: usize = 8;

/// Calls `add` with every element whose value counts at a point of the source, whether its normal is
/// opposite to the target's, and its weight; the weights sum to 1. At each node the elements of one gauge
/// around it count alike.
pub(super) fn around_nodes(
    source: &PreparedSource<'_>,
    at: &SourcePoint,
    mut add: impl FnMut(u32, bool, f64),
) {
    let (mesh, own) = (&source.mesh, at.element as usize);
    let corners = mesh.corner_points(own);
    let weights = shape_functions(mesh, own, &at.point);
    let neighbours = source.neighbours();
    for (corner, weight) in corners.iter().zip(weights) {
        if weight == 0.0 {
            continue;
        }
        let others = neighbours.of(own).iter().copied();
        let around = std::iter::once(at.element)
            .chain(others)
            .filter(|&element| {
                let element = element as usize;
                source.gauge[element] == source.gauge[own]
                    && cos_between(mesh, neighbours, own, element) >= LEAST_BEND_COS
                    && mesh.corner_points(element).contains(corner)
            });
        let around: Vec<u32> = around.collect();
        for &element in &around {
            let is_flipped = at.is_flipped != neighbours.are_opposed(own, element as usize);
            add(element, is_flipped, weight / around.len() as f64);
        }
    }
}

/// Shape functions of an element's corners at the point of it that is closest to `point`: linear in a
/// triangle, bilinear in a quad.
fn shape_functions(mesh: &ShellMesh, element: usize, point: &Point3) -> [f64; 4] {
    let [a, b, c, d] = mesh.corner_points(element);
    if mesh.is_triangle(element) {
        let (ab, ac, ap) = (b - a, c - a, point - a);
        let area = ab.cross(&ac);
        let all = area.norm_squared();
        let v = (ap.cross(&ac).dot(&area) / all).clamp(0.0, 1.0);
        let w = (ab.cross(&ap).dot(&area) / all).clamp(0.0, 1.0 - v);
        return [1.0 - v - w, v, w, 0.0];
    }
    let (mut xi, mut eta) = (0.0_f64, 0.0_f64);
    for _ in 0..STEPS {
        let n = bilinear(xi, eta);
        let here = a.coords * n[0] + b.coords * n[1] + c.coords * n[2] + d.coords * n[3];
        let along = ((b - a) * (1.0 - eta) + (c - d) * (1.0 + eta)) / 4.0;
        let across = ((d - a) * (1.0 - xi) + (c - b) * (1.0 + xi)) / 4.0;
        let miss = point.coords - here;
        // Least squares in the plane of both directions.
        let (aa, ab, bb) = (
            along.norm_squared(),
            along.dot(&across),
            across.norm_squared(),
        );
        let determinant = aa * bb - ab * ab;
        if determinant <= 1e-12 * aa * bb {
            break;
        }
        let (ra, rb) = (along.dot(&miss), across.dot(&miss));
        xi = (xi + (bb * ra - ab * rb) / determinant).clamp(-1.0, 1.0);
        eta = (eta + (aa * rb - ab * ra) / determinant).clamp(-1.0, 1.0);
    }
    bilinear(xi, eta)
}

fn bilinear(xi: f64, eta: f64) -> [f64; 4] {
    [
        (1.0 - xi) * (1.0 - eta) / 4.0,
        (1.0 + xi) * (1.0 - eta) / 4.0,
        (1.0 + xi) * (1.0 + eta) / 4.0,
        (1.0 - xi) * (1.0 + eta) / 4.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;

    #[test]
    fn points_have_the_weights_they_were_made_with() {
        let corners = [
            [0.0, 0.0, 0.0],
            [10.0, 1.0, 0.5],
            [12.0, 9.0, 0.0],
            [-1.0, 8.0, 0.4],
        ];
        let positions: Vec<Point3> = corners.iter().map(|&p| Point3::from(p)).collect();
        let quad = ShellMesh::new(positions.clone(), vec![[0, 1, 2, 3]], vec![0]).unwrap();
        for (xi, eta) in [(0.0, 0.0), (0.3, -0.8), (-1.0, 1.0), (0.9, 0.95)] {
            let expected = bilinear(xi, eta);
            let point = positions.iter().zip(expected).map(|(p, n)| p.coords * n);
            let found = shape_functions(&quad, 0, &Point3::from(point.sum::<Vector3>()));
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
            }
        }
        let triangle = ShellMesh::new(positions.clone(), vec![[0, 1, 2, 2]], vec![0]).unwrap();
        let point =
            positions[0].coords * 0.2 + positions[1].coords * 0.5 + positions[2].coords * 0.3;
        let found = shape_functions(&triangle, 0, &Point3::from(point));
        for (a, b) in found.iter().zip([0.2, 0.5, 0.3, 0.0]) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
    }
}
