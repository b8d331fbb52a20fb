//! What the reader found in the files.

use crate::app::AppState;
use crate::formats::{Diagnostic, Severity};
use crate::jobs::Role;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, grouped, nothing_yet, role_mark};
use egui::{RichText, ScrollArea, Ui};

/// Counts by kind, then the findings that were kept, file by file.
pub fn diagnostics_ui(ui: &mut Ui, state: &AppState) {
    let loaded = || {
        let parts = Role::ALL.into_iter();
        parts.filter_map(|role| Some((role, state.document.part(role)?)))
    };
    let total: u64 = loaded()
        .map(|(_, p)| p.loaded.model.diagnostics.total())
        .sum();
    if total == 0 {
        let title = match loaded().next() {
            Some(_) => "Nothing was found amiss in the files",
            None => "No file yet",
        };
        nothing_yet(
            ui,
            title,
            "Findings of the reader stand here with file and line",
        );
        return;
    }
    ScrollArea::vertical()
        .id_salt("diagnostics")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for (role, part) in loaded() {
                let diagnostics = &part.loaded.model.diagnostics;
                if diagnostics.is_empty() {
                    continue;
                }
                ui.horizontal(|ui| {
                    role_mark(ui, role);
                    ui.label(part.loaded.file_name());
                    for (kind, n) in diagnostics.counts() {
                        let n = usize::try_from(n).unwrap_or(usize::MAX);
                        caption(ui, format!("{} × {}", grouped(n), kind.label()));
                    }
                });
                for diagnostic in diagnostics.iter() {
                    row_ui(ui, diagnostic);
                }
            }
        });
}

fn row_ui(ui: &mut Ui, diagnostic: &Diagnostic) {
    let palette = Palette::of(ui);
    let (sign, color) = match diagnostic.severity() {
        Severity::Note => ("ℹ", palette.secondary),
        Severity::Warning => ("⚠", palette.check),
        Severity::Error => ("✖", palette.poor),
    };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(sign).color(color));
        let text = diagnostic.to_string();
        ui.add(egui::Label::new(text).wrap().selectable(true));
    });
}
