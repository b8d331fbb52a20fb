//! The values that travel between the window and the pipeline.

use crate::geometry::Similarity;
use serde::{Deserialize, Serialize};

/// Every setting of a match.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MatchRecipe {
    /// Seed of everything that is drawn.
    pub seed: u64,
    /// Ceilings of the triangles that are matched, crash and stamped; `None` takes all.
    pub reduce_to: [Option<usize>; 2],
}

/// A first pose.
#[derive(Debug, Clone, PartialEq)]
pub struct StartPose {
    /// The pose.
    pub crash_from_stamped: Similarity,
    /// In words, for example "normal up, turned 30°".
    pub label: String,
}

/// What a match found.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchRun {
    /// The pose.
    pub crash_from_stamped: Similarity,
    /// Other poses that fit nearly as well.
    pub alternatives: Vec<Similarity>,
    /// The verdict in words.
    pub verdict: String,
}

/// Distances and overlap at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Share of the stamped part that lies on the crash part.
    pub overlap: f64,
}

/// Settings of a sweep.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepSettings {
    /// Ceilings of the triangles.
    pub levels: Vec<usize>,
}

/// The paper's tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepTable;

/// What is to be written and where.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportRequest;
