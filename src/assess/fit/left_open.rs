//! How far the part may lie elsewhere where its bends are part of its shape.

use super::{Fit, Row, bends_of, explaining};
use crate::assess::evidence::PoseEvidence;
use crate::assess::jackknife::{self, Patches};
use crate::assess::least_squares::robust_weights;
use crate::assess::small_motion::{Six, Unknown, motion_of};
use crate::geometry::{Point3, Vector3};

impl Fit {
    /// Motions whose squares sum to the square of what the evidence, bends solved for with the motion, leaves open: the
    /// jackknife over the patches, noise, and the way to where the source belongs. O(places).
    pub(in crate::assess) fn left_open(
        &self,
        evidence: &PoseEvidence<'_>,
        patches: &Patches,
    ) -> Vec<Six> {
        let contacts = &evidence.contacts;
        let row = |point: &Point3, direction: &Vector3, offset: f64| {
            explaining(contacts, &self.bends, point, direction, offset)
        };
        let left = contacts.list.iter();
        let left = left.map(|c| c.gap - row(&c.point, &c.normal, 1.0).dot(&self.found));
        let left: Vec<f64> = left.collect();
        let areas: Vec<f64> = contacts.list.iter().map(|c| c.weight).collect();
        let weights = robust_weights(&left, &areas, evidence.noise);
        let mut parts = patches.equations(evidence, &weights, row);
        let has_offset = self.found[Unknown::OFFSET] != 0.0;
        if !has_offset {
            for part in &mut parts {
                part.leave_out(Unknown::OFFSET..Unknown::OFFSET + 1);
            }
        }
        let all = jackknife::sum(&parts);
        let open = jackknife::left_open(&all, evidence, &weights, &left);
        let rigid_parts = self.bends.rigid_parts(contacts);
        let rigid = |by: Row| motion_of(&by) + rigid_parts * bends_of(&by);
        let found = jackknife::replicates(&parts, &all).chain(open).map(rigid);
        found.chain([self.rigid]).collect()
    }
}
