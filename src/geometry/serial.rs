//! How poses and numbers are stored as text: to the last bit, and so that a person can read them.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::similarity::{NEARLY_ORTHONORMAL, off_orthonormal};
use super::{Camera, Matrix3, Point3, Projection, Rotation, Similarity, Vector3};

/// A motion as it is stored.
#[derive(Serialize, Deserialize)]
struct StoredSimilarity {
    /// R, row by row.
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    scale: f64,
}

impl Serialize for Similarity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |row: usize| std::array::from_fn(|column| self.rotation[(row, column)]);
        let stored = StoredSimilarity {
            rotation: std::array::from_fn(row),
            translation: self.translation.into(),
            scale: self.scale,
        };
        stored.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Similarity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stored = StoredSimilarity::deserialize(deserializer)?;
        let rotation = Matrix3::from_fn(|row, column| stored.rotation[row][column]);
        // No rounding is repaired here: the pose is what was stored, to the last bit.
        let is_rotation = off_orthonormal(&rotation) < NEARLY_ORTHONORMAL;
        let is_motion = is_rotation && stored.scale.is_finite() && stored.scale > 0.0;
        if !is_motion {
            return Err(serde::de::Error::custom(
                "the pose is no rotation and scale",
            ));
        }
        Ok(Self {
            rotation,
            translation: Vector3::from(stored.translation),
            scale: stored.scale,
        })
    }
}

/// A camera as it is stored.
#[derive(Serialize, Deserialize)]
struct StoredCamera {
    target: [f64; 3],
    /// Unit quaternion w, x, y, z from view to world.
    orientation: [f64; 4],
    height: f64,
    /// Angle from bottom to top in radians; absent for parallel rays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov_y: Option<f64>,
}

impl Serialize for Camera {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let q = self.world_from_view.quaternion();
        let stored = StoredCamera {
            target: self.target.coords.into(),
            orientation: [q.w, q.i, q.j, q.k],
            height: self.height,
            fov_y: match self.projection {
                Projection::Orthographic => None,
                Projection::Perspective { fov_y } => Some(fov_y),
            },
        };
        stored.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Camera {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stored = StoredCamera::deserialize(deserializer)?;
        let [w, i, j, k] = stored.orientation;
        let quaternion = nalgebra::Quaternion::new(w, i, j, k);
        let is_camera = (quaternion.norm() - 1.0).abs() < 1e-6
            && stored.height.is_finite()
            && stored.height > 0.0
            && stored
                .fov_y
                .is_none_or(|angle| (0.01..3.0).contains(&angle));
        if !is_camera {
            return Err(serde::de::Error::custom("the camera looks nowhere"));
        }
        Ok(Self {
            target: Point3::from(stored.target),
            world_from_view: Rotation::new_unchecked(quaternion),
            height: stored.height,
            projection: match stored.fov_y {
                None => Projection::Orthographic,
                Some(fov_y) => Projection::Perspective { fov_y },
            },
        })
    }
}

/// For fields that may be infinite or no number, which JSON cannot hold: these become words.
pub mod any_float {
    use super::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Stored {
        Number(f64),
        Word(String),
    }

    /// Writes a number or a word.
    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() {
            value.serialize(serializer)
        } else {
            value.to_string().serialize(serializer)
        }
    }

    /// Reads what [`serialize`] wrote.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        match Stored::deserialize(deserializer)? {
            Stored::Number(value) => Ok(value),
            Stored::Word(word) => word.parse().map_err(serde::de::Error::custom),
        }
    }
}

/// [`any_float`] for fields that may be missing.
pub mod any_float_or_none {
    use super::{Deserialize, Deserializer, Serialize, Serializer, any_float};

    #[derive(Serialize, Deserialize)]
    struct Stored(#[serde(with = "any_float")] f64);

    /// Writes a number, a word, or nothing.
    pub fn serialize<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
        value.map(Stored).serialize(serializer)
    }

    /// Reads what [`serialize`] wrote.
    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<f64>, D::Error> {
        let stored = Option::<Stored>::deserialize(deserializer)?;
        Ok(stored.map(|stored| stored.0))
    }
}

/// For points and vectors: x, y, z.
pub mod xyz {
    use super::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes three numbers.
    pub fn serialize<S: Serializer, T: Clone + Into<[f64; 3]>>(
        value: &T,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let numbers: [f64; 3] = value.clone().into();
        numbers.serialize(serializer)
    }

    /// Reads three numbers.
    pub fn deserialize<'de, D: Deserializer<'de>, T: From<[f64; 3]>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        <[f64; 3]>::deserialize(deserializer).map(T::from)
    }
}

/// For values that are shared in memory and stored like any other.
pub mod shared {
    use super::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::Arc;

    /// Writes the value.
    pub fn serialize<S: Serializer, T: Serialize>(
        value: &Arc<T>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        T::serialize(value, serializer)
    }

    /// Reads a value of its own.
    pub fn deserialize<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
        deserializer: D,
    ) -> Result<Arc<T>, D::Error> {
        T::deserialize(deserializer).map(Arc::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::camera::StandardView;

    fn again<T: Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
        let text = serde_json::to_string_pretty(value).unwrap();
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn poses_and_cameras_come_back_to_the_last_bit() {
        for n in 0..200_i32 {
            let x = f64::from(n) * 0.1 + 1.0 / 3.0;
            let turn = Rotation::from_euler_angles(x, x * 1.7, -x * 0.3);
            let pose = Similarity {
                rotation: *turn.to_rotation_matrix().matrix(),
                translation: Vector3::new(x.exp(), -1e-9 * x, 5e3 / x),
                scale: 1.0 + x * 1e-3,
            };
            let read = again(&pose);
            let bits = |pose: &Similarity| {
                let numbers = pose.rotation.iter().chain(pose.translation.iter());
                let bits: Vec<u64> = numbers.map(|v| v.to_bits()).collect();
                (bits, pose.scale.to_bits())
            };
            assert_eq!(bits(&read), bits(&pose));
            let camera = Camera {
                target: Point3::new(x, 1.0 / x, -x),
                world_from_view: turn * StandardView::Top.world_from_view(),
                height: x,
                projection: Projection::perspective(),
            };
            assert_eq!(again(&camera), camera);
        }
        assert_eq!(again(&Camera::default()), Camera::default());
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let text = r#"{"rotation":[[1,0,0],[0,1,0],[0,0,0]],"translation":[0,0,0],"scale":1}"#;
        let read: Result<Similarity, _> = serde_json::from_str(text);
        assert!(read.unwrap_err().to_string().contains("no rotation"));
        let text = r#"{"target":[0,0,0],"orientation":[0,0,0,0],"height":1}"#;
        assert!(serde_json::from_str::<Camera>(text).is_err());
    }

    #[test]
    fn numbers_without_end_are_words() {
        #[derive(Debug, Serialize, Deserialize)]
        struct Score(#[serde(with = "any_float")] f64);
        #[derive(Debug, Serialize, Deserialize)]
        struct Maybe(#[serde(with = "any_float_or_none")] Option<f64>);
        for value in [0.1, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -0.0] {
            assert_eq!(again(&Score(value)).0.to_bits(), value.to_bits());
        }
        for value in [None, Some(0.1), Some(f64::INFINITY)] {
            assert_eq!(again(&Maybe(value)).0, value);
        }
    }
}
