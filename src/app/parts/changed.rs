//! Files that changed on disk after they were read: reported, and read again on request.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use super::PartsState;
use crate::app::work::Work;
use crate::app::{Action, AppState, Document, LogStep, NoticeLevel};
use crate::pipeline::load::LoadedPart;
use crate::role::Role;
use crate::text::counted;

impl PartsState {
    /// True if a file of this part has another content now than was read from it.
    pub(in crate::app) fn has_changed_on_disk(&self, document: &Document, role: Role) -> bool {
        document
            .part(role)
            .is_some_and(|part| self.is_changed(&part.loaded))
    }

    fn is_changed(&self, part: &LoadedPart) -> bool {
        let is_changed = |file: &PathBuf| self.changed_on_disk.contains(file);
        !self.changed_on_disk.is_empty() && part.files().iter().any(is_changed)
    }

    /// The work goes on with what was read; whoever wants the new content is one click away from it.
    pub(super) fn tell_changed(&mut self, work: &mut Work<'_>, changed: BTreeSet<PathBuf>) {
        let before = std::mem::replace(&mut self.changed_on_disk, changed);
        let crash = work.document.part(Role::Crash);
        let crash = crash.map(|part| (Role::Crash, part.loaded.to_arc()));
        let stamped = work.document.all_stamped();
        let stamped = stamped.map(|part| (Role::Stamped, part.to_arc()));
        let parts: Vec<(Role, Arc<LoadedPart>)> = crash.into_iter().chain(stamped).collect();
        for (role, part) in parts {
            let is_news =
                |file: &PathBuf| self.changed_on_disk.contains(file) && !before.contains(file);
            let files: BTreeSet<PathBuf> = part.files().into_iter().filter(is_news).collect();
            let main = part.file_name();
            let what = match files.len() {
                0 => continue,
                _ if files.contains(&part.path) => main,
                n => format!("{main}: {}", counted(n, "included file")),
            };
            let verb = if files.len() == 1 || files.contains(&part.path) {
                "has"
            } else {
                "have"
            };
            let text = format!("{what} {verb} changed on disk; this work keeps what was read");
            work.log_step(LogStep::Load, Some(role), text.clone(), None);
            let showing = work.showing(NoticeLevel::Warning);
            let notices = &mut work.log.notices;
            notices.offer(
                NoticeLevel::Warning,
                text,
                showing,
                &[Action::ReloadChanged],
            );
        }
        self.withdraw_offer(work);
    }

    /// These files are known in their new content.
    pub(in crate::app) fn was_read_again(&mut self, work: &mut Work<'_>, files: &[PathBuf]) {
        for file in files {
            self.changed_on_disk.remove(file);
        }
        self.withdraw_offer(work);
    }

    /// Nothing is left to be read again.
    fn withdraw_offer(&self, work: &mut Work<'_>) {
        if self.changed_on_disk.is_empty() {
            work.log.notices.withdraw(Action::ReloadChanged);
        }
    }
}

impl AppState {
    /// True if a file of any part has another content now than was read from it.
    pub fn has_any_changed_on_disk(&self) -> bool {
        let document = &self.document;
        let crash = document.part(Role::Crash).map(|part| &part.loaded);
        let mut parts = crash.into_iter().chain(document.all_stamped());
        parts.any(|part| self.parts.is_changed(part))
    }

    /// True if a file of this part has another content now than was read from it.
    pub fn has_changed_on_disk(&self, role: Role) -> bool {
        self.parts.has_changed_on_disk(&self.document, role)
    }
}
