//! The pose of a stamped file that is given none.

use serde::{Deserialize, Serialize};

use super::PipelineError;
use crate::assess::Verdict;
use crate::geometry::Similarity;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::{MatchRecipe, MatchRun, match_parts};
use crate::registration::{Hand, MatchMonitor};
use crate::role::PerRole;

/// Where the pose of a further stamped file comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FurtherPose {
    /// It is matched by itself.
    #[default]
    Matched,
    /// It lies as the first stamped part does: both were formed in one tool.
    AsFirst,
}

impl FurtherPose {
    /// Both, in the order of the choice.
    pub const ALL: [Self; 2] = [Self::Matched, Self::AsFirst];

    /// The choice in section 4.
    pub fn label(self) -> &'static str {
        match self {
            Self::Matched => "Matched",
            Self::AsFirst => "As the first",
        }
    }

    /// The choice in a sentence.
    pub fn help(self) -> &'static str {
        match self {
            Self::Matched => "The file is matched with the crash part by itself",
            Self::AsFirst => "The file lies as the first one does: both were formed in one tool",
        }
    }
}

/// How a stamped file is matched before it is mapped from: in the usual way, from where its file has it.
pub fn placing_recipe(hand: Hand) -> MatchRecipe {
    let mut recipe = MatchRecipe::default();
    recipe.settings.hand = hand;
    recipe
}

/// The match that gives a stamped file its pose on the crash part.
pub fn place<'a>(
    parts: PerRole<&LoadedPart>,
    recipe: &MatchRecipe,
    monitor: impl Into<MatchMonitor<'a>>,
) -> Result<MatchRun, PipelineError> {
    match_parts(parts, None, recipe, &Similarity::identity(), monitor)
}

/// What is to be told of the pose of a stamped file before it is mapped from; `None` if nothing is.
pub fn pose_warning(verdict: Verdict, file: &str) -> Option<String> {
    (verdict == Verdict::Poor)
        .then(|| format!("the pose of {file} is poor; look at it before the mapping is used"))
}
