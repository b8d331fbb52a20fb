//! The starts of the last match, the winner first.

use crate::app::{AppState, Command, MoveCommand};
use crate::registration::{Fate, StartRecord};
use crate::report::{fate_words, side_word};
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, length, nothing_yet, percent};
use egui::{Align, Layout, RichText, Sense, Ui};
use egui_extras::{Column, TableBuilder};

/// The table.
pub fn starts_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(result) = &state.document.result else {
        nothing_yet(
            ui,
            "No starts yet",
            "A match lists every start here with what became of it",
        );
        return;
    };
    let outcome = &result.run.outcome;
    let mut order: Vec<usize> = (0..outcome.starts.len()).collect();
    order.sort_by_key(|&index| rank(&outcome.starts[index].fate));
    ui.spacing_mut().item_spacing.y = 0.0;
    TableBuilder::new(ui)
        .id_salt("starts")
        .sense(Sense::click())
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::exact(40.0))
        .column(Column::exact(176.0))
        .column(Column::exact(80.0))
        .column(Column::exact(80.0))
        .column(Column::exact(80.0))
        .column(Column::exact(72.0))
        .column(Column::remainder().clip(true))
        .header(20.0, |mut header| {
            let titles = [
                "#",
                "start",
                "rmse",
                "overlap",
                "score",
                "iterations",
                "fate",
            ];
            for title in titles {
                header.col(|ui| {
                    caption(ui, title);
                });
            }
        })
        .body(|body| {
            body.rows(20.0, order.len(), |mut row| {
                let index = order[row.index()];
                let start = &outcome.starts[index];
                for text in cells(index, start) {
                    row.col(|ui| {
                        let color = if index == outcome.winner {
                            Palette::of(ui).good
                        } else {
                            Palette::of(ui).text
                        };
                        ui.add(egui::Label::new(RichText::new(text).color(color)).truncate());
                    });
                }
                let response = row.response();
                if response.clicked() && state.can_move().is_ok() {
                    let command = MoveCommand::SetPose {
                        crash_from_stamped: start.last,
                        name: format!("Pose of start {}", index + 1),
                    };
                    commands.push(command.into());
                }
                response.on_hover_text("Click to put the stamped part at this pose");
            });
        });
}

fn rank(fate: &Fate) -> u8 {
    match fate {
        Fate::Won => 0,
        Fate::RunnerUp => 1,
        Fate::MergedInto { .. } => 2,
        Fate::Dropped { .. } => 3,
        Fate::Failed => 4,
    }
}

fn cells(index: usize, start: &StartRecord) -> [String; 7] {
    let last = start.iterations.last();
    let mut kind = format!("{}, {}", start.kind.label(), side_word(start.data_side));
    if start.flipped {
        kind += ", turned";
    }
    if start.mirrored {
        kind += ", mirrored";
    }
    [
        (index + 1).to_string(),
        kind,
        last.map_or_else(|| "–".to_owned(), |i| length(i.rmse)),
        last.map_or_else(|| "–".to_owned(), |i| percent(i.fraction)),
        length(start.score),
        start.iterations.len().to_string(),
        fate_words(start.fate),
    ]
}
