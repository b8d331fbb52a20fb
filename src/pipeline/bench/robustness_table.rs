//! The runs of a robustness measurement, counted by scenario, as a table and as JSON.

use serde::Serialize;

use super::robustness::{COVERAGE, Ending, RobustnessRun};
use crate::assess::{PoseKind, ShapeKind, Verdict};
use crate::report::build_id;
use crate::samples::scenario::Scenario;

/// Verdicts counted: GOOD, CHECK, POOR.
pub type Counts = [usize; 3];

/// One scenario, or all of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobustnessRow {
    /// What was changed.
    pub scenario: String,
    /// Number of matches.
    pub runs: usize,
    /// Verdicts of the runs that ended at the true pose.
    pub right: Counts,
    /// Of those that ended at another pose that fits as well.
    pub twins: Counts,
    /// Of those that ended at a wrong pose.
    pub wrong: Counts,
    /// Of those for which no pose is true, because the shapes differ.
    pub no_truth: Counts,
    /// Right runs whose error lies within three times the stated uncertainty, and those it is known of.
    pub covered: [usize; 2],
    /// Median and largest ratio of error and stated uncertainty of the right runs.
    pub error_ratio: Option<[f64; 2]>,
    /// Median and largest error of a node of the right runs, in millimetres.
    pub node_error: Option<[f64; 2]>,
    /// Median and largest time in milliseconds.
    pub time_ms: [f64; 2],
}

/// The whole measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobustnessTable {
    schema: &'static str,
    build: String,
    threads: usize,
    /// The seed all pairs come from.
    pub seed: u64,
    /// One row for each scenario, in their order.
    pub rows: Vec<RobustnessRow>,
    /// Sums over all scenarios.
    pub total: RobustnessRow,
    /// Every match.
    pub runs: Vec<RunRecord>,
}

/// One match as it is written to JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunRecord {
    scenario: String,
    part: &'static str,
    seed: u64,
    ending: &'static str,
    verdict: Verdict,
    reason: String,
    pose: Option<PoseKind>,
    shape: Option<ShapeKind>,
    node_error: Option<f64>,
    pose_uncertainty: Option<f64>,
    starts: usize,
    time_ms: f64,
}

impl RobustnessTable {
    /// Counts the runs.
    pub fn new(seed: u64, runs: &[RobustnessRun]) -> Self {
        let of = |scenario: Scenario| {
            let runs: Vec<&RobustnessRun> =
                runs.iter().filter(|run| run.scenario == scenario).collect();
            (!runs.is_empty()).then(|| row(scenario.name(), &runs))
        };
        Self {
            schema: "shapematch-robustness/1",
            build: build_id(),
            threads: rayon::current_num_threads(),
            seed,
            rows: Scenario::ALL.into_iter().filter_map(of).collect(),
            total: row("all".to_owned(), &runs.iter().collect::<Vec<_>>()),
            runs: runs.iter().map(record).collect(),
        }
    }
}

fn record(run: &RobustnessRun) -> RunRecord {
    RunRecord {
        scenario: run.scenario.name(),
        part: run.part.name(),
        seed: run.seed,
        ending: run.ending.name(),
        verdict: run.verdict,
        reason: run.reason.clone(),
        pose: run.pose,
        shape: run.shape,
        node_error: run.node_error,
        pose_uncertainty: run.uncertainty,
        starts: run.n_starts,
        time_ms: run.time_ms,
    }
}

fn row(scenario: String, runs: &[&RobustnessRun]) -> RobustnessRow {
    let counts = |ending: Ending| {
        let of = |verdict: Verdict| {
            let hit = |run: &&&RobustnessRun| run.ending == ending && run.verdict == verdict;
            runs.iter().filter(hit).count()
        };
        [Verdict::Good, Verdict::Check, Verdict::Poor].map(of)
    };
    let right = || runs.iter().filter(|run| run.ending == Ending::Right);
    let covered: Vec<bool> = right().filter_map(|run| run.is_covered()).collect();
    let ratios = right().filter_map(|run| {
        let error = (run.node_error? - run.hidden_offset).max(0.0);
        Some(error / run.uncertainty?.max(1e-9))
    });
    let errors = right().filter_map(|run| run.node_error);
    let times = runs.iter().map(|run| run.time_ms);
    RobustnessRow {
        scenario,
        runs: runs.len(),
        right: counts(Ending::Right),
        twins: counts(Ending::Twin),
        wrong: counts(Ending::Wrong),
        no_truth: counts(Ending::NoTruth),
        covered: [covered.iter().filter(|c| **c).count(), covered.len()],
        error_ratio: median_and_largest(ratios),
        node_error: median_and_largest(errors),
        time_ms: median_and_largest(times).unwrap_or_default(),
    }
}

fn median_and_largest(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    Some([*values.get(values.len() / 2)?, *values.last()?])
}

/// "3/1/0", or a dash where there is nothing.
pub fn slashed(counts: Counts) -> String {
    let [good, check, poor] = counts;
    if good + check + poor == 0 {
        return "-".to_owned();
    }
    format!("{good}/{check}/{poor}")
}

impl RobustnessRow {
    /// The cells of the row as text, in the order of [`COLUMNS`].
    pub fn cells(&self) -> Vec<String> {
        let pair = |values: Option<[f64; 2]>| {
            let text = |[a, b]: [f64; 2]| format!("{a:.2} / {b:.2}");
            values.map_or_else(|| "-".to_owned(), text)
        };
        let n_right: usize = self.right.iter().sum();
        let n_true: usize = [self.right, self.twins, self.wrong]
            .as_flattened()
            .iter()
            .sum();
        let share = if n_true == 0 {
            "-".to_owned()
        } else {
            format!("{n_right}/{n_true}")
        };
        let [covered, known] = self.covered;
        vec![
            self.scenario.clone(),
            share,
            slashed(self.right),
            slashed(self.twins),
            slashed(self.wrong),
            slashed(self.no_truth),
            pair(self.node_error),
            pair(self.error_ratio),
            if known == 0 {
                "-".to_owned()
            } else {
                format!("{covered}/{known}")
            },
            format!("{:.0} / {:.0}", self.time_ms[0], self.time_ms[1]),
        ]
    }
}

/// Titles of the columns. Verdicts are counted GOOD/CHECK/POOR.
pub const COLUMNS: [&str; 10] = [
    "scenario",
    "right",
    "of right",
    "of twins",
    "of wrong",
    "no truth",
    "error mm",
    "error/stated",
    "covered",
    "time ms",
];

/// What the columns mean, one sentence each.
pub fn notes() -> String {
    format!(
        "Verdicts are counted GOOD/CHECK/POOR. A twin is another pose under which the smaller part lies as\n\
         well. Pairs of values are median and largest. Covered: error of the worst node within {COVERAGE} times\n\
         the stated uncertainty, plus an offset that cannot be told from a shift."
    )
}
