//! What deviation, overlap, section and labels change.

use std::sync::Arc;

use crate::app::inspect::Compared;
use crate::app::{AppState, Effect, InspectCommand, Label};
use crate::geometry::{Aabb, Point3, Vector3};
use crate::jobs::{CompareInput, JobKey, JobKind, Stamp};
use crate::pipeline::inspect::Comparison;
use crate::role::{PerRole, Role};

/// How much of the part is in view around a place that is looked at.
const CLOSE: f64 = 0.12;

impl AppState {
    pub(super) fn apply_inspect(&mut self, command: InspectCommand) -> Vec<Effect> {
        match command {
            InspectCommand::Update => {
                self.gave_up_comparing = None;
                return self.compare();
            }
            InspectCommand::Pin(role, point) => self.pin(role, &point),
            InspectCommand::Rename { id, name, gesture } => {
                self.commit_in("Rename label", Some(gesture), |document| {
                    if let Some(label) = document.labels.iter_mut().find(|l| l.id == id) {
                        label.name = name;
                    }
                });
            }
            InspectCommand::Remove(id) => {
                self.commit("Remove label", |d| d.labels.retain(|label| label.id != id));
            }
            InspectCommand::RemoveAll => {
                self.commit("Remove all labels", |document| document.labels.clear());
            }
            InspectCommand::LookAt(role, point) => self.look_at(role, &point),
        }
        Vec::new()
    }

    /// Asks for a comparison where something shows it and it is quick enough.
    pub(super) fn keep_comparing(&mut self) -> Vec<Effect> {
        if self.should_compare() {
            self.compare()
        } else {
            Vec::new()
        }
    }

    fn compare(&mut self) -> Vec<Effect> {
        let Some((crash, stamped)) = self.document.both() else {
            return Vec::new();
        };
        let input = CompareInput {
            levels: PerRole {
                crash: crash
                    .level
                    .as_ref()
                    .map(|level| Arc::clone(&level.level.mesh)),
                stamped: stamped
                    .level
                    .as_ref()
                    .map(|level| Arc::clone(&level.level.mesh)),
            },
            parts: PerRole::new(crash, stamped).map(|part| part.loaded.to_arc()),
            crash_from_stamped: self.shown_pose(),
        };
        if self.jobs.is_active(JobKey::Compare) {
            return Vec::new();
        }
        vec![self.start(JobKind::Compare(input))]
    }

    pub(super) fn take_compared(&mut self, comparison: Arc<Comparison>, stamp: Stamp) {
        self.compared = Some(Compared {
            parts: stamp.parts,
            comparison: comparison.into(),
        });
    }

    /// A label at the node next to a point; one that is there already stays the only one.
    fn pin(&mut self, role: Role, point: &Point3) {
        let Some(part) = self.document.part(role) else {
            return;
        };
        let positions = part.loaded.mesh.positions();
        let distance = |p: &Point3| (p - point).norm_squared();
        let nearest = positions
            .iter()
            .enumerate()
            .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
        let Some((vertex, position)) = nearest else {
            return;
        };
        let vertex = vertex as u32;
        let (revision, position) = (part.revision, *position);
        let is_there = |label: &Label| label.part == revision && label.vertex == vertex;
        if self.document.labels.iter().any(is_there) {
            return;
        }
        let node = part.loaded.node_id(vertex);
        let id = self.next_revision();
        let name = match node {
            Some(node) => format!("Label at node {node}"),
            None => "Label".to_owned(),
        };
        self.commit(name, |document| {
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

    fn look_at(&mut self, role: Role, point: &Point3) {
        let Some(part) = self.document.part(role) else {
            return;
        };
        let at = match role {
            Role::Crash => *point,
            Role::Stamped => self.shown_pose().apply(point),
        };
        let window = if self.view.is_moved_over {
            Role::Crash
        } else {
            role
        };
        let half = Vector3::repeat(CLOSE / 2.0 * part.bounds().diagonal());
        let around = Aabb::of_points(&[at - half, at + half]);
        self.view.focus = window;
        self.fit(window, &around.corners());
    }
}
