//! What is told of the tools in a stamped file: which parts were left out as tools, and which may be some because they
//! lie on each other over most of their area.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::load::LoadedPart;
use crate::formats::{Diagnostic, DiagnosticKind, Model};
use crate::geometry::TriMesh;
use crate::monitor::{Cancelled, Monitor};
use crate::search::{Bvh, ClosestPoint as _};
use crate::text::{counted, parts_by_id};

/// Tools that are named by their ids.
const N_NAMED_TOOLS: usize = 6;
/// Parts with less than this share of the area of the largest one are not compared, and no more than so many are.
const LEAST_AREA: f64 = 0.2;
const MOST_PARTS: usize = 8;
/// Triangles of the smaller of two parts that are looked at, spread over it.
const N_SAMPLE: usize = 400;
/// Share of their area that has the other part beside it.
const LEAST_COVERED: f64 = 0.6;
/// Cosine between normals of surfaces that lie on each other.
const ALIKE: f64 = 0.8;
/// Distance of surfaces that lie on each other: in thicknesses of the sheet, and as a fraction of the part's size.
const NEAR_THICKNESS: f64 = 2.0;
const NEAR_SIZE: f64 = 0.005;

/// Says which parts of a file are left out as tools of the forming simulation; `None` if none are.
pub fn tools_line(file_name: &str, tools: &[u64]) -> Option<String> {
    let which = match tools.len() {
        0 => return None,
        1..=N_NAMED_TOOLS => parts_by_id(tools),
        n => counted(n, "part"),
    };
    Some(format!(
        "{file_name}: {which} left out as tools, which are rigid, without forming results or of even thickness"
    ))
}

impl LoadedPart {
    /// Says which of its parts lie on each other and are taken as one part; `None` if none do.
    pub fn stacked_line(&self) -> Option<String> {
        let mut told = self.surface_diagnostics.iter();
        let stacked = told.find(|one| one.kind == DiagnosticKind::StackedParts)?;
        Some(format!("{}: {}", self.file_name(), stacked.message))
    }
}

/// A warning that names the parts of a mesh that lie on each other; `None` if none do. `parts` are those of the
/// triangles, as indices into those of the model.
pub(super) fn stacked_parts(
    (model, mesh): (&Model, &TriMesh),
    parts: &[u32],
    thickness: Option<f64>,
    monitor: &Monitor,
) -> Result<Option<Diagnostic>, Cancelled> {
    let sheets = sheets(mesh, parts, monitor)?;
    let mut is_stacked = vec![false; sheets.len()];
    for (large, sheet) in sheets.iter().enumerate() {
        for small in large + 1..sheets.len() {
            monitor.check()?;
            if (!is_stacked[large] || !is_stacked[small]) && sheets[small].lies_on(sheet, thickness)
            {
                (is_stacked[large], is_stacked[small]) = (true, true);
            }
        }
    }
    let stacked = sheets.iter().zip(is_stacked).filter(|(_, is_one)| *is_one);
    let mut ids: Vec<u64> = stacked
        .map(|(sheet, _)| model.parts[sheet.part as usize].id)
        .collect();
    ids.sort_unstable();
    Ok((!ids.is_empty()).then(|| {
        let message = format!(
            "{} lie on each other over most of their area, as a sheet and its tools do, and are taken as one part; choose \
             the sheet alone (--stamped-part) where the others are tools",
            parts_by_id(&ids)
        );
        Diagnostic::new(DiagnosticKind::StackedParts, message)
    }))
}

/// The surface of one part.
struct Sheet {
    part: u32,
    area: f64,
    bvh: Bvh,
}

/// The largest parts of a mesh, by falling area; none where there is only one.
fn sheets(mesh: &TriMesh, parts: &[u32], monitor: &Monitor) -> Result<Vec<Sheet>, Cancelled> {
    let mut triangles: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    monitor.check()?;
    for (triangle, (&part, &corners)) in parts.iter().zip(mesh.triangles()).enumerate() {
        triangles.entry(part).or_default().push(corners);
        *areas.entry(part).or_default() += mesh.triangle_area(triangle);
    }
    let mut largest: Vec<(u32, f64)> = areas.into_iter().collect();
    largest.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let most = largest.first().map_or(0.0, |(_, area)| *area);
    largest.retain(|(_, area)| *area >= LEAST_AREA * most);
    largest.truncate(MOST_PARTS);
    if largest.len() < 2 {
        return Ok(Vec::new());
    }
    let mut sheets = Vec::new();
    for (part, area) in largest {
        let triangles = triangles.remove(&part).unwrap_or_default();
        if let Some(own) = compact(mesh, triangles) {
            let bvh = Bvh::build_for(Arc::new(own), monitor)?;
            sheets.push(Sheet { part, area, bvh });
        }
    }
    Ok(sheets)
}

/// The mesh of some triangles with the vertices that they use.
fn compact(mesh: &TriMesh, mut triangles: Vec<[u32; 3]>) -> Option<TriMesh> {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for corner in triangles.iter_mut().flatten() {
        let at = used.binary_search(corner).ok()?;
        *corner = u32::try_from(at).ok()?;
    }
    let positions = used.iter().map(|&v| mesh.positions()[v as usize]);
    TriMesh::new(positions.collect(), triangles).ok()
}

impl Sheet {
    /// Whether most of it has the other part beside it.
    fn lies_on(&self, other: &Self, thickness: Option<f64>) -> bool {
        let mesh = self.bvh.mesh();
        let size = NEAR_SIZE * mesh.aabb().diagonal();
        let near = thickness.map_or(size, |t| size.max(NEAR_THICKNESS * t));
        let every = mesh.n_triangles().div_ceil(N_SAMPLE).max(1);
        let (mut covered, mut all) = (0.0, 0.0);
        for triangle in (0..mesh.n_triangles()).step_by(every) {
            let area = mesh.triangle_area(triangle);
            all += area;
            let place = mesh.triangle_centroid(triangle);
            let found = other.bvh.closest(&place, near, None, None);
            let is_alike = found.is_some_and(|hit| {
                let normal = other.bvh.mesh().normal(hit.triangle as usize);
                normal.dot(&mesh.normal(triangle)).abs() >= ALIKE
            });
            if is_alike {
                covered += area;
            }
        }
        self.area > 0.0 && covered >= LEAST_COVERED * all
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::formats::{Memory, Selection};
    use crate::pipeline::load::{LoadSettings, load_from};

    /// Sheets of ten by ten quads of 5 mm at these places: parts 1, 2 and so on, without cards of parts.
    fn loaded(places: &[[f64; 3]], selection: Selection) -> LoadedPart {
        let (mut nodes, mut shells) = (String::new(), String::new());
        for (sheet, [x, y, z]) in places.iter().enumerate() {
            let first = 1000 * sheet + 1;
            for place in 0..121 {
                let (column, row) = (place % 11, place / 11);
                let [x, y] = [x + 5.0 * f64::from(column), y + 5.0 * f64::from(row)];
                let id = first + place as usize;
                nodes += &format!("{id},{x},{y},{z}\n");
                if column < 10 && row < 10 {
                    let part = sheet + 1;
                    shells += &format!("{id},{part},{id},{},{},{}\n", id + 1, id + 12, id + 11);
                    shells += "1.,1.,1.,1.\n";
                }
            }
        }
        let deck = format!("*KEYWORD\n*NODE\n{nodes}*ELEMENT_SHELL_THICKNESS\n{shells}*END\n");
        let source = Memory::new().with("deck.k", deck.into_bytes());
        let settings = LoadSettings {
            selection,
            ..LoadSettings::default()
        };
        load_from(&source, Path::new("deck.k"), &settings, &Monitor::silent()).unwrap()
    }

    fn told(part: &LoadedPart) -> Option<String> {
        part.stacked_line()
    }

    #[test]
    fn a_sheet_between_tools_is_told_where_nothing_tells_which_it_is() {
        let stack = [
            [0.0; 3],
            [1.0, 2.0, -1.1],
            [0.0, 0.0, 1.1],
            [0.0, 0.0, 90.0],
        ];
        let line = told(&loaded(&stack, Selection::Sheet)).unwrap();
        assert!(
            line.starts_with("deck.k: parts 1, 2, 3 lie on each other over most of their area"),
            "{line}"
        );
        assert_eq!(told(&loaded(&stack, Selection::All)), None);
        assert_eq!(told(&loaded(&stack, Selection::Parts(vec![1, 2]))), None);
    }

    #[test]
    fn parts_beside_each_other_are_no_stack() {
        let welded = [[0.0; 3], [50.0, 0.0, 0.0]];
        assert_eq!(told(&loaded(&welded, Selection::Sheet)), None);
        let lapped = [[0.0; 3], [35.0, 0.0, 1.0]];
        assert_eq!(told(&loaded(&lapped, Selection::Sheet)), None);
    }
}
