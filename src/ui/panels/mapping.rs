//! Section 4: the forming results onto the crash part.

use egui::{Align, Layout, Ui, vec2};

use super::drop;
use super::section::section_ui;
use super::setting_form::{Gear, setting_ui};
use super::stamped_files::stamped_files_ui;
use crate::app::{
    Action, AppState, BottomTab, ColorBy, Command, DoubtfulElement, InspectCommand, MapCommand,
    MapPicture, MapResult, Quantity, Section, UnmappedElement, ViewCommand,
};
use crate::assess::Verdict;
use crate::geometry::Point3;
use crate::jobs::JobKey;
use crate::mapping::MapOptions;
use crate::pipeline::forming_values::LayerChoice;
use crate::pipeline::map::{MapRecord, PairRecord, PoseOrigin};
use crate::pipeline::names::file_name;
use crate::role::Role;
use crate::settings::{MAP_SETTINGS, Setting};
use crate::text::{Lengths, fixed, grouped, length, percent, sentence, share};
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW, TALL};
use crate::ui::widgets::{
    Look, action_button, caption, card, chip, paragraph, plain_action, secondary, wide_action,
};

/// Quantities beside each other.
const N_CHIPS: usize = 3;

/// Draws section 4.
pub fn mapping_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let summary = summary(state);
    section_ui(
        ui,
        state,
        Section::Map,
        &summary,
        commands,
        |ui, commands| {
            let ready = state.document.has_forming_results();
            // One file that can be mapped from needs no list; the way to a second stands beside the gear.
            let has_list = state.stamped_rows().len() > 1 || ready.is_err();
            if has_list && state.document.both().is_some() {
                stamped_files_ui(ui, state, commands);
            }
            if let Err(reason) = ready {
                paragraph(ui, reason.to_string());
                return;
            }
            quantities_ui(ui, state, has_list, commands);
            options_ui(ui, state, commands);
            run_ui(ui, state, commands);
            if let Some(result) = state.document.current_mapping() {
                result_ui(ui, state, result, commands);
            }
        },
    );
    drop::section_hint(ui, state);
}

fn summary(state: &AppState) -> String {
    if state.jobs.is_active(JobKey::Map) {
        return "running".to_owned();
    }
    let result = state.document.current_mapping();
    result.map_or_else(String::new, |result| {
        format!("{} of the area", percent(result.record.mapped_area))
    })
}

/// What is mapped; what the stamped file lacks is greyed with its reason.
fn quantities_ui(ui: &mut Ui, state: &AppState, has_list: bool, commands: &mut Vec<Command>) {
    let mut recipe = state.document.mapping.recipe.clone();
    // What may be greyed has a part of the window of its own, which a wrapped row would not break.
    let has_own = has_own_options(&recipe.options);
    for row in Quantity::ALL.chunks(N_CHIPS) {
        let is_last = row.len() < N_CHIPS;
        ui.horizontal(|ui| {
            for &quantity in row {
                let missing = state.document.lacks_quantity(quantity);
                let is_on = quantity.switch(&mut recipe.options.quantities);
                ui.add_enabled_ui(missing.is_none(), |ui| {
                    let response = chip(ui, quantity.label(), *is_on && missing.is_none());
                    let response = match missing {
                        Some(reason) => response.on_disabled_hover_text(reason),
                        None => response,
                    };
                    if response.clicked() {
                        *is_on ^= true;
                    }
                });
            }
            if is_last {
                RowEnd::new(ui, "quantities").show(ui, |ui| {
                    if !has_list {
                        plain_action(ui, state, Action::AddStamped, commands);
                    }
                    GEAR.ui(ui, has_own);
                });
            }
        });
    }
    if recipe != state.document.mapping.recipe {
        commands.push(MapCommand::SetRecipe(Box::new(recipe)).into());
    }
}

/// The gear that shows and hides method and limits.
const GEAR: Gear = Gear {
    id: "mapping settings are open",
    what: "mapping settings",
};

/// The method, limits and the rest, while the gear is on.
fn options_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if !GEAR.is_on(ui) {
        return;
    }
    let before = &state.document.mapping.recipe.options;
    let mut options = before.clone();
    card(ui, |ui| {
        let has_several = !state.document.mapping.further.is_empty();
        let is_shown = |row: &&Setting<MapOptions>| has_several || row.option != OVERLAP;
        for setting in MAP_SETTINGS.iter().filter(is_shown) {
            setting_ui(ui, state, setting, (&mut options, &MapOptions::default()));
        }
    });
    if options != *before {
        commands.push(MapCommand::SetOptions(Box::new(options)).into());
    }
}

/// One stamped part alone is overlapped by no other.
const OVERLAP: &str = "overlap";

/// True if a setting behind the gear is not the usual one.
fn has_own_options(options: &MapOptions) -> bool {
    let usual = MapOptions::default();
    let is_own = |row: &Setting<MapOptions>| row.get(options) != row.get(&usual);
    MAP_SETTINGS.iter().any(is_own)
}

fn run_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_running = state.jobs.is_active(JobKey::Map);
    let label = if is_running { "Cancel" } else { "Map" };
    let is_made = state.document.current_mapping().is_some();
    let is_done = is_made && !state.document.is_mapping_out_of_date();
    let is_matched = state.document.current_result().is_some();
    let has_better = state.is_other_hand_better();
    let look = if is_running || is_done || !is_matched || has_better {
        Look::Plain
    } else {
        Look::Primary
    };
    wide_action(
        ui,
        state,
        Action::MapOrCancel,
        (label, look, TALL),
        commands,
    );
    if is_running {
        let running = state.jobs.running().filter(|job| job.key == JobKey::Map);
        let words = running.map_or("Waiting for the previous task", |_| "Mapping …");
        secondary(ui, words);
    } else if state.can_map_as_loaded().is_ok() {
        caption(ui, "There is no match yet");
        let look = (Action::MapAsLoaded.row().label, Look::Plain, ROW);
        wide_action(ui, state, Action::MapAsLoaded, look, commands);
    }
    pose_ui(ui, state);
}

/// At which pose a mapping is made, of several files at their most doubtful one, and of a match why it is doubtful: a
/// permanent line wherever no good match stands for it.
fn pose_ui(ui: &mut Ui, state: &AppState) {
    if state.document.can_map().is_err() {
        return;
    }
    let poses = state.document.mapped_poses();
    let Some((n, words)) = PoseOrigin::most_doubtful(&poses, state.lengths()) else {
        return;
    };
    let (_, origin) = poses[n];
    let mut text = format!("Pose: {words}");
    // Of a poor match of a further file the list tells why.
    let verdict = Verdict::Poor;
    let is_told = n > 0 && origin == PoseOrigin::Match { verdict };
    if let Some(doubt) = state.match_doubt(n).filter(|_| !is_told) {
        text += &format!(". {}", sentence(&doubt));
    }
    let color = if origin.is_good() == Some(false) {
        Palette::of(ui).check
    } else {
        ui.visuals().weak_text_color()
    };
    ui.add(egui::Label::new(egui::RichText::new(text).color(color)).wrap());
}

fn result_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let record = &result.record;
    caption(ui, "Result");
    let stale = state.stale(Section::Map);
    if let Some(stale) = stale {
        let text = format!("Out of date: {}. Map again.", stale.reason);
        let text = egui::RichText::new(text).color(Palette::of(ui).check);
        ui.add(egui::Label::new(text).wrap());
    }
    ui.scope(|ui| {
        if stale.is_some() {
            ui.multiply_opacity(STALE);
        }
        for line in lines(record, state.lengths()) {
            ui.label(line);
        }
        for warning in &record.warnings {
            paragraph(ui, sentence(warning));
        }
        checks_ui(ui, record, commands);
    });
    picture_ui(ui, state, commands);
    doubtful_ui(ui, state, commands);
    unmapped_ui(ui, state, commands);
    other_ui(ui, state, commands);
    caption(ui, "Save");
    ui.horizontal_wrapped(|ui| {
        // All five have room in one row.
        ui.spacing_mut().button_padding.x = 5.0;
        ui.spacing_mut().item_spacing.x = 3.0;
        for (action, label) in [
            (Action::SaveMappedDeck, "Deck…"),
            (Action::SaveMappedPart, "Part…"),
            (Action::SaveMappedInclude, "Include…"),
            (Action::SaveMapReport, "Report…"),
            (Action::SaveMapTable, "Table…"),
        ] {
            let look = (label, Look::Plain, vec2(0.0, ROW));
            action_button(ui, state, action, look, commands);
        }
    });
    if state.jobs.is_exporting() {
        secondary(ui, "Saving …  Esc gives it up");
    }
}

/// How much of a result is seen that is out of date.
pub const STALE: f32 = 0.5;

/// The file that mappings are compared with, and the way out of it.
fn other_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    caption(ui, "Another result");
    let is_comparing = state.jobs.is_active(JobKey::CompareMapping);
    let label = if is_comparing {
        "Cancel"
    } else {
        "Compare with…"
    };
    let look = (label, Look::Plain, vec2(110.0, ROW));
    ui.horizontal(|ui| {
        action_button(ui, state, Action::CompareMapping, look, commands);
        let Some(file) = &state.document.mapping.compare_with else {
            return;
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let end = ("×", Look::Plain, vec2(ROW, ROW));
            let button = action_button(ui, state, Action::EndMapComparison, end, commands);
            button.accessible_name(Action::EndMapComparison.row().label);
            let name = egui::Label::new(file_name(file)).truncate();
            ui.add(name).on_hover_text(file.display().to_string());
        });
    });
}

/// How many checks are met, and the way to them.
fn checks_ui(ui: &mut Ui, record: &MapRecord, commands: &mut Vec<Command>) {
    let (n_met, n_asked) = record.n_met();
    let palette = Palette::of(ui);
    let color = if n_met == n_asked {
        palette.good
    } else {
        palette.check
    };
    let text = format!("{n_met} of {n_asked} checks met");
    let button = egui::Button::new(egui::RichText::new(text).color(color));
    let button = button.min_size(vec2(0.0, ROW));
    let response = ui.add(button);
    if response
        .on_hover_text("Checks, distributions and probe, at the bottom")
        .clicked()
    {
        commands.push(ViewCommand::SetTab(BottomTab::Mapping).into());
    }
}

/// Which quantity is shown, in which picture, of which layers.
fn picture_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let shown = state.color_by(Role::Crash);
    let is_shown = state.is_mapping_shown();
    let quantity = state.map_quantity();
    let mut chosen = None;
    caption(ui, "Quantity");
    ui.horizontal_wrapped(|ui| {
        for by in state.mapped_quantities() {
            let is_told = shown.speaks_of_quantity() || shown == by;
            if chip(ui, by.label(), is_shown && is_told && by == quantity).clicked() {
                chosen = Some(state.with_map_quantity(by));
            }
        }
    });
    caption(ui, "Picture");
    ui.horizontal_wrapped(|ui| {
        let is_values = is_shown && shown.map_picture().is_none();
        if chip(ui, "Values", is_values).clicked() {
            chosen = Some(state.with_map_picture(None));
        }
        let is_there = |picture: &MapPicture| state.missing_for(picture.color_by()).is_none();
        for picture in MapPicture::ALL.into_iter().filter(is_there) {
            let is_on = is_shown && shown == picture.color_by();
            if chip(ui, picture.label(), is_on).clicked() {
                chosen = Some(state.with_map_picture(Some(picture)));
            }
        }
    });
    let speaks_of_it = shown == quantity || shown.speaks_of_quantity();
    if let Some(layer) = state.shown_layer(quantity).filter(|_| speaks_of_it) {
        caption(ui, "Layers");
        ui.horizontal(|ui| {
            ui.spacing_mut().button_padding.x = 6.0;
            ui.spacing_mut().item_spacing.x = 4.0;
            for choice in LayerChoice::ALL {
                if chip(ui, choice.label(), choice == layer).clicked() {
                    let mut display = state.view.display.clone();
                    let usual = state.usual_layer(quantity);
                    display.mapped.layer = Some(choice).filter(|_| usual != Some(choice));
                    chosen = Some(display);
                }
            }
        });
    }
    if let Some(note) = state.layers_differ(quantity).filter(|_| speaks_of_it) {
        caption(ui, note);
    }
    if let Some(display) = chosen {
        commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    }
    // Greyed rather than gone, so that what stands below stays under the pointer.
    if state.is_mapping_apart() {
        ui.add_enabled_ui(state.can_compare_mapped(), |ui| {
            compare_ui(ui, state, commands);
        });
    }
}

/// Wipes and blinks between the mapped crash part and the stamped one at its pose.
fn compare_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    caption(ui, "Mapped and stamped in one window");
    ui.horizontal(|ui| {
        let is_wiped = state.view.display.wipe.is_some();
        let look = if is_wiped { Look::On } else { Look::Plain };
        let wipe = (Action::ToggleWipe.row().label, look, vec2(64.0, ROW));
        action_button(ui, state, Action::ToggleWipe, wipe, commands);
        let blink = egui::Button::new(Action::Blink.row().label).min_size(vec2(64.0, ROW));
        let blink = ui.add(blink);
        // The key of the same name holds it down as well.
        let (id, is_held) = (blink.id.with("held"), blink.is_pointer_button_down_on());
        if ui.data(|data| data.get_temp(id)).unwrap_or(false) != is_held {
            ui.data_mut(|data| data.insert_temp(id, is_held));
            commands.push(ViewCommand::SetBlinking(is_held).into());
        }
        let key = Action::Blink.row().shortcut();
        let key = key.map_or_else(String::new, |key| format!(" ({key})"));
        let hold = format!("Hold to see the stamped part in the place of the mapped one{key}");
        blink
            .on_hover_text(hold)
            .on_disabled_hover_text("The stamped part has no such picture: choose Values");
    });
}

/// Counts, means, and the way back.
fn lines(record: &MapRecord, lengths: Lengths) -> Vec<String> {
    let mut lines = Vec::new();
    for row in &record.statuses {
        lines.push(format!(
            "{} {} ({})",
            grouped(row.n_elements),
            row.status.label(),
            share(row.area_share)
        ));
    }
    let mean = |name: &str, pair: &Option<PairRecord>, unit: &str| {
        let pair = pair.as_ref()?;
        Some(format!(
            "{name}: mean {}{unit} ({})",
            length(pair.crash.mean),
            pair.stamped_value(&format!("{}{unit}", length(pair.stamped.mean)))
        ))
    };
    lines.extend(mean("Thickness", &record.thickness, lengths.suffix()));
    lines.extend(mean("Plastic strain", &record.plastic_strain, ""));
    if let Some(back) = &record.map_back {
        for (name, difference) in [
            ("thickness", &back.thickness),
            ("plastic strain", &back.plastic),
        ] {
            if let Some(of_range) = difference.share_of_range() {
                let off = share(of_range);
                lines.push(format!(
                    "Mapped back onto the stamped part: {name} differs by {off} of its range (P95)"
                ));
            }
        }
    }
    lines
}

/// The elements without values; a click flies there.
fn unmapped_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (elements, n) = state.unmapped_elements();
    if n == 0 {
        return;
    }
    caption(ui, format!("{} without values", grouped(n)));
    let row = |element: &UnmappedElement| {
        let text = format!("{}  {}", element.id, element.status.label());
        (text, element.center)
    };
    let rows: Vec<_> = elements.iter().map(row).collect();
    element_list(ui, "unmapped elements", (&rows, n), commands);
}

/// While the confidence is looked at: the elements that can be trusted least, the worst first; a click
/// flies there.
fn doubtful_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if !state.is_mapping_shown() || state.color_by(Role::Crash) != ColorBy::MapConfidence {
        return;
    }
    let elements = state.doubtful_elements();
    if elements.is_empty() {
        secondary(ui, "Every mapped element has a confidence of 1.00");
        return;
    }
    caption(ui, "Least confidence first");
    let row = |element: &DoubtfulElement| {
        let confidence = fixed(element.confidence, 2);
        let text = format!("{}  confidence {confidence}", element.id);
        (text, element.center)
    };
    let rows: Vec<_> = elements.iter().map(row).collect();
    element_list(ui, "doubtful elements", (&rows, rows.len()), commands);
}

/// Elements of the crash part with what is said of them, of `n` in all; a click flies there.
fn element_list(
    ui: &mut Ui,
    name: &str,
    (rows, n): (&[(String, Point3)], usize),
    commands: &mut Vec<Command>,
) {
    egui::ScrollArea::vertical()
        .id_salt(name)
        .max_height(4.0 * ROW)
        .show(ui, |ui| {
            for (text, point) in rows {
                if ui.button(text).on_hover_text("Look there").clicked() {
                    let (role, point, text) = (Role::Crash, *point, text.clone());
                    commands.push(InspectCommand::LookAt { role, point, text }.into());
                }
            }
            if n > rows.len() {
                secondary(ui, format!("and {} more", grouped(n - rows.len())));
            }
        });
}
