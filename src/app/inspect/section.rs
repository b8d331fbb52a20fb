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
        let is_kept = |plane: &Plane| section.is_on || self.meets_a_part(plane);
        SectionView {
            plane: section.plane.filter(is_kept),
            ..section
        }
        .toggled(|| self.default_section_plane())
    }

    /// The section with its plane turned to a direction, through the same point unless it met neither part there.
    #[must_use]
    pub fn section_across(&self, normal: &Vector3) -> SectionView {
        let section = self.inspect.section;
        let turned = section.plane.map(|plane| Plane::new(plane.point, normal));
        let plane = turned.filter(|plane| self.meets_a_part(plane));
        let anew = || Plane::new(self.default_section_plane().point, normal);
        SectionView {
            is_on: true,
            plane: Some(plane.unwrap_or_else(anew)),
            ..section
        }
    }

    /// The section once other parts are there: a plane that is shown and meets neither is put anew, across the same
    /// direction.
    pub(in crate::app) fn section_of_parts(&self) -> SectionView {
        match self.inspect.section.shown() {
            Some(plane) => self.section_across(&plane.normal),
            None => self.inspect.section,
        }
    }

    fn meets_a_part(&self, plane: &Plane) -> bool {
        let boxes = Role::ALL.map(|role| self.bounds_of(role));
        boxes
            .iter()
            .any(|bounds| !bounds.is_empty() && plane.meets(bounds))
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
    /// The mean edge length of the part with the finer elements; 1 without one.
    pub fn finest_element(&self) -> f64 {
        let parts = Role::ALL.into_iter();
        let sizes = parts.filter_map(|role| Some(self.part(role)?.facts.edge_length));
        let finest = sizes.fold(f64::INFINITY, f64::min);
        if finest.is_finite() { finest } else { 1.0 }
    }

    /// A tenth of an element, the step of the section plane by keys.
    pub fn section_step(&self) -> f64 {
        0.1 * self.finest_element()
    }
}
