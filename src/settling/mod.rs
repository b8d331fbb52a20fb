//! The last steps of a match: the pose that was refined on the full meshes is moved, or another one takes its place,
//! before it is assessed. [`settle`] is the list of the steps, in their order; each answers one question.
//!
//! They measure what `assess` measures: `candidate` weighs the evidence of the shapes for and against a pose,
//! `refine_with_borders` moves one to where surfaces, borders and holes fit together, `free_motion_search` looks along
//! what surfaces leave free. `context` is what all of them are given, `chosen_pose` what they give back.

mod all_pairs;
mod alternatives;
mod border_choice;
mod candidate;
mod chosen_pose;
mod context;
mod copies;
mod free_motion_search;
mod full_overlap;
mod holes;
mod pieces;
mod pulled_aside;
mod refine_with_borders;
mod remove_bend;
mod remove_offset;
mod remove_trims;

pub use all_pairs::is_better_with_all_pairs;
pub use alternatives::chosen_by_shape;
pub use border_choice::{OppositeHand, hand_by_borders, held_by_borders};
pub use chosen_pose::ChosenPose;
pub use context::PairContext;
pub use copies::placed_on_copies;
pub use full_overlap::placed_as_a_whole;
pub use holes::placed_by_holes;
pub use pieces::placed_by_pieces;
pub use pulled_aside::{PulledAside, Remainder, pulled_aside};
pub use refine_with_borders::refined_with_borders;
pub use remove_bend::without_bend;
pub use remove_offset::without_offset;
pub use remove_trims::without_trims;

use crate::assess::AssessSettings;
use crate::assess::contact::MAX_NODES;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{
    MatchOutcome, MatchSettings, Method, MirrorCheck, Surface, Termination, same_pose,
};
use chosen_pose::as_likely;

/// Chooses and moves the pose of `outcome`, of source and target. `check` is what it will be assessed by. Nothing
/// happens where the match was stopped, and where nothing was searched or refined.
pub fn settle(
    outcome: &mut MatchOutcome,
    surfaces: [&Surface; 2],
    settings: &MatchSettings,
    check: &AssessSettings,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let is_searched = settings.refine_on_full && settings.method != Method::Umeyama;
    if !is_searched || outcome.termination == Termination::Stopped {
        return Ok(());
    }
    let context = PairContext::new(surfaces, check, monitor);
    let found = outcome.target_from_source;
    choose_pairs(&context, outcome)?;
    hold(&context, outcome)?;
    for choose in CHOICES {
        if is_ended(&context, outcome) {
            return Ok(());
        }
        let chosen = choose(&context, outcome)?;
        // A search that was stopped leaves poses that were never refined.
        if is_ended(&context, outcome) {
            return Ok(());
        }
        take(outcome, chosen);
    }
    if let Some(pose) = without_trims(&context, &outcome.target_from_source)? {
        outcome.target_from_source = pose;
    }
    // Both hands are compared where their surfaces lie closest.
    if let Some(opposite) = hand_by_borders(&context, outcome)? {
        outcome.mirror_check = MirrorCheck {
            score_ratio: Some(opposite.score_ratio),
            by_borders: true,
            target_from_source: Some(opposite.target_from_source),
        };
    }
    remove_bend(&context, outcome)?;
    if check.remove_offset
        && let Some(pose) = without_offset(&context, &outcome.target_from_source)?
    {
        outcome.target_from_source = pose;
    }
    drop_same_poses(&context, outcome);
    measure_scale(&context, outcome, &found)
}

/// A step that may put another pose in the place of the result.
type Choice = fn(&PairContext<'_>, &MatchOutcome) -> Result<Option<ChosenPose>, Cancelled>;

/// These steps, in their order.
const CHOICES: [Choice; 5] = [
    chosen_by_shape,
    placed_by_holes,
    placed_by_pieces,
    placed_as_a_whole,
    placed_on_copies,
];

/// Whether a stop was asked for: the result is then the pose that was settled so far, and other poses were not sought
/// to the end.
fn is_ended(context: &PairContext<'_>, outcome: &mut MatchOutcome) -> bool {
    let is_stopped = context.is_stopped();
    if is_stopped {
        outcome.termination = Termination::Stopped;
        outcome.rivals_sought = false;
    }
    is_stopped
}

/// The pose of the closest pairs, or of all of them.
fn choose_pairs(context: &PairContext<'_>, outcome: &mut MatchOutcome) -> Result<(), Cancelled> {
    if let Some(pose) = outcome.with_all_pairs.take()
        && is_better_with_all_pairs(context, [&outcome.target_from_source, &pose])?
    {
        outcome.target_from_source = pose;
    }
    Ok(())
}

/// Moves the pose to where borders and holes hold it, unless that pulls it aside of where the surfaces lie on each
/// other.
fn hold(context: &PairContext<'_>, outcome: &mut MatchOutcome) -> Result<(), Cancelled> {
    let found = outcome.target_from_source;
    if let Some(held) = held_by_borders(context, outcome)? {
        let poses = [&found, &held.target_from_source];
        match pulled_aside(context, poses, Remainder::MayGrow)? {
            None => held.taken_by(outcome),
            Some(PulledAside::Rival) => {
                let rival = as_likely(held.target_from_source, outcome);
                outcome.alternatives.insert(0, rival);
            }
            Some(PulledAside::Worse) => {}
        }
    } else if let Some(pose) = refined_with_borders(context, &found)?
        && pulled_aside(context, [&found, &pose], Remainder::MayNotGrow)?.is_none()
    {
        outcome.target_from_source = pose;
    }
    Ok(())
}

/// Takes out of the pose what a bend does to it, unless that pulls it aside.
fn remove_bend(context: &PairContext<'_>, outcome: &mut MatchOutcome) -> Result<(), Cancelled> {
    let found = outcome.target_from_source;
    if let Some(pose) = without_bend(context, &found)?
        && pulled_aside(context, [&found, &pose], Remainder::MayGrow)?.is_none()
    {
        outcome.target_from_source = pose;
    }
    Ok(())
}

/// Leaves out alternatives that the steps have moved the pose to.
fn drop_same_poses(context: &PairContext<'_>, outcome: &mut MatchOutcome) {
    let part = context.source.measures().into();
    let pose = outcome.target_from_source;
    let alternatives = &mut outcome.alternatives;
    alternatives.retain(|other| !same_pose(&other.target_from_source, &pose, &part));
}

/// Where another pose took the place of the one that the match found, whose pairs say nothing about it, the scale is
/// that of the places where the parts meet.
fn measure_scale(
    context: &PairContext<'_>,
    outcome: &mut MatchOutcome,
    found: &Similarity,
) -> Result<(), Cancelled> {
    let pose = outcome.target_from_source;
    if same_pose(found, &pose, &context.source.measures().into()) {
        return Ok(());
    }
    context.check()?;
    let reach = context.distances(pose.scale).reach;
    let mut contacts = context.contacts(pose.scale, reach, MAX_NODES);
    let offset = context.settings.thickness.unwrap_or(0.0);
    let scale = contacts.best_scale(&pose, offset);
    outcome.scale_check.pair_scale = scale.unwrap_or(pose.scale);
    Ok(())
}

/// Another pose becomes the result where a step chose one.
fn take(outcome: &mut MatchOutcome, chosen: Option<ChosenPose>) {
    if let Some(chosen) = chosen {
        chosen.taken_by(outcome);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh, Vector3};
    use crate::registration::{MatchInput, match_surfaces};

    /// A piece of a sphere about the origin.
    fn cap(radius: f64) -> Surface {
        let n = 30_u32;
        let place = |i: u32| f64::from(i) / f64::from(n) - 0.5;
        let points = (0..(n + 1) * (n + 1)).map(|k| {
            let at = Vector3::new(place(k % (n + 1)), place(k / (n + 1)), 0.4);
            Point3::from(at.normalize() * radius)
        });
        let cells = (0..n * n).map(|k| k / n * (n + 1) + k % n);
        let up = n + 1;
        let triangles = cells.flat_map(|a| [[a, a + 1, a + up + 1], [a, a + up + 1, a + up]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    /// A match of two surfaces with the same nodes.
    fn superposed(source: &Surface, target: &Surface) -> MatchOutcome {
        let input = MatchInput {
            source,
            target,
            reduced: None,
        };
        let settings = MatchSettings::of(Method::Umeyama);
        match_surfaces(&input, &settings, &Monitor::silent()).unwrap()
    }

    #[test]
    fn a_pose_is_no_alternative_to_itself() {
        let part = cap(100.0);
        let (check, monitor) = (AssessSettings::default(), Monitor::silent());
        let mut outcome = superposed(&part, &part);
        let shifted = |shift: f64| {
            let mut pose = Similarity::identity();
            pose.translation.x = shift;
            as_likely(pose, &outcome)
        };
        let alternatives = [shifted(0.5), shifted(50.0)];
        outcome.alternatives = alternatives.to_vec();
        outcome.target_from_source = Similarity::identity();
        let context = PairContext::new([&part, &part], &check, &monitor);
        drop_same_poses(&context, &mut outcome);
        let left = outcome.alternatives.iter();
        let left: Vec<f64> = left
            .map(|other| other.target_from_source.translation.x)
            .collect();
        assert_eq!(left, [50.0]);
    }

    #[test]
    fn a_stop_ends_the_choice_between_poses_and_is_told() {
        let part = cap(100.0);
        let monitor = Monitor::silent();
        let input = MatchInput {
            source: &part,
            target: &part,
            reduced: None,
        };
        let settings = MatchSettings::default();
        let mut outcome = match_surfaces(&input, &settings, &monitor).unwrap();
        assert!(outcome.rivals_sought && outcome.termination != Termination::Stopped);
        monitor.request_stop();
        let check = AssessSettings::default();
        settle(&mut outcome, [&part, &part], &settings, &check, &monitor).unwrap();
        assert!(!outcome.rivals_sought);
        assert_eq!(outcome.termination, Termination::Stopped);
    }

    #[test]
    fn the_scale_of_the_pairs_is_that_under_the_pose_that_was_chosen() {
        let (small, large) = (cap(100.0), cap(100.5));
        let (check, monitor) = (AssessSettings::default(), Monitor::silent());
        for (source, target, scale) in [(&small, &large, 1.005), (&large, &small, 1.0 / 1.005)] {
            let context = PairContext::new([source, target], &check, &monitor);
            let mut outcome = superposed(source, target);
            outcome.target_from_source = Similarity::identity();
            outcome.scale_check.pair_scale = 1.3;
            // A pose that was only moved keeps what its pairs said.
            let mut found = Similarity::identity();
            found.translation.x = 0.5;
            measure_scale(&context, &mut outcome, &found).unwrap();
            assert_eq!(outcome.scale_check.pair_scale, 1.3);
            found.translation.x = 50.0;
            measure_scale(&context, &mut outcome, &found).unwrap();
            let measured = outcome.scale_check.pair_scale;
            assert!((measured - scale).abs() < 5e-4, "{measured}");
        }
    }
}
