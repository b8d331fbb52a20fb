//! The 3D windows: real mouse events in, commands and pictures out. All but one need no adapter.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui::{Event, MouseWheelUnit, PointerButton, Pos2, Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{
    Action, AppState, ColorBy, Command, Effect, FileCommand, FreeWindow, MoveCommand, PartCommand,
    PictureChoice, Settings, ViewCommand,
};
use shapematch::formats::Model;
use shapematch::geometry::camera::{OrbitStyle, ScreenSize};
use shapematch::geometry::{Camera, Point3, TriMesh};
use shapematch::jobs::{
    JobEvent, JobId, JobKind, JobOutput, JobStage, PartFacts, PartSource, PipelineRunner,
    Runner as _,
};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::prepare;
use shapematch::role::Role;
use shapematch::ui::keyboard::Keyboard;
use shapematch::ui::viewport::Viewports;

use super::layout::{Painted, texts};

const SIZE: Vec2 = vec2(640.0, 320.0);

/// A gently bent sheet of 12 × 8 cells.
fn sheet() -> TriMesh {
    let mut positions = Vec::new();
    for i in 0..=12 {
        for j in 0..=8 {
            let (x, y) = (f64::from(i), f64::from(j));
            positions.push(Point3::new(10.0 * x, 10.0 * y, 0.4 * x * x + 0.2 * y));
        }
    }
    let cell = |k: u32| {
        let a = k / 8 * 9 + k % 8;
        [[a, a + 9, a + 10], [a, a + 10, a + 1]]
    };
    TriMesh::new(positions, (0..96).flat_map(cell).collect()).unwrap()
}

/// A program without shell and panels: two windows side by side over a state, with the keys of the window.
pub struct Desk {
    pub state: AppState,
    pub viewports: Viewports,
    keyboard: Keyboard,
    seen: Vec<Command>,
    n_jobs: u64,
}

impl Desk {
    pub fn new(render_state: Option<&RenderState>) -> Self {
        let settings = Settings {
            reduce_motion: true,
            ..Settings::default()
        };
        Self {
            state: AppState::new(settings),
            viewports: Viewports::new(render_state),
            keyboard: Keyboard::default(),
            seen: Vec::new(),
            n_jobs: 0,
        }
    }

    pub fn with_sheets(render_state: Option<&RenderState>) -> Self {
        let mut desk = Self::new(render_state);
        for role in Role::ALL {
            let paths = vec![PathBuf::from("sheet.k")];
            let role = Some(role);
            desk.apply(FileCommand::Open { paths, role }.into());
        }
        desk
    }

    /// Applies a command and does its jobs at once.
    pub fn apply(&mut self, command: Command) {
        for effect in self.state.apply(command) {
            let Effect::StartJob(kind, stamp) = effect else {
                continue;
            };
            self.n_jobs += 1;
            let (id, key) = (JobId(self.n_jobs), kind.key());
            let tell = |stage| JobEvent {
                id,
                key,
                stamp,
                elapsed: std::time::Duration::ZERO,
                stage,
            };
            let started = self.state.apply(tell(JobStage::Started));
            assert!(started.is_empty());
            let output = done(*kind);
            self.apply(tell(JobStage::Finished(output)).into());
        }
    }

    pub fn camera(&self, role: Role) -> Camera {
        *self.state.view.cameras.get(role)
    }
}

/// Files are made up, the rest is real.
fn done(kind: JobKind) -> JobOutput {
    match kind {
        JobKind::Load {
            role,
            source: source @ PartSource::File(_),
            settings,
        } => {
            let model = Arc::new(Model::from_mesh(&sheet(), "sheet"));
            let path = PathBuf::from("sheet.k");
            let part = prepare(&path, model, &settings, &Monitor::silent()).unwrap();
            let facts = Arc::new(PartFacts::of(&part, &Monitor::silent()).unwrap());
            JobOutput::Loaded {
                role,
                source,
                part: Arc::new(part),
                facts,
            }
        }
        other => PipelineRunner.run(other, &Monitor::silent()).unwrap(),
    }
}

pub fn show(ui: &mut egui::Ui, desk: &mut Desk) {
    let (whole, ctx) = (ui.max_rect(), ui.ctx().clone());
    desk.keyboard.begin(&ctx, &desk.state, false);
    let mut commands = Vec::new();
    for role in Role::ALL {
        let area = window(whole, role);
        let builder = egui::UiBuilder::new().max_rect(area).id_salt(role.word());
        ui.scope_builder(builder, |ui| {
            desk.viewports.show(ui, role, &desk.state, &mut commands);
        });
    }
    desk.keyboard.collect(&ctx);
    for command in commands {
        desk.seen.push(command.clone());
        desk.apply(command);
    }
    desk.keyboard.uncover(&desk.state, false);
    while let Some(command) = desk.keyboard.next(&ctx, &desk.state) {
        desk.apply(command);
        ctx.request_repaint();
    }
}

/// The left or right half.
fn window(whole: Rect, role: Role) -> Rect {
    let (left, right) = whole.split_left_right_at_fraction(0.5);
    match role {
        Role::Crash => left,
        Role::Stamped => right,
    }
}

pub fn harness(desk: Desk) -> Harness<'static, Desk> {
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .build_ui_state(show, desk);
    settle(&mut harness);
    harness
}

/// Draws until nothing that the windows show is still made on another thread.
pub fn settle(harness: &mut Harness<'_, Desk>) {
    harness.run_steps(4);
    let begun = Instant::now();
    while harness.state().viewports.is_waiting() {
        assert!(begun.elapsed() < Duration::from_secs(60), "never ready");
        std::thread::sleep(Duration::from_millis(1));
        harness.step();
    }
    harness.run_steps(2);
}

fn press(harness: &Harness<'_, Desk>, pos: Pos2, button: PointerButton, pressed: bool) {
    harness.event(Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: egui::Modifiers::NONE,
    });
}

pub fn drag(harness: &mut Harness<'_, Desk>, button: PointerButton, from: Pos2, to: Pos2) {
    harness.event(Event::PointerMoved(from));
    harness.step();
    press(harness, from, button, true);
    harness.step();
    for step in 1..=4 {
        harness.event(Event::PointerMoved(
            from + (to - from) * (step as f32 / 4.0),
        ));
        harness.step();
    }
    press(harness, to, button, false);
    harness.run_steps(2);
}

/// Two notches of the wheel at a place.
fn turn_wheel(harness: &mut Harness<'_, Desk>, at: Pos2) {
    harness.event(Event::PointerMoved(at));
    harness.step();
    harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, 2.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run_steps(30);
}

fn screen_of(area: Rect) -> ScreenSize {
    ScreenSize {
        width: f64::from(area.width()),
        height: f64::from(area.height()),
    }
}

/// Where the kittest harness draws: its panel keeps a margin.
pub fn area(harness: &Harness<'_, Desk>, role: Role) -> Rect {
    let name = match role {
        Role::Crash => "Crash part",
        Role::Stamped => "Stamped part",
    };
    harness
        .get_by(|node| node.label().is_some_and(|l| l.starts_with(name)))
        .rect()
}

/// What is under the pointer offers what its row in the list does.
#[test]
fn the_menu_of_a_part_in_3d_is_that_of_its_row() {
    let mut harness = harness(Desk::with_sheets(None));
    let pos = area(&harness, Role::Crash).center();
    harness.event(Event::PointerMoved(pos));
    harness.run_steps(2);
    for pressed in [true, false] {
        harness.event(Event::PointerButton {
            pos,
            button: PointerButton::Secondary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        harness.run_steps(2);
    }
    for name in [
        "Hide",
        "Show only this",
        "Show all",
        "Match only this",
        "Find parts like this",
        "Fit selection",
        "Rotate about this point",
    ] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
}

#[test]
fn a_drag_orbits_and_the_grabbed_point_stays() {
    let mut harness = harness(Desk::with_sheets(None));
    let area = area(&harness, Role::Crash);
    let from = area.center();
    let before = harness.state().camera(Role::Crash);
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from + vec2(60.0, 20.0),
    );
    let after = harness.state().camera(Role::Crash);
    assert!(after.world_from_view.angle_to(&before.world_from_view) > 0.3);
    assert_eq!(after.height, before.height);
    let other = harness.state().camera(Role::Stamped);
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from - vec2(60.0, 20.0),
    );
    let back = harness.state().camera(Role::Crash);
    assert!(
        back.world_from_view.angle_to(&before.world_from_view) < 0.2,
        "the way back"
    );
    assert_eq!(
        other,
        harness.state().camera(Role::Stamped),
        "windows are not linked"
    );
}

#[test]
fn the_wheel_zooms_to_the_cursor() {
    let mut harness = harness(Desk::with_sheets(None));
    let area = area(&harness, Role::Crash);
    let at = area.center() + vec2(20.0, 10.0);
    let before = harness.state().camera(Role::Crash);
    let pixel = [f64::from(at.x - area.left()), f64::from(at.y - area.top())];
    let anchor = before.unproject(pixel, screen_of(area), &before.target);
    turn_wheel(&mut harness, at);
    let after = harness.state().camera(Role::Crash);
    assert!(after.height < 0.9 * before.height, "closer");
    let seen = after.project(&anchor, screen_of(area)).unwrap();
    let off = (seen.x - pixel[0]).hypot(seen.y - pixel[1]);
    assert!(
        off < 1.0,
        "the point under the cursor moved by {off} points"
    );
}

#[test]
fn the_middle_button_pans_and_the_right_one_zooms() {
    let mut harness = harness(Desk::with_sheets(None));
    let from = area(&harness, Role::Stamped).center();
    let before = harness.state().camera(Role::Stamped);
    drag(
        &mut harness,
        PointerButton::Middle,
        from,
        from + vec2(40.0, 0.0),
    );
    let panned = harness.state().camera(Role::Stamped);
    assert_eq!(panned.world_from_view, before.world_from_view);
    assert_eq!(panned.height, before.height);
    assert!((panned.target - before.target).norm() > 0.01 * before.height);
    drag(
        &mut harness,
        PointerButton::Secondary,
        from,
        from - vec2(0.0, 60.0),
    );
    let zoomed = harness.state().camera(Role::Stamped);
    assert!(zoomed.height < 0.8 * panned.height, "upwards comes closer");
}

#[test]
fn a_click_selects_the_part_and_beside_it_nothing() {
    let mut harness = harness(Desk::with_sheets(None));
    let area = area(&harness, Role::Crash);
    let mut click = |pos: Pos2| {
        harness.event(Event::PointerMoved(pos));
        harness.step();
        press(&harness, pos, PointerButton::Primary, true);
        press(&harness, pos, PointerButton::Primary, false);
        harness.run_steps(2);
        let state = &harness.state().state;
        (state.parts.selected.first().copied(), state.view.focus)
    };
    let (selected, focus) = click(area.center());
    assert_eq!(selected.map(|part| part.role), Some(Role::Crash));
    assert_eq!(focus, Role::Crash);
    assert_eq!(click(area.left_bottom() + vec2(6.0, -110.0)).0, None);
}

#[test]
fn ctrl_and_click_add_to_the_selection_and_take_from_it() {
    let mut harness = harness(Desk::with_sheets(None));
    let mut click = |role| {
        let pos = area(&harness, role).center();
        harness.event(Event::PointerMoved(pos));
        harness.step();
        harness.event(Event::ModifiersChanged(egui::Modifiers::COMMAND));
        for pressed in [true, false] {
            harness.event(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::COMMAND,
            });
        }
        harness.run_steps(2);
        harness.state().state.parts.selected.len()
    };
    let counts = [Role::Crash, Role::Stamped, Role::Crash].map(&mut click);
    assert_eq!(counts, [1, 2, 1]);
}

#[test]
fn arrow_keys_turn_the_window_that_has_the_focus() {
    let mut harness = harness(Desk::with_sheets(None));
    let before = harness.state().camera(Role::Stamped);
    let is_right = |label: &str| label.starts_with("Stamped part");
    harness
        .get_by(|node| node.label().is_some_and(|l| is_right(&l)))
        .focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::ArrowRight);
    harness.run_steps(2);
    let turned = harness.state().camera(Role::Stamped);
    assert!(turned.world_from_view.angle_to(&before.world_from_view) > 0.05);
    assert_eq!(turned.height, before.height);
    harness.key_press(egui::Key::Minus);
    harness.run_steps(2);
    assert!(harness.state().camera(Role::Stamped).height > before.height);
    assert_eq!(harness.state().state.view.focus, Role::Stamped);
    // Keys of actions reach the window that has the focus.
    harness.key_press(egui::Key::F);
    harness.run_steps(2);
    let state = &harness.state().state;
    assert!(state.view.is_fitted(Role::Stamped));
}

#[test]
fn hovering_names_the_part_and_says_nothing_twice() {
    let mut harness = harness(Desk::with_sheets(None));
    let center = area(&harness, Role::Stamped).center();
    for step in 0..4 {
        harness.event(Event::PointerMoved(center + vec2(step as f32, 0.0)));
        harness.step();
    }
    let hovers = |c: &&Command| matches!(c, Command::Part(PartCommand::Hover(Some(_))));
    assert_eq!(harness.state().seen.iter().filter(hovers).count(), 1);
    // Panics unless the windows come to rest: an idle window draws nothing.
    harness.run();
}

/// A part under the pointer is told to nobody while it moves by keys: the move would end.
#[test]
fn a_move_by_keys_hovers_nothing() {
    for action in [Action::MoveTool, Action::RotateTool] {
        let mut desk = Desk::with_sheets(None);
        let begin = action.command(&desk.state).expect("can move");
        desk.apply(begin);
        let mut harness = harness(desk);
        for role in Role::ALL {
            let center = area(&harness, role).center();
            for step in 0..4 {
                harness.event(Event::PointerMoved(center + vec2(step as f32, 0.0)));
                harness.step();
            }
        }
        let desk = harness.state();
        let hovers = |c: &Command| matches!(c, Command::Part(PartCommand::Hover(_)));
        assert!(!desk.seen.iter().any(hovers), "{action:?}");
        assert!(desk.state.moving.tool.is_some(), "{action:?}");
    }
}

/// Two windows with the gizmo, and its dot, which lies at the centre of the part.
fn with_gizmo() -> (Harness<'static, Desk>, Pos2) {
    let mut desk = Desk::with_sheets(None);
    desk.apply(MoveCommand::ToggleGizmo.into());
    let harness = harness(desk);
    let camera = harness.state().camera(Role::Stamped);
    let area = area(&harness, Role::Stamped);
    let pivot = harness.state().state.document.stamped_center().unwrap();
    let seen = camera.project(&pivot, screen_of(area)).unwrap();
    let dot = area.min + vec2(seen.x as f32, seen.y as f32);
    (harness, dot)
}

/// A slow frame takes the press and the way on together, or even the way to the handle: what was pressed counts.
#[test]
fn a_quick_drag_on_a_handle_moves_the_part_and_not_the_camera() {
    for is_there_before in [true, false] {
        let (mut harness, dot) = with_gizmo();
        let camera = harness.state().camera(Role::Stamped);
        let screen = screen_of(area(&harness, Role::Stamped));
        let pivot = harness.state().state.document.stamped_center().unwrap();
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        let way = vec2(18.0, 24.0);
        let mut events = vec![Event::PointerMoved(dot)];
        if is_there_before {
            harness.input_mut().events.append(&mut events);
            harness.step();
        }
        events.extend([button(dot, true), Event::PointerMoved(dot + way)]);
        harness.input_mut().events.append(&mut events);
        harness.step();
        // Let go in the frame of the last piece of the way.
        events.push(Event::PointerMoved(dot + 2.0 * way));
        events.push(button(dot + 2.0 * way, false));
        events.push(Event::PointerMoved(dot + 5.0 * way));
        harness.input_mut().events.append(&mut events);
        harness.run_steps(3);
        let desk = harness.state();
        assert_eq!(desk.camera(Role::Stamped), camera, "{is_there_before}");
        let name = desk.state.history.undo_name().unwrap_or_default();
        assert!(name.ends_with("in the plane of the screen"), "{name}");
        let seen = camera.project(&pivot, screen).unwrap();
        let at = [seen.x + 36.0, seen.y + 48.0];
        let expected = camera.unproject(at, screen, &pivot) - pivot;
        let moved = desk.state.document.crash_from_stamped().translation;
        let error = (moved - expected).norm() / expected.norm();
        assert!(error < 1e-3, "{moved} for {expected}");
    }
}

#[test]
fn letters_of_the_gizmo_are_never_cut_nor_covered() {
    let (mut harness, _) = with_gizmo();
    let role = Role::Stamped;
    let area = area(&harness, role);
    let pivot = harness.state().state.document.stamped_center().unwrap();
    let [width, height] = [area.width(), area.height()].map(f64::from);
    let [middle, edge] = [[0.5 * width, 0.5 * height], [30.0, 60.0]];
    for at in [
        middle,
        [middle[0], edge[1]],
        [middle[0], height - edge[1]],
        [edge[0], middle[1]],
        [width - edge[0], middle[1]],
        [width - 100.0, 100.0],
    ] {
        let camera = harness.state().camera(role);
        let there = camera.unproject(at, screen_of(area), &pivot);
        let moved = Camera {
            target: camera.target + (pivot - there),
            ..camera
        };
        let command = ViewCommand::SetCamera(role, moved);
        harness.state_mut().apply(command.into());
        harness.run_steps(3);
        let covered = harness.state().state.view.rooms.get(role).covered;
        let free = Rect::from_min_max(
            area.min + vec2(0.0, area.height() * covered.top as f32),
            area.max - vec2(0.0, area.height() * covered.bottom as f32),
        );
        // The letters of the cube and of the buttons are smaller.
        let is_letter = |text: &Painted| {
            let is_here = area.intersects(text.rect) && text.rect.height() > 15.0;
            is_here && ["X", "Y", "Z"].contains(&&*text.text)
        };
        let letters: Vec<_> = texts(&harness).into_iter().filter(is_letter).collect();
        assert!(!letters.is_empty(), "{at:?}");
        for letter in letters {
            assert!(
                free.contains_rect(letter.rect),
                "{} {:?}",
                letter.text,
                letter.rect
            );
        }
    }
}

#[test]
fn the_gizmo_moves_the_part_in_one_step() {
    let (mut harness, dot) = with_gizmo();
    let before = *harness.state().state.document.crash_from_stamped();
    let camera = harness.state().camera(Role::Stamped);
    let n_steps = harness.state().state.history.n_done();
    drag(
        &mut harness,
        PointerButton::Primary,
        dot,
        dot + vec2(30.0, 0.0),
    );
    let desk = harness.state();
    assert_eq!(
        desk.camera(Role::Stamped),
        camera,
        "the camera leaves the button alone"
    );
    assert_ne!(*desk.state.document.crash_from_stamped(), before);
    assert_eq!(desk.state.history.n_done(), n_steps + 1);
    let ended = |c: &Command| matches!(c, Command::Move(MoveCommand::EndDrag));
    assert!(desk.seen.iter().any(ended));
}

/// Two windows with a device, so that there are pictures.
fn drawn() -> Harness<'static, Desk> {
    let state = egui_kittest::wgpu::create_render_state(
        egui_kittest::wgpu::default_wgpu_setup(),
        RendererOptions::PREDICTABLE,
    );
    let renderer = egui_kittest::wgpu::WgpuTestRenderer::from_render_state(state.clone());
    let desk = Desk::with_sheets(Some(&state));
    let builder = Harness::builder()
        .with_size(vec2(360.0, 180.0))
        .renderer(renderer);
    let mut harness = builder.build_ui_state(show, desk);
    settle(&mut harness);
    harness
}

/// The picture of the left window on transparent ground.
fn left_picture(harness: &mut Harness<'_, Desk>) -> image::RgbaImage {
    let viewports = &mut harness.state_mut().viewports;
    let choice = PictureChoice {
        is_transparent: true,
        ..PictureChoice::default()
    };
    viewports.window_picture(Role::Crash, &choice, 1).unwrap()
}

#[test]
fn a_drag_with_ctrl_draws_edges_only_as_long_as_it_lasts() {
    let mut harness = drawn();
    let n_opaque = |harness: &mut Harness<'_, Desk>| {
        let picture = left_picture(harness);
        picture.pixels().filter(|p| p.0[3] > 128).count()
    };
    let center = area(&harness, Role::Crash).center();
    let full = n_opaque(&mut harness);
    harness.event(Event::PointerMoved(center));
    harness.step();
    let button = |harness: &Harness<'_, Desk>, pos, pressed| {
        harness.event(Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::COMMAND,
        });
    };
    harness.event(Event::ModifiersChanged(egui::Modifiers::COMMAND));
    button(&harness, center, true);
    let mut pos = center;
    for _ in 0..4 {
        pos += vec2(5.0, 2.0);
        harness.event(Event::PointerMoved(pos));
        harness.step();
    }
    let dragged = n_opaque(&mut harness);
    assert!(dragged > 100 && dragged * 3 < full, "{dragged} of {full}");
    button(&harness, pos, false);
    harness.run_steps(2);
    assert!(n_opaque(&mut harness) * 2 > full, "the surface is back");
}

#[test]
fn move_over_draws_the_stamped_part_in_the_left_picture() {
    let mut harness = drawn();
    let counts = |harness: &mut Harness<'_, Desk>| {
        let picture = left_picture(harness);
        let (mut blue, mut orange) = (0, 0);
        for pixel in picture.pixels().filter(|p| p.0[3] == 255) {
            let [red, _, b, _] = pixel.0;
            orange += usize::from(red > b.saturating_add(40));
            blue += usize::from(b > red.saturating_add(40));
        }
        (blue, orange)
    };
    let (blue, orange) = counts(&mut harness);
    assert!(blue > 2000 && orange == 0, "{blue} blue, {orange} orange");
    harness
        .state_mut()
        .apply(ViewCommand::ToggleMoveOver.into());
    harness.run_steps(3);
    let (_, orange) = counts(&mut harness);
    assert!(orange > 2000, "{orange} orange");
    harness.render().unwrap();
}

/// Mean of the lightness L* of what a window shows of a part.
fn lightness(harness: &mut Harness<'_, Desk>, role: Role) -> f64 {
    let choice = PictureChoice {
        is_transparent: true,
        ..PictureChoice::default()
    };
    let viewports = &mut harness.state_mut().viewports;
    let picture = viewports.window_picture(role, &choice, 1).unwrap();
    let linear = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
    let opaque = picture.pixels().filter(|pixel| pixel.0[3] == 255);
    let luminances = opaque.map(|pixel| {
        let [red, green, blue, _] = pixel.0.map(linear);
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    });
    let luminances: Vec<f64> = luminances.collect();
    assert!(luminances.len() > 500, "{} pixels", luminances.len());
    let mean = luminances.iter().sum::<f64>() / luminances.len() as f64;
    116.0 * mean.cbrt() - 16.0
}

#[test]
fn the_two_parts_are_told_apart_without_colours() {
    let mut harness = drawn();
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        harness.ctx.set_theme(theme);
        settle(&mut harness);
        // The same sheet from the same side in the same light.
        let apart = lightness(&mut harness, Role::Stamped) - lightness(&mut harness, Role::Crash);
        assert!(apart > 10.0, "{theme:?}: {apart:.1} apart");
    }
}

#[test]
fn before_a_map_the_other_part_is_a_grey_ghost() {
    let mut harness = drawn();
    let n_blue = |harness: &mut Harness<'_, Desk>| {
        let picture = left_picture(harness);
        let is_blue = |p: &&image::Rgba<u8>| p.0[2] > p.0[0].saturating_add(40);
        picture.pixels().filter(is_blue).count()
    };
    let desk = harness.state_mut();
    desk.apply(ViewCommand::ToggleMoveOver.into());
    harness.run_steps(3);
    let before = n_blue(&mut harness);
    assert!(before > 500, "{before} blue without a map");
    let desk = harness.state_mut();
    let mut display = desk.state.view.display.clone();
    display.color_by = ColorBy::Deviation;
    // So wide that the whole map is neutral: what is blue is the crash part.
    display.coloring.limits = Some([-1000.0, 1000.0]);
    desk.apply(ViewCommand::SetDisplay(Box::new(display)).into());
    harness.run_steps(3);
    assert_eq!(n_blue(&mut harness), 0);
}

#[test]
fn the_free_window_turns_with_the_left_one() {
    let mut desk = Desk::with_sheets(None);
    desk.apply(ViewCommand::ToggleMoveOver.into());
    let mut harness = harness(desk);
    harness.run_steps(30);
    let own = harness.state().camera(Role::Stamped);
    let before = harness.state().camera(Role::Crash);
    let center = area(&harness, Role::Stamped).center();
    let to = center + vec2(40.0, 10.0);
    drag(&mut harness, PointerButton::Primary, center, to);
    let turned = harness.state().camera(Role::Crash);
    assert!(turned.world_from_view.angle_to(&before.world_from_view) > 0.1);
    assert_eq!(harness.state().camera(Role::Stamped), own);
    // So narrow a window offers its uses as a menu.
    harness.get_by_role(egui::accesskit::Role::ComboBox).click();
    harness.run_steps(2);
    harness.get_by_label("Deviation").click();
    harness.run_steps(2);
    let free = harness.state().state.free_window();
    assert_eq!(free, Some(FreeWindow::Deviation));
}

#[test]
fn a_free_drag_beside_the_circle_rolls() {
    let mut desk = Desk::with_sheets(None);
    desk.apply(ViewCommand::SetOrbitStyle(OrbitStyle::Free).into());
    let mut harness = harness(desk);
    let area = area(&harness, Role::Crash);
    let before = harness.state().camera(Role::Crash);
    let from = area.center() + vec2(-10.0, 0.42 * area.height());
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from + vec2(60.0, 0.0),
    );
    let rolled = harness.state().camera(Role::Crash);
    assert!(rolled.up().angle(&before.up()) > 0.1);
    assert!(
        rolled.forward().angle(&before.forward()) < 1e-9,
        "it looks where it did"
    );
}

#[test]
fn the_pivot_is_picked_under_the_pointer_and_forgotten() {
    let mut harness = harness(Desk::with_sheets(None));
    let center = area(&harness, Role::Crash).center();
    harness.event(Event::PointerMoved(center));
    harness.step();
    harness.key_press(egui::Key::P);
    harness.run_steps(2);
    let pivot = *harness.state().state.view.pivot.get(Role::Crash);
    let pivot = pivot.expect("the point under the pointer");
    let camera = harness.state().camera(Role::Crash);
    let from = center + vec2(40.0, 20.0);
    drag(
        &mut harness,
        PointerButton::Primary,
        from,
        from + vec2(30.0, 15.0),
    );
    let turned = harness.state().camera(Role::Crash);
    let area = area(&harness, Role::Crash);
    let seen = |camera: &Camera| camera.project(&pivot, screen_of(area)).unwrap();
    let (old, new) = (seen(&camera), seen(&turned));
    assert!(turned.world_from_view.angle_to(&camera.world_from_view) > 0.1);
    assert!(
        (old.x - new.x).hypot(old.y - new.y) < 0.1,
        "the pivot stays"
    );
    // The same key forgets it again, and once only.
    harness.key_press(egui::Key::P);
    harness.run_steps(2);
    assert_eq!(*harness.state().state.view.pivot.get(Role::Crash), None);
}

#[test]
fn shift_and_arrows_pan_and_windows_say_what_they_show() {
    let mut harness = harness(Desk::with_sheets(None));
    let before = harness.state().camera(Role::Crash);
    harness
        .get_by(|node| {
            node.label()
                .is_some_and(|l| l.starts_with("Crash part, 192 triangles"))
        })
        .focus();
    harness.run_steps(2);
    harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::ArrowRight);
    harness.run_steps(2);
    let panned = harness.state().camera(Role::Crash);
    assert_eq!(panned.world_from_view, before.world_from_view);
    assert!((panned.target - before.target).norm() > 0.01 * before.height);
    harness.key_press(egui::Key::Plus);
    harness.run_steps(2);
    assert!(harness.state().camera(Role::Crash).height < before.height);
}

#[test]
fn the_wheel_over_the_view_buttons_does_not_zoom() {
    // They stand where there is room beside the names.
    let mut harness = Harness::builder()
        .with_size(vec2(1400.0, SIZE.y))
        .build_ui_state(show, Desk::with_sheets(None));
    settle(&mut harness);
    let before = harness.state().camera(Role::Crash);
    let button = harness.get_by_label("Look along Y (crash)");
    let at = button.rect().center();
    turn_wheel(&mut harness, at);
    assert_eq!(harness.state().camera(Role::Crash), before);
}
