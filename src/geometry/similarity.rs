//! Rotation, translation and scale, with or without a mirror.

use super::{Matrix3, Matrix4, Point3, Pose, Vector3};

/// Largest entry of |RᵀR − I| of a rotation that is stored and read again.
pub(super) const NEARLY_ORTHONORMAL: f64 = 1e-6;
/// A scale is the rounding of a matrix up to so many times what it leaves of its columns' being alike.
const ROUNDING_OF_SCALE: f64 = 10.0;

/// Why a 4×4 matrix is not a similarity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MatrixError {
    /// An entry is NaN or infinite.
    #[error("the matrix holds an entry that is not a finite number")]
    NotFinite,
    /// The last row is not 0 0 0 1; a column-ordered matrix looks like this too.
    #[error("the last row is not 0 0 0 1 (is the matrix written column by column?)")]
    LastRow,
    /// The 3×3 block is not scale times an orthogonal matrix.
    #[error("the 3×3 block is not a rotation times a scale (largest deviation {deviation:.2e})")]
    NotOrthogonal {
        /// Largest entry of |AᵀA/c² − I|.
        deviation: f64,
    },
}

/// `target = scale · rotation · source + translation`, the product of a match.
///
/// `rotation` is orthogonal; its determinant is +1, or −1 when the source had to be mirrored
/// (left-hand against right-hand part). `scale` is positive and 1 unless a similarity was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Orthogonal 3×3 matrix R.
    pub rotation: Matrix3,
    /// Translation t, in target length units.
    pub translation: Vector3,
    /// Scale c > 0.
    pub scale: f64,
}

impl Default for Similarity {
    fn default() -> Self {
        Self::identity()
    }
}

impl From<Pose> for Similarity {
    fn from(pose: Pose) -> Self {
        Self {
            rotation: *pose.rotation.to_rotation_matrix().matrix(),
            translation: pose.translation.vector,
            scale: 1.0,
        }
    }
}

impl Similarity {
    /// No motion.
    pub fn identity() -> Self {
        Self {
            rotation: Matrix3::identity(),
            translation: Vector3::zeros(),
            scale: 1.0,
        }
    }

    /// The mirror x → −x.
    pub fn mirror_x() -> Self {
        Self::mirror(0)
    }

    /// The mirror that turns the sign of a coordinate: 0 for x, 1 for y, 2 for z.
    pub fn mirror(axis: usize) -> Self {
        let mut rotation = Matrix3::identity();
        rotation[(axis, axis)] = -1.0;
        Self {
            rotation,
            ..Self::identity()
        }
    }

    /// Scaling about the origin.
    pub fn from_scale(scale: f64) -> Self {
        Self {
            scale,
            ..Self::identity()
        }
    }

    /// A shift.
    pub fn from_translation(translation: Vector3) -> Self {
        Self {
            translation,
            ..Self::identity()
        }
    }

    /// A rotation or mirror (an orthogonal matrix) about a point, which stays.
    pub fn about(center: &Point3, rotation: Matrix3) -> Self {
        Self {
            rotation,
            ..Self::identity()
        }
        .taking(center, center)
    }

    /// The same rotation and scale with the translation that takes `from` to `to`.
    #[must_use]
    pub fn taking(self, from: &Point3, to: &Point3) -> Self {
        Self {
            translation: to.coords - self.rotation * from.coords * self.scale,
            ..self
        }
    }

    /// Moves a point.
    pub fn apply(&self, point: &Point3) -> Point3 {
        Point3::from(self.rotation * point.coords * self.scale + self.translation)
    }

    /// Turns a direction: rotation (and mirror) only, lengths stay.
    pub fn rotate(&self, direction: &Vector3) -> Vector3 {
        self.rotation * direction
    }

    /// True if the motion exchanges left and right hand.
    pub fn is_mirrored(&self) -> bool {
        self.rotation.determinant() < 0.0
    }

    /// `self ∘ other`: first `other`, then `self`.
    pub fn after(&self, other: &Self) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.rotation * other.translation * self.scale + self.translation,
            scale: self.scale * other.scale,
        }
    }

    /// The motion back.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        let scale = 1.0 / self.scale;
        Self {
            rotation,
            translation: -(rotation * self.translation) * scale,
            scale,
        }
    }

    /// 4×4 matrix for column vectors, scale included.
    pub fn to_matrix4(&self) -> Matrix4 {
        let mut matrix = Matrix4::identity();
        matrix
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(self.rotation * self.scale));
        matrix
            .fixed_view_mut::<3, 1>(0, 3)
            .copy_from(&self.translation);
        matrix
    }

    /// The 4×4 matrix as rows.
    pub fn to_rows(&self) -> [[f64; 4]; 4] {
        let m = self.to_matrix4();
        std::array::from_fn(|row| std::array::from_fn(|col| m[(row, col)]))
    }

    /// Reads a 4×4 matrix for column vectors; `tolerance` bounds the entries of |AᵀA/c² − I|.
    /// The 3×3 block is kept as given, divided by its scale, unless it was written with few digits: then the rotation
    /// is the nearest one, and a scale that these digits do not tell from 1 is 1.
    pub fn from_matrix4(matrix: &Matrix4, tolerance: f64) -> Result<Self, MatrixError> {
        if !matrix.iter().all(|x| x.is_finite()) {
            return Err(MatrixError::NotFinite);
        }
        let last = matrix.row(3);
        if last[0] != 0.0 || last[1] != 0.0 || last[2] != 0.0 || last[3] != 1.0 {
            return Err(MatrixError::LastRow);
        }
        let block: Matrix3 = matrix.fixed_view::<3, 3>(0, 0).into();
        let gram = block.transpose() * block;
        let scale_sq = gram.trace() / 3.0;
        if scale_sq <= 0.0 {
            return Err(MatrixError::NotOrthogonal { deviation: 1.0 });
        }
        let deviation = (gram / scale_sq - Matrix3::identity()).amax();
        if deviation > tolerance {
            return Err(MatrixError::NotOrthogonal { deviation });
        }
        // A rigid matrix stays bit-identical when it is copied and pasted.
        let rounding = (ROUNDING_OF_SCALE * deviation).max(tolerance.min(1e-6));
        let scale = if (scale_sq - 1.0).abs() <= rounding {
            1.0
        } else {
            scale_sq.sqrt()
        };
        let mut rotation = block / scale;
        if off_orthonormal(&rotation) >= 0.1 * NEARLY_ORTHONORMAL {
            rotation = nearest_orthonormal(rotation);
        }
        let translation = matrix.fixed_view::<3, 1>(0, 3).into();
        Ok(Self {
            rotation,
            translation,
            scale,
        })
    }

    /// Rotation angle of `self⁻¹ ∘ other` in radians, mirror ignored; exact down to 1e-16.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let relative = self.rotation.transpose() * other.rotation;
        let skew = Vector3::new(
            relative[(2, 1)] - relative[(1, 2)],
            relative[(0, 2)] - relative[(2, 0)],
            relative[(1, 0)] - relative[(0, 1)],
        );
        skew.norm().atan2(relative.trace() - 1.0)
    }

    /// Largest distance between the images of `points` under both motions.
    pub fn max_displacement<'a>(
        &self,
        other: &Self,
        points: impl IntoIterator<Item = &'a Point3>,
    ) -> f64 {
        points
            .into_iter()
            .map(|p| (self.apply(p) - other.apply(p)).norm())
            .fold(0.0, f64::max)
    }
}

/// Largest entry of |RᵀR − I|.
pub(super) fn off_orthonormal(rotation: &Matrix3) -> f64 {
    (rotation.transpose() * rotation - Matrix3::identity()).amax()
}

/// The orthonormal matrix nearest to one, of the same hand.
fn nearest_orthonormal(matrix: Matrix3) -> Matrix3 {
    let svd = matrix.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) => u * v_t,
        _ => matrix,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Similarity {
        let pose = Pose::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, 0.2, -0.9));
        Similarity {
            scale: 25.4,
            ..pose.into()
        }
    }

    #[test]
    fn inverse_and_composition_undo() {
        let both = sample().inverse().after(&sample());
        assert!((both.to_matrix4() - Matrix4::identity()).amax() < 1e-12);
        let p = Point3::new(4.0, 5.0, 6.0);
        assert!((sample().inverse().apply(&sample().apply(&p)) - p).norm() < 1e-12);
    }

    #[test]
    fn matrix_round_trip() {
        let back = Similarity::from_matrix4(&sample().to_matrix4(), 1e-9).unwrap();
        assert!((back.to_matrix4() - sample().to_matrix4()).amax() < 1e-12);
        let mirror = Similarity::mirror_x();
        assert!(
            Similarity::from_matrix4(&mirror.to_matrix4(), 1e-9)
                .unwrap()
                .is_mirrored()
        );
    }

    /// What is pasted is stored in projects and written into cards that hold no scale.
    #[test]
    fn a_matrix_of_few_digits_is_the_nearest_rotation() {
        let turned = Pose::rotation(Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_4));
        for motion in [sample(), turned.into(), Similarity::mirror_x()] {
            for digits in [1e5, 1e6, 1e7] {
                let rigid = Similarity {
                    scale: 1.0,
                    ..motion
                };
                let written = rigid.to_matrix4().map(|x| (x * digits).round() / digits);
                let read = Similarity::from_matrix4(&written, 1e-4).unwrap();
                assert_eq!(read.scale, 1.0);
                assert_eq!(read.is_mirrored(), motion.is_mirrored());
                assert!((read.rotation - motion.rotation).amax() < 2.0 / digits);
                let stored = serde_json::to_string(&read).unwrap();
                assert_eq!(serde_json::from_str::<Similarity>(&stored).unwrap(), read);
            }
        }
        // All digits are kept, and a scale that they tell from 1 too.
        let scaled = Similarity {
            scale: 1.000_02,
            ..sample()
        };
        let read = Similarity::from_matrix4(&scaled.to_matrix4(), 1e-4).unwrap();
        assert!((read.scale - scaled.scale).abs() < 1e-14);
        let rigid = Similarity::from(turned).to_matrix4();
        assert_eq!(
            Similarity::from_matrix4(&rigid, 1e-4).unwrap().to_matrix4(),
            rigid
        );
    }

    #[test]
    fn says_what_is_wrong_with_a_matrix() {
        let transposed = sample().to_matrix4().transpose();
        assert_eq!(
            Similarity::from_matrix4(&transposed, 1e-9),
            Err(MatrixError::LastRow)
        );
        let mut sheared = sample().to_matrix4();
        sheared[(0, 1)] += 1.0;
        assert!(matches!(
            Similarity::from_matrix4(&sheared, 1e-9),
            Err(MatrixError::NotOrthogonal { .. })
        ));
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let turned = Similarity::from(Pose::rotation(Vector3::new(0.0, 0.0, 1e-11)));
        let angle = Similarity::identity().angle_to(&turned);
        assert!((angle - 1e-11).abs() < 1e-20, "{angle:e}");
    }
}
