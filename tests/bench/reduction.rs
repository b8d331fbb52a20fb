//! What the reduction benchmark times, apart from the timing, so that a test can run it small.

use shapematch::geometry::TriMesh;
use shapematch::monitor::Monitor;
use shapematch::simplify::{CollapseSequence, SimplifySettings, Speed, simplify};

/// Reduces from scratch.
pub fn reduce(mesh: &TriMesh, speed: Speed, max_triangles: usize) -> TriMesh {
    let settings = SimplifySettings {
        speed,
        ..SimplifySettings::to_triangles(max_triangles)
    };
    let simplified = simplify(mesh, &settings, &Monitor::silent());
    simplified
        .expect("the default settings are valid and nobody cancels")
        .mesh
}

/// Records down to a level, for levels to be taken out.
pub fn record(mesh: &TriMesh, max_triangles: usize) -> CollapseSequence {
    let settings = SimplifySettings::to_triangles(max_triangles);
    CollapseSequence::record(mesh, &settings, &Monitor::silent())
        .expect("the default settings are valid and nobody cancels")
}
