//! The question which parts of a crash model are matched: before a match, where one of them is plainly the stamped one,
//! and after it, where the stamped part fits several.

use egui::{Button, Label, Ui, vec2};

use crate::app::{AppState, Command, MatchResult, PartCommand, PartRef, together};
use crate::assess::Reason;
use crate::role::Role;
use crate::text::counted;
use crate::ui::theme::ROW;
use crate::ui::widgets::{caption, card};

/// Parts that have a button each.
const MOST: usize = 4;

/// Names the part that is most like the stamped part, with a button for it and one for all; of several that are equally
/// alike each has a button, because nothing tells yet which is meant.
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
            for (place, ids) in more.choices.iter().take(MOST).enumerate() {
                let label = match (more.only(), ids.len()) {
                    (Some(_), 1) => "Match only this".to_owned(),
                    (Some(_), _) => "Match only these".to_owned(),
                    (None, _) => format!("Only {}", together(ids)),
                };
                let help = format!(
                    "The stamped part is matched to {} and to no other part",
                    more.titles(&state.document, place)
                );
                choice_ui(ui, state, (&label, &help), || {
                    commands.push(PartCommand::UseAlike(place).into());
                });
            }
            let help = "The stamped part is matched to all crash parts together";
            choice_ui(ui, state, ("Match all as one", help), || {
                commands.push(PartCommand::UseAll(Role::Crash).into());
            });
        });
        if more.choices.len() > MOST {
            more_ui(ui, more.choices.len() - MOST);
        }
    });
}

/// A button that chooses parts, while no job holds the choice.
fn choice_ui(ui: &mut Ui, state: &AppState, (label, help): (&str, &str), choose: impl FnOnce()) {
    let can = state.jobs.is_unlocked();
    let button = ui.add_enabled(can.is_ok(), Button::new(label));
    let button = match can {
        Ok(()) => button.on_hover_text(help),
        Err(reason) => button.on_disabled_hover_text(format!("{help}\n{reason}")),
    };
    if button.clicked() {
        choose();
    }
}

/// That there are more than have a button.
fn more_ui(ui: &mut Ui, n: usize) {
    caption(ui, format!("… and {n} more in the list of section 1"));
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
        more_ui(ui, ids.len() - MOST);
    }
}
