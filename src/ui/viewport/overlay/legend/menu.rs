//! The menu of a legend: which part, which map, how many colours.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, PopupCloseBehavior, RichText, Ui};

use crate::app::{Coloring, Command, Display, InspectCommand, ViewCommand};
use crate::colormap::ColorMap;
use crate::role::Role;
use crate::ui::pictures::clickable;
use crate::ui::viewport::overlay::Overlay;

/// Plain colours to choose from.
const BANDS: [u8; 4] = [5, 7, 9, 11];

/// What the colours stand for, which decides the choices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    /// Values without a sign.
    Plain,
    /// Values with a sign.
    Signed,
    /// The deviation, whose limits and parts can be chosen too.
    Deviation,
}

/// The button with the menu of maps.
pub(super) fn maps(ui: &mut Ui, over: &Overlay<'_>, values: Values, commands: &mut Vec<Command>) {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let button = Button::new(RichText::new("Colours").size(11.5)).small();
    let mut display = over.frame.state.view.display.clone();
    let menu = MenuButton::from_button(button).config(config);
    let choices_ui = |ui: &mut Ui| {
        ui.visuals_mut().override_text_color = None;
        ui.set_min_width(190.0);
        if values == Values::Deviation {
            parts(ui, &mut display.coloring);
            ui.separator();
        }
        choices(ui, &mut display.coloring, values);
        ui.separator();
        automatic(ui, over, &mut display, values, commands);
    };
    let (response, _) = clickable(ui, |ui| menu.ui(ui, choices_ui));
    let name = format!("Colour map ({})", over.role().word());
    response
        .on_hover_text("Colours, bands, pattern")
        .accessible_name(name);
    set(over, display, commands);
}

fn parts(ui: &mut Ui, coloring: &mut Coloring) {
    for (role, name) in [
        (Role::Stamped, "▲ on the stamped part"),
        (Role::Crash, "■ on the crash part"),
    ] {
        ui.checkbox(coloring.on.get_mut(role), name);
    }
}

fn choices(ui: &mut Ui, coloring: &mut Coloring, values: Values) {
    let map = match values {
        Values::Plain => &mut coloring.map,
        Values::Signed | Values::Deviation => &mut coloring.signed_map,
    };
    for choice in ColorMap::ALL {
        ui.radio_value(map, choice, choice.label());
    }
    ui.checkbox(&mut coloring.is_reversed, "Reversed");
    ui.separator();
    ui.horizontal(|ui| {
        ui.label("Bands");
        ui.selectable_value(&mut coloring.n_bands, None, "smooth");
        for n in BANDS {
            ui.selectable_value(&mut coloring.n_bands, Some(n), n.to_string());
        }
    });
    if values != Values::Plain {
        ui.checkbox(&mut coloring.has_pattern, "Pattern for the sign")
            .on_hover_text(
                "Dots for positive, lines for negative values: readable without colours",
            );
    }
}

/// Limits that follow the values again.
fn automatic(
    ui: &mut Ui,
    over: &Overlay<'_>,
    display: &mut Display,
    values: Values,
    commands: &mut Vec<Command>,
) {
    let coloring = &mut display.coloring;
    let by = over.frame.state.color_by(over.role());
    let is_set = match values {
        Values::Deviation => {
            let is_set = coloring.limits.is_some() || coloring.tolerance.is_some();
            is_set || over.frame.state.is_range_held()
        }
        Values::Plain | Values::Signed => display.limits.contains_key(&by),
    };
    let automatic = Button::new("Automatic limits");
    if !ui.add_enabled(is_set, automatic).clicked() {
        return;
    }
    if values == Values::Deviation {
        coloring.limits = None;
        coloring.tolerance = None;
        commands.push(InspectCommand::FitRange.into());
    } else {
        display.limits.remove(&by);
    }
}

/// Takes new choices over.
pub(super) fn set(over: &Overlay<'_>, display: Display, commands: &mut Vec<Command>) {
    if display != over.frame.state.view.display {
        commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    }
}
