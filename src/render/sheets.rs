//! The depths of two sheets, drawn before the picture: where they lie in each other, each is striped
//! with the colour of the other. Both see the same stripes, so that rounding of depths does not show.

use super::pass::surface::Surface;
use super::pipeline::{DEPTH_FORMAT, SHEET_FORMAT};
use super::prepare::Prepared;
use super::scene::Sheet;
use super::slice::Slice;
use super::texture::{slice_pass, texture, view};

/// A depth picture of each sheet, one sample per pixel, with the depth buffer they share.
#[derive(Debug)]
pub(super) struct Sheets {
    first: wgpu::TextureView,
    second: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Sheets {
    pub(super) fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = drawn | wgpu::TextureUsages::TEXTURE_BINDING;
        let sheet = || view(&texture(device, size, SHEET_FORMAT, 1, read));
        Self {
            first: sheet(),
            second: sheet(),
            depth: view(&texture(device, size, DEPTH_FORMAT, 1, drawn)),
        }
    }

    /// What shaders read, first and second sheet.
    pub(super) fn views(&self) -> [&wgpu::TextureView; 2] {
        [&self.first, &self.second]
    }

    /// Records the drawing of one of them, or of a slice; `frame` is the frame's group without them.
    pub(super) fn draw(
        &self,
        (surface, sheet): (&Surface, Sheet),
        frame: &wgpu::BindGroup,
        encoder: &mut wgpu::CommandEncoder,
        prepared: &Prepared,
        slice: &mut Slice,
    ) {
        let target = match sheet {
            Sheet::First => &self.first,
            Sheet::Second => &self.second,
        };
        let mut pass = slice_pass(encoder, "sheet depth", [target, &self.depth], *slice);
        pass.set_bind_group(0, frame, &[]);
        let of_sheet = prepared.solid.iter().filter(|d| d.sheet == Some(sheet));
        for drawable in of_sheet {
            surface.draw_depth(&mut pass, drawable, slice);
        }
    }
}
