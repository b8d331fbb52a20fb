//! Poses near a found one in which parts that are nearly symmetric fit too.

use std::f64::consts::PI;

use nalgebra::Unit;

use super::candidate::{Candidate, DataChoice, Pairing};
use super::starts::{Start, StartKind};
use crate::geometry::{Matrix3, Rotation, Similarity, Vector3};
use crate::registration::surface::Measures;

/// The pose of `candidate` mirrored in each principal plane of the data: where a part that is
/// nearly its own mirror image lies if it is of the opposite hand.
pub(crate) fn mirror_images(choice: &DataChoice<'_>, candidate: &Candidate) -> Vec<Start> {
    let measures = choice.fine.data.measures();
    (0..3)
        .map(|axis| {
            let normal: Vector3 = measures.principal_axes.column(axis).into();
            let rotation = Matrix3::identity() - normal * normal.transpose() * 2.0;
            let mirror = Similarity::about(&measures.centroid, rotation);
            variation(choice, candidate, &mirror, axis)
        })
        .collect()
}

/// The pose of `candidate` rotated by 180° about each principal axis of the data, and of the model where that leads
/// elsewhere: where parts that are nearly symmetric have their twins. A piece lies elsewhere on a symmetric part, and
/// need not be symmetric itself.
pub(crate) fn twins(choice: &DataChoice<'_>, candidate: &Candidate) -> Vec<Start> {
    let Pairing { data, model } = choice.fine;
    let pose = candidate.run.model_from_data;
    let mut turns: Vec<(usize, Similarity)> = half_turns(data.measures()).collect();
    // Seen from the data.
    let of_model = half_turns(model.measures())
        .map(|(axis, turn)| (axis, pose.inverse().after(&turn.after(&pose))));
    for (axis, turn) in of_model {
        if !turns.iter().any(|(_, known)| choice.is_same(known, &turn)) {
            turns.push((axis, turn));
        }
    }
    turns
        .into_iter()
        .map(|(axis, turn)| variation(choice, candidate, &turn, axis))
        .collect()
}

/// Half turns of a part about each of its principal axes, with the axis.
fn half_turns(part: &Measures) -> impl Iterator<Item = (usize, Similarity)> {
    (0..3).map(|axis| {
        let direction = Unit::new_normalize(part.principal_axes.column(axis).into());
        let rotation = Rotation::from_axis_angle(&direction, PI);
        let rotation = *rotation.to_rotation_matrix().matrix();
        (axis, Similarity::about(&part.centroid, rotation))
    })
}

/// The pose of `candidate` after the data was moved by `motion`.
fn variation(
    choice: &DataChoice<'_>,
    candidate: &Candidate,
    motion: &Similarity,
    axis: usize,
) -> Start {
    let pose = candidate.run.model_from_data.after(motion);
    Start {
        kind: StartKind::Twin { axis },
        // A sheet that is flipped shows its other side.
        flipped: candidate.start.flipped != flips(motion, choice),
        target_from_source: choice.data_side().oriented(&pose),
    }
}

/// True if `motion` reverses the mean normal of the data.
fn flips(motion: &Similarity, choice: &DataChoice<'_>) -> bool {
    let normal = choice.fine.data.measures().mean_normal;
    motion.rotate(&normal).dot(&normal) < 0.0
}
