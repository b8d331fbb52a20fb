//! A floor-like pan: a tunnel, beads, flanged sides and twelve round holes, meshed at one pitch.

use shapematch::geometry::{Point3, TriMesh};

const LENGTH: f64 = 1400.0;
const WIDTH: f64 = 840.0;

/// Centre and radius of the holes.
const HOLES: [([f64; 2], f64); 12] = [
    ([-520.0, -250.0], 30.0),
    ([-250.0, -250.0], 40.0),
    ([60.0, -250.0], 25.0),
    ([420.0, -250.0], 45.0),
    ([-520.0, 250.0], 30.0),
    ([-250.0, 250.0], 40.0),
    ([60.0, 250.0], 25.0),
    ([420.0, 250.0], 45.0),
    ([-600.0, 0.0], 35.0),
    ([-100.0, 0.0], 28.0),
    ([300.0, 0.0], 50.0),
    ([610.0, 0.0], 26.0),
];

/// 0 below 0, 1 above 1, smooth in between.
fn step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn height(x: f64, y: f64) -> f64 {
    let tunnel = 130.0 * (1.0 - 0.15 * x / LENGTH) * step((150.0 - y.abs()) / 70.0);
    let sides = 45.0 * step((y.abs() - 385.0) / 25.0);
    let bead = |centre: f64| {
        let across = 1.0 - ((y.abs() - centre) / 14.0).powi(2);
        let along = step((560.0 - x.abs()) / 30.0) * step((x.abs() - 60.0) / 30.0);
        7.0 * across.max(0.0).powi(2) * along
    };
    let heel = 60.0 * step((x - 480.0) / 90.0);
    tunnel + sides + bead(180.0) + bead(320.0) + bead(355.0) + heel + 2e-5 * x * x
}

/// The pan at a pitch in mm: 8 gives about 35,000 triangles, 13 border loops, one component.
pub fn pan(pitch: f64) -> TriMesh {
    let (nx, ny) = ((LENGTH / pitch) as u32, (WIDTH / pitch) as u32);
    let at = |i: u32, j: u32| {
        let x = LENGTH * (f64::from(i) / f64::from(nx) - 0.5);
        let y = WIDTH * (f64::from(j) / f64::from(ny) - 0.5);
        [x, y]
    };
    let index = |i: u32, j: u32| j * (nx + 1) + i;
    let in_hole = |[x, y]: [f64; 2]| {
        HOLES
            .iter()
            .any(|([cx, cy], r)| (x - cx).hypot(y - cy) < *r)
    };
    let mut triangles = Vec::new();
    let mut on_border = vec![[false; 2]; ((nx + 1) * (ny + 1)) as usize];
    for j in 0..ny {
        for i in 0..nx {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let [a, b, c, d] = corners.map(|[i, j]| index(i, j));
            let cut = corners.iter().any(|&[i, j]| in_hole(at(i, j)));
            for v in [a, b, c, d] {
                on_border[v as usize][usize::from(cut)] = true;
            }
            if cut {
                continue;
            }
            if (i + j) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    // Three vertices of one border would span a triangle inside the hole.
    triangles.retain(|corners| {
        corners
            .iter()
            .any(|&v| on_border[v as usize] != [true, true])
    });
    let mut positions = Vec::new();
    for j in 0..=ny {
        for i in 0..=nx {
            let [mut x, mut y] = at(i, j);
            if on_border[index(i, j) as usize] == [true, true] {
                let ([cx, cy], r) = HOLES
                    .iter()
                    .copied()
                    .min_by(|(p, r), (q, s)| {
                        let d = |c: &[f64; 2], r: &f64| (x - c[0]).hypot(y - c[1]) - r;
                        d(p, r).total_cmp(&d(q, s))
                    })
                    .unwrap();
                let d = (x - cx).hypot(y - cy);
                (x, y) = (cx + (x - cx) * r / d, cy + (y - cy) * r / d);
            }
            positions.push(Point3::new(x, y, height(x, y)));
        }
    }
    TriMesh::new(positions, triangles).unwrap()
}
