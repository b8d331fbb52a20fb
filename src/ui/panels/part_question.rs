//! The question which parts of a crash model are matched: before a match, where one of them is plainly the stamped one,
//! and after it, where the stamped part fits several.

use egui::{Button, Label, Ui, vec2};

use crate::app::{AppState, Command, MatchResult, PartCommand, PartRef};
use crate::assess::Reason;
use crate::role::Role;
use crate::text::counted;
use crate::ui::theme::ROW;
use crate::ui::widgets::{caption, card};

/// Parts that have a button each.
const MOST: usize = 4;

/// Names the part that is most like the stamped part, with a button for it and one for all. Of several that are equally
/// alike nothing tells yet which is meant, or of which hand they are: they have no button.
pub fn part_question_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(more) = state.part_question() else {
        return;
    };
    card(ui, |ui| {
        let title = more.title(&state.document);
        let n_used = more.n_used;
        let mut parts = state.document.parts.iter();
        let is_full = parts.all(|(_, part)| part.as_ref().is_none_or(|part| part.level.is_none()));
        let what_now = if is_full {
            ". Match tries the most alike one by one."
        } else {
            ""
        };
        let text = format!(
            "The crash model has {}. Most like the stamped part: {title}{what_now}",
            counted(n_used, "part")
        );
        ui.add(Label::new(text).wrap());
        ui.horizontal_wrapped(|ui| {
            let label = match more.only() {
                Some([_]) => Some("Match only this"),
                Some(_) => Some("Match only these"),
                None => None,
            };
            if label.is_some_and(|label| ui.button(label).clicked()) {
                commands.push(PartCommand::UseMostAlike.into());
            }
            let all = ui.button("Match all as one");
            if all
                .on_hover_text("The stamped part is matched to all crash parts together")
                .clicked()
            {
                commands.push(PartCommand::UseAll(Role::Crash).into());
            }
        });
    });
}

/// Of a result that fits several crash parts about as well: a button for each, which chooses it and matches.
pub fn alike_parts_ui(
    ui: &mut Ui,
    state: &AppState,
    result: &MatchResult,
    commands: &mut Vec<Command>,
) {
    let Some(others) = Reason::alike_parts(&result.run.assessment.reasons) else {
        return;
    };
    let matched = state
        .document
        .part(Role::Crash)
        .map(|crash| &crash.facts.used);
    // Several that are matched together are no one part.
    let matched = matched.filter(|used| used.len() == 1);
    let ids: Vec<u64> = matched
        .into_iter()
        .flatten()
        .chain(others)
        .copied()
        .collect();
    ui.add_space(4.0);
    ui.add_enabled_ui(state.can_match().is_ok(), |ui| {
        for &id in ids.iter().take(MOST) {
            let part = PartRef {
                role: Role::Crash,
                id,
            };
            let title = state.document.part_title(part);
            let button = Button::new(&title).truncate().min_size(vec2(0.0, ROW));
            let help = format!("Match with {title} and no other part");
            if ui.add(button).on_hover_text(help).clicked() {
                commands.push(PartCommand::MatchOnly(part).into());
            }
        }
    });
    if ids.len() > MOST {
        caption(
            ui,
            format!("… and {} more in the list of section 1", ids.len() - MOST),
        );
    }
}
