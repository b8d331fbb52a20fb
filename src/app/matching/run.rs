//! Starts, stops and cancels alignment and match.

use std::sync::Arc;

use super::MatchState;
use super::starts::LiveStarts;
use crate::app::work::Work;
use crate::app::{Document, Effect, GestureId, OfParts, Part};
use crate::jobs::{JobKind, MatchInput};
use crate::pipeline::match_parts::{MatchRecipe, ReducedPair};
use crate::registration::StartMethod;

impl MatchState {
    /// Changes the settings as one undo step; says whether anything changed.
    pub(super) fn change_recipe(
        &mut self,
        work: &mut Work<'_>,
        name: &str,
        gesture: GestureId,
        change: impl FnOnce(&mut Document),
    ) -> bool {
        if work.is_unlocked().is_err() {
            return false;
        }
        let has_changed = work.commit_in(name, Some(gesture), change);
        if self.starts_of(work.document).is_none() {
            work.previews.start = None;
        }
        has_changed
    }

    pub(in crate::app) fn run_match(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        self.run_as_asked(work, JobKind::Match)
    }

    /// Finds the parts of the crash model that the stamped part belongs to; the match follows with them.
    pub(in crate::app) fn find_parts(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        self.run_as_asked(work, JobKind::FindParts)
    }

    /// From where the part lies now, whatever the recipe begins with; a wide search would lead away from it.
    pub(super) fn refine(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        let mut recipe = work.document.recipe.clone();
        recipe.settings.starts.method = StartMethod::CurrentPose;
        recipe.settings.starts.wide_search = false;
        self.run_match_of(work, recipe, JobKind::Match)
    }

    /// With the starts of the recipe; not while the pairs it begins with fix no pose.
    fn run_as_asked(
        &mut self,
        work: &mut Work<'_>,
        kind: impl FnOnce(MatchInput) -> JobKind,
    ) -> Vec<Effect> {
        let recipe = work.document.recipe_to_run();
        recipe.map_or_else(Vec::new, |recipe| self.run_match_of(work, recipe, kind))
    }

    fn run_match_of(
        &mut self,
        work: &mut Work<'_>,
        recipe: MatchRecipe,
        kind: impl FnOnce(MatchInput) -> JobKind,
    ) -> Vec<Effect> {
        let effects = start_with_input(work, recipe, kind);
        if !effects.is_empty() {
            self.live_starts = OfParts::new(work.document, LiveStarts::default());
            self.failure = None;
            work.previews.chosen_start = None;
            work.previews.live = None;
        }
        effects
    }
}

/// The surface normals aligned, whatever the recipe begins with.
pub(super) fn align(work: &mut Work<'_>) -> Vec<Effect> {
    let recipe = work.document.recipe.clone();
    start_with_input(work, recipe, JobKind::Align)
}

/// The inputs of a match: the levels that are shown, the settings, the pose.
fn match_input(work: &Work<'_>, recipe: MatchRecipe) -> Option<MatchInput> {
    work.document.can_match(work.jobs).ok()?;
    let both = work.document.both()?;
    let is_reduced = both.crash.level.is_some() || both.stamped.level.is_some();
    let reduced = is_reduced.then(|| ReducedPair {
        meshes: both.map(|part| Arc::clone(part.reduced_mesh())),
        max_triangles: both.map(Part::ceiling),
    });
    Some(MatchInput {
        parts: both.map(|part| part.loaded.to_arc()),
        reduced,
        recipe,
        current: *work.document.crash_from_stamped(),
    })
}

pub(super) fn start_with_input(
    work: &mut Work<'_>,
    recipe: MatchRecipe,
    kind: impl FnOnce(MatchInput) -> JobKind,
) -> Vec<Effect> {
    let Some(input) = match_input(work, recipe) else {
        return Vec::new();
    };
    work.previews.drop_all();
    vec![work.start(kind(input))]
}

pub(super) fn stop_run(work: &mut Work<'_>) -> Vec<Effect> {
    let Some(key) = work.jobs.locking_job() else {
        return Vec::new();
    };
    work.jobs.ending(key, false);
    vec![Effect::StopJob(key)]
}

pub(super) fn cancel_run(work: &mut Work<'_>) -> Vec<Effect> {
    let key = work.jobs.locking_job();
    key.map_or_else(Vec::new, |key| work.cancel(key))
}
