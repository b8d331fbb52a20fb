//! Outlines of the parts in the section plane, cut off the frame.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::identity::Identity;
use super::meshes::ShownMesh;
use crate::app::{AppState, Shared};
use crate::colormap::{ColorScale, Rgb};
use crate::geometry::{
    Aabb, OutlineGap, OutlineGaps, Plane, Point3, SectionLine, Similarity, Vector3, outline_gaps,
    section,
};
use crate::pipeline::load::LoadedPart;
use crate::render::{DepthMode, Fill, Overlay, Polyline};
use crate::role::{PerRole, Role};
use crate::ui::background::{Background, Task};
use crate::ui::theme::Look;

/// What a cut was made of.
#[derive(Debug, Clone, PartialEq)]
struct CutKey {
    /// The window that shows it: each may show the same part at another pose.
    window: Role,
    role: Role,
    /// The number of a stamped file; 0 for the first and for the crash part.
    number: usize,
    mesh: Identity,
    plane: Plane,
    world_from_mesh: Similarity,
}

/// The window that shows a part, and the part.
type Place = (Role, Role, usize);

/// A part that is to be cut: whose it is, the number of its file, its mesh, where it lies.
pub(super) type Uncut = (Role, usize, Arc<ShownMesh>, Similarity);

/// The outlines that are shown.
#[derive(Default)]
pub(super) struct Cuts {
    /// Those of the crash part and of the first stamped file.
    pub parts: PerRole<Option<Arc<Cut>>>,
    /// Those of the further stamped files, by their numbers.
    pub further: BTreeMap<usize, Arc<Cut>>,
}

impl Cuts {
    /// The outline of the crash part or of a stamped file.
    pub fn of(&self, role: Role, number: usize) -> Option<&Arc<Cut>> {
        match number {
            0 => self.parts.get(role).as_ref(),
            _ => self.further.get(&number),
        }
    }

    /// Those of all stamped files.
    pub fn stamped(&self) -> impl Iterator<Item = &Arc<Cut>> {
        self.parts.stamped.iter().chain(self.further.values())
    }

    /// All of them with their styles, the crash part's first so that it lies below.
    pub fn styled(&self, look: &Look) -> Vec<(Role, LineStyle, &Arc<Cut>)> {
        let parts = self.parts.iter();
        let parts =
            parts.filter_map(|(role, cut)| Some((role, style(look, role, 0), cut.as_ref()?)));
        let further = self.further.iter();
        let further =
            further.map(|(&number, cut)| (Role::Stamped, style(look, Role::Stamped, number), cut));
        parts.chain(further).collect()
    }
}

/// How an outline is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LineStyle {
    pub rgb: Rgb,
    /// Its file shares the colour with another one, whose surface is not hatched.
    pub is_dashed: bool,
}

/// The style of an outline: the colour of the part, and the look of a further stamped file.
pub(super) fn style(look: &Look, role: Role, number: usize) -> LineStyle {
    let (rgb, is_dashed) = match number {
        0 => (*look.roles.get(role), false),
        _ => ColorScale::file_look(number),
    };
    LineStyle { rgb, is_dashed }
}

/// The outline of one part in the plane.
pub(super) struct Cut {
    /// In the space of the crash model.
    pub lines: Vec<SectionLine>,
    mesh: Arc<ShownMesh>,
    world_from_mesh: Similarity,
}

impl CutKey {
    fn place(&self) -> Place {
        (self.window, self.role, self.number)
    }
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

/// The outlines with the gaps between the crash part's and those of the stamped files.
pub(super) struct Gaps {
    pub crash: Arc<Cut>,
    pub stamped: Vec<FileGaps>,
}

/// The outline of a stamped file with its gaps.
pub(super) struct FileGaps {
    pub number: usize,
    pub cut: Arc<Cut>,
    pub found: OutlineGaps,
}

/// Gaps wider than this share of the crash outline's size are none: the parts differ there.
const WIDEST: f64 = 0.1;

impl Gaps {
    fn make(crash: Arc<Cut>, stamped: Vec<(usize, Arc<Cut>)>) -> Self {
        let points = crash.lines.iter().flat_map(|line| &line.points);
        let size = Aabb::of_points(points).diagonal();
        let measured = stamped.into_iter().map(|(number, cut)| FileGaps {
            number,
            found: outline_gaps(&crash.lines, &cut.lines, WIDEST * size),
            cut,
        });
        let stamped = measured.collect();
        Self { crash, stamped }
    }

    /// The longest of all ways.
    pub fn worst(&self) -> Option<&OutlineGap> {
        let all = self
            .stamped
            .iter()
            .filter_map(|file| file.found.worst.as_ref());
        let length = |gap: &OutlineGap| (gap.to - gap.from).norm();
        all.max_by(|a, b| length(a).total_cmp(&length(b)))
    }
}

/// Widths of an outline and of the rim that keeps it visible on its own part.
const LINE: f32 = 2.0;
const RIM: f32 = 5.0;
/// Length of the dashes of an outline, and of the gaps between them.
const DASH: f32 = 6.0;

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
    }
}

/// The outline of a part in its style, with a rim.
pub(super) fn outline(look: &Look, cut: &Cut, style: LineStyle, offset: &Vector3) -> Vec<Polyline> {
    let lines = cut.lines.iter().map(|line| {
        let first = line.points.first().filter(|_| line.is_closed);
        let points = line.points.iter().chain(first);
        points.map(|point| point + offset).collect::<Vec<_>>()
    });
    let lines: Vec<_> = lines.collect();
    let rim = if look.is_dark { 0 } else { 255 };
    let [r, g, b] = style.rgb;
    let dash = if style.is_dashed { DASH } else { 0.0 };
    let styles = [
        ([rim, rim, rim, 235], RIM, 0.0),
        ([r, g, b, 255], LINE, dash),
    ];
    let drawn = styles.into_iter().flat_map(|(color, width, dash)| {
        let line = move |points: &Vec<Point3>| Polyline {
            dash,
            ..Polyline::new(points.clone(), color, width)
        };
        lines.iter().map(line).collect::<Vec<_>>()
    });
    drawn.collect()
}

/// The numbers of the stamped files that are not hidden.
fn shown_files(state: &AppState) -> Vec<usize> {
    let first = (!state.is_first_file_hidden()).then_some(0);
    let further = state.shown_further().into_iter().map(|file| file.number);
    first.into_iter().chain(further).collect()
}

/// The outlines of all parts.
pub(super) struct SectionStore {
    background: Background<CutKey, Cut>,
    ready: BTreeMap<Place, (CutKey, Arc<Cut>)>,
    /// Those that could not be made, of what is shown.
    failed: Vec<CutKey>,
    /// The plane that cuts were asked for last.
    asked: Option<Plane>,
    /// Of gaps, the key of the crash part's cut first.
    measuring: Background<Vec<CutKey>, Gaps>,
    gaps: Option<(Vec<CutKey>, Option<Arc<Gaps>>)>,
}

impl SectionStore {
    pub fn new() -> Self {
        Self {
            background: Background::new("sections"),
            ready: BTreeMap::new(),
            failed: Vec::new(),
            asked: None,
            measuring: Background::new("gaps"),
            gaps: None,
        }
    }

    /// Asks for the cuts of what a window shows.
    pub fn update(
        &mut self,
        window: Role,
        state: &AppState,
        meshes: &[Uncut],
        wake: &egui::Context,
    ) {
        let plane = state.inspect.section.shown();
        self.asked = plane;
        let keys = plane.into_iter().flat_map(|plane| {
            let key = move |(role, number, mesh, pose): &Uncut| {
                let key = CutKey {
                    window,
                    role: *role,
                    number: *number,
                    mesh: mesh.key(),
                    plane,
                    world_from_mesh: *pose,
                };
                (key, Arc::clone(mesh))
            };
            meshes.iter().map(key)
        });
        let keys: Vec<_> = keys.collect();
        // What a window shows no longer is not taken for what it shows.
        self.ready.retain(|place, _| {
            place.0 != window || keys.iter().any(|(key, _)| key.place() == *place)
        });
        let is_shown = |failed: &CutKey| keys.iter().any(|(key, _)| key == failed);
        self.failed
            .retain(|key| key.window != window || is_shown(key));
        let is_missing = |key: &CutKey| {
            let ready = self.ready.get(&key.place());
            ready.is_none_or(|(of, _)| of != key) && !self.failed.contains(key)
        };
        let wanted = keys
            .into_iter()
            .filter(|(key, _)| is_missing(key))
            .map(|(key, mesh)| {
                let cut = key.clone();
                let work = Box::new(move || Cut::make(&cut, mesh));
                Task { key, work }
            });
        let wanted = wanted.collect();
        for (key, cut) in self.background.exchange(window, wanted, wake) {
            match cut {
                Some(cut) => {
                    self.ready.insert(key.place(), (key, Arc::new(cut)));
                }
                None => self.failed.push(key),
            }
        }
        self.measure(window, state, wake);
    }

    /// The newest outline of a part in a window, or in the other one.
    fn newest(&self, window: Role, role: Role, number: usize) -> Option<&(CutKey, Arc<Cut>)> {
        let of = |window| self.ready.get(&(window, role, number));
        of(window).or_else(|| of(window.other()))
    }

    /// Asks for the gaps between the newest outlines.
    fn measure(&mut self, window: Role, state: &AppState, wake: &egui::Context) {
        let task = self.ungauged(state).into_iter().collect();
        for (key, gaps) in self.measuring.exchange(window, task, wake) {
            self.gaps = Some((key, gaps.map(Arc::new)));
        }
    }

    /// The gaps that are to be measured, if these are not the ones that are known.
    fn ungauged(&self, state: &AppState) -> Option<Task<Vec<CutKey>, Gaps>> {
        state.inspect.section.shown()?;
        // The crash part's window is the one that shows both.
        let newest = |role, number| self.newest(Role::Crash, role, number);
        let (crash_key, crash) = newest(Role::Crash, 0)?;
        let mut key = vec![crash_key.clone()];
        let mut stamped = Vec::new();
        for number in shown_files(state) {
            let (of, cut) = newest(Role::Stamped, number)?;
            if of.plane != crash_key.plane {
                return None;
            }
            key.push(of.clone());
            stamped.push((number, Arc::clone(cut)));
        }
        let is_known = self.gaps.as_ref().is_some_and(|(of, _)| *of == key);
        let crash = Arc::clone(crash);
        (!is_known && !stamped.is_empty()).then(|| Task {
            key,
            work: Box::new(move || Gaps::make(crash, stamped)),
        })
    }

    /// The newest gaps, of the outlines that are shown or of those before them.
    pub fn gaps(&self, state: &AppState) -> Option<Arc<Gaps>> {
        let plane = state.inspect.section.shown()?;
        let (key, gaps) = self.gaps.as_ref()?;
        // Another direction has other axes, in which old outlines would be nonsense.
        let is_same = key.first()?.plane.normal == plane.normal;
        let shown = shown_files(state);
        gaps.clone().filter(|gaps| {
            let numbers = gaps.stamped.iter().map(|file| file.number);
            is_same && state.document.both().is_some() && numbers.eq(shown)
        })
    }

    /// The newest outlines of the parts that are loaded, as a window shows them, while the section is shown.
    pub fn cuts(&self, window: Role, state: &AppState) -> Cuts {
        let mut cuts = Cuts::default();
        if state.inspect.section.shown().is_none() {
            return cuts;
        }
        let ready = |(role, number), part: &Shared<LoadedPart>| {
            let (_, cut) = self.newest(window, role, number)?;
            // Its units may have been named since.
            let is_of_part = part.is_same_surface(&cut.mesh.source.part);
            is_of_part.then(|| Arc::clone(cut))
        };
        for role in Role::ALL {
            let is_hidden = role == Role::Stamped && state.is_first_file_hidden();
            let part = state.document.part(role).filter(|_| !is_hidden);
            *cuts.parts.get_mut(role) = part.and_then(|part| ready((role, 0), &part.loaded));
        }
        for file in state.shown_further() {
            let found = ready((Role::Stamped, file.number), &file.loaded);
            cuts.further.extend(found.map(|cut| (file.number, cut)));
        }
        cuts
    }

    /// True while the outlines in this plane are still to come.
    pub fn is_cutting(&self, plane: &Plane) -> bool {
        self.asked.as_ref() != Some(plane) || self.background.is_waiting()
    }

    /// True while outlines are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting() || self.measuring.is_waiting()
    }
}
