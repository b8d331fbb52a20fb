//! The verdict card and the matrix.

use super::explain;
use crate::app::{
    Action, AppState, Command, ExportCommand, MatchCommand, MatchResult, is_same_pose,
};
use crate::assess::Verdict;
use crate::geometry::Similarity;
use crate::report::{PoseRecord, number};
use crate::ui::panels::top_bar::copy_forms_ui;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{
    Look, action_button, caption, card, chip, figure, length, paragraph, percent, square, tight,
};
use egui::{Color32, RichText, Ui, vec2};

/// Verdict, figures, alternatives, matrix.
pub fn result_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    explain::failure_ui(ui, state, commands);
    let Some(result) = &state.document.result else {
        return;
    };
    ui.add_space(2.0);
    let is_current = state.document.current_result().is_some();
    let top = ui.cursor().top();
    card(ui, |ui| {
        verdict_ui(ui, result, is_current);
        figures_ui(ui, state, result);
        alternatives_ui(ui, state, result, commands);
        explain::causes_ui(ui, state.causes(), commands);
    });
    // A new result comes into sight by itself.
    let id = egui::Id::unique("stamp of the result in sight");
    let seen: Option<crate::jobs::Stamp> = ui.data(|data| data.get_temp(id));
    if seen != Some(result.stamp) {
        ui.data_mut(|data| data.insert_temp(id, result.stamp));
        let bottom = ui.cursor().top() + 3.0 * ROW;
        let x = ui.max_rect().x_range();
        ui.scroll_to_rect(egui::Rect::from_x_y_ranges(x, top..=bottom), None);
    }
    if is_current {
        matrix_ui(ui, state, commands);
    }
}

/// Sign and colour of a verdict.
fn verdict_look(palette: &Palette, verdict: Verdict) -> (&'static str, Color32) {
    match verdict {
        Verdict::Good => ("✔", palette.good),
        Verdict::Check => ("⚠", palette.check),
        Verdict::Poor => ("✖", palette.poor),
    }
}

fn verdict_ui(ui: &mut Ui, result: &MatchResult, is_current: bool) {
    let palette = Palette::of(ui);
    let assessment = &result.run.assessment;
    let (sign, color) = verdict_look(palette, assessment.verdict);
    ui.horizontal(|ui| {
        let text = format!("{sign} {}", assessment.verdict.label());
        let label = ui.label(RichText::new(text).color(color).size(17.0));
        ui.ctx().accesskit_node_builder(label.id, |node| {
            node.set_live(egui::accesskit::Live::Polite);
        });
        if !is_current {
            caption(ui, "out of date");
        } else if let Some(index) = result.alternative {
            caption(ui, format!("showing alternative {}", index + 1));
        }
    });
    for reason in assessment.reasons.iter().take(3) {
        let mut letters = reason.chars();
        let first = letters.next().map(|c| c.to_uppercase().to_string());
        paragraph(
            ui,
            format!("{}{}.", first.unwrap_or_default(), letters.as_str()),
        );
    }
}

fn figures_ui(ui: &mut Ui, state: &AppState, result: &MatchResult) {
    ui.add_space(2.0);
    let coverage = &result.run.assessment.coverage;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        let limit = state.length_text(coverage.limit);
        let over =
            |one: &crate::assess::OneSided| format!("{} within {limit}", percent(one.overlap));
        figure(ui, "stamped → crash", &over(&coverage.source_on_target));
        figure(ui, "crash → stamped", &over(&coverage.target_on_source));
        let spread = format!(
            "{} · {}",
            length(coverage.rmse()),
            state.length_text(coverage.p95())
        );
        figure(ui, "RMS · p95", &spread);
        let outcome = &result.run.outcome;
        let best = &outcome.target_from_source;
        let corners = state.stamped_corners();
        let agrees = |pose: &Similarity| corners.is_some_and(|c| is_same_pose(pose, best, &c));
        let starts = outcome.starts.iter();
        let n_same = starts.filter(|start| agrees(&start.last)).count();
        figure(
            ui,
            "starts that agree",
            &format!("{n_same} of {}", outcome.starts.len()),
        );
        let [crash, stamped] = result.run.n_triangles;
        let on = format!(
            "■ {} ▲ {}",
            crate::ui::widgets::grouped(crash),
            crate::ui::widgets::grouped(stamped)
        );
        figure(ui, "searched on", &on);
    });
}

/// Poses that fit nearly as well: one click or one key away.
fn alternatives_ui(
    ui: &mut Ui,
    state: &AppState,
    result: &MatchResult,
    commands: &mut Vec<Command>,
) {
    if Action::FlipAlternative.enabled(state).is_err() {
        return;
    }
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let keys = Action::FlipAlternative.info().shortcut;
        let keys = keys.map_or_else(String::new, |s| s.to_string());
        caption(ui, format!("Nearly as good ({keys})"));
        if chip(ui, "best", result.alternative.is_none()).clicked() {
            commands.push(MatchCommand::ShowAlternative(None).into());
        }
        let alternatives = result.run.outcome.alternatives.iter().take(4);
        for (index, alternative) in alternatives.enumerate() {
            let label = format!("{} (×{:.2})", index + 1, alternative.score_ratio);
            let is_on = result.alternative == Some(index);
            if chip(ui, &label, is_on).clicked() {
                commands.push(MatchCommand::ShowAlternative(Some(index)).into());
            }
        }
    });
}

/// The 4×4 with its sentence, and the copy menu.
fn matrix_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let pose = state.document.crash_from_stamped();
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let last = state.copy_form();
        let width = ui.available_width() - ROW - UNIT;
        let look = ("Copy matrix", Look::Plain, vec2(width, ROW + 4.0));
        let mut none = Vec::new();
        let response = action_button(ui, state, Action::CopyMatrix, look, &mut none);
        if response.clicked() {
            commands.push(ExportCommand::Copy(last).into());
        }
        response.on_hover_text(format!("As {}", last.label()));
        let menu = egui::containers::menu::MenuButton::from_button(square("▾", ROW + 4.0));
        let (button, _) = tight(ui, |ui| {
            menu.ui(ui, |ui| copy_forms_ui(ui, state, commands))
        });
        button
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Copy matrix as"));
    });
    egui::CollapsingHeader::new("Matrix, stamped → crash")
        .id_salt("matrix")
        .show_unindented(ui, |ui| {
            caption(ui, "p_crash = R · p_stamped + t, column vectors");
            grid_ui(ui, &pose.to_rows());
            moved_ui(ui, state);
        });
}

/// Every digit, in columns that line up; it scrolls sideways rather than being rounded.
fn grid_ui(ui: &mut Ui, rows: &[[f64; 4]; 4]) {
    egui::ScrollArea::horizontal()
        .id_salt("matrix digits")
        .show(ui, |ui| {
            egui::Grid::new("matrix grid")
                .spacing(vec2(12.0, 2.0))
                .show(ui, |ui| {
                    for row in rows {
                        for value in row {
                            let text = RichText::new(format!("{:>20}", number(*value)))
                                .monospace()
                                .size(10.5);
                            ui.add(egui::Label::new(text).selectable(true));
                        }
                        ui.end_row();
                    }
                });
        });
}

/// What people expect of a translation: how far the part's centre goes, and how much it turns.
fn moved_ui(ui: &mut Ui, state: &AppState) {
    let pose = state.document.crash_from_stamped();
    let Some(part) = state.document.part(crate::jobs::Role::Stamped) else {
        return;
    };
    let center = part.bounds().center();
    let record = PoseRecord::new(pose, part.loaded.sample_node(), &center);
    let [x, y, z] = record.center_move.map(length);
    let turn = record.rotation_axis_angle;
    let [u, v, w] = turn.axis.map(|x| format!("{:.3}", x + 0.0));
    paragraph(ui, format!("The centre moves by ({x}, {y}, {z})."));
    paragraph(
        ui,
        format!(
            "The part turns by {:.3}° about the axis ({u}, {v}, {w}).",
            turn.angle_deg
        ),
    );
    if let Some(node) = record.sample_node {
        let words = |[x, y, z]: [f64; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
        let (from, to) = (words(node.stamped), words(node.crash));
        paragraph(ui, format!("Sample node {}: {from} → {to}", node.id));
    }
    caption(
        ui,
        format!(
            "det R = {:.9}, c = {}",
            record.determinant,
            number(record.scale)
        ),
    );
}
