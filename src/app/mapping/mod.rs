//! Carrying the forming results onto the crash part: what was chosen, what came out, and how it is
//! looked at.

mod command;
mod further;
mod picture;
mod placing;
mod probe;
mod quantity;
mod results;
mod shown_files;
mod stamped_rows;

pub use command::MapCommand;
pub(super) use further::{FURTHER_WITHOUT_POSE, NewFurther, further_dropped};
pub use further::{Further, MappingState};
pub use picture::{MapDisplay, MapPicture};
pub use placing::Placing;
pub use probe::ProbeReport;
use probe::Probed;
pub use quantity::Quantity;
pub(super) use results::{take_compared, take_mapped};
pub use shown_files::{FileShare, ShownFile};
pub use stamped_rows::{StampedRow, StampedState};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::further::{set_pose, set_units};
use super::history::step_words;
use super::work::Work;
use super::{AppState, ColorBy, Document, Effect, MatchResult, Reason, Shared};
use crate::geometry::Similarity;
use crate::jobs::{CompareMappingInput, JobKey, JobKind, MapInput, Stamp};
use crate::pipeline::forming_values::{FormingValue, has_forming_value, nominal_thickness};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::{
    ChangedParts, ElementLists, MapRecipe, MapRecord, MapRun, OtherResult, PoseOrigin,
};
pub use crate::pipeline::map::{DoubtfulElement, FurtherPose, UnmappedElement};
use crate::pipeline::names::file_name;
use crate::role::{PerRole, Role};
use crate::settings::{MAP_SETTINGS, changed_setting};

/// What undo covers of the mapping.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    /// Quantities, method, limits.
    pub recipe: MapRecipe,
    /// Stamped files beside the first one, in the order of the list.
    pub further: Vec<Further>,
    /// The other mapper's file that every mapping is compared with.
    pub compare_with: Option<PathBuf>,
    /// The last mapping.
    pub result: Option<MapResult>,
    /// Ids of the crash elements that were pinned for the report, in this order.
    pub pins: Vec<u64>,
}

/// A mapping with the state it was made at.
#[derive(Debug, Clone, PartialEq)]
pub struct MapResult {
    /// Values, statuses, checks.
    pub run: Shared<MapRun>,
    /// The same in figures.
    pub record: Shared<MapRecord>,
    /// Elements to look at.
    pub lists: Shared<ElementLists>,
    /// Parts and pose.
    pub stamp: Stamp,
    /// The stamped parts that it was made from beside the first one; their poses are the run's.
    pub further: Vec<Shared<LoadedPart>>,
    /// Another mapper's result for the same elements.
    pub other: Option<Shared<OtherResult>>,
}

/// Moves of less than this share of the part are the rounding of one that comes back.
const UNMOVED: f64 = 1e-9;

/// Why there is no picture of the files.
pub(super) const FROM_ONE_FILE: &str = "nothing is mapped from several stamped files";

impl Document {
    /// The mapping, if parts and pose are still those it was made at.
    pub fn current_mapping(&self) -> Option<&MapResult> {
        let result = self.mapping.result.as_ref();
        result.filter(|result| result.stamp == self.stamp())
    }

    /// True if quantities, options or stamped files were changed after the current mapping was made.
    pub fn is_mapping_out_of_date(&self) -> bool {
        self.mapping_changes().is_some()
    }

    /// What was changed after the current mapping was made; `None` if nothing was.
    pub(super) fn mapping_changes(&self) -> Option<&'static str> {
        let result = self.current_mapping()?;
        if result.run.recipe != self.wanted_mapping() {
            Some("the options changed after the mapping")
        } else if !self.has_same_stamped(result) {
            Some("the stamped files changed after the mapping")
        } else {
            None
        }
    }

    /// What a mapping would be asked with now: without the quantities that all stamped parts lack.
    pub fn wanted_mapping(&self) -> MapRecipe {
        let mut recipe = self.mapping.recipe.clone();
        for quantity in Quantity::ALL {
            if self.lacks_quantity(quantity).is_some() {
                *quantity.switch(&mut recipe.options.quantities) = false;
            }
        }
        recipe
    }

    /// `Ok` if the forming results can be mapped now.
    pub fn can_map(&self) -> Result<(), Reason> {
        self.has_forming_results()?;
        if self
            .part(Role::Crash)
            .is_some_and(|part| !part.loaded.has_shells())
        {
            return Err(Reason("The crash part has no shells to map onto."));
        }
        self.further_poses().map(|_| ())
    }

    /// `Ok` if somebody has said where the stamped part belongs.
    pub fn has_pose_to_map_at(&self) -> Result<(), Reason> {
        if self.pose_origin() != PoseOrigin::AsLoaded {
            return Ok(());
        }
        Err(Reason(
            "There is no match yet: match first, or choose Map as loaded in section 4.",
        ))
    }

    /// Where the pose of the stamped part comes from.
    pub fn pose_origin(&self) -> PoseOrigin {
        let is_moved = *self.crash_from_stamped() != Similarity::identity();
        let (Some(result), Some(part)) = (&self.result, self.part(Role::Stamped)) else {
            return if is_moved {
                PoseOrigin::ByHand
            } else {
                PoseOrigin::AsLoaded
            };
        };
        let bounds = part.bounds();
        let found = result.run.pose(result.alternative);
        let distance = found.map_or(0.0, |found| {
            found.max_displacement(self.crash_from_stamped(), &bounds.corners())
        });
        // Moved there and back is not moved.
        let is_elsewhere = result.stamp != self.stamp() && distance > UNMOVED * bounds.diagonal();
        if let Some(changed) = self.changed_after(result) {
            return if is_elsewhere && !is_moved {
                PoseOrigin::AsLoaded
            } else {
                PoseOrigin::Outdated {
                    changed,
                    distance: is_elsewhere.then_some(distance),
                    verdict: result.verdict(),
                }
            };
        }
        let verdict = result.run.assessment.verdict;
        if is_elsewhere {
            PoseOrigin::Moved { distance, verdict }
        } else if result.alternative.is_some() {
            PoseOrigin::Alternative
        } else {
            PoseOrigin::Match { verdict }
        }
    }

    /// The parts that are others now than those a match was made with.
    fn changed_after(&self, result: &MatchResult) -> Option<ChangedParts> {
        let (then, now) = (&result.stamp.parts, self.stamp().parts);
        ChangedParts::of(PerRole {
            crash: then.crash == now.crash,
            stamped: then.stamped == now.stamped,
        })
    }

    /// `Ok` if there is something to map.
    pub fn has_forming_results(&self) -> Result<(), Reason> {
        self.has_both_parts()?;
        let has_any = |part: &Shared<LoadedPart>| {
            !part.model.forming.is_empty() || !part.model.shell_extras.is_empty()
        };
        if self.all_stamped().any(has_any) {
            return Ok(());
        }
        Err(Reason(if self.mapping.further.is_empty() {
            "The stamped file holds no forming results."
        } else {
            "None of the stamped files holds forming results."
        }))
    }
}

impl AppState {
    /// `Ok` if a mapping may start, or one runs that may be given up.
    pub fn can_map(&self) -> Result<(), Reason> {
        if self.jobs.is_active(JobKey::Map) {
            return Ok(());
        }
        self.document.can_map()?;
        // During the first match there is none yet, but it need not be begun.
        self.jobs.is_unlocked()?;
        self.jobs.are_parts_read()?;
        self.document.has_pose_to_map_at()?;
        self.shows_its_pose()
    }

    /// `Ok` if a mapping of a part that was neither matched nor moved may start.
    pub fn can_map_as_loaded(&self) -> Result<(), Reason> {
        self.document.can_map()?;
        if self.document.has_pose_to_map_at().is_ok() {
            return Err(Reason(
                "The stamped part has a pose: Map carries over there.",
            ));
        }
        self.jobs.are_parts_read()?;
        self.jobs.is_unlocked()?;
        self.shows_its_pose()
    }

    /// The elements without values of the current mapping, the first of each reason in turn, at most
    /// forty; and how many there are.
    pub fn unmapped_elements(&self) -> (Vec<UnmappedElement>, usize) {
        let result = self.document.current_mapping();
        result.map_or_else(Default::default, |result| {
            (result.lists.unmapped.clone(), result.lists.n_unmapped)
        })
    }

    /// The mapped elements that can be trusted least, the worst first, at most forty; of equal ones those
    /// that come first in the deck. Elements that can be trusted wholly are not among them.
    pub fn doubtful_elements(&self) -> Vec<DoubtfulElement> {
        let result = self.document.current_mapping();
        result.map_or_else(Vec::new, |result| result.lists.doubtful.clone())
    }

    /// The thickness of the flat sheet: the crash part's section, else the stamped part's.
    pub fn flat_thickness(&self) -> Option<f64> {
        let of = |role| nominal_thickness(&self.document.part(role)?.loaded);
        of(Role::Crash).or_else(|| of(Role::Stamped))
    }

    /// The current mapping, if it gives the crash part what a choice of colours asks for.
    pub fn mapped_for(&self, by: ColorBy) -> Option<Arc<MapRun>> {
        let run = &self.document.current_mapping()?.run;
        let wanted = run.recipe.options.quantities;
        let has = match by.forming() {
            Some(FormingValue::Thinning) => wanted.thickness,
            Some(FormingValue::PlasticStrain) => wanted.plastic_strain,
            Some(FormingValue::VonMises | FormingValue::MajorStress) => wanted.stress,
            Some(FormingValue::MajorStrain | FormingValue::MinorStrain) => wanted.strain,
            None => by == ColorBy::Thickness && wanted.thickness,
        };
        has.then(|| run.to_arc())
    }

    /// Why no loaded part has what a choice of colours asks for; `None` if one has it.
    pub fn missing_for(&self, by: ColorBy) -> Option<&'static str> {
        if by == ColorBy::MapOther {
            let result = self.document.current_mapping();
            let has_other = result.is_some_and(|result| result.other.is_some());
            return (!has_other).then_some("the mapping was compared with no other file yet");
        }
        if by == ColorBy::MapFile {
            let result = self.document.current_mapping();
            let has_several = result.is_some_and(MapResult::has_several_files);
            return (!has_several).then_some(FROM_ONE_FILE);
        }
        if by.map_picture().is_some() {
            let has_mapping = self.document.current_mapping().is_some();
            return (!has_mapping).then_some("nothing is mapped at this pose yet");
        }
        if by == ColorBy::Uncertainty {
            return self.has_uncertainty().err().map(|reason| reason.0);
        }
        let value = by.forming()?;
        let flat = self.flat_thickness();
        let mut reason = Some("no part is loaded");
        for role in Role::ALL {
            if let Some(part) = self.document.part(role) {
                match has_forming_value(&part.loaded, value, flat) {
                    Ok(()) => return None,
                    Err(why) => reason = Some(why),
                }
            }
        }
        reason
    }
}

impl MappingState {
    pub(super) fn apply(&mut self, work: &mut Work<'_>, command: MapCommand) -> Vec<Effect> {
        match command {
            MapCommand::SetRecipe(recipe) => {
                work.commit("Mapped quantities", |document| {
                    document.mapping.recipe = *recipe;
                });
            }
            MapCommand::SetOptions(options) => {
                let before = &work.document.mapping.recipe.options;
                let change = changed_setting(&MAP_SETTINGS, [before, &*options]);
                let [about, name] = step_words("Mapping settings", change, work.lengths());
                let gesture = work.history.series(&about, work.log.now);
                work.commit_in(name, Some(gesture), |document| {
                    document.mapping.recipe.options = *options;
                });
            }
            MapCommand::AskFurther => return vec![Effect::AskFurther],
            MapCommand::AddFurther(file) => return self.add(work, file),
            MapCommand::RemoveFurther(revision) => return self.remove(work, revision),
            MapCommand::SetFurtherPose(revision, pose) => set_pose(work, revision, pose),
            MapCommand::SetFurtherUnits(revision, units) => {
                return set_units(work, revision, units);
            }
            MapCommand::MatchFurther(revision) => self.match_again(work, revision),
            MapCommand::StopFurther => {
                work.jobs.ending(JobKey::PlaceFurther, false);
                return vec![Effect::StopJob(JobKey::PlaceFurther)];
            }
            MapCommand::MapOrCancel if work.jobs.is_active(JobKey::Map) => {
                return work.cancel(JobKey::Map);
            }
            MapCommand::MapOrCancel if work.document.has_pose_to_map_at().is_err() => {}
            MapCommand::MapOrCancel | MapCommand::MapAsLoaded => {
                self.restoring = None;
                return start(work);
            }
            MapCommand::AskOther if work.jobs.is_active(JobKey::CompareMapping) => {
                return work.cancel(JobKey::CompareMapping);
            }
            MapCommand::AskOther => return vec![Effect::AskOtherMapping],
            MapCommand::CompareWith(file) => {
                self.restoring = None;
                return compare_with(work, file).into_iter().collect();
            }
            MapCommand::EndComparison => end_comparison(work),
            MapCommand::TogglePin(id) => toggle_pin(work, id),
            MapCommand::Probe(element) => {
                self.probed = element.and_then(|element| Probed::of(work.document, element));
            }
        }
        Vec::new()
    }
}

fn toggle_pin(work: &mut Work<'_>, id: u64) {
    let pins = &work.document.mapping.pins;
    let at = pins.iter().position(|pin| *pin == id);
    let name = if at.is_some() {
        "Remove a pin"
    } else {
        "Pin an element"
    };
    work.commit(name, |document| {
        let pins = &mut document.mapping.pins;
        match at {
            Some(at) => {
                pins.remove(at);
            }
            None => pins.push(id),
        }
    });
}

fn start(work: &mut Work<'_>) -> Vec<Effect> {
    let may_start = work.document.can_map().is_ok()
        && work.is_unlocked().is_ok()
        && work.jobs.are_parts_read().is_ok();
    if !may_start {
        return Vec::new();
    }
    let Some(both) = work.document.both() else {
        return Vec::new();
    };
    let Ok(poses) = work.document.further_places() else {
        return Vec::new();
    };
    let recipe = work.document.wanted_mapping();
    let further = work.document.mapping.further.iter();
    let further = further.map(|further| further.loaded.to_arc());
    let input = MapInput {
        parts: both.map(|part| part.loaded.to_arc()),
        recipe,
        pose: (
            *work.document.crash_from_stamped(),
            work.document.pose_origin(),
        ),
        further: further.zip(poses).collect(),
    };
    vec![work.start(JobKind::Map(input))]
}

fn compare_with(work: &mut Work<'_>, file: PathBuf) -> Option<Effect> {
    let run = work.document.current_mapping()?.run.to_arc();
    let crash = work.document.part(Role::Crash)?.loaded.to_arc();
    let input = CompareMappingInput { run, crash, file };
    Some(work.start(JobKind::CompareMapping(input)))
}

fn end_comparison(work: &mut Work<'_>) {
    work.commit("End the comparison", |document| {
        document.mapping.compare_with = None;
        if let Some(result) = &mut document.mapping.result {
            let mut record = MapRecord::clone(&result.record);
            record.comparison = None;
            result.record = Arc::new(record).into();
            result.other = None;
        }
    });
}

/// Names of files without their folders.
pub fn file_names(paths: &[String]) -> String {
    let names = paths.iter().map(|path| file_name(Path::new(path)));
    names.collect::<Vec<_>>().join(", ")
}
