//! What opening, swapping and reloading of files change.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use super::roles::{offer_swap, remember_roles, stamped_word};
use super::{FileCommand, Guess, PartsState};
use crate::app::follow_up::FollowUp;
use crate::app::mapping::further_dropped;
use crate::app::work::Work;
use crate::app::{
    Action, Effect, GestureId, LogStep, NoticeLevel, Part, Settings, StampedPose, facts,
};
use crate::formats::ReadOptions;
use crate::formats::model::FormingEvidence;
use crate::jobs::{JobKey, JobKind, PartFacts, PartSource, ProjectRequest};
use crate::pipeline::load::{LoadSettings, LoadedPart, same_parts_line, usual_selection};
use crate::pipeline::names::file_name;
use crate::pipeline::project::is_project;
use crate::role::{PerRole, Role};
use crate::text::counted;

/// A part that was read, or made again from the model in memory.
pub(in crate::app) struct NewPart {
    /// What it is taken for.
    pub role: Role,
    /// The surface that was made.
    pub part: Arc<LoadedPart>,
    /// What was counted and measured about it.
    pub facts: Arc<PartFacts>,
    /// How long it took.
    pub took: Duration,
}

impl PartsState {
    pub(in crate::app) fn apply_file(
        &mut self,
        work: &mut Work<'_>,
        command: FileCommand,
    ) -> Vec<Effect> {
        if let FileCommand::ChangedOnDisk(files) = command {
            self.tell_changed(work, files);
            return Vec::new();
        }
        if let Err(reason) = work.is_unlocked() {
            // The actions are disabled then; a file can be dropped all the same.
            if matches!(command, FileCommand::Open { .. }) {
                let text = format!("Not opened. {} Stop it first.", reason.0);
                work.notify(NoticeLevel::Note, text);
            }
            return Vec::new();
        }
        match command {
            FileCommand::AskOpen(role) => vec![Effect::AskOpen(role)],
            FileCommand::Open { paths, role } => self.open(work, paths, role),
            FileCommand::OpenExample => self.open_example(work, &PartSource::Example),
            FileCommand::OpenRealisticExample => {
                self.open_example(work, &PartSource::RealisticExample)
            }
            FileCommand::Reload(role) => self.reload(work, role),
            FileCommand::ReloadAll => {
                work.follow(FollowUp::ReadFurtherAgain(None));
                self.reload_together(work, &Role::ALL)
            }
            FileCommand::ReloadChanged => {
                let changed = Role::ALL
                    .into_iter()
                    .filter(|&role| self.has_changed_on_disk(work.document, role));
                let changed: Vec<Role> = changed.collect();
                let files = self.changed_on_disk.clone();
                work.follow(FollowUp::ReadFurtherAgain(Some(files)));
                self.reload_together(work, &changed)
            }
            FileCommand::ChangedOnDisk(_) => Vec::new(),
            FileCommand::Close(role) => self.close(work, role),
            // What is being read comes under the role that it has now.
            FileCommand::Swap if work.jobs.are_parts_read().is_err() => Vec::new(),
            FileCommand::Swap => self.swap(work),
            FileCommand::SetLengthFactor { role, factor } => {
                self.set_length_factor(work, role, factor)
            }
            FileCommand::SetUnits { role, units } => self.set_units(work, role, units),
            FileCommand::DismissUnitHint => self.dismiss_unit_hint(work),
            FileCommand::ForgetRecent(path) => {
                work.settings.recent.retain(|known| *known != path);
                work.settings.opened.remove(&path);
                work.settings.opened_as.remove(&path);
                vec![Effect::SaveSettings]
            }
        }
    }

    fn open(
        &mut self,
        work: &mut Work<'_>,
        paths: Vec<PathBuf>,
        role: Option<Role>,
    ) -> Vec<Effect> {
        if let Some(path) = paths.iter().find(|path| is_project(path)) {
            work.follow(FollowUp::OpenProject(ProjectRequest {
                path: path.clone(),
                ..ProjectRequest::default()
            }));
            return Vec::new();
        }
        let n_paths = paths.len();
        if n_paths > 2 {
            let left: Vec<String> = paths[2..].iter().map(|path| file_name(path)).collect();
            let text = format!(
                "{} were dropped; the first two are opened, not {}: further stamped files go into the \
                 list of section 4",
                counted(n_paths, "file"),
                left.join(", ")
            );
            work.log_at(NoticeLevel::Note, LogStep::Load, None, text, None);
        }
        let first = role.unwrap_or_else(|| self.role_to_fill(work));
        let roles = [first, first.other()];
        if role.is_none() || n_paths > 1 {
            self.guess.n_pending = n_paths.min(2);
        } else {
            self.guess = Guess::default();
        }
        let files = paths.into_iter().zip(roles);
        files
            .flat_map(|(path, role)| {
                self.load(
                    work,
                    role,
                    PartSource::File(path),
                    usual_load_settings(work.settings),
                )
            })
            .collect()
    }

    /// The part a file without a role is first taken for.
    fn role_to_fill(&self, work: &Work<'_>) -> Role {
        let is_crash_there = work.document.part(Role::Crash).is_some();
        let is_stamped_there = work.document.part(Role::Stamped).is_some();
        if is_crash_there && !is_stamped_there {
            Role::Stamped
        } else {
            Role::Crash
        }
    }

    fn open_example(&mut self, work: &mut Work<'_>, source: &PartSource) -> Vec<Effect> {
        self.guess = Guess::default();
        let load = |role| self.load(work, role, source.clone(), LoadSettings::default());
        let effects = Role::ALL.into_iter().flat_map(load).collect();
        self.together_gesture = Some(GestureId::new());
        effects
    }

    /// A newer load of a part ends the older one.
    fn load(
        &mut self,
        work: &mut Work<'_>,
        role: Role,
        source: PartSource,
        settings: LoadSettings,
    ) -> Vec<Effect> {
        self.together_gesture = None;
        let mut effects = Vec::new();
        for key in [JobKey::Load(role), JobKey::Reselect(role)] {
            if work.jobs.is_active(key) {
                effects.extend(work.cancel(key));
            }
        }
        effects.push(work.start(JobKind::Load {
            role,
            source,
            settings,
        }));
        effects
    }

    fn reload(&mut self, work: &mut Work<'_>, role: Role) -> Vec<Effect> {
        let Some(part) = work.document.part(role) else {
            return Vec::new();
        };
        let (source, mut settings) = (part.source.clone(), part.loaded.settings.clone());
        // A file that met the limit is read again with a higher one.
        let limit = settings.read.limit().max(work.settings.read_limit);
        settings.read = settings.read.with_limit(limit);
        self.guess = Guess::default();
        self.load(work, role, source, settings)
    }

    /// Reads files again as one undo step.
    fn reload_together(&mut self, work: &mut Work<'_>, roles: &[Role]) -> Vec<Effect> {
        let roles = roles.iter();
        let effects = roles.flat_map(|&role| self.reload(work, role)).collect();
        self.together_gesture = Some(GestureId::new());
        effects
    }

    fn close(&mut self, work: &mut Work<'_>, role: Role) -> Vec<Effect> {
        let name = format!("Close the {} part", role.word());
        withdraw_diagnostics(work, role);
        let revision = work.history.next_revision();
        work.previews.drop_all();
        let mut n_dropped = None;
        work.commit(name, |document| {
            *document.parts.get_mut(role) = None;
            document.result = None;
            document.end_remedies();
            if role == Role::Crash {
                n_dropped = Some(document.drop_for_crash());
            } else {
                document.mapping.result = None;
            }
            document.pose = StampedPose {
                revision,
                ..StampedPose::default()
            };
        });
        self.forget_missing(work.document);
        further_dropped(work, n_dropped);
        work.follow(FollowUp::PartClosed);
        let of_part = [
            JobKey::Load(role),
            JobKey::Reselect(role),
            JobKey::Reduce(role),
        ];
        of_part
            .into_iter()
            .flat_map(|key| work.cancel(key))
            .collect()
    }

    fn swap(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        work.log.notices.withdraw(Action::Swap);
        self.exchange(work);
        self.leave_tools_out(work)
    }

    fn exchange(&mut self, work: &mut Work<'_>) {
        let revision = work.history.next_revision();
        work.previews.drop_all();
        let mut n_dropped = None;
        let has_swapped = work.commit("Swap the parts", |document| {
            if document.parts.crash.is_some() || document.parts.stamped.is_some() {
                document.parts.swap();
                document.result = None;
                n_dropped = Some(document.drop_for_crash());
                document.pose = StampedPose {
                    revision,
                    ..StampedPose::default()
                };
            }
        });
        if has_swapped {
            self.selected.clear();
            work.follow(FollowUp::PartsSwapped);
            work.log_step(LogStep::Load, None, "crash and stamped part swapped", None);
            remember_roles(work);
            further_dropped(work, n_dropped);
        }
    }

    /// Once it is known which file is the stamped one: of a forming deck the sheet is matched, not die, punch
    /// and binder. What was left out is taken in again where the file turns out to be the crash model.
    fn leave_tools_out(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        let mut effects = Vec::new();
        for role in Role::ALL {
            let other = usual_selection(role.other());
            let of_other = |part: &Part| {
                part.loaded.settings.selection == other && !part.facts.tools.is_empty()
            };
            if work.document.part(role).is_some_and(of_other) {
                let usual = usual_selection(role);
                // Another unit that is asked for at the same time is of the same step.
                let factor = work.document.wanted_length_factor();
                let factor = factor.filter(|_| role == Role::Stamped);
                effects.extend(self.reselect(work, role, |settings| {
                    settings.selection = usual;
                    settings.length_factor = factor.unwrap_or(settings.length_factor);
                }));
            }
        }
        effects
    }

    fn set_length_factor(&mut self, work: &mut Work<'_>, role: Role, factor: f64) -> Vec<Effect> {
        self.reselect(work, role, |settings| settings.length_factor = factor)
    }

    /// Makes the surface of a part again from the model in memory, with what is changed beside what was chosen
    /// before and is not made yet.
    pub(super) fn reselect(
        &mut self,
        work: &mut Work<'_>,
        role: Role,
        change: impl FnOnce(&mut LoadSettings),
    ) -> Vec<Effect> {
        let Some(part) = work.document.part(role) else {
            return Vec::new();
        };
        let (revision, loaded) = (part.revision, part.loaded.to_arc());
        let pending = self.pending(work.document, work.jobs, role);
        let before = pending.unwrap_or(&loaded.settings);
        let mut settings = before.clone();
        change(&mut settings);
        if settings == *before {
            return Vec::new();
        }
        let mut effects = work.cancel(JobKey::Reselect(role));
        let is_as_loaded = LoadSettings {
            units: loaded.settings.units,
            ..settings.clone()
        } == loaded.settings;
        *self.pending.get_mut(role) = (!is_as_loaded).then(|| (revision, settings.clone()));
        if is_as_loaded {
            return effects;
        }
        effects.push(work.start(JobKind::Reselect {
            role,
            part: loaded,
            settings,
        }));
        effects
    }

    /// A part was read: into its place with it, then the questions that follow.
    pub(in crate::app) fn take_loaded(
        &mut self,
        work: &mut Work<'_>,
        source: PartSource,
        new: NewPart,
    ) -> Vec<Effect> {
        let NewPart {
            role,
            part,
            facts,
            took,
        } = new;
        let is_guess = self.guess.n_pending > 0;
        let role = if is_guess && self.belongs_other_side(work, role, &facts) {
            role.other()
        } else {
            role
        };
        work.log_step(
            LogStep::Load,
            Some(role),
            facts::load_line(&part, &facts),
            Some(took),
        );
        withdraw_diagnostics(work, role);
        if let Some((level, line)) = facts::diagnostics_line(&part) {
            work.log_at(level, LogStep::Load, Some(role), line, None);
        }
        let now = work.unix_now();
        work.settings.remember(&source, now);
        let part = self.with_remembered_units(work, part);
        let before = work.document.part(role);
        let before = before.filter(|before| before.source == source);
        let (is_again, lay) = (before.is_some(), before.map(Part::bounds));
        self.place(work, role, source, part, facts);
        let is_in_place = is_again && work.document.part(role).map(Part::bounds) == lay;
        if is_guess {
            self.guess.n_pending -= 1;
            if self.guess.n_pending == 0 {
                self.settle_guess(work);
            }
        }
        remember_roles(work);
        work.follow(FollowUp::PartLoaded { role, is_in_place });
        self.refresh_likeness(work.document);
        let mut effects = vec![Effect::SaveSettings];
        effects.extend(self.settle_length_factor(work));
        if self.guess.n_pending == 0 && !is_again {
            warn_of_same_parts(work);
            effects.extend(self.leave_tools_out(work));
            if !is_guess {
                offer_swap(work);
            }
        }
        effects
    }

    /// A single file without a role whose content says stamped, and nothing stamped there yet, or both
    /// parts, of which it takes the place of the one it is like.
    fn belongs_other_side(&self, work: &Work<'_>, role: Role, facts: &PartFacts) -> bool {
        let is_single = self.guess.n_pending == 1;
        let is_free = work.document.part(role.other()).is_none();
        let may_replace = is_free || work.document.part(role).is_some();
        is_single && may_replace && role == Role::Crash && facts.formed > FormingEvidence::None
    }

    fn place(
        &mut self,
        work: &mut Work<'_>,
        role: Role,
        source: PartSource,
        part: Arc<LoadedPart>,
        facts: Arc<PartFacts>,
    ) {
        let file = part.file_name();
        self.was_read_again(work, &part.files());
        let (revision, pose_revision) =
            (work.history.next_revision(), work.history.next_revision());
        work.previews.drop_all();
        let mut n_dropped = None;
        let had_result = work.document.result.is_some();
        let old = work.document.part(role);
        let is_again = old.is_some_and(|old| old.source == source);
        if !is_again {
            // Another deck may have a part of the same number.
            self.selected.retain(|part| part.role != role);
        }
        let gesture = self.together_gesture;
        let name = match gesture.filter(|gesture| work.history.is_open(*gesture)) {
            Some(_) if is_again => "Load both files again".to_owned(),
            Some(_) => "Load both files".to_owned(),
            None => format!("Load {file}"),
        };
        work.commit_in(name, gesture, |document| {
            let old = document.parts.get_mut(role);
            let same = old.take().filter(|old| old.source == source);
            let mut new = Part::new(part, facts, source, revision);
            if let Some(same) = same {
                // The same file again: what the user chose about it stays, results go stale.
                new.hidden = same.hidden;
                new.colors = same.colors;
                new.wanted_level = same.wanted_level;
            } else {
                document.result = None;
                document.end_remedies();
                document.pose = StampedPose {
                    revision: pose_revision,
                    ..StampedPose::default()
                };
                // Further stamped files stand for the crash part that they were added to.
                if role == Role::Crash {
                    n_dropped = Some(document.drop_for_crash());
                } else {
                    document.mapping.result = None;
                    if let Some(crash) = &mut document.parts.crash
                        && !crash.loaded.settings.alike_parts.is_empty()
                    {
                        // They fit the stamped part before.
                        crash.loaded = Arc::new(crash.loaded.without_alike_parts()).into();
                    }
                }
            }
            *document.parts.get_mut(role) = Some(new);
        });
        self.forget_missing(work.document);
        further_dropped(work, n_dropped);
        if had_result && work.document.result.is_none() {
            let text =
                format!("{file} discarded the result of the match before it; undo brings it back");
            work.log_step(LogStep::Load, Some(role), text.clone(), None);
            let showing = work.showing(NoticeLevel::Note);
            let notices = &mut work.log.notices;
            notices.offer(NoticeLevel::Note, text, showing, &[Action::Undo]);
        }
    }

    /// Both files are there: the one that looks more like the end of a forming simulation is the
    /// stamped part.
    fn settle_guess(&mut self, work: &mut Work<'_>) {
        let Some(PerRole { crash, stamped }) = work.document.both() else {
            return;
        };
        let is_by_name = crash.facts.formed == stamped.facts.formed
            && stamped_word(crash) > stamped_word(stamped);
        if crash.facts.formed > stamped.facts.formed || is_by_name {
            self.exchange(work);
        }
        self.tell_guess(work, is_by_name);
    }

    /// What was guessed, why, and the way out.
    fn tell_guess(&mut self, work: &mut Work<'_>, is_by_name: bool) {
        let Some(PerRole { stamped, .. }) = work.document.both() else {
            return;
        };
        let why = match stamped.facts.formed {
            _ if is_by_name => "its name says so",
            FormingEvidence::None => "no file says which it is",
            FormingEvidence::ThicknessPerElement => {
                "it is one part with a thickness for each element"
            }
            FormingEvidence::Results => "it carries forming results",
        };
        let text = format!(
            "{} is taken for the stamped part: {why}",
            stamped.loaded.file_name()
        );
        work.log_step(LogStep::Load, None, text.clone(), None);
        let showing = work.showing(NoticeLevel::Note);
        work.log
            .notices
            .offer(NoticeLevel::Note, text, showing, &[Action::Swap]);
    }
}

/// How a file is read that was not read before.
fn usual_load_settings(settings: &Settings) -> LoadSettings {
    LoadSettings {
        read: ReadOptions::default().with_limit(settings.read_limit),
        ..LoadSettings::default()
    }
}

/// Says that one file was opened as both parts.
fn warn_of_same_parts(work: &mut Work<'_>) {
    let both = work.document.both();
    let line = both.and_then(|both| same_parts_line(both.map(|part| &*part.loaded)));
    if let Some(line) = line {
        work.log_at(NoticeLevel::Warning, LogStep::Load, None, line, None);
    }
}

/// A file is gone or read anew: what was said of its content goes with it.
fn withdraw_diagnostics(work: &mut Work<'_>, role: Role) {
    let part = work.document.part(role);
    if let Some((_, line)) = part.and_then(|part| facts::diagnostics_line(&part.loaded)) {
        work.log.notices.withdraw_text(&line);
    }
}
