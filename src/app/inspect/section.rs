//! The section plane.

use serde::{Deserialize, Serialize};

use crate::app::{AppState, Document};
use crate::geometry::{Aabb, Plane, Point3, Similarity, Vector3};
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
    /// The section on or off. A plane of other parts, or from before they were moved, that meets neither is put anew.
    pub(in crate::app) fn toggled_section(&self) -> SectionView {
        let section = self.inspect.section;
        let meets = |plane: &Plane| {
            let boxes = Role::ALL.map(|role| self.bounds_of(role));
            boxes
                .iter()
                .any(|bounds| !bounds.is_empty() && plane.meets(bounds))
        };
        SectionView {
            plane: section.plane.filter(|plane| section.is_on || meets(plane)),
            ..section
        }
        .toggled(|| self.default_section_plane())
    }

    /// A plane through the middle of what both parts have in common, or of the crash part, or of the only one; across
    /// its longest side.
    pub fn default_section_plane(&self) -> Plane {
        let [crash, stamped] = Role::ALL.map(|role| self.bounds_of(role));
        // As loaded they lie anywhere.
        let is_placed = self.view.is_moved_over
            || self.document.crash_from_stamped() != &Similarity::identity();
        let common = if is_placed {
            crash.intersection(&stamped)
        } else {
            Aabb::empty()
        };
        let mut of_interest = [common, crash, stamped].into_iter();
        let Some(bounds) = of_interest.find(|bounds| !bounds.is_empty()) else {
            return Plane::new(Point3::origin(), &Vector3::x());
        };
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
