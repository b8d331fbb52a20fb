//! Distances and overlap at the pose that is shown.

use std::sync::Arc;
use std::time::Duration;

use super::MatchState;
use crate::app::work::Work;
use crate::app::{AppState, Effect, LogStep, MatchResult, Reason, facts};
use crate::assess::{AlternativeStatements, Assessment, Coverage};
use crate::jobs::{JobKey, JobKind, MeasureInput, Measurement, Stamp};
use crate::registration::MatchSettings;

impl AppState {
    /// Distances and overlap of the current result at the pose that is shown: those of the match for its
    /// best pose, for an alternative what was measured there; `None` until that is known.
    pub fn result_coverage(&self) -> Option<&Coverage> {
        self.coverage_of(self.document.current_result()?)
    }

    /// The same of a result that the part may have been moved from.
    pub fn coverage_of<'a>(&'a self, result: &'a MatchResult) -> Option<&'a Coverage> {
        match result.alternative {
            None => Some(&result.run.assessment.coverage),
            Some(_) => {
                let measured = self.matching.measurement_at(result.stamp)?;
                Some(&measured.coverage)
            }
        }
    }

    /// What is said of the alternative that is shown; `None` until it is measured.
    pub fn alternative_statements(&self) -> Option<&AlternativeStatements> {
        let result = self.document.current_result()?;
        let measured = self.matching.measurement_at(result.stamp)?;
        let (_, said) = measured.alternative.as_ref()?;
        result.alternative.is_some().then_some(said)
    }
}

impl AppState {
    /// The assessment whose uncertainty is that of the shown pose: of the match's best pose only.
    pub fn uncertain_assessment(&self) -> Option<&Arc<Assessment>> {
        let result = self.document.current_result()?;
        let assessment = &result.run.assessment;
        let is_stated = result.alternative.is_none() && assessment.uncertainty().is_some();
        is_stated.then_some(assessment)
    }

    /// `Ok` if it is known how far the shown pose may be off.
    pub fn has_uncertainty(&self) -> Result<(), Reason> {
        match self.uncertain_assessment() {
            Some(_) => Ok(()),
            None => Err(Reason(
                "Only the best pose of a match has an uncertainty; match first.",
            )),
        }
    }
}

impl MatchState {
    /// The measurement, if it was made of these parts at this pose.
    fn measurement_at(&self, stamp: Stamp) -> Option<&Measurement> {
        let (at, measurement) = self.measurement.as_ref()?;
        (*at == stamp).then_some(&**measurement)
    }

    /// The match measured its best pose; an alternative that is shown is measured as soon as it is.
    pub(in crate::app) fn keep_measuring_alternative(
        &mut self,
        work: &mut Work<'_>,
    ) -> Vec<Effect> {
        let stamp = work.document.stamp();
        let result = work.document.current_result();
        let is_alternative = result.is_some_and(|result| result.alternative.is_some());
        let tolerance = work.document.recipe.settings.shape_tolerance;
        let measured = self.measurement_at(stamp);
        let said = measured.and_then(|measured| measured.alternative.as_ref());
        let is_known = said.is_some_and(|(of, _)| *of == tolerance)
            || self.alternative_asked == Some((stamp, tolerance));
        let is_free = work.is_unlocked().is_ok() && !work.jobs.is_active(JobKey::Measure);
        if !is_alternative || is_known || !is_free {
            return Vec::new();
        }
        self.alternative_asked = Some((stamp, tolerance));
        measure(work)
    }

    pub(in crate::app) fn take_measured(
        &mut self,
        work: &mut Work<'_>,
        measurement: Arc<Measurement>,
        stamp: Stamp,
        took: Duration,
    ) {
        let line = facts::measure_line(&measurement.coverage, work.lengths());
        work.log_step(LogStep::Measure, None, line, Some(took));
        self.measurement = Some((stamp, measurement.into()));
    }
}

pub(super) fn measure(work: &mut Work<'_>) -> Vec<Effect> {
    let Some(both) = work.document.both() else {
        return Vec::new();
    };
    let result = work.document.current_result();
    let alternative = result.filter(|result| result.alternative.is_some());
    let alternative_of = alternative.map(|result| {
        Box::new(MatchSettings {
            shape_tolerance: work.document.recipe.settings.shape_tolerance,
            ..result.run.recipe.settings.clone()
        })
    });
    let input = MeasureInput {
        parts: both.map(|part| part.loaded.to_arc()),
        crash_from_stamped: *work.document.crash_from_stamped(),
        alternative_of,
    };
    let mut effects = work.cancel(JobKey::Measure);
    effects.push(work.start(JobKind::Measure(input)));
    effects
}
