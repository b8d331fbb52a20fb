//! What all steps are given: both parts, what they are compared by, and the request to cancel.

use std::sync::{Mutex, OnceLock, PoisonError};

use crate::assess::borders::BorderComparison;
use crate::assess::contact::ContactSearch;
use crate::assess::evidence::{EvidenceSearch, PoseEvidence};
use crate::assess::statements::{Outlines, shape_statement};
use crate::assess::tolerance::Distances;
use crate::assess::{AssessSettings, ShapeStatement};
use crate::geometry::{Point3, Similarity};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;

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
    /// The statements made so far, by pose: several steps ask about the same one.
    shapes: Mutex<Vec<(Similarity, ShapeStatement)>>,
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
            shapes: Mutex::default(),
        }
    }

    /// Every step asks this before and between its parts.
    pub(super) fn check(&self) -> Result<(), Cancelled> {
        self.monitor.check()
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

    /// The borders of both, looked for within `reach`.
    pub(super) fn borders(&self, scale: f64, reach: f64) -> BorderComparison<'a> {
        BorderComparison::new(self.surfaces(), scale, reach)
    }

    /// The statement about the shape under a pose, made when first asked for.
    pub(super) fn shape(&self, pose: &Similarity) -> ShapeStatement {
        let shapes = || self.shapes.lock().unwrap_or_else(PoisonError::into_inner);
        let known = shapes().iter().find(|(of, _)| of == pose).cloned();
        if let Some((_, shape)) = known {
            return shape;
        }
        let shape = shape_statement(self.surfaces(), pose, self.settings, Outlines::Compared);
        shapes().push((*pose, shape.clone()));
        shape
    }

    /// The same with the outlines left out.
    pub(super) fn shape_without_outlines(&self, pose: &Similarity) -> ShapeStatement {
        shape_statement(self.surfaces(), pose, self.settings, Outlines::LeftOut)
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
