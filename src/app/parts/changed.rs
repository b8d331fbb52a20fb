//! Files that changed on disk after they were read: told, and read again on request.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::PartsState;
use crate::app::work::Work;
use crate::app::{Action, AppState, Document, NoticeLevel};
use crate::role::Role;
use crate::text::counted;

impl PartsState {
    /// True if a file of this part has another content now than was read from it.
    pub(in crate::app) fn has_changed_on_disk(&self, document: &Document, role: Role) -> bool {
        let is_changed = |file: &PathBuf| self.changed_on_disk.contains(file);
        !self.changed_on_disk.is_empty()
            && document
                .part(role)
                .is_some_and(|part| part.loaded.files().iter().any(is_changed))
    }

    /// The work goes on with what was read; whoever wants the new content is one click away from it.
    pub(super) fn tell_changed(&mut self, work: &mut Work<'_>, changed: BTreeSet<PathBuf>) {
        let before = std::mem::replace(&mut self.changed_on_disk, changed);
        for role in Role::ALL {
            let Some(part) = work.document.part(role) else {
                continue;
            };
            let is_news =
                |file: &PathBuf| self.changed_on_disk.contains(file) && !before.contains(file);
            let files: BTreeSet<PathBuf> =
                part.loaded.files().into_iter().filter(is_news).collect();
            let main = part.loaded.file_name();
            let what = match files.len() {
                0 => continue,
                _ if files.contains(&part.loaded.path) => main,
                n => format!("{main}: {}", counted(n, "included file")),
            };
            let verb = if files.len() == 1 || files.contains(&part.loaded.path) {
                "has"
            } else {
                "have"
            };
            let text = format!("{what} {verb} changed on disk; this work keeps what was read");
            work.log_step("load", Some(role), text.clone(), None);
            let showing = work.showing(NoticeLevel::Warning);
            let notices = &mut work.log.notices;
            notices.offer(NoticeLevel::Warning, text, showing, Action::ReloadChanged);
        }
        self.withdraw_offer(work);
    }

    /// These files are known in their new content.
    pub(super) fn was_read_again(&mut self, work: &mut Work<'_>, files: &[PathBuf]) {
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
    /// True if a file of this part has another content now than was read from it.
    pub fn has_changed_on_disk(&self, role: Role) -> bool {
        self.parts.has_changed_on_disk(&self.document, role)
    }
}
