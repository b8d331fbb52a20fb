use crate::registration::Alternative;
use serde::{Deserialize, Serialize};

/// Below this ratio two poses are equivalent.
const AMBIGUOUS_BELOW: f64 = 1.1;
/// Below this ratio the second-best pose deserves a look.
const VERIFY_BELOW: f64 = 1.3;

/// How far the second-best distinct pose is behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clarity {
    /// No other pose comes near.
    Clear,
    /// Another pose is nearly as good: 1.1 to 1.3 times the score.
    Verify,
    /// Another pose is as good: less than 1.1 times the score.
    Ambiguous,
}

/// The comparison with the poses that came closest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ambiguity {
    /// The verdict of the comparison.
    pub clarity: Clarity,
    /// Score of the second-best distinct pose over the best, if one was near.
    pub ratio: Option<f64>,
    /// Equivalent positions, the result included.
    pub n_equivalent: usize,
}

impl Ambiguity {
    /// Judges alternatives sorted by their score ratio.
    pub fn of(alternatives: &[Alternative]) -> Self {
        let ratio = alternatives.first().map(|a| a.score_ratio);
        let clarity = match ratio {
            Some(ratio) if ratio < AMBIGUOUS_BELOW => Clarity::Ambiguous,
            Some(ratio) if ratio < VERIFY_BELOW => Clarity::Verify,
            _ => Clarity::Clear,
        };
        let equivalent = alternatives
            .iter()
            .filter(|a| a.score_ratio < AMBIGUOUS_BELOW);
        Self {
            clarity,
            ratio,
            n_equivalent: 1 + equivalent.count(),
        }
    }
}
