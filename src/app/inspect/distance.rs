//! The distance between two points that are picked on the sheets.

use super::InspectState;
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{AppState, Document};
use crate::geometry::{Point3, Vector3};
use crate::role::Role;

/// A point within this share of its radius is the centre of a hole: what was picked went through poses.
const AT_CENTER: f64 = 1e-6;

/// A point to measure from or to. It goes with its part.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DistanceEnd {
    /// Revision of the part it is on.
    part: u64,
    /// Where it is, in the part's own frame.
    point: Point3,
}

/// The tool that measures distances, while it is on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DistanceTool {
    /// The points that were picked: none, the first, or both.
    ends: Vec<DistanceEnd>,
}

impl InspectState {
    pub(super) fn toggle_distance(&mut self, work: &mut Work<'_>) {
        let begins = self.distance.is_none() && work.document.has_any_part().is_ok();
        self.distance = begins.then(DistanceTool::default);
        if begins {
            work.follow(FollowUp::DistanceBegun);
        }
    }

    /// Takes a point of a part's own frame; after two of them it is the first one again.
    pub(super) fn measure_to(&mut self, document: &Document, role: Role, point: Point3) {
        if let (Some(tool), Some(part)) = (&mut self.distance, document.part(role)) {
            if tool.ends.len() == 2 {
                tool.ends.clear();
            }
            let part = part.revision;
            tool.ends.push(DistanceEnd { part, point });
        }
    }

    /// Points on a part that was replaced or removed are forgotten; without any part the tool ends.
    pub(in crate::app) fn keep_distance(&mut self, document: &Document) {
        let is_gone = |end: &DistanceEnd| document.role_of(end.part).is_none();
        if document.has_any_part().is_err() {
            self.distance = None;
        } else if let Some(tool) = &mut self.distance
            && tool.ends.iter().any(is_gone)
        {
            tool.ends.clear();
        }
    }
}

impl AppState {
    /// True while a click in a 3D window takes a point, for a pair or for a distance.
    pub fn is_picking(&self) -> bool {
        self.pairs.tool.is_some() || self.inspect.distance.is_some()
    }

    /// The points that were picked to measure between, each with its part and in that part's frame: none, the first,
    /// or both.
    pub fn distance_ends(&self) -> Vec<(Role, Point3)> {
        let ends = self.inspect.distance.iter().flat_map(|tool| &tool.ends);
        let with_role = |end: &DistanceEnd| Some((self.document.role_of(end.part)?, end.point));
        ends.filter_map(with_role).collect()
    }

    /// What the next click is for, while distances are measured.
    pub fn distance_prompt(&self) -> Option<&'static str> {
        let tool = self.inspect.distance.as_ref()?;
        Some(match tool.ends.len() {
            1 => "Click the second point",
            _ => "Click the first point",
        })
    }

    /// The distance that was measured, once both points are picked, as [`Self::distance_texts`] writes it.
    pub fn measured_distance(&self) -> Option<[String; 2]> {
        let ends = self.distance_ends().try_into().ok()?;
        Some(self.distance_texts(ends))
    }

    /// The way from one point to the other along the axes of the crash part, with the stamped part where it is shown.
    fn distance_way(&self, ends: [(Role, Point3); 2]) -> Vector3 {
        let [from, to] = ends.map(|(role, point)| match role {
            Role::Crash => point,
            Role::Stamped => self.shown_pose().apply(&point),
        });
        to - from
    }

    /// Which of two ends of a distance are centres of round holes, if any is.
    pub fn distance_holes(&self, ends: [(Role, Point3); 2]) -> Option<&'static str> {
        match ends.map(|(role, point)| self.is_hole_center(role, &point)) {
            [true, true] => Some("centre of hole to centre of hole"),
            [true, false] => Some("from centre of hole"),
            [false, true] => Some("to centre of hole"),
            [false, false] => None,
        }
    }

    fn is_hole_center(&self, role: Role, point: &Point3) -> bool {
        let part = self.document.part(role);
        let holes = part
            .into_iter()
            .flat_map(|part| part.facts.landmarks.values())
            .flat_map(|landmarks| &landmarks.holes);
        let mut holes = holes.map(|hole| (hole.center - point).norm() <= AT_CENTER * hole.radius);
        holes.any(|is_there| is_there)
    }

    /// The distance between two points, and what it is along each axis of the crash part.
    pub fn distance_texts(&self, ends: [(Role, Point3); 2]) -> [String; 2] {
        let way = self.distance_way(ends);
        let [from, to] = ends.map(|(role, _)| role);
        let lengths = if from == to {
            self.lengths_of(from)
        } else {
            self.lengths()
        };
        let along = |axis: &str, length| format!("Δ{axis}\u{a0}{}", lengths.signed(length));
        let axes = [along("x", way.x), along("y", way.y), along("z", way.z)];
        [lengths.of(way.norm()), axes.join("  ") + lengths.suffix()]
    }
}
