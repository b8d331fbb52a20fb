//! Outlines laid flat, and how those of the two parts lie to each other.

use super::sections::LineStyle;
use crate::geometry::Vector3;
use crate::role::Role;

/// A line of an outline in the axes of the plane.
pub(super) struct Outline {
    pub role: Role,
    pub style: LineStyle,
    pub points: Vec<[f64; 2]>,
}

/// How the outlines of the two parts lie in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lie {
    /// Near enough to be compared.
    Together,
    /// So far from each other that one picture shows neither.
    Apart(f64),
    /// The plane meets this part alone.
    Alone(Role),
    /// The plane meets neither.
    Nowhere,
}

/// Outlines whose boxes are farther from each other than this share of the larger one are not seen together.
const APART: f64 = 1.0;

/// A box around the outlines of a part, or of all: its least and its greatest corner.
pub(super) fn around(outlines: &[Outline], role: Option<Role>) -> Option<[[f64; 2]; 2]> {
    let of = |outline: &&Outline| role.is_none_or(|role| outline.role == role);
    let mut points = outlines
        .iter()
        .filter(of)
        .flat_map(|outline| &outline.points);
    let first = *points.next()?;
    Some(points.fold([first; 2], |[low, high], point| {
        [
            [low[0].min(point[0]), low[1].min(point[1])],
            [high[0].max(point[0]), high[1].max(point[1])],
        ]
    }))
}

impl Lie {
    /// How outlines lie to each other.
    pub fn of(outlines: &[Outline]) -> Self {
        let boxes = Role::ALL.map(|role| around(outlines, Some(role)));
        let [[low, high], [other_low, other_high]] = match boxes {
            [Some(crash), Some(stamped)] => [crash, stamped],
            [Some(_), None] => return Self::Alone(Role::Crash),
            [None, Some(_)] => return Self::Alone(Role::Stamped),
            [None, None] => return Self::Nowhere,
        };
        let between = |i: usize| {
            (other_low[i] - high[i])
                .max(low[i] - other_high[i])
                .max(0.0)
        };
        let distance = between(0).hypot(between(1));
        let size = |low: [f64; 2], high: [f64; 2]| (high[0] - low[0]).hypot(high[1] - low[1]);
        if distance > APART * size(low, high).max(size(other_low, other_high)) {
            Self::Apart(distance)
        } else {
            Self::Together
        }
    }
}

/// A direction by its coordinate letter, or by its parts where it lies between the axes.
pub(super) fn direction_name(direction: &Vector3) -> String {
    let sign = |part: f64| if part < 0.0 { "−" } else { "" };
    let letters = ["X", "Y", "Z"];
    let mut along = letters.into_iter().zip(direction.iter());
    if let Some((letter, part)) = along.find(|(_, part)| part.abs() > 1.0 - 1e-9) {
        return format!("{}{letter}", sign(*part));
    }
    let parts = letters.into_iter().zip(direction.iter());
    let parts = parts.filter(|(_, part)| part.abs() >= 0.005);
    let terms = parts.enumerate().map(|(index, (letter, part))| {
        let sign = match (index, *part < 0.0) {
            (0, _) => sign(*part),
            (_, false) => " + ",
            (_, true) => " − ",
        };
        format!("{sign}{:.2} {letter}", part.abs())
    });
    terms.collect()
}

/// What is told along an axis in a direction, and its sign: a coordinate itself, which falls where the direction is
/// against it.
pub(super) fn told_along(direction: &Vector3) -> (String, f64) {
    let is_against = |part: &f64| *part < -1.0 + 1e-9;
    let sign = if direction.iter().any(is_against) {
        -1.0
    } else {
        1.0
    };
    (direction_name(&(direction * sign)), sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(role: Role, left: f64) -> Outline {
        Outline {
            role,
            style: LineStyle {
                rgb: [0; 3],
                is_dashed: false,
            },
            points: vec![[left, 0.0], [left + 3.0, 4.0]],
        }
    }

    #[test]
    fn directions_have_the_letters_of_the_axes() {
        assert_eq!(direction_name(&Vector3::y()), "Y");
        assert_eq!(direction_name(&-Vector3::x()), "−X");
        let between = Vector3::new(-0.6, 0.0, 0.8);
        assert_eq!(direction_name(&between), "−0.60 X + 0.80 Z");
        // Along an axis the coordinate itself is told, also where it falls.
        assert_eq!(told_along(&-Vector3::x()), ("X".to_owned(), -1.0));
        assert_eq!(told_along(&Vector3::z()), ("Z".to_owned(), 1.0));
        assert_eq!(told_along(&between), (direction_name(&between), 1.0));
    }

    #[test]
    fn outlines_far_from_each_other_lie_apart() {
        let crash = || square(Role::Crash, 0.0);
        let stamped = |left| square(Role::Stamped, left);
        assert_eq!(Lie::of(&[crash(), stamped(1.0)]), Lie::Together);
        assert_eq!(Lie::of(&[crash(), stamped(7.0)]), Lie::Together);
        assert_eq!(Lie::of(&[stamped(-20.0), crash()]), Lie::Apart(17.0));
        assert_eq!(Lie::of(&[crash()]), Lie::Alone(Role::Crash));
        assert_eq!(Lie::of(&[]), Lie::Nowhere);
        assert_eq!(around(&[stamped(1.0)], Some(Role::Crash)), None);
    }
}
