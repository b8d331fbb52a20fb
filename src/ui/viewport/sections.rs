//! Outlines of the parts in the section plane, cut off the frame.

use std::sync::Arc;

use super::meshes::{MeshKey, ShownMesh};
use crate::app::AppState;
use crate::geometry::{
    Aabb, OutlineGaps, Plane, Point3, SectionLine, Similarity, Vector3, outline_gaps, section,
};
use crate::render::{DepthMode, Fill, Overlay, Polyline};
use crate::role::{PerRole, Role};
use crate::ui::background::{Background, Task};
use crate::ui::theme::Look;

/// What a cut was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct CutKey {
    role: Role,
    mesh: MeshKey,
    plane: Plane,
    world_from_mesh: Similarity,
}

/// The outline of one part in the plane.
pub(super) struct Cut {
    /// In the space of the crash model.
    pub lines: Vec<SectionLine>,
    mesh: Arc<ShownMesh>,
    world_from_mesh: Similarity,
}

impl Cut {
    fn make(key: &CutKey, mesh: Arc<ShownMesh>) -> Self {
        let mesh_from_world = key.world_from_mesh.inverse();
        let plane = Plane::new(
            mesh_from_world.apply(&key.plane.point),
            &mesh_from_world.rotate(&key.plane.normal),
        );
        let mut lines = section(mesh.mesh(), &plane);
        for point in lines.iter_mut().flat_map(|line| &mut line.points) {
            *point = key.world_from_mesh.apply(point);
        }
        Self {
            lines,
            mesh,
            world_from_mesh: key.world_from_mesh,
        }
    }

    /// Normal of a triangle in the space of the crash model.
    pub fn normal(&self, triangle: u32) -> Vector3 {
        let normal = self.mesh.mesh().normal(triangle as usize);
        self.world_from_mesh.rotate(&normal)
    }
}

/// Both outlines with the gaps between them.
pub(super) struct Gaps {
    pub cuts: PerRole<Arc<Cut>>,
    pub found: OutlineGaps,
}

/// Gaps wider than this share of the crash outline's size are none: the parts differ there.
const WIDEST: f64 = 0.1;

impl Gaps {
    fn make(cuts: PerRole<Arc<Cut>>) -> Self {
        let points = cuts.crash.lines.iter().flat_map(|line| &line.points);
        let size = Aabb::of_points(points).diagonal();
        let found = outline_gaps(&cuts.crash.lines, &cuts.stamped.lines, WIDEST * size);
        Self { cuts, found }
    }
}

/// Widths of an outline and of the rim that keeps it visible on its own part.
const LINE: f32 = 2.0;
const RIM: f32 = 5.0;

/// Border and a breath of fill of the plane.
pub(super) fn frame(look: &Look, corners: &[Point3; 4]) -> Overlay {
    let [a, b, c, d] = *corners;
    let ink = if look.is_dark { 255 } else { 0 };
    let border = Polyline::new(vec![a, b, c, d, a], [ink, ink, ink, 130], 1.2);
    Overlay {
        polylines: vec![border],
        fills: vec![Fill {
            triangles: vec![[a, b, c], [a, c, d]],
            color: [ink, ink, ink, 14],
            depth: DepthMode::OnTop,
        }],
        ..Overlay::default()
    }
}

/// The outline of a part in its colour, with a rim.
pub(super) fn outline(
    look: &Look,
    cut: &Cut,
    color: crate::colormap::Rgb,
    offset: &Vector3,
) -> Vec<Polyline> {
    let lines = cut.lines.iter().map(|line| {
        let first = line.points.first().filter(|_| line.is_closed);
        let points = line.points.iter().chain(first);
        points.map(|point| point + offset).collect::<Vec<_>>()
    });
    let lines: Vec<_> = lines.collect();
    let rim = if look.is_dark { 0 } else { 255 };
    let [r, g, b] = color;
    let styles = [([rim, rim, rim, 235], RIM), ([r, g, b, 255], LINE)];
    let drawn = styles.into_iter().flat_map(|(color, width)| {
        let line = move |points: &Vec<Point3>| Polyline::new(points.clone(), color, width);
        lines.iter().map(line).collect::<Vec<_>>()
    });
    drawn.collect()
}

/// The outlines of both parts.
pub(super) struct SectionStore {
    background: Background<CutKey, Cut>,
    ready: PerRole<Option<(CutKey, Arc<Cut>)>>,
    failed: Vec<CutKey>,
    measuring: Background<PerRole<CutKey>, Gaps>,
    gaps: Option<(PerRole<CutKey>, Option<Arc<Gaps>>)>,
}

impl SectionStore {
    pub fn new() -> Self {
        Self {
            background: Background::new("sections"),
            ready: PerRole::default(),
            failed: Vec::new(),
            measuring: Background::new("gaps"),
            gaps: None,
        }
    }

    /// Asks for the cuts of what a window shows.
    pub fn update(
        &mut self,
        window: Role,
        state: &AppState,
        meshes: &[(Role, Arc<ShownMesh>, Similarity)],
        wake: &egui::Context,
    ) {
        let plane = state.inspect.section.shown();
        let keys = plane.into_iter().flat_map(|plane| {
            let key = move |(role, mesh, pose): &(Role, Arc<ShownMesh>, Similarity)| {
                let key = CutKey {
                    role: *role,
                    mesh: mesh.key(),
                    plane,
                    world_from_mesh: *pose,
                };
                (key, Arc::clone(mesh))
            };
            meshes.iter().map(key)
        });
        let is_missing = |key: &CutKey| {
            let ready = self.ready.get(key.role).as_ref();
            ready.is_none_or(|(of, _)| of != key) && !self.failed.contains(key)
        };
        let wanted = keys
            .filter(|(key, _)| is_missing(key))
            .map(|(key, mesh)| Task {
                key,
                work: Box::new(move || Cut::make(&key, mesh)),
            });
        let wanted = wanted.collect();
        for (key, cut) in self.background.exchange(window, wanted, wake) {
            match cut {
                Some(cut) => *self.ready.get_mut(key.role) = Some((key, Arc::new(cut))),
                None => self.failed.push(key),
            }
        }
        self.measure(window, plane.is_some(), wake);
    }

    /// Asks for the gaps between the newest outlines.
    fn measure(&mut self, window: Role, is_shown: bool, wake: &egui::Context) {
        let (crash, stamped) = (&self.ready.crash, &self.ready.stamped);
        let both = crash.as_ref().zip(stamped.as_ref()).filter(|_| is_shown);
        let task = both.and_then(|((crash_key, crash), (stamped_key, stamped))| {
            let key = PerRole::new(*crash_key, *stamped_key);
            let is_one_plane = key.crash.plane == key.stamped.plane;
            let is_known = self.gaps.as_ref().is_some_and(|(of, _)| *of == key);
            let cuts = PerRole::new(Arc::clone(crash), Arc::clone(stamped));
            (is_one_plane && !is_known).then(|| Task {
                key,
                work: Box::new(move || Gaps::make(cuts)),
            })
        });
        let wanted = task.into_iter().collect();
        for (key, gaps) in self.measuring.exchange(window, wanted, wake) {
            self.gaps = Some((key, gaps.map(Arc::new)));
        }
    }

    /// The newest gaps, of the outlines that are shown or of those before them.
    pub fn gaps(&self, state: &AppState) -> Option<Arc<Gaps>> {
        let plane = state.inspect.section.shown()?;
        let (key, gaps) = self.gaps.as_ref()?;
        // Another direction has other axes, in which old outlines would be nonsense.
        let is_same = key.crash.plane.normal == plane.normal;
        gaps.clone()
            .filter(|_| is_same && state.document.both().is_some())
    }

    /// The newest outlines of the parts that are loaded, while the section is shown.
    pub fn cuts(&self, state: &AppState) -> PerRole<Option<Arc<Cut>>> {
        let mut cuts = PerRole::default();
        if state.inspect.section.shown().is_none() {
            return cuts;
        }
        for (role, ready) in self.ready.iter() {
            let of_part = |(_, cut): &&(CutKey, Arc<Cut>)| {
                let part = state.document.part(role);
                part.is_some_and(|p| Arc::ptr_eq(&p.loaded.to_arc(), &cut.mesh.source.part))
            };
            let found = ready.as_ref().filter(of_part);
            *cuts.get_mut(role) = found.map(|(_, cut)| Arc::clone(cut));
        }
        cuts
    }

    /// True while outlines are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting() || self.measuring.is_waiting()
    }
}
