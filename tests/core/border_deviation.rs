//! How far the borders of a reduced mesh moved, measured plainly.

use shapematch::geometry::{BorderEdges, Point3, Topology, TriMesh, Vector3};

/// Samples per original edge length, at least; long edges get more.
const SAMPLES_PER_BORDER: usize = 4096;

/// Distances between the border polylines of two meshes, in length units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BorderDeviation {
    /// Root mean square over both directions, by length. 0 if neither mesh has a border, infinite
    /// if only one has.
    pub rms: f64,
    /// The largest distance in either direction.
    pub max: f64,
    /// Border loops of the first mesh.
    pub loops_before: usize,
    /// Border loops of the second mesh.
    pub loops_after: usize,
}

/// Measures the borders of `reduced` against those of `original`, both ways: each border is
/// sampled evenly by length, its vertices included, and each sample looks for the closest point
/// on the other. O(edges · samples).
pub fn border_deviation(original: &TriMesh, reduced: &TriMesh) -> BorderDeviation {
    let (before, after) = (Border::of(original), Border::of(reduced));
    let mut deviation = BorderDeviation {
        loops_before: before.n_loops,
        loops_after: after.n_loops,
        ..BorderDeviation::default()
    };
    if before.segments.is_empty() && after.segments.is_empty() {
        return deviation;
    }
    let (mut sum, mut length) = (0.0, 0.0);
    for (from, to) in [(&before, &after), (&after, &before)] {
        let squared_distance = |point: &Point3| {
            let all = to
                .segments
                .iter()
                .map(|segment| segment.squared_distance(point));
            all.fold(f64::INFINITY, f64::min)
        };
        let spacing = from.length() / SAMPLES_PER_BORDER as f64;
        for segment in &from.segments {
            let n = (segment.length() / spacing.max(f64::MIN_POSITIVE))
                .ceil()
                .max(1.0);
            let mut segment_sum = 0.0;
            for k in 0..n as usize {
                let squared = squared_distance(&segment.at((k as f64 + 0.5) / n));
                segment_sum += squared;
                deviation.max = deviation.max.max(squared);
            }
            sum += segment_sum / n * segment.length();
            length += segment.length();
            deviation.max = deviation.max.max(squared_distance(&segment.start));
        }
    }
    deviation.rms = if length > 0.0 {
        (sum / length).sqrt()
    } else {
        0.0
    };
    deviation.max = deviation.max.sqrt();
    deviation
}

#[derive(Debug, Clone, Copy)]
struct Segment {
    start: Point3,
    along: Vector3,
}

impl Segment {
    fn at(&self, t: f64) -> Point3 {
        self.start + self.along * t
    }

    fn length(&self) -> f64 {
        self.along.norm()
    }

    fn squared_distance(&self, point: &Point3) -> f64 {
        let from_start = point - self.start;
        let length2 = self.along.norm_squared();
        let t = if length2 > 0.0 {
            (from_start.dot(&self.along) / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (from_start - self.along * t).norm_squared()
    }
}

struct Border {
    segments: Vec<Segment>,
    n_loops: usize,
}

impl Border {
    fn of(mesh: &TriMesh) -> Self {
        let edges = BorderEdges::of(mesh, &Topology::of(mesh));
        let segments = edges
            .iter()
            .map(|edge| {
                let [u, v] = edge.ends.map(|v| mesh.positions()[v as usize]);
                Segment {
                    start: u,
                    along: v - u,
                }
            })
            .collect();
        Self {
            segments,
            n_loops: edges.loops().len(),
        }
    }

    fn length(&self) -> f64 {
        self.segments.iter().map(Segment::length).sum()
    }
}

fn square(size: f64) -> TriMesh {
    let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let positions = vec![p(0.0, 0.0), p(size, 0.0), p(size, size), p(0.0, size)];
    TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

#[test]
fn a_square_against_a_larger_one() {
    let deviation = border_deviation(&square(10.0), &square(11.0));
    assert!((deviation.max - 2.0_f64.sqrt()).abs() < 1e-12);
    assert!(deviation.rms > 0.6 && deviation.rms < 1.0, "{deviation:?}");
    assert_eq!((deviation.loops_before, deviation.loops_after), (1, 1));
    assert_eq!(border_deviation(&square(10.0), &square(10.0)).max, 0.0);
}

#[test]
fn a_lost_border_is_infinitely_far() {
    let deviation = border_deviation(&square(1.0), &TriMesh::default());
    assert_eq!(deviation.max, f64::INFINITY);
    assert_eq!(deviation.rms, f64::INFINITY);
    let none = border_deviation(&TriMesh::default(), &TriMesh::default());
    assert_eq!(none, BorderDeviation::default());
}
