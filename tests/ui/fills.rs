//! What is painted into the window without egui's sampler: large plain areas and stretched pictures.

use std::sync::Arc;

use egui::{Color32, Shape};
use image::RgbaImage;
use shapematch::app::Dialog;
use shapematch::geometry::Camera;
use shapematch::render::{Drawable, Frame, MeshInput, RenderMesh, Renderer, Scene, ViewTarget};

use super::large::wavy;
use super::layout::Window;
use super::project::drawn;
use super::render::device;
use super::story::{click, finish};

/// An area of this many square points is large: a third of the left column of a small window.
const LARGE: f32 = 40_000.0;

/// The large rectangles that egui fills.
fn large_fills(window: &Window) -> Vec<String> {
    let mut found = Vec::new();
    for clipped in &window.output().shapes {
        let Shape::Rect(rect) = &clipped.shape else {
            continue;
        };
        let seen = rect.rect.intersect(clipped.clip_rect);
        if rect.fill != Color32::TRANSPARENT && seen.is_positive() && seen.area() > LARGE {
            found.push(format!("{seen} in {:?}", rect.fill));
        }
    }
    found
}

#[test]
fn egui_fills_no_large_area_and_the_colours_are_those_of_the_theme() {
    let mut window = drawn(1.0 / 60.0);
    assert_eq!(large_fills(&window), [""; 0]);
    let shot = window.render().unwrap();
    let panel = window.ctx.global_style().visuals.panel_fill;
    let ground = Color32::from_rgb(0x1E, 0x21, 0x26);
    for (place, color) in [([6, 594], panel), ([894, 340], ground)] {
        let [x, y] = place;
        assert_eq!(shot.get_pixel(x, y).0, color.to_array(), "{place:?}");
    }
    window.key_press(egui::Key::F1);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, Some(Dialog::Help));
    assert_eq!(large_fills(&window), [""; 0], "behind a dialog");
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    click(&mut window, "Open the example pair");
    finish(&mut window);
    assert_eq!(large_fills(&window), [""; 0]);
}

/// What is painted into a window of 6 × 4 pixels of that format.
fn painted(
    format: wgpu::TextureFormat,
    paint: impl FnOnce(&mut wgpu::RenderPass<'_>),
) -> RgbaImage {
    const SIZE: wgpu::Extent3d = wgpu::Extent3d {
        width: 6,
        height: 4,
        depth_or_array_layers: 1,
    };
    let state = device();
    let texture = state.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: SIZE,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let buffer = state.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4 * 256,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = state.device.create_command_encoder(&Default::default());
    let view = texture.create_view(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::RED),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
    paint(&mut pass);
    drop(pass);
    let target = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout: wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(256),
            rows_per_image: None,
        },
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, SIZE);
    state.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
    let waiting = wgpu::PollType::wait_indefinitely();
    state.device.poll(waiting).unwrap();
    let bytes = buffer.get_mapped_range(..).unwrap();
    let row = |y: u32| bytes[256 * y as usize..][..4 * SIZE.width as usize].to_vec();
    let rgba = (0..SIZE.height).flat_map(row).collect();
    RgbaImage::from_raw(SIZE.width, SIZE.height, rgba).unwrap()
}

#[test]
fn a_fill_has_its_colour_in_every_format_of_a_window() {
    for format in [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
    ] {
        let state = device();
        let renderer = Renderer::new(&state.device, &state.queue, format);
        for color in [[0, 0, 0, 255], [0x24, 0x28, 0x2E, 255], [3, 128, 250, 255]] {
            let shot = painted(format, |pass| renderer.fill(color, pass));
            for (x, y, pixel) in shot.enumerate_pixels() {
                let off = (0..4).map(|k| pixel.0[k].abs_diff(color[k])).max();
                assert!(
                    off <= Some(1),
                    "{format:?} {x} {y}: {pixel:?}, not {color:?}"
                );
            }
        }
    }
}

#[test]
fn a_coarse_picture_is_stretched_between_the_centres_of_its_pixels() {
    let mesh = wavy();
    let drawn = Arc::new(RenderMesh::new(MeshInput::plain(&mesh)));
    let scene = Scene {
        drawables: vec![Drawable::new(drawn, [0x56, 0xB4, 0xE9])],
        ..Scene::default()
    };
    let mut camera = Camera::default();
    camera.fit_to_points(&scene.bounds().corners(), 1.5);
    let frame = Frame {
        scene: &scene,
        camera: &camera,
        size: [6, 4],
    };
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let mut renderer = Renderer::new(&device().device, &device().queue, format);
    let mut target = ViewTarget::on_processor();
    let mut encoder = device().device.create_command_encoder(&Default::default());
    renderer.draw_step(&mut target, &mut encoder, &frame);
    let coarse = renderer.read(&target, encoder).unwrap();
    assert_eq!(coarse.dimensions(), (2, 2));
    let shot = painted(format, |pass| renderer.paint(&target, pass));
    // By hand: a pixel's centre in texels, held to the centres of the outermost texels.
    for (x, y, pixel) in shot.enumerate_pixels() {
        let place = |at: u32, n: u32| (f64::from(at) + 0.5) / f64::from(n) * 2.0 - 0.5;
        let [u, v] = [place(x, 6), place(y, 4)].map(|t| t.clamp(0.0, 1.0));
        for k in 0..4 {
            let texel = |i: u32, j: u32| f64::from(coarse.get_pixel(i, j).0[k]);
            let upper = texel(0, 0) * (1.0 - u) + texel(1, 0) * u;
            let lower = texel(0, 1) * (1.0 - u) + texel(1, 1) * u;
            let expected = upper * (1.0 - v) + lower * v;
            let found = f64::from(pixel.0[k]);
            assert!(
                (found - expected).abs() <= 1.0,
                "{x} {y}: {found}, not {expected}"
            );
        }
    }
    let colors: std::collections::BTreeSet<_> = coarse.pixels().map(|pixel| pixel.0).collect();
    assert!(colors.len() > 1, "one colour proves nothing");
}
