//! Points spread evenly over a surface.

use super::z_order::{LAST_CELL, z_code};
use super::{Aabb, Point3, TriMesh, Vector3};

/// A point on a surface that stands for a piece of its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// Where it lies.
    pub point: Point3,
    /// Unit normal of its triangle.
    pub normal: Vector3,
    /// Triangle the sample lies on.
    pub triangle: u32,
    /// The area it stands for; those of all samples sum to the area of the mesh.
    pub area: f64,
}

/// `n` samples spread evenly over the area; none if the mesh has no area.
///
/// The triangles are laid end to end along a Z-order curve (Morton 1966), the line is cut into `n`
/// pieces of equal area, and each piece gets one sample at a place that depends on `seed` and the
/// piece's number alone. So no sizeable patch goes without samples, and samples that follow each
/// other lie near each other, which keeps a search tree's cache warm.
/// O(triangles · log triangles + n).
pub fn sample_surface(mesh: &TriMesh, n: usize, seed: u64) -> Vec<SurfaceSample> {
    let order = along_z_curve(mesh);
    let areas: Vec<f64> = order
        .iter()
        .map(|&t| mesh.triangle_area(t as usize))
        .collect();
    let total: f64 = areas.iter().sum();
    if total <= 0.0 || !total.is_finite() {
        return Vec::new();
    }
    let piece = total / n as f64;
    let mut samples = Vec::with_capacity(n);
    let mut slot = 0;
    let mut before = 0.0;
    for i in 0..n {
        let [along, u, v] = std::array::from_fn(|k| uniform(seed, 3 * i as u64 + k as u64));
        let at = (i as f64 + along) * piece;
        while slot + 1 < order.len() && before + areas[slot] <= at {
            before += areas[slot];
            slot += 1;
        }
        // Rounding may run past the last triangle with area.
        while areas[slot] <= 0.0 && slot > 0 {
            slot -= 1;
            before -= areas[slot];
        }
        let triangle = order[slot];
        samples.push(SurfaceSample {
            point: place(&mesh.corners(triangle as usize), u, v),
            normal: mesh.normal(triangle as usize),
            triangle,
            area: piece,
        });
    }
    samples
}

/// A point of the triangle, uniform over its area for uniform `u` and `v`.
fn place([a, b, c]: &[Point3; 3], u: f64, v: f64) -> Point3 {
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    a + (b - a) * u + (c - a) * v
}

/// Triangle indices in the order of their centres along a Z-order curve.
fn along_z_curve(mesh: &TriMesh) -> Vec<u32> {
    let Aabb { min, .. } = mesh.aabb();
    let extent = mesh.aabb().extents().max().max(f64::MIN_POSITIVE);
    let code = |t: usize| -> u32 {
        let [a, b, c] = mesh.corners(t);
        let center = (a - min + (b - min) + (c - min)) / (3.0 * extent);
        z_code(&(center * LAST_CELL))
    };
    let mut keys: Vec<u64> = (0..mesh.n_triangles())
        .map(|t| u64::from(code(t)) << 32 | t as u64)
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// A number in 0 … 1 that depends on seed and index alone (splitmix64, Steele et al. 2014).
fn uniform(seed: u64, index: u64) -> f64 {
    let mix = |mut z: u64| {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (mix(mix(seed) ^ index) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square in two triangles of very different size, and one without area.
    fn square() -> TriMesh {
        let p = |x: f64, y: f64| Point3::new(x, y, 7.0);
        let positions = vec![
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(1.0, 1.0),
            p(0.0, 1.0),
            p(0.9, 0.0),
        ];
        let triangles = vec![[0, 4, 3], [4, 4, 1], [4, 1, 2], [4, 2, 3]];
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn samples_lie_on_their_triangles_and_share_the_area() {
        let mesh = square();
        let samples = sample_surface(&mesh, 1000, 3);
        assert_eq!(samples.len(), 1000);
        assert!((samples.iter().map(|s| s.area).sum::<f64>() - 1.0).abs() < 1e-12);
        let mut counts = [0; 4];
        for sample in &samples {
            assert_eq!(sample.point.z, 7.0);
            assert_eq!(sample.normal, Vector3::z());
            assert_ne!(sample.triangle, 1);
            counts[sample.triangle as usize] += 1;
        }
        for (t, count) in counts.into_iter().enumerate() {
            // Each piece of the line lies in one triangle but for those across a boundary.
            let expected = 1000.0 * mesh.triangle_area(t);
            assert!(
                (f64::from(count) - expected).abs() <= 2.0,
                "{count} of {expected}"
            );
        }
        let mean = samples.iter().map(|s| s.point.coords).sum::<Vector3>() / 1000.0;
        assert!((mean - Vector3::new(0.5, 0.5, 7.0)).norm() < 0.03, "{mean}");
    }

    #[test]
    fn the_seed_decides() {
        let mesh = square();
        assert_eq!(sample_surface(&mesh, 50, 1), sample_surface(&mesh, 50, 1));
        assert_ne!(sample_surface(&mesh, 50, 1), sample_surface(&mesh, 50, 2));
    }

    #[test]
    fn no_area_no_samples() {
        assert!(sample_surface(&TriMesh::default(), 10, 1).is_empty());
        assert!(sample_surface(&square(), 0, 1).is_empty());
        let point = TriMesh::new(vec![Point3::origin()], vec![[0, 0, 0]]).unwrap();
        assert!(sample_surface(&point, 10, 1).is_empty());
    }
}
