//! An analytic drawn pan, meshed at any pitch, and the measures of a found pose.

use shapematch::geometry::{Point3, Pose, Similarity, TriMesh, Vector3};

/// Height of a drawn pan, 420 × 280 × 45 mm, with a crown and four embosses of different height.
pub fn pan_height(x: f64, y: f64) -> f64 {
    let smooth = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * t * (t * (6.0 * t - 15.0) + 10.0)
    };
    let corner = 40.0;
    let (qx, qy) = (x.abs() - (170.0 - corner), y.abs() - (100.0 - corner));
    let outside = (qx.max(0.0).powi(2) + qy.max(0.0).powi(2)).sqrt();
    let inside = outside + qx.max(qy).min(0.0) - corner;
    let wall = smooth(1.0 - (inside / 30.0));
    let crown = 6.0 * (1.0 - (x / 210.0).powi(2)) * (1.0 - (y / 140.0).powi(2));
    let emboss = |cx: f64, cy: f64, radius: f64, height: f64| {
        let r = ((x - cx).powi(2) + (y - cy).powi(2)).sqrt();
        height * smooth(2.0 * (1.0 - r / radius))
    };
    -45.0 * wall
        + crown
        + emboss(-90.0, 40.0, 35.0, 8.0)
        + emboss(80.0, -30.0, 45.0, -6.0)
        + emboss(70.0, 50.0, 30.0, 5.0)
        + emboss(-60.0, -50.0, 25.0, -4.0)
}

/// The pan within `keep`, sampled on a grid of `pitch` turned by `turn`, jittered.
pub fn pan(pitch: f64, turn: f64, keep: impl Fn(f64, f64) -> bool) -> TriMesh {
    sheet(pitch, turn, pan_height, keep)
}

/// A wavy panel, 200 × 130 mm, whose radii of 45 mm and more elements of 9 mm follow well; meshed
/// as [`pan`] is.
pub fn panel(pitch: f64, turn: f64, keep: impl Fn(f64, f64) -> bool) -> TriMesh {
    let height = |x: f64, y: f64| {
        15.0 * (x / 30.0 + 0.5).sin() + 14.0 * (y / 27.0 - 0.3).cos() + x * y / 270.0
    };
    let within = |x: f64, y: f64| x.abs() <= 100.0 && y.abs() <= 65.0 && keep(x, y);
    sheet(pitch, turn, height, within)
}

fn sheet(
    pitch: f64,
    turn: f64,
    height: impl Fn(f64, f64) -> f64,
    keep: impl Fn(f64, f64) -> bool,
) -> TriMesh {
    let n = (260.0 / pitch) as i64;
    let width = 2 * n + 1;
    let mut index = vec![u32::MAX; (width * width) as usize];
    let mut positions = Vec::new();
    let mut state = 12345u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((state >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 0.3 * pitch
    };
    for j in -n..=n {
        for i in -n..=n {
            let (u, v) = (i as f64 * pitch + noise(), j as f64 * pitch + noise());
            let (x, y) = (
                u * turn.cos() - v * turn.sin(),
                u * turn.sin() + v * turn.cos(),
            );
            if x.abs() <= 210.0 && y.abs() <= 140.0 && keep(x, y) {
                index[((j + n) * width + i + n) as usize] = positions.len() as u32;
                positions.push(Point3::new(x, y, height(x, y)));
            }
        }
    }
    let mut triangles = Vec::new();
    for j in 0..width - 1 {
        for i in 0..width - 1 {
            let at = |di: i64, dj: i64| index[((j + dj) * width + i + di) as usize];
            for corners in [
                [at(0, 0), at(1, 0), at(1, 1)],
                [at(0, 0), at(1, 1), at(0, 1)],
            ] {
                if corners.iter().all(|&v| v != u32::MAX) {
                    triangles.push(corners);
                }
            }
        }
    }
    TriMesh::new(positions, triangles).unwrap()
}

pub fn everywhere(_: f64, _: f64) -> bool {
    true
}

/// A placement far from the origin, different for each seed.
pub fn placement(seed: u64) -> Similarity {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(77);
    let mut next = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 30) as f64 - 1.0
    };
    let axis = Vector3::new(next(), next(), next()).normalize();
    let angle = std::f64::consts::PI * next();
    let shift = Vector3::new(next(), next(), next()) * 2000.0;
    Pose::new(shift, axis * angle).into()
}

/// Largest distance of a source node from where it belongs.
pub fn worst_node(source: &TriMesh, truth: &Similarity, found: &Similarity) -> f64 {
    truth.max_displacement(found, source.positions())
}
