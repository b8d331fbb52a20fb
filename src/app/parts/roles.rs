//! Which file is the crash part and which the stamped part, as far as their names and contents say.

use crate::app::work::Work;
use crate::app::{Action, LogStep, NoticeLevel, Part};
use crate::formats::model::other_order;
use crate::role::{PerRole, Role};

/// Each file was opened as one of the parts. Where they speak plainly against that, the user is asked.
pub(super) fn offer_swap(work: &mut Work<'_>) {
    let Some(both) = work.document.both() else {
        return;
    };
    let PerRole { crash, stamped } = both;
    let is_by_name = crash.facts.formed >= stamped.facts.formed
        && stamped_word(crash) > 0
        && stamped_word(stamped) < 0;
    let names = both.map(|part| part.loaded.file_name());
    let text = if let Some(evidence) = other_order(&crash.loaded.model, &stamped.loaded.model) {
        format!(
            "Swapped files? {} was opened as crash part and carries {}, {} carries none",
            names.crash,
            evidence.words(),
            names.stamped
        )
    } else if is_by_name {
        format!(
            "Swapped files? {} was opened as crash part, {} as stamped part",
            names.crash, names.stamped
        )
    } else {
        return;
    };
    work.offer_at(NoticeLevel::Warning, LogStep::Load, &text, &[Action::Swap]);
}

/// How plainly a file's name says that it is the stamped part: 1, that it is the crash part: -1, else 0.
pub(super) fn stamped_word(part: &Part) -> i32 {
    let name = part.loaded.file_name().to_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| name.contains(word));
    i32::from(has(&["stamped", "stamping", "dynain", "formed"])) - i32::from(has(&["crash"]))
}

/// The list of recent files follows what the files are used as.
pub(super) fn remember_roles(work: &mut Work<'_>) {
    for role in Role::ALL {
        if let Some(part) = work.document.part(role) {
            work.settings.remember_role(&part.source, role);
        }
    }
}
