//! What lies over the window fits in it: sheets alone, at the sizes that screens and scales leave.

use egui::{Rect, Vec2, vec2};
use egui_kittest::Harness;
use shapematch::app::{AppState, Dialog, Settings, ViewCommand};
use shapematch::ui::overlays::overlays_ui;

use super::layout::{faults, texts};

/// A sheet over nothing.
fn sheet(dialog: Dialog, size: Vec2) -> Harness<'static, AppState> {
    let mut state = AppState::new(Settings::default());
    let _ = state.apply(ViewCommand::SetDialog(Some(dialog)));
    let mut harness = Harness::builder().with_size(size).build_ui_state(
        |ui, state: &mut AppState| {
            let mut commands = Vec::new();
            overlays_ui(ui.ctx(), state, false, &mut commands);
        },
        state,
    );
    harness.run_steps(3);
    harness
}

#[test]
fn the_help_sheet_keeps_keys_beside_names_on_any_screen() {
    // From a small laptop at twice the size to a large screen.
    for size in [
        vec2(512.0, 300.0),
        vec2(640.0, 360.0),
        vec2(800.0, 450.0),
        vec2(1024.0, 576.0),
        vec2(1280.0, 720.0),
        vec2(1536.0, 864.0),
        vec2(1920.0, 1080.0),
    ] {
        let harness = sheet(Dialog::Help, size);
        let faults = faults(&harness);
        assert!(faults.is_empty(), "{size}: {}", faults.join("\n"));
        let screen = Rect::from_min_size(egui::Pos2::ZERO, size);
        for text in texts(&harness) {
            let seen = text.rect.intersect(text.clip);
            assert!(screen.contains_rect(seen), "{size}: {:?} {seen}", text.text);
        }
    }
}
