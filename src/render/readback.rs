//! Textures back to the CPU.

use std::sync::mpsc;
use std::time::Duration;

/// Why a picture did not come back.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReadbackError {
    /// The device was lost or did not answer.
    #[error("the graphics device did not finish the picture")]
    Device,
}

/// Longest wait for a picture; software drivers take seconds for large ones.
const PATIENCE: Duration = Duration::from_secs(60);

/// A copy of a texture on its way to the CPU.
#[derive(Debug)]
pub(super) struct Download {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bytes_per_texel: u32,
    done: Option<mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

impl Download {
    /// Records the copy; `texture` needs `COPY_SRC`.
    pub(super) fn record(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> Self {
        let size = [texture.width(), texture.height()];
        let bytes_per_texel = texture.format().block_copy_size(None).unwrap_or(4);
        let row = padded_row(size[0], bytes_per_texel);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("download"),
            size: u64::from(row) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        Self {
            buffer,
            size,
            bytes_per_texel,
            done: None,
        }
    }

    /// Asks for the bytes; call after the commands were submitted.
    pub(super) fn start(&mut self) {
        let (sender, receiver) = mpsc::channel();
        self.buffer
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver is gone if nobody waits any more.
                let _ = sender.send(result);
            });
        self.done = Some(receiver);
    }

    /// Waits for the bytes, row by row without padding.
    pub(super) fn wait(mut self, device: &wgpu::Device) -> Result<Vec<u8>, ReadbackError> {
        let wait = wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(PATIENCE),
        };
        device.poll(wait).map_err(|_| ReadbackError::Device)?;
        // Another thread that uses the device may be the one that tells, a little later.
        let done = self.done.take().ok_or(ReadbackError::Device)?;
        match done.recv_timeout(PATIENCE) {
            Ok(Ok(())) => self.bytes(),
            Ok(Err(_)) | Err(_) => Err(ReadbackError::Device),
        }
    }

    fn bytes(&self) -> Result<Vec<u8>, ReadbackError> {
        let view = self
            .buffer
            .get_mapped_range(..)
            .map_err(|_| ReadbackError::Device)?;
        let row = padded_row(self.size[0], self.bytes_per_texel) as usize;
        let used = (self.size[0] * self.bytes_per_texel) as usize;
        Ok(view
            .chunks(row)
            .flat_map(|row| row[..used].to_vec())
            .collect())
    }
}

fn padded_row(width: u32, bytes_per_texel: u32) -> u32 {
    (width * bytes_per_texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Divides premultiplied colours by their opacity, which image files want.
pub(super) fn unpremultiply(rgba: &mut [u8]) {
    for texel in rgba.chunks_exact_mut(4) {
        let alpha = u32::from(texel[3]);
        if alpha > 0 && alpha < 255 {
            for channel in &mut texel[..3] {
                *channel = ((u32::from(*channel) * 255 + alpha / 2) / alpha).min(255) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_transparent_colours_come_back() {
        let mut rgba = [100, 50, 0, 128, 7, 8, 9, 255, 0, 0, 0, 0];
        unpremultiply(&mut rgba);
        assert_eq!(rgba, [199, 100, 0, 128, 7, 8, 9, 255, 0, 0, 0, 0]);
    }
}
