use super::{Assessment, Clarity};
use crate::registration::{MatchOutcome, Surface, Termination};
use serde::{Deserialize, Serialize};

/// The judgement in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Use it.
    Good,
    /// Probably right; look at the reasons.
    Check,
    /// Do not use it.
    Poor,
}

impl Verdict {
    /// The word for the user.
    pub fn label(self) -> &'static str {
        match self {
            Self::Good => "GOOD",
            Self::Check => "CHECK",
            Self::Poor => "POOR",
        }
    }

    /// The word for machines.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Check => "check",
            Self::Poor => "poor",
        }
    }
}

/// Overlap of the better covered part that is needed for GOOD, and for not being POOR.
const FULL_OVERLAP: f64 = 0.9;
const LEAST_OVERLAP: f64 = 0.45;
/// Root mean square distance, as a share of the overlap limit, above which a fit is POOR. Places
/// spread evenly between zero and the limit, as under a wrong pose, measure 0.58.
const POOR_RMSE: f64 = 0.5;
/// Distances up to so many times the faceting are unremarkable.
const FACETING: f64 = 3.0;
/// Distance of the kept pairs, as a share of the overlap limit, above which parts that overhang
/// each other are different parts. A rail against a bracket measures 0.7.
const DIFFERENT_P95: f64 = 0.4;
/// Scales of the final pairs farther from 1 than this hint at different sizes.
const SCALE_TOLERANCE: f64 = 0.005;

/// One reason with its weight.
type Reason = (Verdict, String);

/// The verdict with its reasons, the gravest first.
pub(super) fn decide(
    assessment: &Assessment,
    outcome: &MatchOutcome,
    source: &Surface,
    target: &Surface,
) -> (Verdict, Vec<String>) {
    let mut reasons: Vec<Reason> = Vec::new();
    reasons.extend(hand(assessment));
    reasons.extend(unit(assessment));
    reasons.extend(distances(assessment, outcome, source, target));
    reasons.extend(overlap(assessment));
    reasons.extend(mismatch(assessment, outcome));
    reasons.extend(freedom(assessment));
    reasons.extend(ambiguity(assessment));
    reasons.extend(ending(outcome));
    let verdict = reasons.iter().map(|(v, _)| *v).max();
    let verdict = verdict.unwrap_or(Verdict::Good);
    if verdict == Verdict::Good {
        let overlap = percent(assessment.coverage.better_overlap());
        let p95 = assessment.coverage.p95();
        reasons.push((
            Verdict::Good,
            format!("{overlap} of the smaller part is covered, 95 % of it within {p95:.3}, and no other pose comes near"),
        ));
    }
    reasons.sort_by_key(|(verdict, _)| std::cmp::Reverse(*verdict));
    (
        verdict,
        reasons.into_iter().map(|(_, words)| words).collect(),
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn hand(assessment: &Assessment) -> Option<Reason> {
    let ratio = assessment.mirror_check.score_ratio?;
    if ratio < 0.8 {
        let words = format!(
            "the opposite hand fits better (its score is {ratio:.2} of this one's): \
             match it mirrored, or choose the other part"
        );
        return Some((Verdict::Poor, words));
    }
    (ratio < 0.98).then(|| {
        let words = format!(
            "the part is nearly its own mirror image, and the opposite hand fits a little better \
             (its score is {ratio:.2} of this one's)"
        );
        (Verdict::Check, words)
    })
}

fn unit(assessment: &Assessment) -> Option<Reason> {
    let check = &assessment.scale_check;
    if let Some(unit) = check.unit {
        let words = format!(
            "the target is {:.4} times as large as the source: are they in different units ({})? \
             Factor {:.6} was not applied",
            check.size_ratio, unit.words, unit.factor
        );
        return Some((Verdict::Poor, words));
    }
    let off = (check.pair_scale - 1.0).abs();
    (off > SCALE_TOLERANCE).then(|| {
        let words = format!("the pairs would fit best at scale {:.4}", check.pair_scale);
        (Verdict::Check, words)
    })
}

fn distances(
    assessment: &Assessment,
    outcome: &MatchOutcome,
    source: &Surface,
    target: &Surface,
) -> Option<Reason> {
    let coverage = &assessment.coverage;
    let rmse = coverage.rmse();
    if rmse > POOR_RMSE * coverage.limit {
        let words = format!(
            "the parts do not lie on each other: root mean square distance {rmse:.3} within the \
             limit of {:.3}",
            coverage.limit
        );
        return Some((Verdict::Poor, words));
    }
    let edge = |surface: &Surface| surface.measures().mean_edge_length;
    let finest = edge(source).min(edge(target));
    let usual = (FACETING * assessment.noise).max(0.02 * finest);
    // Measured against the smooth surface; the plain distances hold the facets' own error.
    let p95 = outcome.p95;
    (p95 > usual).then(|| {
        let words = format!(
            "the shapes differ: 95 % lie within {p95:.3}, the facets alone explain {usual:.3}"
        );
        (Verdict::Check, words)
    })
}

fn overlap(assessment: &Assessment) -> Option<Reason> {
    let coverage = &assessment.coverage;
    let better = coverage.better_overlap();
    let both = format!(
        "{} of the stamped and {} of the crash part",
        percent(coverage.source_on_target.overlap),
        percent(coverage.target_on_source.overlap)
    );
    if better < LEAST_OVERLAP {
        let words = format!("only {both} lie within {:.3} of each other", coverage.limit);
        return Some((Verdict::Poor, words));
    }
    (better < FULL_OVERLAP).then(|| {
        let words = format!("neither part contains the other: {both} are covered");
        (Verdict::Check, words)
    })
}

/// Parts that overhang each other may be the same sheet, and parts whose shapes differ may be so
/// because of springback; both together are two different parts that happen to touch.
fn mismatch(assessment: &Assessment, outcome: &MatchOutcome) -> Option<Reason> {
    let coverage = &assessment.coverage;
    let overhang = coverage.better_overlap() < FULL_OVERLAP;
    (overhang && outcome.p95 > DIFFERENT_P95 * coverage.limit).then(|| {
        let words = "the parts neither cover each other nor agree where they meet: are they the \
                     same part?";
        (Verdict::Poor, words.to_owned())
    })
}

fn freedom(assessment: &Assessment) -> Option<Reason> {
    let motion = assessment.freedom.motion?;
    Some((Verdict::Check, motion.words()))
}

fn ambiguity(assessment: &Assessment) -> Option<Reason> {
    let ambiguity = &assessment.ambiguity;
    let ratio = ambiguity.ratio?;
    let how = ambiguity.twin.map_or_else(
        || "in another pose".to_owned(),
        |twin| format!("{} it", twin.words()),
    );
    let words = match ambiguity.clarity {
        Clarity::Clear => return None,
        Clarity::Verify => {
            format!("{how} fits nearly as well (score ratio {ratio:.2}): verify which is meant")
        }
        Clarity::Ambiguous => format!(
            "ambiguous: {how} fits as well (score ratio {ratio:.3}), {} equivalent positions in all",
            ambiguity.n_equivalent
        ),
    };
    Some((Verdict::Check, words))
}

fn ending(outcome: &MatchOutcome) -> Option<Reason> {
    match outcome.termination {
        Termination::Converged | Termination::ClosedForm => None,
        Termination::MaxIterations => None,
        Termination::Stopped => Some((
            Verdict::Check,
            "the match was stopped before it had settled".to_owned(),
        )),
        Termination::Degenerate | Termination::NoPairs => {
            let words = format!("the match ended early: {}", outcome.termination.label());
            Some((Verdict::Poor, words))
        }
    }
}
