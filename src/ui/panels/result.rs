//! The verdict card and the matrix.

use egui::{Button, RichText, Ui, vec2};

use super::explain;
use super::part_question::alike_parts_ui;
use super::tolerance::tolerance_ui;
use crate::app::{
    Action, AppState, Axis, Command, ExportCommand, MatchCommand, MatchResult, Section,
};
use crate::assess::{Ambiguity, Coverage, OneSided, Reason, alternative_words, likely_beside};
use crate::jobs::Stamp;
use crate::registration::{Alternative, group_starts};
use crate::report::distances::{OVERLAP_HELP, OVERLAP_SPREAD};
use crate::report::{DIRECTION, PoseRecord, few_agree_words, number, start_kinds};
use crate::role::{PerRole, Role};
use crate::text::{capital, fixed, sentence, vector, whole_percent};
use crate::ui::panels::mapping::STALE;
use crate::ui::panels::top_bar::copy_forms_ui;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{
    Look, action_tooltip, caption, card, chip, figure, figure_fits, focus_ring, paragraph, percent,
    plain_action, square, tight, told_button, verdict_color,
};

/// Verdict, figures, alternatives, matrix.
pub fn result_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    explain::failure_ui(ui, state, commands);
    let Some(result) = &state.document.result else {
        return;
    };
    ui.add_space(2.0);
    let top = ui.cursor().top();
    let held = HeldHeight::read(ui, (result.stamp, state.document.stamp().parts));
    card(ui, |ui| {
        let first = ui.cursor().top();
        if state.is_preview() {
            // The figures are those of the result, not of the pose that is looked at.
            ui.multiply_opacity(STALE);
        }
        if state.document.current_result().is_some() {
            verdict_ui(ui, state, result, commands);
            alike_parts_ui(ui, state, result, commands);
            if !state.is_unit_in_doubt() {
                figures_ui(ui, state, result);
                alternatives_ui(ui, state, result, commands);
            }
            explain::causes_ui(ui, state.causes(), state.is_other_hand_better(), commands);
        } else {
            outdated_ui(ui, state, result, commands);
        }
        held.hold(ui, first);
    });
    into_sight(ui, result.stamp, top);
    matrix_ui(ui, state, commands);
}

/// In the first of so many frames the sections above a new result are as high as they were without it; then they
/// have folded.
const FRAMES_TO_SIGHT: u8 = 3;

/// A new result, whose card begins at `top` and ends at the cursor, comes into sight by itself. At once: on its way to
/// a place that the card no longer has, the column would pass it.
fn into_sight(ui: &Ui, result: Stamp, top: f32) {
    let id = egui::Id::unique("stamp of the result in sight");
    let seen: Option<(Stamp, u8)> = ui.data(|data| data.get_temp(id));
    let n_before = seen.map_or(0, |(seen, n)| if seen == result { n } else { 0 });
    if n_before == FRAMES_TO_SIGHT {
        return;
    }
    ui.data_mut(|data| data.insert_temp(id, (result, n_before + 1)));
    let bottom = ui.cursor().top() + 3.0 * ROW;
    // Of a card that is higher than the column its beginning, with the verdict.
    let is_higher = bottom - top > ui.clip_rect().height();
    let align = is_higher.then_some(egui::Align::TOP);
    let card = egui::Rect::from_x_y_ranges(ui.max_rect().x_range(), top..=bottom);
    ui.scroll_to_rect_animation(card, align, egui::style::ScrollAnimation::none());
    ui.ctx().request_repaint();
}

/// A pose made by hand is worth copying too. It stands below what the part is moved with, so that the first move
/// shifts nothing there.
pub fn pose_by_hand_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_alone = state.document.result.is_none() && state.document.has_pose();
    if is_alone && state.document.has_part(Role::Stamped).is_ok() {
        matrix_ui(ui, state, commands);
    }
}

/// The height of the card, which gets lower with the first move by hand: it is kept while the pointer is
/// at what stands below it, so that a button can be clicked twice.
#[derive(Debug, Clone, Copy, Default)]
struct HeldHeight {
    /// The result and the parts that are shown: the card of others has its own height.
    of: (Stamp, PerRole<u64>),
    height: f32,
    bottom: f32,
}

impl HeldHeight {
    fn id() -> egui::Id {
        egui::Id::unique("height of the verdict card")
    }

    fn read(ui: &Ui, of: (Stamp, PerRole<u64>)) -> Self {
        let last: Option<Self> = ui.data(|data| data.get_temp(Self::id()));
        let fresh = Self {
            of,
            ..Self::default()
        };
        last.filter(|last| last.of == of).unwrap_or(fresh)
    }

    /// At the end of the card whose content began at `first`.
    fn hold(self, ui: &mut Ui, first: f32) {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let is_below = pointer.is_some_and(|at| ui.clip_rect().contains(at) && at.y > self.bottom);
        let missing = self.height - (ui.cursor().top() - first);
        if is_below && missing > 0.0 {
            ui.add_space(missing);
        }
        let bottom = ui.cursor().top();
        let now = Self {
            height: bottom - first,
            bottom,
            ..self
        };
        ui.data_mut(|data| data.insert_temp(Self::id(), now));
    }
}

/// A result that the shown pose or parts are no longer those of: quiet, with the ways on.
fn outdated_ui(ui: &mut Ui, state: &AppState, result: &MatchResult, commands: &mut Vec<Command>) {
    let reason = state.stale(Section::Match).map_or("", |stale| stale.reason);
    let color = Palette::of(ui).secondary;
    let mut title = format!("Earlier result: {}", result.verdict().label());
    title += &pose_number(state, result);
    ui.label(RichText::new(title).color(color).size(15.0));
    mirrored_ui(ui, result);
    paragraph(ui, sentence(reason));
    if let Some(coverage) = state.coverage_of(result) {
        let spread = format!(
            "{} · {}",
            state.lengths().number(coverage.rmse()),
            state.lengths().of(coverage.p95())
        );
        figure(ui, "RMS · P95 then", &spread).on_hover_text(OVERLAP_SPREAD.help);
    }
    let is_same_pair = result.stamp.parts == state.document.stamp().parts;
    ui.horizontal(|ui| {
        let can_go_back = is_same_pair && state.can_move().is_ok();
        let back = Button::new("Back to the result").min_size(vec2(0.0, ROW));
        if ui.add_enabled(can_go_back, back).clicked() {
            commands.push(MatchCommand::ShowAlternative(result.alternative).into());
        }
        plain_action(ui, state, Action::Refine, commands);
    });
}

fn verdict_ui(ui: &mut Ui, state: &AppState, result: &MatchResult, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let assessment = &result.run.assessment;
    let lengths = state.lengths();
    let verdict = result.verdict();
    ui.horizontal(|ui| {
        // As high with a preview as without.
        ui.set_min_height(ui.spacing().interact_size.y);
        let shown = state.shown_instead();
        let number = pose_number(state, result);
        let text = match &shown {
            Some(shown) => {
                let text = format!("Result: {}{number}. Shown is {shown}.", verdict.label());
                RichText::new(text).color(palette.secondary)
            }
            None => {
                let text = format!("{} {}{number}", verdict.sign(), verdict.label());
                RichText::new(text)
                    .color(verdict_color(palette, verdict))
                    .size(17.0)
            }
        };
        let label = ui.add(egui::Label::new(text).truncate());
        ui.ctx().accesskit_node_builder(label.id, |node| {
            node.set_live(egui::accesskit::Live::Polite);
        });
        // An alternative is told from the best pose, whatever the tolerance.
        if result.alternative.is_none() && shown.is_none() {
            tolerance_ui(ui, state, result, commands);
        }
    });
    mirrored_ui(ui, result);
    if let Some(alternative) = shown_alternative(result) {
        alternative_ui(ui, state, result, alternative);
        return;
    }
    let is_unit_in_doubt = state.is_unit_in_doubt();
    let n_told = if is_unit_in_doubt { 1 } else { 3 };
    for reason in assessment.reasons.iter().take(n_told) {
        paragraph(ui, sentence(&state.reason_words(reason)));
    }
    if is_unit_in_doubt {
        return;
    }
    // A reason that tells how far the pose may be off has said all that the statement would.
    let tells_offset = |reason: &Reason| matches!(reason, Reason::Uncertain { .. });
    let is_told = assessment.reasons.iter().take(n_told).any(tells_offset)
        && assessment
            .uncertainty()
            .is_some_and(|stated| stated.unknown_offset == 0.0);
    for statement in assessment.statements(lengths).iter().skip(is_told.into()) {
        paragraph(ui, sentence(statement));
    }
}

/// A pose of the opposite hand is no plain one, whatever its verdict.
fn mirrored_ui(ui: &mut Ui, result: &MatchResult) {
    let pose = result.run.pose(result.alternative);
    if pose.is_some_and(|pose| pose.is_mirrored()) {
        ui.label(RichText::new("Opposite hand: the stamped part is mirrored").strong());
    }
}

/// Of an alternative: " – pose 2 of 3".
fn pose_number(state: &AppState, result: &MatchResult) -> String {
    result.alternative.map_or_else(String::new, |index| {
        format!(" – pose {} of {}", index + 2, state.n_equal_poses())
    })
}

/// How an alternative fits beside the best pose, and the statements that the best pose has too.
fn alternative_ui(ui: &mut Ui, state: &AppState, result: &MatchResult, alternative: &Alternative) {
    let lengths = state.lengths();
    let best = &result.run.assessment.coverage;
    let (rms, p95) = (lengths.number(best.rmse()), lengths.of(best.p95()));
    let said = alternative_words(alternative.score_ratio, alternative.by_shape);
    paragraph(ui, said);
    // The same figures as below are those of this pose.
    let name = OVERLAP_SPREAD.name;
    paragraph(ui, format!("{name} at the best pose: {rms} · {p95}."));
    if state.is_unit_in_doubt() {
        return;
    }
    let said = state.alternative_statements();
    for statement in said.iter().flat_map(|said| said.sentences(lengths)) {
        paragraph(ui, sentence(&statement));
    }
}

fn shown_alternative(result: &MatchResult) -> Option<&Alternative> {
    result.run.outcome.alternatives.get(result.alternative?)
}

fn figures_ui(ui: &mut Ui, state: &AppState, result: &MatchResult) {
    ui.add_space(2.0);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        match state.result_coverage() {
            Some(coverage) => coverage_ui(ui, state, coverage),
            None => {
                caption(ui, "Measuring this pose…");
            }
        }
        let outcome = &result.run.outcome;
        let groups = group_starts(&outcome.starts, &state.stamped_extent());
        let n_same = groups.first().map_or(0, |group| group.members.len());
        figure(
            ui,
            "Converged starts",
            &format!("{n_same} of {}", outcome.starts.len()),
        );
        caption(ui, capital(&start_kinds(&outcome.starts)));
        if let Some(words) = few_agree_words(&outcome.starts, n_same) {
            caption(ui, capital(&words));
        }
        let PerRole { crash, stamped } = result.run.n_triangles;
        let on = format!(
            "■ {} ▲ {}",
            crate::ui::widgets::grouped(crash),
            crate::ui::widgets::grouped(stamped)
        );
        figure(ui, "Meshes used", &on);
    });
}

/// Overlap both ways and the spread of the distances, of the full meshes.
fn coverage_ui(ui: &mut Ui, state: &AppState, coverage: &Coverage) {
    let limit = state.lengths().of(coverage.limit);
    let over = |one: &OneSided| format!("{} within {limit}", percent(one.overlap));
    let [source, target] = [&coverage.source_on_target, &coverage.target_on_source];
    let rows = [
        ["Overlap ▲ stamped", "Overlap ▲", &over(source)],
        ["Overlap ■ crash", "Overlap ■", &over(target)],
    ];
    // In a narrow column the signs alone tell the parts apart, in both rows alike.
    let has_words = rows
        .iter()
        .all(|[name, _, value]| figure_fits(ui, name, value));
    for [name, short, value] in rows {
        figure(ui, if has_words { name } else { short }, value).on_hover_text(OVERLAP_HELP);
    }
    let (rms, p95) = (
        state.lengths().number(coverage.rmse()),
        state.lengths().of(coverage.p95()),
    );
    let spread = format!("{rms} · {p95}");
    figure(ui, OVERLAP_SPREAD.name, &spread).on_hover_text(OVERLAP_SPREAD.help);
}

/// Poses that fit nearly as well: one click or one key away.
fn alternatives_ui(
    ui: &mut Ui,
    state: &AppState,
    result: &MatchResult,
    commands: &mut Vec<Command>,
) {
    if Action::NextAlternative.enabled(state).is_err() {
        return;
    }
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let keys = Action::NextAlternative.row().shortcut();
        let keys = keys.map_or_else(String::new, |s| s.to_string());
        caption(ui, format!("Alternatives ({keys})"));
        if chip(ui, "1 best", result.alternative.is_none()).clicked() {
            commands.push(MatchCommand::ShowAlternative(None).into());
        }
        let alternatives = Ambiguity::near(&result.run.outcome.alternatives);
        for (index, alternative) in alternatives.iter().enumerate() {
            let label = match alternative.by_shape {
                true => likely_beside(alternative.score_ratio).to_owned(),
                false => format!("+{}", whole_percent(alternative.score_ratio - 1.0)),
            };
            let label = format!("{} ({label})", index + 2);
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
        let is_unmatched = state.document.current_result().is_none();
        let label = if is_unmatched {
            "Copy matrix (not matched)"
        } else {
            "Copy matrix"
        };
        let look = (label, Look::Plain, vec2(width, ROW + 4.0));
        let tooltip = format!(
            "{}\nAs {}",
            action_tooltip(Action::CopyMatrix),
            last.label()
        );
        if told_button(ui, state, Action::CopyMatrix, look, &tooltip).clicked() {
            commands.push(ExportCommand::Copy(last).into());
        }
        let menu = egui::containers::menu::MenuButton::from_button(square("▾", ROW + 4.0));
        let (button, _) = tight(ui, |ui| {
            menu.ui(ui, |ui| copy_forms_ui(ui, state, commands))
        });
        button
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Copy matrix as"));
    });
    let shown = egui::CollapsingHeader::new("Matrix, stamped → crash")
        .id_salt("matrix")
        .show_unindented(ui, |ui| {
            caption(ui, DIRECTION);
            grid_ui(ui, &pose.to_rows());
            moved_ui(ui, state);
        });
    focus_ring(ui, shown.header_response.rect, &shown.header_response);
}

/// Air between columns of digits.
const BETWEEN: f32 = 12.0;
/// Size of digits.
const DIGITS: f32 = 10.5;

/// Every digit. The rotation stands as a matrix where the column is wide enough for its digits, else below each other,
/// row after row; the shift has lines of its own, so that it is seen at once.
fn grid_ui(ui: &mut Ui, rows: &[[f64; 4]; 4]) {
    let lines = &rows[..3];
    let rotation = aligned(lines.iter().flat_map(|row| &row[..3]));
    let shift = aligned(lines.iter().map(|row| &row[3]));
    let width = |text: &String| {
        let font = egui::FontId::monospace(DIGITS);
        let color = egui::Color32::PLACEHOLDER;
        let laid = ui.painter().layout_no_wrap(text.clone(), font, color);
        laid.size().x
    };
    let widest = rotation.iter().map(width).fold(0.0, f32::max);
    let fits = 3.0 * widest + 2.0 * BETWEEN <= ui.available_width();
    digits_grid(ui, "rotation grid", |ui| {
        for (i, text) in rotation.into_iter().enumerate() {
            let (row, column) = (i / 3 + 1, i % 3 + 1);
            if !fits {
                caption(ui, format!("R{row}{column}"));
            }
            digits(ui, text);
            if !fits || column == 3 {
                ui.end_row();
            }
            if !fits && column == 3 {
                // Air between the rows of the matrix.
                ui.allocate_space(vec2(1.0, 2.0));
                ui.end_row();
            }
        }
    });
    digits_grid(ui, "translation grid", |ui| {
        for (axis, text) in Axis::ALL.into_iter().zip(shift) {
            caption(ui, format!("t {}", axis.letter()));
            digits(ui, text);
            ui.end_row();
        }
    });
}

/// Numbers with their decimal points below each other.
fn aligned<'a>(values: impl Iterator<Item = &'a f64>) -> Vec<String> {
    let texts: Vec<String> = values.map(|&value| number(value)).collect();
    let whole = |text: &str| text.find(['.', 'e']).unwrap_or(text.len());
    let most = texts.iter().map(|text| whole(text)).max().unwrap_or(0);
    let pad = |text: &String| " ".repeat(most - whole(text)) + text;
    texts.iter().map(pad).collect()
}

fn digits_grid(ui: &mut Ui, name: &str, rows: impl FnOnce(&mut Ui)) {
    egui::Grid::new(name)
        .spacing(vec2(BETWEEN, 2.0))
        .min_row_height(0.0)
        .show(ui, rows);
}

fn digits(ui: &mut Ui, text: String) {
    let text = RichText::new(text).monospace().size(DIGITS);
    ui.add(egui::Label::new(text).selectable(true).extend());
}

/// What people expect of a translation: how far the part's centre goes, and how much it turns.
fn moved_ui(ui: &mut Ui, state: &AppState) {
    let pose = state.document.crash_from_stamped();
    let Some(part) = state.document.part(Role::Stamped) else {
        return;
    };
    let center = part.bounds().center();
    let record = PoseRecord::new(pose, part.loaded.sample_node(), &center);
    let lengths = state.lengths();
    let (unit, [x, y, z]) = (
        lengths.suffix(),
        record.center_move.map(|x| lengths.number(x)),
    );
    let turn = record.rotation_axis_angle;
    let axis = vector(turn.axis, 3);
    paragraph(ui, format!("The centre moves by ({x}, {y}, {z}){unit}."));
    paragraph(
        ui,
        format!(
            "The part rotates by {}° about the axis {axis}{}.",
            fixed(turn.angle_deg, 3),
            record.mirror_words()
        ),
    );
    if let Some(node) = record.sample_node {
        let (from, to) = (vector(node.stamped, 3), vector(node.crash, 3));
        paragraph(ui, format!("Sample node {}: {from} → {to}{unit}", node.id));
    }
    caption(
        ui,
        format!(
            "det R = {}, c = {}",
            fixed(record.determinant, 9),
            number(record.scale)
        ),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_whole_and_their_points_stand_below_each_other() {
        let values = [0.999_999_999_999_999_9, -1.25, 1234.5, -2.5e-17, 1.0];
        let texts = aligned(values.iter());
        let points: Vec<_> = texts.iter().map(|text| text.find('.')).collect();
        assert!(points.iter().all(|point| *point == Some(4)), "{texts:?}");
        for (text, value) in texts.iter().zip(values) {
            assert_eq!(text.trim().parse(), Ok(value));
        }
    }

    #[test]
    fn the_height_of_a_card_is_kept_for_its_result_and_parts_alone() {
        let ctx = egui::Context::default();
        let height = |result: u64, parts: u64, content: f32| {
            let stamp = Stamp {
                pose: result,
                ..Stamp::default()
            };
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(
                    egui::Pos2::ZERO,
                    vec2(300.0, 800.0),
                )),
                events: vec![egui::Event::PointerMoved(egui::pos2(50.0, 700.0))],
                ..egui::RawInput::default()
            };
            let mut found = 0.0;
            let mut output = ctx.run_ui(input, |ui| {
                let held = HeldHeight::read(ui, (stamp, PerRole::both(parts)));
                let first = ui.cursor().top();
                ui.add_space(content);
                held.hold(ui, first);
                found = ui.cursor().top() - first;
            });
            output.textures_delta.clear();
            found
        };
        let heights = [(1, 1, 300.0), (1, 1, 100.0), (1, 2, 100.0)];
        let found = heights.map(|(result, parts, content)| height(result, parts, content));
        assert_eq!(found, [300.0, 300.0, 100.0]);
        let found = [(2, 2, 300.0), (3, 2, 100.0)].map(|(r, p, content)| height(r, p, content));
        assert_eq!(found, [300.0, 100.0]);
    }
}
