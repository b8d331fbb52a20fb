//! Picking points for pairs and distances: what the pointer snaps to, and the click that takes it.

use egui::{Pos2, Rect};

use super::frame::FrameContext;
use super::navigation::{pixel_of, pos_of, screen_of};
use super::picture::Hit;
use crate::app::{Command, InspectCommand, NoticeCommand, PairCommand, PickKind, PickedPoint};
use crate::geometry::{Camera, Point3};
use crate::role::Role;

/// Nodes and corners catch the pointer within so many points.
const REACH: f32 = 10.0;
/// The middle of a small hole does too; that of a large one from anywhere in it.
const HOLE_REACH: f32 = 14.0;

/// What a click would pick now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pick {
    pub role: Role,
    /// In the space of the part.
    pub picked: PickedPoint,
    /// In the window.
    pub at: Pos2,
}

/// Something a click could pick, in the space of the window.
struct Candidate {
    /// In the window, points.
    at: Pos2,
    point: Point3,
    kind: PickKind,
}

/// A hole or corner near the pointer.
struct Near {
    /// Distance from the pointer, as a part of its reach.
    off: f32,
    candidate: Candidate,
}

/// A hole or corner of the part.
struct Landmark {
    /// In the space of the window.
    point: Point3,
    /// From how far away it catches the pointer, points.
    reach: f32,
    /// How far behind the sheet it may lie, in lengths of the part.
    depth: f64,
    kind: PickKind,
}

/// What lies under the pointer; a click takes it.
pub(super) fn update(frame: &FrameContext<'_>, commands: &mut Vec<Command>) -> Option<Pick> {
    if frame.state.inspect.distance.is_some() {
        return measure(frame, commands);
    }
    PointPicker(frame).update(commands)
}

/// The point that a click would measure from or to.
fn measure(frame: &FrameContext<'_>, commands: &mut Vec<Command>) -> Option<Pick> {
    let end = distance_end(frame)?;
    let last = frame.state.distance_ends().pop();
    let is_last = |pick: &Pick| last == Some((pick.role, pick.picked.point));
    // A double click is one point, not two in one place.
    let is_repeated = frame.response.double_clicked() && end.as_ref().is_ok_and(is_last);
    if frame.response.clicked() && !is_repeated {
        commands.push(match end {
            Ok(Pick { role, picked, .. }) => InspectCommand::MeasureTo(role, picked.point).into(),
            Err(why) => NoticeCommand::Explain(why.to_owned()).into(),
        });
    }
    end.ok()
}

/// The centre of the hole or the node next to the pointer, or else the point of the sheet below it; why none can be
/// taken there.
fn distance_end(frame: &FrameContext<'_>) -> Option<Result<Pick, &'static str>> {
    let pos = frame.response.hover_pos()?;
    let (rect, camera) = (frame.rect(), &frame.view.camera);
    let hit = frame.picture.hit(camera, frame.pixel(pos), frame.screen());
    let hole = hole_center(frame, pos, hit.as_ref());
    let is_first_here = |(role, _): &(Role, Point3)| frame.picture.place_of(*role).is_some();
    let ends = frame.state.distance_ends();
    if hole.is_none() && hit.as_ref()?.further.is_some() {
        return Some(Err(
            "Distances are measured on the crash part and the first stamped part",
        ));
    }
    if frame.shows_other_pose() {
        return Some(Err(
            "The stamped part is shown at another pose here: measure in the left window",
        ));
    }
    if ends.len() == 1 && !ends.iter().all(is_first_here) {
        return Some(Err(
            "The first point lies in the other window: Move over shows both parts in one",
        ));
    }
    let (role, Candidate { at, point, kind }) = match hole {
        Some(hole) => hole,
        None => {
            let hit = hit.as_ref()?;
            (hit.role, snapped(rect, camera, pos, hit)?)
        }
    };
    let point = frame.picture.place_of(role)?.to_part(&point);
    let picked = PickedPoint { point, kind };
    Some(Ok(Pick { role, picked, at }))
}

/// The nearest centre of a hole within reach in the parts that are shown.
fn hole_center(
    frame: &FrameContext<'_>,
    pos: Pos2,
    hit: Option<&Hit>,
) -> Option<(Role, Candidate)> {
    let picker = PointPicker(frame);
    let near = Role::ALL
        .into_iter()
        .filter_map(|role| Some((role, picker.nearest(picker.holes(role)?, pos, hit)?)));
    let nearest = near.min_by(|(_, a), (_, b)| a.off.total_cmp(&b.off));
    nearest.map(|(role, near)| (role, near.candidate))
}

/// Picking in one frame.
struct PointPicker<'a>(&'a FrameContext<'a>);

impl PointPicker<'_> {
    fn update(&self, commands: &mut Vec<Command>) -> Option<Pick> {
        let pick = self.pick();
        if self.0.response.clicked() {
            if let Some(why) = self.0.state.wrong_pick(self.0.view.window) {
                commands.push(NoticeCommand::Explain(why).into());
            } else if let Some(Pick { role, picked, .. }) = pick {
                let point = picked;
                commands.push(PairCommand::Pick { role, point }.into());
            }
        }
        pick
    }

    /// The part that is asked for in this window: the one of the next click where both are, else the
    /// window's own.
    fn role(&self) -> Option<Role> {
        let (_, asked) = self.0.state.next_pick()?;
        let role = if self.0.state.view.is_moved_over {
            asked
        } else {
            self.0.view.window
        };
        let is_here = self.0.view.window == Role::Crash || !self.0.state.view.is_moved_over;
        is_here.then_some(role)
    }

    fn pick(&self) -> Option<Pick> {
        if self.0.state.is_preview() || self.0.state.jobs.locking_job().is_some() {
            return None;
        }
        let role = self.role()?;
        let pos = self.0.response.hover_pos()?;
        let rect = self.0.rect();
        let pixel = pixel_of(rect, pos);
        let hit = self
            .0
            .picture
            .hit_of(Some(role), &self.0.view.camera, pixel, screen_of(rect));
        let place = self.0.picture.place_of(role)?;
        let Candidate { at, point, kind } = self
            .landmark(role, pos, hit.as_ref())
            .or_else(|| snapped(rect, &self.0.view.camera, pos, hit.as_ref()?))?;
        let picked = PickedPoint {
            point: place.to_part(&point),
            kind,
        };
        Some(Pick { role, picked, at })
    }

    /// The nearest hole or corner within reach that no sheet of the part hides.
    fn landmark(&self, role: Role, pos: Pos2, hit: Option<&Hit>) -> Option<Candidate> {
        let landmarks = self.holes(role)?.chain(self.corners(role)?);
        self.nearest(landmarks, pos, hit).map(|near| near.candidate)
    }

    /// The round holes of what is shown of a part.
    fn holes(&self, role: Role) -> Option<impl Iterator<Item = Landmark>> {
        let place = self.0.picture.place_of(role)?;
        let landmarks = self.0.state.document.part(role)?.shown_landmarks();
        let holes = landmarks.flat_map(|of_part| &of_part.holes);
        Some(holes.map(move |hole| {
            let center = place.to_window(&hole.center);
            let radius = (hole.radius / self.size_at(&center)) as f32;
            Landmark {
                point: center,
                reach: HOLE_REACH.max(0.9 * radius),
                depth: hole.radius,
                kind: PickKind::HoleCenter,
            }
        }))
    }

    /// The corners of its rim.
    fn corners(&self, role: Role) -> Option<impl Iterator<Item = Landmark>> {
        let place = self.0.picture.place_of(role)?;
        let landmarks = self.0.state.document.part(role)?.shown_landmarks();
        let corners = landmarks.flat_map(|of_part| &of_part.corners);
        Some(corners.map(move |corner| Landmark {
            point: place.to_window(corner),
            reach: REACH,
            depth: 0.0,
            kind: PickKind::Corner,
        }))
    }

    /// Length of a pixel at a point.
    fn size_at(&self, point: &Point3) -> f64 {
        let screen = screen_of(self.0.rect());
        self.0.view.camera.pixel_size(screen, point)
    }

    /// The nearest of these within reach that is neither cut away nor behind what the pointer meets.
    fn nearest(
        &self,
        landmarks: impl Iterator<Item = Landmark>,
        pos: Pos2,
        hit: Option<&Hit>,
    ) -> Option<Near> {
        let shown = landmarks.filter(|landmark| !self.0.picture.is_cut_away(&landmark.point));
        let within = shown.filter_map(|landmark| {
            let Landmark {
                point,
                reach,
                depth,
                kind,
            } = landmark;
            let at = pos_of(self.0.rect(), &self.0.view.camera, &point)?;
            let off = at.distance(pos) / reach;
            let slack = depth + f64::from(2.0 * reach) * self.size_at(&point);
            let is_seen = hit.is_none_or(|hit| !self.is_behind(&point, &hit.point, slack));
            let candidate = Candidate { at, point, kind };
            (off < 1.0 && is_seen).then_some(Near { off, candidate })
        });
        within.min_by(|a, b| a.off.total_cmp(&b.off))
    }

    /// True if a point lies farther from the viewer than another by more than `slack`.
    fn is_behind(&self, point: &Point3, other: &Point3, slack: f64) -> bool {
        let ray = self.0.view.camera.ray(
            pixel_of(self.0.rect(), self.0.rect().center()),
            screen_of(self.0.rect()),
            &self.0.picture.bounds,
        );
        (point - other).dot(&ray.direction.normalize()) > slack
    }
}

/// The corner of the triangle under the pointer if it is within reach, else the point of the surface.
fn snapped(rect: Rect, camera: &Camera, pos: Pos2, hit: &Hit) -> Option<Candidate> {
    let at = pos_of(rect, camera, &hit.node)?;
    if at.distance(pos) <= REACH {
        return Some(Candidate {
            at,
            point: hit.node,
            kind: PickKind::Node(hit.node_id),
        });
    }
    Some(Candidate {
        at: pos,
        point: hit.point,
        kind: PickKind::Surface,
    })
}
