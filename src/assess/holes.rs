//! Poses from holes, whatever the match found.

use super::tolerance::is_source_smaller;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Surface, WideSearch};

/// Whether both parts have holes, and a pose like this one is looked for by them.
pub(super) fn can_place(source: &Surface, target: &Surface, pose: &Similarity) -> bool {
    let has_holes = |part: &Surface| part.borders().iter().any(|border| border.is_hole);
    !pose.is_mirrored() && pose.scale == 1.0 && has_holes(source) && has_holes(target)
}

/// The poses under which the most holes of the smaller part lie on like ones of the other; they are as exact as the middles
/// of a few holes. O(holes² of both parts), bounded.
pub(super) fn poses(
    source: &Surface,
    target: &Surface,
    monitor: &Monitor,
) -> Result<Vec<Similarity>, Cancelled> {
    let is_source_smaller = is_source_smaller(source, target, 1.0);
    let [data, model] = if is_source_smaller {
        [source, target]
    } else {
        [target, source]
    };
    let Some(search) = WideSearch::new(data, model) else {
        return Ok(Vec::new());
    };
    let mut poses = search.on_holes(monitor)?;
    if !is_source_smaller {
        for pose in &mut poses {
            *pose = pose.inverse();
        }
    }
    Ok(poses)
}

/// Of these the poses that lie farther than `apart` from all known ones, which are more exact.
pub(super) fn poses_unlike(
    source: &Surface,
    target: &Surface,
    (known, apart): (&[Similarity], f64),
    monitor: &Monitor,
) -> Result<Vec<Similarity>, Cancelled> {
    let corners = source.mesh().aabb().corners();
    let mut found = poses(source, target, monitor)?;
    found.retain(|pose| {
        let mut known = known.iter();
        known.all(|known| pose.max_displacement(known, &corners) > apart)
    });
    Ok(found)
}
