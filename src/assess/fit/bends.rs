//! What springback does to a sheet: smooth bends and a twist that keep lengths, and the camber of a slender part.

use nalgebra::{SMatrix, SVector};

use crate::assess::contact::Contacts;
use crate::assess::small_motion::Six;
use crate::geometry::{Matrix3, Point3, Similarity, Vector3};
use crate::registration::Surface;

/// Number of bends.
pub(in crate::assess) const N_BENDS: usize = 9;

/// A part is slender if it is so many times as long as wide. Only such a part bends within its plane: the strain of
/// its sides grows with its width, that of a wide part would be plastic.
const SLENDER: f64 = 3.0;
/// Normals of a sheet that faces no way cancel each other: a part faces an axis whose share of the mean normal is at
/// least this …
const LEAST_FACING: f64 = 0.3;
/// … and so many times that of its shortest one.
const MORE_FACING: f64 = 2.0;

/// Deflections w(x, y) out of the part's plane of second and third order, with the displacements in the
/// plane that keep lengths (Kirchhoff's plate), and for a slender part deflections v(x) within the plane, under which
/// its sections stay plane (Bernoulli's beam): what springback does.
pub(in crate::assess) struct Bends {
    pub(in crate::assess) center: Point3,
    /// Principal axes of the source in the target's frame.
    pub(in crate::assess) axes: Matrix3,
    /// How far the places reach along them.
    pub(in crate::assess) half: [f64; 3],
}

impl Bends {
    /// Bends of the source under a pose, over the places where it meets the target.
    pub(in crate::assess) fn of(source: &Surface, pose: &Similarity, contacts: &Contacts) -> Self {
        let axes = pose.rotation * axes_of_plate(source);
        let center = contacts.center;
        let mut half = [f64::MIN_POSITIVE; 3];
        for contact in &contacts.list {
            let arm = contact.point - center;
            for (k, half) in half.iter_mut().enumerate() {
                *half = half.max(axes.column(k).dot(&arm).abs());
            }
        }
        Self { center, axes, half }
    }

    /// The rigid motion in each of the bends, of size 1 at the border, in least squares over the area. O(places).
    pub(super) fn rigid_parts(&self, contacts: &Contacts) -> SMatrix<f64, 6, N_BENDS> {
        let (mut inertia, mut total) = (Matrix3::zeros(), 0.0);
        let (mut moments, mut sums) = ([Vector3::zeros(); N_BENDS], [Vector3::zeros(); N_BENDS]);
        for contact in &contacts.list {
            let arm = (contact.point - contacts.center) / contacts.radius;
            let weight = contact.weight;
            inertia += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * weight;
            total += weight;
            let of_each = self.displacements(&contact.point);
            for ((by, moment), sum) in of_each.iter().zip(&mut moments).zip(&mut sums) {
                let moved = self.axes * by * weight;
                *moment += arm.cross(&moved);
                *sum += moved;
            }
        }
        let inverse = inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        let of_each = moments.iter().zip(&sums).map(|(moment, sum)| {
            let (turn, shift) = (inverse * moment, sum / total);
            Six::from([turn.x, turn.y, turn.z, shift.x, shift.y, shift.z])
        });
        SMatrix::from_columns(&of_each.collect::<Vec<Six>>())
    }

    /// How much each of the bends, of size 1 at the border, moves a place along a direction.
    pub(in crate::assess) fn row(
        &self,
        point: &Point3,
        direction: &Vector3,
    ) -> SVector<f64, N_BENDS> {
        let direction = self.axes.transpose() * direction;
        SVector::from(self.displacements(point).map(|by| by.dot(&direction)))
    }

    /// How each of the bends, of size 1 at the border, displaces a place, along the axes.
    fn displacements(&self, point: &Point3) -> [Vector3; N_BENDS] {
        let arm = self.axes.transpose() * (point - self.center);
        let (x, y) = (arm.x / self.half[0], arm.y / self.half[1]);
        // Deflection, slope along x, slope along y.
        let out_of_plane = [
            [x * x, 2.0 * x, 0.0],
            [x * y, y, x],
            [y * y, 0.0, 2.0 * y],
            [x * x * x, 3.0 * x * x, 0.0],
            [x * x * y, 2.0 * x * y, x * x],
            [x * y * y, y * y, 2.0 * x * y],
            [y * y * y, 0.0, 3.0 * y * y],
        ];
        let within_plane = [[x * x, 2.0 * x], [x * x * x, 3.0 * x * x]];
        let mut bends = [Vector3::zeros(); N_BENDS];
        let (plates, beams) = bends.split_at_mut(out_of_plane.len());
        for (bend, [deflection, along_x, along_y]) in plates.iter_mut().zip(out_of_plane) {
            let [in_x, in_y] = [along_x / self.half[0], along_y / self.half[1]];
            *bend = Vector3::new(-arm.z * in_x, -arm.z * in_y, deflection);
        }
        if self.half[0] >= SLENDER * self.half[1] {
            for (bend, [deflection, along_x]) in beams.iter_mut().zip(within_plane) {
                *bend = Vector3::new(-arm.y * along_x / self.half[0], deflection, 0.0);
            }
        }
        bends
    }
}

/// The axes of a part as a plate, the one across it last: the principal axis that most of the sheet faces, which
/// is the shortest one of any but a deep part. A slender part bends both ways. Right-handed, as the principal axes are.
fn axes_of_plate(source: &Surface) -> Matrix3 {
    let measures = source.measures();
    let (axes, spread) = (measures.principal_axes, measures.principal_spread);
    if spread[0] >= SLENDER * spread[1] {
        return axes;
    }
    let faces = |k: usize| axes.column(k).dot(&measures.mean_normal).abs();
    let is_across = |k: usize| faces(k) >= LEAST_FACING && faces(k) > MORE_FACING * faces(2);
    let [first, second, third] = [0, 1, 2].map(|k| axes.column(k).into_owned());
    if is_across(1) {
        Matrix3::from_columns(&[first, -third, second])
    } else if is_across(0) {
        Matrix3::from_columns(&[second, third, first])
    } else {
        axes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    #[test]
    fn only_a_slender_part_bends_within_its_plane() {
        let within_plane = |width: f64| {
            let bends = Bends {
                center: Point3::origin(),
                axes: Matrix3::identity(),
                half: [400.0, width, 30.0],
            };
            let row = bends.row(&Point3::new(400.0, 0.0, 0.0), &Vector3::y());
            [row[N_BENDS - 2], row[N_BENDS - 1]]
        };
        assert_eq!(within_plane(100.0), [1.0, 1.0]);
        assert_eq!(within_plane(200.0), [0.0, 0.0]);
    }

    #[test]
    fn a_deep_arch_bends_across_the_way_it_faces() {
        // Half an ellipse of 200 mm width, 100 or 260 mm high, along x.
        let arch = |length: f64, height: f64| {
            let points = (0..=20).flat_map(|i| (0..=40).map(move |j| (f64::from(i), f64::from(j))));
            let points = points.map(|(i, j)| {
                let angle = std::f64::consts::PI * j / 40.0;
                let (x, y) = (length * i / 20.0, 100.0 * angle.cos());
                Point3::new(x, y, height * angle.sin())
            });
            let cells = (0..20).flat_map(|i| (0..40).map(move |j| 41 * i + j));
            let triangles = cells.flat_map(|a| [[a, a + 41, a + 42], [a, a + 42, a + 1]]);
            let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
            axes_of_plate(&Surface::new(&mesh, "source").unwrap())
        };
        for (length, height) in [(300.0, 100.0), (300.0, 260.0), (120.0, 260.0)] {
            let axes = arch(length, height);
            assert!(axes[(2, 2)].abs() > 0.99, "{length}, {height}: {axes}");
            assert!((axes.determinant() - 1.0).abs() < 1e-9);
        }
    }
}
