//! Where the pose comes from that a mapping was made at: values at a wrong pose look as good as any.

use serde::Serialize;

use super::place::pose_warning;
use crate::assess::Verdict;
use crate::role::{PerRole, Role};
use crate::text::Lengths;

/// Where the pose of a stamped part comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case", tag = "from")]
pub enum PoseOrigin {
    /// It was given with the task, and nothing more is known of it.
    #[default]
    Given,
    /// A match found it.
    Match {
        /// What the match said of it.
        verdict: Verdict,
    },
    /// A match found it, and another one that fits better.
    Alternative,
    /// It was moved by hand from where a match had put it.
    Moved {
        /// How far the corner of the part's box that moved farthest.
        distance: f64,
        /// What the match said of its own pose.
        verdict: Verdict,
    },
    /// A match found it, for parts of which one has changed since.
    Outdated {
        /// What has changed.
        changed: ChangedParts,
        /// How far the part was moved by hand from where the match had put it, if it was.
        distance: Option<f64>,
        /// What the match said of the parts as they were.
        verdict: Verdict,
    },
    /// It was put there by hand, without a match.
    ByHand,
    /// It lies where its file has it.
    AsLoaded,
}

/// Which parts were read or chosen anew after a match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangedParts {
    /// The crash part alone.
    Crash,
    /// The stamped part alone.
    Stamped,
    /// Both parts.
    Both,
}

impl ChangedParts {
    /// Those that are not the same any more; `None` if all are.
    pub fn of(is_same: PerRole<bool>) -> Option<Self> {
        match (is_same.crash, is_same.stamped) {
            (true, true) => None,
            (false, true) => Some(Self::Crash),
            (true, false) => Some(Self::Stamped),
            (false, false) => Some(Self::Both),
        }
    }

    /// "the crash part".
    fn words(self) -> String {
        match self {
            Self::Crash => format!("the {} part", Role::Crash.word()),
            Self::Stamped => format!("the {} part", Role::Stamped.word()),
            Self::Both => "both parts".to_owned(),
        }
    }
}

impl PoseOrigin {
    /// Whether a match stands for the pose; `None` for one that was given.
    pub fn is_good(&self) -> Option<bool> {
        match self {
            Self::Given => None,
            Self::Match { verdict } => Some(*verdict == Verdict::Good),
            Self::Alternative
            | Self::Moved { .. }
            | Self::Outdated { .. }
            | Self::ByHand
            | Self::AsLoaded => Some(false),
        }
    }

    /// "moved by hand, 5.00 mm from the match (GOOD)".
    pub fn words(&self, lengths: Lengths) -> String {
        match self {
            Self::Given => "given".to_owned(),
            Self::Match { verdict } => format!("{} match", verdict.label()),
            Self::Alternative => "an alternative of the match".to_owned(),
            Self::Moved { distance, verdict } => format!(
                "moved by hand, {} from the match ({})",
                lengths.of(*distance),
                verdict.label()
            ),
            Self::Outdated {
                changed,
                distance,
                verdict,
            } => {
                let moved = distance.map_or_else(String::new, |distance| {
                    format!("moved by hand, {} ", lengths.of(distance))
                });
                format!(
                    "{moved}from the match before {} changed ({})",
                    changed.words(),
                    verdict.label()
                )
            }
            Self::ByHand => "placed by hand, no match".to_owned(),
            Self::AsLoaded => "as loaded, no match".to_owned(),
        }
    }

    /// The most doubtful of the poses of these files, the first of equal ones, by its place and in words: "b.k: POOR
    /// match". One that is as good as all others names no file.
    pub fn most_doubtful(files: &[(String, Self)], lengths: Lengths) -> Option<(usize, String)> {
        // The last of the largest is taken.
        let most = (0..files.len()).rev().max_by_key(|&n| files[n].1.doubt())?;
        let (name, origin) = &files[most];
        let words = origin.words(lengths);
        let is_named = files.len() > 1 && origin.is_good() != Some(true);
        let words = if is_named {
            format!("{name}: {words}")
        } else {
            words
        };
        Some((most, words))
    }

    /// What is to be told before the mapping is used; `None` if nothing is.
    pub(super) fn warning(&self, file: &str, lengths: Lengths) -> Option<String> {
        match self {
            Self::Given => None,
            Self::Match { verdict } => pose_warning(*verdict, file),
            Self::Alternative
            | Self::Moved { .. }
            | Self::Outdated { .. }
            | Self::ByHand
            | Self::AsLoaded => Some(format!("the pose of {file}: {}", self.words(lengths))),
        }
    }

    /// How little is to be said for the pose, the best first.
    fn doubt(&self) -> u8 {
        match self {
            Self::Match {
                verdict: Verdict::Good,
            } => 0,
            Self::Given => 1,
            Self::Match {
                verdict: Verdict::Check,
            } => 2,
            Self::Alternative => 3,
            Self::Moved { .. } => 4,
            Self::Outdated { .. } => 5,
            Self::Match {
                verdict: Verdict::Poor,
            } => 6,
            Self::ByHand => 7,
            Self::AsLoaded => 8,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::LengthUnit;

    #[test]
    fn of_several_files_the_most_doubtful_is_named() {
        use Verdict::{Good, Poor};
        let of = |verdicts: &[Verdict]| {
            let names = ["a.k", "b.k", "c.k"].map(str::to_owned).into_iter();
            let poses = verdicts
                .iter()
                .map(|&verdict| PoseOrigin::Match { verdict });
            let files: Vec<_> = names.zip(poses).collect();
            PoseOrigin::most_doubtful(&files, Lengths::new(None)).map(|(_, words)| words)
        };
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[Poor]).as_deref(), Some("POOR match"));
        assert_eq!(of(&[Good, Poor, Good]).as_deref(), Some("b.k: POOR match"));
        assert_eq!(of(&[Good, Good]).as_deref(), Some("GOOD match"));
    }

    #[test]
    fn only_a_good_match_stands_for_a_pose() {
        let of = |verdict| PoseOrigin::Match { verdict };
        assert_eq!(of(Verdict::Good).is_good(), Some(true));
        assert_eq!(of(Verdict::Check).is_good(), Some(false));
        assert_eq!(PoseOrigin::Given.is_good(), None);
        let moved = PoseOrigin::Moved {
            distance: 5.0,
            verdict: Verdict::Good,
        };
        assert_eq!(moved.is_good(), Some(false));
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        let words = "moved by hand, 5.00 mm from the match (GOOD)";
        assert_eq!(moved.words(lengths), words);
        let warning = moved.warning("a.k", lengths);
        assert_eq!(warning, Some(format!("the pose of a.k: {words}")));
        assert_eq!(of(Verdict::Good).warning("a.k", lengths), None);
    }

    #[test]
    fn a_match_of_parts_that_have_changed_stands_for_no_pose() {
        let of = |crash, stamped, distance| {
            let changed = ChangedParts::of(PerRole { crash, stamped })?;
            let verdict = Verdict::Good;
            Some(PoseOrigin::Outdated {
                changed,
                distance,
                verdict,
            })
        };
        assert_eq!(of(true, true, None), None);
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        let words = |origin: Option<PoseOrigin>| origin.map(|origin| origin.words(lengths));
        assert_eq!(
            words(of(false, true, None)).as_deref(),
            Some("from the match before the crash part changed (GOOD)")
        );
        assert_eq!(
            words(of(false, false, Some(5.0))).as_deref(),
            Some("moved by hand, 5.00 mm from the match before both parts changed (GOOD)")
        );
        let origin = of(true, false, None).expect("one has changed");
        assert_eq!(origin.is_good(), Some(false));
        assert!(origin.warning("a.k", lengths).is_some());
    }
}
