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

/// What a picture showed, and the camera it was seen by.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    scene: Scene,
    camera: Camera,
}

impl Seen {
    /// What a frame shows.
    pub(super) fn of(frame: &Frame<'_>) -> Self {
        Self {
            scene: frame.scene.clone(),
            camera: *frame.camera,
        }
    }

    /// True if a frame shows the same.
    pub(super) fn is_of(&self, frame: &Frame<'_>) -> bool {
        self.scene == *frame.scene && self.camera == *frame.camera
    }

    /// True if a frame shows everything at the same place.
    pub(super) fn lies_as(&self, frame: &Frame<'_>) -> bool {
        self.camera == *frame.camera && frame.scene.lies_as(&self.scene)
    }
}
