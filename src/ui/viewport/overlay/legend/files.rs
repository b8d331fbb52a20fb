//! Which stamped file gave the elements of a mapping their values: how many, how much area, and the way to the
//! first of each.

use egui::{RichText, Ui};

use super::status::{Class, row, sizes};
use crate::app::{Command, MapPicture};
use crate::colormap::ColorScale;
use crate::ui::viewport::overlay::Overlay;

/// A row for each file, and one for what has no values.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let state = over.frame.state;
    let title = RichText::new(MapPicture::File.label()).size(12.5);
    ui.label(title.color(over.frame.look.text));
    ui.add_space(3.0);
    let scale = ColorScale::files();
    let files = state.map_files();
    for file in &files {
        let class = Class {
            name: &file.name,
            size: (file.n_elements, file.area_share),
            first: file.first,
            look: (scale, ColorScale::file_value(file.number)),
        };
        row(ui, over, &class, commands);
    }
    let (unmapped, n) = state.unmapped_elements();
    if n > 0 && !unmapped.is_empty() {
        let given: f64 = files.iter().map(|file| file.area_share).sum();
        let class = Class {
            name: "no values",
            size: (n, (1.0 - given).max(0.0)),
            first: None,
            look: (scale, f64::NAN),
        };
        row(ui, over, &class, commands);
    }
    sizes(ui, over);
}
