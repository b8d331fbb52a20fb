//! How far the parts lie apart: what is measured, how it is coloured, labels and the section plane. Distances between
//! two points.

mod apply;
mod coloring;
mod command;
mod distance;
mod section;

pub use coloring::Coloring;
pub use command::InspectCommand;
pub use distance::DistanceTool;
pub use section::SectionView;

use self::coloring::own_limit;
use super::{AppState, BottomTab, ColorBy, Document, OfParts, Shared};
use crate::assess::deviation::{DeviationStats, OneWay, OverlapClass};
use crate::colormap::ColorScale;
use crate::geometry::{Point3, Similarity};
use crate::jobs::{JobKey, Stamp};
use crate::pipeline::inspect::Comparison;
use crate::role::Role;

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

/// A place that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct LookedAt {
    /// Revision of the part it is on.
    part: u64,
    /// Where it is, in the part's own frame.
    pub point: Point3,
    /// What is said about it.
    pub text: String,
}

/// The comparison of both parts, the section plane and the distance between two points.
#[derive(Debug, Clone, Default)]
pub struct InspectState {
    /// The section plane.
    pub section: SectionView,
    /// The tool that measures between two points, while it is on.
    pub distance: Option<DistanceTool>,
    /// The last comparison of both parts, up to date or not.
    pub compared: Option<OfParts<Shared<Comparison>>>,
    /// The end of the automatic range of the map. It stays while the stamped part is moved by hand from where it was
    /// matched, so that colours and shares can be compared with those before.
    limit: Option<OfParts<f64>>,
    /// The place that was looked at last; marked until something else is.
    place: Option<LookedAt>,
    /// The state at which a comparison failed or was cancelled.
    gave_up_comparing: Option<Stamp>,
}

impl InspectState {
    /// The last comparison of the parts that are loaded, up to date or not.
    fn comparison(&self, document: &Document) -> Option<&Comparison> {
        let comparison = self.compared.as_ref()?.current(document)?;
        Some(comparison)
    }

    /// True if the comparison is that of this pose and the levels in use.
    fn is_current(&self, document: &Document, shown: &Similarity) -> bool {
        let Some(comparison) = self.comparison(document) else {
            return false;
        };
        let has = |role: Role| {
            let mesh = document.part(role).map(|part| part.reduced_mesh());
            mesh.is_some_and(|mesh| comparison.drawn(mesh).is_some())
        };
        comparison.crash_from_stamped == *shown && Role::ALL.into_iter().all(has)
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

impl InspectState {
    /// Ends the mark at the place that was looked at; true if there was one.
    pub(super) fn forget_place(&mut self) -> bool {
        self.place.take().is_some()
    }
}

impl AppState {
    /// The place that was looked at last, with its part.
    pub fn looked_at(&self) -> Option<(Role, &LookedAt)> {
        let place = self.inspect.place.as_ref()?;
        Some((self.document.role_of(place.part)?, place))
    }

    /// The last comparison of the parts that are loaded, up to date or not.
    pub fn comparison(&self) -> Option<&Comparison> {
        self.inspect.comparison(&self.document)
    }

    /// The colours of the deviation, if it was measured.
    pub fn deviation_scale(&self) -> Option<ColorScale> {
        let comparison = self.comparison()?;
        let limit = self.held_limit().unwrap_or_else(|| own_limit(comparison));
        let coloring = &self.view.display.coloring;
        Some(coloring.deviation_scale(comparison.deviation.is_signed, limit))
    }

    /// True if the automatic range of the map is that of the pose before the stamped part was moved.
    pub fn is_range_held(&self) -> bool {
        let held = self.held_limit();
        held.is_some() && held != self.comparison().map(own_limit)
    }

    fn held_limit(&self) -> Option<f64> {
        self.inspect
            .limit
            .as_ref()?
            .current(&self.document)
            .copied()
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
        self.inspect.is_current(&self.document, &self.shown_pose())
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

    /// Deviation at a label; `None` where it is not known or the other part is not there.
    pub fn label_value(&self, label: &Label) -> Option<f64> {
        let field = &self.deviation_of(self.document.role_of(label.part)?)?.field;
        let vertex = label.vertex as usize;
        (vertex < field.signed.len()).then(|| field.compared(vertex))?
    }

    /// The same in words: that the other part is missing there, or a dash without a comparison.
    pub fn label_text(&self, label: &Label) -> String {
        match self.label_value(label) {
            Some(value) => self.lengths().signed_of(value),
            None if self.comparison().is_none() => "–".to_owned(),
            None => OverlapClass::OnlyHere.label().to_owned(),
        }
    }
}
