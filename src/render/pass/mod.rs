//! The passes in the order in which [`ViewTarget`](super::ViewTarget) draws them, one file and one
//! shader each.

pub(super) mod background;
pub(super) mod composite;
pub(super) mod edges;
pub(super) mod fill;
pub(super) mod outline;
pub(super) mod overlay;
pub(super) mod points;
pub(super) mod surface;

use crate::render::pipeline::Layouts;
use crate::render::prepare::{Prepared, PreparedDrawable};
use crate::render::slice::Slice;

/// The pipelines of all passes.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) background: background::Background,
    pub(super) surface: surface::Surface,
    pub(super) edges: edges::Edges,
    pub(super) points: points::Points,
    pub(super) overlay: overlay::OverlayPass,
    pub(super) outline: outline::Outline,
}

impl Passes {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        Self {
            background: background::Background::new(device, layouts),
            surface: surface::Surface::new(device, layouts),
            edges: edges::Edges::new(device, layouts),
            points: points::Points::new(device, layouts),
            overlay: overlay::OverlayPass::new(device, layouts),
            outline: outline::Outline::new(device, layouts),
        }
    }

    /// What of the multisampled picture belongs to a slice; the first has the background, the one that
    /// is not used up has what lies over the parts.
    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        prepared: &Prepared,
        slice: &mut Slice,
    ) {
        pass.set_bind_group(0, &prepared.frame, &[]);
        if prepared.opaque_background && slice.is_first() {
            self.background.draw(pass);
        }
        // Lines leave no depth behind: drawn right after their own surface, those of a sheet that lies
        // behind another are covered by it, however steep both are.
        for drawable in &prepared.solid {
            self.surface.draw_solid(pass, drawable, slice);
            self.draw_lines(pass, drawable, slice);
        }
        for drawable in &prepared.clear {
            self.surface.draw_clear(pass, drawable, slice);
            self.draw_lines(pass, drawable, slice);
        }
        if slice.left() > 0 {
            self.overlay.draw(pass, &prepared.overlay);
        }
    }

    fn draw_lines(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawable: &PreparedDrawable,
        slice: &mut Slice,
    ) {
        self.edges.draw(pass, drawable, slice);
        self.points.draw(pass, drawable, slice);
    }
}
