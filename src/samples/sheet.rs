//! The exact surface of a part: a section swept along a spine, with embossed beads and pads.

use super::path::{Flat, Path};
use crate::geometry::{Point3, Vector3};

/// Half width of the central differences, millimetres.
const STEP: f64 = 1e-3;

/// Values over the length of a part, joined by smooth steps.
#[derive(Debug, Clone, Default)]
pub(super) struct Ramp(pub(super) Vec<(f64, f64)>);

impl Ramp {
    fn at(&self, u: f64, otherwise: f64) -> f64 {
        let Some(&(first, value)) = self.0.first() else {
            return otherwise;
        };
        let mut result = value;
        let mut from = first;
        for &(knot, next) in &self.0[1..] {
            if u > from {
                result += (next - result) * smooth_step((u - from) / (knot - from));
            }
            from = knot;
        }
        result
    }
}

/// A raised or sunk field of the sheet: a rounded box with a sloping rim. A bead has no width.
#[derive(Debug, Clone, Copy)]
pub(super) struct Emboss {
    /// Middle in (u, v).
    pub(super) center: (f64, f64),
    /// Half length and half width of the box before rounding.
    pub(super) half: (f64, f64),
    /// Turn of the box, radians.
    pub(super) angle: f64,
    /// How far the rounding reaches around the box.
    pub(super) radius: f64,
    /// Width of the slope around it.
    pub(super) ramp: f64,
    /// Height along the sheet's normal; negative is sunk.
    pub(super) height: f64,
}

impl Emboss {
    fn at(&self, p: &Flat) -> f64 {
        let (x, y) = (p.x - self.center.0, p.y - self.center.1);
        // Most embosses are far from most points.
        let reach = self.half.0 + self.half.1 + self.radius + self.ramp;
        if x.abs().max(y.abs()) > reach {
            return 0.0;
        }
        let (sin, cos) = self.angle.sin_cos();
        let outside_x = ((x * cos + y * sin).abs() - self.half.0).max(0.0);
        let outside_y = ((y * cos - x * sin).abs() - self.half.1).max(0.0);
        let outside = outside_x.hypot(outside_y) - self.radius;
        self.height * smooth_step(1.0 - outside / self.ramp)
    }
}

/// Quintic step from 0 to 1 with continuous curvature.
pub(super) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

/// A smooth surface over the plane (u, v), both in millimetres of arc length, u along the part and
/// v across it, (0, 0) in the middle. Defined everywhere, so that addendum lies on it too.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    /// Curve in (x, z) that the section follows.
    pub(super) spine: Path,
    /// Curve in (y, z), from negative to positive y; of a turned sheet in (radius, z), from its axis.
    pub(super) section: Path,
    /// Whether the section is turned about z instead of swept along the spine; (u, v) are then a
    /// plane wound around the axis, with the arc length from the axis as radius.
    pub(super) is_turned: bool,
    /// Factor on the section's z, within `height_band` of the middle.
    pub(super) height: Ramp,
    /// Half width in v where `height` acts. The section must lie at z = 0 on its border.
    pub(super) height_band: f64,
    /// Widening of each half of the section along y.
    pub(super) flare: Ramp,
    /// Half width in v over which the widening grows from 0 to its value.
    pub(super) flare_band: f64,
    /// Beads and pads.
    pub(super) embosses: Vec<Emboss>,
}

impl Sheet {
    /// A plain sweep without ramps and embosses.
    pub(super) fn sweep(spine: Path, section: Path) -> Self {
        Self {
            spine,
            section,
            is_turned: false,
            height: Ramp::default(),
            height_band: f64::INFINITY,
            flare: Ramp::default(),
            flare_band: 1.0,
            embosses: Vec::new(),
        }
    }

    /// A section in (radius, z) turned about z.
    pub(super) fn turned(section: Path) -> Self {
        Self {
            is_turned: true,
            ..Self::sweep(Path::open(&[(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)]), section)
        }
    }

    /// The point of the surface over (u, v).
    pub(super) fn point(&self, p: &Flat) -> Point3 {
        if self.is_turned {
            return self.turned_point(p);
        }
        let (along, tangent) = self.spine.at(p.x + self.spine.length() / 2.0);
        let (across, slope) = self.section.at(p.y + self.section.length() / 2.0);
        let factor = if p.y.abs() < self.height_band {
            self.height.at(p.x, 1.0)
        } else {
            1.0
        };
        let side = smooth_step((p.y / self.flare_band + 1.0) / 2.0) * 2.0 - 1.0;
        let raised: f64 = self.embosses.iter().map(|emboss| emboss.at(p)).sum();
        let y = across.x + side * self.flare.at(p.x, 0.0) - slope.y * raised;
        let z = across.y * factor + slope.x * raised;
        Point3::new(along.x - tangent.y * z, y, along.y + tangent.x * z)
    }

    fn turned_point(&self, p: &Flat) -> Point3 {
        let (profile, slope) = self.section.at(p.coords.norm());
        let raised: f64 = self.embosses.iter().map(|emboss| emboss.at(p)).sum();
        let radius = profile.x - slope.y * raised;
        let (sin, cos) = p.y.atan2(p.x).sin_cos();
        Point3::new(radius * cos, radius * sin, profile.y + slope.x * raised)
    }

    /// Unit normal, on the +z side of a flat part, by central differences.
    pub(super) fn normal(&self, p: &Flat) -> Vector3 {
        self.area_vector(p).normalize()
    }

    /// Area of the surface over that in the plane.
    pub(super) fn stretch(&self, p: &Flat) -> f64 {
        self.area_vector(p).norm() / (4.0 * STEP * STEP)
    }

    fn area_vector(&self, p: &Flat) -> Vector3 {
        let along =
            self.point(&Flat::new(p.x + STEP, p.y)) - self.point(&Flat::new(p.x - STEP, p.y));
        let across =
            self.point(&Flat::new(p.x, p.y + STEP)) - self.point(&Flat::new(p.x, p.y - STEP));
        along.cross(&across)
    }
}
