//! What lies under a pixel: a few pixels around it are drawn again with indices for colours.

use super::context::Context;
use super::frame::Frame;
use super::mesh_cache::MeshCache;
use super::pipeline::{DEPTH_FORMAT, Gpu, PICK_FORMAT};
use super::prepare::{Detail, Prepared};
use super::readback::{Download, ReadbackError};
use super::texture::{attachment, texture, view};
use super::uniforms::Region;

/// Pixels on each side of the cursor that still count.
const TOLERANCE: u32 = 3;
const SIDE: u32 = 2 * TOLERANCE + 1;

/// A triangle under the cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PickHit {
    /// Index into [`Scene::drawables`](super::Scene::drawables).
    pub drawable: usize,
    /// Index of the triangle in the mesh.
    pub triangle: usize,
    /// False if the cursor itself is beside it, within the tolerance of three pixels.
    pub exact: bool,
}

/// A question under way to the graphics card.
#[derive(Debug)]
pub struct PickRequest {
    download: Download,
}

impl PickRequest {
    /// Draws the area around `pixel` of the frame with the indices of what is visible.
    pub(super) fn record(
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        frame: &Frame<'_>,
        pixel: [f64; 2],
    ) -> Self {
        let corner = pixel.map(|x| x.floor() - f64::from(TOLERANCE));
        let region = Region {
            origin: corner,
            size: [f64::from(SIDE); 2],
        };
        let prepared = Prepared::new(
            gpu,
            cache,
            (frame, Detail::Exact),
            region,
            context.no_sheets.views(),
        );
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let copied = usage | wgpu::TextureUsages::COPY_SRC;
        let ids = texture(gpu.device, [SIDE; 2], PICK_FORMAT, 1, copied);
        let depth = texture(gpu.device, [SIDE; 2], DEPTH_FORMAT, 1, usage);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("pick"),
            });
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("pick"),
                color_attachments: &[Some(attachment(
                    &view(&ids),
                    None,
                    wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                ))],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &view(&depth),
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_bind_group(0, &prepared.frame, &[]);
            for drawable in prepared.all() {
                context.passes.surface.draw_pick(&mut pass, drawable);
            }
        }
        let mut download = Download::record(gpu.device, &mut encoder, &ids);
        gpu.queue.submit([encoder.finish()]);
        download.start();
        Self { download }
    }

    /// The answer if it is there (`Some(Ok(None))`: nothing lies there). Never waits; ask again next frame.
    pub fn poll(
        &mut self,
        device: &wgpu::Device,
    ) -> Option<Result<Option<PickHit>, ReadbackError>> {
        let bytes = self.download.poll(device)?;
        Some(bytes.map(|bytes| nearest_hit(&bytes)))
    }

    /// Waits for the answer: about a frame.
    pub fn wait(self, device: &wgpu::Device) -> Result<Option<PickHit>, ReadbackError> {
        Ok(nearest_hit(&self.download.wait(device)?))
    }
}

/// The hit nearest to the middle of the square; of equally near ones, the first.
fn nearest_hit(bytes: &[u8]) -> Option<PickHit> {
    let mut best: Option<(u32, PickHit)> = None;
    for (place, texel) in bytes.chunks_exact(8).enumerate() {
        let number = |at: usize| {
            let bytes: [u8; 4] = std::array::from_fn(|i| texel[at + i]);
            u32::from_le_bytes(bytes)
        };
        let (drawable, triangle) = (number(0), number(4));
        let place = place as u32;
        let (dx, dy) = (
            (place % SIDE).abs_diff(TOLERANCE),
            (place / SIDE).abs_diff(TOLERANCE),
        );
        let distance_sq = dx * dx + dy * dy;
        let nearer = best.is_none_or(|(found, _)| distance_sq < found);
        if drawable > 0 && triangle > 0 && nearer && distance_sq <= TOLERANCE * TOLERANCE {
            let hit = PickHit {
                drawable: drawable as usize - 1,
                triangle: triangle as usize - 1,
                exact: distance_sq == 0,
            };
            best = Some((distance_sq, hit));
        }
    }
    best.map(|(_, hit)| hit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hit_nearest_to_the_cursor_wins() {
        let mut texels = vec![[0u32; 2]; (SIDE * SIDE) as usize];
        assert_eq!(nearest_hit(bytemuck::cast_slice(&texels)), None);
        let at = |x: u32, y: u32| (y * SIDE + x) as usize;
        texels[at(0, 0)] = [9, 9];
        assert_eq!(
            nearest_hit(bytemuck::cast_slice(&texels)),
            None,
            "beyond the tolerance"
        );
        texels[at(5, 3)] = [1, 8];
        texels[at(3, 4)] = [2, 5];
        let hit = nearest_hit(bytemuck::cast_slice(&texels)).unwrap();
        assert_eq!((hit.drawable, hit.triangle, hit.exact), (1, 4, false));
        texels[at(3, 3)] = [1, 1];
        let hit = nearest_hit(bytemuck::cast_slice(&texels)).unwrap();
        assert_eq!((hit.drawable, hit.triangle, hit.exact), (0, 0, true));
    }
}
