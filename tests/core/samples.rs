//! The generated pairs: counts, borders, shapes, poses, decks.

use shapematch::geometry::Topology;
use shapematch::samples::{SampleSettings, generate};

#[test]
fn the_floor_is_the_paper_s() {
    let pair = generate(&SampleSettings::default());
    let stamped = pair.stamped.to_trimesh();
    assert_eq!(stamped.n_triangles(), 34_808);
    let diagonal = stamped.aabb().diagonal();
    assert!((diagonal - 1632.0).abs() < 2.0, "{diagonal}");
    let loops = Topology::of(&stamped).border_loops(&stamped);
    assert_eq!(loops.len(), 13);
    assert!(loops.iter().all(|border| border.closed));
}
