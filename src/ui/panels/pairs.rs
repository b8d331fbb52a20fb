//! The picked pairs: what each is, how far it is off, and the pose they stand for.

use egui::{Align, Button, Layout, RichText, Ui, vec2};

use crate::app::{Action, AppState, Command, PairCommand, PointPair};
use crate::registration::PointPairFit;
use crate::role::Role;
use crate::text::{counted, sentence};
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{
    Look, action_button, caption, card, icon_button, paragraph, role_mark, secondary,
};

/// The card with the pairs, while the tool is on or pairs are there.
pub fn pairs_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.pairs.tool.is_none() && state.document.current_pairs().is_empty() {
        return;
    }
    ui.add_space(2.0);
    card(ui, |ui| {
        head_ui(ui, state, commands);
        let fit = state.document.pair_fit();
        for (index, pair) in state.document.current_pairs().iter().enumerate() {
            row_ui(ui, state, (index, pair), fit.as_ref().ok(), commands);
        }
        match &fit {
            Ok(fit) => doubt_ui(ui, state, fit),
            Err(missing) => {
                paragraph(ui, sentence(missing));
            }
        }
        ui.horizontal(|ui| {
            let half = (ui.available_width() - UNIT) / 2.0;
            let fit = ("Fit", Look::Primary, vec2(half, ROW));
            action_button(ui, state, Action::FitPairs, fit, commands).widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, "Fit the pairs")
            });
            let refine = ("Refine", Look::Plain, vec2(half, ROW));
            action_button(ui, state, Action::Refine, refine, commands);
        });
    });
}

fn head_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label("Point pairs");
        RowEnd::new(ui, "pairs").show(ui, |ui| {
            let button = |label: &'static str| Button::new(label).min_size(vec2(0.0, ROW));
            if !state.document.current_pairs().is_empty() && ui.add(button("Delete all")).clicked()
            {
                commands.push(PairCommand::DeleteAll.into());
            }
            let is_on = state.pairs.tool.is_some();
            let label = if is_on { "Done" } else { "Pick more" };
            if ui.add(button(label)).clicked() {
                commands.push(PairCommand::ToggleTool.into());
            }
        });
    });
    if let Some((pair, role)) = state.next_pick() {
        ui.horizontal(|ui| {
            caption(ui, format!("Pair {}: click on", pair + 1));
            role_mark(ui, role);
            caption(ui, format!("the {} part", role.word()));
        });
    }
}

fn row_ui(
    ui: &mut Ui,
    state: &AppState,
    (index, pair): (usize, &PointPair),
    fit: Option<&PointPairFit>,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label((index + 1).to_string());
        for role in Role::ALL {
            role_mark(ui, role);
            let text = match pair.get(role) {
                Some(picked) => picked.kind.word(),
                None => "–",
            };
            let name = format!("Pick pair {} on the {} part again", index + 1, role.word());
            let what = pair.get(role).map(|picked| picked.kind.words());
            let asks = state.pairs.tool.and_then(|tool| tool.repick);
            let is_asked = asks == Some((index, role));
            let button = Button::new(RichText::new(text).small()).selected(is_asked);
            let response = ui.add(button.min_size(vec2(54.0, ROW - 2.0)));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            let hint = what.map_or_else(|| name.clone(), |what| format!("{what}\n{name}"));
            if response.on_hover_text(hint).clicked() {
                commands.push(PairCommand::Repick { pair: index, role }.into());
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Delete pair {}", index + 1);
            if icon_button(ui, "✖", &name, true).clicked() {
                commands.push(PairCommand::Delete(index).into());
            }
            residual_ui(ui, state, (index, pair), fit);
        });
    });
}

/// Distance after the fit; the worst one is marked.
fn residual_ui(
    ui: &mut Ui,
    state: &AppState,
    (index, pair): (usize, &PointPair),
    fit: Option<&PointPairFit>,
) {
    let is_whole = pair.crash.is_some() && pair.stamped.is_some();
    let residual = fit
        .filter(|_| is_whole)
        .and_then(|fit| fit.residuals.get(index));
    let Some(residual) = residual else {
        secondary(ui, "–");
        return;
    };
    let text = state.lengths().of(*residual);
    if fit.and_then(PointPairFit::worst) == Some(index) {
        let color = Palette::of(ui).check;
        ui.label(RichText::new(format!("⚠ {text}")).color(color))
            .on_hover_text("The pair that fits worst");
    } else {
        secondary(ui, text);
    }
}

fn doubt_ui(ui: &mut Ui, state: &AppState, fit: &PointPairFit) {
    match state.document.pair_doubt_text(fit, state.lengths()) {
        Some(doubt) => {
            let color = Palette::of(ui).check;
            let text = RichText::new(format!("⚠ {doubt}")).color(color);
            ui.add(egui::Label::new(text).wrap());
        }
        None => {
            let pairs = counted(fit.residuals.len(), "pair");
            let rmse = state.lengths().of(fit.fit.rmse);
            caption(ui, format!("{pairs}, RMS {rmse} after the fit"));
        }
    }
}
