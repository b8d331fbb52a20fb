//! What the units of the files change.

use std::sync::Arc;

use super::PartsState;
use crate::app::work::Work;
use crate::app::{Effect, GestureId, LogStep, NoticeLevel};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::doubt_of_set_units;
use crate::role::{PerRole, Role};
use crate::text::capital;
use crate::units::Units;

impl PartsState {
    /// Says which units a file is in: one undo step, together with the factor that follows.
    pub(super) fn set_units(
        &mut self,
        work: &mut Work<'_>,
        role: Role,
        units: Option<Units>,
    ) -> Vec<Effect> {
        let Some(part) = work.document.part(role) else {
            return Vec::new();
        };
        let (path, hash) = (part.loaded.path.clone(), part.loaded.hash());
        let labelled = Arc::new(part.loaded.with_units(units));
        let file = part.loaded.file_name();
        let line = match labelled.units() {
            Some(known) => format!("{file} is in {}", known.words()),
            None => format!("the units of {file} are unknown"),
        };
        let name = match units {
            Some(units) => format!("{file} is in {}", units.label()),
            None => format!("Guess the units of {file}"),
        };
        let doubt = doubt_of_set_units(&labelled);
        let before = part.loaded.settings.units;
        let has_changed = before != units;
        let gesture = GestureId::new();
        if has_changed {
            work.commit_in(name, Some(gesture), |document| {
                if let Some(part) = document.parts.get_mut(role) {
                    part.loaded = labelled.into();
                }
            });
            work.log_step(LogStep::Units, Some(role), line, None);
            if let Some(doubt) = doubt {
                let level = NoticeLevel::Warning;
                work.log_at(level, LogStep::Units, Some(role), capital(&doubt), None);
            }
        }
        let mut effects = Vec::new();
        if let Some(hash) = hash {
            work.settings.unit_memory.set_units(&path, hash, units);
            effects.push(Effect::SaveSettings);
        }
        let follows = if role == Role::Stamped && before.is_some() && units.is_none() {
            // The factor was that of the unit which is taken back.
            self.reselect(work, role, |settings| settings.length_factor = 1.0)
        } else {
            self.settle_length_factor(work)
        };
        let is_made_again = |effect: &Effect| matches!(effect, Effect::StartJob(..));
        self.unit_gesture = Some(gesture).filter(|_| follows.iter().any(is_made_again));
        effects.extend(follows);
        effects
    }

    /// Multiplies the stamped file's lengths as its unit, where the user said it, asks for.
    pub(super) fn settle_length_factor(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        let Some(factor) = work.document.wanted_length_factor() else {
            return Vec::new();
        };
        self.reselect(work, Role::Stamped, |settings| {
            settings.length_factor = factor;
        })
    }

    /// A file that was opened before keeps the units that were set for it then.
    pub(super) fn with_remembered_units(
        &self,
        work: &Work<'_>,
        part: Arc<LoadedPart>,
    ) -> Arc<LoadedPart> {
        let memory = &work.settings.unit_memory;
        match memory.units(&part.path, part.hash()) {
            Some(units) if part.settings.units.is_none() => Arc::new(part.with_units(Some(units))),
            _ => part,
        }
    }

    /// The sizes really are different: not asked again for these two files.
    pub(super) fn dismiss_unit_hint(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        self.unit_hint_dismissed_for = Some(work.document.stamp().parts);
        let Some(PerRole { crash, stamped }) = work.document.both() else {
            return Vec::new();
        };
        let (path, hashes) = (
            stamped.loaded.path.clone(),
            (crash.loaded.hash(), stamped.loaded.hash()),
        );
        let (Some(crash), Some(stamped)) = hashes else {
            return Vec::new();
        };
        work.settings.unit_memory.set_differs(&path, stamped, crash);
        vec![Effect::SaveSettings]
    }
}
