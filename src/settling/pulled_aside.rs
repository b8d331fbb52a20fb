//! Does a pose that borders and holes support lie aside of where the surfaces lie on each other?

use super::candidate::{FewPlaces, Judged, judged};
use super::context::PairContext;
use crate::assess::tolerance::AS_CLOSE;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Borders may hold a pose under which what remains of the distances besides a bend is [`AS_CLOSE`] times as much and
/// so many tolerances more.
const LITTLE_REMAINDER: f64 = 0.25;

/// What speaks against a pose that borders and holes support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulledAside {
    /// It is worse than the one that the surfaces found.
    Worse,
    /// It is as likely: more of the parts meets, and their surfaces lie much farther apart or differ somewhere.
    Rival,
}

/// Whether what remains of the distances besides a bend may grow with a motion of the pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remainder {
    /// It may: the surfaces leave the pose free, or a bend has moved it.
    MayGrow,
    /// It may not: the surfaces hold the pose.
    MayNotGrow,
}

/// What speaks against a pose that borders and holes support, beside the one that the surfaces found: that one has
/// surely fewer differences, or what remains besides a bend has clearly grown where it may not, or a piece of the parts
/// lies on each other where all of them lies apart, or the surfaces differ somewhere only under the one that borders
/// support. Springback keeps surfaces farther apart than either pose, so that their distance alone does not decide: an
/// addendum all round that ends anywhere may pull a hood aside by 30 mm. `None` where nothing does; poses that lie
/// within the tolerance of each other are as good. O(border edges + nodes · log triangles).
pub fn pulled_aside(
    context: &PairContext<'_>,
    [by_surfaces, by_borders]: [&Similarity; 2],
    remainder: Remainder,
) -> Result<Option<PulledAside>, Cancelled> {
    context.check()?;
    let distances = context.distances(by_surfaces.scale);
    let tolerance = distances.tolerance;
    if context.displacement(by_surfaces, by_borders) <= tolerance.remainder {
        return Ok(None);
    }
    let few = FewPlaces::new(context, by_surfaces.scale);
    let Judged {
        result: before,
        candidates,
    } = judged(context, by_surfaces, &[*by_borders], |pose, shape| {
        few.candidate(pose, shape)
    })?;
    let [after] = &candidates[..] else {
        return Ok(None);
    };
    let most = AS_CLOSE * before.remainder + LITTLE_REMAINDER * tolerance.remainder;
    let has_grown = remainder == Remainder::MayNotGrow && after.remainder > most;
    if before.beats(after) || has_grown && before.n_differences <= after.n_differences {
        return Ok(Some(PulledAside::Worse));
    }
    let is_rival = before.lies_much_closer_elsewhere_than(after, distances.noise)
        || before.fits_where_surfaces_differ_under(after);
    Ok(is_rival.then_some(PulledAside::Rival))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::AssessSettings;
    use crate::geometry::{Point3, TriMesh, Vector3};
    use crate::monitor::Monitor;
    use crate::registration::Surface;

    #[test]
    fn a_pose_under_which_the_shapes_fit_less_well_is_not_taken_for_its_borders() {
        // A shallow bowl of 300 mm: neither springback nor a small motion explains a shift of it by 30 mm, and half
        // a millimetre does not matter.
        let n = 31;
        let points = (0..n * n).map(|i| {
            let [x, y] = [i % n, i / n].map(|k| 10.0 * f64::from(k) - 150.0);
            let waves = 6.0 * (x / 30.0).sin() * (y / 35.0).cos();
            Point3::new(x, y, (x * x + 0.5 * y * y) / 600.0 + waves)
        });
        let cells = (0..n * (n - 1)).filter(|i| i % n + 1 < n);
        let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        let bowl = Surface::new(&mesh, "source").unwrap();
        let shifted = |x: f64| Similarity {
            translation: Vector3::new(x, 0.0, 0.0),
            ..Similarity::identity()
        };
        let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
        let context = PairContext::new([&bowl, &bowl], &settings, &monitor);
        for (by_surfaces, by_borders, is_worse) in
            [(0.0, 30.0, true), (30.0, 0.0, false), (0.0, 0.5, false)]
        {
            let poses = [&shifted(by_surfaces), &shifted(by_borders)];
            let found = pulled_aside(&context, poses, Remainder::MayNotGrow).unwrap();
            let expected = is_worse.then_some(PulledAside::Worse);
            assert_eq!(found, expected, "{by_surfaces} {by_borders}");
        }
    }
}
