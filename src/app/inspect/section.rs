//! The section plane.

use serde::{Deserialize, Serialize};

use crate::app::{AppState, Document};
use crate::geometry::{Plane, Point3, Vector3};
use crate::role::Role;

/// The section plane and what becomes of the parts in front of it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct SectionView {
    /// The plane is shown and cuts.
    pub is_on: bool,
    /// Where it is, in the space of the crash model; stays while it is off.
    pub plane: Option<Plane>,
    /// What lies on the side of the normal is not drawn.
    pub is_clipped: bool,
}

impl SectionView {
    /// The plane, if it is shown.
    pub fn shown(&self) -> Option<Plane> {
        self.plane.filter(|_| self.is_on)
    }

    /// The section on or off; at first at the plane that is given.
    #[must_use]
    pub fn toggled(self, first: impl FnOnce() -> Plane) -> Self {
        Self {
            is_on: !self.is_on,
            plane: Some(self.plane.unwrap_or_else(first)),
            ..self
        }
    }

    /// The section with its plane turned to a direction, through the same point.
    #[must_use]
    pub fn across(self, normal: &Vector3, first: impl FnOnce() -> Plane) -> Self {
        let plane = self.plane.unwrap_or_else(first);
        Self {
            is_on: true,
            plane: Some(Plane::new(plane.point, normal)),
            ..self
        }
    }

    /// The section with its plane moved along its normal.
    pub fn moved(self, way: f64) -> Option<Self> {
        let plane = self.shown()?;
        let point = plane.point + plane.normal * way;
        Some(Self {
            plane: Some(Plane { point, ..plane }),
            ..self
        })
    }
}

impl AppState {
    /// A plane through the middle of the parts, across their longest side.
    pub fn default_section_plane(&self) -> Plane {
        let bounds = self.visible_bounds(Role::Crash);
        let bounds = if bounds.is_empty() {
            self.visible_bounds(Role::Stamped)
        } else {
            bounds
        };
        if bounds.is_empty() {
            return Plane::new(Point3::origin(), &Vector3::x());
        }
        let size = bounds.max - bounds.min;
        let longest = size.imax();
        let mut normal = Vector3::zeros();
        normal[longest] = 1.0;
        Plane::new(bounds.center(), &normal)
    }
}

impl Document {
    /// A tenth of an element, the step of the section plane by keys.
    pub fn section_step(&self) -> f64 {
        let parts = Role::ALL.into_iter();
        let sizes = parts.filter_map(|role| Some(self.part(role)?.facts.edge_length));
        let finest = sizes.fold(f64::INFINITY, f64::min);
        if finest.is_finite() {
            0.1 * finest
        } else {
            0.1
        }
    }
}
