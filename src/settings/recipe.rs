//! Everything a match depends on besides the two parts.

use serde::{Deserialize, Serialize};

use crate::registration::MatchSettings;

/// Everything a match depends on besides the two parts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MatchRecipe {
    /// Method and parameters.
    pub settings: MatchSettings,
    /// Reduce both parts to so many triangles for the search, as the paper does.
    pub max_triangles: Option<usize>,
}
