//! Further stamped files on the same crash part: read, matched by themselves, and mapped from with the first.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use super::probe::Probed;
use super::{FurtherPose, MapResult, Placing};
use crate::app::follow_up::FollowUp;
use crate::app::parts::length_factor_of;
use crate::app::work::Work;
use crate::app::{Document, Effect, LogStep, NoticeLevel, Part, Reason, Shared, UnitHint, facts};
use crate::assess::Verdict;
use crate::geometry::Similarity;
use crate::jobs::{FurtherInput, JobKey, JobKind, PlaceInput, Stamp};
use crate::pipeline::load::{LoadSettings, LoadedPart, usual_selection};
use crate::pipeline::map::{PoseOrigin, placing_recipe, pose_warning};
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::names::{file_name, told_apart};
use crate::role::{PerRole, Role};
use crate::text::{counted, grouped};
use crate::units::Units;

/// What can be done about a further stamped file that has no pose.
pub(in crate::app) const FURTHER_WITHOUT_POSE: &str =
    "Section 4 gives the file the pose of the first one, or removes it";

/// A further stamped file on the same crash part.
#[derive(Debug, Clone, PartialEq)]
pub struct Further {
    /// What was read.
    pub loaded: Shared<LoadedPart>,
    /// Never given twice; another one when the file is read again.
    pub revision: u64,
    /// Where its pose comes from.
    pub pose: FurtherPose,
    /// Its last match.
    pub placing: Option<Placing>,
}

/// Further stamped files that are read and matched, and the element that is probed.
#[derive(Debug, Clone, Default)]
pub struct MappingState {
    /// Files that are being read, by the number they are to have.
    pub(super) reading: BTreeMap<u64, PathBuf>,
    /// Files that could not be read, with the reason.
    pub(super) unread: BTreeMap<u64, (PathBuf, String)>,
    /// The match that was asked for.
    pub(super) placing: Option<Task>,
    /// The state of a project that was opened, whose mapping is made again; until another one is asked for.
    pub(super) restoring: Option<Stamp>,
    /// The element that is looked at closely. Looking is no step of the history.
    pub(super) probed: Option<Probed>,
    /// Matches that gave no pose, with the reason where they were not given up.
    pub(super) unplaced: Vec<(Task, Option<String>)>,
}

/// A match that is to give a further stamped file its pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Task {
    /// Number of the file.
    revision: u64,
    /// Number of the crash part.
    crash_revision: u64,
    /// What its lengths are multiplied by.
    length_factor: f64,
    /// It lies as the first one, and is only to be brought into the unit of lengths.
    is_as_first: bool,
}

/// A further stamped file that was read.
pub(in crate::app) struct NewFurther {
    /// The number it is to have.
    pub revision: u64,
    /// The number of the file that it takes the place of.
    pub replaces: Option<u64>,
    /// What was read.
    pub part: Arc<LoadedPart>,
    /// How long it took.
    pub took: Duration,
}

impl Further {
    /// What its lengths are to be multiplied by: as its own unit asks for, else as those of the first file.
    fn length_factor(&self, both: PerRole<&Part>) -> f64 {
        let own = length_factor_of(&both.crash.loaded, &self.loaded);
        own.unwrap_or(both.stamped.length_factor())
    }

    /// How its size differs from the crash part's by the factor between two units, where no good pose speaks
    /// for the unit it is taken to be in.
    pub(super) fn unit_hint(&self, both: PerRole<&Part>) -> Option<UnitHint> {
        let is_good = |placing: &Placing| placing.verdict != Verdict::Poor;
        let is_open =
            self.loaded.settings.units.is_none() && !self.placing.as_ref().is_some_and(is_good);
        let hint = || UnitHint::of_parts(&both.crash.loaded, &self.loaded);
        is_open.then(hint).flatten()
    }

    /// The match that it still needs on these parts.
    pub(super) fn task(&self, both: PerRole<&Part>) -> Option<Task> {
        let length_factor = self.length_factor(both);
        let crash_revision = both.crash.revision;
        let is_placed = match self.pose {
            FurtherPose::AsFirst => true,
            FurtherPose::Matched => {
                let placing = self.placing.as_ref();
                placing.is_some_and(|placing| placing.crash_revision == crash_revision)
            }
        };
        let is_in_unit = self.loaded.settings.length_factor == length_factor;
        (!is_placed || !is_in_unit).then_some(Task {
            revision: self.revision,
            crash_revision,
            length_factor,
            is_as_first: self.pose == FurtherPose::AsFirst,
        })
    }

    /// Its own pose on these parts, `Some(None)` if it lies as the first one; `None` while it has none.
    pub(super) fn place(&self, both: PerRole<&Part>) -> Option<Option<Similarity>> {
        if self.task(both).is_some() {
            return None;
        }
        match self.pose {
            FurtherPose::AsFirst => Some(None),
            FurtherPose::Matched => {
                let own = self.placing.as_ref()?;
                Some(Some(own.crash_from_stamped))
            }
        }
    }
}

impl Document {
    /// A further stamped file by its number.
    pub fn further(&self, revision: u64) -> Option<&Further> {
        let mut all = self.mapping.further.iter();
        all.find(|further| further.revision == revision)
    }

    /// Where the further stamped files lie, in their order; the reason if one of them has no pose yet.
    pub fn further_poses(&self) -> Result<Vec<Similarity>, Reason> {
        let places = self.further_places()?.into_iter();
        Ok(places.map(|(pose, _)| pose).collect())
    }

    /// The same with where each pose comes from.
    pub(super) fn further_places(&self) -> Result<Vec<(Similarity, PoseOrigin)>, Reason> {
        let Some(both) = self.both() else {
            return Err(Reason("Load both parts first."));
        };
        let pose = |further: &Further| {
            let place = further.place(both).ok_or(Reason(
                "A stamped file has no pose yet: wait for its match, let it lie as the first one, \
                 or remove it.",
            ))?;
            let as_first = || (*self.crash_from_stamped(), self.pose_origin());
            let own = further.placing.as_ref().zip(place);
            Ok(own.map_or_else(as_first, |(placing, pose)| {
                let verdict = placing.verdict;
                (pose, PoseOrigin::Match { verdict })
            }))
        };
        self.mapping.further.iter().map(pose).collect()
    }

    /// The stamped files that are mapped from with where their poses come from, the first one first. Empty while
    /// one of them has no pose.
    pub fn mapped_poses(&self) -> Vec<(String, PoseOrigin)> {
        let Ok(further) = self.further_places() else {
            return Vec::new();
        };
        let origins = further.into_iter().map(|(_, origin)| origin);
        let origins = std::iter::once(self.pose_origin()).chain(origins);
        let names = self.all_stamped().map(|part| self.stamped_name(part));
        names.zip(origins).collect()
    }

    /// Name of a stamped file, with as much of its folder as tells it from the others.
    pub fn stamped_name(&self, part: &LoadedPart) -> String {
        told_apart(
            &part.path,
            self.all_stamped().map(|other| other.path.as_path()),
        )
    }

    /// All stamped parts that are mapped from, the first one first.
    pub fn all_stamped(&self) -> impl Iterator<Item = &Shared<LoadedPart>> {
        let first = self.part(Role::Stamped).map(|part| &part.loaded);
        let further = self.mapping.further.iter().map(|further| &further.loaded);
        first.into_iter().chain(further)
    }

    /// True if a mapping was made from the stamped files as they are now.
    pub(super) fn has_same_stamped(&self, result: &MapResult) -> bool {
        let further = &self.mapping.further;
        let mut pairs = further.iter().zip(&result.further);
        let is_same = further.len() == result.further.len()
            && pairs.all(|(further, mapped)| further.loaded.is_same_surface(mapped));
        let poses = self.further_poses();
        is_same && poses.is_ok_and(|poses| result.run.poses[1..] == poses)
    }

    /// Takes out what stands for the crash part: the mapping with what it is compared with, pins, and the further
    /// stamped files; how many these were.
    pub(in crate::app) fn drop_for_crash(&mut self) -> usize {
        let mapping = &mut self.mapping;
        (mapping.result, mapping.compare_with) = (None, None);
        mapping.pins.clear();
        std::mem::take(&mut mapping.further).len()
    }
}

impl MappingState {
    /// Asks for the match of a further stamped file, where one has no pose on the present crash part. Undo
    /// and projects need nothing more. While the crash part is still to be found, none is asked for.
    pub(in crate::app) fn keep_placing(
        &mut self,
        work: &mut Work<'_>,
        is_part_open: bool,
    ) -> Vec<Effect> {
        let mut effects = Vec::new();
        let wanted = wanted(work.document);
        self.unplaced.retain(|(task, _)| wanted.contains(task));
        if let Some(task) = self.placing {
            let is_active = work.jobs.is_active(JobKey::PlaceFurther);
            match (is_active, wanted.contains(&task)) {
                (true, true) => return effects,
                (true, false) => effects.extend(work.cancel(JobKey::PlaceFurther)),
                // It was given up, and is not begun anew by itself.
                (false, true) => self.unplaced.push((task, None)),
                (false, false) => {}
            }
            self.placing = None;
        }
        if is_part_open || work.is_unlocked().is_err() {
            return effects;
        }
        let is_open = |task: &&Task| self.unplaced.iter().all(|(given_up, _)| given_up != *task);
        if let Some(task) = wanted.iter().find(is_open) {
            effects.extend(self.place(work, *task));
        }
        effects
    }

    fn place(&mut self, work: &mut Work<'_>, task: Task) -> Option<Effect> {
        let further = work.document.further(task.revision)?;
        let crash = work.document.part(Role::Crash)?;
        let hand = work.document.recipe.settings.hand;
        let input = PlaceInput {
            revision: task.revision,
            crash_revision: task.crash_revision,
            parts: PerRole::new(crash.loaded.to_arc(), further.loaded.to_arc()),
            length_factor: task.length_factor,
            recipe: (!task.is_as_first).then(|| placing_recipe(hand)),
        };
        self.placing = Some(task);
        Some(work.start(JobKind::PlaceFurther(input)))
    }

    /// The pose belongs to the step that added the file or changed the crash part. One of a file or a crash
    /// part that is no longer there is dropped.
    pub(in crate::app) fn take_placed(
        &mut self,
        work: &mut Work<'_>,
        (revision, crash_revision): (u64, u64),
        part: Arc<LoadedPart>,
        run: Option<Arc<MatchRun>>,
        took: Duration,
    ) {
        let task = self.placing.take();
        let is_it =
            |task: &Task| (task.revision, task.crash_revision) == (revision, crash_revision);
        if !task.is_some_and(|task| is_it(&task) && wanted(work.document).contains(&task)) {
            return;
        }
        work.follow(FollowUp::FurtherPlaced);
        let placing = run.map(|run| (facts::match_level(&run), Placing::of(&run, crash_revision)));
        let (name, lengths) = (work.document.stamped_name(&part), work.lengths());
        let further = work.document.mapping.further.iter_mut();
        let mut further = further.filter(|further| further.revision == revision);
        let Some(further) = further.next() else {
            return;
        };
        let path = part.path.display().to_string();
        let warning = placing
            .as_ref()
            .and_then(|(_, placing)| pose_warning(placing.verdict, &path));
        if !Arc::ptr_eq(&further.loaded.to_arc(), &part) {
            further.loaded = part.into();
        }
        let Some((level, placing)) = placing else {
            return;
        };
        let line = format!("{name}: {}", placing.line(lengths));
        further.placing = Some(placing);
        // It was said of the pose before.
        if let Some(before) = pose_warning(Verdict::Poor, &path) {
            work.log.notices.withdraw_text(&before);
        }
        match warning {
            Some(warning) => {
                work.log.push(level, LogStep::Match, None, line, Some(took));
                work.log_at(NoticeLevel::Warning, LogStep::Match, None, warning, None);
            }
            None => work.log_at(level, LogStep::Match, None, line, Some(took)),
        }
    }

    /// A match gave no pose.
    pub(in crate::app) fn place_failed(&mut self, reason: String) {
        let failed = self.placing.take();
        self.unplaced
            .extend(failed.map(|task| (task, Some(reason))));
    }

    /// Reads a file that is not in the list yet.
    pub(super) fn add(&mut self, work: &mut Work<'_>, file: PathBuf) -> Vec<Effect> {
        let Some(both) = work.document.both() else {
            return Vec::new();
        };
        let is_known = work.document.all_stamped().any(|part| part.path == file)
            || self.reading.values().any(|known| *known == file);
        if is_known {
            let text = format!("{} is among the stamped files already", file_name(&file));
            work.log_at(
                NoticeLevel::Note,
                LogStep::Load,
                Some(Role::Stamped),
                text,
                None,
            );
            return Vec::new();
        }
        self.unread.retain(|_, (known, _)| *known != file);
        let first = &both.stamped.loaded.settings;
        let settings = LoadSettings {
            selection: usual_selection(Role::Stamped),
            units: None,
            ..first.clone()
        };
        vec![self.read(work, file, settings, None)]
    }

    /// Reads files again: all, or those that are among these.
    pub(in crate::app) fn read_again(
        &mut self,
        work: &mut Work<'_>,
        is_meant: impl Fn(&LoadedPart) -> bool,
    ) -> Vec<Effect> {
        let further = work.document.mapping.further.clone();
        let meant = further.iter().filter(|further| is_meant(&further.loaded));
        let again = |further: &Further| {
            let settings = further.loaded.settings.clone();
            let file = further.loaded.path.clone();
            self.read(work, file, settings, Some(further.revision))
        };
        meant.map(again).collect()
    }

    fn read(
        &mut self,
        work: &mut Work<'_>,
        file: PathBuf,
        mut settings: LoadSettings,
        replaces: Option<u64>,
    ) -> Effect {
        // A file that met the limit is read again with a higher one.
        let limit = settings.read.limit().max(work.settings.read_limit);
        settings.read = settings.read.with_limit(limit);
        let revision = work.history.next_revision();
        if replaces.is_none() {
            self.reading.insert(revision, file.clone());
        }
        work.start(JobKind::LoadFurther(FurtherInput {
            revision,
            replaces,
            file,
            settings,
        }))
    }

    /// A file was read: into the list, where its match follows.
    pub(in crate::app) fn take_loaded(&mut self, work: &mut Work<'_>, new: NewFurther) {
        let NewFurther {
            revision,
            replaces,
            part,
            took,
        } = new;
        self.reading.remove(&revision);
        let role = Some(Role::Stamped);
        // A file of which the user once said the unit keeps it.
        let memory = &work.settings.unit_memory;
        let part = match memory.units(&part.path, part.hash()) {
            Some(units) if replaces.is_none() => Arc::new(part.with_units(Some(units))),
            _ => part,
        };
        let name = work.document.stamped_name(&part);
        let mut line = format!("{name}: {}", counted(part.report.n_triangles, "triangle"));
        if replaces.is_none() {
            line += ", one more stamped file";
        }
        work.log_step(LogStep::Load, role, line, Some(took));
        if let Some((level, line)) = facts::diagnostics_line(&part) {
            work.log_at(level, LogStep::Load, role, line, None);
        }
        if let Some(line) = part.tools_line() {
            work.log_at(NoticeLevel::Note, LogStep::Load, role, line, None);
        }
        let step = match replaces {
            None => format!("Add {name}"),
            Some(_) => format!("Load {name}"),
        };
        work.commit(step, |document| {
            let all = &mut document.mapping.further;
            let Some(replaced) = replaces else {
                all.push(Further {
                    loaded: part.into(),
                    revision,
                    pose: FurtherPose::default(),
                    placing: None,
                });
                return;
            };
            let of_it = all.iter_mut().find(|further| further.revision == replaced);
            if let Some(further) = of_it {
                *further = Further {
                    loaded: part.into(),
                    revision,
                    pose: further.pose,
                    placing: None,
                };
            }
        });
    }

    /// A file could not be read; the list says so until it is taken out.
    pub(in crate::app) fn load_failed(&mut self, revision: u64, reason: String) {
        if let Some(file) = self.reading.remove(&revision) {
            self.unread.insert(revision, (file, reason));
        }
    }

    /// A file is no longer waited for.
    pub(in crate::app) fn load_cancelled(&mut self, revision: u64) {
        self.reading.remove(&revision);
    }

    /// The list begins anew: what is being read for it is no longer waited for, and what could not be read or
    /// matched is forgotten.
    pub(in crate::app) fn clear_list(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        self.unread.clear();
        self.unplaced.clear();
        self.restoring = None;
        let reading = std::mem::take(&mut self.reading).into_keys();
        reading
            .flat_map(|revision| work.cancel(JobKey::LoadFurther(revision)))
            .collect()
    }

    /// Takes a file out of the list, whatever has become of it.
    pub(super) fn remove(&mut self, work: &mut Work<'_>, revision: u64) -> Vec<Effect> {
        if self.reading.remove(&revision).is_some() {
            return work.cancel(JobKey::LoadFurther(revision));
        }
        if self.unread.remove(&revision).is_some() {
            return Vec::new();
        }
        let Some(further) = work.document.further(revision) else {
            return Vec::new();
        };
        let name = work.document.stamped_name(&further.loaded);
        let name = format!("Remove {name}");
        work.commit(name, |document| {
            let all = &mut document.mapping.further;
            all.retain(|further| further.revision != revision);
        });
        Vec::new()
    }

    /// Matches a file anew.
    pub(super) fn match_again(&mut self, work: &mut Work<'_>, revision: u64) {
        self.unplaced.retain(|(task, _)| task.revision != revision);
        let Some(further) = work.document.further(revision) else {
            return;
        };
        let name = work.document.stamped_name(&further.loaded);
        let name = format!("Match {name}");
        change(work, name, revision, |further| {
            further.pose = FurtherPose::Matched;
            further.placing = None;
        });
    }
}

/// Lets a file lie where this says.
pub(super) fn set_pose(work: &mut Work<'_>, revision: u64, pose: FurtherPose) {
    let Some(further) = work.document.further(revision) else {
        return;
    };
    let name = work.document.stamped_name(&further.loaded);
    let name = match pose {
        FurtherPose::Matched => format!("Match {name}"),
        FurtherPose::AsFirst => format!("Pose of {name} as the first"),
    };
    change(work, name, revision, |further| further.pose = pose);
}

/// Says which units a file is in, and what its lengths are multiplied by with it; `None`: as the first one.
pub(super) fn set_units(work: &mut Work<'_>, revision: u64, units: Option<Units>) -> Vec<Effect> {
    let Some(further) = work.document.further(revision) else {
        return Vec::new();
    };
    let loaded = further.loaded.to_arc();
    if loaded.settings.units == units {
        return Vec::new();
    }
    let name = work.document.stamped_name(&loaded);
    let step = match units {
        Some(units) => format!("{name} is in {}", units.label()),
        None => format!("{name} is in the unit of the first"),
    };
    change(work, step.clone(), revision, |further| {
        further.loaded = Arc::new(loaded.with_units(units)).into();
    });
    work.log_step(LogStep::Units, Some(Role::Stamped), step, None);
    let Some(hash) = loaded.hash() else {
        return Vec::new();
    };
    let memory = &mut work.settings.unit_memory;
    memory.set_units(&loaded.path, hash, units);
    vec![Effect::SaveSettings]
}

fn change(work: &mut Work<'_>, step: String, revision: u64, change: impl FnOnce(&mut Further)) {
    work.commit(step, |document| {
        let mut all = document.mapping.further.iter_mut();
        if let Some(further) = all.find(|further| further.revision == revision) {
            change(further);
        }
    });
}

/// The matches that are still needed, in the order of the list.
fn wanted(document: &Document) -> Vec<Task> {
    let Some(both) = document.both() else {
        return Vec::new();
    };
    let further = document.mapping.further.iter();
    further.filter_map(|further| further.task(both)).collect()
}

/// So many further stamped files went with the old crash part; `None` if it is still there. What is read for it
/// goes too.
pub(in crate::app) fn further_dropped(work: &mut Work<'_>, n: Option<usize>) {
    let Some(n) = n else {
        return;
    };
    work.follow(FollowUp::FurtherDropped);
    if n == 0 {
        return;
    }
    let text = format!(
        "{} of the old crash part {} no longer mapped from; undo brings {} back",
        match n {
            1 => "one further stamped file".to_owned(),
            n => format!("{} further stamped files", grouped(n)),
        },
        if n == 1 { "is" } else { "are" },
        if n == 1 { "it" } else { "them" },
    );
    work.log_at(NoticeLevel::Note, LogStep::Map, None, text, None);
}
