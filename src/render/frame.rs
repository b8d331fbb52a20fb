//! One picture that is asked for.

use super::scene::Scene;
use crate::geometry::Camera;

/// One picture: what, from where, how large.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// What there is to see.
    pub scene: &'a Scene,
    /// Camera the picture is taken with.
    pub camera: &'a Camera,
    /// Width and height in pixels; zero counts as one, sizes beyond the device's limit are cut.
    pub size: [u32; 2],
}
