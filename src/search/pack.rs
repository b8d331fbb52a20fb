//! What the leaves of a [`WideTree`](super::wide::WideTree) hold: four triangles or four points.

use glam::{Vec3A, Vec4};

use super::wide::{FAR_AWAY, Pack, Query, WIDTH};
use crate::geometry::{Vector3, any_perpendicular};

/// Height over longest edge below which the direction of a triangle's normal is left to `f64`.
const NEEDLE: f64 = 1e-6;

/// Four triangles, each in a frame of its own: corner a at the origin, b on the first axis, c in
/// the plane of the first two. a–b is the longest edge, which keeps needles well-conditioned.
///
/// 13 rows of 16 bytes: what a division tells is not stored, because large meshes have a million of these.
#[derive(Debug, Clone)]
pub(super) struct TrianglePack {
    origin: [Vec4; 3],
    first_axis: [Vec4; 3],
    second_axis: [Vec4; 3],
    /// First coordinate of b; its second is zero.
    b: Vec4,
    c: [Vec4; 2],
    ids: [u32; WIDTH],
}

impl TrianglePack {
    /// Cosine between each triangle's normal and `direction`.
    #[inline]
    pub(super) fn normal_cos(&self, direction: &Query) -> Vec4 {
        let [x, y, z] = self.normals();
        x * direction.x + y * direction.y + z * direction.z
    }

    #[inline]
    fn normals(&self) -> [Vec4; 3] {
        let (u, v) = (&self.first_axis, &self.second_axis);
        [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]
    }

    /// Unit normal of the triangle in a place, unless it is a needle.
    pub(super) fn normal(&self, slot: usize) -> Vec3A {
        Vec3A::from_array(self.normals().map(|axis| axis[slot]))
    }

    /// Indices of the triangles without the unused places.
    pub(super) fn real_ids(&self) -> impl Iterator<Item = u32> {
        self.ids.into_iter().filter(|&id| id != u32::MAX)
    }

    /// Bit per place that holds a triangle.
    pub(super) fn used(&self) -> u32 {
        let bit = |slot: usize| u32::from(self.ids[slot] != u32::MAX) << slot;
        (0..WIDTH).map(bit).sum()
    }

    /// Index of the triangle in a place.
    pub(super) fn id(&self, slot: usize) -> u32 {
        self.ids[slot]
    }

    /// Bit per triangle: so narrow that [`Self::normal_cos`] says nothing about it.
    pub(super) fn needles(&self) -> u32 {
        (self.c[1].cmple(self.b * NEEDLE as f32)).bitmask()
    }
}

impl Pack for TrianglePack {
    type Item = [Vector3; 3];

    fn new(ids: &[u32], item: &impl Fn(u32) -> [Vector3; 3]) -> Self {
        let mut pack = Self {
            origin: [Vec4::splat(FAR_AWAY); 3],
            first_axis: [Vec4::ONE, Vec4::ZERO, Vec4::ZERO],
            second_axis: [Vec4::ZERO, Vec4::ONE, Vec4::ZERO],
            b: Vec4::ZERO,
            c: [Vec4::ZERO; 2],
            ids: [u32::MAX; WIDTH],
        };
        for (slot, &id) in ids.iter().enumerate() {
            pack.set(slot, &item(id));
            pack.ids[slot] = id;
        }
        pack
    }

    /// The distance to the plane where the foot of the perpendicular lies inside, otherwise the
    /// smallest of the distances to the three edges. "Inside" is strict, so that a triangle
    /// without area is its edges.
    #[inline]
    fn distance_sq(&self, query: &Query) -> Vec4 {
        let (px, py, pz) = (
            query.x - self.origin[0],
            query.y - self.origin[1],
            query.z - self.origin[2],
        );
        let along = |axis: &[Vec4; 3]| px * axis[0] + py * axis[1] + pz * axis[2];
        let (x, y) = (along(&self.first_axis), along(&self.second_axis));
        let height = along(&self.normals());

        let ab_x = x - x.max(Vec4::ZERO).min(self.b);
        let ab_sq = ab_x * ab_x + y * y;

        let (ex, ey) = (self.c[0] - self.b, self.c[1]);
        let from_b = x - self.b;
        let t = clamp_unit((from_b * ex + y * ey) / length_sq(ex, ey));
        let (rx, ry) = (from_b - ex * t, y - ey * t);
        let bc_sq = rx * rx + ry * ry;

        let (fx, fy) = (self.c[0], self.c[1]);
        let t = clamp_unit((x * fx + y * fy) / length_sq(fx, fy));
        let (rx, ry) = (x - fx * t, y - fy * t);
        let ac_sq = rx * rx + ry * ry;

        let inside = y.cmpgt(Vec4::ZERO) & (ex * y).cmpgt(ey * from_b) & (fx * y).cmplt(fy * x);
        let in_plane = Vec4::select(inside, Vec4::ZERO, ab_sq.min(bc_sq).min(ac_sq));
        in_plane + height * height
    }

    #[inline]
    fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    fn ids_mut(&mut self) -> &mut [u32; WIDTH] {
        &mut self.ids
    }
}

/// Squared length of an edge to divide by: without length, whatever is divided is zero too.
#[inline]
fn length_sq(x: Vec4, y: Vec4) -> Vec4 {
    (x * x + y * y).max(Vec4::splat(f32::MIN_POSITIVE))
}

#[inline]
fn clamp_unit(t: Vec4) -> Vec4 {
    t.max(Vec4::ZERO).min(Vec4::ONE)
}

impl TrianglePack {
    fn set(&mut self, slot: usize, corners: &[Vector3; 3]) {
        let side_sq = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).norm_squared());
        let longer = |best, i| if side_sq[i] > side_sq[best] { i } else { best };
        let start = (1..3).fold(0, longer);
        let [a, b, c] = [0, 1, 2].map(|i| corners[(start + i) % 3]);
        let (length, ac) = (side_sq[start].sqrt(), c - a);
        let first = if length > 0.0 {
            (b - a) * (1.0 / length)
        } else {
            Vector3::x()
        };
        let cx = ac.dot(&first);
        let across = ac - first * cx;
        let height = across.norm();
        let second = if height > length * 1e-6 {
            across * (1.0 / height)
        } else if height > length * 1e-14 {
            // Once more, because what cancelled above left `across` slightly off.
            let v = across * (1.0 / height);
            (v - first * first.dot(&v)).normalize()
        } else {
            // `across` is rounding and may point anywhere, even along `first`.
            any_perpendicular(&first)
        };
        let cy = ac.dot(&second).max(0.0);
        for axis in 0..3 {
            self.origin[axis][slot] = a[axis] as f32;
            self.first_axis[axis][slot] = first[axis] as f32;
            self.second_axis[axis][slot] = second[axis] as f32;
        }
        self.b[slot] = length as f32;
        self.c[0][slot] = cx as f32;
        self.c[1][slot] = cy as f32;
    }
}

/// Four points side by side.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct PointPack {
    position: [Vec4; 3],
    ids: [u32; WIDTH],
}

/// Replaces every index in the packs by what `new_ids` has in its place.
pub(super) fn rename<P: Pack>(packs: &mut [P], new_ids: &[u32]) {
    let ids = packs.iter_mut().flat_map(Pack::ids_mut);
    for id in ids.filter(|id| **id != u32::MAX) {
        *id = new_ids[*id as usize];
    }
}

impl Pack for PointPack {
    type Item = Vector3;

    fn new(ids: &[u32], item: &impl Fn(u32) -> Vector3) -> Self {
        let mut pack = Self {
            position: [Vec4::splat(FAR_AWAY); 3],
            ids: [u32::MAX; WIDTH],
        };
        for (slot, &id) in ids.iter().enumerate() {
            let point = item(id);
            for axis in 0..3 {
                pack.position[axis][slot] = point[axis] as f32;
            }
            pack.ids[slot] = id;
        }
        pack
    }

    #[inline]
    fn distance_sq(&self, query: &Query) -> Vec4 {
        let (x, y, z) = (
            query.x - self.position[0],
            query.y - self.position[1],
            query.z - self.position[2],
        );
        x * x + y * y + z * z
    }

    #[inline]
    fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    fn ids_mut(&mut self) -> &mut [u32; WIDTH] {
        &mut self.ids
    }
}
