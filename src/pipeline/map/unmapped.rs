//! The elements that carry no values of their own, as one set for each reason.

use super::MapRun;
use crate::formats::Model;
use crate::mapping::Status;
use crate::monitor::{Cancelled, Monitor};

/// `*SET_SHELL_LIST_TITLE` for each status but *mapped*, with ids that no set of the deck has; a deck of
/// its own. Ids stand in fields of ten, or of twenty (`LONG=Y`) where they are longer.
pub fn unmapped_sets(run: &MapRun, model: &Model, monitor: &Monitor) -> Result<String, Cancelled> {
    let ids = run
        .shells
        .iter()
        .map(|&shell| model.shells[shell as usize].id);
    let largest = ids.clone().max().unwrap_or(0);
    let first_set = 1 + model.sets.shells.keys().max().copied().unwrap_or(0);
    let is_long = largest.max(first_set + 9) > 9_999_999_999;
    let width = if is_long { 20 } else { 10 };
    let mut text = String::from(if is_long {
        "*KEYWORD LONG=Y\n"
    } else {
        "*KEYWORD\n"
    });
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
        text += &format!("*SET_SHELL_LIST_TITLE\n{}\n{set:>width$}\n", status.label());
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
