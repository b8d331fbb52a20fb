//! Pairs of points that the user picked on both parts, and the pose that fits them.

mod apply;
mod command;

pub use command::PairCommand;
use serde::{Deserialize, Serialize};

use super::{AppState, Document, JobBoard, Reason};
use crate::geometry::Point3;
use crate::geometry::serial::xyz;
use crate::pipeline::match_parts::MatchRecipe;
use crate::registration::{
    PairDoubt, PointPairFit, RegistrationError, StartMethod, fit_point_pairs,
};
use crate::role::{PerRole, Role};
use crate::text::Lengths;

/// What a picked point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PickKind {
    /// A node, with its number in the deck where it has one.
    Node(Option<u64>),
    /// The middle of a round hole.
    HoleCenter,
    /// A corner of the rim.
    Corner,
    /// A point of the surface.
    Surface,
}

impl PickKind {
    /// In one word, for narrow columns.
    pub fn word(self) -> &'static str {
        match self {
            Self::Node(_) => "node",
            Self::HoleCenter => "hole",
            Self::Corner => "corner",
            Self::Surface => "point",
        }
    }

    /// The kind in words, with the node's number where it is known.
    pub fn words(self) -> String {
        match self {
            Self::Node(Some(id)) => format!("node {id}"),
            Self::Node(None) => "node".to_owned(),
            Self::HoleCenter => "hole centre".to_owned(),
            Self::Corner => "corner".to_owned(),
            Self::Surface => "point".to_owned(),
        }
    }
}

/// A picked point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PickedPoint {
    /// Where, in the space of its own part (for the crash part that is the crash model's).
    #[serde(with = "xyz")]
    pub point: Point3,
    /// What is there.
    pub kind: PickKind,
}

/// One point on each part that belong together; the last pair may lack one.
pub type PointPair = PerRole<Option<PickedPoint>>;

/// The pairs with the parts they were picked on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointPairs {
    /// The loaded parts, as in [`crate::jobs::Stamp`].
    pub parts: PerRole<u64>,
    /// In the order they were picked.
    pub pairs: Vec<PointPair>,
}

/// The tool that picks pairs, while it is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairTool {
    /// A point that is picked again.
    pub repick: Option<(usize, Role)>,
}

/// The tool that picks pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairsState {
    /// Where it stands, while it is on.
    pub tool: Option<PairTool>,
}

/// What picked pairs say, or why they say nothing yet.
pub type PairVerdict = Result<PointPairFit, String>;

impl Document {
    /// The pairs, if they belong to the parts that are loaded.
    pub fn current_pairs(&self) -> &[PointPair] {
        let known = &self.pairs;
        if known.parts == self.stamp().parts {
            &known.pairs
        } else {
            &[]
        }
    }

    /// The best motion for the whole pairs; else what is missing, as a sentence.
    pub fn pair_fit(&self) -> PairVerdict {
        let whole = self.current_pairs().iter();
        let whole = whole.filter_map(|pair| Some((pair.stamped?.point, pair.crash?.point)));
        let (source, target): (Vec<_>, Vec<_>) = whole.unzip();
        fit_point_pairs(&source, &target).map_err(|error| match error {
            RegistrationError::TooFewPairs { n_pairs } => match 3 - n_pairs.min(3) {
                3 => "three pairs of points fix a pose: pick the first one".to_owned(),
                1 => "one more pair is needed".to_owned(),
                n => format!("{n} more pairs are needed"),
            },
            RegistrationError::CollinearPoints => {
                "the points lie on one line, so the turn about it is free: pick one beside it"
                    .to_owned()
            }
            RegistrationError::CoincidentPoints => {
                "the points lie in one place: pick them far apart".to_owned()
            }
            other => other.to_string(),
        })
    }

    /// What is doubtful about the pairs, as a sentence.
    pub fn pair_doubt_text(&self, fit: &PointPairFit, lengths: Lengths) -> Option<String> {
        Some(match fit.doubt? {
            PairDoubt::Far { pair, distance } => format!(
                "Pair {} lies {} from where the others put it: pick it again or delete it.",
                pair + 1,
                lengths.of(distance)
            ),
            PairDoubt::Exchanged {
                pairs: [a, b],
                rmse,
            } => format!(
                "The points of pairs {} and {} may be swapped: exchanged, all pairs fit within {}.",
                a + 1,
                b + 1,
                lengths.of(rmse)
            ),
            PairDoubt::Mirrored { .. } => {
                "The pairs fit a mirrored part much better: is this the opposite hand?".to_owned()
            }
        })
    }

    /// `Ok` unless the match begins with pairs that are not there.
    pub(in crate::app) fn has_start_pose(&self) -> Result<(), Reason> {
        self.has_start_pose_of(&self.recipe)
    }

    /// The same of a match with this recipe.
    pub(in crate::app) fn has_start_pose_of(&self, recipe: &MatchRecipe) -> Result<(), Reason> {
        let method = recipe.settings.starts.method;
        let has = method != StartMethod::GivenPoses || self.pair_fit().is_ok();
        has.then_some(()).ok_or(Reason(
            "Pick three pairs of points first, or choose another start.",
        ))
    }

    /// What a match is run with: the pose of the pairs, where it begins there; none while they fix no pose.
    pub(in crate::app) fn recipe_to_run(&self) -> Option<MatchRecipe> {
        let mut recipe = self.recipe.clone();
        if recipe.settings.starts.method == StartMethod::GivenPoses {
            let fit = self.pair_fit().ok()?;
            recipe.settings.starts.poses = vec![fit.fit.target_from_source];
        }
        Some(recipe)
    }

    /// `Ok` if the pairs fix a pose and the part may be moved.
    pub fn can_fit_pairs(&self, jobs: &JobBoard) -> Result<(), Reason> {
        self.can_move(jobs)?;
        match self.pair_fit() {
            Ok(_) => Ok(()),
            Err(_) if self.current_pairs().len() < 3 => {
                Err(Reason("Pick three pairs of points first."))
            }
            Err(_) => Err(Reason(
                "The pairs do not fix a pose: pick one beside the others.",
            )),
        }
    }
}

impl AppState {
    /// The pair and the part the next click is for, if the tool is on.
    pub fn next_pick(&self) -> Option<(usize, Role)> {
        self.pairs.next_pick(&self.document)
    }

    /// Why a click in this window picks nothing, if the tool is on and another window has what is asked for.
    pub fn wrong_pick(&self, window: Role) -> Option<String> {
        let (pair, asked) = self.next_pick()?;
        if self.view.is_moved_over {
            let is_wrong = window == Role::Stamped;
            return is_wrong.then(|| {
                "Points are picked in the left window while the stamped part is moved over"
                    .to_owned()
            });
        }
        let is_wrong = window != asked && self.pairs.tool?.repick.is_some();
        is_wrong.then(|| format!("Pair {} waits for its point {}", pair + 1, place_of(asked)))
    }
}

/// "on the stamped part, in the right window".
pub(super) fn place_of(role: Role) -> String {
    let side = match role {
        Role::Crash => "left",
        Role::Stamped => "right",
    };
    format!("on the {} part, in the {side} window", role.word())
}

impl PairsState {
    /// The pair and the part the next click is for, if the tool is on. In its own window each part may
    /// also be clicked out of turn.
    fn next_pick(&self, document: &Document) -> Option<(usize, Role)> {
        let tool = self.tool?;
        let pairs = document.current_pairs();
        let n_pairs = pairs.len();
        // Undo, or another part, may have taken the pair away.
        if let Some(repick) = tool.repick.filter(|(pair, _)| *pair < n_pairs) {
            return Some(repick);
        }
        Some(match pairs.last() {
            Some(last) if last.crash.is_none() => (n_pairs - 1, Role::Crash),
            Some(last) if last.stamped.is_none() => (n_pairs - 1, Role::Stamped),
            _ => (n_pairs, Role::Crash),
        })
    }

    /// The pair a click on a part goes to. Out of turn it replaces the point that is there.
    fn place_of_pick(&self, document: &Document, role: Role) -> Option<usize> {
        let (pair, asked) = self.next_pick(document)?;
        let is_repick = self.tool?.repick.is_some();
        (asked == role || !is_repick).then_some(pair)
    }
}
