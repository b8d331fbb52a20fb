//! Large meshes in regions side by side, and what they leave as a whole.
//!
//! A round cuts the mesh into regions, a number that depends on the mesh alone, and freezes the
//! vertices with triangles in several of them. The regions are then collapsed independently of each
//! other, all up to a common price, until a quarter of the triangles is left. Merged by price,
//! their collapses are nearly in the order that they would have as a whole. The next round cuts
//! along other lines, so what was frozen before catches up first. When few triangles are left, the
//! mesh is collapsed as a whole.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::decimator::{Collapse, Decimator};
use super::intake::{UnitMesh, add_quadrics};
use super::queue::N_BUCKETS;
use super::settings::{SimplifySettings, Speed, StopReason};
use super::surface::{CollapsingMesh, Kind};
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::monitor::{Cancelled, Monitor};

/// With fewer triangles than this, the mesh is one region.
const WHOLE_BELOW: usize = 4096;

/// The mesh has one region for every so many units of the square root of its triangles: a cut is
/// about as long as that root, and at the end of a round the vertices on it should be few of those
/// left. 35,000 triangles make two regions, 200,000 four, two million fifteen.
const ROOT_PER_REGION: f64 = 90.0;

/// A round ends when this part of its triangles is left.
const LEFT_BY_ROUND: usize = 4;

/// Rounds that leave fewer triangles than this are exact with [`Speed::Fast`] too: few collapses are
/// left, and they make most of the error.
const EXACT_BELOW: usize = 8000;

/// Cuts run across the longest axis, and lean by this slope along the second to one side and to the
/// other in turn, so that cuts of two rounds hardly meet.
const LEAN: f64 = 0.15;

/// The collapses of `mesh` down to the settings' maximum, in order, and why they end.
pub(super) fn decimate(
    mesh: UnitMesh,
    settings: &SimplifySettings,
    monitor: &Monitor,
) -> Result<(Vec<Collapse>, StopReason), Cancelled> {
    // From a thread of the pool, the short steps start without waking one first.
    rayon::scope(|_| decimate_by_rounds(mesh, settings, monitor))
}

fn decimate_by_rounds(
    mut mesh: UnitMesh,
    settings: &SimplifySettings,
    monitor: &Monitor,
) -> Result<(Vec<Collapse>, StopReason), Cancelled> {
    let max_triangles = settings.max_triangles;
    let n_start = mesh.triangles.len();
    let to_do = n_start.saturating_sub(max_triangles) as u64;
    let report = |n_left: usize| {
        // Regions side by side may together go further than was asked for; of that nothing is kept.
        let done = ((n_start - n_left) as u64).min(to_do);
        monitor.progress("simplify", done, Some(to_do));
    };
    let mut collapses = Vec::new();
    let mut lean = LEAN;
    while mesh.triangles.len() >= WHOLE_BELOW.max(max_triangles + 1) {
        let n = mesh.triangles.len();
        let goal = n / LEFT_BY_ROUND;
        let is_exact = settings.speed == Speed::Exact || goal < EXACT_BELOW;
        let n_regions = ((n as f64).sqrt() / ROOT_PER_REGION).max(2.0) as usize;
        let slabs = Slabs::of(&mesh, n_regions, lean, monitor)?;
        let mut regions = slabs
            .faces_of
            .par_iter()
            .map(|faces| Region::new(&mesh, faces, &slabs.is_frozen, settings, is_exact, monitor))
            .collect::<Result<Vec<_>, _>>()?;
        let goal = goal.max(max_triangles);
        collapse_side_by_side(&mut regions, goal, monitor, &report)?;
        merge(&regions, n, max_triangles, &mut collapses);
        let n_left = collapses.last().map_or(n, |c| c.n_triangles as usize);
        if n_left <= max_triangles {
            return Ok((collapses, StopReason::Reached));
        }
        if monitor.stop_requested() {
            return Ok((collapses, StopReason::StopRequested));
        }
        mesh = left_of(&regions, mesh);
        lean = -lean;
        if n_left > n - n / 8 {
            // Something other than the cuts holds it.
            break;
        }
    }
    let n = mesh.triangles.len();
    let all: Vec<u32> = (0..n as u32).collect();
    let nothing_frozen = vec![false; mesh.positions.len()];
    let mut whole = Region::new(&mesh, &all, &nothing_frozen, settings, true, monitor)?;
    let stop_reason = whole.decimator.run(max_triangles, monitor, report)?;
    merge(&[whole], n, max_triangles, &mut collapses);
    Ok((collapses, stop_reason))
}

/// A part of the mesh with numbers of its own.
struct Region {
    decimator: Decimator,
    /// The mesh's number of each vertex.
    names: Vec<u32>,
    /// The mesh's number of each triangle.
    faces: Vec<u32>,
}

impl Region {
    /// The region of the triangles `faces`. Vertices are numbered as they come.
    fn new(
        mesh: &UnitMesh,
        faces: &[u32],
        is_frozen: &[bool],
        settings: &SimplifySettings,
        is_exact: bool,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        // One more than the number; 0 for none.
        let mut number = vec![0_u32; mesh.positions.len()];
        let mut names = Vec::with_capacity(faces.len() / 2 + 2);
        let mut triangles = Vec::with_capacity(faces.len());
        for_chunks(faces.len(), monitor, |range| {
            triangles.extend(faces[range].iter().map(|&t| {
                mesh.triangles[t as usize].map(|v| {
                    let number = &mut number[v as usize];
                    if *number == 0 {
                        names.push(v);
                        *number = names.len() as u32;
                    }
                    *number - 1
                })
            }));
        })?;
        let positions: Vec<_> = names.iter().map(|&v| mesh.positions[v as usize]).collect();
        let part_of = if mesh.part_of.is_empty() {
            Vec::new()
        } else {
            faces.iter().map(|&t| mesh.part_of[t as usize]).collect()
        };
        let mut surface = CollapsingMesh::new(&positions, &triangles, part_of, monitor)?;
        add_quadrics(&mut surface, settings, monitor)?;
        for (vertex, &name) in surface.vertices.iter_mut().zip(&names) {
            if is_frozen[name as usize] {
                vertex.kind = Kind::Frozen;
            }
        }
        Ok(Self {
            decimator: Decimator::new(surface, settings, is_exact, monitor)?,
            names,
            faces: faces.to_vec(),
        })
    }
}

/// A mesh in slices with about equally many triangles.
struct Slabs {
    /// The triangles of each. One across a cut belongs to the first slab that it reaches.
    faces_of: Vec<Vec<u32>>,
    /// For each vertex whether it has triangles in several.
    is_frozen: Vec<bool>,
}

impl Slabs {
    fn of(
        mesh: &UnitMesh,
        n_slabs: usize,
        lean: f64,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        const N_BINS: usize = 4096;
        let bin_of = bins_along(&mesh.positions, lean, N_BINS, monitor)?;
        let reach = map_chunks(mesh.triangles.len(), monitor, |t| {
            let [a, b, c] = mesh.triangles[t].map(|v| bin_of[v as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        })?;
        let mut counts = vec![0; N_BINS];
        for &[first, _] in &reach {
            counts[first as usize] += 1;
        }
        let mut n_before = 0;
        let slab_of_bin: Vec<usize> = counts
            .iter()
            .map(|count| {
                let slab = (n_before + count / 2) * n_slabs / reach.len();
                n_before += count;
                slab
            })
            .collect();
        let mut faces_of = vec![Vec::new(); n_slabs];
        let mut is_frozen = vec![false; mesh.positions.len()];
        for_chunks(reach.len(), monitor, |range| {
            for t in range {
                let [first, last] = reach[t].map(|bin| slab_of_bin[bin as usize]);
                faces_of[first].push(t as u32);
                if first == last {
                    continue;
                }
                for v in mesh.triangles[t].map(|v| v as usize) {
                    // Those in the first slab have all their triangles there, or an earlier one
                    // across a cut to say that they have not.
                    is_frozen[v] |= slab_of_bin[bin_of[v] as usize] != first;
                }
            }
        })?;
        Ok(Self {
            faces_of,
            is_frozen,
        })
    }
}

/// How far each position lies along the longest axis of all, leaning to the second one, in
/// `n_bins` steps.
fn bins_along(
    positions: &[Vector3<f64>],
    lean: f64,
    n_bins: usize,
    monitor: &Monitor,
) -> Result<Vec<u32>, Cancelled> {
    let (mut low, mut high) = (positions[0], positions[0]);
    for_chunks(positions.len(), monitor, |range| {
        for position in &positions[range] {
            low = low.inf(position);
            high = high.sup(position);
        }
    })?;
    let size = high - low;
    let long = size.imax();
    let [second, third] = [(long + 1) % 3, (long + 2) % 3];
    let second = if size[second] < size[third] {
        third
    } else {
        second
    };
    let mut direction = Vector3::ith(long, 1.0);
    direction[second] = lean;
    // From the corner of the box that comes first in this direction.
    let start = low.dot(&direction) + (lean * size[second]).min(0.0);
    let scale = n_bins as f64 / size.dot(&direction.abs()).max(f64::MIN_POSITIVE);
    map_chunks(positions.len(), monitor, |v| {
        let along = positions[v].dot(&direction) - start;
        ((along * scale) as u32).min(n_bins as u32 - 1)
    })
}

/// Collapses all regions up to a common price at which `goal` triangles are left or fewer.
fn collapse_side_by_side(
    regions: &mut [Region],
    goal: usize,
    monitor: &Monitor,
    report: &impl Fn(usize),
) -> Result<(), Cancelled> {
    loop {
        let left = regions.iter().map(|r| r.decimator.surface().n_triangles);
        let n_left: usize = left.sum();
        report(n_left);
        if n_left <= goal || monitor.stop_requested() {
            return Ok(());
        }
        // About a quarter of the edges that come up are collapsed, each with two triangles.
        let wanted = (n_left - goal).max(goal / 8);
        let Some(end) = bucket_after(regions, wanted) else {
            return Ok(());
        };
        regions
            .par_iter_mut()
            .try_for_each(|region| region.decimator.run_before(end, monitor))?;
    }
}

/// The end of the cheapest buckets that have so many edges, or all; `None` if there are no edges.
fn bucket_after(regions: &[Region], wanted: usize) -> Option<usize> {
    let queues = || regions.iter().map(|region| region.decimator.queue());
    let first = queues().map(|queue| queue.first()).min()?;
    let (mut n, mut end) = (0, None);
    for bucket in first..N_BUCKETS {
        let here: usize = queues().map(|queue| queue.len_of(bucket)).sum();
        if here > 0 {
            n += here;
            end = Some(bucket + 1);
        }
        if n >= wanted {
            break;
        }
    }
    end
}

/// Appends the regions' collapses by price, down to `max_triangles`.
fn merge(
    regions: &[Region],
    n_triangles: usize,
    max_triangles: usize,
    collapses: &mut Vec<Collapse>,
) {
    let mut order: Vec<(u16, u32, u32)> = Vec::new();
    for (r, region) in regions.iter().enumerate() {
        let dearest = region.decimator.dearest().iter().enumerate();
        order.extend(dearest.map(|(i, &bucket)| (bucket, r as u32, i as u32)));
    }
    order.sort_by_key(|&(bucket, ..)| bucket);
    let mut n_left = n_triangles;
    for (_, r, i) in order {
        if n_left <= max_triangles {
            break;
        }
        let region = &regions[r as usize];
        let own = region.decimator.collapses();
        let before = match i {
            0 => region.faces.len(),
            _ => own[i as usize - 1].n_triangles as usize,
        };
        let collapse = own[i as usize];
        n_left -= before - collapse.n_triangles as usize;
        let [kept, removed] = [collapse.kept, collapse.removed].map(|v| region.names[v as usize]);
        collapses.push(Collapse {
            kept,
            removed,
            n_triangles: n_left as u32,
            ..collapse
        });
    }
}

/// The mesh that the regions have left of `mesh`.
fn left_of(regions: &[Region], mut mesh: UnitMesh) -> UnitMesh {
    for region in regions {
        let vertices = &region.decimator.surface().vertices;
        for (vertex, &name) in vertices.iter().zip(&region.names) {
            mesh.positions[name as usize] = vertex.position;
        }
    }
    let left_of_region = |region: &Region| {
        let mut triangles = Vec::new();
        let mut parts = Vec::new();
        for (t, corners) in region.decimator.surface().left() {
            triangles.push(corners.map(|v| region.names[v as usize]));
            parts.extend(mesh.part_of.get(region.faces[t] as usize));
        }
        (triangles, parts)
    };
    let left = regions.par_iter().map(left_of_region).collect::<Vec<_>>();
    let (triangles, parts): (Vec<_>, Vec<_>) = left.into_iter().unzip();
    UnitMesh {
        positions: mesh.positions,
        triangles: triangles.concat(),
        part_of: parts.concat(),
    }
}
