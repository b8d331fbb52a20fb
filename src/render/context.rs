//! What is made once per device.

use super::pass::{Passes, composite::Composite, fill::Fill};
use super::pipeline::Layouts;
use super::sheets::Sheets;

/// Layouts and pipelines of one device.
#[derive(Debug)]
pub(super) struct Context {
    pub(super) layouts: Layouts,
    pub(super) passes: Passes,
    pub(super) composite: Composite,
    pub(super) fill: Fill,
    /// What shaders read in place of the sheets' depths where there are none.
    pub(super) no_sheets: Sheets,
}

impl Context {
    /// Compiles all shaders. `window_format` is the format that [`Composite`] and [`Fill`] paint to.
    pub(super) fn new(device: &wgpu::Device, window_format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        Self {
            passes: Passes::new(device, &layouts),
            composite: Composite::new(device, window_format),
            fill: Fill::new(device, window_format),
            no_sheets: Sheets::new(device, [1; 2]),
            layouts,
        }
    }
}
