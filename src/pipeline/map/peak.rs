//! What the crash mesh can hold of the largest plastic strain, whoever maps it.

use super::MapRun;
use crate::geometry::Point3;
use crate::geometry::chunks::for_chunks;
use crate::mapping::{ShellMesh, SourcePart};
use crate::monitor::{Cancelled, Monitor};

/// Elements around the peak belong to its sheet while their normals differ by less than 60°.
const SAME_SHEET_COS: f64 = 0.5;

/// Mean of the stamped plastic strain over an area as large as the crash element there, around its
/// largest value: no element can carry more of a peak that is narrower than itself. `None` without
/// plastic strain. O(elements).
pub(super) fn peak_at_best(run: &MapRun, monitor: &Monitor) -> Result<Option<f64>, Cancelled> {
    let Some((part, peak)) = largest(run, monitor)? else {
        return Ok(None);
    };
    let source = &run.sources[part];
    let mesh = &source.mesh;
    let there = run.poses[part].apply(&mesh.centroids()[peak]);
    let Some(crash) = nearest(&run.target.mesh, &there) else {
        return Ok(None);
    };
    monitor.check()?;
    let scale = run.poses[part].scale;
    let area = run.target.mesh.areas()[crash] / (scale * scale);
    mean_around(source, peak, area, monitor)
}

/// Part and element of the largest value that the crash part covers.
fn largest(run: &MapRun, monitor: &Monitor) -> Result<Option<(usize, usize)>, Cancelled> {
    let back = run.checks.map_back.as_ref();
    let mut best: Option<(f64, usize, usize)> = None;
    for (part, source) in run.sources.iter().enumerate() {
        let covered = back.map(|back| &back.is_covered[part]);
        for_chunks(source.mesh.len(), monitor, |range| {
            for element in range {
                let is_covered = covered.is_none_or(|covered| covered[element]);
                let value = source.mean_plastic_strain(element);
                if is_covered && value.is_finite() && best.is_none_or(|(most, ..)| value > most) {
                    best = Some((value, part, element));
                }
            }
        })?;
    }
    Ok(best.map(|(_, part, element)| (part, element)))
}

fn nearest(mesh: &ShellMesh, point: &Point3) -> Option<usize> {
    let distance = |element: &usize| (mesh.centroids()[*element] - point).norm_squared();
    (0..mesh.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Mean over the elements nearest to one of them that together have an area; the last counts in part.
fn mean_around(
    source: &SourcePart,
    center: usize,
    area: f64,
    monitor: &Monitor,
) -> Result<Option<f64>, Cancelled> {
    let mesh = &source.mesh;
    let (place, normal) = (mesh.centroids()[center], mesh.normals()[center]);
    let mut around: Vec<(f64, usize)> = Vec::new();
    for_chunks(mesh.len(), monitor, |range| {
        let all = range.map(|e| ((mesh.centroids()[e] - place).norm_squared(), e));
        around.extend(all.filter(|&(distance_sq, element)| {
            distance_sq <= 4.0 * area.max(mesh.areas()[center])
                && mesh.normals()[element].dot(&normal) >= SAME_SHEET_COS
                && source.mean_plastic_strain(element).is_finite()
        }));
    })?;
    around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut sum, mut left) = (0.0, area);
    for (_, element) in around {
        let part = mesh.areas()[element].min(left);
        sum += part * source.mean_plastic_strain(element);
        left -= part;
    }
    let counted = area - left;
    Ok((counted > 0.0).then(|| sum / counted))
}
