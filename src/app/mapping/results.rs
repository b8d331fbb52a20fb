//! Takes over mappings and comparisons when their jobs end, and makes the mapping of an opened project again.

use std::sync::Arc;
use std::time::Duration;

use super::further::MappingState;
use super::{MapResult, compare_with, file_names, start};
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{AppState, Document, Effect, LogStep, NoticeLevel, Shared};
use crate::pipeline::load::{LoadedPart, same_parts_line};
use crate::pipeline::map::{
    ComparisonRecord, ElementLists, MapRecord, MapRun, OtherResult, unread_line,
};
use crate::role::Role;
use crate::text::{capital, counted, percent};

impl AppState {
    /// Makes the mapping of a project that was opened once more: same files, pose and choices give the same
    /// values, which a project does not keep.
    pub(in crate::app) fn restore_mapping(&mut self) -> Vec<Effect> {
        let stamp = self.document.stamp();
        let (mut work, topics) = self.split();
        topics.mapping.restoring = Some(stamp);
        start(&mut work)
    }

    /// What is restored belongs to the step that opened the project: neither a step of its own nor a change
    /// that is to be saved.
    pub(in crate::app) fn taking_mapping(
        &mut self,
        take: impl FnOnce(&mut Work<'_>, &MappingState) -> Vec<Effect>,
    ) -> Vec<Effect> {
        let is_restored = self.mapping.is_restoring(&self.document);
        let is_saved = is_restored && !self.is_unsaved();
        let (mut work, topics) = self.split();
        let effects = take(&mut work, topics.mapping);
        if is_saved {
            self.keep_as_saved();
        }
        effects
    }
}

impl MappingState {
    /// True if the mapping that is made, or was made last, is that of the project that was opened.
    pub(in crate::app) fn is_restoring(&self, document: &Document) -> bool {
        self.restoring == Some(document.stamp())
    }
}

/// Takes a mapping over as one undo step, and compares it with the file that mappings are compared with.
pub(in crate::app) fn take_mapped(
    work: &mut Work<'_>,
    state: &MappingState,
    (run, record, lists): (Arc<MapRun>, Arc<MapRecord>, Arc<ElementLists>),
    further: Vec<Arc<LoadedPart>>,
    took: Duration,
) -> Vec<Effect> {
    let other = work.document.mapping.compare_with.clone();
    let text = format!(
        "{} of the area of {} mapped",
        percent(record.mapped_area),
        counted(record.n_elements, "element")
    );
    // What could not be read was told when the file was, and so was one file in both places.
    let crash = work.document.part(Role::Crash).map(|part| &part.loaded);
    let parts = crash.into_iter().chain(work.document.all_stamped());
    let both = work.document.both();
    let same = both.and_then(|both| same_parts_line(both.map(|part| &*part.loaded)));
    let unread = parts.filter_map(|part| unread_line(part));
    let told: Vec<String> = unread.chain(same).collect();
    for warning in record.warnings.iter().filter(|one| !told.contains(one)) {
        work.log_at(
            NoticeLevel::Warning,
            LogStep::Map,
            None,
            capital(warning),
            None,
        );
    }
    work.log_step(LogStep::Map, None, text, Some(took));
    let stamp = work.document.stamp();
    let put = |document: &mut Document| {
        let mapping = &mut document.mapping;
        mapping.result = Some(MapResult {
            run: run.into(),
            record: record.into(),
            lists: lists.into(),
            stamp,
            further: further.into_iter().map(Shared::from).collect(),
            other: None,
        });
    };
    if state.restoring == Some(stamp) {
        put(work.document);
    } else {
        work.commit("Map forming results", put);
        work.follow(FollowUp::Mapped);
    }
    let compared = other.and_then(|file| compare_with(work, file));
    compared.into_iter().collect()
}

/// Takes another mapper's result over as one undo step.
pub(in crate::app) fn take_compared(
    work: &mut Work<'_>,
    state: &MappingState,
    run: &Arc<MapRun>,
    (other, comparison): (Arc<OtherResult>, ComparisonRecord),
    took: Duration,
) {
    let current = work.document.current_mapping();
    // Mapped anew meanwhile: the comparison that follows from it is on its way.
    if current.is_none_or(|result| !Arc::ptr_eq(&result.run.to_arc(), run)) {
        return;
    }
    let text = format!(
        "compared with {}: {} have values in both, {} only here, {} only there",
        file_names(&comparison.files),
        counted(comparison.n_both, "element"),
        counted(comparison.n_only_here, "element"),
        counted(comparison.n_only_other, "element"),
    );
    work.log_step(LogStep::Map, None, text, Some(took));
    let file = other.files.first().cloned();
    // What follows from a new mapping is undone with it.
    let mapping = &work.document.mapping;
    let is_first = mapping
        .result
        .as_ref()
        .is_some_and(|result| result.other.is_none());
    let follows_mapping = is_first && file.is_some() && file == mapping.compare_with;
    let put = |document: &mut Document| {
        document.mapping.compare_with = file;
        if let Some(result) = &mut document.mapping.result {
            let mut record = MapRecord::clone(&result.record);
            record.comparison = Some(comparison);
            result.record = Arc::new(record).into();
            result.other = Some(other.into());
        }
    };
    if follows_mapping || state.restoring == Some(work.document.stamp()) {
        put(work.document);
    } else {
        work.commit("Compare with another mapping", put);
        work.follow(FollowUp::MappingCompared);
    }
}
