//! The work that undo brings back: parts, levels, pose, settings, result.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::{Label, Mapping, PointPairs, Shared};
use crate::assess::Verdict;
use crate::formats::PartSummary;
use crate::formats::model::ReadFile;
use crate::geometry::{Aabb, Landmarks, Similarity, TriMesh};
use crate::jobs::{MeasuredLevel, PartFacts, PartSource, Stamp};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::{MatchRecipe, MatchRun};
use crate::pipeline::names::told_apart;
use crate::role::{PerRole, Role};
use crate::settings::SETTINGS;

/// What undo covers: a value that is cheap to clone, because all geometry is shared.
///
/// There is no pose for the crash part anywhere, so nothing can move it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// The loaded parts.
    pub parts: PerRole<Option<Part>>,
    /// The parts, by their stamp, of which the user said that all of the crash model are meant.
    pub all_meant_for: Option<PerRole<u64>>,
    /// Where the stamped part lies.
    pub pose: StampedPose,
    /// Points that were picked on both parts.
    pub pairs: PointPairs,
    /// Every setting of the match.
    pub recipe: MatchRecipe,
    /// What they are for other parts, while a remedy has changed some for the present ones.
    pub recipe_before_remedy: Option<Box<MatchRecipe>>,
    /// The last match that was taken over.
    pub result: Option<MatchResult>,
    /// Forming results onto the crash part.
    pub mapping: Mapping,
    /// Values pinned to nodes, oldest first.
    pub labels: Vec<Label>,
    /// Number of the project it comes from, a new one whenever one is opened; 0 before.
    pub project: u64,
}

/// The pose of the stamped part with the number of its state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StampedPose {
    /// `crash = c · R · stamped + t`.
    pub crash_from_stamped: Similarity,
    /// Never given twice; see [`Stamp`].
    pub revision: u64,
}

/// A loaded part with everything the user chose about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What was read.
    pub loaded: Shared<LoadedPart>,
    /// Where it came from.
    pub source: PartSource,
    /// What was counted and measured about it.
    pub facts: Shared<PartFacts>,
    /// Never given twice; see [`Stamp`].
    pub revision: u64,
    /// The ceiling of triangles the user asked for; stays when the part is read again.
    pub wanted_level: Option<usize>,
    /// The level reached, `None` while the full mesh is used.
    pub level: Option<Shared<MeasuredLevel>>,
    /// Ids of hidden parts of the deck.
    pub hidden: BTreeSet<u64>,
    /// Colours the user gave, sRGB.
    pub colors: BTreeMap<u64, [u8; 3]>,
}

/// A match that was taken over, with the choice among its poses.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchResult {
    /// What the match found.
    pub run: Shared<MatchRun>,
    /// The alternative that is shown instead of the best pose.
    pub alternative: Option<usize>,
    /// The state of the document right after the result was taken over.
    pub stamp: Stamp,
    /// What the lengths of both parts were multiplied by then.
    pub length_factors: PerRole<Option<f64>>,
}

impl MatchResult {
    /// The verdict on the pose that is taken: where another pose fits better, an alternative is at best one
    /// to check.
    pub fn verdict(&self) -> Verdict {
        match (self.alternative, self.run.assessment.verdict) {
            (Some(_), Verdict::Good) => Verdict::Check,
            (_, verdict) => verdict,
        }
    }
}

impl Part {
    /// A freshly read part: all shown, nothing reduced.
    pub fn new(
        loaded: Arc<LoadedPart>,
        facts: Arc<PartFacts>,
        source: PartSource,
        revision: u64,
    ) -> Self {
        Self {
            loaded: loaded.into(),
            facts: facts.into(),
            source,
            revision,
            wanted_level: None,
            level: None,
            hidden: BTreeSet::new(),
            colors: BTreeMap::new(),
        }
    }

    /// The mesh at the chosen level, or the full one.
    pub fn reduced_mesh(&self) -> &Arc<TriMesh> {
        match &self.level {
            Some(measured) => &measured.level.mesh,
            None => &self.loaded.mesh,
        }
    }

    /// The ceiling that the mesh in use was reduced to; `None` for the full mesh.
    pub fn ceiling(&self) -> Option<usize> {
        self.level.as_ref().map(|measured| measured.max_triangles)
    }

    /// True if this part of the deck is shown.
    pub fn is_visible(&self, id: u64) -> bool {
        !self.hidden.contains(&id)
    }

    /// The holes and corners of what is shown of it.
    pub fn shown_landmarks(&self) -> impl Iterator<Item = &Landmarks> {
        let all = self.facts.landmarks.iter();
        all.filter(|(id, _)| self.is_visible(**id))
            .map(|(_, of_part)| of_part)
    }

    /// True if this part of the deck is matched.
    pub fn is_used(&self, id: u64) -> bool {
        self.facts.used.contains(&id)
    }

    /// The parts of the deck with elements that are not matched.
    pub fn unused(&self) -> impl Iterator<Item = u64> {
        let has_elements = |part: &&PartSummary| part.n_shells + part.n_solids > 0;
        let parts = self.facts.parts.iter().filter(has_elements);
        parts.map(|part| part.id).filter(|id| !self.is_used(*id))
    }

    /// True if the deck holds more than is matched.
    pub fn has_unused(&self) -> bool {
        self.unused().next().is_some()
    }

    /// The factor its coordinates were multiplied by at loading.
    pub fn length_factor(&self) -> f64 {
        self.loaded.settings.length_factor
    }

    /// Bounds in the part's own space.
    pub fn bounds(&self) -> Aabb {
        self.facts.bounds
    }
}

impl Document {
    /// One of the two parts.
    pub fn part(&self, role: Role) -> Option<&Part> {
        self.parts.get(role).as_ref()
    }

    /// Both parts, if both are there.
    pub fn both(&self) -> Option<PerRole<&Part>> {
        let PerRole { crash, stamped } = self.parts.as_ref();
        Some(PerRole {
            crash: crash.as_ref()?,
            stamped: stamped.as_ref()?,
        })
    }

    /// The numbers of the present state of the inputs; 0 stands for "no part".
    pub fn stamp(&self) -> Stamp {
        let revision = |part: &Option<Part>| part.as_ref().map_or(0, |p| p.revision);
        Stamp {
            parts: PerRole {
                crash: revision(&self.parts.crash),
                stamped: revision(&self.parts.stamped),
            },
            pose: self.pose.revision,
        }
    }

    /// The factors that the lengths of the parts are multiplied by.
    pub(super) fn length_factors(&self) -> PerRole<Option<f64>> {
        PerRole::from_fn(|role| self.part(role).map(Part::length_factor))
    }

    /// The numbers of all parts there are, those of further stamped files too.
    pub fn revisions(&self) -> Vec<u64> {
        let parts = self.parts.iter().filter_map(|(_, part)| part.as_ref());
        let further = self.mapping.further.iter();
        parts
            .map(|part| part.revision)
            .chain(further.map(|further| further.revision))
            .collect()
    }

    /// The files that were read from disk, with what was read.
    pub fn files_read(&self) -> Vec<ReadFile> {
        let parts = self.parts.iter().filter_map(|(_, part)| part.as_ref());
        let from_disk = parts.filter(|part| matches!(part.source, PartSource::File(_)));
        let further = self.mapping.further.iter().map(|further| &further.loaded);
        from_disk
            .map(|part| &part.loaded)
            .chain(further)
            .flat_map(|part| part.model.files.clone())
            .collect()
    }

    /// The files that something was found in while they were read, further stamped files too, with their part.
    pub fn files_with_diagnostics(&self) -> impl Iterator<Item = (Role, &LoadedPart)> {
        let crash = self.part(Role::Crash).map(|part| &part.loaded);
        let crash = crash.into_iter().map(|part| (Role::Crash, &**part));
        let stamped = self.all_stamped().map(|part| (Role::Stamped, &**part));
        let has_any = |part: &LoadedPart| part.diagnostics().iter().any(|found| !found.is_empty());
        crash.chain(stamped).filter(move |(_, part)| has_any(part))
    }

    /// Every setting of the match as the user wants it, for other parts too.
    pub(super) fn set_recipe(&mut self, recipe: MatchRecipe) {
        if let Some(before) = &mut self.recipe_before_remedy {
            let changed = SETTINGS.iter().filter_map(|setting| {
                let value = setting.get(&recipe)?;
                (setting.get(&self.recipe).as_ref() != Some(&value)).then_some((setting, value))
            });
            for (setting, value) in changed {
                setting.set(before, &value);
            }
        }
        self.recipe = recipe;
    }

    /// The settings that a remedy asks for, until other parts are matched.
    pub(super) fn set_remedy(&mut self, recipe: MatchRecipe) {
        let before = std::mem::replace(&mut self.recipe, recipe);
        self.recipe_before_remedy
            .get_or_insert_with(|| Box::new(before));
    }

    /// Other parts are there: what remedies changed goes with those before.
    pub(super) fn end_remedies(&mut self) {
        if let Some(recipe) = self.recipe_before_remedy.take() {
            self.recipe = *recipe;
        }
    }

    /// True if the stamped part was moved.
    pub fn has_pose(&self) -> bool {
        self.pose.crash_from_stamped != Similarity::identity()
    }

    /// The pose of the stamped part.
    pub fn crash_from_stamped(&self) -> &Similarity {
        &self.pose.crash_from_stamped
    }

    /// The result, if parts and pose are still those it stands for.
    pub fn current_result(&self) -> Option<&MatchResult> {
        self.result.as_ref().filter(|r| r.stamp == self.stamp())
    }

    /// Name of a part's file, with its folder where the other part's file has the same name.
    pub fn name_of(&self, role: Role) -> String {
        let path = |role| Some(self.part(role)?.loaded.path.as_path());
        let all = Role::ALL.into_iter().filter_map(path);
        path(role).map_or_else(String::new, |own| told_apart(own, all))
    }

    /// True if both parts were read from one file, which is seldom meant.
    pub fn has_one_file(&self) -> bool {
        let both = self.both();
        both.is_some_and(|both| both.crash.loaded.path == both.stamped.loaded.path)
    }

    /// Centre of the box of the stamped part at its pose, the pivot of moves by hand.
    pub fn stamped_center(&self) -> Option<crate::geometry::Point3> {
        let part = self.parts.stamped.as_ref()?;
        let bounds = part.bounds();
        (!bounds.is_empty()).then(|| self.pose.crash_from_stamped.apply(&bounds.center()))
    }
}
