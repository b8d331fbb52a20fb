//! The stamped files that a mapping takes its values from: each with its verdict and its pose.

use egui::{Align, Button, Layout, Rect, RichText, Sense, Ui, Vec2, vec2};

use super::units;
use crate::app::{
    Action, AppState, Command, FurtherPose, MapCommand, StampedRow, StampedState, ViewCommand,
};
use crate::assess::Verdict;
use crate::pipeline::map::pose_warning;
use crate::role::Role;
use crate::text::sentence;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{
    caption, eye, file_swatch, icon_button, plain_action, role_mark, verdict_color,
};

/// The list of stamped files, and the way to one more.
pub fn stamped_files_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let rows = state.stamped_rows();
    ui.horizontal(|ui| {
        caption(ui, "Stamped files");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            plain_action(ui, state, Action::AddStamped, commands);
        });
    });
    for row in &rows {
        row_ui(ui, row, state, commands);
        if let Some(problem) = problem(row, state) {
            let color = Palette::of(ui).poor;
            let text = RichText::new(problem).small().color(color);
            ui.add(egui::Label::new(text).wrap());
        }
    }
}

/// Name, verdict, pose, and the way out of the list.
fn row_ui(ui: &mut Ui, row: &StampedRow, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        sight_ui(ui, row, commands);
        let end = RowEnd::new(ui, &row.path);
        end.before(ui, |ui| {
            let name = ui.add(egui::Label::new(&row.name).truncate());
            name.on_hover_text(row.path.display().to_string());
        });
        end.show(ui, |ui| {
            if let Some(units) = row.own_units {
                let label = RichText::new(units.label()).small();
                let label = ui.label(label.color(Palette::of(ui).secondary));
                label.on_hover_text("The unit of this file; the menu of its pose sets it");
            }
            state_ui(ui, &row.state);
            pose_ui(ui, row, state, commands);
            if let Some(revision) = row.removed_by {
                let name = match row.state {
                    StampedState::Reading => format!("Stop reading {}", row.name),
                    _ => format!("Remove {}", row.name),
                };
                if icon_button(ui, "✖", &name, true).clicked() {
                    commands.push(MapCommand::RemoveFurther(revision).into());
                }
            }
        });
    });
}

/// The switch that shows a file in 3D, and its colour there; the mark of a stamped part while it is not read.
fn sight_ui(ui: &mut Ui, row: &StampedRow, commands: &mut Vec<Command>) {
    let Some(number) = row.number else {
        role_mark(ui, Role::Stamped);
        return;
    };
    let (place, switch) = ui.allocate_exact_size(vec2(16.0, ROW), Sense::click());
    eye(
        ui,
        place,
        &switch,
        (row.is_shown, &format!("Show {}", row.name)),
    );
    if switch
        .on_hover_text("Show or hide this file in 3D")
        .clicked()
    {
        commands.push(ViewCommand::ShowFile(row.path.clone(), !row.is_shown).into());
    }
    let (place, swatch) = ui.allocate_exact_size(vec2(12.0, ROW), Sense::hover());
    let square = Rect::from_center_size(place.center(), Vec2::splat(11.0));
    file_swatch(ui.painter(), square, number);
    swatch
        .on_hover_text("Its colour in the picture From file, and where the colours tell the parts");
}

/// Where the pose of a further file comes from, and its unit; while it is matched, the way to end that.
fn pose_ui(ui: &mut Ui, row: &StampedRow, state: &AppState, commands: &mut Vec<Command>) {
    let Some((revision, pose)) = row.further else {
        return;
    };
    if row.state == StampedState::Matching {
        let stop = ui.add(Button::new("Stop").min_size(vec2(0.0, ROW)));
        let stop = stop.on_hover_text("End the match with the best pose so far");
        let name = format!("Stop the match of {}", row.name);
        if stop.accessible_name(name).clicked() {
            commands.push(MapCommand::StopFurther.into());
        }
        return;
    }
    let label = format!("{} ▾", pose.label());
    let button = Button::new(RichText::new(label).small()).min_size(vec2(0.0, ROW));
    let menu = egui::containers::menu::MenuButton::from_button(button);
    let (button, _) = menu.ui(ui, |ui| {
        for choice in FurtherPose::ALL {
            let item = ui.selectable_label(choice == pose, choice.label());
            if item.on_hover_text(choice.help()).clicked() {
                commands.push(MapCommand::SetFurtherPose(revision, choice).into());
                ui.close();
            }
        }
        ui.separator();
        if ui.button("Match again").clicked() {
            commands.push(MapCommand::MatchFurther(revision).into());
            ui.close();
        }
        ui.menu_button("Units", |ui| {
            units::further_units_ui(ui, revision, state, commands);
        });
    });
    let button = button.on_hover_text(pose.help());
    button.accessible_name(format!("Pose of {}", row.name));
}

/// What is known of a file, in a word.
fn state_ui(ui: &mut Ui, state: &StampedState) {
    let palette = Palette::of(ui);
    let pose;
    let (word, color, more) = match state {
        StampedState::Reading => ("reading …", palette.secondary, None),
        StampedState::NotRead(_) => ("not read", palette.poor, None),
        StampedState::Waiting(why) => ("waits", palette.secondary, Some(sentence(why))),
        StampedState::Matching => ("matching …", palette.secondary, None),
        StampedState::NotMatched(Some(_)) => ("not matched", palette.poor, None),
        StampedState::NotMatched(None) => (
            "not matched",
            palette.check,
            Some("The match was given up".to_owned()),
        ),
        StampedState::Matched(verdict, line) => (
            verdict.label(),
            verdict_color(palette, *verdict),
            Some(line.clone()),
        ),
        StampedState::Alternative(verdict, number) => {
            pose = format!("{}, pose {number}", verdict.label());
            (
                pose.as_str(),
                verdict_color(palette, *verdict),
                Some("Another pose of its match, which section 3 tells of".to_owned()),
            )
        }
        StampedState::AsFirst => return,
        StampedState::Outdated(words) => ("older match", palette.check, Some(sentence(words))),
        StampedState::ByHand => (
            "by hand",
            palette.secondary,
            Some("It lies where it was put".to_owned()),
        ),
        StampedState::AsLoaded => (
            "as loaded",
            palette.secondary,
            Some("It lies where its file has it".to_owned()),
        ),
    };
    let label = ui.label(RichText::new(word).small().color(color));
    if let Some(more) = more {
        label.on_hover_text(more);
    }
}

/// What is wrong with a file, and what to do.
fn problem(row: &StampedRow, state: &AppState) -> Option<String> {
    if let Some(hint) = &row.unit_hint
        && matches!(
            row.state,
            StampedState::NotMatched(Some(_)) | StampedState::Matched(..)
        )
    {
        let words = hint.words();
        return Some(format!(
            "The file {words}. The menu of its pose sets its unit."
        ));
    }
    match &row.state {
        StampedState::NotRead(reason) => Some(format!(
            "{} Add another file or fix this one.",
            sentence(reason)
        )),
        StampedState::NotMatched(Some(reason)) => Some(format!(
            "{} Let it lie as the first one, or remove it.",
            sentence(reason)
        )),
        // Section 3 tells of the first one.
        StampedState::Matched(Verdict::Poor, _) if row.further.is_some() => {
            let doubt = row.number.and_then(|n| state.match_doubt(n));
            // An older project does not know why.
            let doubt = doubt.or_else(|| pose_warning(Verdict::Poor, &row.name));
            doubt.map(|doubt| sentence(&doubt))
        }
        _ => None,
    }
}
