//! Numbers of a mapping as colours of the crash part, one for each element: difference, distance,
//! angle, confidence, status.

use super::meshes::ShownMesh;
use crate::app::MapPicture;
use crate::colormap::ColorScale;
use crate::pipeline::map::{MapRun, OtherResult, ShownValue};

/// The numbers of a picture at the corners of a mesh, three for each triangle; NaN where there is none.
pub(super) fn at_corners(
    shown: &ShownMesh,
    (run, other): (&MapRun, Option<&OtherResult>),
    picture: MapPicture,
    value: &ShownValue,
) -> Vec<f32> {
    let mut by_shell = vec![f32::NAN; shown.source.part.model.shells.len()];
    for (element, &shell) in run.shells.iter().enumerate() {
        if let Some(slot) = by_shell.get_mut(shell as usize) {
            *slot = number((run, other), element, picture, value) as f32;
        }
    }
    let triangles = 0..shown.mesh().n_triangles();
    let numbers = triangles.map(|triangle| {
        let shell = shown.source.element(triangle) as usize;
        by_shell.get(shell).copied().unwrap_or(f32::NAN)
    });
    numbers.flat_map(|number| [number; 3]).collect()
}

fn number(
    (run, other): (&MapRun, Option<&OtherResult>),
    element: usize,
    picture: MapPicture,
    value: &ShownValue,
) -> f64 {
    let report = &run.mapped.elements[element];
    match picture {
        MapPicture::Difference => run.difference(element, value),
        MapPicture::Distance => report.normal_distance,
        MapPicture::Angle => report.angle_deg,
        MapPicture::Confidence if report.status.has_values() => report.confidence,
        MapPicture::Confidence => f64::NAN,
        MapPicture::Status => f64::from(report.status as u8),
        MapPicture::File => {
            let part = run.values_from(element);
            part.map_or(f64::NAN, ColorScale::file_value)
        }
        MapPicture::Other => {
            other.map_or(f64::NAN, |other| run.difference_to(other, element, value))
        }
    }
}
