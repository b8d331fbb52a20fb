//! What the match gave at each level of reduction, for the chips of section 2.

use std::time::Duration;

use super::ReduceState;
use crate::app::{AppState, Document, OfParts};
use crate::geometry::Similarity;
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::sweep::Sweep;
use crate::role::{PerRole, Role};

/// The result of a match that searched on one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelResult {
    /// The ceiling of both parts; `None` for the full meshes.
    pub max_triangles: Option<usize>,
    /// The pose that was found.
    pub crash_from_stamped: Similarity,
    /// Root mean square distance of the two parts at that pose, where it was measured.
    pub rmse: Option<f64>,
    /// How long the match took.
    pub took: Duration,
}

impl AppState {
    /// The result of the match at a level, if one was made with the loaded parts.
    pub fn level_result(&self, max_triangles: Option<usize>) -> Option<&LevelResult> {
        let mut rows = self.reduce.level_results.current(&self.document)?.iter();
        rows.rfind(|row| row.max_triangles == max_triangles)
    }

    /// How far the pose of a level puts the stamped part from where that of the full meshes does:
    /// the largest distance at the corners of its box. `None` before both are known.
    pub fn distance_to_full(&self, result: &LevelResult) -> Option<f64> {
        let full = self.level_result(None)?;
        let part = self.document.part(Role::Stamped)?;
        let corners = part.bounds().corners();
        let (at, of_full) = (&result.crash_from_stamped, &full.crash_from_stamped);
        Some(at.max_displacement(of_full, &corners))
    }
}

impl ReduceState {
    /// Remembers a match by the level it searched on; parts at two different levels are no level.
    pub(in crate::app) fn keep_match_level(&mut self, document: &Document, run: &MatchRun) {
        let PerRole { crash, stamped } = run.max_triangles;
        if crash != stamped {
            return;
        }
        self.keep_level(
            document,
            LevelResult {
                max_triangles: crash,
                crash_from_stamped: run.crash_from_stamped,
                rmse: Some(run.assessment.coverage.rmse()),
                took: Duration::try_from_secs_f64(run.times.total_ms / 1e3).unwrap_or_default(),
            },
        );
    }

    /// Remembers the matches of a sweep.
    pub(in crate::app) fn keep_sweep_levels(&mut self, document: &Document, sweep: &Sweep) {
        for row in &sweep.matching {
            self.keep_level(
                document,
                LevelResult {
                    max_triangles: row.max_triangles,
                    crash_from_stamped: row.crash_from_stamped,
                    rmse: None,
                    took: Duration::try_from_secs_f64(row.time_ms / 1e3).unwrap_or_default(),
                },
            );
        }
    }

    fn keep_level(&mut self, document: &Document, result: LevelResult) {
        let known = self.level_results.current(document);
        let others = known.into_iter().flatten();
        let others = others.filter(|row| row.max_triangles != result.max_triangles);
        let rows = others.copied().chain([result]).collect();
        self.level_results = OfParts::new(document, rows);
    }
}
