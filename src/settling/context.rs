//! What all steps are given: both parts, what they are compared by, and the request to cancel.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::free_motion_search::FamilyBorders;
use crate::assess::borders::BorderComparison;
use crate::assess::contact::ContactSearch;
use crate::assess::evidence::{EvidenceSearch, PoseEvidence};
use crate::assess::statements::{Outlines, shape_statement};
use crate::assess::tolerance::Distances;
use crate::assess::{AssessSettings, ShapeStatement};
use crate::geometry::{Point3, Similarity};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;

/// Borders that are kept prepared. Steps ask for three reaches; where the scale is free, every pose has its own.
const MOST_PREPARED: usize = 8;

/// Two parts whose pose is chosen.
pub struct PairContext<'a> {
    pub(super) source: &'a Surface,
    pub(super) target: &'a Surface,
    pub(super) settings: &'a AssessSettings,
    pub(super) monitor: &'a Monitor,
    /// Of the source's box.
    corners: [Point3; 8],
    /// The poses under which holes lie on like ones, found when first asked for.
    pub(super) on_holes: OnceLock<Vec<Similarity>>,
    /// What the search along families of poses compares, the target as the smaller part or the source, prepared when
    /// first asked for.
    pub(super) borders_of_families: [OnceLock<Option<FamilyBorders>>; 2],
    /// The statements made so far, by pose: several steps ask about the same one.
    shapes: Mutex<Vec<(Similarity, ShapeStatement)>>,
    /// The borders prepared last, by scale and reach.
    borders: Mutex<Vec<([f64; 2], Arc<BorderComparison<'a>>)>>,
}

impl<'a> PairContext<'a> {
    /// For source and target.
    pub fn new(
        [source, target]: [&'a Surface; 2],
        settings: &'a AssessSettings,
        monitor: &'a Monitor,
    ) -> Self {
        Self {
            source,
            target,
            settings,
            monitor,
            corners: source.mesh().aabb().corners(),
            on_holes: OnceLock::new(),
            borders_of_families: Default::default(),
            shapes: Mutex::default(),
            borders: Mutex::default(),
        }
    }

    /// Every step asks this before and between its parts.
    pub(super) fn check(&self) -> Result<(), Cancelled> {
        self.monitor.check()
    }

    /// Whether the work is to end with what it has.
    pub(super) fn is_stopped(&self) -> bool {
        self.monitor.stop_requested()
    }

    /// Source and target.
    pub(super) fn surfaces(&self) -> [&'a Surface; 2] {
        [self.source, self.target]
    }

    /// What both are compared by under poses of this scale.
    pub(super) fn distances(&self, scale: f64) -> Distances {
        Distances::of(self.source, self.target, scale, self.settings)
    }

    /// How far the source lies apart under two poses, at the corners of its box.
    pub(super) fn displacement(&self, a: &Similarity, b: &Similarity) -> f64 {
        a.max_displacement(b, &self.corners)
    }

    /// The search for the places where both meet under poses of this scale.
    pub(super) fn contacts(&self, scale: f64, reach: f64, max_nodes: usize) -> ContactSearch<'a> {
        ContactSearch::new(self.surfaces(), scale, reach, max_nodes)
    }

    /// The borders of both, looked for within `reach`, prepared when first asked for.
    pub(super) fn borders(&self, scale: f64, reach: f64) -> Arc<BorderComparison<'a>> {
        let key = [scale, reach];
        if let Some(borders) = known(&self.borders, &key) {
            return borders;
        }
        // Two steps at once may both prepare them: a lock held meanwhile could wait for its own thread.
        let borders = Arc::new(BorderComparison::new(self.surfaces(), scale, reach));
        let mut prepared = lock(&self.borders);
        if prepared.len() == MOST_PREPARED {
            prepared.remove(0);
        }
        prepared.push((key, Arc::clone(&borders)));
        borders
    }

    /// The statement about the shape under a pose, made when first asked for.
    pub(super) fn shape(&self, pose: &Similarity) -> ShapeStatement {
        if let Some(shape) = known(&self.shapes, pose) {
            return shape;
        }
        let shape = self.statement(pose, Outlines::Compared);
        lock(&self.shapes).push((*pose, shape.clone()));
        shape
    }

    /// The same with the outlines left out.
    pub(super) fn shape_without_outlines(&self, pose: &Similarity) -> ShapeStatement {
        self.statement(pose, Outlines::LeftOut)
    }

    fn statement(&self, pose: &Similarity, outlines: Outlines) -> ShapeStatement {
        let borders = self.borders(pose.scale, self.distances(pose.scale).border_reach);
        shape_statement(&borders, pose, self.settings, outlines)
    }

    /// A pose moved step by step: `next` gives the next pose, and the motion that is none any more. It ends there,
    /// where the parts meet nowhere or there is no next pose, or after so many steps.
    /// O(steps · (border edges + nodes · log triangles)).
    pub(super) fn stepped(
        &self,
        search: &mut EvidenceSearch<'_, '_>,
        first: &Similarity,
        n_steps: usize,
        mut next: impl FnMut(&mut PoseEvidence<'_>) -> Option<(Similarity, f64)>,
    ) -> Result<Similarity, Cancelled> {
        let mut pose = *first;
        for _ in 0..n_steps {
            self.check()?;
            let Some((moved, still)) = search.at(&pose).and_then(|mut met| next(&mut met)) else {
                break;
            };
            let by = self.displacement(&moved, &pose);
            pose = moved;
            if by <= still {
                break;
            }
        }
        Ok(pose)
    }
}

/// What was found for a key.
fn known<K: PartialEq, T: Clone>(found: &Mutex<Vec<(K, T)>>, key: &K) -> Option<T> {
    let found = lock(found);
    let known = found.iter().find(|(of, _)| of == key);
    known.map(|(_, known)| known.clone())
}

/// What was found so far; each entry is whole, even if a thread that added one panicked.
fn lock<T>(found: &Mutex<T>) -> MutexGuard<'_, T> {
    found.lock().unwrap_or_else(PoisonError::into_inner)
}
