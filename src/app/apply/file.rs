//! What opening, swapping and reloading of files change.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crate::app::state::Guess;
use crate::app::{
    Action, AppState, Effect, FileCommand, NoticeLevel, Part, Section, StampedPose, facts,
};
use crate::formats::ReadOptions;
use crate::jobs::{JobKey, JobKind, PartFacts, PartSource, ProjectRequest};
use crate::pipeline::load::{LoadSettings, LoadedPart};
use crate::pipeline::project::is_project;
use crate::role::Role;

impl AppState {
    pub(super) fn apply_file(&mut self, command: FileCommand) -> Vec<Effect> {
        if self.is_unlocked().is_err() {
            return Vec::new();
        }
        match command {
            FileCommand::AskOpen(role) => vec![Effect::AskOpen(role)],
            FileCommand::Open { paths, role } => self.open(paths, role),
            FileCommand::OpenExample => self.open_example(),
            FileCommand::Reload(role) => self.reload(role),
            FileCommand::ReloadAll => Role::ALL
                .into_iter()
                .flat_map(|role| self.reload(role))
                .collect(),
            FileCommand::Close(role) => self.close(role),
            FileCommand::Swap => self.swap(),
            FileCommand::SetLengthFactor { role, factor } => self.set_length_factor(role, factor),
            FileCommand::SetUnits { role, units } => self.set_units(role, units),
            FileCommand::DismissUnitHint => self.dismiss_unit_hint(),
            FileCommand::ForgetRecent(path) => {
                self.settings.recent.retain(|known| *known != path);
                self.settings.opened.remove(&path);
                vec![Effect::SaveSettings]
            }
        }
    }

    fn open(&mut self, paths: Vec<PathBuf>, role: Option<Role>) -> Vec<Effect> {
        if let Some(path) = paths.iter().find(|path| is_project(path)) {
            return self.open_project(ProjectRequest {
                path: path.clone(),
                ..ProjectRequest::default()
            });
        }
        let n_paths = paths.len();
        if n_paths > 2 {
            let text = format!("{n_paths} files were dropped; the first two are opened");
            self.log_at(NoticeLevel::Note, "load", None, text, None);
        }
        let first = role.unwrap_or_else(|| self.role_to_fill());
        let roles = [first, first.other()];
        if role.is_none() || n_paths > 1 {
            self.guess.n_pending = n_paths.min(2);
        } else {
            self.guess = Guess::default();
        }
        let files = paths.into_iter().zip(roles);
        files
            .flat_map(|(path, role)| {
                let settings = self.usual_load_settings();
                self.load(role, PartSource::File(path), settings)
            })
            .collect()
    }

    fn usual_load_settings(&self) -> LoadSettings {
        LoadSettings {
            read: ReadOptions::default().with_limit(self.settings.read_limit),
            ..LoadSettings::default()
        }
    }

    /// The part a file without a role is first taken for.
    fn role_to_fill(&self) -> Role {
        let is_crash_there = self.document.part(Role::Crash).is_some();
        let is_stamped_there = self.document.part(Role::Stamped).is_some();
        if is_crash_there && !is_stamped_there {
            Role::Stamped
        } else {
            Role::Crash
        }
    }

    fn open_example(&mut self) -> Vec<Effect> {
        self.guess = Guess::default();
        let example = |role| (role, PartSource::Example);
        Role::ALL
            .map(example)
            .into_iter()
            .flat_map(|(role, source)| self.load(role, source, LoadSettings::default()))
            .collect()
    }

    /// A newer load of a part ends the older one.
    fn load(&mut self, role: Role, source: PartSource, settings: LoadSettings) -> Vec<Effect> {
        let mut effects = Vec::new();
        for key in [JobKey::Load(role), JobKey::Reselect(role)] {
            if self.jobs.is_active(key) {
                effects.extend(self.cancel_job(key));
            }
        }
        effects.push(self.start(JobKind::Load {
            role,
            source,
            settings,
        }));
        effects
    }

    fn reload(&mut self, role: Role) -> Vec<Effect> {
        let Some(part) = self.document.part(role) else {
            return Vec::new();
        };
        let (source, mut settings) = (part.source.clone(), part.loaded.settings.clone());
        // A file that met the limit is read again with a higher one.
        let limit = settings.read.limit().max(self.settings.read_limit);
        settings.read = settings.read.with_limit(limit);
        self.guess = Guess::default();
        self.load(role, source, settings)
    }

    fn close(&mut self, role: Role) -> Vec<Effect> {
        let name = format!("Close the {} part", role.word());
        let revision = self.next_revision();
        self.drop_previews();
        self.commit(name, |document| {
            *document.parts.get_mut(role) = None;
            document.result = None;
            document.pose = StampedPose {
                revision,
                ..StampedPose::default()
            };
        });
        Vec::new()
    }

    fn swap(&mut self) -> Vec<Effect> {
        let revision = self.next_revision();
        self.drop_previews();
        let has_swapped = self.commit("Swap the parts", |document| {
            if document.parts.crash.is_some() || document.parts.stamped.is_some() {
                document.parts.swap();
                document.result = None;
                document.pose = StampedPose {
                    revision,
                    ..StampedPose::default()
                };
            }
        });
        if has_swapped {
            self.view.cameras.swap();
            self.view.selected.clear();
            self.log_step("load", None, "crash and stamped part exchanged", None);
        }
        Vec::new()
    }

    fn set_length_factor(&mut self, role: Role, factor: f64) -> Vec<Effect> {
        self.reselect(role, |settings| settings.length_factor = factor)
    }

    /// What became of a part that took another selection, factor or unit.
    fn reselect_name(&self, role: Role, part: &LoadedPart, facts: &PartFacts) -> String {
        let old_factor = self.document.part(role).map(Part::length_factor);
        let factor = part.settings.length_factor;
        match part.settings.units {
            _ if old_factor == Some(factor) => {
                format!("Match {}", facts::counted(facts.used.len(), "part"))
            }
            Some(units) => format!("{} is in {}", part.file_name(), units.label()),
            None => format!("Lengths × {factor}"),
        }
    }

    /// Makes the surface of a part again from the model in memory.
    pub(super) fn reselect(
        &mut self,
        role: Role,
        change: impl FnOnce(&mut LoadSettings),
    ) -> Vec<Effect> {
        let Some(part) = self.document.part(role) else {
            return Vec::new();
        };
        let loaded = part.loaded.to_arc();
        let mut settings = loaded.settings.clone();
        change(&mut settings);
        if settings == loaded.settings {
            return Vec::new();
        }
        let mut effects = self.cancel_job(JobKey::Reselect(role));
        effects.push(self.start(JobKind::Reselect {
            role,
            part: loaded,
            settings,
        }));
        effects
    }

    /// A part was read: into its place with it, then the questions that follow.
    pub(super) fn take_loaded(
        &mut self,
        role: Role,
        source: PartSource,
        part: Arc<LoadedPart>,
        facts: Arc<PartFacts>,
        took: Duration,
    ) -> Vec<Effect> {
        let is_guess = self.guess.n_pending > 0;
        let role = if is_guess && self.belongs_other_side(role, &facts) {
            role.other()
        } else {
            role
        };
        self.log_step(
            "load",
            Some(role),
            facts::load_line(&part, &facts),
            Some(took),
        );
        if let Some((level, line)) = facts::diagnostics_line(&part) {
            self.log_at(level, "load", Some(role), line, None);
        }
        self.settings
            .remember(&source, self.clock.unix_at(self.now));
        let part = self.with_remembered_units(part);
        self.place(role, source, part, facts);
        if is_guess {
            self.guess.n_pending -= 1;
            if self.guess.n_pending == 0 {
                self.settle_guess();
            }
        }
        self.fit_after_load(role);
        self.go_on_from_load();
        self.refresh_likeness();
        let mut effects = vec![Effect::SaveSettings];
        effects.extend(self.settle_length_factor());
        effects
    }

    /// Two single parts need no choice, so the sections after loading come next; a deck of many
    /// parts is chosen from first.
    fn go_on_from_load(&mut self) {
        let is_single = |part: &Part| part.facts.parts.len() <= 1;
        let is_plain = |(crash, stamped): (&Part, &Part)| is_single(crash) && is_single(stamped);
        if self.document.both().is_some_and(is_plain) {
            self.view.sections.touch(Section::Match);
            self.view.sections.touch(Section::Reduce);
        }
    }

    /// A single file without a role whose content says stamped, and nothing stamped there yet.
    fn belongs_other_side(&self, role: Role, facts: &PartFacts) -> bool {
        let is_single = self.guess.n_pending == 1;
        let is_free = self.document.part(role.other()).is_none();
        is_single && is_free && role == Role::Crash && facts.formed > 0
    }

    fn place(
        &mut self,
        role: Role,
        source: PartSource,
        part: Arc<LoadedPart>,
        facts: Arc<PartFacts>,
    ) {
        let name = format!("Load {}", part.file_name());
        let (revision, pose_revision) = (self.next_revision(), self.next_revision());
        self.drop_previews();
        self.commit(name, |document| {
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
                document.pose = StampedPose {
                    revision: pose_revision,
                    ..StampedPose::default()
                };
            }
            *document.parts.get_mut(role) = Some(new);
        });
    }

    /// Both files are there: the one that looks more like the end of a forming simulation is the
    /// stamped part.
    fn settle_guess(&mut self) {
        let Some((crash, stamped)) = self.document.both() else {
            return;
        };
        if crash.facts.formed > stamped.facts.formed {
            self.swap();
        }
        self.tell_guess();
    }

    /// What was guessed, why, and the way out.
    fn tell_guess(&mut self) {
        let Some((_, stamped)) = self.document.both() else {
            return;
        };
        let why = match stamped.facts.formed {
            0 => "no file says which it is",
            1 => "it is one part with a thickness for each element",
            _ => "it carries forming results",
        };
        let text = format!(
            "{} is taken for the stamped part: {why}",
            stamped.loaded.file_name()
        );
        self.log_step("load", None, text.clone(), None);
        let is_muted = self.settings.muted.contains(&NoticeLevel::Note);
        self.notices
            .offer(NoticeLevel::Note, text, (self.now, is_muted), Action::Swap);
    }

    /// A part took another selection or unit.
    pub(super) fn take_reselected(
        &mut self,
        role: Role,
        part: Arc<LoadedPart>,
        facts: Arc<PartFacts>,
        took: Duration,
    ) -> Vec<Effect> {
        let line = facts::load_line(&part, &facts);
        let revision = self.next_revision();
        let name = self.reselect_name(role, &part, &facts);
        let gesture = self.unit_gesture.take();
        self.drop_previews();
        self.commit_in(name, gesture, |document| {
            if let Some(old) = document.parts.get_mut(role) {
                old.loaded = part.into();
                old.facts = facts.into();
                old.revision = revision;
                old.level = None;
            }
        });
        self.log_step("select", Some(role), line, Some(took));
        self.refresh_likeness();
        self.fit_after_load(role);
        self.reduce_again(role)
    }
}
