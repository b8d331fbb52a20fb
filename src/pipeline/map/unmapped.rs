//! The elements that are not wholly mapped, as one set for each status.

use super::MapRun;
use crate::formats::Model;
use crate::formats::keyword::card::Layout;
use crate::formats::keyword::write::keyword_line;
use crate::mapping::Status;
use crate::monitor::{Cancelled, Monitor};

/// `*SET_SHELL_LIST_TITLE` for each status but *mapped*, with ids that no set of the deck has; a deck of
/// its own in the crash deck's format, or a long one (`LONG=Y`) where ids have more than ten digits. Each title says
/// whether the elements carry values all the same.
pub fn unmapped_sets(run: &MapRun, model: &Model, monitor: &Monitor) -> Result<String, Cancelled> {
    let ids = run
        .shells
        .iter()
        .map(|&shell| model.shells[shell as usize].id);
    let largest = ids.clone().max().unwrap_or(0);
    let first_set = 1 + model.sets.shells.keys().max().copied().unwrap_or(0);
    let layout = if largest.max(first_set + 9) > 9_999_999_999 {
        Layout::Long
    } else {
        model.layout
    };
    let width = layout.width(10);
    let mut text = keyword_line(layout).to_owned();
    let mut set = first_set;
    for status in Status::ALL.into_iter().filter(|s| *s != Status::Mapped) {
        monitor.check()?;
        let reports = run.mapped.elements.iter().zip(ids.clone());
        let members: Vec<u64> = reports
            .filter(|(report, _)| report.status == status)
            .map(|(_, id)| id)
            .collect();
        if members.is_empty() {
            continue;
        }
        let values = if status.has_values() {
            "with values"
        } else {
            "no values"
        };
        let title = format!("{}: {values}", status.label());
        text += &format!("*SET_SHELL_LIST_TITLE\n{title}\n{set:>width$}\n");
        for row in members.chunks(8) {
            for id in row {
                text += &format!("{id:>width$}");
            }
            text.push('\n');
        }
        set += 1;
    }
    Ok(text + "*END\n")
}
