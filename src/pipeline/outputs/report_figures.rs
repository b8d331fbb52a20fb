//! The pictures of the report, drawn without a graphics card.

use crate::assess::PoseUncertainty;
use crate::assess::deviation::{Deviation, DeviationField};
use crate::colormap::{ColorScale, Rgb, UNMATCHED};
use crate::geometry::chunks::map_chunks;
use crate::geometry::{Camera, Matrix3, Point3, Rotation, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::palette::ROLES_ON_DARK;
use crate::pipeline::load::LoadedPart;
use crate::registration::Surface;
use crate::report::html::Figure;
use crate::report::picture::{Paint, Picture, PictureMesh, picture};
use crate::role::{PerRole, Role};
use crate::text::Lengths;

/// Colours of the two parts.
const COLORS: PerRole<Rgb> = ROLES_ON_DARK;
/// Pixels of pictures, of those of single places, and of thumbnails.
const SIZE: [usize; 2] = [720, 480];
const SPOT_SIZE: [usize; 2] = [432, 312];
const THUMB_SIZE: [usize; 2] = [240, 160];
/// Places that are drawn from near.
const N_SPOTS: usize = 3;

/// Draws the two parts of a match.
pub(super) struct FigureRenderer<'a> {
    parts: PerRole<&'a LoadedPart>,
    pose: Similarity,
    deviation: &'a Deviation,
    /// The colour of each vertex by its deviation.
    colors: PerRole<Vec<Rgb>>,
    lengths: Lengths,
    front: Rotation,
    back: Rotation,
    monitor: &'a Monitor,
}

/// From which side a sheet is seen.
#[derive(Clone, Copy)]
pub(in crate::pipeline) enum From {
    Front,
    Back,
}

impl<'a> FigureRenderer<'a> {
    pub(super) fn new(
        parts: PerRole<&'a LoadedPart>,
        pose: Similarity,
        deviation: &'a Deviation,
        scale: ColorScale,
        lengths: Lengths,
        monitor: &'a Monitor,
    ) -> Result<Self, Cancelled> {
        let fields = PerRole {
            crash: &deviation.target_on_source.field,
            stamped: &deviation.source_on_target.field,
        };
        let colors = |field: &DeviationField| {
            map_chunks(field.signed.len(), monitor, |v| {
                let value = field.compared(v);
                value.map_or(UNMATCHED, |value| scale.color(value))
            })
        };
        let view = |from| view_of(&parts.crash.surface, from);
        Ok(Self {
            parts,
            pose,
            deviation,
            colors: PerRole {
                crash: colors(fields.crash)?,
                stamped: colors(fields.stamped)?,
            },
            lengths,
            front: view(From::Front),
            back: view(From::Back),
            monitor,
        })
    }

    /// Each part in its own frame, as its file has it.
    pub(super) fn parts(&self) -> Result<Vec<Figure>, Cancelled> {
        let still = Similarity::identity();
        let stamped_view = view_of(&self.parts.stamped.surface, From::Front);
        let sides = [
            (Role::Stamped, stamped_view, "▲ Stamped part before."),
            (Role::Crash, self.front, "■ Crash part."),
        ];
        let figure = |(role, view, title): (Role, Rotation, &str)| {
            let part = self.parts.get(role);
            let camera = self.fitted(view, part.mesh.positions(), &still, SIZE)?;
            let mesh = PictureMesh {
                mesh: &part.mesh,
                world_from_mesh: &still,
                paint: Paint::Plain(*COLORS.get(role)),
            };
            let n = crate::text::grouped(part.mesh.n_triangles());
            let drawn = self.drawn(SIZE, &camera, mesh)?;
            Ok(self.figure(
                &drawn,
                title.to_owned(),
                format!("As {} has it, {n} triangles.", part.file_name()),
                format!("The {} part alone, seen at an angle", role.word()),
            ))
        };
        sides.into_iter().map(figure).collect()
    }

    /// Both parts at the pose, from both sides.
    pub(super) fn overlays(&self) -> Result<Vec<Figure>, Cancelled> {
        let views = [(self.front, "from the front"), (self.back, "from behind")];
        let figure = |(view, words): (Rotation, &str)| {
            let drawn = self.both(view, &self.pose, SIZE)?;
            let drawn = drawn.stamped.chequered(&drawn.crash, SIZE[1] / 12);
            Ok(self.figure(
                &drawn,
                "▲ on ■ after the match,".to_owned(),
                format!("{words}; both parts in turn, square by square."),
                format!("Both parts in the matched pose, seen {words}"),
            ))
        };
        views.into_iter().map(figure).collect()
    }

    /// Crash and stamped part under one camera.
    fn both(
        &self,
        view: Rotation,
        pose: &Similarity,
        size: [usize; 2],
    ) -> Result<PerRole<Picture>, Cancelled> {
        let still = Similarity::identity();
        let mut camera = self.fitted(view, self.parts.crash.mesh.positions(), &still, size)?;
        let moved = self.fitted(view, self.parts.stamped.mesh.positions(), pose, size)?;
        let is_near = (camera.target - moved.target).norm() < 0.5 * camera.height;
        camera.height = if is_near {
            camera.height.max(moved.height) * 1.04
        } else {
            camera.height * 1.3
        };
        let draw = |role| {
            let mesh = PictureMesh {
                mesh: &self.parts.get(role).mesh,
                world_from_mesh: match role {
                    Role::Crash => &still,
                    Role::Stamped => pose,
                },
                paint: Paint::Plain(*COLORS.get(role)),
            };
            self.drawn(size, &camera, mesh)
        };
        Ok(PerRole {
            crash: draw(Role::Crash)?,
            stamped: draw(Role::Stamped)?,
        })
    }

    /// Both parts in the colours of their deviation.
    pub(super) fn maps(&self) -> Result<Vec<Figure>, Cancelled> {
        let on_crash = PictureMesh {
            mesh: &self.parts.crash.mesh,
            world_from_mesh: &Similarity::identity(),
            paint: Paint::PerVertex(&self.colors.crash),
        };
        let sides = [
            (
                self.map_mesh(),
                "▲ Stamped part,",
                "distance to the crash part.",
            ),
            (on_crash, "■ Crash part,", "distance to the stamped part."),
        ];
        let figure = |(mesh, title, caption): (PictureMesh<'_>, &str, &str)| {
            let camera = self.fitted(
                self.front,
                mesh.mesh.positions(),
                mesh.world_from_mesh,
                SIZE,
            )?;
            let drawn = self.drawn(SIZE, &camera, mesh)?;
            let alt = format!("Map of the distances. {title} {caption}");
            Ok(self.figure(&drawn, title.to_owned(), caption.to_owned(), alt))
        };
        sides.into_iter().map(figure).collect()
    }

    fn map_mesh(&self) -> PictureMesh<'_> {
        PictureMesh {
            mesh: &self.parts.stamped.mesh,
            world_from_mesh: &self.pose,
            paint: Paint::PerVertex(&self.colors.stamped),
        }
    }

    /// The largest deviations from near.
    pub(super) fn spots(&self) -> Result<Vec<Figure>, Cancelled> {
        let surface = &self.parts.stamped.surface;
        let [edge, _] = self.deviation.mean_edge_lengths;
        let size = self.parts.stamped.mesh.aabb().diagonal() * self.pose.scale;
        let spots = self.deviation.source_on_target.spots.iter().take(N_SPOTS);
        let figure = |(i, spot): (usize, &crate::assess::deviation::Spot)| {
            let vertex = spot.vertex as usize;
            let normal = surface
                .vertex_normals()
                .get(surface.vertex_of()[vertex] as usize);
            let normal = self.pose.rotate(normal.unwrap_or(&Vector3::zeros()));
            let toward = self.front * Vector3::z();
            let normal = if normal.dot(&toward) < 0.0 {
                -normal
            } else {
                normal
            };
            let camera = Camera {
                target: self.pose.apply(&spot.position),
                world_from_view: looking(&(normal + 0.6 * toward), &(self.front * Vector3::y())),
                height: (14.0 * edge).max(0.12 * size),
                ..Camera::default()
            };
            let number = i + 1;
            let value = self.lengths.of(spot.value);
            let node = self.parts.stamped.node_id(spot.vertex);
            let node = node.map_or_else(String::new, |id| format!(" at node {id}"));
            Ok(Figure {
                is_marked: true,
                ..self.figure(
                    &self.drawn(SPOT_SIZE, &camera, self.map_mesh())?,
                    format!("{number}: {value}"),
                    format!("{node}."),
                    format!("Place {number} of the largest deviations from near, {value}"),
                )
            })
        };
        spots.enumerate().map(figure).collect()
    }

    /// The stamped part in the colours of how far the pose may be off.
    pub(super) fn uncertainty(
        &self,
        stated: &PoseUncertainty,
        scale: &ColorScale,
    ) -> Result<Vec<Figure>, Cancelled> {
        let positions = self.parts.stamped.mesh.positions();
        let values = stated.field(positions, &self.pose);
        let colors: Vec<Rgb> = values.iter().map(|&value| scale.color(value)).collect();
        let mesh = PictureMesh {
            paint: Paint::PerVertex(&colors),
            ..self.map_mesh()
        };
        let camera = self.fitted(self.front, positions, &self.pose, SIZE)?;
        let largest = self.lengths.of(stated.largest);
        Ok(vec![self.figure(
            &self.drawn(SIZE, &camera, mesh)?,
            "▲ Stamped part,".to_owned(),
            format!("how far each node may be off, at most ± {largest}."),
            format!("Map of the uncertainty of the pose, at most {largest}"),
        )])
    }

    /// Both parts at another pose.
    pub(super) fn rival(
        &self,
        pose: &Similarity,
        title: String,
        caption: String,
    ) -> Result<Figure, Cancelled> {
        let drawn = self.both(self.front, pose, SPOT_SIZE)?;
        let drawn = drawn.stamped.chequered(&drawn.crash, SPOT_SIZE[1] / 12);
        let alt = format!("Both parts at pose {title}");
        Ok(self.figure(&drawn, title, caption, alt))
    }

    /// Where a start ended.
    pub(super) fn start(&self, pose: &Similarity, number: usize) -> Result<Figure, Cancelled> {
        let drawn = self.both(self.front, pose, THUMB_SIZE)?;
        let drawn = drawn.stamped.mixed(&drawn.crash);
        let alt = format!("Both parts as pose {number} has them");
        Ok(self.figure(&drawn, String::new(), String::new(), alt))
    }

    /// One mesh in a picture, unless the report was given up.
    fn drawn(
        &self,
        size: [usize; 2],
        camera: &Camera,
        mesh: PictureMesh<'_>,
    ) -> Result<Picture, Cancelled> {
        picture(size, camera, None, &[mesh], self.monitor)
    }

    fn fitted(
        &self,
        view: Rotation,
        points: &[Point3],
        pose: &Similarity,
        size: [usize; 2],
    ) -> Result<Camera, Cancelled> {
        fitted(view, points, pose, size, self.monitor)
    }

    fn figure(&self, drawn: &Picture, title: String, caption: String, alt: String) -> Figure {
        Figure {
            png: drawn.to_png(),
            size: [drawn.width, drawn.height],
            alt,
            title,
            caption,
            is_marked: false,
        }
    }
}

/// Fits a view to points under a motion.
pub(in crate::pipeline) fn fitted(
    view: Rotation,
    points: &[Point3],
    pose: &Similarity,
    [width, height]: [usize; 2],
    monitor: &Monitor,
) -> Result<Camera, Cancelled> {
    let moved = map_chunks(points.len(), monitor, |i| pose.apply(&points[i]))?;
    let mut camera = Camera {
        world_from_view: view,
        ..Camera::default()
    };
    camera.fit_to_points(&moved, width as f64 / height as f64);
    Ok(camera)
}

/// A view on the broad side of a sheet, from a little below and aside; upright where the part is.
pub(in crate::pipeline) fn view_of(surface: &Surface, from: From) -> Rotation {
    let measures = surface.measures();
    let axes = measures.principal_axes;
    let (mut long, mut mid) = (Vector3::from(axes.column(0)), Vector3::from(axes.column(1)));
    let mut broad = Vector3::from(axes.column(2));
    if measures.mean_normal.dot(&broad) < 0.0 {
        broad = -broad;
    }
    if matches!(from, From::Back) {
        broad = -broad;
    }
    // What is up in the car is up in the picture.
    if mid.z < -0.1 || (mid.z.abs() <= 0.1 && mid.y < 0.0) {
        mid = -mid;
    }
    if long.cross(&mid).dot(&broad) < 0.0 {
        long = -long;
    }
    looking(&(0.8 * broad - 0.5 * mid + 0.32 * long), &mid)
}

/// The view from `back` with `up` upwards.
fn looking(back: &Vector3, up: &Vector3) -> Rotation {
    let back = back.try_normalize(1e-12).unwrap_or_else(Vector3::z);
    let right = up.cross(&back).try_normalize(1e-9);
    let right = right.unwrap_or_else(|| {
        Vector3::y()
            .cross(&back)
            .try_normalize(1e-9)
            .unwrap_or_else(Vector3::x)
    });
    let matrix = Matrix3::from_columns(&[right, back.cross(&right), back]);
    Rotation::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix))
}
