//! What real pairs differ by, as functions on meshes: noise, springback, offsets, trims, normals,
//! further sheets. Every function gives the same mesh for the same seed.

use std::collections::HashMap;

use nalgebra::SymmetricEigen;

use super::random::Random;
use crate::geometry::{Matrix3, Point3, TriMesh, Vector3};

/// Every node moved along its normal by a normally distributed distance with deviation `deviation`.
pub fn noisy(mesh: &TriMesh, deviation: f64, seed: u64) -> TriMesh {
    let mut random = Random::new(seed);
    let normals = mesh.vertex_normals();
    let moved = mesh.positions().iter().zip(&normals);
    let moved = moved.map(|(p, normal)| p + normal * (deviation * random.normal()));
    with_positions(mesh, moved.collect())
}

/// Every node moved along its normal by `distance`.
pub fn offset(mesh: &TriMesh, distance: f64) -> TriMesh {
    let normals = mesh.vertex_normals();
    let moved = mesh.positions().iter().zip(&normals);
    with_positions(
        mesh,
        moved.map(|(p, normal)| p + normal * distance).collect(),
    )
}

/// Bent and twisted as by springback: low-order deflections out of the part's plane that keep lengths
/// (Kirchhoff's plate). No rigid motion is left in the displacements, whose largest is `largest`.
pub fn sprung(mesh: &TriMesh, largest: f64, seed: u64) -> TriMesh {
    let mut random = Random::new(seed);
    let frame = Frame::of(mesh);
    let half = frame.half_extents(mesh);
    let [bend_x, bend_y, twist, third] = [1.0, 0.4, 0.8, 0.3].map(|size| size * random.signed());
    let shift = |p: &Point3| {
        let [a, b, c] = frame.local(p);
        let (x, y) = (a / half[0], b / half[1]);
        let deflection = bend_x * x * x + bend_y * y * y + twist * x * y + third * x * x * x;
        let slope_x = (2.0 * bend_x * x + twist * y + 3.0 * third * x * x) / half[0];
        let slope_y = (2.0 * bend_y * y + twist * x) / half[1];
        frame.axes * Vector3::new(-c * slope_x, -c * slope_y, deflection)
    };
    let mut shifts: Vec<Vector3> = mesh.positions().iter().map(shift).collect();
    take_out_rigid_motion(mesh, &mut shifts);
    let most = shifts.iter().map(Vector3::norm).fold(0.0, f64::max);
    let factor = if most > 0.0 { largest / most } else { 0.0 };
    let moved = mesh.positions().iter().zip(&shifts);
    with_positions(mesh, moved.map(|(p, shift)| p + shift * factor).collect())
}

/// The piece on one side of a plane across the part, with `share` of the area.
pub fn cut(mesh: &TriMesh, share: f64, seed: u64) -> TriMesh {
    let (direction, along) = cutting_direction(mesh, seed);
    let limit = level(mesh, &along, share);
    clipped(mesh, |p| p.coords.dot(&direction) - limit)
}

/// `n` strips across the part are missing, together about `share` of its area.
pub fn without_strips(mesh: &TriMesh, n: usize, share: f64, seed: u64) -> TriMesh {
    let (direction, along) = cutting_direction(mesh, seed);
    let mut left = TriMesh::default();
    let pieces = n + 1;
    let kept = (1.0 - share) / pieces as f64;
    let gap = share / n.max(1) as f64;
    for piece in 0..pieces {
        let from = piece as f64 * (kept + gap);
        let low = level(mesh, &along, from);
        let high = level(mesh, &along, from + kept);
        let is_last = piece == n;
        let upper = if is_last {
            mesh.clone()
        } else {
            clipped(mesh, |p| p.coords.dot(&direction) - high)
        };
        let band = if piece == 0 {
            upper
        } else {
            clipped(&upper, |p| low - p.coords.dot(&direction))
        };
        left = joined(&left, &band);
    }
    left
}

/// Each triangle turned to the other side with probability `share`.
pub fn mixed_normals(mesh: &TriMesh, share: f64, seed: u64) -> TriMesh {
    let mut random = Random::new(seed);
    let (positions, mut triangles) = mesh.clone().into_parts();
    for corners in &mut triangles {
        if random.unit() < share {
            corners.swap(1, 2);
        }
    }
    TriMesh::new(positions, triangles).expect("the corners are those of a mesh")
}

/// A second sheet `distance` along the normal over a piece with `share` of the area.
pub fn doubled(mesh: &TriMesh, distance: f64, share: f64, seed: u64) -> TriMesh {
    let second = offset(&cut(mesh, share, seed), distance);
    joined(mesh, &second)
}

/// Both meshes as one, not connected.
pub fn joined(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let (mut positions, mut triangles) = a.clone().into_parts();
    let first = positions.len() as u32;
    positions.extend(b.positions());
    triangles.extend(
        b.triangles()
            .iter()
            .map(|corners| corners.map(|v| v + first)),
    );
    TriMesh::new(positions, triangles).expect("the corners are those of two meshes")
}

fn with_positions(mesh: &TriMesh, positions: Vec<Point3>) -> TriMesh {
    TriMesh::new(positions, mesh.triangles().to_vec())
        .expect("finite positions moved by finite distances")
}

/// Principal axes of the area, the longest first.
struct Frame {
    center: Point3,
    axes: Matrix3,
}

impl Frame {
    fn of(mesh: &TriMesh) -> Self {
        let center = mesh.centroid();
        let mut moments = Matrix3::zeros();
        for t in 0..mesh.n_triangles() {
            let [a, b, c] = mesh.corners(t).map(|p| p - center);
            let arm = (a + b + c) / 3.0;
            moments += arm * arm.transpose() * mesh.triangle_area(t);
        }
        let eigen = SymmetricEigen::new(moments);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let first = eigen.eigenvectors.column(order[0]).into_owned();
        let second = eigen.eigenvectors.column(order[1]).into_owned();
        let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
        Self { center, axes }
    }

    fn local(&self, p: &Point3) -> [f64; 3] {
        (self.axes.transpose() * (p - self.center)).into()
    }

    fn half_extents(&self, mesh: &TriMesh) -> [f64; 3] {
        let mut half = [1e-9_f64; 3];
        for p in mesh.positions() {
            for (half, x) in half.iter_mut().zip(self.local(p)) {
                *half = half.max(x.abs());
            }
        }
        half
    }
}

/// Takes the best rigid motion, in least squares over the area, out of small displacements.
fn take_out_rigid_motion(mesh: &TriMesh, shifts: &mut [Vector3]) {
    let areas = mesh.vertex_areas();
    let total: f64 = areas.iter().sum();
    if total <= 0.0 {
        return;
    }
    let weighted = |of: &dyn Fn(usize) -> Vector3| {
        let sum: Vector3 = (0..areas.len()).map(|i| of(i) * areas[i]).sum();
        sum / total
    };
    let center = Point3::from(weighted(&|i| mesh.positions()[i].coords));
    let mean = weighted(&|i| shifts[i]);
    let mut inertia = Matrix3::zeros();
    let mut moment = Vector3::zeros();
    for ((p, shift), &area) in mesh.positions().iter().zip(shifts.iter()).zip(&areas) {
        let arm = p - center;
        inertia += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * area;
        moment += arm.cross(shift) * area;
    }
    let turn = inertia
        .try_inverse()
        .map_or(Vector3::zeros(), |inverse| inverse * moment);
    for (shift, p) in shifts.iter_mut().zip(mesh.positions()) {
        *shift -= mean + turn.cross(&(p - center));
    }
}

/// A direction within the part's plane, and where every triangle lies along it, lowest first, with
/// its area.
fn cutting_direction(mesh: &TriMesh, seed: u64) -> (Vector3, Vec<(f64, f64)>) {
    let mut random = Random::new(seed);
    let frame = Frame::of(mesh);
    let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
    let direction = frame.axes * Vector3::new(cos, sin, 0.0);
    let mut along: Vec<(f64, f64)> = (0..mesh.n_triangles())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.coords.dot(&direction));
            ((a + b + c) / 3.0, mesh.triangle_area(t))
        })
        .collect();
    along.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    (direction, along)
}

/// Where `share` of the area lies below.
fn level(mesh: &TriMesh, along: &[(f64, f64)], share: f64) -> f64 {
    let wanted = share * mesh.area();
    let mut below = 0.0;
    let at = along.iter().find(|(_, area)| {
        below += area;
        below >= wanted
    });
    at.or(along.last()).map_or(0.0, |(level, _)| *level)
}

/// The part where `beyond` is not positive. Triangles that cross its zero are cut; edges share the
/// new nodes.
fn clipped(mesh: &TriMesh, beyond: impl Fn(&Point3) -> f64) -> TriMesh {
    let mut positions: Vec<Point3> = Vec::new();
    let mut renumbered: HashMap<u32, u32> = HashMap::new();
    let mut crossings: HashMap<[u32; 2], u32> = HashMap::new();
    let mut triangles = Vec::new();
    let values: Vec<f64> = mesh.positions().iter().map(beyond).collect();
    for corners in mesh.triangles() {
        let mut polygon: Vec<u32> = Vec::with_capacity(4);
        for i in 0..3 {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            let (a, b) = (values[from as usize], values[to as usize]);
            if a <= 0.0 {
                let next = positions.len() as u32;
                let vertex = *renumbered.entry(from).or_insert(next);
                if vertex == next {
                    positions.push(mesh.positions()[from as usize]);
                }
                polygon.push(vertex);
            }
            if (a <= 0.0) != (b <= 0.0) {
                let next = positions.len() as u32;
                let edge = [from.min(to), from.max(to)];
                let vertex = *crossings.entry(edge).or_insert(next);
                if vertex == next {
                    let [low, high] = edge.map(|v| v as usize);
                    let t = values[low] / (values[low] - values[high]);
                    let [p, q] = [low, high].map(|v| mesh.positions()[v]);
                    positions.push(p + (q - p) * t);
                }
                polygon.push(vertex);
            }
        }
        for i in 2..polygon.len() {
            triangles.push([polygon[0], polygon[i - 1], polygon[i]]);
        }
    }
    TriMesh::new(positions, triangles).expect("corners were numbered as they were made")
}

#[cfg(test)]
mod tests {
    use super::super::{SamplePart, SampleSettings, generate};
    use super::*;

    fn bracket() -> TriMesh {
        let settings = SampleSettings {
            part: SamplePart::Bracket,
            ..SampleSettings::default()
        };
        generate(&settings).stamped.to_trimesh()
    }

    #[test]
    fn cuts_keep_their_share_and_stay_on_the_surface() {
        let mesh = bracket();
        for (seed, share) in [(1, 0.6), (2, 0.35), (3, 0.2)] {
            let piece = cut(&mesh, share, seed);
            let kept = piece.area() / mesh.area();
            assert!((kept - share).abs() < 0.01, "{kept} for {share}");
            let again = cut(&mesh, share, seed);
            assert_eq!(piece, again);
        }
        let strips = without_strips(&mesh, 3, 0.3, 4);
        let kept = strips.area() / mesh.area();
        assert!((kept - 0.7).abs() < 0.02, "{kept}");
    }

    #[test]
    fn springback_has_its_size_and_no_rigid_motion() {
        let mesh = bracket();
        let bent = sprung(&mesh, 3.0, 9);
        let mut shifts: Vec<Vector3> = bent
            .positions()
            .iter()
            .zip(mesh.positions())
            .map(|(a, b)| a - b)
            .collect();
        let largest = shifts.iter().map(Vector3::norm).fold(0.0, f64::max);
        assert!((largest - 3.0).abs() < 1e-9, "{largest}");
        let before = shifts.clone();
        take_out_rigid_motion(&mesh, &mut shifts);
        let change = shifts.iter().zip(&before).map(|(a, b)| (a - b).norm());
        assert!(change.fold(0.0, f64::max) < 1e-9);
        // Lengths stay: the area changes by less than the bending of the corners explains.
        assert!((bent.area() / mesh.area() - 1.0).abs() < 0.01);
    }

    #[test]
    fn noise_lies_along_the_normals_with_its_deviation() {
        let mesh = bracket();
        let rough = noisy(&mesh, 0.3, 2);
        let normals = mesh.vertex_normals();
        let mut square = 0.0;
        for ((a, b), normal) in rough.positions().iter().zip(mesh.positions()).zip(&normals) {
            let shift = a - b;
            assert!((shift - normal * shift.dot(normal)).norm() < 1e-12);
            square += shift.norm_squared();
        }
        let deviation = (square / normals.len() as f64).sqrt();
        assert!((deviation - 0.3).abs() < 0.02, "{deviation}");
    }

    #[test]
    fn second_sheets_and_turned_triangles_add_up() {
        let mesh = bracket();
        let doubled = doubled(&mesh, 2.0, 0.4, 5);
        assert!((doubled.area() / mesh.area() - 1.4).abs() < 0.05);
        let mixed = mixed_normals(&mesh, 0.3, 6);
        let pairs = mixed.triangles().iter().zip(mesh.triangles());
        let turned = pairs.filter(|(a, b)| a != b).count();
        let share = turned as f64 / mesh.n_triangles() as f64;
        assert!((share - 0.3).abs() < 0.05, "{share}");
    }
}
