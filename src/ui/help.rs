//! The sheet of all keys and of the mouse.

use egui::scroll_area::ScrollBarVisibility;
use egui::style::ScrollStyle;
use egui::{Align, Label, Layout, RichText, ScrollArea, TextStyle, Ui, Vec2, vec2};

use super::overlays::{group_title, title};
use super::theme::Palette;
use crate::app::Menu;

/// A column holds the longest name and the longest keys in two lines at most.
const NARROWEST: f32 = 250.0;
/// Widest sheet.
const WIDEST: f32 = 1080.0;
/// Between two columns.
const BETWEEN: f32 = 32.0;
/// Between a name and its keys.
const GAP: f32 = 12.0;
/// Height of a line.
const LINE: f32 = 18.0;

/// The menus in the order of a sheet of three columns: by far the longest one has a column of its own, the shorter ones
/// stand before and behind it.
const OF_THREE: [Menu; Menu::ALL.len()] = [
    Menu::File,
    Menu::Edit,
    Menu::Match,
    Menu::View,
    Menu::Export,
    Menu::Help,
];

/// Keys that are no menu entries: group, and for each key what it does.
const OTHER_KEYS: [(&str, &[(&str, &str)]); 5] = [
    (
        "In a 3D window",
        &[
            ("Arrows", "Rotate"),
            ("Shift+Arrows", "Pan"),
            ("+, −", "Zoom"),
            ("P on a part", "Rotate about this point; P again: no longer"),
        ],
    ),
    (
        "In the program",
        &[
            ("Tab, Shift+Tab", "Next or previous field, tab or 3D window"),
            ("Space, Enter", "Press the button or tab with the frame"),
            ("Alt or F10", "Open the menus; Left, Right: the next one"),
            ("Esc", "Close what is open; then cancel the run"),
        ],
    ),
    (
        "While moving by keys",
        &[
            ("X, Y, Z", "Only along or about this axis"),
            ("Shift+X, Y, Z", "Only in the plane across it"),
            ("Digits", "Type the amount"),
            ("Enter", "Accept"),
            ("Esc", "Cancel"),
        ],
    ),
    (
        "On the convergence chart",
        &[("Left, Right", "Step by step")],
    ),
    (
        "Mouse",
        &[
            ("Left drag", "Rotate"),
            ("Ctrl + drag", "The same, edges only"),
            ("Ctrl + Shift + left drag", "Roll"),
            ("Middle drag", "Pan"),
            ("Wheel, right drag", "Zoom to the pointer"),
            ("Click", "Select a part"),
            ("Ctrl + click", "Add to the selection"),
            ("Double click", "Bring the part into view"),
        ],
    ),
];

/// Keys with a title.
struct Group {
    title: &'static str,
    /// What is done, and with which keys.
    rows: Vec<(&'static str, String)>,
}

/// All keys, menu by menu, and the mouse.
pub(super) fn help_ui(ui: &mut Ui, room: Vec2) {
    let width = room.x.min(WIDEST);
    ui.set_width(width);
    title(ui, "Keys and mouse", None);
    // The bar has a strip of its own, so that no keys lie under it.
    ui.spacing_mut().scroll = ScrollStyle::solid();
    let sheet = ScrollArea::vertical()
        .scroll_bar_visibility(ScrollBarVisibility::AlwaysVisible)
        .max_height(room.y)
        .min_scrolled_height(room.y);
    sheet.show(ui, |ui| {
        let width = ui.available_width();
        let n_columns = (((width + BETWEEN) / (NARROWEST + BETWEEN)) as usize).clamp(1, 3);
        let column = (width - BETWEEN * (n_columns - 1) as f32) / n_columns as f32;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing = vec2(BETWEEN, 2.0);
            for groups in in_columns(groups(n_columns), n_columns) {
                ui.vertical(|ui| {
                    ui.set_width(column);
                    column_ui(ui, &groups);
                });
            }
        });
    });
}

fn groups(n_columns: usize) -> Vec<Group> {
    let of_menu = |menu: &Menu| Group {
        title: menu.label(),
        rows: menu
            .rows()
            .filter_map(|row| Some((row.label, row.key_text()?)))
            .collect(),
    };
    let of_others = |(title, rows): &(&'static str, &'static [(&'static str, &'static str)])| {
        let rows = rows.iter().map(|(keys, what)| (*what, (*keys).to_owned()));
        Group {
            title,
            rows: rows.collect(),
        }
    };
    let menus = if n_columns == 3 {
        OF_THREE.iter()
    } else {
        Menu::ALL.iter()
    };
    let all = menus.map(of_menu).chain(OTHER_KEYS.iter().map(of_others));
    all.filter(|group| !group.rows.is_empty()).collect()
}

fn height(group: &Group) -> usize {
    group.rows.len() + 2
}

/// The groups in their order, in columns of which the highest is as low as can be.
fn in_columns(groups: Vec<Group>, n_columns: usize) -> Vec<Vec<Group>> {
    let heights: Vec<usize> = groups.iter().map(height).collect();
    let n_filled = |limit: usize| {
        let (mut n, mut filled) = (1, 0);
        for height in &heights {
            if filled > 0 && filled + height > limit {
                n += 1;
                filled = 0;
            }
            filled += height;
        }
        n
    };
    let (highest, all) = (heights.iter().max().copied(), heights.iter().sum());
    let mut limits = highest.unwrap_or(0)..all;
    let limit = limits.find(|limit| n_filled(*limit) <= n_columns);
    let limit = limit.unwrap_or(all);
    let mut columns: Vec<Vec<Group>> = vec![Vec::new()];
    let mut filled = 0;
    for group in groups {
        if filled > 0 && filled + height(&group) > limit {
            columns.push(Vec::new());
            filled = 0;
        }
        filled += height(&group);
        if let Some(column) = columns.last_mut() {
            column.push(group);
        }
    }
    columns
}

fn column_ui(ui: &mut Ui, groups: &[Group]) {
    let width = ui.available_width();
    let font = TextStyle::Body.resolve(ui.style());
    let color = Palette::of(ui).secondary;
    let keys = groups.iter().flat_map(|group| &group.rows);
    let widths = keys.map(|(_, keys)| {
        let text = ui.painter();
        let laid = text.layout_no_wrap(keys.clone(), font.clone(), color);
        laid.size().x
    });
    // Keys have a column of their own; where both are long, both take a second line.
    let keys = widths.fold(0.0_f32, f32::max).ceil().min(0.55 * width);
    for group in groups {
        group_title(ui, group.title);
        for (what, text) in &group.rows {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = GAP;
                let cell = |ui: &mut Ui, width, align, text: RichText| {
                    let layout = Layout::top_down(align);
                    ui.allocate_ui_with_layout(vec2(width, LINE), layout, |ui| {
                        ui.set_width(width);
                        ui.add(Label::new(text).wrap());
                    });
                };
                let name = width - keys - GAP;
                cell(ui, name, Align::Min, RichText::new(*what));
                cell(ui, keys, Align::Max, RichText::new(text).color(color));
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_keep_the_order_and_are_about_as_high() {
        for n_columns in 1..=3 {
            let before: Vec<_> = groups(n_columns).iter().map(|group| group.title).collect();
            let columns = in_columns(groups(n_columns), n_columns);
            assert_eq!(columns.len(), n_columns);
            let titles = columns.iter().flatten().map(|group| group.title);
            assert_eq!(titles.collect::<Vec<_>>(), before);
            let of_column = |column: &Vec<Group>| column.iter().map(height).sum();
            let heights: Vec<usize> = columns.iter().map(of_column).collect();
            let mean = heights.iter().sum::<usize>() / n_columns;
            let highest = *heights.iter().max().expect("a column");
            assert!(highest < mean * 6 / 5, "{heights:?}");
        }
    }

    #[test]
    fn every_menu_is_on_the_sheet() {
        assert!(Menu::ALL.iter().all(|menu| OF_THREE.contains(menu)));
    }
}
