//! Textures that are drawn to.

use super::slice::Slice;

/// A colour attachment; with `resolve_target` only the resolved picture is kept.
pub(super) fn attachment<'a>(
    view: &'a wgpu::TextureView,
    resolve_target: Option<&'a wgpu::TextureView>,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'a> {
    // Once resolved, the samples are not needed any more.
    let store = if resolve_target.is_some() {
        wgpu::StoreOp::Discard
    } else {
        wgpu::StoreOp::Store
    };
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target,
        ops: wgpu::Operations { load, store },
    }
}

/// A pass that draws a slice of a picture with depth: the first slice clears both, the others go on.
pub(super) fn slice_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    [color, depth]: [&wgpu::TextureView; 2],
    slice: Slice,
) -> wgpu::RenderPass<'a> {
    let (clear_color, clear_depth) = if slice.is_first() {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        (clear, wgpu::LoadOp::Clear(0.0))
    } else {
        (wgpu::LoadOp::Load, wgpu::LoadOp::Load)
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(attachment(color, None, clear_color))],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations {
                load: clear_depth,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

/// A texture of `size` pixels.
pub(super) fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    sample_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("viewport"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// All of a texture.
pub(super) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
