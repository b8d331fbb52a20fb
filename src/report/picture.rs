//! Small pictures of meshes without a graphics card: thumbnails, and the pictures of a report that must
//! look alike from the window and from the command line.

use crate::colormap::Rgb;
use crate::geometry::camera::ScreenSize;
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::geometry::{Camera, Similarity, TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Samples per pixel along each side; their mean smooths the edges.
const SAMPLES: usize = 2;
/// Share of light that comes from everywhere; the rest comes from the viewer.
const AMBIENT: f64 = 0.38;
/// Back sides are so much darker, as in the 3D windows.
const BACK: f64 = 0.85;
/// A jump in depth of this share of the picture's height is an outline.
const OUTLINE: f64 = 0.012;
/// Pixels from line to line of a hatch, and across a line.
const HATCH: usize = 8;
const HATCH_LINE: usize = 2;
/// Colour of outlines.
const INK: Rgb = [38, 42, 48];

/// Colours of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint<'a> {
    /// One colour, shaded.
    Plain(Rgb),
    /// A colour for each vertex, hardly shaded, so that it can be read against a legend.
    PerVertex(&'a [Rgb]),
}

/// A mesh in a picture.
#[derive(Debug, Clone, Copy)]
pub struct PictureMesh<'a> {
    /// The mesh in its own space.
    pub mesh: &'a TriMesh,
    /// Where it lies.
    pub world_from_mesh: &'a Similarity,
    /// Colour of the sheet or of its values.
    pub paint: Paint<'a>,
}

/// Pixels from the top left corner, row by row, four bytes each: red, green, blue, opacity (not
/// multiplied in), sRGB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// `4 · width · height` bytes.
    pub rgba: Vec<u8>,
}

/// Draws meshes with their outlines. Without a background the rest is transparent. Where two meshes lie
/// in one place the later one is seen. O(triangles + pixels covered); an error if `monitor` is cancelled.
pub fn picture(
    [width, height]: [usize; 2],
    camera: &Camera,
    background: Option<Rgb>,
    meshes: &[PictureMesh<'_>],
    monitor: &Monitor,
) -> Result<Picture, Cancelled> {
    let (width, height) = (width.max(1), height.max(1));
    let mut canvas = Canvas::new(width * SAMPLES, height * SAMPLES);
    let screen = ScreenSize {
        width: canvas.width as f64,
        height: canvas.height as f64,
    };
    for (place, item) in meshes.iter().enumerate() {
        // Coinciding sheets would show through each other in spots.
        let lift = place as f64 * 0.001 * camera.height;
        canvas.draw(item, (camera, screen), lift, monitor)?;
    }
    canvas.outline(OUTLINE * camera.height);
    Ok(canvas.finish(width, height, background))
}

impl Picture {
    /// This picture over another of the same size, each half transparent: where both show something
    /// the colours mix, elsewhere each keeps its own.
    #[must_use]
    pub fn mixed(mut self, other: &Self) -> Self {
        let pixels = self.rgba.as_chunks_mut::<4>().0.iter_mut();
        for (own, other) in pixels.zip(other.rgba.as_chunks::<4>().0) {
            let [a, b] = [own[3], other[3]].map(u32::from);
            for (channel, other) in own.iter_mut().zip(other).take(3) {
                let sum = u32::from(*channel) * a + u32::from(*other) * b;
                *channel = sum.checked_div(a + b).unwrap_or(0) as u8;
            }
            own[3] = own[3].max(other[3]);
        }
        self
    }

    /// This picture and another of the same size in turn, in squares of `tile` pixels; where one of
    /// them shows nothing, the other. Where lines run on from square to square, the two agree.
    #[must_use]
    pub fn chequered(mut self, other: &Self, tile: usize) -> Self {
        let (width, tile) = (self.width, tile.max(1));
        let pixels = self.rgba.as_chunks_mut::<4>().0.iter_mut();
        for (at, (own, other)) in pixels.zip(other.rgba.as_chunks::<4>().0).enumerate() {
            let is_others = (at % width / tile + at / width / tile) % 2 == 1;
            if own[3] == 0 || (is_others && other[3] > 0) {
                *own = *other;
            }
        }
        self
    }

    /// Adds lines that rise to the right where `mask`, a picture of the same size, is light.
    #[must_use]
    pub fn hatched(mut self, mask: &Self) -> Self {
        let width = self.width;
        let pixels = self.rgba.as_chunks_mut::<4>().0.iter_mut();
        for (at, (own, mask)) in pixels.zip(mask.rgba.as_chunks::<4>().0).enumerate() {
            if mask[0].min(mask[3]) > 127 && (at % width + at / width) % HATCH < HATCH_LINE {
                own[..3].copy_from_slice(&INK);
            }
        }
        self
    }

    /// The picture as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        self.to_png_with(&[])
    }

    /// The picture as a PNG file with texts: keywords of up to 79 Latin letters, and what they say.
    pub fn to_png_with(&self, texts: &[(&str, String)]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let (width, height) = (self.width as u32, self.height as u32);
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        for (keyword, text) in texts {
            // A keyword that is none is left out.
            let _ = encoder.add_itxt_chunk((*keyword).to_owned(), text.clone());
        }
        let written = encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&self.rgba));
        // Writing to memory fails only if the number of bytes is wrong, and `finish` makes as many.
        debug_assert!(written.is_ok());
        bytes
    }
}

/// A vertex on the canvas.
#[derive(Clone, Copy)]
struct Corner {
    x: f64,
    y: f64,
    depth: f64,
    color: [f64; 3],
}

struct Canvas {
    width: usize,
    height: usize,
    /// View depth, larger is nearer.
    depth: Vec<f64>,
    color: Vec<Option<Rgb>>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depth: vec![f64::NEG_INFINITY; width * height],
            color: vec![None; width * height],
        }
    }

    fn draw(
        &mut self,
        item: &PictureMesh<'_>,
        (camera, screen): (&Camera, ScreenSize),
        lift: f64,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let plain = match item.paint {
            Paint::Plain(color) => Some(color),
            Paint::PerVertex(_) => None,
        };
        let corner = |vertex: usize| {
            let world = item.world_from_mesh.apply(&item.mesh.positions()[vertex]);
            let at = camera.project(&world, screen)?;
            let color = match item.paint {
                Paint::Plain(color) => color,
                Paint::PerVertex(colors) => colors.get(vertex).copied().unwrap_or(INK),
            };
            Some(Corner {
                x: at.x,
                y: at.y,
                depth: at.depth + lift,
                color: color.map(f64::from),
            })
        };
        let corners: Vec<Option<Corner>> = map_chunks(item.mesh.n_vertices(), monitor, corner)?;
        let is_mirrored = item.world_from_mesh.rotation.determinant() < 0.0;
        let triangles = item.mesh.triangles();
        for_chunks(triangles.len(), monitor, |range| {
            for triangle in &triangles[range] {
                let [Some(a), Some(b), Some(c)] = triangle.map(|vertex| corners[vertex as usize])
                else {
                    continue;
                };
                let facing = facing([a, b, c], camera.height / screen.height);
                let is_back = (facing < 0.0) != is_mirrored;
                let full = match plain {
                    Some(_) => AMBIENT + (1.0 - AMBIENT) * facing.abs(),
                    None => 0.9 + 0.1 * facing.abs(),
                };
                let light = if is_back && plain.is_some() {
                    full * BACK
                } else {
                    full
                };
                self.fill([a, b, c], light);
            }
        })
    }

    /// Every sample inside the triangle that nothing nearer covers.
    fn fill(&mut self, [a, b, c]: [Corner; 3], light: f64) {
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let span = |values: [f64; 3], size: usize| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // The casts saturate, which clips to the canvas.
            ((low - 0.5).ceil() as usize).min(size)..((high + 0.5).floor() as usize).min(size)
        };
        for y in span([a.y, b.y, c.y], self.height) {
            for x in span([a.x, b.x, c.x], self.width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let u = ((c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x)) / area;
                let v = ((a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x)) / area;
                let w = 1.0 - u - v;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let depth = u * a.depth + v * b.depth + w * c.depth;
                let place = y * self.width + x;
                if depth > self.depth[place] {
                    self.depth[place] = depth;
                    let mix = |k: usize| u * a.color[k] + v * b.color[k] + w * c.color[k];
                    let color = std::array::from_fn(|k| (mix(k) * light).round() as u8);
                    self.color[place] = Some(color);
                }
            }
        }
    }

    /// Inks samples whose right or lower neighbour lies much further back, and the other way round.
    fn outline(&mut self, jump: f64) {
        let mut inked = Vec::new();
        for y in 0..self.height {
            for x in 0..self.width {
                let place = y * self.width + x;
                let right = (x + 1 < self.width).then_some(place + 1);
                let below = (y + 1 < self.height).then_some(place + self.width);
                for other in [right, below].into_iter().flatten() {
                    let (here, there) = (self.depth[place], self.depth[other]);
                    if here - there > jump {
                        inked.push(place);
                    } else if there - here > jump {
                        inked.push(other);
                    }
                }
            }
        }
        for place in inked {
            self.color[place] = Some(INK);
        }
    }

    /// The mean of the samples of each pixel.
    fn finish(&self, width: usize, height: usize, background: Option<Rgb>) -> Picture {
        let mut rgba = Vec::with_capacity(4 * width * height);
        for y in 0..height {
            for x in 0..width {
                let samples = (0..SAMPLES * SAMPLES).map(|k| {
                    let (dx, dy) = (k % SAMPLES, k / SAMPLES);
                    self.color[(y * SAMPLES + dy) * self.width + x * SAMPLES + dx]
                });
                rgba.extend(mean(samples.map(|sample| sample.or(background))));
            }
        }
        Picture {
            width,
            height,
            rgba,
        }
    }
}

/// Cosine between the triangle's normal and the line of sight, positive from the front. `length` is that
/// of one sample.
fn facing([a, b, c]: [Corner; 3], length: f64) -> f64 {
    let edge = |to: Corner| {
        Vector3::new(
            (to.x - a.x) * length,
            (a.y - to.y) * length,
            to.depth - a.depth,
        )
    };
    let normal = edge(b).cross(&edge(c));
    normal.z / normal.norm().max(f64::MIN_POSITIVE)
}

/// Mean colour of the covered samples, and the share of them as opacity.
fn mean(samples: impl Iterator<Item = Option<Rgb>>) -> [u8; 4] {
    let (mut sum, mut n_covered, mut n) = ([0_usize; 3], 0_usize, 0_usize);
    for sample in samples {
        n += 1;
        if let Some(color) = sample {
            n_covered += 1;
            for (sum, channel) in sum.iter_mut().zip(color) {
                *sum += usize::from(channel);
            }
        }
    }
    let channel = |k: usize| (sum[k] / n_covered.max(1)) as u8;
    let opacity = (255 * n_covered / n.max(1)) as u8;
    [channel(0), channel(1), channel(2), opacity]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;
    use crate::geometry::camera::StandardView;

    #[test]
    fn a_hatch_covers_what_is_light_in_the_mask() {
        let picture = |pixel: [u8; 4]| Picture {
            width: 16,
            height: 4,
            rgba: pixel.repeat(64),
        };
        let own = picture([200, 100, 50, 255]);
        for dark in [picture([0, 0, 0, 255]), picture([255, 255, 255, 0])] {
            assert_eq!(own.clone().hatched(&dark), own);
        }
        let hatched = own.hatched(&picture([255; 4]));
        let pixels = hatched.rgba.as_chunks::<4>().0;
        let n_inked = pixels.iter().filter(|pixel| pixel[..3] == INK).count();
        assert_eq!(n_inked, 64 * HATCH_LINE / HATCH);
        assert!(pixels.iter().all(|pixel| pixel[3] == 255));
    }

    fn square(z: f64, half: f64) -> TriMesh {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let positions = corners.map(|(x, y)| Point3::new(x * half, y * half, z));
        TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn from_above() -> Camera {
        Camera {
            world_from_view: StandardView::Top.world_from_view(),
            height: 4.0,
            ..Camera::default()
        }
    }

    fn silently(
        size: [usize; 2],
        camera: &Camera,
        background: Option<Rgb>,
        meshes: &[PictureMesh<'_>],
    ) -> Picture {
        picture(size, camera, background, meshes, &Monitor::silent()).unwrap()
    }

    fn pixel(picture: &Picture, x: usize, y: usize) -> [u8; 4] {
        let at = 4 * (y * picture.width + x);
        std::array::from_fn(|k| picture.rgba[at + k])
    }

    #[test]
    fn the_nearer_mesh_is_seen_and_the_rest_is_background() {
        let (low, high) = (square(0.0, 1.0), square(0.5, 0.5));
        let still = Similarity::identity();
        let mesh = |mesh, color| PictureMesh {
            mesh,
            world_from_mesh: &still,
            paint: Paint::Plain(color),
        };
        let meshes = [mesh(&high, [200, 0, 0]), mesh(&low, [0, 0, 200])];
        let drawn = silently([40, 40], &from_above(), Some([9, 9, 9]), &meshes);
        assert_eq!(pixel(&drawn, 1, 1), [9, 9, 9, 255]);
        assert_eq!(pixel(&drawn, 20, 20), [200, 0, 0, 255]);
        assert_eq!(pixel(&drawn, 12, 20), [0, 0, 200, 255]);
        let clear = silently([40, 40], &from_above(), None, &meshes);
        assert_eq!(pixel(&clear, 1, 1)[3], 0);
        assert_eq!(pixel(&clear, 20, 20), [200, 0, 0, 255]);
    }

    #[test]
    fn back_sides_are_darker_and_colours_of_vertices_blend() {
        let sheet = square(0.0, 1.0);
        let turned = TriMesh::new(sheet.positions().to_vec(), vec![[0, 2, 1], [0, 3, 2]]).unwrap();
        let still = Similarity::identity();
        let shown = |mesh, paint| {
            let item = PictureMesh {
                mesh,
                world_from_mesh: &still,
                paint,
            };
            pixel(&silently([40, 40], &from_above(), None, &[item]), 20, 20)
        };
        let plain = Paint::Plain([200, 200, 200]);
        assert_eq!(shown(&sheet, plain)[0], 200);
        assert_eq!(shown(&turned, plain)[0], 170);
        let colors = [[0, 0, 0], [100, 0, 0], [200, 0, 0], [100, 0, 0]];
        let [red, ..] = shown(&sheet, Paint::PerVertex(&colors));
        assert!((90..=110).contains(&red), "{red}");
    }

    #[test]
    fn mixed_pictures_show_both() {
        let pixel = |rgba: [u8; 4]| Picture {
            width: 1,
            height: 1,
            rgba: rgba.to_vec(),
        };
        let mixed = |a, b| pixel(a).mixed(&pixel(b)).rgba;
        assert_eq!(mixed([200, 0, 0, 255], [0, 100, 0, 255]), [100, 50, 0, 255]);
        assert_eq!(mixed([200, 0, 0, 255], [9, 9, 9, 0]), [200, 0, 0, 255]);
        assert_eq!(mixed([9, 9, 9, 0], [0, 100, 0, 128]), [0, 100, 0, 128]);
        assert_eq!(mixed([9, 9, 9, 0], [9, 9, 9, 0])[3], 0);
    }

    #[test]
    fn chequered_pictures_take_turns_where_both_are() {
        let row = |rgba: [[u8; 4]; 4]| Picture {
            width: 4,
            height: 1,
            rgba: rgba.concat(),
        };
        let (a, b, none) = ([1, 1, 1, 255], [2, 2, 2, 255], [0; 4]);
        let both = row([a, a, a, none]).chequered(&row([b, b, none, b]), 1);
        assert_eq!(both, row([a, b, a, b]));
        assert_eq!(row([a; 4]).chequered(&row([b; 4]), 2), row([a, a, b, b]));
    }

    #[test]
    fn a_png_reads_back_to_the_same_pixels() {
        let sheet = square(0.0, 1.0);
        let still = Similarity::identity();
        let item = PictureMesh {
            mesh: &sheet,
            world_from_mesh: &still,
            paint: Paint::Plain([10, 120, 200]),
        };
        let drawn = silently([31, 17], &from_above(), None, &[item]);
        let bytes = drawn.to_png();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut back).unwrap();
        assert_eq!((info.width, info.height), (31, 17));
        assert_eq!(back, drawn.rgba);
    }

    #[test]
    fn a_png_tells_what_it_shows() {
        let drawn = silently([4, 4], &from_above(), None, &[]);
        let texts = [
            ("Pose", "ä → 1 0\n0 1".to_owned()),
            ("Software", "x".to_owned()),
        ];
        let bytes = drawn.to_png_with(&texts);
        let reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let found = &reader.info().utf8_text;
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].keyword, "Pose");
        assert_eq!(found[0].get_text().unwrap(), texts[0].1);
    }

    #[test]
    fn points_behind_the_eye_and_meshes_off_the_canvas_are_passed_over() {
        let sheet = square(1e9, 1e12);
        let still = Similarity::identity();
        let item = PictureMesh {
            mesh: &sheet,
            world_from_mesh: &still,
            paint: Paint::Plain([1, 2, 3]),
        };
        let mut camera = from_above();
        camera.projection = crate::geometry::camera::Projection::perspective();
        let drawn = silently([8, 8], &camera, None, &[item]);
        assert!(drawn.rgba.iter().all(|&byte| byte == 0));
    }

    #[test]
    fn a_cancel_ends_a_picture() {
        let monitor = Monitor::silent();
        monitor.request_cancel();
        let square = square(0.0, 1.0);
        let item = PictureMesh {
            mesh: &square,
            world_from_mesh: &Similarity::identity(),
            paint: Paint::Plain([200, 100, 50]),
        };
        let drawn = picture([8, 8], &from_above(), None, &[item], &monitor);
        assert_eq!(drawn, Err(Cancelled));
    }
}
