//! Points, boxes, triangle meshes, their topology, and poses. Everything is `f64`.

mod aabb;
mod border_edges;
mod borders;
pub mod camera;
pub(crate) mod chunks;
mod clean;
pub(crate) mod cracks;
mod groups;
mod landmarks;
mod merged;
mod mesh;
mod normals;
pub mod section;
pub mod serial;
mod similarity;
pub mod tensor;
mod topology;
mod weld;
mod z_order;

pub use aabb::Aabb;
pub use border_edges::{BorderEdge, BorderEdges, BorderLoop};
pub use borders::{Border, Circle};
pub use camera::{Camera, Projection};
pub use clean::CleanMesh;
pub use landmarks::{Landmarks, RoundHole};
pub use merged::MergedMesh;
pub use mesh::{MeshError, TriMesh};
pub use normals::{CornerNormals, VertexFans, corner_normals, face_normals};
pub use section::{
    Gap, OutlineGap, OutlineGaps, Plane, SectionLine, gap_at, gap_to_nearest, nearest_on_lines,
    outline_gaps, section,
};
pub use similarity::{MatrixError, Similarity};
pub use topology::{Topology, orient_consistently};
pub use weld::{Welded, first_at_place, weld};
pub use z_order::{z_order, z_order_for};

/// A position in space.
pub type Point3 = nalgebra::Point3<f64>;
/// A displacement or a direction.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3×3 matrix, for example a rotation.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A 4×4 matrix acting on column vectors.
pub type Matrix4 = nalgebra::Matrix4<f64>;
/// A rigid motion `target_from_source`: rotation (unit quaternion), then translation.
pub type Pose = nalgebra::Isometry3<f64>;
/// A rotation as a unit quaternion.
pub type Rotation = nalgebra::UnitQuaternion<f64>;

/// A right-handed frame whose third axis is a unit vector and whose first one points as far as it may in another
/// direction, or in any if both are parallel.
pub(crate) fn frame_about(z: &Vector3, towards: &Vector3) -> Matrix3 {
    let x = towards - z * towards.dot(z);
    let x = x.try_normalize(1e-6).unwrap_or_else(|| {
        let other = if z.x.abs() < 0.7 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        (other - z * other.dot(z)).normalize()
    });
    Matrix3::from_columns(&[x, z.cross(&x), *z])
}

/// A unit vector perpendicular to a unit vector: across the axis that this is farthest from.
pub(crate) fn any_perpendicular(unit: &Vector3) -> Vector3 {
    let mut axis = Vector3::zeros();
    axis[unit.iamin()] = 1.0;
    unit.cross(&axis).normalize()
}
