//! Why a match is weak: the likely causes with their evidence, and a remedy for each.

use super::Failure;
use crate::app::parts::together;
use crate::app::{
    Action, AppState, BottomTab, Command, MatchCommand, MatchResult, PartCommand, ViewCommand,
};
use crate::assess::{
    Assessment, Clarity, PoseKind, Reason, ShapeKind, ShapeReason, Twin, Verdict, as_well,
    fit_beside, fit_of_hand,
};
use crate::pipeline::match_parts::MatchRecipe;
use crate::registration::{Hand, Method, StartMethod};
use crate::role::Role;
use crate::text::{capital, length, sentence, whole_percent};

/// Causes that are listed; more would be guessing.
const MOST: usize = 3;
/// Less overlap of the better covered part is little.
const LITTLE_OVERLAP: f64 = 0.6;

/// A likely cause of a weak or failed match.
#[derive(Debug, Clone)]
pub struct Cause {
    /// The cause in a few words.
    pub title: String,
    /// The evidence for it, as a sentence.
    pub evidence: String,
    /// The remedy: the label of its button and what it does.
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
        if let Some(only) = self.only_cause(assessment) {
            return vec![only];
        }
        let is_different = is_different_part(assessment);
        let found = [
            self.parts_together_cause(assessment),
            self.hand_cause(assessment),
            is_different.then(different_cause),
            self.twin_cause(result).filter(|_| !is_different),
            self.freedom_cause(assessment),
            self.overlap_cause(assessment),
            self.shape_cause(assessment),
            self.read_cause(assessment),
        ];
        found.into_iter().flatten().take(MOST).collect()
    }

    /// The cause beside which nothing else that was found means anything: sizes and overlap of several parts say
    /// nothing about the one that is stamped, and parts in different units lie nowhere on each other.
    fn only_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let of_parts = self.parts_cause(assessment);
        of_parts.or_else(|| self.units_cause(assessment))
    }

    /// True where the part of the other hand fits better and can be matched: that comes before all else.
    pub fn is_other_hand_better(&self) -> bool {
        let result = self.document.current_result();
        result.is_some_and(|result| {
            let assessment = &result.run.assessment;
            let mut reasons = assessment.reasons.iter();
            let is_better = reasons.any(|reason| matches!(reason, Reason::OppositeHand { .. }));
            let can_match = || {
                let cause = self.hand_cause(assessment);
                cause.is_some_and(|cause| cause.remedy.is_some())
            };
            is_better && self.only_cause(assessment).is_none() && can_match()
        })
    }

    /// True while it is asked whether the parts are in different units and the match says so too: then
    /// nothing else that it found means anything.
    pub fn is_unit_in_doubt(&self) -> bool {
        let result = self.document.current_result();
        result.is_some_and(|result| {
            let assessment = &result.run.assessment;
            let is_other = assessment.scale_check.unit.is_some() && self.unit_hint().is_some();
            is_other && self.parts_cause(assessment).is_none()
        })
    }

    /// A reason of a verdict as the card says it: beside the figures, which it does not show while the units are in
    /// doubt.
    pub fn reason_words(&self, reason: &Reason) -> String {
        if self.is_unit_in_doubt() {
            reason.words(self.lengths())
        } else {
            reason.words_beside_figures(self.lengths())
        }
    }

    /// Why the last match gave no pose, if these are still its parts.
    pub fn match_failure(&self) -> Option<&str> {
        self.failure().map(|failure| failure.message.as_str())
    }

    fn failure(&self) -> Option<&Failure> {
        self.matching.failure.as_ref()?.current(&self.document)
    }

    /// What to try after a match that gave no pose.
    pub fn failure_causes(&self) -> Vec<Cause> {
        let Some(failure) = self.failure() else {
            return Vec::new();
        };
        if failure.method == Method::Umeyama {
            // It knows neither starts nor contact.
            return vec![Cause {
                title: "Meshes that differ".to_owned(),
                evidence: "Umeyama takes two meshes with the same nodes in the same order."
                    .to_owned(),
                remedy: self.retry("Match with Fractional ICP", |recipe| {
                    recipe.settings.set_method(Method::Fractional);
                }),
            }];
        }
        let units = self.unit_remedy().map(|remedy| Cause {
            title: "Different units".to_owned(),
            evidence: "The sizes of the two files differ by a factor between units.".to_owned(),
            remedy: Some(remedy),
        });
        let starts = Cause {
            title: "Too few start poses".to_owned(),
            evidence: "From no start pose did the parts come into contact.".to_owned(),
            remedy: self.retry("Try all starts", |recipe| {
                recipe.settings.starts.method = StartMethod::All;
            }),
        };
        let by_hand = Cause {
            title: "Parts too far apart".to_owned(),
            evidence: "Three point pairs give a start pose.".to_owned(),
            remedy: self.do_action(Action::PairTool, "Pick point pairs"),
        };
        units.into_iter().chain([starts, by_hand]).collect()
    }

    /// Changes the recipe for these parts and runs again.
    fn retry(
        &self,
        label: &str,
        change: impl FnOnce(&mut MatchRecipe),
    ) -> Option<(String, Vec<Command>)> {
        let mut recipe = self.document.recipe.clone();
        change(&mut recipe);
        let can_match =
            self.can_match().is_ok() && self.document.has_start_pose_of(&recipe).is_ok();
        if recipe == self.document.recipe || !can_match {
            return None;
        }
        let set = MatchCommand::SetRemedy {
            name: label.to_owned(),
            recipe: Box::new(recipe),
            is_matched: true,
        };
        let commands = vec![set.into(), MatchCommand::Run.into()];
        Some((label.to_owned(), commands))
    }

    fn do_action(&self, action: Action, label: &str) -> Option<(String, Vec<Command>)> {
        let commands = action.command(self);
        commands.map(|command| (label.to_owned(), vec![command]))
    }

    fn parts_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let Some(more) = self.more_alike() else {
            return several_parts_cause(assessment);
        };
        let title = more.title(&self.document);
        let evidence = match more.only() {
            Some([_]) => format!("{title} alone is more like the stamped part than all together."),
            Some(_) => format!("{title} alone are more like the stamped part than all together."),
            None => format!(
                "Each of {title} alone is more like the stamped part than all together: choose one."
            ),
        };
        let only = more.only().filter(|_| self.jobs.is_unlocked().is_ok());
        let remedy = only.map(|ids| {
            let commands = vec![PartCommand::UseAlike(0).into()];
            (format!("Match only {}", together(ids)), commands)
        });
        Some(Cause {
            title: matched_as_one(more.n_used),
            evidence,
            remedy,
        })
    }

    /// Crash parts that were chosen together, of which the stamped one covers little.
    fn parts_together_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let n_used = self.document.part(Role::Crash)?.facts.used.len();
        let covered = assessment.coverage.target_on_source.overlap;
        (n_used > 1 && covered < LITTLE_OVERLAP).then(|| Cause {
            title: matched_as_one(n_used),
            evidence: format!(
                "The stamped part covers {} of them: choose in section 1 the part that it belongs to.",
                whole_percent(covered)
            ),
            remedy: None,
        })
    }

    fn units_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let check = &assessment.scale_check;
        let evidence = match (&check.unit, self.unit_hint()) {
            (Some(unit), _) => larger_part(check.size_ratio, unit.times(check.size_ratio)),
            // Among the parts of a whole model sizes say nothing, but the files do.
            (None, Some(hint)) => sentence(&hint.text()),
            (None, None) => {
                let mut reasons = assessment.reasons.iter();
                let far_apart = reasons.find(|reason| reason.is_of_units())?;
                sentence(&far_apart.words(self.lengths()))
            }
        };
        Some(Cause {
            title: "Different units".to_owned(),
            evidence,
            remedy: self.unit_remedy(),
        })
    }

    fn hand_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let fit = assessment.reasons.iter().find_map(|reason| match reason {
            Reason::OppositeHand {
                score_ratio,
                by_borders,
            }
            | Reason::NearMirrorImage {
                score_ratio,
                by_borders,
            } => Some(fit_of_hand(*score_ratio, *by_borders)),
            _ => None,
        })?;
        let hand = self.document.recipe.settings.hand;
        Some(Cause {
            title: "Opposite-hand part".to_owned(),
            evidence: format!("The other hand fits better: {fit}."),
            remedy: self.retry("Match the opposite hand", |recipe| {
                recipe.settings.hand = match hand {
                    Hand::Mirrored => Hand::Same,
                    Hand::Same | Hand::Either => Hand::Mirrored,
                };
            }),
        })
    }

    /// Beside an alternative that is shown the other pose is the best one.
    fn twin_cause(&self, result: &MatchResult) -> Option<Cause> {
        let run = &result.run;
        let ambiguity = &run.assessment.ambiguity;
        if ambiguity.clarity == Clarity::Clear {
            return None;
        }
        let (twin, ratio, by_shape, remedy) = if let Some(index) = result.alternative {
            let shown = run.outcome.alternatives.get(index)?;
            let source = &self.document.part(Role::Stamped)?.loaded.surface;
            let twin = Twin::of(source, &shown.target_from_source, &run.crash_from_stamped);
            let back = MatchCommand::ShowAlternative(None);
            let remedy = ("Show the best pose".to_owned(), vec![back.into()]);
            let is_possible = Action::NextAlternative.enabled(self).is_ok();
            let remedy = is_possible.then_some(remedy);
            (
                Some(twin),
                shown.score_ratio.recip(),
                shown.by_shape,
                remedy,
            )
        } else {
            let remedy = self.do_action(Action::NextAlternative, "Show the other pose");
            let ratio = ambiguity.ratio.unwrap_or(1.0);
            (ambiguity.twin, ratio, ambiguity.by_shape, remedy)
        };
        let how = twin.map(|twin| twin.words(self.lengths()));
        let well = as_well(ratio);
        Some(Cause {
            title: "Ambiguous pose".to_owned(),
            evidence: format!(
                "{}, the part fits {well} ({}): check holes and beads.",
                capital(how.as_deref().unwrap_or("in another pose")),
                fit_beside(ratio, by_shape)
            ),
            remedy,
        })
    }

    fn freedom_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let motion = assessment.open_motion()?;
        Some(Cause {
            title: "Sliding possible".to_owned(),
            evidence: sentence(&motion.words()),
            remedy: self.do_action(Action::PairTool, "Pick point pairs"),
        })
    }

    fn overlap_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let coverage = &assessment.coverage;
        let overlap = coverage.better_overlap();
        (overlap < LITTLE_OVERLAP).then(|| Cause {
            title: "Wrong location".to_owned(),
            evidence: format!(
                "Only {} of the better covered part lies within {} of the other.",
                whole_percent(overlap),
                self.lengths().of(coverage.limit)
            ),
            remedy: self
                .retry("Try all starts", |recipe| {
                    recipe.settings.starts.method = StartMethod::All;
                })
                .or_else(|| self.do_action(Action::PairTool, "Pick point pairs")),
        })
    }

    fn shape_cause(&self, assessment: &Assessment) -> Option<Cause> {
        if assessment.coverage.better_overlap() < LITTLE_OVERLAP || is_different_part(assessment) {
            // What lies elsewhere is not bent, nor is another part.
            return None;
        }
        let differ = assessment.reasons.iter().find_map(|reason| match reason {
            Reason::Shape {
                difference: ShapeReason::Surface { by, .. } | ShapeReason::Bent { by, .. },
            } => Some(*by),
            _ => None,
        });
        let by = differ?;
        let mut evidence = format!(
            "At 95 % of the area the surfaces differ by up to {}, more than the tolerance.",
            self.lengths().of(by)
        );
        let pose = assessment.pose.as_ref();
        let is_found = pose.is_none_or(|pose| pose.kind <= PoseKind::Uncertain);
        if !is_found {
            evidence += " Another part or a wrong pose looks alike, and the pose is not clear.";
        }
        Some(Cause {
            title: "Springback or another forming state".to_owned(),
            evidence,
            // A wider tolerance does not make a pose the right one.
            remedy: is_found.then(|| self.allow(by)),
        })
    }

    fn read_cause(&self, assessment: &Assessment) -> Option<Cause> {
        let is_one = |reason: &&Reason| matches!(reason, Reason::ReadErrors { .. });
        let reason = assessment.reasons.iter().find(is_one)?;
        let tab = ViewCommand::SetTab(BottomTab::Diagnostics);
        Some(Cause {
            title: "Read errors".to_owned(),
            evidence: sentence(&reason.words(self.lengths())),
            remedy: Some(("Show diagnostics".to_owned(), vec![tab.into()])),
        })
    }

    /// A shape tolerance that accepts a difference; the verdict follows it at once.
    fn allow(&self, by: f64) -> (String, Vec<Command>) {
        let digit = 10f64.powf(by.log10().floor() - 1.0);
        let tolerance = (by / digit).ceil() * digit;
        let mut recipe = self.document.recipe.clone();
        recipe.settings.shape_tolerance = tolerance;
        let label = format!("Allow {}", self.lengths().of(tolerance));
        let set = MatchCommand::SetRemedy {
            name: label.clone(),
            recipe: Box::new(recipe),
            is_matched: false,
        };
        (label, vec![set.into()])
    }
}

fn is_different_part(assessment: &Assessment) -> bool {
    let shape = assessment.shape.as_ref();
    shape.is_some_and(|shape| shape.kind == ShapeKind::Different)
}

/// Of two different parts no other pose, and no other tolerance, is worth a look.
fn different_cause() -> Cause {
    Cause {
        title: "A different part".to_owned(),
        evidence: "The shapes differ by more than springback or another version of the part: check that both files \
                   hold the same part."
            .to_owned(),
        remedy: None,
    }
}

/// Which part is so many times as large, from the size of the crash part over that of the stamped one.
fn larger_part(size_ratio: f64, times: f64) -> String {
    let [larger, other] = if size_ratio < 1.0 {
        ["stamped", "crash"]
    } else {
        ["crash", "stamped"]
    };
    format!(
        "The {larger} part is {} times as large as the {other} part.",
        length(times)
    )
}

/// What is wrong where all parts of a crash model are matched together.
fn matched_as_one(n_parts: usize) -> String {
    format!("{n_parts} crash parts are matched as one")
}

/// Several crash parts none of which is more like the stamped part: which it is only the user knows.
fn several_parts_cause(assessment: &Assessment) -> Option<Cause> {
    assessment.reasons.iter().find_map(|reason| match reason {
        Reason::SeveralParts { n_parts, .. } => Some(Cause {
            title: matched_as_one(*n_parts),
            evidence: "Choose in section 1 the part that the stamped one belongs to.".to_owned(),
            remedy: None,
        }),
        _ => None,
    })
}
