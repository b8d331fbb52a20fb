//! Which parts a window shows, where, and how they look: from the state, without a mesh in sight.

use super::frame::ViewFrame;
use super::meshes::MeshSource;
use crate::app::{AppState, ColorBy, FreeWindow, Part, PartRef, ShownFile, ShownGeometry};
use crate::geometry::{Similarity, Vector3};
use crate::render::{PartLook, Style, WipeSide};
use crate::role::Role;
use crate::ui::theme::Look;

/// Opacity of the crash part when one sees through it.
const SEE_THROUGH: f32 = 0.2;
/// Opacity of a part without colours of its own before or behind one that shows the deviation.
pub(super) const GHOST: f32 = 0.15;
/// Opacity of the stamped part while something else than its real pose is shown.
const PREVIEW: f32 = 0.62;

/// One part in one window.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PartInstance {
    pub role: Role,
    /// The further stamped file that it is; `None` for the crash part and the first stamped part.
    pub further: Option<ShownFile>,
    pub world_from_part: Similarity,
    /// Shift for display only.
    pub offset: Vector3,
    pub opacity: f32,
    pub is_detailed: bool,
    pub wipe: WipeSide,
    /// Grey, so that its own colour is not taken for one of the map.
    pub is_ghost: bool,
}

impl PartInstance {
    /// Grey and faint from now on.
    fn fade(&mut self) {
        self.is_ghost = true;
        self.opacity = self.opacity.min(GHOST);
    }

    /// Its mesh; `None` if it is not loaded. A further stamped file has no levels.
    pub fn source(&self, state: &AppState) -> Option<MeshSource> {
        if let Some(file) = &self.further {
            return Some(MeshSource::full(file.loaded.to_arc()));
        }
        let part = state.document.part(self.role)?;
        Some(MeshSource::of(part, self.is_detailed))
    }

    /// Its number among the stamped files; the crash part has that of the first too.
    pub fn number(&self) -> usize {
        self.further.as_ref().map_or(0, |file| file.number)
    }
}

/// What a line across the window separates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Divider {
    /// Crash left, stamped right.
    Wipe(f32),
    /// Reduced left, full right.
    Split(f32),
}

impl Divider {
    /// Place of the line as a share of the width.
    pub fn share(self) -> f32 {
        match self {
            Self::Wipe(share) | Self::Split(share) => share,
        }
    }
}

/// The line across a window, if it has one: the wipe where both parts are, else the split.
pub(super) fn divider(state: &AppState, view: &ViewFrame) -> Option<Divider> {
    let display = &state.view.display;
    let is_shared = view.window == Role::Crash && state.view.is_moved_over;
    let wipe = if state.is_mapping_apart() {
        state.mapped_wipe()
    } else {
        display.wipe
    };
    let wipe = wipe.filter(|_| is_shared).map(Divider::Wipe);
    let is_beside = free_window(state, view).is_some();
    let split = display
        .split
        .filter(|_| has_level(state, view.window) && !is_beside);
    wipe.or(split.map(Divider::Split))
}

fn has_level(state: &AppState, window: Role) -> bool {
    let reduced = |role| state.document.part(role).is_some_and(|p| p.level.is_some());
    reduced(window) || (state.view.is_moved_over && reduced(Role::Stamped))
}

/// The parts of a window, crash first.
pub(super) fn visible_parts(state: &AppState, view: &ViewFrame) -> Vec<PartInstance> {
    if let Some(free) = free_window(state, view) {
        let mut parts = beside(state, view, free);
        fade(state, view, &mut parts);
        return parts;
    }
    let mut parts = Vec::new();
    // The mapped part stands alone, its stamped part beside it, unless both are compared in one window.
    let is_apart = view.over >= 1.0 && state.is_mapping_apart();
    let is_blinked_away = is_apart && state.is_mapped_blinking();
    if view.window == Role::Crash && state.document.part(Role::Crash).is_some() && !is_blinked_away
    {
        parts.push(crash(state));
    }
    if is_blinked_away || is_apart && state.mapped_wipe().is_some() {
        parts.extend(all_files(state, full(Role::Stamped, view.pose)));
    } else if state.document.part(Role::Stamped).is_some() && !is_apart {
        let first = stamped(state, view).into_iter();
        parts.extend(first.flat_map(|first| all_files(state, first)));
    }
    fade(state, view, &mut parts);
    match divider(state, view) {
        Some(Divider::Wipe(_)) => {
            for instance in &mut parts {
                instance.wipe = match instance.role {
                    Role::Crash => WipeSide::Left,
                    Role::Stamped => WipeSide::Right,
                };
            }
            parts
        }
        Some(Divider::Split(_)) => parts.iter().flat_map(both_sides).collect(),
        None => parts,
    }
}

/// The parts that a section cuts in the shared window though it does not draw them: the outlines are those of both
/// parts, whichever of them the mapping or a blink leaves out.
pub(super) fn only_cut(
    state: &AppState,
    view: &ViewFrame,
    drawn: &[PartInstance],
) -> Vec<PartInstance> {
    let is_shared = view.window == Role::Crash && view.over >= 1.0 && state.view.is_moved_over;
    if !is_shared || state.inspect.section.shown().is_none() {
        return Vec::new();
    }
    let is_left_out = |role: &Role| {
        let is_drawn = drawn.iter().any(|instance| instance.role == *role);
        state.document.part(*role).is_some() && !is_drawn
    };
    let left_out = Role::ALL.into_iter().filter(is_left_out);
    left_out
        .flat_map(|role| match role {
            Role::Crash => vec![crash(state)],
            Role::Stamped => all_files(state, full(role, view.pose)),
        })
        .collect()
}

/// Makes ghosts of the parts that would hide or tint the colours of another one.
fn fade(state: &AppState, view: &ViewFrame, parts: &mut [PartInstance]) {
    let is_full = free_window(state, view) == Some(FreeWindow::FullMesh);
    let is_shared = state.view.is_moved_over && (view.window == Role::Crash || is_full);
    let by = state.color_by(view.window);
    let colored = &state.view.display.coloring.on;
    let is_wiped = matches!(divider(state, view), Some(Divider::Wipe(_)));
    // Of two sheets that lie in each other the colours of one would show through those of the other at random.
    let is_quantity = by == ColorBy::Thickness || by.forming().is_some();
    let shows_quantity = is_quantity && !state.is_mapping_shown() && !is_wiped;
    let has_stamped = parts.iter().any(|part| part.role == Role::Stamped);
    for instance in parts.iter_mut() {
        let hides = match by {
            _ if shows_quantity && has_stamped => is_shared && instance.role == Role::Crash,
            ColorBy::Deviation => is_shared && !*colored.get(instance.role),
            // Only the stamped part has one; the crash part would hide half of it.
            ColorBy::Uncertainty => is_shared && instance.role == Role::Crash,
            _ => false,
        };
        // Distances are those of the first stamped part, and so is the uncertainty of its pose.
        if hides || by.is_match_map() && instance.further.is_some() {
            instance.fade();
        }
    }
    // Colours that are seen through colours of another part are those of neither in the legend.
    let is_map = !matches!(by, ColorBy::Role | ColorBy::Part) && !state.is_mapping_shown();
    let is_looked_through = is_map && !is_wiped && crash_opacity(state) < 1.0;
    let is_behind = |part: &PartInstance| part.role == Role::Stamped && !part.is_ghost;
    if is_looked_through && parts.iter().any(is_behind) {
        for instance in parts.iter_mut().filter(|part| part.role == Role::Crash) {
            instance.is_ghost = true;
            if state.view.display.is_see_through {
                instance.fade();
            }
        }
    }
}

/// What the right window is used for, once its part has left it.
pub(super) fn free_window(state: &AppState, view: &ViewFrame) -> Option<FreeWindow> {
    let is_free = view.window == Role::Stamped && view.over >= 1.0;
    state.free_window().filter(|_| is_free)
}

/// The parts beside the shared window.
fn beside(state: &AppState, view: &ViewFrame, free: FreeWindow) -> Vec<PartInstance> {
    let instance = |role, world_from_part| PartInstance {
        is_detailed: matches!(free, FreeWindow::FullMesh | FreeWindow::Stamped)
            || is_detailed(state),
        ..full(role, world_from_part)
    };
    let pose = match free {
        FreeWindow::Alternative => state.other_pose().unwrap_or(view.pose),
        _ => view.pose,
    };
    let both = [(Role::Crash, Similarity::identity()), (Role::Stamped, pose)];
    let parts = both.map(|(role, pose)| instance(role, pose)).into_iter();
    let colored = &state.view.display.coloring.on;
    let is_shown = |instance: &PartInstance| match free {
        FreeWindow::Nothing | FreeWindow::Section => false,
        FreeWindow::Deviation => *colored.get(instance.role),
        FreeWindow::Stamped => instance.role == Role::Stamped,
        FreeWindow::FullMesh | FreeWindow::Alternative => true,
    };
    let parts = parts.filter(is_shown);
    match free {
        FreeWindow::FullMesh | FreeWindow::Stamped => parts
            .flat_map(|instance| match instance.role {
                Role::Crash => vec![instance],
                Role::Stamped => all_files(state, instance),
            })
            .collect(),
        // Another pose of the first one, and what is measured from it.
        _ => parts.collect(),
    }
}

/// The first stamped part as it is drawn and the further files beside it, each at its own pose; without
/// those that are hidden.
fn all_files(state: &AppState, first: PartInstance) -> Vec<PartInstance> {
    let further = state.shown_further().into_iter();
    let further = further.map(|file| PartInstance {
        world_from_part: file.own_pose.unwrap_or(first.world_from_part),
        is_detailed: true,
        further: Some(file),
        ..first.clone()
    });
    let further: Vec<_> = further.collect();
    let first = Some(first).filter(|_| !state.is_first_file_hidden());
    first.into_iter().chain(further).collect()
}

/// A part as full mesh, as it is.
fn full(role: Role, world_from_part: Similarity) -> PartInstance {
    PartInstance {
        role,
        further: None,
        world_from_part,
        offset: Vector3::zeros(),
        opacity: 1.0,
        is_detailed: true,
        wipe: WipeSide::Both,
        is_ghost: false,
    }
}

/// A part as reduced on the left of the line and as full mesh on its right.
fn both_sides(instance: &PartInstance) -> [PartInstance; 2] {
    let side = |is_detailed, wipe| PartInstance {
        is_detailed,
        wipe,
        ..instance.clone()
    };
    [side(false, WipeSide::Left), side(true, WipeSide::Right)]
}

/// Opacity of the crash part.
pub(super) fn crash_opacity(state: &AppState) -> f32 {
    let display = &state.view.display;
    if display.is_see_through {
        display.opacity.crash.min(SEE_THROUGH)
    } else {
        display.opacity.crash
    }
}

fn crash(state: &AppState) -> PartInstance {
    PartInstance {
        role: Role::Crash,
        further: None,
        world_from_part: Similarity::identity(),
        offset: Vector3::zeros(),
        opacity: crash_opacity(state),
        // The elements of a mapping are those of the full mesh.
        is_detailed: is_detailed(state) || state.is_mapping_shown(),
        wipe: WipeSide::Both,
        is_ghost: false,
    }
}

fn stamped(state: &AppState, view: &ViewFrame) -> Option<PartInstance> {
    let is_left = view.window == Role::Crash;
    let is_over = state.view.is_moved_over;
    let is_previewed_left = is_left && !is_over && view.over <= 0.0 && state.is_preview();
    let is_here = if is_left {
        view.over > 0.0
    } else {
        view.over < 1.0
    };
    let is_blinked_away = is_left && is_over && state.view.is_blinking;
    if is_blinked_away || !(is_here || is_previewed_left) {
        return None;
    }
    let mut opacity = state.view.display.opacity.stamped;
    let mut offset = Vector3::zeros();
    if is_left {
        if state.is_preview() {
            opacity = opacity.min(PREVIEW);
        }
        offset += separation(state, view);
    }
    if !is_previewed_left {
        offset += flight_offset(view);
    }
    // Its own window shows the part where it really is, also while the other tries out poses.
    let is_real = !is_left && state.is_preview();
    let world_from_part = if is_real {
        *state.document.crash_from_stamped()
    } else {
        view.pose
    };
    Some(PartInstance {
        role: Role::Stamped,
        further: None,
        world_from_part,
        offset,
        opacity,
        is_detailed: is_detailed(state),
        wipe: WipeSide::Both,
        is_ghost: false,
    })
}

fn is_detailed(state: &AppState) -> bool {
    let is_blinking = state.view.is_blinking && !state.view.is_moved_over;
    is_blinking || state.view.shown == ShownGeometry::Detailed
}

/// The part leaves one window through the edge between them and enters the other there.
fn flight_offset(view: &ViewFrame) -> Vector3 {
    let width = view.camera.height * view.aspect;
    let share = match view.window {
        Role::Crash => 1.0 - view.over,
        Role::Stamped => -view.over,
    };
    view.camera.right() * (width * share)
}

/// The shift that lets one look between the sheets: along the mean normal, or towards the viewer
/// for parts without one.
fn separation(state: &AppState, view: &ViewFrame) -> Vector3 {
    let distance = state.view.display.separation;
    let Some(part) = state.document.part(Role::Stamped) else {
        return Vector3::zeros();
    };
    let normal = view.pose.rotate(&part.facts.mean_normal);
    let direction = normal.try_normalize(0.05).unwrap_or(-view.camera.forward());
    direction * distance
}

/// Looks of the parts of a deck, by their index.
pub(super) fn part_looks(state: &AppState, part: &Part, role: Role, look: &Look) -> Vec<PartLook> {
    let is_by_part = state.view.display.color_by == ColorBy::Part;
    // Where there is nothing to choose between, lighting everything up would only flicker.
    let has_choice = part.facts.used.len() > 1;
    let model_parts = part.loaded.model.parts.iter().enumerate();
    let looks = model_parts.map(|(index, model_part)| {
        let id = model_part.id;
        let given = part.colors.get(&id).copied();
        PartLook {
            color: given.or_else(|| is_by_part.then(|| look.part(index))),
            visible: part.is_visible(id),
            selected: state.parts.selected.contains(&PartRef { role, id }),
            hovered: has_choice && state.parts.hovered == Some(PartRef { role, id }),
        }
    });
    looks.collect()
}

/// What is drawn of a mesh.
pub(super) fn style(state: &AppState, view: &ViewFrame) -> Style {
    let display = &state.view.display;
    if view.is_bare {
        return Style {
            surface: false,
            ..Style::default()
        };
    }
    Style {
        element_edges: display.has_edges,
        feature_edges: display.has_feature_edges,
        borders: display.has_feature_edges,
        points: display.has_points,
        ..Style::default()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::formats::Model;
    use crate::geometry::{Camera, Point3, TriMesh};
    use crate::jobs::{PartFacts, PartSource};
    use crate::monitor::Monitor;
    use crate::pipeline::load::{LoadSettings, prepare};
    use crate::role::PerRole;

    /// A window with a triangle as each of the parts, the stamped one moved over.
    fn moved_over() -> AppState {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]].map(Point3::from);
        let mesh = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let model = Arc::new(Model::from_mesh(&mesh, "triangle"));
        let path = Path::new("triangle.k");
        let (settings, monitor) = (LoadSettings::default(), Monitor::silent());
        let part = |revision| {
            let part = prepare(path, Arc::clone(&model), &settings, &monitor).unwrap();
            let facts = PartFacts::of(&part, &monitor).unwrap();
            let source = PartSource::File(path.to_path_buf());
            Some(Part::new(Arc::new(part), Arc::new(facts), source, revision))
        };
        let mut state = AppState::default();
        state.document.parts = PerRole {
            crash: part(1),
            stamped: part(2),
        };
        state.view.is_moved_over = true;
        state
    }

    /// Which parts the left window shows as ghosts.
    fn ghosts(state: &AppState) -> Vec<Role> {
        let view = ViewFrame {
            window: Role::Crash,
            camera: Camera::default(),
            aspect: 1.0,
            pose: Similarity::identity(),
            over: 1.0,
            is_bare: false,
        };
        let parts = visible_parts(state, &view);
        assert_eq!(parts.len(), 2);
        let ghosts = parts.iter().filter(|part| part.is_ghost);
        ghosts.map(|part| part.role).collect()
    }

    #[test]
    fn colours_of_a_map_are_seen_through_grey_alone() {
        let mut state = moved_over();
        for by in [ColorBy::Overlap, ColorBy::Deviation, ColorBy::Thickness] {
            state.view.display.color_by = by;
            state.view.display.coloring.on = PerRole {
                crash: true,
                stamped: true,
            };
            // Both sheets have a thickness, and lie in each other.
            let hidden = (by == ColorBy::Thickness).then_some(Role::Crash);
            assert_eq!(ghosts(&state), Vec::from_iter(hidden), "{by:?}");
            state.view.display.is_see_through = true;
            assert_eq!(ghosts(&state), [Role::Crash], "{by:?}");
            // Left and right of a line nothing is seen through.
            state.view.display.wipe = Some(0.5);
            assert_eq!(ghosts(&state), [], "{by:?}");
            state.view.display.wipe = None;
            state.view.display.is_see_through = false;
        }
        state.view.display.opacity.crash = 0.5;
        assert_eq!(ghosts(&state), [Role::Crash]);
        // The part that has the colours keeps them.
        state.view.display.color_by = ColorBy::Deviation;
        state.view.display.coloring.on.stamped = false;
        assert_eq!(ghosts(&state), [Role::Stamped]);
        // Without a map each part has its own colour.
        state.view.display.color_by = ColorBy::Role;
        assert_eq!(ghosts(&state), []);
    }
}
