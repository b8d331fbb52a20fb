//! Why a match is weak: the likely causes with what speaks for them, and one thing to do about each.

use super::{Action, AppState, Command, FileCommand, MatchCommand};
use crate::assess::{Assessment, Clarity, Verdict};
use crate::jobs::Role;
use crate::pipeline::match_parts::MatchRecipe;
use crate::registration::{Hand, StartMethod};

/// Causes that are told; more would be guessing.
const MOST: usize = 3;
/// The other hand is worth a word below this ratio of scores.
const OTHER_HAND: f64 = 0.98;
/// Less overlap of the better covered part is little.
const LITTLE_OVERLAP: f64 = 0.6;

/// A likely cause of a weak or failed match.
#[derive(Debug, Clone)]
pub struct Cause {
    /// The cause as a question.
    pub title: String,
    /// What speaks for it, as a sentence.
    pub evidence: String,
    /// What can be done: the words on the button and what it does.
    pub remedy: Option<(String, Vec<Command>)>,
}

impl AppState {
    /// The likely causes why the present result is not good, the likeliest first.
    pub fn causes(&self) -> Vec<Cause> {
        let Some(result) = self.document.current_result() else {
            return Vec::new();
        };
        let assessment = &result.run.assessment;
        if assessment.verdict == Verdict::Good {
            return Vec::new();
        }
        let found = [
            self.units_cause(assessment),
            self.hand_cause(assessment),
            self.twin_cause(assessment),
            self.freedom_cause(assessment),
            self.overlap_cause(assessment),
            self.shape_cause(assessment, result.run.outcome.p95),
        ];
        found.into_iter().flatten().take(MOST).collect()
    }

    /// Why the last match gave no pose, if these are still its parts.
    pub fn match_failure(&self) -> Option<&str> {
        let parts = self.document.stamp().parts;
        let failed = self.failed_match.as_ref().filter(|(of, _)| *of == parts);
        failed.map(|(_, message)| message.as_str())
    }

    /// What to try after a match that gave no pose.
    pub fn failure_causes(&self) -> Vec<Cause> {
        if self.match_failure().is_none() {
            return Vec::new();
        }
        let units = self.unit_remedy().map(|remedy| Cause {
            title: "Different units?".to_owned(),
            evidence: "The sizes of the two files differ by a factor between units.".to_owned(),
            remedy: Some(remedy),
        });
        let starts = Cause {
            title: "Too few first poses?".to_owned(),
            evidence: "No start found places where the parts meet.".to_owned(),
            remedy: self.retry("Try all starts", |recipe| {
                recipe.settings.starts.method = StartMethod::All;
            }),
        };
        let by_hand = Cause {
            title: "Parts that do not find each other?".to_owned(),
            evidence: "Three pairs of points give a first pose.".to_owned(),
            remedy: self.do_action(Action::PairTool, "Pick point pairs"),
        };
        units.into_iter().chain([starts, by_hand]).collect()
    }

    /// Changes the recipe and runs again.
    fn retry(
        &self,
        label: &str,
        change: impl FnOnce(&mut MatchRecipe),
    ) -> Option<(String, Vec<Command>)> {
        let mut recipe = self.document.recipe.clone();
        change(&mut recipe);
        if recipe == self.document.recipe || self.can_match().is_err() {
            return None;
        }
        let commands = vec![
            MatchCommand::SetRecipe(Box::new(recipe)).into(),
            MatchCommand::Run.into(),
        ];
        Some((label.to_owned(), commands))
    }

    fn do_action(&self, action: Action, label: &str) -> Option<(String, Vec<Command>)> {
        let commands = action.to_commands(self);
        (!commands.is_empty()).then(|| (label.to_owned(), commands))
    }

    fn unit_remedy(&self) -> Option<(String, Vec<Command>)> {
        let hint = self.unit_hint()?;
        let factor = self.hinted_length_factor()?;
        let role = Role::Stamped;
        let (label, command) = match hint.unit {
            Some(unit) => {
                let units = Some(unit.into());
                let command = FileCommand::SetUnits { role, units };
                (format!("Treat stamped as {unit}"), command)
            }
            None => {
                let command = FileCommand::SetLengthFactor { role, factor };
                (format!("Multiply stamped lengths by {factor}"), command)
            }
        };
        Some((label, vec![command.into()]))
    }

    fn units_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let check = &assessment.scale_check;
        check.unit.as_ref()?;
        Some(Cause {
            title: "Different units?".to_owned(),
            evidence: format!(
                "The crash part is {:.4} times as large as the stamped one.",
                check.size_ratio
            ),
            remedy: self.unit_remedy(),
        })
    }

    fn hand_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let ratio = assessment.mirror_check.score_ratio?;
        let hand = self.document.recipe.settings.hand;
        (ratio < OTHER_HAND).then(|| Cause {
            title: "The opposite-hand part?".to_owned(),
            evidence: format!(
                "Mirrored it fits better: its score is {:.0} % of this one's.",
                100.0 * ratio
            ),
            remedy: self.retry("Match the opposite hand", |recipe| {
                recipe.settings.hand = match hand {
                    Hand::Mirrored => Hand::Same,
                    Hand::Same | Hand::Either => Hand::Mirrored,
                };
            }),
        })
    }

    fn twin_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let ambiguity = &assessment.ambiguity;
        if ambiguity.clarity == Clarity::Clear {
            return None;
        }
        let how = ambiguity.twin.map(|twin| twin.words());
        Some(Cause {
            title: "A part that fits twice?".to_owned(),
            evidence: format!(
                "{} it fits almost as well (score ratio {:.2}): check holes and beads.",
                capital(&how.unwrap_or_else(|| "in another pose".to_owned())),
                ambiguity.ratio.unwrap_or(1.0)
            ),
            remedy: self.do_action(Action::FlipAlternative, "Show the other pose"),
        })
    }

    fn freedom_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let motion = assessment.freedom.motion?;
        Some(Cause {
            title: "A shape that slides on itself?".to_owned(),
            evidence: format!("{}.", capital(&motion.words())),
            remedy: self.do_action(Action::PairTool, "Pick point pairs"),
        })
    }

    fn overlap_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let coverage = &assessment.coverage;
        let overlap = coverage.better_overlap();
        (overlap < LITTLE_OVERLAP).then(|| Cause {
            title: "The wrong place?".to_owned(),
            evidence: format!(
                "Only {:.0} % of the better covered part lies within {}.",
                100.0 * overlap,
                self.length_text(coverage.limit)
            ),
            remedy: self
                .retry("Try all starts", |recipe| {
                    recipe.settings.starts.method = StartMethod::All;
                })
                .or_else(|| self.do_action(Action::PairTool, "Pick point pairs")),
        })
    }

    fn shape_cause(&self, assessment: &Assessment, p95: f64) -> Option<Cause> {
        let is_told = assessment
            .reasons
            .iter()
            .any(|r| r.contains("shapes differ"));
        is_told.then(|| Cause {
            title: "Springback, or another forming state?".to_owned(),
            evidence: format!(
                "95 % of the kept pairs lie within {}, more than the facets explain.",
                self.length_text(p95)
            ),
            remedy: self.retry(&format!("Allow {}", self.length_text(p95)), |recipe| {
                recipe.settings.allowance = p95;
            }),
        })
    }
}

/// The text with its first letter large.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    format!("{}{}", first.unwrap_or_default(), letters.as_str())
}
