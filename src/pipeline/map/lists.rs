//! The few elements of a mapping that are worth a look, found once when it is made.

use super::MapRun;
use crate::geometry::Point3;
use crate::geometry::chunks::CHUNK;
use crate::mapping::Status;
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;

/// Elements of a list.
const N_LISTED: usize = 40;

/// A confidence that is written as 1.00.
const WHOLLY_TRUSTED: f64 = 0.995;

/// Elements of a mapping to look at.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementLists {
    /// Elements without values, the first of each reason and then the others in the order of the deck, at
    /// most forty.
    pub unmapped: Vec<UnmappedElement>,
    /// How many elements have no values.
    pub n_unmapped: usize,
    /// The mapped elements that can be trusted least, the worst first, at most forty; of equal ones those
    /// that come first in the deck. Elements that can be trusted wholly are not among them.
    pub doubtful: Vec<DoubtfulElement>,
    /// The first element of each status there is, by its place in the run.
    pub first_of: Vec<(Status, usize)>,
    /// What each stamped part gave, in their order.
    pub givers: Vec<GiverShare>,
}

/// The elements that took their values from one stamped part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GiverShare {
    /// How many elements.
    pub n_elements: usize,
    /// Their share of the area.
    pub area_share: f64,
    /// The first of them, by its place in the run.
    pub first: Option<usize>,
}

/// An element of the crash part that carries no values.
#[derive(Debug, Clone, PartialEq)]
pub struct UnmappedElement {
    /// Its id in the deck.
    pub id: u64,
    /// Why the element has no mapped values.
    pub status: Status,
    /// Centre of the element, in crash coordinates.
    pub center: Point3,
}

/// An element of the crash part whose values are to be trusted less than others.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubtfulElement {
    /// Its id in the deck.
    pub id: u64,
    /// How far it can be trusted, 0 to 1.
    pub confidence: f64,
    /// Centre of the element, in crash coordinates.
    pub center: Point3,
}

/// The lists of a mapping onto `crash`. O(elements).
pub fn element_lists(
    run: &MapRun,
    crash: &LoadedPart,
    monitor: &Monitor,
) -> Result<ElementLists, Cancelled> {
    let id = |element: usize| crash.model.shells[run.shells[element] as usize].id;
    let center = |element: usize| run.target.mesh.centroids()[element];
    let mut first_of: Vec<(Status, usize)> = Vec::new();
    let (mut first, mut others) = (Vec::new(), Vec::new());
    let mut n_unmapped = 0;
    // In order, never longer than the list.
    let mut worst: Vec<(f64, usize)> = Vec::with_capacity(N_LISTED + 1);
    for (element, report) in run.mapped.elements.iter().enumerate() {
        if element % CHUNK == 0 {
            monitor.check()?;
        }
        let (status, confidence) = (report.status, report.confidence);
        let is_first = first_of.iter().all(|(known, _)| *known != status);
        if is_first {
            first_of.push((status, element));
        }
        if !status.has_values() {
            n_unmapped += 1;
            let list = if is_first { &mut first } else { &mut others };
            if list.len() < N_LISTED {
                list.push((element, status));
            }
            continue;
        }
        let is_full = worst.len() == N_LISTED;
        let beats = !is_full || worst.last().is_some_and(|last| confidence < last.0);
        if confidence < WHOLLY_TRUSTED && beats {
            let at = worst.partition_point(|row| row.0 <= confidence);
            worst.insert(at, (confidence, element));
            worst.truncate(N_LISTED);
        }
    }
    let unmapped = first.into_iter().chain(others).take(N_LISTED);
    Ok(ElementLists {
        unmapped: unmapped
            .map(|(element, status)| UnmappedElement {
                id: id(element),
                status,
                center: center(element),
            })
            .collect(),
        n_unmapped,
        doubtful: worst
            .into_iter()
            .map(|(confidence, element)| DoubtfulElement {
                id: id(element),
                confidence,
                center: center(element),
            })
            .collect(),
        first_of,
        givers: givers(run, monitor)?,
    })
}

/// What each stamped part gave. O(elements).
pub(super) fn givers(run: &MapRun, monitor: &Monitor) -> Result<Vec<GiverShare>, Cancelled> {
    let mut givers = vec![GiverShare::default(); run.sources.len()];
    let areas = run.target.mesh.areas();
    let whole: f64 = areas.iter().sum();
    for (element, area) in areas.iter().enumerate() {
        if element % CHUNK == 0 {
            monitor.check()?;
        }
        let Some(part) = run.values_from(element) else {
            continue;
        };
        let giver = &mut givers[part];
        giver.n_elements += 1;
        giver.area_share += area / whole;
        giver.first = giver.first.or(Some(element));
    }
    Ok(givers)
}
