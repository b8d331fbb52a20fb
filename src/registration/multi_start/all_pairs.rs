//! What a run that chose its pairs leaves out, and where all of them lead.

use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::icp::{PairSelection, Run, StageInput, StageRules, advance};
use crate::registration::observer::MatchMonitor;

/// A run that kept this share of the pairs left out nothing that matters.
const ALL_KEPT: f64 = 0.99;

/// True if a run that was free to choose left out more pairs than trims do.
pub(super) fn left_pairs_out(run: &Run, rules: &StageRules) -> bool {
    let chooses = matches!(
        rules.selection.selection,
        PairSelection::Fractional { .. } | PairSelection::TrimmedSearch
    );
    chooses && run.fraction < ALL_KEPT
}

/// Where a run goes on to with all pairs. A bent part fits best in its middle, turned or slid until the rest, which
/// is left out, lies elsewhere.
pub(super) fn with_all_pairs(
    run: &Run,
    input: &StageInput<'_>,
    monitor: &Monitor,
) -> Result<Similarity, Cancelled> {
    let mut rules = *input.rules;
    rules.selection.selection = PairSelection::All;
    rules.step.likely_motion = f64::INFINITY;
    rules.least_reach = None;
    let mut all = Run::new(run.start_idx, run.model_from_data);
    let unobserved = monitor.without_observer();
    let input = StageInput {
        rules: &rules,
        ..*input
    };
    advance(
        &mut all,
        &input,
        rules.max_iterations,
        &MatchMonitor::from(&unobserved),
    )?;
    Ok(all.model_from_data)
}
