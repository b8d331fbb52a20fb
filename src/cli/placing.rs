//! Where the stamped parts of a mapping lie: as given, or by a match.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context as _;

use super::UsageError;
use super::map::MapChoice;
use super::recipe::pose;
use crate::assess::Verdict;
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::find_parts::{find_parts, guessed_units};
use crate::pipeline::load::{LoadedPart, prepare};
use crate::pipeline::map::{PoseOrigin, place as place_part, placing_recipe};
use crate::pipeline::map_car::CarReason;
use crate::pipeline::match_parts::{MatchRecipe, MatchRun};
use crate::pipeline::project::{Project, ProjectFile};
use crate::pipeline::units::PairUnits;
use crate::role::PerRole;
use crate::text::{Lengths, counted};

/// Where the stamped parts lie.
pub(super) struct Placed {
    /// The crash parts that they lie on.
    pub(super) crash: LoadedPart,
    /// The pose of each, and where it comes from.
    pub(super) poses: Vec<(Similarity, PoseOrigin)>,
}

/// Says which files are not those of a project as they were when it was saved; an error where one has the place of
/// another.
fn check_files(
    project: &Project,
    path: &Path,
    crash: &LoadedPart,
    stamped: &[LoadedPart],
) -> anyhow::Result<()> {
    let expected = project.files();
    let hash_of = |file: ProjectFile| project.entry(file)?.hash;
    let files = std::iter::once(crash).chain(stamped);
    for (&file, part) in expected.iter().zip(files) {
        let (Some(saved), Some(now)) = (hash_of(file), part.hash()) else {
            continue;
        };
        if saved == now {
            continue;
        }
        let name = part.path.display();
        if let Some(other) = expected.iter().find(|other| hash_of(**other) == Some(now)) {
            let (other, own) = (other.words(), file.words());
            let text = format!("{name} is {other} of {}, not {own}", path.display());
            return Err(UsageError(text).into());
        }
        log::warn!(
            "{name} is not {} of {} as it was when that was saved: the pose may not be that of this file",
            file.words(),
            path.display()
        );
    }
    Ok(())
}

/// The pose of each stamped part as it is given (`typed`), or by a match on the crash parts that it belongs to.
pub(super) fn place(
    choice: &MapChoice,
    typed: &[String],
    (crash, stamped): (LoadedPart, &[LoadedPart]),
    monitor: &Monitor,
) -> anyhow::Result<Placed> {
    let given = |crash, poses: Vec<Similarity>| {
        let poses = poses.into_iter().map(|pose| (pose, PoseOrigin::Given));
        Ok(Placed {
            crash,
            poses: poses.collect(),
        })
    };
    if choice.identity {
        return given(crash, vec![Similarity::identity(); stamped.len()]);
    }
    if let Some(path) = &choice.project {
        let (project, notes) = Project::read(path)?;
        for note in notes {
            log::warn!("{}: {note}", path.display());
        }
        let poses = project.stamped_poses();
        let (n_poses, n_files) = (poses.len(), stamped.len());
        let poses: Option<Vec<Similarity>> = poses.into_iter().collect();
        return match poses.filter(|_| n_poses == n_files) {
            Some(poses) => {
                choice.lengths.check_project(&project, path)?;
                check_files(&project, path, &crash, stamped)?;
                given(crash, poses)
            }
            None if n_poses == n_files => Err(UsageError(format!(
                "a stamped file of {} has no pose yet; match it in the window",
                path.display()
            ))
            .into()),
            None => Err(UsageError(format!(
                "{} holds {}, but {n_files} are named",
                path.display(),
                counted(n_poses, "stamped file")
            ))
            .into()),
        };
    }
    if !typed.is_empty() {
        let poses: anyhow::Result<Vec<Similarity>> =
            typed.iter().map(|text| pose("--pose", text)).collect();
        return given(crash, poses?);
    }
    let recipe = placing_recipe(choice.hand());
    if choice.crash_part.is_none() && crash.chosen_part_ids().len() > 1 {
        if let Some(placed) = on_found_parts(&crash, stamped, &recipe, monitor)? {
            return Ok(placed);
        }
        log::warn!(
            "no part of {} fits alone; --crash-part names it",
            crash.path.display()
        );
    }
    let mut poses = Vec::new();
    for part in stamped {
        let parts = PerRole::new(&crash, part);
        let file = part.path.display().to_string();
        let run =
            place_part(parts, &recipe, monitor).with_context(|| format!("cannot match {file}"))?;
        warn_of_doubt(&run, parts);
        poses.push(found_by(&run));
    }
    Ok(Placed { crash, poses })
}

/// Says why a match is not good: the record of a mapping holds the verdict alone.
fn warn_of_doubt(run: &MatchRun, parts: PerRole<&LoadedPart>) {
    if run.assessment.verdict == Verdict::Good {
        return;
    }
    let units = PairUnits::of(parts.map(Some));
    let why = run.assessment.sentences(Lengths::new(units.lengths));
    if let Some(why) = why.first() {
        log::warn!("{}: {why}", parts.stamped.path.display());
    }
}

/// The pose that a match found.
fn found_by(run: &MatchRun) -> (Similarity, PoseOrigin) {
    let verdict = run.assessment.verdict;
    (run.crash_from_stamped, PoseOrigin::Match { verdict })
}

/// Tells where a crash part would have the size of the stamped part in another unit.
pub(super) fn warn_of_unit(parts: PerRole<&LoadedPart>, monitor: &Monitor) -> anyhow::Result<()> {
    if let Some(unit) = guessed_units(parts, monitor)? {
        let reasons = [CarReason::NoPart, CarReason::OtherUnit(unit)].map(|reason| reason.text());
        log::warn!("{}: {}", parts.stamped.path.display(), reasons.join("; "));
    }
    Ok(())
}

/// The crash parts that the stamped parts belong to, and the poses on them; `None` if one of them fits no
/// part of the crash model.
fn on_found_parts(
    crash: &LoadedPart,
    stamped: &[LoadedPart],
    recipe: &MatchRecipe,
    monitor: &Monitor,
) -> anyhow::Result<Option<Placed>> {
    let mut ids = BTreeSet::new();
    let mut poses = Vec::new();
    for part in stamped {
        let parts = PerRole::new(crash, part);
        let found = find_parts(parts, recipe, &Similarity::identity(), monitor);
        let found = found.with_context(|| format!("cannot match {}", part.path.display()))?;
        let Some(found) = found else {
            warn_of_unit(parts, monitor)?;
            return Ok(None);
        };
        if !found.rivals.is_empty() {
            let reason = CarReason::Rivals(found.rivals);
            log::warn!("{}: {}", part.path.display(), reason.text());
        }
        warn_of_doubt(&found.found.run, parts);
        ids.extend(found.found.part.chosen_part_ids());
        poses.push(found_by(&found.found.run));
    }
    let mut settings = crash.settings.clone();
    settings.selection = Selection::Parts(ids.into_iter().collect());
    let crash = prepare(&crash.path, Arc::clone(&crash.model), &settings, monitor)?;
    Ok(Some(Placed { crash, poses }))
}
