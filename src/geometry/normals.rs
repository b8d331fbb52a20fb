//! Normals at vertices and at the corners of triangles, and the corners around each vertex.

use rayon::prelude::*;

use super::chunks::{CHUNK, for_chunks, map_chunks};
use super::{Point3, TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Corners around a vertex beyond which it has no common normal: a spike of that many triangles is
/// no sheet, and comparing each with each would take for ever.
const MAX_FAN: usize = 1024;
/// Chunks of vertices whose normals are found before they are put together.
const CHUNKS_PER_WAVE: usize = 8;

/// Unit normal of each triangle; zero without area. O(triangles).
pub fn face_normals(mesh: &TriMesh, monitor: &Monitor) -> Result<Vec<Vector3>, Cancelled> {
    map_chunks(mesh.n_triangles(), monitor, |t| mesh.normal(t))
}

/// For each vertex the corners of triangles that lie there. Corner `3 · t + i` is corner `i` of
/// triangle `t`.
#[derive(Debug, Clone)]
pub struct VertexFans {
    start: Vec<u32>,
    corners: Vec<u32>,
}

impl VertexFans {
    /// Sorts the corners by vertex. O(vertices + triangles).
    pub fn of(mesh: &TriMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        // Where the fan of each vertex ends; filling it from behind turns that into its start.
        let mut start = vec![0_u32; mesh.n_vertices() + 1];
        for_chunks(mesh.n_triangles(), monitor, |range| {
            for &vertex in mesh.triangles()[range].iter().flatten() {
                start[vertex as usize] += 1;
            }
        })?;
        let mut total = 0;
        for count in &mut start {
            total += *count;
            *count = total;
        }
        let mut corners = vec![0; total as usize];
        let n = mesh.n_triangles();
        for_chunks(n, monitor, |range| {
            for t in range.map(|i| n - 1 - i) {
                for i in (0..3).rev() {
                    let place = &mut start[mesh.triangles()[t][i] as usize];
                    *place -= 1;
                    corners[*place as usize] = (3 * t + i) as u32;
                }
            }
        })?;
        Ok(Self { start, corners })
    }

    /// The corners at a vertex in ascending order.
    pub fn around(&self, vertex: usize) -> &[u32] {
        &self.corners[self.start[vertex] as usize..self.start[vertex + 1] as usize]
    }

    fn n_vertices(&self) -> usize {
        self.start.len() - 1
    }
}

/// Unit normals at the vertices and at the corners of triangles. Where the surface is smooth at a vertex,
/// its corners have the vertex's normal, which is stored once.
#[derive(Debug, Clone)]
pub struct CornerNormals {
    /// Those of the vertices, then those that only some corners of a vertex have.
    normals: Vec<Vector3>,
    n_vertices: usize,
    sharp: SharpTriangles,
}

/// The triangles with a corner that does not have its vertex's normal, numbered in their order.
#[derive(Debug, Clone, Default)]
struct SharpTriangles {
    /// A bit for each triangle of the mesh.
    is_sharp: Vec<u64>,
    /// For each 64 triangles how many sharp ones come before them.
    n_before: Vec<u32>,
    /// Place of the normal of each corner of each sharp triangle.
    places: Vec<[u32; 3]>,
}

impl CornerNormals {
    /// Unit normal at each vertex, triangles weighted by their angle at the vertex; zero where a vertex
    /// has no triangle with area. The same as [`TriMesh::vertex_normals`].
    pub fn of_vertices(&self) -> &[Vector3] {
        &self.normals[..self.n_vertices]
    }

    /// The normals at the three corners of a triangle of the mesh that these are made of.
    #[inline]
    pub fn of_triangle(&self, mesh: &TriMesh, triangle: usize) -> [Vector3; 3] {
        let places = self.sharp.places_of(triangle);
        let places = places.unwrap_or(&mesh.triangles()[triangle]);
        places.map(|place| self.normals[place as usize])
    }
}

impl SharpTriangles {
    /// `own` are the corners with a normal of their own, each with its place, in rising order.
    fn of(mesh: &TriMesh, own: &[(u32, u32)]) -> Self {
        let mut is_sharp = vec![0_u64; mesh.n_triangles().div_ceil(64)];
        let mut places = Vec::new();
        for of_triangle in own.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
            let triangle = of_triangle[0].0 as usize / 3;
            is_sharp[triangle / 64] |= 1 << (triangle % 64);
            let mut corners = mesh.triangles()[triangle];
            for &(corner, place) in of_triangle {
                corners[corner as usize % 3] = place;
            }
            places.push(corners);
        }
        let mut n = 0;
        let count = |bits: &u64| {
            let before = n;
            n += bits.count_ones();
            before
        };
        let n_before = is_sharp.iter().map(count).collect();
        Self {
            is_sharp,
            n_before,
            places,
        }
    }

    #[inline]
    fn places_of(&self, triangle: usize) -> Option<&[u32; 3]> {
        let (block, bit) = (triangle / 64, 1_u64 << (triangle % 64));
        let bits = self.is_sharp[block];
        let among = (bits & (bit - 1)).count_ones();
        (bits & bit != 0).then(|| &self.places[(self.n_before[block] + among) as usize])
    }
}

/// Normal at each vertex, and at each corner of each triangle the mean of the triangles around the vertex
/// that turn by at most `max_angle` (radians) against this one, all weighted by their angle at the vertex
/// (Thürmer and Wüthrich 1998). Flat areas do not depend on how they are cut, and sharp edges stay sharp.
///
/// `faces` are the [`face_normals`]. O(triangles) for fans of a bounded size.
pub fn corner_normals(
    mesh: &TriMesh,
    faces: &[Vector3],
    fans: &VertexFans,
    max_angle: f64,
    monitor: &Monitor,
) -> Result<CornerNormals, Cancelled> {
    let min_cos = max_angle.cos();
    let n_vertices = fans.n_vertices();
    let n_chunks = n_vertices.div_ceil(CHUNK);
    let mut normals = Vec::with_capacity(n_vertices);
    let mut of_some = Vec::new();
    let mut own = Vec::new();
    // A few chunks at a time, because what they found is held twice until it is joined.
    for start in (0..n_chunks).step_by(CHUNKS_PER_WAVE) {
        let wave = start..n_chunks.min(start + CHUNKS_PER_WAVE);
        let chunks: Vec<FanNormals> = wave
            .into_par_iter()
            .map(|chunk| {
                monitor.check()?;
                let mut found = FanNormals::default();
                for vertex in chunk * CHUNK..n_vertices.min((chunk + 1) * CHUNK) {
                    found.add(mesh, faces, fans.around(vertex), min_cos);
                }
                Ok(found)
            })
            .collect::<Result<_, Cancelled>>()?;
        for chunk in chunks {
            let before = n_vertices + of_some.len();
            let moved = chunk.own.into_iter();
            own.extend(moved.map(|(corner, place)| (corner, (before + place) as u32)));
            normals.extend(chunk.of_vertices);
            of_some.extend(chunk.of_some);
        }
    }
    normals.extend(of_some);
    own.sort_unstable();
    Ok(CornerNormals {
        normals,
        n_vertices,
        sharp: SharpTriangles::of(mesh, &own),
    })
}

/// Normals of consecutive fans.
#[derive(Default)]
struct FanNormals {
    of_vertices: Vec<Vector3>,
    /// Those that only some corners of a vertex have.
    of_some: Vec<Vector3>,
    /// The corners without their vertex's normal, each with the place of its own in `of_some`.
    own: Vec<(u32, usize)>,
}

impl FanNormals {
    fn add(&mut self, mesh: &TriMesh, faces: &[Vector3], fan: &[u32], min_cos: f64) {
        let face = |corner: u32| faces[corner as usize / 3];
        let weighted = |&corner: &u32| face(corner) * corner_angle(mesh, corner);
        let of_vertex = fan.iter().map(weighted).sum::<Vector3>().try_normalize(0.0);
        self.of_vertices.push(of_vertex.unwrap_or_default());
        let all_agree = fan.len() <= MAX_FAN
            && fan.iter().enumerate().all(|(i, &a)| {
                let own = face(a);
                fan[i..].iter().all(|&b| face(b).dot(&own) >= min_cos)
            });
        if all_agree && of_vertex.is_some() {
            // The common case: one smooth sheet.
            return;
        }
        let first = self.of_some.len();
        for &corner in fan {
            let own = face(corner);
            let agreeing = fan
                .iter()
                .filter(|&&other| face(other).dot(&own) >= min_cos);
            let normal = if fan.len() <= MAX_FAN {
                let sum: Vector3 = agreeing.map(weighted).sum();
                sum.try_normalize(0.0).unwrap_or(own)
            } else {
                own
            };
            // Of a large fan the last one alone: one after the other they would be compared with all before.
            let from = if fan.len() <= MAX_FAN {
                first
            } else {
                first.max(self.of_some.len().saturating_sub(1))
            };
            let known = self.of_some[from..].iter().position(|&n| n == normal);
            let place = known.map_or(self.of_some.len(), |place| from + place);
            if known.is_none() {
                self.of_some.push(normal);
            }
            self.own.push((corner, place));
        }
    }
}

/// Inner angle of a triangle at a corner; zero where a side has no length.
fn corner_angle(mesh: &TriMesh, corner: u32) -> f64 {
    let (triangle, i) = (corner as usize / 3, corner as usize % 3);
    let points: [Point3; 3] = mesh.corners(triangle);
    let (u, v) = (
        points[(i + 1) % 3] - points[i],
        points[(i + 2) % 3] - points[i],
    );
    u.angle(&v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares that bends by `angles` from one to the next.
    fn strip(angles: &[f64]) -> TriMesh {
        let mut positions = Vec::new();
        let (mut x, mut z, mut turned) = (0.0, 0.0, 0.0_f64);
        for i in 0..=angles.len() + 1 {
            positions.extend([Point3::new(x, 0.0, z), Point3::new(x, 1.0, z)]);
            x += turned.cos();
            z += turned.sin();
            turned += angles.get(i).copied().unwrap_or_default();
        }
        let squares = 0..=angles.len() as u32;
        let triangles = squares.flat_map(|i| {
            let a = 2 * i;
            [[a, a + 2, a + 3], [a, a + 3, a + 1]]
        });
        TriMesh::new(positions, triangles.collect()).unwrap()
    }

    fn normals(mesh: &TriMesh, max_angle: f64) -> Vec<[Vector3; 3]> {
        let monitor = Monitor::silent();
        let faces = face_normals(mesh, &monitor).unwrap();
        let fans = VertexFans::of(mesh, &monitor).unwrap();
        let found = corner_normals(mesh, &faces, &fans, max_angle, &monitor).unwrap();
        (0..mesh.n_triangles())
            .map(|t| found.of_triangle(mesh, t))
            .collect()
    }

    /// The definition, corner by corner.
    fn plainly(mesh: &TriMesh, max_angle: f64) -> Vec<[Vector3; 3]> {
        let corner = |t: usize, i: usize| {
            let own = mesh.normal(t);
            let vertex = mesh.triangles()[t][i];
            let mut sum = Vector3::zeros();
            for (other, corners) in mesh.triangles().iter().enumerate() {
                for (j, &v) in corners.iter().enumerate() {
                    if v == vertex && mesh.normal(other).dot(&own) >= max_angle.cos() {
                        sum += mesh.normal(other) * corner_angle(mesh, (3 * other + j) as u32);
                    }
                }
            }
            sum.try_normalize(0.0).unwrap_or(own)
        };
        let triangles = 0..mesh.n_triangles();
        triangles.map(|t| [0, 1, 2].map(|i| corner(t, i))).collect()
    }

    #[test]
    fn corners_have_the_normals_of_the_definition_to_the_last_bit() {
        let mesh = strip(&[0.1, 0.9, 0.3, -0.5, 0.7, -1.4]);
        for max_angle in [0.0, 0.4, 0.7, 3.2] {
            assert_eq!(normals(&mesh, max_angle), plainly(&mesh, max_angle));
        }
        assert_eq!(normals(&strip(&[0.0, 0.0]), 0.5), [[Vector3::z(); 3]; 6]);
    }

    #[test]
    fn sharp_edges_stay_sharp_and_bends_are_smooth() {
        let normal = |i: usize, angle| normals(&strip(&[angle]), 0.6)[i];
        // The last square's first corner lies on the bend.
        assert!((normal(2, 1.0)[0] - strip(&[1.0]).normal(2)).norm() < 1e-12);
        assert!((normal(2, 0.5)[0] - strip(&[0.5]).normal(2)).norm() > 0.1);
    }

    #[test]
    fn vertices_have_the_normals_of_the_plain_loop_to_the_last_bit() {
        // The second has more vertices than a wave.
        for mesh in [
            strip(&[0.1, 0.9, 0.3, -0.5]),
            strip(&[0.1, 0.9, 0.3].repeat(25_000)),
        ] {
            let monitor = Monitor::silent();
            let faces = face_normals(&mesh, &monitor).unwrap();
            let fans = VertexFans::of(&mesh, &monitor).unwrap();
            let found = corner_normals(&mesh, &faces, &fans, 0.6, &monitor).unwrap();
            assert_eq!(found.of_vertices(), mesh.vertex_normals());
        }
    }

    #[test]
    fn a_spike_of_very_many_triangles_ends_soon() {
        let n = 100_000;
        let ring = (0..n).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
            Point3::new(cos, sin, 0.0)
        });
        let positions = std::iter::once(Point3::origin()).chain(ring).collect();
        let triangles = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let found = normals(&TriMesh::new(positions, triangles).unwrap(), 0.6);
        assert!(
            found
                .iter()
                .flatten()
                .all(|n| (n - Vector3::z()).norm() < 1e-6)
        );
    }
}
