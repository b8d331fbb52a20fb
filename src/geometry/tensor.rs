//! Symmetric second-order tensors as decks write them: xx, yy, zz, xy, yz, zx, tensor shear.

use super::{Matrix3, Vector3};

/// Components xx, yy, zz, xy, yz, zx in global axes. Shear components are those of the tensor
/// (ε_xy = γ_xy / 2), so one formula turns stress and strain.
pub type Tensor = [f64; 6];

/// R·σ·Rᵀ. A mirror is as good as a rotation, because the tensor is of second order.
pub fn rotated(tensor: &Tensor, rotation: &Matrix3) -> Tensor {
    components(&(rotation * matrix(tensor) * rotation.transpose()))
}

/// A rotation made ready to turn many tensors, or a mirror.
#[derive(Debug, Clone, Copy)]
pub struct Turn([[f64; 6]; 6]);

impl Turn {
    /// R·σ·Rᵀ is linear in σ: column by column what each component gives to all six.
    pub fn new(rotation: &Matrix3) -> Self {
        const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
        let r = |i: usize, k: usize| rotation[(i, k)];
        let mut columns = [[0.0; 6]; 6];
        for (column, (k, l)) in columns.iter_mut().zip(ENTRIES) {
            for (entry, (i, j)) in column.iter_mut().zip(ENTRIES) {
                *entry = r(i, k) * r(j, l);
                if k != l {
                    *entry += r(i, l) * r(j, k);
                }
            }
        }
        Self(columns)
    }

    /// The tensor in the turned axes: R·σ·Rᵀ.
    #[inline]
    pub fn apply(&self, tensor: &Tensor) -> Tensor {
        let [a, b, c, d, e, f] = &self.0;
        let [xx, yy, zz, xy, yz, zx] = *tensor;
        std::array::from_fn(|i| {
            (a[i] * xx + b[i] * yy + c[i] * zz) + (d[i] * xy + e[i] * yz + f[i] * zx)
        })
    }
}

/// The components of a symmetric matrix.
pub fn components(matrix: &Matrix3) -> Tensor {
    [
        matrix[(0, 0)],
        matrix[(1, 1)],
        matrix[(2, 2)],
        matrix[(0, 1)],
        matrix[(1, 2)],
        matrix[(2, 0)],
    ]
}

/// A tensor as a symmetric matrix.
pub fn matrix(tensor: &Tensor) -> Matrix3 {
    let [xx, yy, zz, xy, yz, zx] = *tensor;
    Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
}

/// Von Mises equivalent of a stress.
pub fn von_mises(stress: &Tensor) -> f64 {
    von_mises_sq(stress).sqrt()
}

/// Square of the von Mises equivalent, for comparisons.
pub fn von_mises_sq(stress: &Tensor) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)
}

/// Principal values, largest first.
pub fn principal(tensor: &Tensor) -> [f64; 3] {
    let mut values: [f64; 3] = matrix(tensor).symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Component along the unit direction `normal`.
pub fn normal_component(tensor: &Tensor, normal: &Vector3) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *tensor;
    let n = normal;
    xx * n.x * n.x
        + yy * n.y * n.y
        + zz * n.z * n.z
        + 2.0 * (xy * n.x * n.y + yz * n.y * n.z + zx * n.z * n.x)
}

/// The smallest rotation that takes the unit vector `from` onto the unit vector `to`: with
/// v = from × to and c = from · to, I + \[v\]ₓ + \[v\]ₓ² / (1 + c). `None` for equal directions (nothing
/// to do) and for opposite ones (no smallest rotation).
pub fn smallest_rotation(from: &Vector3, to: &Vector3) -> Option<Matrix3> {
    let axis = from.cross(to);
    let cos = from.dot(to);
    if axis.norm_squared() < 1e-30 || cos <= -1.0 + 1e-12 {
        return None;
    }
    let [x, y, z] = [axis.x, axis.y, axis.z];
    let h = 1.0 / (1.0 + cos);
    let (xx, yy, zz) = (h * x * x, h * y * y, h * z * z);
    let (xy, yz, zx) = (h * x * y, h * y * z, h * z * x);
    Some(Matrix3::new(
        1.0 - yy - zz,
        xy - z,
        zx + y,
        xy + z,
        1.0 - xx - zz,
        yz - x,
        zx - y,
        yz + x,
        1.0 - xx - yy,
    ))
}

#[cfg(test)]
mod tests {
    use super::super::Rotation;
    use super::*;

    fn sample() -> Tensor {
        [120.0, -35.0, 4.0, 22.0, -7.0, 13.0]
    }

    #[test]
    fn invariants_stay_under_rotation_and_mirror() {
        let turn = Rotation::from_euler_angles(0.3, -1.1, 2.0);
        let turn: Matrix3 = *turn.to_rotation_matrix().matrix();
        let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
        for motion in [turn, turn * mirror] {
            let moved = rotated(&sample(), &motion);
            let trace = |t: &Tensor| t[0] + t[1] + t[2];
            assert!((trace(&moved) - trace(&sample())).abs() < 1e-12 * 120.0);
            assert!((von_mises(&moved) - von_mises(&sample())).abs() < 1e-12 * 120.0);
            for (a, b) in principal(&moved).iter().zip(principal(&sample())) {
                assert!((a - b).abs() < 1e-11 * 120.0);
            }
            for (a, b) in Turn::new(&motion).apply(&sample()).iter().zip(moved) {
                assert!((a - b).abs() < 1e-12 * 120.0);
            }
            let back = rotated(&moved, &motion.transpose());
            for (a, b) in back.iter().zip(sample()) {
                assert!((a - b).abs() < 1e-12 * 120.0);
            }
        }
    }

    #[test]
    fn the_smallest_rotation_takes_one_direction_to_the_other() {
        let from = Vector3::new(1.0, 2.0, -0.5).normalize();
        let to = Vector3::new(0.8, 2.1, -0.9).normalize();
        let rotation = smallest_rotation(&from, &to).unwrap();
        assert!((rotation * from - to).norm() < 1e-15);
        assert!((rotation.determinant() - 1.0).abs() < 1e-14);
        let across = from.cross(&to).normalize();
        assert!((rotation * across - across).norm() < 1e-15);
        assert_eq!(smallest_rotation(&from, &from), None);
        assert_eq!(smallest_rotation(&from, &-from), None);
    }

    #[test]
    fn uniaxial_stress_has_its_known_numbers() {
        let stress = [10.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(von_mises(&stress), 10.0);
        assert_eq!(principal(&stress), [10.0, 0.0, 0.0]);
        assert_eq!(normal_component(&stress, &Vector3::x()), 10.0);
        let pure_shear = [0.0, 0.0, 0.0, 5.0, 0.0, 0.0];
        assert!((von_mises(&pure_shear) - 5.0 * 3.0_f64.sqrt()).abs() < 1e-12);
    }
}
