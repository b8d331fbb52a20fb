//! What cameras, windows, panels and display choices change.

use crate::app::{AppState, BottomTab, Effect, FreeWindow, ViewCommand};
use crate::geometry::{Aabb, Point3, Similarity};
use crate::role::Role;

/// Nodes that a camera is fitted to at most; those between them lie within the margin.
const MAX_FITTED: usize = 20_000;

impl AppState {
    pub(super) fn apply_view(&mut self, command: ViewCommand) -> Vec<Effect> {
        match command {
            ViewCommand::SetCamera(..)
            | ViewCommand::Standard(..)
            | ViewCommand::PreviousCamera(_)
            | ViewCommand::ToggleProjection(_)
            | ViewCommand::FitAll(_)
            | ViewCommand::Focus(_)
            | ViewCommand::ToggleLink => self.apply_camera(&command),
            ViewCommand::SetOrbitStyle(style) => self.view.orbit_style = style,
            ViewCommand::SetPivot(role, pivot) => *self.view.pivot.get_mut(role) = pivot,
            ViewCommand::SetFocus(role) => self.view.focus = role,
            ViewCommand::SetAspect(role, aspect) => *self.view.aspects.get_mut(role) = aspect,
            ViewCommand::ToggleMoveOver => self.toggle_move_over(),
            ViewCommand::SetShown(shown) => self.view.shown = shown,
            ViewCommand::SetBlinking(is_blinking) => self.view.is_blinking = is_blinking,
            ViewCommand::SetDisplay(display) => self.view.display = *display,
            ViewCommand::SetSection(section) => self.view.section = section,
            ViewCommand::SetTab(tab) => self.set_tab(tab),
            ViewCommand::SetFreeWindow(free) => {
                if free == FreeWindow::Section && !self.view.section.is_on {
                    self.view.section = self.section_toggled();
                }
                self.view.free_window = Some(free);
            }
            ViewCommand::OpenSection(section, is_open) => {
                self.view.sections.set_open(section, is_open);
            }
            ViewCommand::UseSection(section) => self.view.sections.touch(section),
            ViewCommand::ToggleGraphicsOnly => {
                self.view.is_graphics_only = !self.view.is_graphics_only;
                self.view.hovered_preview = None;
            }
            ViewCommand::ShowAsLoaded(is_as_loaded) => {
                self.drop_previews();
                self.view.is_as_loaded = is_as_loaded;
            }
            ViewCommand::SetDialog(dialog) => self.view.dialog = dialog,
            ViewCommand::ToggleGizmo => self.view.has_gizmo = !self.view.has_gizmo,
            ViewCommand::SetMoveAxes(axes) => self.view.move_axes = axes,
            ViewCommand::HoverPreview(preview) => {
                self.view.hovered_preview = preview.filter(|_| self.is_unlocked().is_ok());
            }
            ViewCommand::PinPreview(preview) => {
                self.view.pinned_preview = preview.filter(|_| self.is_unlocked().is_ok());
            }
            ViewCommand::ChooseStart(start) => self.view.chosen_start = start,
        }
        Vec::new()
    }

    fn apply_camera(&mut self, command: &ViewCommand) {
        match *command {
            ViewCommand::SetCamera(role, camera) => self.view.set_camera(role, camera),
            ViewCommand::Standard(role, view) => {
                self.view.remember_camera(role);
                let mut camera = *self.view.cameras.get(role);
                camera.set_standard_view(view);
                self.view.set_camera(role, camera);
            }
            ViewCommand::PreviousCamera(role) => {
                let previous = *self.view.previous_cameras.get(role);
                self.view.remember_camera(role);
                self.view.set_camera(role, previous);
            }
            ViewCommand::ToggleProjection(role) => {
                let mut camera = *self.view.cameras.get(role);
                camera.toggle_projection();
                self.view.set_camera(role, camera);
            }
            ViewCommand::FitAll(role) => self.fit_all(role),
            ViewCommand::Focus(role) => match self.selected_bounds(role) {
                Some(bounds) => self.fit(role, &bounds.corners()),
                None => self.fit_all(role),
            },
            ViewCommand::ToggleLink => self.toggle_link(),
            _ => {}
        }
    }

    fn toggle_link(&mut self) {
        self.view.are_linked = !self.view.are_linked;
        let (role, camera) = (self.view.focus, *self.view.cameras.get(self.view.focus));
        self.view.set_camera(role, camera);
    }

    pub(super) fn fit(&mut self, role: Role, points: &[Point3]) {
        let aspect = *self.view.aspects.get(role);
        self.view.fit(role, points, aspect);
    }

    /// Fits what a window shows, tightly: a turned sheet fills the picture better than its box.
    fn fit_all(&mut self, role: Role) {
        let mut points = Vec::new();
        for of in self.shown_in(role) {
            if let Some(part) = self.document.part(*of) {
                let pose = match of {
                    Role::Crash => Similarity::identity(),
                    Role::Stamped => self.shown_pose(),
                };
                let positions = part.loaded.mesh.positions();
                let step = positions.len().div_ceil(MAX_FITTED).max(1);
                points.extend(positions.iter().step_by(step).map(|p| pose.apply(p)));
            }
        }
        self.fit(role, &points);
    }

    /// The parts a window shows.
    fn shown_in(&self, role: Role) -> &'static [Role] {
        match role {
            Role::Crash if self.view.is_moved_over => &Role::ALL,
            Role::Crash => &[Role::Crash],
            Role::Stamped => &[Role::Stamped],
        }
    }

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
        }
        bounds
    }

    fn bounds_of(&self, role: Role) -> Aabb {
        let Some(part) = self.document.part(role) else {
            return Aabb::empty();
        };
        match role {
            Role::Crash => part.bounds(),
            Role::Stamped => moved_box(&part.bounds(), &self.shown_pose()),
        }
    }

    /// Box around the selected parts that a window shows, if there are any.
    fn selected_bounds(&self, role: Role) -> Option<Aabb> {
        let mut all = Aabb::empty();
        let here = self.shown_in(role);
        for selected in self.view.selected.iter().filter(|p| here.contains(&p.role)) {
            let part = self.document.part(selected.role);
            let bounds = part.and_then(|part| part.facts.part_bounds.get(&selected.id));
            if let Some(bounds) = bounds.filter(|bounds| !bounds.is_empty()) {
                all = all.union(&match selected.role {
                    Role::Crash => *bounds,
                    Role::Stamped => moved_box(bounds, &self.shown_pose()),
                });
            }
        }
        (!all.is_empty()).then_some(all)
    }

    fn toggle_move_over(&mut self) {
        let can_move_over = self.has_both_parts().is_ok();
        if self.view.is_moved_over {
            self.view.is_moved_over = false;
            self.view.focus = Role::Stamped;
        } else if can_move_over {
            self.view.is_moved_over = true;
            self.view.focus = Role::Crash;
        }
        self.fit_all(Role::Crash);
    }

    fn set_tab(&mut self, tab: BottomTab) {
        self.view.tab = tab;
        // The list the pointer was on may be gone.
        self.view.hovered_preview = None;
        self.view.is_graphics_only = false;
    }

    /// The first look at a part: its own camera, or both windows when moved over.
    pub(super) fn fit_after_load(&mut self, role: Role) {
        if role == Role::Stamped {
            self.look_at_sheet();
        }
        self.fit_all(role);
        if self.view.is_moved_over {
            self.fit_all(Role::Crash);
        }
    }

    /// A stamped part comes in the axes of its die: look along its mean normal.
    fn look_at_sheet(&mut self) {
        let Some(part) = self.document.part(Role::Stamped) else {
            return;
        };
        let normal = part.facts.mean_normal;
        if self.view.are_linked || normal.norm() == 0.0 {
            return;
        }
        let pose = *self.document.crash_from_stamped();
        let corners = part.bounds().corners().map(|corner| pose.apply(&corner));
        let direction = -pose.rotate(&normal);
        self.view.cameras.stamped.look_along(&direction, &corners);
    }
}

/// Box around a moved box.
fn moved_box(bounds: &Aabb, pose: &Similarity) -> Aabb {
    if bounds.is_empty() {
        return *bounds;
    }
    Aabb::of_points(&bounds.corners().map(|corner| pose.apply(&corner)))
}
