//! What the reader found in the files.

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use crate::app::{AppState, Command, ExportCommand};
use crate::formats::{Diagnostic, Diagnostics, Severity};
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, focus_ring, grouped, nothing_yet, role_mark};

/// Diagnostics of a kind that are shown without being asked for.
const FEW: u64 = 3;

/// File by file one line for each kind of diagnostic, which unfolds.
pub fn diagnostics_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut files = state
        .document
        .files_with_diagnostics()
        .enumerate()
        .peekable();
    if files.peek().is_none() {
        let title = match state.document.has_any_part() {
            Ok(()) => "No problems found",
            Err(_) => "No file yet",
        };
        let hint = "What the reader has to say stands here with file and line";
        nothing_yet(ui, title, hint);
        return;
    }
    ScrollArea::vertical()
        .id_salt("diagnostics")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for (number, (role, part)) in files {
                ui.horizontal(|ui| {
                    role_mark(ui, role);
                    ui.label(part.file_name());
                    if ui.small_button("Copy").clicked() {
                        let all = part.diagnostics().into_iter().flat_map(Diagnostics::iter);
                        let lines: Vec<String> = all.map(ToString::to_string).collect();
                        let (text, what) = (lines.join("\n"), "Diagnostics".to_owned());
                        commands.push(ExportCommand::CopyText { text, what }.into());
                    }
                });
                for (list, diagnostics) in part.diagnostics().into_iter().enumerate() {
                    ui.push_id((number, list), |ui| kinds_ui(ui, diagnostics));
                }
            }
        });
}

/// The most severe kinds first.
fn kinds_ui(ui: &mut Ui, diagnostics: &Diagnostics) {
    let mut kinds: Vec<_> = diagnostics.counts().filter(|(_, n)| *n > 0).collect();
    kinds.sort_by_key(|(kind, _)| std::cmp::Reverse(kind.severity()));
    for (kind, n) in kinds {
        let (sign, color) = look(ui, kind.severity());
        let count = grouped(usize::try_from(n).unwrap_or(usize::MAX));
        let title = RichText::new(format!("{sign} {count} × {}", kind.label())).color(color);
        let shown = CollapsingHeader::new(title)
            .id_salt(kind.label())
            .default_open(n <= FEW)
            .show(ui, |ui| {
                let mut n_kept = 0;
                for diagnostic in diagnostics.iter().filter(|d| d.kind == kind) {
                    row_ui(ui, diagnostic);
                    n_kept += 1;
                }
                if n_kept < n {
                    let more = usize::try_from(n - n_kept).unwrap_or(usize::MAX);
                    caption(ui, format!("and {} more of this kind", grouped(more)));
                }
            });
        focus_ring(ui, shown.header_response.rect, &shown.header_response);
    }
}

/// Sign and colour of a severity.
fn look(ui: &Ui, severity: Severity) -> (&'static str, egui::Color32) {
    let palette = Palette::of(ui);
    match severity {
        Severity::Note => ("ℹ", palette.secondary),
        Severity::Warning => ("⚠", palette.check),
        Severity::Error => ("✖", palette.poor),
    }
}

fn row_ui(ui: &mut Ui, diagnostic: &Diagnostic) {
    let text = diagnostic.to_string();
    ui.add(egui::Label::new(text).wrap().selectable(true));
}
