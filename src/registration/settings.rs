//! Everything a match depends on besides the meshes.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::RegistrationError;
use super::closed_form::Motion;
use super::icp::{Floor, Metric, PairSelection, PairWith};
use super::multi_start::starts::{StartMethod, StartSettings};

/// The methods by name; each is a choice of pairs, selection, metric and search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Closed form for meshes with the same node numbering.
    Umeyama,
    /// All pairs count.
    Icp,
    /// The given share of the pairs counts.
    Trimmed,
    /// A share found by itself counts, searched in 0.4 … 1.
    TrimmedSearch,
    /// Fractional ICP with a floor, the default.
    #[default]
    Fractional,
    /// Fractional ICP as in the paper: node to node, point to point, no floor, every start run to
    /// its end, λ 3 and then 0.95.
    Paper,
}

/// Which hand of the source is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hand {
    /// As it is.
    #[default]
    Same,
    /// Mirrored: a left-hand part for a right-hand one.
    Mirrored,
    /// Both; the better one wins.
    Either,
}

/// How the starts are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// All starts on few points, the best distinct ones on more, the winner refined.
    #[default]
    CoarseToFine,
    /// Every start on all points to its end.
    EveryStart,
}

/// Which mesh supplies the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DataSide {
    /// The smaller one; of equal ones the coarser; both where both overhang.
    #[default]
    Auto,
    /// The source's nodes on the target's triangles.
    Source,
    /// The target's nodes on the source's triangles.
    Target,
}

/// Everything a match depends on besides the meshes. The defaults just work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MatchSettings {
    /// The method by name; sets the fields below through [`MatchSettings::of`]. Only
    /// [`Method::Umeyama`] is asked for again later, because it needs no search.
    pub method: Method,
    /// What a data point is paired with.
    pub pair_with: PairWith,
    /// Which pairs are kept.
    pub selection: PairSelection,
    /// What is minimised.
    pub metric: Metric,
    /// What may move.
    pub motion: Motion,
    /// Which hand of the source is tried.
    pub hand: Hand,
    /// How the first poses are made.
    pub starts: StartSettings,
    /// How they are searched.
    pub search: Search,
    /// Refine the best pose on the full meshes (else only on the reduced ones, if there are any).
    pub refine_on_full: bool,
    /// Which mesh supplies the points.
    pub data_side: DataSide,
    /// Deviation of the real shapes that is to be expected besides faceting, such as springback;
    /// added to the floor. In length units.
    pub allowance: f64,
    /// How far the shapes may differ besides springback before they are another version, in length
    /// units; 0 takes the larger of a millimetre and the sheet's thickness. It decides nothing in the
    /// search.
    pub shape_tolerance: f64,
    /// Take a separable offset of the sheets, as between skin and mid-surface, out of the pose.
    pub remove_offset: bool,
    /// Largest angle between normals of a pair in the later stages, degrees; 180 lets all through.
    pub max_normal_angle_deg: f64,
    /// Data points of the coarse stage.
    pub n_coarse_points: usize,
    /// Data points of the refinement.
    pub n_refine_points: usize,
    /// Iteration cap where a run goes to its end.
    pub max_iterations: usize,
    /// A run has converged when a step moves no corner of the bounding box by more than this
    /// fraction of the mean edge length.
    pub motion_tolerance: f64,
}

impl Default for MatchSettings {
    fn default() -> Self {
        Self {
            method: Method::Fractional,
            pair_with: PairWith::Triangle,
            selection: PairSelection::default(),
            metric: Metric::Symmetric,
            motion: Motion::Rigid,
            hand: Hand::Same,
            starts: StartSettings::default(),
            search: Search::CoarseToFine,
            refine_on_full: true,
            data_side: DataSide::Auto,
            allowance: 0.0,
            shape_tolerance: 0.0,
            remove_offset: false,
            max_normal_angle_deg: 60.0,
            n_coarse_points: 500,
            n_refine_points: 3000,
            max_iterations: 200,
            motion_tolerance: 1e-3,
        }
    }
}

impl MatchSettings {
    /// The settings that a method's name stands for.
    pub fn of(method: Method) -> Self {
        let base = Self {
            method,
            ..Self::default()
        };
        match method {
            Method::Umeyama | Method::Fractional => base,
            Method::Icp => Self {
                selection: PairSelection::All,
                ..base
            },
            Method::Trimmed => Self {
                selection: PairSelection::Trimmed {
                    overlap: PairSelection::USUAL_OVERLAP,
                },
                ..base
            },
            Method::TrimmedSearch => Self {
                selection: PairSelection::TrimmedSearch,
                ..base
            },
            Method::Paper => Self {
                pair_with: PairWith::Node,
                selection: PairSelection::Fractional {
                    lambda: 0.95,
                    floor: Floor::None,
                },
                metric: Metric::PointToPoint,
                search: Search::EveryStart,
                refine_on_full: false,
                data_side: DataSide::Source,
                max_normal_angle_deg: 180.0,
                starts: StartSettings {
                    both_signs: false,
                    wide_search: false,
                    ..StartSettings::default()
                },
                ..base
            },
        }
    }

    /// Says which setting lies outside its range.
    pub(crate) fn check(&self) -> Result<(), RegistrationError> {
        self.starts.n_rotations()?;
        if self.starts.method == StartMethod::GivenPoses && self.starts.poses.is_empty() {
            return Err(RegistrationError::NoStarts);
        }
        let within = |name, value: f64, range: RangeInclusive<f64>| {
            if range.contains(&value) {
                Ok(())
            } else {
                Err(RegistrationError::Setting { name, value, range })
            }
        };
        match self.selection {
            PairSelection::Trimmed { overlap } => within("the overlap", overlap, limits::OVERLAP)?,
            PairSelection::Fractional { lambda, floor } => {
                within("λ", lambda, limits::LAMBDA)?;
                if let Floor::Length(length) = floor {
                    within("the floor", length, limits::LENGTH)?;
                }
            }
            PairSelection::All | PairSelection::TrimmedSearch => {}
        }
        within("the allowance", self.allowance, limits::LENGTH)?;
        within("the shape tolerance", self.shape_tolerance, limits::LENGTH)?;
        let angle = self.max_normal_angle_deg;
        within(
            "the normal angle in degrees",
            angle,
            limits::NORMAL_ANGLE_DEG,
        )?;
        let tolerance = self.motion_tolerance;
        within("the motion tolerance", tolerance, limits::MOTION_TOLERANCE)?;
        let counts = [
            ("the number of coarse points", self.n_coarse_points),
            ("the number of refinement points", self.n_refine_points),
            ("the iteration limit", self.max_iterations),
        ];
        let range = *limits::COUNT.start() as f64..=*limits::COUNT.end() as f64;
        let mut counts = counts.into_iter();
        counts.try_for_each(|(name, value)| within(name, value as f64, range.clone()))
    }

    /// Takes another method with its own settings; start, given poses, rotation step, hand and tolerances stay.
    pub fn set_method(&mut self, method: Method) {
        let mut new = Self::of(method);
        new.starts.method = self.starts.method;
        new.starts.poses = std::mem::take(&mut self.starts.poses);
        new.starts.angle_segment_deg = self.starts.angle_segment_deg;
        new.hand = self.hand;
        new.allowance = self.allowance;
        new.shape_tolerance = self.shape_tolerance;
        new.remove_offset = self.remove_offset;
        *self = new;
    }
}

/// The ranges outside of which a match refuses a setting.
pub mod limits {
    use std::ops::RangeInclusive;

    /// λ of Fractional ICP.
    pub const LAMBDA: RangeInclusive<f64> = 0.01..=100.0;
    /// Fraction that Trimmed ICP keeps.
    pub const OVERLAP: RangeInclusive<f64> = 1e-3..=1.0;
    /// Lengths: floor, allowance and shape tolerance. No part is larger in any unit.
    pub const LENGTH: RangeInclusive<f64> = 0.0..=1e9;
    /// Angle between the normals of a pair, in degrees.
    pub const NORMAL_ANGLE_DEG: RangeInclusive<f64> = 1.0..=180.0;
    /// Tolerance of convergence, in mean edge lengths.
    pub const MOTION_TOLERANCE: RangeInclusive<f64> = 0.0..=1.0;
    /// Step of the rotations about the mean normal, in degrees. Above 60° there are fewer than six
    /// starts, too few to reach the right minimum from every placement.
    pub const ANGLE_SEGMENT_DEG: RangeInclusive<f64> = 1.0..=60.0;
    /// Points and iterations.
    pub const COUNT: RangeInclusive<usize> = 1..=1_000_000_000;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Similarity;

    #[test]
    fn another_method_begins_at_the_same_poses() {
        let mut settings = MatchSettings::default();
        settings.starts.method = StartMethod::GivenPoses;
        settings.starts.poses = vec![Similarity::mirror_x()];
        settings.set_method(Method::Trimmed);
        assert_eq!(settings.method, Method::Trimmed);
        assert_eq!(settings.starts.method, StartMethod::GivenPoses);
        assert_eq!(settings.starts.poses, [Similarity::mirror_x()]);
        assert!(settings.check().is_ok());
    }
}
