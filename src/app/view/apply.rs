//! What cameras, windows, panels and display choices change.

use std::collections::BTreeSet;

use super::{BottomTab, Display, FitRooms, Fitted, Section, ViewCommand, ViewRoom, ViewState};
use crate::app::{AppState, Document, Part, PartRef, ShownFile, facts};
use crate::geometry::{Aabb, Camera, Point3, Similarity, Vector3};
use crate::pipeline::load::LoadedPart;
use crate::registration::starts::Start;
use crate::role::Role;

/// Nodes that a camera is fitted to at most; those between them lie within the margin.
const MAX_FITTED: usize = 20_000;
/// How much of the part is in view around a place that is looked at.
const CLOSE: f64 = 0.12;
/// Windows that are compared have one scale, unless one part needs a picture so many times as high as the other: it
/// would leave that one too small to be seen.
const ONE_SCALE: f64 = 2.0;

/// What there is to be seen.
pub(in crate::app) struct Scene<'a> {
    pub document: &'a Document,
    /// The pose the stamped part is drawn at.
    pub pose: Similarity,
    /// The first poses, while one of them is shown.
    pub starts: &'a [Start],
    pub selected: &'a BTreeSet<PartRef>,
    /// The further stamped files that are drawn with the first one.
    pub further: Vec<ShownFile>,
    /// The right window shows something with the camera of the left one.
    pub is_beside: bool,
    /// The left window shows what was mapped from the part in the right one.
    pub are_compared: bool,
}

impl ViewState {
    pub(in crate::app) fn apply(&mut self, command: ViewCommand, scene: &Scene<'_>) {
        match command {
            ViewCommand::SetCamera(..)
            | ViewCommand::Standard(..)
            | ViewCommand::LookFrom(..)
            | ViewCommand::PreviousCamera(_)
            | ViewCommand::ToggleProjection(_)
            | ViewCommand::FitAll(_)
            | ViewCommand::FitBoth
            | ViewCommand::Focus(_)
            | ViewCommand::ToggleLink => self.apply_camera(&command, scene),
            ViewCommand::SetOrbitStyle(style) => self.orbit_style = style,
            ViewCommand::SetPivot(role, pivot) => *self.pivot.get_mut(role) = pivot,
            ViewCommand::SetFocus(role) => self.focus = role,
            ViewCommand::SetRoom(role, room) => self.set_room(role, room, scene),
            ViewCommand::ShowFile(file, is_shown) => {
                if is_shown {
                    self.hidden_files.remove(&file);
                } else {
                    self.hidden_files.insert(file);
                }
            }
            ViewCommand::ToggleMoveOver => self.toggle_move_over(scene),
            ViewCommand::SetShown(shown) => self.shown = shown,
            ViewCommand::SetBlinking(is_blinking) => self.is_blinking = is_blinking,
            ViewCommand::SetDisplay(display) => self.set_display(*display),
            ViewCommand::SetTab(tab) => self.set_tab(tab),
            ViewCommand::SetFreeWindow(free) => self.free_window = Some(free),
            ViewCommand::OpenSection(section, is_open) => {
                self.sections.set_open(section, is_open);
            }
            ViewCommand::ShowSection(section) => self.show_section(section),
            ViewCommand::ShowMoveByHand => {
                self.show_section(Section::Match);
                self.n_asked_by_hand += 1;
            }
            ViewCommand::UseSection(section) => self.sections.ask_for(section),
            ViewCommand::ToggleGraphicsOnly => {
                self.is_graphics_only = !self.is_graphics_only;
            }
            ViewCommand::FoldColumn(is_folded) => self.column = Some(is_folded),
            ViewCommand::SetColumnRoom(room) => {
                self.column_room = room;
                self.column = None;
            }
            ViewCommand::SetDialog(dialog) => self.dialog = dialog,
        }
    }

    fn set_display(&mut self, mut display: Display) {
        if display.mapped != self.display.mapped {
            // Limits of differences are those of one quantity.
            display.limits.retain(|by, _| !by.speaks_of_quantity());
        }
        let before = self.display.color_by;
        if display.color_by.is_match_map() && !before.is_match_map() {
            self.colors_before_map = before;
        }
        self.display = display;
    }

    fn show_section(&mut self, section: Section) {
        self.is_graphics_only = false;
        self.column = Some(false);
        self.sections.set_open(section, true);
    }

    fn apply_camera(&mut self, command: &ViewCommand, scene: &Scene<'_>) {
        match *command {
            ViewCommand::SetCamera(role, camera) => self.set_camera(role, camera),
            ViewCommand::Standard(role, view) => {
                self.turn_camera(role, scene, |camera| camera.set_standard_view(view));
            }
            ViewCommand::LookFrom(role, direction) => {
                self.turn_camera(role, scene, |camera| camera.look_from(direction));
            }
            ViewCommand::PreviousCamera(role) => {
                let previous = *self.previous_cameras.get(role);
                self.remember_camera(role);
                self.set_camera(role, previous);
            }
            ViewCommand::ToggleProjection(role) => {
                let mut camera = *self.cameras.get(role);
                camera.toggle_projection();
                self.set_camera(role, camera);
            }
            ViewCommand::FitAll(role) => self.fit_all(role, scene),
            ViewCommand::FitBoth => self.fit_both(scene),
            ViewCommand::Focus(role) => match self.selected_bounds(role, scene) {
                Some(bounds) => self.fit_window(role, &bounds.corners(), scene),
                None => self.fit_all(role, scene),
            },
            ViewCommand::ToggleLink => self.toggle_link(scene),
            _ => {}
        }
    }

    fn turn_camera(&mut self, role: Role, scene: &Scene<'_>, turn: impl FnOnce(&mut Camera)) {
        self.remember_camera(role);
        let mut camera = *self.cameras.get(role);
        let is_whole = self.is_as_close_as_fitted(role);
        turn(&mut camera);
        self.set_camera(role, camera);
        // What was seen whole is seen whole from there too.
        if is_whole {
            self.fit_again(role, scene);
        }
    }

    fn toggle_link(&mut self, scene: &Scene<'_>) {
        self.are_linked = !self.are_linked;
        let (role, camera) = (self.focus, *self.cameras.get(self.focus));
        let follows_by_itself = self.is_fitted(role.other());
        self.set_camera(role, camera);
        if self.are_linked && follows_by_itself {
            self.note_fitted(role.other());
        }
        // What took over the zoom of the other window, and was moved by nobody, shows its own part whole again.
        if !self.are_linked {
            for role in Role::ALL {
                self.keep_whole(role, scene);
            }
        }
    }

    fn fit_window(&mut self, role: Role, points: &[Point3], scene: &Scene<'_>) {
        if !points.is_empty() {
            self.remember_camera(role);
            let room = self.room(role, scene);
            self.fit(role, points, &room);
        }
    }

    /// The room for a window's picture; one camera may serve two windows.
    fn room(&self, role: Role, scene: &Scene<'_>) -> ViewRoom {
        let own = *self.rooms.get(role);
        let other = self.rooms.get(role.other());
        let is_shared = role == Role::Crash && scene.is_beside;
        if is_shared || scene.are_compared && own.has_shape_of(other) {
            own.shared(other)
        } else {
            own
        }
    }

    /// Fits a fitted window again, with the place for a legend that it was fitted with.
    fn fit_again(&mut self, role: Role, scene: &Scene<'_>) {
        let rooms = self.rooms_again(role, scene);
        self.refit(role, rooms, scene);
    }

    fn rooms_again(&self, role: Role, scene: &Scene<'_>) -> FitRooms {
        let now = self.room(role, scene);
        let fitted = self.fitted.get(role).as_ref();
        fitted.map_or(FitRooms::new(now), |fitted| {
            now.keeping_legend_of(&fitted.first_room)
        })
    }

    /// Takes over the shape of a window and what lies over it; what was seen whole stays so. A legend that comes up
    /// would cover the part, also where the camera was turned by hand: it then shows the part whole again, from the
    /// same side.
    fn set_room(&mut self, role: Role, room: ViewRoom, scene: &Scene<'_>) {
        let before = std::mem::replace(self.rooms.get_mut(role), room);
        let of = self.camera_of(role);
        let covers_part = room.has_legend_where_free(&before) && self.is_as_close_as_fitted(of);
        // A line more in the header.
        let may_stay = self.is_moved_by_hand && room.aspect == before.aspect;
        if covers_part || self.is_fitted(of) && !may_stay {
            self.fit_again(of, scene);
        }
    }

    /// The stamped part was moved by hand.
    pub(in crate::app) fn stay(&mut self) {
        self.is_moved_by_hand = true;
    }

    /// What a window shows whole stays so, once it shows more.
    pub(in crate::app) fn keep_whole(&mut self, role: Role, scene: &Scene<'_>) {
        let of = self.camera_of(role);
        if self.is_fitted(of) {
            self.fit_again(of, scene);
        }
    }

    /// True while the user has brought nothing closer since a window was fitted: its camera was at most turned or
    /// shifted.
    fn is_as_close_as_fitted(&self, role: Role) -> bool {
        let fitted = self.fitted.get(role).as_ref();
        fitted.is_some_and(|fitted| fitted.camera.height == self.cameras.get(role).height)
    }

    /// Fits what a window shows, tightly: a turned sheet fills the picture better than its box.
    pub(in crate::app) fn fit_all(&mut self, role: Role, scene: &Scene<'_>) {
        self.remember_camera(role);
        let rooms = FitRooms::new(self.room(role, scene));
        self.refit(role, rooms, scene);
    }

    /// Linked cameras share their zoom: the window that has the keys is fitted last, so that it shows all.
    pub(in crate::app) fn fit_both(&mut self, scene: &Scene<'_>) {
        for role in [self.focus.other(), self.focus] {
            self.fit_all(role, scene);
        }
    }

    fn refit(&mut self, role: Role, rooms: FitRooms, scene: &Scene<'_>) {
        self.is_moved_by_hand = false;
        let other = role.other();
        let is_other_fitted = self.is_fitted(other);
        self.fit_to(role, rooms, scene);
        if scene.are_compared && is_other_fitted {
            let rooms = self.rooms_again(other, scene);
            let height = self.cameras.get(role).height;
            self.fit_to(other, rooms, scene);
            // A linked one has followed.
            self.cameras.get_mut(role).height = height;
            self.give_one_scale(scene);
        }
    }

    fn fit_to(&mut self, role: Role, rooms: FitRooms, scene: &Scene<'_>) {
        let other = role.other();
        // A linked camera comes along, moved by nobody.
        let is_other_fitted = self.are_linked && self.is_fitted(other);
        self.fit(role, &self.points(role, scene), &rooms.now);
        *self.fitted.get_mut(role) = Some(Fitted {
            camera: *self.cameras.get(role),
            first_room: rooms.first,
        });
        if is_other_fitted {
            self.note_fitted(other);
        }
    }

    /// Gives both windows the scale of the one that shows more. What each shows stays in the middle of its room.
    fn give_one_scale(&mut self, scene: &Scene<'_>) {
        let heights = Role::ALL.map(|role| self.cameras.get(role).height);
        let [low, high] = [heights[0].min(heights[1]), heights[0].max(heights[1])];
        for role in Role::ALL {
            if self.are_linked || high <= ONE_SCALE * low {
                let points = self.points(role, scene);
                self.cameras.get_mut(role).zoom_out_about(&points, high);
            }
            self.note_fitted(role);
        }
    }

    /// The present camera of a window counts as the one it was fitted with.
    fn note_fitted(&mut self, role: Role) {
        let camera = *self.cameras.get(role);
        if let Some(fitted) = self.fitted.get_mut(role) {
            fitted.camera = camera;
        }
    }

    /// What a window is fitted to.
    fn points(&self, role: Role, scene: &Scene<'_>) -> Vec<Point3> {
        let stamped_pose = stamped_pose(role, scene);
        let mut points = Vec::new();
        for of in self.shown_in(role) {
            if let Some(part) = scene.document.part(*of) {
                let pose = match of {
                    Role::Crash => Similarity::identity(),
                    Role::Stamped => stamped_pose,
                };
                points.extend(visible_points(part, pose));
            }
        }
        if self.shown_in(role).contains(&Role::Stamped) {
            for file in &scene.further {
                points.extend(spread(&file.loaded, file.own_pose.unwrap_or(stamped_pose)));
            }
        }
        // One camera sees all first poses, and stays where it is from one to the next.
        let stamped = scene.document.part(Role::Stamped);
        if let Some(part) = stamped.filter(|_| role == Role::Crash) {
            let corners = part.bounds().corners();
            let poses = scene.starts.iter().map(|start| start.target_from_source);
            points.extend(poses.flat_map(|pose| corners.map(|corner| pose.apply(&corner))));
        }
        // So it does with the poses that fit as well.
        let shared = stamped.filter(|_| role == Role::Crash && self.is_moved_over);
        let result = scene.document.current_result();
        for (part, result) in shared.into_iter().zip(result) {
            let equal = (0..facts::n_alternatives(&result.run)).map(Some);
            let poses = std::iter::once(None).chain(equal);
            let poses = poses.filter_map(|pose| result.run.pose(pose));
            points.extend(poses.flat_map(|pose| spread(&part.loaded, pose)));
        }
        points
    }

    /// The parts a window shows.
    fn shown_in(&self, role: Role) -> &'static [Role] {
        match role {
            Role::Crash if self.is_moved_over => &Role::ALL,
            Role::Crash => &[Role::Crash],
            Role::Stamped => &[Role::Stamped],
        }
    }

    /// Box around the selected parts that a window shows, if there are any.
    fn selected_bounds(&self, role: Role, scene: &Scene<'_>) -> Option<Aabb> {
        let mut all = Aabb::empty();
        let here = self.shown_in(role);
        for selected in scene.selected.iter().filter(|p| here.contains(&p.role)) {
            let part = scene.document.part(selected.role);
            let bounds = part.and_then(|part| part.facts.part_bounds.get(&selected.id));
            if let Some(bounds) = bounds.filter(|bounds| !bounds.is_empty()) {
                all = all.union(&match selected.role {
                    Role::Crash => *bounds,
                    Role::Stamped => moved_box(bounds, &stamped_pose(role, scene)),
                });
            }
        }
        (!all.is_empty()).then_some(all)
    }

    pub(in crate::app) fn toggle_move_over(&mut self, scene: &Scene<'_>) {
        let can_move_over = scene.document.has_both_parts().is_ok();
        if self.is_moved_over {
            self.is_moved_over = false;
            self.focus = Role::Stamped;
        } else if can_move_over {
            self.is_moved_over = true;
            self.focus = Role::Crash;
        }
        if self.is_moved_over || self.are_linked {
            self.fit_all(Role::Crash, scene);
        } else {
            self.fit_both(scene);
        }
    }

    fn set_tab(&mut self, tab: BottomTab) {
        self.tab = tab;
        self.is_graphics_only = false;
    }

    /// The first look at a part: its own camera, or both windows when moved over.
    pub(in crate::app) fn fit_after_load(&mut self, role: Role, scene: &Scene<'_>) {
        if role == Role::Stamped {
            self.look_at_sheet(scene);
        }
        self.fit_part(role, scene);
    }

    /// Shows a part whole from where it is seen, or both when moved over.
    pub(in crate::app) fn fit_part(&mut self, role: Role, scene: &Scene<'_>) {
        self.fit_all(role, scene);
        if self.is_moved_over {
            self.fit_all(Role::Crash, scene);
        }
    }

    /// Brings a point of a part's own frame close into view.
    pub(in crate::app) fn look_at(&mut self, role: Role, point: &Point3, scene: &Scene<'_>) {
        let Some(part) = scene.document.part(role) else {
            return;
        };
        let window = if self.is_moved_over {
            Role::Crash
        } else {
            role
        };
        let at = match role {
            Role::Crash => *point,
            Role::Stamped => stamped_pose(window, scene).apply(point),
        };
        let half = Vector3::repeat(CLOSE / 2.0 * part.bounds().diagonal());
        let around = Aabb::of_points(&[at - half, at + half]);
        self.focus = window;
        self.fit_window(window, &around.corners(), scene);
    }

    /// A stamped part comes in the axes of its die: look along its mean normal.
    fn look_at_sheet(&mut self, scene: &Scene<'_>) {
        let Some(part) = scene.document.part(Role::Stamped) else {
            return;
        };
        let normal = part.facts.mean_normal;
        if self.are_linked || self.is_moved_over || normal.norm() == 0.0 {
            return;
        }
        let pose = *scene.document.crash_from_stamped();
        let corners = part.bounds().corners().map(|corner| pose.apply(&corner));
        let direction = -pose.rotate(&normal);
        self.cameras.stamped.look_along(&direction, &corners);
    }
}

impl AppState {
    /// What a window shows, in its own space: the left one that of the crash model, the right one
    /// that of the crash model too, with the stamped part at its pose.
    pub fn visible_bounds(&self, role: Role) -> Aabb {
        let is_over = self.view.is_moved_over;
        let mut bounds = Aabb::empty();
        if role == Role::Crash {
            bounds = bounds.union(&self.bounds_of(Role::Crash));
        }
        if role == Role::Stamped || is_over {
            bounds = bounds.union(&self.bounds_of(Role::Stamped));
            for file in self.shown_further() {
                let pose = file.own_pose.unwrap_or_else(|| self.shown_pose());
                let points: Vec<Point3> = spread(&file.loaded, pose).collect();
                bounds = bounds.union(&Aabb::of_points(&points));
            }
        }
        bounds
    }

    /// Box around a part in the space of the crash model; empty if it is not loaded.
    pub(in crate::app) fn bounds_of(&self, role: Role) -> Aabb {
        let Some(part) = self.document.part(role) else {
            return Aabb::empty();
        };
        match role {
            Role::Crash => part.bounds(),
            Role::Stamped => moved_box(&part.bounds(), &self.shown_pose()),
        }
    }
}

/// Where a window shows the stamped part: its own where it really is, also while the other one tries out poses.
fn stamped_pose(window: Role, scene: &Scene<'_>) -> Similarity {
    match window {
        Role::Crash => scene.pose,
        Role::Stamped => *scene.document.crash_from_stamped(),
    }
}

/// Points of what is shown of a part, where it is drawn: spread over all of it, or the corners of the boxes of those
/// parts of the deck that are not hidden.
fn visible_points(part: &Part, pose: Similarity) -> Vec<Point3> {
    let boxes = part.facts.part_bounds.iter();
    let shown = boxes.filter(|(id, bounds)| part.is_visible(**id) && !bounds.is_empty());
    let corners = shown.flat_map(|(_, bounds)| bounds.corners());
    let corners: Vec<Point3> = corners.map(|corner| pose.apply(&corner)).collect();
    if part.hidden.is_empty() || corners.is_empty() {
        return spread(&part.loaded, pose).collect();
    }
    corners
}

/// Points spread over a part, where it is drawn.
fn spread(part: &LoadedPart, pose: Similarity) -> impl Iterator<Item = Point3> {
    let positions = part.mesh.positions();
    let step = positions.len().div_ceil(MAX_FITTED).max(1);
    positions
        .iter()
        .step_by(step)
        .map(move |point| pose.apply(point))
}

/// Box around a moved box.
fn moved_box(bounds: &Aabb, pose: &Similarity) -> Aabb {
    if bounds.is_empty() {
        return *bounds;
    }
    Aabb::of_points(&bounds.corners().map(|corner| pose.apply(&corner)))
}
