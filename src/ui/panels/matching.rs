//! Section 3: first poses, the match, what came out.

use std::time::Duration;

use egui::{Button, ComboBox, ProgressBar, RichText, Ui, vec2};

use super::section::{is_unfolded, section_ui};
use super::{manual_move, pairs, recipe, result};
use crate::app::{
    Action, AppState, Command, MatchCommand, RunningJob, Section, ShownGeometry, ViewCommand,
    duration_text,
};
use crate::jobs::JobKey;
use crate::registration::{Method, StartMethod};
use crate::role::Role;
use crate::settings::Choice as _;
use crate::text::{counted, whole_percent};
use crate::ui::focus;
use crate::ui::theme::{Palette, ROW, TALL, UNIT};
use crate::ui::widgets::{
    Look, action_button, action_tooltip, caption, focus_ring, form_row, paragraph, secondary,
    segments, tight, told_button, wide_action,
};

/// Width of the label column of this section.
const LABEL: f32 = 56.0;
/// A match is not stopped by a click so soon after its start: two clicks may come far apart where frames are slow.
const NO_STOP_YET: Duration = Duration::from_millis(700);

/// Draws section 3.
pub fn matching_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let summary = summary(state, is_unfolded(ui, Section::Match));
    section_ui(
        ui,
        state,
        Section::Match,
        &summary,
        commands,
        |ui, commands| {
            if state.document.both().is_none() {
                paragraph(ui, "Load both parts first.");
                if state.document.part(Role::Stamped).is_some() {
                    manual_move::manual_move_ui(ui, state, commands);
                }
                return;
            }
            align_ui(ui, state, commands);
            chain_ui(ui, state, commands);
            pairs::pairs_ui(ui, state, commands);
            run_ui(ui, state, commands);
            result::result_ui(ui, state, commands);
            compare_ui(ui, state, commands);
            manual_move::manual_move_ui(ui, state, commands);
            result::pose_by_hand_ui(ui, state, commands);
        },
    );
}

fn summary(state: &AppState, is_unfolded: bool) -> String {
    if state.jobs.is_active(JobKey::Match) {
        return "running".to_owned();
    }
    match state.document.current_result() {
        // The card below says it.
        Some(_) if is_unfolded => String::new(),
        Some(result) => {
            let verdict = result.verdict().label();
            // An alternative is measured once it is shown.
            state.coverage_of(result).map_or_else(
                || verdict.to_owned(),
                |coverage| format!("{verdict} · RMS {}", state.lengths().of(coverage.rmse())),
            )
        }
        None if state.document.both().is_none() => String::new(),
        None => state.document.recipe.settings.method.label().to_owned(),
    }
}

/// "Align surface normals", and stepping through the first poses it made.
fn align_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let look = ("Align surface normals", Look::Plain, ROW + 4.0);
    wide_action(ui, state, Action::Align, look, commands);
    let Some(starts) = state.current_starts().filter(|s| !s.is_empty()) else {
        return;
    };
    ui.horizontal(|ui| {
        let square = vec2(ROW, ROW);
        let previous = ("◀", Look::Plain, square);
        tight(ui, |ui| {
            action_button(ui, state, Action::PreviousStart, previous, commands)
                .widget_info(|| named_button("Previous start"));
        });
        let text = match state.previews.start {
            Some(index) => format!("start {} of {}", index + 1, starts.len()),
            None => counted(starts.len(), "start"),
        };
        let label = ui.add_sized(vec2(104.0, ROW), egui::Label::new(text));
        label.on_hover_text("The first poses are shown one by one; the real pose stays");
        let next = ("▶", Look::Plain, square);
        tight(ui, |ui| {
            action_button(ui, state, Action::NextStart, next, commands)
                .widget_info(|| named_button("Next start"));
        });
        if state.previews.start.is_some() {
            let look = ("Use", Look::Plain, vec2(48.0, ROW));
            action_button(ui, state, Action::UseStart, look, commands);
            if ui
                .add(Button::new("Back").min_size(vec2(48.0, ROW)))
                .clicked()
            {
                commands.push(MatchCommand::ShowStart(None).into());
            }
        }
    });
}

fn named_button(name: &str) -> egui::WidgetInfo {
    egui::WidgetInfo::labeled(egui::Role::Button, true, name)
}

/// In the window the given pose is that of the picked pairs.
fn start_label(method: StartMethod) -> &'static str {
    match method {
        StartMethod::GivenPoses => "Point pairs",
        other => other.label(),
    }
}

fn start_help(method: StartMethod) -> &'static str {
    match method {
        StartMethod::GivenPoses => "Starts from the pose that picked pairs of points give",
        other => other.help(),
    }
}

/// Start, then method: the two links of the chain, and the gear for the rest.
fn chain_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut recipe = state.document.recipe.clone();
    let is_free = state.jobs.locking_job().is_none();
    ui.add_enabled_ui(is_free, |ui| {
        form_row(ui, "Start", LABEL, |ui| {
            let menu = ComboBox::from_id_salt("start")
                .selected_text(start_label(recipe.settings.starts.method))
                .width(ui.available_width());
            focus::menu(ui, menu, |ui| {
                for &method in StartMethod::ALL {
                    let value = &mut recipe.settings.starts.method;
                    let holds = *value == method;
                    let choice = ui.selectable_value(value, method, start_label(method));
                    focus::chosen(ui, holds, choice).on_hover_text(start_help(method));
                }
            });
        });
        form_row(ui, "Method", LABEL, |ui| {
            let room = ui.available_width() - ROW - UNIT;
            let menu = ComboBox::from_id_salt("method")
                .selected_text(recipe.settings.method.label())
                .width(room);
            focus::menu(ui, menu, |ui| {
                for &method in Method::ALL {
                    let is_on = recipe.settings.method == method;
                    let choice = ui.selectable_label(is_on, method.label());
                    let choice = focus::chosen(ui, is_on, choice);
                    if choice.on_hover_text(method.help()).clicked() && !is_on {
                        recipe.settings.set_method(method);
                    }
                }
            });
            recipe::GEAR.ui(ui, recipe::has_own_settings(&recipe));
        });
        recipe::recipe_ui(ui, state, &mut recipe);
    });
    if recipe != state.document.recipe {
        commands.push(MatchCommand::SetRecipe(Box::new(recipe)).into());
    }
}

/// The run: match, or stop and cancel with what is going on.
fn run_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.add_space(2.0);
    let width = ui.available_width();
    if !state.jobs.is_active(JobKey::Match) {
        // At the pose of a match mapping is the next thing to do.
        let look = match state.document.current_result() {
            Some(_) => Look::Plain,
            None => Look::Primary,
        };
        let look = ("▶  Match", look, TALL);
        wide_action(ui, state, Action::MatchOrStop, look, commands)
            .widget_info(|| named_button("Match the parts"));
        cancelling_ui(ui, state);
        return;
    }
    let is_stopping = state.jobs.running().is_some_and(|job| job.is_stopping);
    ui.horizontal(|ui| {
        let stop = if is_stopping {
            "Stopping…"
        } else {
            "Stop (keep best)"
        };
        let look = (stop, Look::Primary, vec2(width - 88.0 - UNIT, TALL));
        let tooltip = action_tooltip(Action::MatchOrStop);
        let stop = told_button(ui, state, Action::MatchOrStop, look, &tooltip);
        // The second of two clicks on the button that starts the match, whose place this one takes, ends nothing.
        let begun = state.jobs.running().map(|job| job.since);
        let is_new = begun.is_some_and(|at| state.log.now.saturating_sub(at) < NO_STOP_YET);
        if stop.clicked() && !is_new && !stop.double_clicked() {
            commands.extend(Action::MatchOrStop.command(state));
        }
        let look = ("Cancel", Look::Plain, vec2(88.0, TALL));
        action_button(ui, state, Action::CancelRun, look, commands);
    });
    status_ui(ui, state);
}

/// Says that the worker has not yet let go of a match that was cancelled.
fn cancelling_ui(ui: &mut Ui, state: &AppState) {
    let is_meant = |job: &&RunningJob| job.key == JobKey::Match && job.is_cancelling;
    if state.jobs.running().filter(is_meant).is_some() {
        secondary(ui, "Cancelling…");
    }
}

/// One live line under the buttons, and a bar only for what can be counted.
fn status_ui(ui: &mut Ui, state: &AppState) {
    let Some(job) = state.jobs.running().filter(|job| job.key == JobKey::Match) else {
        secondary(ui, "Waiting for the previous task");
        return;
    };
    let mut text = String::new();
    let [n_ended, n_starts] = state.n_ended_starts();
    if n_starts > 0 {
        let fraction = n_ended as f32 / n_starts as f32;
        ui.add(ProgressBar::new(fraction).desired_height(4.0))
            .on_hover_text(format!(
                "Ended: {n_ended} of {}",
                counted(n_starts, "start")
            ))
            .accessible_name("Starts that have ended");
    }
    if let Some(latest) = job.latest {
        text += &format!(
            "start {}/{n_starts} · iteration {} · residual {} · kept {} · ",
            latest.start + 1,
            latest.number + 1,
            state.lengths().of(latest.record.rmse),
            whole_percent(latest.record.fraction)
        );
    } else if let Some(progress) = job.progress {
        text += &format!("{} · ", progress.phase);
    }
    text += &duration_text(state.log.now.saturating_sub(job.since));
    let color = Palette::of(ui).secondary;
    let label = ui.add(egui::Label::new(RichText::new(text).small().color(color)).wrap());
    ui.ctx().accesskit_node_builder(label.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_millis(100));
}

/// Move over, reduced or detailed, gizmo.
fn compare_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        let label = if state.view.is_moved_over {
            "Move back"
        } else {
            "Move over"
        };
        let half = (ui.available_width() - UNIT) / 2.0;
        let look = (label, Look::Plain, vec2(half, ROW + 4.0));
        action_button(ui, state, Action::ToggleMoveOver, look, commands);
        let can = Action::ToggleDetailed.enabled(state).is_ok();
        let choices = [ShownGeometry::Reduced, ShownGeometry::Detailed];
        let is_on = |index: usize| can && state.view.shown == choices[index];
        let labels = [("Reduced", is_on(0), can), ("Detailed", is_on(1), can)];
        if let Some(index) = segments(ui, &labels, half) {
            commands.push(ViewCommand::SetShown(choices[index]).into());
        }
    });
    if state.view.is_moved_over {
        over_ui(ui, state, commands);
    } else if state.view.shown == ShownGeometry::Detailed {
        caption(ui, "The windows show the full meshes");
    }
}

/// How the two parts lie in one window.
fn over_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut display = state.view.display.clone();
    for (role, name) in [(Role::Crash, "■ opacity"), (Role::Stamped, "▲ opacity")] {
        form_row(ui, name, 72.0, |ui| {
            slider_room(ui);
            let value = display.opacity.get_mut(role);
            let slider = ui.add(egui::Slider::new(value, 0.0..=1.0).fixed_decimals(2));
            focus_ring(ui, slider.rect, &slider);
        });
    }
    form_row(ui, "separation", 72.0, |ui| {
        let size = state
            .document
            .part(Role::Stamped)
            .map_or(1.0, |p| p.bounds().diagonal());
        slider_room(ui);
        let slider = egui::Slider::new(&mut display.separation, 0.0..=0.25 * size);
        let decimals = (4.0 - size.log10().floor()).clamp(1.0, 9.0) as usize;
        let slider = ui.add(
            slider
                .max_decimals(decimals)
                .suffix(state.document.unit_suffix()),
        );
        focus_ring(ui, slider.rect, &slider);
        slider.on_hover_text("Draws the stamped part apart from where it is; the matrix stays");
    });
    ui.horizontal(|ui| {
        for action in [Action::ToggleSeeThrough, Action::ToggleWipe] {
            let is_on = match action {
                Action::ToggleWipe => display.wipe.is_some(),
                _ => display.is_see_through,
            };
            let look = if is_on { Look::On } else { Look::Plain };
            let label = (action.row().label, look, vec2(0.0, ROW));
            action_button(ui, state, action, label, commands);
        }
    });
    if display != state.view.display {
        commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    }
}

/// A slider takes what its number leaves; the numbers of all are as wide, whether they have a unit or not.
fn slider_room(ui: &mut Ui) {
    const NUMBER: f32 = 72.0;
    let spacing = ui.spacing_mut();
    spacing.interact_size.x = NUMBER;
    let beside = NUMBER + spacing.item_spacing.x;
    ui.spacing_mut().slider_width = ui.available_width() - beside;
}
