//! A start on its way, and the choice of data and model it runs in.

use std::borrow::Cow;
use std::sync::Arc;

use super::starts::Start;
use crate::geometry::Similarity;
use crate::registration::agreement::same_pose;
use crate::registration::icp::{Data, Frames, Run, Stage, StageRules, natural_floor, stage_rules};
use crate::registration::observer::MatchMonitor;
use crate::registration::result::{Side, StartOutcome, StartRecord};
use crate::registration::settings::MatchSettings;
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// The deviation of the shapes is measured on the closer part of the pairs, because the rest may have no
/// counterpart: this share of them …
const DEVIATION_SHARE: f64 = 0.3;
/// … and so many times what they keep within: of values around nothing two thirds lie there.
const DEVIATION_SCALE: f64 = 2.0;
/// So many times the faceting is no deviation.
const FACETING: f64 = 3.0;
/// Largest deviation that is expected, as a share of the reach: of 1 % of the diagonal.
const DEVIATION_REACH: f64 = 0.1;

/// The surfaces of one stage in their roles.
#[derive(Clone, Copy)]
pub(crate) struct Pairing<'a> {
    /// Supplies the points and moves.
    pub(crate) data: &'a Surface,
    /// Supplies the triangles and stays.
    pub(crate) model: &'a Surface,
}

impl Pairing<'_> {
    pub(crate) fn swapped(self) -> Self {
        Self {
            data: self.model,
            model: self.data,
        }
    }
}

/// One choice of hand and of data and model.
pub(crate) struct DataChoice<'a> {
    /// The meshes of the coarse stage.
    pub(crate) coarse: Pairing<'a>,
    /// The meshes of the stages that follow.
    pub(crate) fine: Pairing<'a>,
    pub(crate) frames: Frames,
    pub(crate) mirrored: bool,
    /// The coarse model as a grid, if far questions are put to one.
    pub(crate) grid: Option<Arc<FeatureGrid>>,
    /// Points farther away than this find no partner on the exact meshes.
    pub(crate) reach: f64,
    /// True if the deviation of the shapes is for the match to find out.
    pub(crate) is_estimated: bool,
    /// How far the shapes differ besides their facets as the coarse stage saw it: springback, noise or an
    /// offset of the sheets. Expected by the stages that follow.
    pub(crate) deviation: f64,
}

impl DataChoice<'_> {
    pub(crate) fn data_side(&self) -> Side {
        self.frames.data_side
    }

    /// The motion of the data that a start (a motion of the possibly mirrored source) stands for.
    fn model_from_data(&self, start: &Start) -> Similarity {
        self.data_side().oriented(&start.target_from_source)
    }

    /// The rules of a stage between the surfaces of `pairing`.
    pub(super) fn rules(
        &self,
        stage: Stage,
        settings: &MatchSettings,
        pairing: Pairing<'_>,
    ) -> StageRules {
        let mut expected = Cow::Borrowed(settings);
        if self.deviation > settings.allowance {
            expected.to_mut().allowance = self.deviation;
        }
        let mut rules = stage_rules(stage, &expected, pairing.data, pairing.model);
        rules.matching.reject.max_distance = self.reach;
        rules
    }

    /// From now on expects that the shapes differ as they do under the pose of `run`.
    pub(super) fn expect_as(&mut self, run: &Run) {
        if self.is_estimated {
            self.deviation = self.deviation_of(run).clamp(0.0, self.most_deviation());
        }
    }

    /// False where the shapes differ by more under the pose of `run` than those of one part may, so that
    /// a better pose would be worth nothing either. Always true where the deviation is not estimated.
    pub(super) fn resembles(&self, run: &Run) -> bool {
        !self.is_estimated || self.deviation_of(run) < self.most_deviation()
    }

    /// How far the shapes differ under the pose of `run` besides their facets.
    fn deviation_of(&self, run: &Run) -> f64 {
        let Pairing { data, model } = self.coarse;
        let facets = natural_floor(data, model);
        DEVIATION_SCALE * run.quantile(DEVIATION_SHARE) - FACETING * facets
    }

    fn most_deviation(&self) -> f64 {
        self.reach * DEVIATION_REACH
    }

    /// True for poses of the data that a further refinement would bring together.
    pub(super) fn is_same(&self, a: &Similarity, b: &Similarity) -> bool {
        same_pose(a, b, &self.fine.data.measures().into())
    }
}

/// A start on its way.
pub(crate) struct Candidate {
    pub(crate) start: Start,
    pub(crate) first: Similarity,
    pub(crate) run: Run,
    /// Set once it is out.
    pub(crate) outcome: Option<StartOutcome>,
}

impl Candidate {
    pub(crate) fn new(choice: &DataChoice<'_>, start: Start, start_idx: usize) -> Self {
        let pose = choice.model_from_data(&start);
        Self {
            start,
            first: choice.frames.target_from_source(&pose),
            run: Run::new(start_idx, pose),
            outcome: None,
        }
    }

    /// Where it is as a first pose of the source that was searched with.
    pub(super) fn as_start(&self, choice: &DataChoice<'_>) -> Start {
        Start {
            target_from_source: choice.data_side().oriented(&self.run.model_from_data),
            ..self.start
        }
    }

    pub(crate) fn is_alive(&self) -> bool {
        self.outcome.is_none()
    }

    /// Reports that it begins, or how it ended.
    pub(crate) fn report(&self, choice: &DataChoice<'_>, monitor: &MatchMonitor<'_>) {
        monitor.start(self.run.start_idx, || self.record(choice));
    }

    /// Takes it out of the search and reports why.
    pub(crate) fn end(
        &mut self,
        outcome: StartOutcome,
        choice: &DataChoice<'_>,
        monitor: &MatchMonitor<'_>,
    ) {
        self.outcome = Some(outcome);
        self.report(choice, monitor);
    }

    /// The record so far, without iterations.
    fn record(&self, choice: &DataChoice<'_>) -> StartRecord {
        StartRecord {
            kind: self.start.kind,
            flipped: self.start.flipped,
            mirrored: choice.mirrored,
            data_side: choice.data_side(),
            first: self.first,
            last: choice.frames.target_from_source(&self.run.model_from_data),
            score: self.run.score,
            p95: self.run.p95(),
            took: self.run.took,
            termination: self.run.termination,
            outcome: self.outcome,
            iterations: Vec::new(),
        }
    }

    /// The whole record of a search that has ended: who is still alive is a runner-up.
    pub(crate) fn into_record(self, choice: &DataChoice<'_>) -> StartRecord {
        let record = self.record(choice);
        StartRecord {
            outcome: Some(self.outcome.unwrap_or(StartOutcome::RunnerUp)),
            iterations: self.run.records,
            ..record
        }
    }
}

/// Data of a stage with both directions of the normals.
pub(crate) struct BothSigns([Data; 2]);

impl BothSigns {
    pub(crate) fn new(data: Data) -> Self {
        let flipped = data.flipped();
        Self([data, flipped])
    }

    pub(crate) fn get(&self, flipped: bool) -> &Data {
        &self.0[usize::from(flipped)]
    }
}
