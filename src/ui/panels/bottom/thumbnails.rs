//! Small pictures of poses, drawn without the graphics card by a thread of their own.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use egui::{Color32, ColorImage, Context, Rect, Sense, TextureHandle, TextureOptions, Ui, Vec2};

use crate::app::{AppState, Part};
use crate::geometry::{Camera, MergedMesh, Point3, Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::report::picture::{Paint, Picture, PictureMesh, picture};
use crate::role::{PerRole, Role};
use crate::ui::background::{Background, Task};
use crate::ui::theme::Palette;

/// Pixels of a picture.
const SIZE: [usize; 2] = [144, 90];
/// Triangles of a mesh that is drawn so small.
const MAX_TRIANGLES: usize = 2000;
/// Air around what is seen.
const AIR: f64 = 1.2;
/// The stamped part is seen as a whole unless the crash part would become so many times smaller for it.
const MOST_SMALLER: f64 = 2.5;
/// Pictures kept at most.
const KEPT: usize = 256;

/// What a picture shows. Two of the same key look alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Key {
    parts: PerRole<u64>,
    pose: u64,
    is_dark: bool,
}

/// A mesh that is small enough for a small picture, made when first needed.
struct SmallMesh {
    part: Arc<LoadedPart>,
    level: Option<Arc<TriMesh>>,
    made: OnceLock<Arc<TriMesh>>,
}

impl SmallMesh {
    fn of(part: &Part) -> Self {
        let level = part.reduced_mesh();
        Self {
            part: part.loaded.to_arc(),
            level: (level.n_triangles() <= MAX_TRIANGLES).then(|| Arc::clone(level)),
            made: OnceLock::new(),
        }
    }

    fn get(&self) -> &Arc<TriMesh> {
        self.made.get_or_init(|| {
            let full = || Arc::clone(&self.part.mesh);
            if let Some(level) = &self.level {
                return Arc::clone(level);
            }
            if self.part.mesh.n_triangles() <= MAX_TRIANGLES {
                return full();
            }
            let small = MergedMesh::of(&self.part.mesh, MAX_TRIANGLES);
            small.map_or_else(full, |small| Arc::new(small.mesh))
        })
    }
}

/// The pictures and the thread that draws them.
pub(super) struct Thumbnails {
    background: Background<Key, Picture>,
    meshes: Option<(PerRole<u64>, PerRole<Arc<SmallMesh>>)>,
    /// Most recently drawn last; `None` for those that could not be drawn.
    ready: Vec<(Key, Option<TextureHandle>)>,
    wanted: Vec<(Key, Similarity)>,
}

/// The pictures as the frame finds them.
#[derive(Clone)]
pub(super) struct SharedThumbnails(Arc<Mutex<Thumbnails>>);

impl SharedThumbnails {
    pub fn lock(&self) -> MutexGuard<'_, Thumbnails> {
        // Only the frame locks it; a panic there ends the program.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Thumbnails {
    /// Those of this window.
    pub fn of(ctx: &Context) -> SharedThumbnails {
        let make = || {
            SharedThumbnails(Arc::new(Mutex::new(Self {
                background: Background::new("thumbnails"),
                meshes: None,
                ready: Vec::new(),
                wanted: Vec::new(),
            })))
        };
        ctx.data_mut(|data| {
            let id = egui::Id::unique("thumbnails");
            data.get_temp_mut_or_insert_with(id, make).clone()
        })
    }

    /// Shows the picture of a pose, or an empty field until it is drawn.
    pub fn show(&mut self, ui: &mut Ui, state: &AppState, pose: Option<Similarity>, size: Vec2) {
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let palette = Palette::of(ui);
        ui.painter().rect_filled(rect, 3.0, palette.field);
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "Both parts at this pose")
        });
        let Some(pose) = pose else {
            return;
        };
        let key = key_of(state, &pose, ui.visuals().dark_mode);
        let ready = self.ready.iter().find(|(known, _)| *known == key);
        match ready {
            Some((_, Some(texture))) => {
                let uv = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
                ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
            }
            Some((_, None)) => {}
            None => self.wanted.push((key, pose)),
        }
    }

    /// Takes what was drawn and asks for what [`Thumbnails::show`] missed. To be called once a frame,
    /// after the last picture.
    pub fn make(&mut self, ui: &Ui, state: &AppState) {
        let ctx = ui.ctx();
        let wanted = std::mem::take(&mut self.wanted);
        let tasks = self.tasks(wanted, state, Palette::of(ui));
        for (key, picture) in self.background.exchange(Role::Crash, tasks, ctx) {
            let texture = picture.map(|picture| {
                let size = [picture.width, picture.height];
                let image = ColorImage::from_rgba_unmultiplied(size, &picture.rgba);
                ctx.load_texture("pose", image, TextureOptions::LINEAR)
            });
            self.ready.push((key, texture));
        }
        let n_old = self.ready.len().saturating_sub(KEPT);
        self.ready.drain(..n_old);
    }

    fn tasks(
        &mut self,
        wanted: Vec<(Key, Similarity)>,
        state: &AppState,
        palette: &Palette,
    ) -> Vec<Task<Key, Picture>> {
        let Some(both) = state.document.both() else {
            return Vec::new();
        };
        let parts = state.document.stamp().parts;
        let is_known = self.meshes.as_ref().is_some_and(|(of, _)| *of == parts);
        if !is_known {
            let meshes = both.map(|part| Arc::new(SmallMesh::of(part)));
            self.meshes = Some((parts, meshes));
        }
        let Some((_, meshes)) = &self.meshes else {
            return Vec::new();
        };
        let camera = camera(both.crash);
        let colors = [palette.crash, palette.stamped].map(|c| [c.r(), c.g(), c.b()]);
        let task = |(key, pose): (Key, Similarity)| {
            let (crash, stamped) = (Arc::clone(&meshes.crash), Arc::clone(&meshes.stamped));
            let work = move || draw([&crash, &stamped], &pose, camera, colors);
            Task {
                key,
                work: Box::new(work),
            }
        };
        wanted.into_iter().map(task).collect()
    }
}

fn key_of(state: &AppState, pose: &Similarity, is_dark: bool) -> Key {
    let mut hasher = DefaultHasher::new();
    for value in pose.to_rows().into_iter().flatten() {
        value.to_bits().hash(&mut hasher);
    }
    Key {
        parts: state.document.stamp().parts,
        pose: hasher.finish(),
        is_dark,
    }
}

/// All pictures of a pair are seen along the sheet's mean normal.
fn camera(crash: &Part) -> Camera {
    let mut camera = Camera::default();
    let normal = crash.facts.mean_normal;
    if normal.norm() > 0.0 {
        camera.look_along(&-normal, &crash.bounds().corners());
    }
    camera
}

/// The camera that has both parts in the picture, or the crash part where the other lies far away.
fn around(camera: Camera, crash: &[Point3], stamped: &[Point3], pose: &Similarity) -> Camera {
    let aspect = SIZE[0] as f64 / SIZE[1] as f64;
    let mut alone = camera;
    alone.fit_to_points(crash, aspect);
    let mut both = camera;
    let stamped = stamped.iter().map(|point| pose.apply(point));
    let points: Vec<Point3> = crash.iter().copied().chain(stamped).collect();
    both.fit_to_points(&points, aspect);
    let mut camera = if both.height <= MOST_SMALLER * alone.height {
        both
    } else {
        alone
    };
    camera.height *= AIR;
    camera
}

fn draw(
    [crash, stamped]: [&SmallMesh; 2],
    pose: &Similarity,
    camera: Camera,
    [crash_color, stamped_color]: [[u8; 3]; 2],
) -> Picture {
    let camera = around(
        camera,
        crash.get().positions(),
        stamped.get().positions(),
        pose,
    );
    let fixed = Similarity::identity();
    let meshes = [
        PictureMesh {
            mesh: crash.get(),
            world_from_mesh: &fixed,
            paint: Paint::Plain(crash_color),
        },
        PictureMesh {
            mesh: stamped.get(),
            world_from_mesh: pose,
            paint: Paint::Plain(stamped_color),
        },
    ];
    let drawn = picture(SIZE, &camera, None, &meshes, &Monitor::silent());
    drawn.expect("a silent monitor is never cancelled")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;

    #[test]
    fn both_parts_are_seen_unless_one_lies_far_away() {
        let crash = [Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 0.0)];
        let height = |away: f64| {
            let pose = Similarity {
                translation: Vector3::new(away, 0.0, 0.0),
                ..Similarity::identity()
            };
            around(Camera::default(), &crash, &crash, &pose).height
        };
        assert!(height(1.0) > 1.1 * height(0.0));
        assert_eq!(height(100.0), height(0.0));
    }
}
