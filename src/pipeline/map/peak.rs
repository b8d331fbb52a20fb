//! What the crash mesh can hold of the largest plastic strain, whoever maps it.

use super::MapRun;
use crate::geometry::Point3;
use crate::geometry::chunks::for_chunks;
use crate::mapping::{ShellMesh, SourcePart};
use crate::monitor::{Cancelled, Monitor};

/// Elements around the peak belong to its sheet while their normals differ by less than 60°.
const SAME_SHEET_COS: f64 = 0.5;

/// Mean of the stamped plastic strain over an area as large as the crash element there, around its largest value or
/// under the largest mapped one, whichever is more: no element can carry more of a peak that is narrower than itself,
/// and a lower and wider peak may leave more. `None` without plastic strain. O(elements).
pub(super) fn peak_at_best(run: &MapRun, monitor: &Monitor) -> Result<Option<f64>, Cancelled> {
    let mut best = None;
    for place in [
        largest_stamped(run, monitor)?,
        under_the_largest_mapped(run, monitor)?,
    ] {
        let Some((part, element)) = place else {
            continue;
        };
        let source = &run.sources[part];
        let there = run.poses[part].apply(&source.mesh.centroids()[element]);
        let Some(crash) = nearest(&run.target.mesh, &there) else {
            continue;
        };
        monitor.check()?;
        let scale = run.poses[part].scale;
        let area = run.target.mesh.areas()[crash] / (scale * scale);
        let mean = mean_around(source, element, area, monitor)?;
        best = mean.into_iter().chain(best).reduce(f64::max);
    }
    Ok(best)
}

/// Part and element of the stamped sheet that the crash element with the largest mapped value lies on.
fn under_the_largest_mapped(
    run: &MapRun,
    monitor: &Monitor,
) -> Result<Option<(usize, usize)>, Cancelled> {
    let elements = 0..run.target.mesh.len();
    let values = elements.map(|element| (run.plastic_strain(element), element));
    let known = values.filter(|(value, _)| value.is_finite());
    let Some((_, largest)) = known.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Ok(None);
    };
    monitor.check()?;
    let there = run.target.mesh.centroids()[largest];
    let below = run.sources.iter().zip(&run.poses).enumerate();
    let below = below.filter_map(|(part, (source, pose))| {
        let element = nearest(&source.mesh, &pose.inverse().apply(&there))?;
        let distance = (pose.apply(&source.mesh.centroids()[element]) - there).norm();
        Some((distance, part, element))
    });
    let nearest = below.min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(nearest.map(|(_, part, element)| (part, element)))
}

/// Part and element of the largest value that the crash part covers.
fn largest_stamped(run: &MapRun, monitor: &Monitor) -> Result<Option<(usize, usize)>, Cancelled> {
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

/// Mean over the elements nearest to one of them that together have an area; the last counts in part. Normals are
/// compared as one side of the sheet has them, whichever way the corners go.
fn mean_around(
    source: &SourcePart,
    center: usize,
    area: f64,
    monitor: &Monitor,
) -> Result<Option<f64>, Cancelled> {
    let mesh = &source.mesh;
    let (place, normal) = (mesh.centroids()[center], mesh.normals()[center]);
    let links = mesh.links(monitor)?;
    let neighbours = &links.neighbours;
    let mut around: Vec<(f64, usize)> = Vec::new();
    for_chunks(mesh.len(), monitor, |range| {
        let all = range.map(|e| ((mesh.centroids()[e] - place).norm_squared(), e));
        around.extend(all.filter(|&(distance_sq, element)| {
            distance_sq <= 4.0 * area.max(mesh.areas()[center])
                && neighbours.seen_cos(center, element, mesh.normals()[element].dot(&normal))
                    >= SAME_SHEET_COS
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::mapping::{Layered, SourceHistory};

    #[test]
    fn the_mean_around_a_peak_does_not_depend_on_the_order_of_corners() {
        let n = 12_u32;
        let node = |i: u32, j: u32| i * (n + 1) + j;
        let mean = |is_reversed: &dyn Fn(u32) -> bool| {
            let nodes = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
            let positions = nodes.map(|(i, j)| Point3::new(f64::from(i), f64::from(j), 0.0));
            let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let corners = cells.map(|(i, j)| {
                let [a, b, c, d] = [
                    node(i, j),
                    node(i + 1, j),
                    node(i + 1, j + 1),
                    node(i, j + 1),
                ];
                if is_reversed(i * n + j) {
                    [a, d, c, b]
                } else {
                    [a, b, c, d]
                }
            });
            let n_elements = (n * n) as usize;
            let parts = vec![0; n_elements];
            let mesh = ShellMesh::new(positions.collect(), corners.collect(), parts).unwrap();
            let mut states = Layered::new(n_elements);
            for element in 0..n_elements {
                let place = mesh.centroids()[element] - Point3::new(6.5, 6.5, 0.0);
                let plastic = (-place.norm_squared() / 4.0).exp();
                let state = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, plastic];
                states.set(element, std::iter::once((0.0, state)));
            }
            let source = SourcePart {
                thickness: Vec::new(),
                states,
                strains: Layered::new(n_elements),
                history: SourceHistory::default(),
                laws: BTreeMap::new(),
                mesh,
            };
            let center = (6 * n + 6) as usize;
            mean_around(&source, center, 9.0, &Monitor::silent())
                .unwrap()
                .unwrap()
        };
        let plain = mean(&|_| false);
        assert!(plain > 0.6, "{plain}");
        assert!((mean(&|e| e.wrapping_mul(2_654_435_761) >> 31 == 0) - plain).abs() < 1e-12);
    }
}
