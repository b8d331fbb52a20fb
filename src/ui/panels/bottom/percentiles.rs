//! Mean, extremes and percentiles of a quantity, one row for each side.

use egui::{RichText, Ui, vec2};

use super::mapping::number;
use crate::app::ColorBy;
use crate::pipeline::map::DistributionRecord;
use crate::ui::theme::Palette;

/// Room for a percentile, and for the sign of its row.
pub(super) const PERCENTILE: f32 = 38.0;
/// Least room for the histogram beside them; where there is less, four of them do.
pub(super) const CHART: f32 = 200.0;
/// Titles of the columns.
const TITLES: [&str; 7] = ["mean", "min", "5 %", "50 %", "95 %", "99 %", "max"];

/// As many of them as have room beside each other; mean, both ends and one more at least.
pub(super) fn fitting_columns(room: f32) -> &'static [usize] {
    let fits = |columns: &&&[usize]| PERCENTILE * (columns.len() + 1) as f32 <= room;
    let all: [&[usize]; 3] = [&[0, 1, 2, 3, 4, 5, 6], &[0, 1, 2, 4, 5, 6], &[0, 1, 4, 6]];
    all.iter().find(fits).copied().unwrap_or(all[2])
}

/// One row for each side: its sign, the numbers of these columns, its colour.
pub(super) fn percentiles_ui(
    ui: &mut Ui,
    rows: &[(&str, &DistributionRecord, egui::Color32)],
    columns: &[usize],
    by: ColorBy,
) {
    let palette = Palette::of(ui);
    let numbers = |of: &DistributionRecord| {
        [of.mean, of.min, of.p5, of.p50, of.p95, of.p99, of.max].map(|n| number(by, n))
    };
    let quiet = |text: &str| RichText::new(text).small().color(palette.secondary);
    egui::Grid::new("mapping percentiles")
        .num_columns(columns.len() + 1)
        .spacing(vec2(6.0, 0.0))
        .min_row_height(15.0)
        .show(ui, |ui| {
            ui.label("");
            for &column in columns {
                ui.label(quiet(TITLES[column]));
            }
            ui.end_row();
            for (name, of, color) in rows {
                ui.label(RichText::new(*name).small().color(*color));
                let numbers = numbers(of);
                for &column in columns {
                    ui.label(RichText::new(&numbers[column]).small());
                }
                ui.end_row();
            }
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremes_are_shown_in_any_room() {
        for (room, n) in [(400.0, 7), (290.0, 6), (200.0, 4), (50.0, 4)] {
            let columns = fitting_columns(room);
            assert_eq!(columns.len(), n, "{room}");
            let titles: Vec<&str> = columns.iter().map(|&column| TITLES[column]).collect();
            assert!(titles.contains(&"min") && titles.contains(&"max"));
        }
    }
}
