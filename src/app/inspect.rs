//! How far the parts lie apart: what is measured, how it is coloured, labels and the section plane.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{AppState, BottomTab, ColorBy, Document, GestureId, Shared};
use crate::assess::deviation::{DeviationStats, OneWay};
use crate::colormap::{ColorMap, ColorScale};
use crate::geometry::{Plane, Point3, Vector3};
use crate::jobs::{JobKey, Stamp};
use crate::pipeline::inspect::Comparison;
use crate::role::{PerRole, Role};

/// A comparison as quick as this follows every move of the hand.
const LIVE: Duration = Duration::from_millis(100);
/// A comparison as quick as this follows by itself once the part rests.
const BY_ITSELF: Duration = Duration::from_secs(3);

/// Choices about the colours of distances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Coloring {
    /// Which parts carry the deviation.
    pub on: PerRole<bool>,
    /// The map of values with a sign.
    pub signed_map: ColorMap,
    /// The map of all other values.
    pub map: ColorMap,
    /// Maps are turned round.
    pub is_reversed: bool,
    /// So many plain colours instead of a smooth map.
    pub n_bands: Option<u8>,
    /// A pattern tells the sign too, for grey prints.
    pub has_pattern: bool,
    /// Values at the ends of the deviation's colours; `None` follows the values.
    pub limits: Option<[f64; 2]>,
    /// Half width of the neutral band; `None` follows the limits.
    pub tolerance: Option<f64>,
}

impl Default for Coloring {
    fn default() -> Self {
        Self {
            on: PerRole {
                crash: false,
                stamped: true,
            },
            signed_map: ColorMap::CoolWarm,
            map: ColorMap::Viridis,
            is_reversed: false,
            n_bands: None,
            has_pattern: false,
            limits: None,
            tolerance: None,
        }
    }
}

impl Coloring {
    /// Puts the chosen map on a scale that is not that of the deviation.
    pub fn on_scale(&self, scale: ColorScale) -> ColorScale {
        ColorScale {
            map: self.map,
            n_bands: self.n_bands,
            reversed: self.is_reversed,
            ..scale
        }
    }

    /// The colours of a deviation.
    pub fn deviation_scale(&self, comparison: &Comparison) -> ColorScale {
        let deviation = &comparison.deviation;
        let ways = [&deviation.source_on_target, &deviation.target_on_source];
        let limit = ways.map(|way| way.stats.round_limit());
        let limit = limit[0].max(limit[1]);
        let is_signed = deviation.is_signed;
        let [min, max] = match self.limits {
            Some(limits) => limits,
            None if is_signed => [-limit, limit],
            None => [0.0, limit],
        };
        let reach = max.abs().max(min.abs());
        ColorScale {
            tolerance: self.tolerance.unwrap_or_else(|| round_quarter(reach)),
            n_bands: self.n_bands,
            reversed: self.is_reversed,
            has_pattern: self.has_pattern,
            ..ColorScale::new(if is_signed { self.signed_map } else { self.map }, min, max)
        }
    }
}

/// A quarter of a length, rounded down to 1, 2 or 5 times a power of ten.
fn round_quarter(length: f64) -> f64 {
    let quarter = length / 4.0;
    if !(quarter > 0.0 && quarter.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(quarter.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|digit| digit * power);
    let fits = steps.into_iter().find(|&s| s <= quarter * (1.0 + 1e-9));
    fits.unwrap_or(power)
}

/// A value pinned to a node. Part of the document, so that undo knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Never given twice.
    pub id: u64,
    /// Revision of the part it is pinned to.
    pub part: u64,
    /// Vertex of the full mesh.
    pub vertex: u32,
    /// The node in the deck.
    pub node: Option<u64>,
    /// Where the vertex is, in the part's own frame.
    pub position: Point3,
    /// What the user calls it; may be empty.
    pub name: String,
}

/// What becomes of labels, and what is looked at.
#[derive(Debug, Clone, PartialEq)]
pub enum InspectCommand {
    /// Measure the deviation at the shown pose.
    Update,
    /// Pin a label to the node next to a point of the part's own frame.
    Pin(Role, Point3),
    /// Call a label so.
    Rename {
        /// Which label.
        id: u64,
        /// What it is called.
        name: String,
        /// The typing it belongs to.
        gesture: GestureId,
    },
    /// Take a label away.
    Remove(u64),
    /// Take all labels away.
    RemoveAll,
    /// Bring a point of the part's own frame close into view.
    LookAt(Role, Point3),
}

/// How much the shown deviation can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Nothing was measured yet.
    Missing,
    /// It is that of the shown pose and levels.
    Current,
    /// It is of another pose or level; the right one is being measured.
    Updating,
    /// It is of another pose or level.
    OutOfDate,
}

/// A comparison with the parts it was made of.
#[derive(Debug, Clone)]
pub struct Compared {
    /// Revisions of the parts.
    pub parts: PerRole<u64>,
    /// The numbers.
    pub comparison: Shared<Comparison>,
}

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
}

impl Document {
    /// The part of that revision, if it is loaded.
    pub fn role_of(&self, revision: u64) -> Option<Role> {
        let has = |role: &Role| self.part(*role).is_some_and(|p| p.revision == revision);
        Role::ALL.into_iter().find(has)
    }

    /// Labels of parts that are loaded, oldest first.
    pub fn shown_labels(&self) -> impl Iterator<Item = (Role, &Label)> {
        let labels = self.labels.iter();
        labels.filter_map(|label| Some((self.role_of(label.part)?, label)))
    }
}

impl AppState {
    /// The last comparison of the parts that are loaded, up to date or not.
    pub fn comparison(&self) -> Option<&Comparison> {
        let parts = self.document.stamp().parts;
        let compared = self.compared.as_ref().filter(|c| c.parts == parts)?;
        Some(&compared.comparison)
    }

    /// One direction of the comparison: from the nodes of `role` to the other part.
    pub fn deviation_of(&self, role: Role) -> Option<&OneWay> {
        let deviation = &self.comparison()?.deviation;
        Some(match role {
            Role::Crash => &deviation.target_on_source,
            Role::Stamped => &deviation.source_on_target,
        })
    }

    /// The numbers the legend speaks of: those of the coloured part, the stamped one if both are.
    pub fn deviation_stats(&self) -> Option<(Role, &DeviationStats)> {
        let on = &self.view.display.coloring.on;
        let role = if on.crash && !on.stamped {
            Role::Crash
        } else {
            Role::Stamped
        };
        Some((role, &self.deviation_of(role)?.stats))
    }

    /// Whether the comparison is that of what is shown.
    pub fn freshness(&self) -> Freshness {
        match self.comparison() {
            None if self.jobs.is_active(JobKey::Compare) => Freshness::Updating,
            None => Freshness::Missing,
            Some(_) if self.is_comparison_current() => Freshness::Current,
            Some(_) if self.jobs.is_active(JobKey::Compare) => Freshness::Updating,
            Some(_) => Freshness::OutOfDate,
        }
    }

    fn is_comparison_current(&self) -> bool {
        let Some(comparison) = self.comparison() else {
            return false;
        };
        let has = |role: Role| {
            let mesh = self.document.part(role).map(|part| part.reduced_mesh());
            mesh.is_some_and(|mesh| comparison.drawn(mesh).is_some())
        };
        comparison.crash_from_stamped == self.shown_pose() && Role::ALL.into_iter().all(has)
    }

    /// True if something on the screen shows distances between the parts.
    pub fn wants_comparison(&self) -> bool {
        let is_measured = |by| matches!(by, ColorBy::Deviation | ColorBy::Overlap);
        let is_shown = Role::ALL
            .into_iter()
            .any(|window| is_measured(self.color_by(window)))
            || self.view.tab == BottomTab::Deviation;
        is_shown && self.document.both().is_some()
    }

    /// True if a comparison should be asked for now, without the user asking.
    pub(super) fn should_compare(&self) -> bool {
        if !self.wants_comparison()
            || self.is_comparison_current()
            || self.jobs.is_active(JobKey::Compare)
            || self.locking_job().is_some()
            || self.gave_up_comparing == Some(self.document.stamp())
        {
            return false;
        }
        let is_moving = self.grab.is_some() || self.is_preview();
        match self.comparison() {
            None => true,
            Some(last) if is_moving => last.took < LIVE,
            Some(last) => last.took < BY_ITSELF,
        }
    }

    /// Deviation at a label; `None` where it is not known or the other part is not there.
    pub fn label_value(&self, label: &Label) -> Option<f64> {
        let field = &self.deviation_of(self.document.role_of(label.part)?)?.field;
        let vertex = label.vertex as usize;
        (vertex < field.signed.len()).then(|| field.compared(vertex))?
    }

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

    /// A tenth of an element, the step of the section plane by keys.
    pub fn section_step(&self) -> f64 {
        let parts = Role::ALL.into_iter();
        let sizes = parts.filter_map(|role| Some(self.document.part(role)?.facts.edge_length));
        let finest = sizes.fold(f64::INFINITY, f64::min);
        if finest.is_finite() {
            0.1 * finest
        } else {
            0.1
        }
    }

    /// The section with its plane turned to a direction, through the same point.
    pub fn section_across(&self, normal: &Vector3) -> SectionView {
        let plane = self.view.section.plane;
        let plane = plane.unwrap_or_else(|| self.default_section_plane());
        SectionView {
            is_on: true,
            plane: Some(Plane::new(plane.point, normal)),
            ..self.view.section
        }
    }

    /// The section with its plane moved along its normal.
    pub fn section_moved(&self, way: f64) -> Option<SectionView> {
        let plane = self.view.section.shown()?;
        let point = plane.point + plane.normal * way;
        Some(SectionView {
            plane: Some(Plane { point, ..plane }),
            ..self.view.section
        })
    }

    /// The section on or off; at first across the longest side of the parts.
    pub fn section_toggled(&self) -> SectionView {
        let section = self.view.section;
        SectionView {
            is_on: !section.is_on,
            plane: Some(
                section
                    .plane
                    .unwrap_or_else(|| self.default_section_plane()),
            ),
            ..section
        }
    }

    /// Remembers that a comparison failed or was cancelled, so that it is not asked for again and
    /// again.
    pub(super) fn give_up_comparing(&mut self, stamp: Stamp) {
        self.gave_up_comparing = Some(stamp);
    }
}

#[cfg(test)]
mod tests {
    use super::round_quarter;

    #[test]
    fn tolerances_are_round() {
        let rounded = [2.0, 1.0, 0.5, 5.0, 10.0, 0.8, 0.0, f64::INFINITY].map(round_quarter);
        assert_eq!(rounded, [0.5, 0.2, 0.1, 1.0, 2.0, 0.2, 0.0, 0.0]);
    }
}
