//! Thickness at the corners of the target elements from the thickness of the elements.

use rayon::prelude::*;

use super::field::Fields;
use super::patch::Patch;
use super::target::TargetPart;
use crate::monitor::{Cancelled, Monitor};

/// Elements that one thread takes at a time.
const CHUNK: usize = 1024;

/// The linear field around each element at its corners, limited so that no corner leaves the range of
/// the elements around; the mean of the corners is the element's value. NaN where it has none.
pub(super) fn corner_thickness(
    thickness: &[f64],
    target: &TargetPart,
    monitor: &Monitor,
) -> Result<Vec<[f64; 4]>, Cancelled> {
    let mesh = &target.mesh;
    let links = mesh.links(monitor)?;
    let neighbours = &links.neighbours;
    let of_chunk = |chunk: usize| -> Result<Vec<[f64; 4]>, Cancelled> {
        monitor.check()?;
        let elements = chunk * CHUNK..((chunk + 1) * CHUNK).min(mesh.len());
        let mut patch = Patch::default();
        let numbers = elements.clone().map(|element| element as u32);
        patch.load(numbers, mesh, neighbours, thickness);
        let Fields {
            patch, thickness, ..
        } = Fields::of_thickness(patch, thickness);
        let at_corners = |slot: usize| {
            let field = thickness.as_ref()?;
            let corners = patch.corners(slot);
            Some(corners.map(|offset| field.weighted(slot, 0, 1.0, &offset)[0]))
        };
        let slots = 0..elements.len();
        Ok(slots
            .map(|slot| at_corners(slot).unwrap_or([f64::NAN; 4]))
            .collect())
    };
    let chunks: Vec<Vec<[f64; 4]>> = (0..mesh.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(of_chunk)
        .collect::<Result<_, Cancelled>>()?;
    Ok(chunks.concat())
}
