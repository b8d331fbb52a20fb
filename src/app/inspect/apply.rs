//! What deviation, overlap, section, labels and distances change.

use std::sync::Arc;
use std::time::Duration;

use super::coloring::own_limit;
use super::{InspectCommand, InspectState, Label, LookedAt};
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{Document, Effect, OfParts};
use crate::geometry::{Point3, Similarity};
use crate::jobs::{CompareInput, JobKey, JobKind, Stamp};
use crate::pipeline::inspect::Comparison;
use crate::role::Role;
use crate::search::ClosestPoint as _;

/// A comparison as quick as this follows every move of the hand.
const LIVE: Duration = Duration::from_millis(100);
/// A comparison as quick as this follows by itself once the part rests.
const BY_ITSELF: Duration = Duration::from_secs(3);

impl InspectState {
    /// `shown` is the pose the stamped part is drawn at.
    pub(in crate::app) fn apply(
        &mut self,
        work: &mut Work<'_>,
        command: InspectCommand,
        shown: &Similarity,
    ) -> Vec<Effect> {
        match command {
            InspectCommand::FitRange => self.limit = None,
            InspectCommand::Update => {
                self.gave_up_comparing = None;
                return compare(work, shown);
            }
            InspectCommand::Pin(role, point) => pin(work, role, &point),
            InspectCommand::Rename { id, name, gesture } => {
                work.commit_in("Rename label", Some(gesture), |document| {
                    if let Some(label) = document.labels.iter_mut().find(|l| l.id == id) {
                        label.name = name;
                    }
                });
            }
            InspectCommand::Remove(id) => {
                work.commit("Remove label", |d| d.labels.retain(|label| label.id != id));
            }
            InspectCommand::RemoveAll => {
                work.commit("Remove all labels", |document| document.labels.clear());
            }
            InspectCommand::LookAt { role, point, text } => {
                let part = work.document.part(role);
                self.place = part.map(|part| LookedAt {
                    part: part.revision,
                    point,
                    text,
                });
                work.follow(FollowUp::LookAt(role, point));
            }
            InspectCommand::ToggleDistance => self.toggle_distance(work),
            InspectCommand::MeasureTo(role, point) => self.measure_to(work.document, role, point),
            InspectCommand::SetSection(section) => {
                if self.section.is_on != section.is_on {
                    work.follow(FollowUp::SectionToggled);
                }
                self.section = section;
            }
        }
        Vec::new()
    }

    /// Asks for a comparison where something shows it and it is quick enough.
    pub(in crate::app) fn keep_comparing(
        &self,
        work: &mut Work<'_>,
        shown: &Similarity,
        is_moving: bool,
    ) -> Vec<Effect> {
        if self.should_compare(work, shown, is_moving) {
            compare(work, shown)
        } else {
            Vec::new()
        }
    }

    /// True if a comparison should be asked for now, without the user asking.
    fn should_compare(&self, work: &Work<'_>, shown: &Similarity, is_moving: bool) -> bool {
        if self.is_current(work.document, shown)
            || work.jobs.is_active(JobKey::Compare)
            || work.jobs.locking_job().is_some()
            || self.gave_up_comparing == Some(work.document.stamp())
        {
            return false;
        }
        match self.comparison(work.document) {
            None => true,
            Some(last) if is_moving => last.took < LIVE,
            Some(last) => last.took < BY_ITSELF,
        }
    }

    /// Remembers that a comparison failed or was cancelled, so that it is not asked for again and
    /// again.
    pub(in crate::app) fn give_up_comparing(&mut self, stamp: Stamp) {
        self.gave_up_comparing = Some(stamp);
    }

    pub(in crate::app) fn take_compared(
        &mut self,
        document: &Document,
        comparison: Arc<Comparison>,
    ) {
        let is_moved = document.result.is_some() && document.current_result().is_none();
        let held = self
            .limit
            .take()
            .filter(|limit| is_moved && limit.current(document).is_some());
        let limit = held.unwrap_or_else(|| OfParts::new(document, own_limit(&comparison)));
        self.limit = Some(limit);
        self.compared = Some(OfParts::new(document, comparison.into()));
    }
}

fn compare(work: &mut Work<'_>, shown: &Similarity) -> Vec<Effect> {
    let Some(both) = work.document.both() else {
        return Vec::new();
    };
    let input = CompareInput {
        levels: both.map(|part| {
            let level = part.level.as_ref();
            level.map(|level| Arc::clone(&level.level.mesh))
        }),
        parts: both.map(|part| part.loaded.to_arc()),
        crash_from_stamped: *shown,
    };
    if work.jobs.is_active(JobKey::Compare) {
        return Vec::new();
    }
    vec![work.start(JobKind::Compare(input))]
}

/// A label at the node next to a point, of the triangle that the point lies on; one that is there already stays the
/// only one.
fn pin(work: &mut Work<'_>, role: Role, point: &Point3) {
    let Some(part) = work.document.part(role) else {
        return;
    };
    let tree = part.loaded.surface.bvh();
    let Some(hit) = tree.closest(point, f64::INFINITY, None, None) else {
        return;
    };
    let (mesh, revision) = (&part.loaded.mesh, part.revision);
    let corners = mesh.triangles()[hit.triangle as usize];
    let corners = corners.map(|vertex| (vertex, mesh.positions()[vertex as usize]));
    let distance = |corner: &(u32, Point3)| (corner.1 - point).norm_squared();
    let [first, others @ ..] = corners;
    let nearer = |a, b| if distance(&b) < distance(&a) { b } else { a };
    let (vertex, position) = others.into_iter().fold(first, nearer);
    let is_there = |label: &Label| label.part == revision && label.vertex == vertex;
    if work.document.labels.iter().any(is_there) {
        return;
    }
    let node = part.loaded.node_id(vertex);
    let id = work.history.next_revision();
    let name = match node {
        Some(node) => format!("Label at node {node}"),
        None => "Label".to_owned(),
    };
    work.commit(name, |document| {
        document.labels.push(Label {
            id,
            part: revision,
            vertex,
            node,
            position,
            name: String::new(),
        });
    });
}
