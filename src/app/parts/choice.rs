//! What the choice, look and visibility of parts change.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{NewPart, PartCommand, PartRef, PartsState};
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{AppState, Document, Effect, JobBoard, LogStep, NoticeLevel, Part, facts};
use crate::formats::Selection;
use crate::jobs::{JobKey, PartFacts};
use crate::pipeline::load::{LoadSettings, LoadedPart};
use crate::role::Role;
use crate::text::{counted, tidy_factor};

impl AppState {
    /// True if a part of a deck is matched, or will be as soon as what was chosen is made.
    pub fn is_part_used(&self, part: PartRef) -> bool {
        self.parts.is_used(&self.document, &self.jobs, part)
    }

    /// True if no other part of its deck is matched, so that this one has to be. O(parts).
    pub fn is_only_part_used(&self, part: PartRef) -> bool {
        let rows = self.document.part(part.role).into_iter();
        let mut others = rows
            .flat_map(|loaded| &loaded.facts.parts)
            .filter(|row| row.id != part.id);
        self.is_part_used(part)
            && !others.any(|row| self.is_part_used(PartRef { id: row.id, ..part }))
    }
}

impl PartsState {
    /// What a part is being made again with.
    pub(super) fn pending(
        &self,
        document: &Document,
        jobs: &JobBoard,
        role: Role,
    ) -> Option<&LoadSettings> {
        let (of, settings) = self.pending.get(role).as_ref()?;
        let is_current = document.part(role)?.revision == *of;
        (is_current && jobs.is_active(JobKey::Reselect(role))).then_some(settings)
    }

    /// [`AppState::is_part_used`].
    fn is_used(&self, document: &Document, jobs: &JobBoard, part: PartRef) -> bool {
        let Some(of) = document.part(part.role) else {
            return false;
        };
        let pending = self.pending(document, jobs, part.role);
        let selection = pending.map(|settings| &settings.selection);
        match selection.filter(|selection| **selection != of.loaded.settings.selection) {
            Some(Selection::Parts(ids)) => ids.contains(&part.id),
            Some(Selection::All) => true,
            Some(Selection::Sheet) => !of.facts.tools.contains(&part.id),
            _ => of.is_used(part.id),
        }
    }

    pub(in crate::app) fn apply_part(
        &mut self,
        work: &mut Work<'_>,
        command: PartCommand,
    ) -> Vec<Effect> {
        match command {
            PartCommand::Select(part) => {
                let known = part.filter(|part| work.document.knows_part(*part));
                self.selected = known.into_iter().collect();
            }
            PartCommand::ToggleSelected(part) => {
                if !self.selected.remove(&part) && work.document.knows_part(part) {
                    self.selected.insert(part);
                }
            }
            PartCommand::Hover(part) => self.hovered = part,
            PartCommand::SetVisible(part, is_visible) => self.set_visible(work, part, is_visible),
            PartCommand::ShowOnly(part) => self.show_only(work, part),
            PartCommand::HideSelected => self.hide_selected(work),
            PartCommand::ShowOnlySelected => self.show_only_selected(work),
            PartCommand::ShowAll => self.show_all(work),
            PartCommand::SetColor(part, color) => self.set_color(work, part, color),
            PartCommand::OrderLike(to) => self.order_like(work.document, to),
            PartCommand::SetUsed(part, is_used) => return self.set_used(work, part, is_used),
            PartCommand::UseOnly(part) => {
                return self.use_parts(work, part.role, Selection::Parts(vec![part.id]));
            }
            PartCommand::UseAlike(place) => {
                let more = self.more_alike.as_ref();
                let more = more.and_then(|more| more.current(work.document));
                if let Some(ids) = more.and_then(|more| more.choices.get(place)) {
                    let selection = Selection::Parts(ids.clone());
                    return self.use_parts(work, Role::Crash, selection);
                }
            }
            PartCommand::MatchOnly(part) => return self.match_only(work, part),
            PartCommand::UseAll(role) => {
                return self.use_all(work, role);
            }
        }
        Vec::new()
    }

    fn change_part(
        &mut self,
        work: &mut Work<'_>,
        name: String,
        role: Role,
        change: impl FnOnce(&mut Part),
    ) {
        work.commit(name, |document| {
            if let Some(part) = document.parts.get_mut(role) {
                change(part);
            }
        });
    }

    fn set_visible(&mut self, work: &mut Work<'_>, part: PartRef, is_visible: bool) {
        if !work.document.knows_part(part) {
            return;
        }
        let verb = if is_visible { "Show" } else { "Hide" };
        let name = format!("{verb} {}", work.document.part_title(part));
        self.change_part(work, name, part.role, |p| {
            if is_visible {
                p.hidden.remove(&part.id);
            } else {
                p.hidden.insert(part.id);
            }
        });
    }

    fn show_only(&mut self, work: &mut Work<'_>, part: PartRef) {
        if !work.document.knows_part(part) {
            return;
        }
        let name = format!("Show only {}", work.document.part_title(part));
        self.change_part(work, name, part.role, |p| {
            let others = p.facts.parts.iter().map(|row| row.id);
            p.hidden = others.filter(|id| *id != part.id).collect();
        });
    }

    fn hide_selected(&mut self, work: &mut Work<'_>) {
        let selected = self.selected.clone();
        let name = format!("Hide {}", self.selection_name(work));
        work.commit(name, |document| {
            for at in selected {
                if let Some(part) = document.parts.get_mut(at.role) {
                    part.hidden.insert(at.id);
                }
            }
        });
    }

    /// Models of which nothing is selected stay as they are.
    fn show_only_selected(&mut self, work: &mut Work<'_>) {
        let selected = self.selected.clone();
        let name = format!("Show only {}", self.selection_name(work));
        work.commit(name, |document| {
            for role in Role::ALL {
                let is_kept = |id| selected.contains(&PartRef { role, id });
                let part = document.parts.get_mut(role).as_mut();
                let has_some = selected.iter().any(|at| at.role == role);
                if let Some(part) = part.filter(|_| has_some) {
                    let all = part.facts.parts.iter().map(|row| row.id);
                    part.hidden = all.filter(|id| !is_kept(*id)).collect();
                }
            }
        });
    }

    /// What is selected, for the names of steps.
    fn selection_name(&self, work: &Work<'_>) -> String {
        let mut selected = self.selected.iter();
        match (selected.next(), selected.next()) {
            (Some(part), None) => work.document.part_title(*part),
            _ => counted(self.selected.len(), "part"),
        }
    }

    fn show_all(&mut self, work: &mut Work<'_>) {
        work.commit("Show all", |document| {
            for role in Role::ALL {
                if let Some(part) = document.parts.get_mut(role) {
                    part.hidden.clear();
                }
            }
        });
    }

    fn set_color(&mut self, work: &mut Work<'_>, part: PartRef, color: Option<[u8; 3]>) {
        if !work.document.knows_part(part) {
            return;
        }
        let name = format!("Colour of {}", work.document.part_title(part));
        self.change_part(work, name, part.role, |p| {
            match color {
                Some(color) => p.colors.insert(part.id, color),
                None => p.colors.remove(&part.id),
            };
        });
    }

    fn set_used(&mut self, work: &mut Work<'_>, part: PartRef, is_used: bool) -> Vec<Effect> {
        let Some(loaded) = work.document.part(part.role) else {
            return Vec::new();
        };
        let ids = loaded.facts.parts.iter().map(|row| row.id);
        let role = part.role;
        let is_used_now =
            |id: &u64| self.is_used(work.document, work.jobs, PartRef { role, id: *id });
        let mut used: BTreeSet<u64> = ids.filter(is_used_now).collect();
        let has_changed = if is_used {
            used.insert(part.id)
        } else {
            used.remove(&part.id)
        };
        if !has_changed || used.is_empty() {
            return Vec::new();
        }
        self.use_parts(
            work,
            part.role,
            Selection::Parts(used.into_iter().collect()),
        )
    }

    fn use_parts(&mut self, work: &mut Work<'_>, role: Role, selection: Selection) -> Vec<Effect> {
        if work.is_unlocked().is_err() {
            return Vec::new();
        }
        self.choice_ended();
        self.reselect(work, role, |settings| settings.choose(selection))
    }

    /// That all crash parts are meant is said with the choice, or by itself where all are chosen already.
    fn use_all(&mut self, work: &mut Work<'_>, role: Role) -> Vec<Effect> {
        if work.is_unlocked().is_err() {
            return Vec::new();
        }
        let effects = self.use_parts(work, role, Selection::All);
        if role == Role::Crash && work.jobs.is_active(JobKey::Reselect(role)) {
            self.are_all_meant_when_chosen = true;
        } else if role == Role::Crash {
            work.commit("Match all crash parts as one", Document::mean_all);
        }
        effects
    }

    /// The match follows when the surface of the part is made.
    fn match_only(&mut self, work: &mut Work<'_>, part: PartRef) -> Vec<Effect> {
        if work.is_unlocked().is_err() {
            return Vec::new();
        }
        let effects = self.use_parts(work, part.role, Selection::Parts(vec![part.id]));
        if work.jobs.is_active(JobKey::Reselect(part.role)) {
            self.match_when_chosen = Some(part);
        } else if work.document.is_only_used(part) {
            work.follow(FollowUp::PartChosen);
        }
        effects
    }

    /// A part took another selection or unit, as the user asked.
    pub(in crate::app) fn take_chosen(&mut self, work: &mut Work<'_>, new: NewPart) {
        let old = work.document.part(new.role);
        let is_other = old.is_some_and(|old| old.facts.used != new.facts.used);
        self.take_reselected(work, new, is_other);
    }

    /// A part took another selection or unit; remedies end where it is another pair for the user.
    pub(in crate::app) fn take_reselected(
        &mut self,
        work: &mut Work<'_>,
        new: NewPart,
        is_other_pair: bool,
    ) {
        let NewPart {
            role,
            part,
            facts,
            took,
        } = new;
        // Another unit may have been set meanwhile.
        let old = work.document.part(role);
        let units = old.map(|old| old.loaded.settings.units);
        let part = match units {
            Some(units) if units != part.settings.units => Arc::new(part.with_units(units)),
            _ => part,
        };
        let line = facts::load_line(&part, &facts);
        let tools = part.tools_line();
        let revision = work.history.next_revision();
        let name = self.reselect_name(work, role, &part, &facts);
        let gesture = self.unit_gesture.take();
        let is_crash = role == Role::Crash;
        let are_now_meant = is_crash && std::mem::take(&mut self.are_all_meant_when_chosen);
        let are_all_meant = are_now_meant || work.document.are_all_meant();
        work.previews.drop_all();
        work.commit_in(name, gesture, |document| {
            if is_other_pair {
                document.end_remedies();
            }
            if let Some(old) = document.parts.get_mut(role) {
                old.loaded = part.into();
                old.facts = facts.into();
                old.revision = revision;
                old.level = None;
            }
            if are_all_meant {
                document.mean_all();
            }
        });
        self.forget_missing(work.document);
        work.log_step(LogStep::Select, Some(role), line, Some(took));
        if let Some(line) = tools {
            work.log_at(NoticeLevel::Note, LogStep::Select, Some(role), line, None);
        }
        self.refresh_likeness(work.document);
        work.follow(FollowUp::PartReselected(role));
        let chosen = self.match_when_chosen.take();
        let is_made = |part: &PartRef| part.role == role && work.document.is_only_used(*part);
        if chosen.as_ref().is_some_and(is_made) {
            work.follow(FollowUp::PartChosen);
        }
    }

    /// What became of a part that took another selection, factor or unit.
    fn reselect_name(
        &self,
        work: &Work<'_>,
        role: Role,
        part: &LoadedPart,
        facts: &PartFacts,
    ) -> String {
        let old_factor = work.document.part(role).map(Part::length_factor);
        let factor = part.settings.length_factor;
        match part.settings.units {
            _ if old_factor == Some(factor) => uses(facts),
            Some(units) => format!("{} is in {}", part.file_name(), units.label()),
            None => format!("Lengths × {}", tidy_factor(factor)),
        }
    }
}

/// "Use only 2000012", "Use 3 parts".
fn uses(facts: &PartFacts) -> String {
    let mut used = facts.used.iter();
    match (used.next(), used.next()) {
        (Some(id), None) => format!("Use only {id}"),
        _ => format!("Use {}", facts::counted(facts.used.len(), "part")),
    }
}
