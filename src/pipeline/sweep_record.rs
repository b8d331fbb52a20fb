//! The tables of a sweep as JSON and as CSV, for the window and the command line alike.

use std::fmt::Write as _;

use serde::Serialize;

use super::sweep::{MatchingRow, ReductionRow, Sweep};

/// The tables as they are written to JSON.
#[derive(Serialize)]
pub struct SweepRecord {
    schema: &'static str,
    threads: usize,
    triangles: usize,
    reduction: Vec<ReductionEntry>,
    matching: Vec<MatchingEntry>,
    reference: &'static str,
    build: String,
}

#[derive(Serialize)]
struct ReductionEntry {
    max_triangles: usize,
    triangles: usize,
    time_ms: f64,
    paper_ms: Option<f64>,
    rms: f64,
    max: f64,
    border_max: f64,
    border_loops: usize,
}

#[derive(Serialize)]
struct MatchingEntry {
    max_triangles: Option<usize>,
    crash_triangles: usize,
    stamped_triangles: usize,
    time_ms: f64,
    paper_ms: Option<f64>,
    node_rms: f64,
    node_max: f64,
    finished_ms: f64,
    finished_node_rms: f64,
}

impl From<&ReductionRow> for ReductionEntry {
    fn from(row: &ReductionRow) -> Self {
        Self {
            max_triangles: row.max_triangles,
            triangles: row.triangles,
            time_ms: row.time_ms,
            paper_ms: row.paper_ms,
            rms: row.rms,
            max: row.max,
            border_max: row.border_max,
            border_loops: row.loops,
        }
    }
}

impl From<&MatchingRow> for MatchingEntry {
    fn from(row: &MatchingRow) -> Self {
        Self {
            max_triangles: row.max_triangles,
            crash_triangles: row.triangles.crash,
            stamped_triangles: row.triangles.stamped,
            time_ms: row.time_ms,
            paper_ms: row.paper_ms,
            node_rms: row.node_rms,
            node_max: row.node_max,
            finished_ms: row.finished_ms,
            finished_node_rms: row.finished_node_rms,
        }
    }
}

impl Sweep {
    /// Both tables with threads and build.
    pub fn to_record(&self) -> SweepRecord {
        SweepRecord {
            schema: "shapematch.bench/1",
            threads: rayon::current_num_threads(),
            triangles: self.n_triangles,
            reduction: self.reduction.iter().map(Into::into).collect(),
            matching: self.matching.iter().map(Into::into).collect(),
            reference: if self.has_truth {
                "known pose"
            } else {
                "match of the full meshes"
            },
            build: crate::report::build_id(),
        }
    }

    /// [`Sweep::to_record`] as text.
    pub fn to_json(&self) -> String {
        // Numbers and plain text always have a JSON form.
        serde_json::to_string_pretty(&self.to_record()).unwrap_or_default()
    }

    /// Both tables between commas, with a first column that tells them apart.
    pub fn to_csv(&self) -> String {
        let number = |n: Option<f64>| n.map_or_else(String::new, |n| n.to_string());
        let mut text = String::from(
            "table,max_triangles,triangles,time_ms,paper_ms,rms,max,finished_ms,finished_rms\n",
        );
        // Writing to a string cannot fail.
        for row in &self.reduction {
            let (max, n, paper) = (row.max_triangles, row.triangles, number(row.paper_ms));
            let (time, rms, far) = (row.time_ms, row.rms, row.max);
            let _ = writeln!(text, "reduction,{max},{n},{time},{paper},{rms},{far},,");
        }
        for row in &self.matching {
            let max = row
                .max_triangles
                .map_or_else(String::new, |n| n.to_string());
            let (n, paper) = (row.triangles.stamped, number(row.paper_ms));
            let (time, rms, far) = (row.time_ms, row.node_rms, row.node_max);
            let (finished, finished_rms) = (row.finished_ms, row.finished_node_rms);
            let _ = writeln!(
                text,
                "matching,{max},{n},{time},{paper},{rms},{far},{finished},{finished_rms}"
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_hold_every_row() {
        let sweep = Sweep {
            n_triangles: 34_808,
            reduction: vec![ReductionRow {
                max_triangles: 1000,
                triangles: 998,
                time_ms: 12.5,
                rms: 0.1,
                max: 0.5,
                border_max: 0.2,
                loops: 3,
                paper_ms: Some(1406.0),
            }],
            matching: Vec::new(),
            has_truth: false,
        };
        let json: serde_json::Value = serde_json::from_str(&sweep.to_json()).unwrap();
        assert_eq!(json["reduction"][0]["triangles"], 998);
        assert_eq!(json["reference"], "match of the full meshes");
        let csv = sweep.to_csv();
        assert_eq!(
            csv.lines().nth(1),
            Some("reduction,1000,998,12.5,1406,0.1,0.5,,")
        );
        let n_columns = |line: &str| line.split(',').count();
        assert!(csv.lines().all(|line| n_columns(line) == 9), "{csv}");
    }
}
