//! Numbers of a mapping as colours of the crash part, one for each element: difference, distance,
//! angle, confidence, status.

use crate::app::MapPicture;
use crate::colormap::ColorScale;
use crate::pipeline::map::{MapRun, OtherResult, ShownValue};

/// The number of a picture for each of so many elements of the deck; NaN where there is none.
pub(super) fn by_element(
    n_elements: usize,
    (run, other): (&MapRun, Option<&OtherResult>),
    picture: MapPicture,
    value: &ShownValue,
) -> Vec<f64> {
    let mut numbers = vec![f64::NAN; n_elements];
    for (element, &shell) in run.shells.iter().enumerate() {
        if let Some(slot) = numbers.get_mut(shell as usize) {
            *slot = number((run, other), element, picture, value);
        }
    }
    numbers
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
