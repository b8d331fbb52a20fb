//! What is said of the shapes: differences, the kind of deformation, and what only one part has.

use super::partly_met;
use crate::assess::{BentEnd, BorderFit, PartAxis, ShapeKind, ShapeReason, ShapeStatement};
use crate::geometry::Point3;
use crate::text::{Lengths, counted, percent};

impl ShapeReason {
    /// The difference in words, without a capital and a full stop.
    pub fn words(&self, lengths: Lengths) -> String {
        let place = |at: &Point3| lengths.place((*at).into());
        let [by, limit] = match self {
            Self::Bent { by, limit }
            | Self::Surface { by, limit, .. }
            | Self::Local { by, limit, .. }
            | Self::Borders { by, limit, .. }
            | Self::Hole { by, limit, .. } => lengths.compared([*by, *limit]),
            Self::Stretched { by, .. } => [lengths.of(*by), String::new()],
            Self::Outlines { pieces } => [lengths.of(pieces.by), String::new()],
            Self::HardlyMet { .. } | Self::Holes { .. } => [String::new(), String::new()],
        };
        match self {
            Self::HardlyMet { share } => partly_met(*share),
            Self::Bent { .. } => {
                format!("the parts are bent against each other by {by}, more than {limit}")
            }
            Self::Surface { at, .. } => format!(
                "the surfaces differ by {by}, more than {limit}, most at {}",
                place(at)
            ),
            Self::Local { at, is_end, .. } => {
                let what = if *is_end {
                    "an end or a flange that is bent or lies elsewhere"
                } else {
                    "a bead, a step, a dent or a radius that only one part has"
                };
                format!(
                    "the surfaces differ at one place by {by}, more than {limit}, at {}: {what}",
                    place(at)
                )
            }
            Self::Borders { at, .. } => format!(
                "the borders lie {by} apart, more than {limit}, most at {}",
                place(at)
            ),
            Self::Hole { is_mean: true, .. } => {
                format!("all holes are off one way, by {by} in the mean, more than {limit}")
            }
            Self::Hole { at, .. } => {
                format!("a hole is off by {by}, more than {limit}, at {}", place(at))
            }
            Self::Stretched { share, axis, .. } => format!(
                "the stamped part is {} ({by}) {}: another version",
                percent(share.abs()),
                axis.compared(*share > 0.0)
            ),
            Self::Holes {
                only_source,
                only_target,
                at,
            } => format!(
                "holes differ: {only_source} in the stamped part only, {only_target} in the crash \
                 part only, one of them at {}",
                place(at)
            ),
            Self::Outlines { pieces } => format!(
                "outlines differ: {} of sheet in the stamped part only, {} in the crash part only, \
                 the largest {by} beyond the other part at {}: a lug or a notch lies elsewhere",
                counted(pieces.only_source, "piece"),
                counted(pieces.only_target, "piece"),
                place(&pieces.at)
            ),
        }
    }
}

impl PartAxis {
    /// "longer" or "shorter", or what is said of the other axes.
    pub fn compared(self, is_more: bool) -> &'static str {
        match (self, is_more) {
            (Self::Length, true) => "longer",
            (Self::Length, false) => "shorter",
            (Self::Width, true) => "wider",
            (Self::Width, false) => "narrower",
            (Self::Height, true) => "higher",
            (Self::Height, false) => "lower",
        }
    }
}

impl ShapeKind {
    /// The words for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Same => "same surface",
            Self::Deformed => "same part, deformed",
            Self::OtherVersion => "another version of the part",
            Self::Different => "a different part",
        }
    }
}

impl ShapeStatement {
    /// "same part, deformed: bend and twist 0.63 of 5.00 mm, remainder 0.13 of 1.00 mm".
    pub fn words(&self, lengths: Lengths) -> String {
        let is_bent = self.springback.max(self.remainder) > self.tolerance.unremarkable()
            || self.bent_end.is_some();
        let label = match self.kind {
            ShapeKind::Deformed if self.offset.is_some() && !is_bent => "same surface at an offset",
            kind => kind.label(),
        };
        if !self.remainder.is_finite() {
            return label.to_owned();
        }
        let offset = self.offset.map_or_else(String::new, |offset| {
            let removed = if self.is_offset_removed {
                ", taken out of the pose"
            } else {
                ""
            };
            format!(", offset {}{removed}", lengths.of(offset))
        });
        let trim = match (self.borders.other_trim, self.borders.apart) {
            (Some(apart), _) => {
                format!(", trimmed differently, borders {} apart", lengths.of(apart))
            }
            (None, Some(border)) if self.reasons.is_empty() => format!(
                ", trimmed differently at one place, borders {} apart at {}",
                lengths.of(border.by),
                lengths.place(border.at.into())
            ),
            _ => String::new(),
        };
        let end = self
            .bent_end
            .map_or_else(String::new, |BentEnd { by, at }| {
                let by = lengths.within(by, self.tolerance.springback);
                format!(
                    ", an end or a flange bent by {by} at {}",
                    lengths.place(at.into())
                )
            });
        let pieces = self.pieces_of_one_part(lengths);
        let holes = self.holes_of_one_part();
        format!(
            "{label}: bend and twist {}, remainder {}{end}{offset}{trim}{pieces}{holes}",
            lengths.within(self.springback, self.tolerance.springback),
            lengths.within(self.remainder, self.tolerance.remainder)
        )
    }
}

impl ShapeStatement {
    /// ", 1 piece of sheet at the outline in the stamped part only, 12.0 mm beyond the other at (…)" where one part has
    /// a lug that the other lacks, or no notch where the other has one.
    fn pieces_of_one_part(&self, lengths: Lengths) -> String {
        let Some(pieces) = self.borders.pieces else {
            return String::new();
        };
        let Some((n, role)) = of_one_part(pieces.only_source, pieces.only_target) else {
            return String::new();
        };
        format!(
            ", {} of sheet at the outline in the {role} part only, {} beyond the other at {}",
            counted(n, "piece"),
            lengths.of(pieces.by),
            lengths.place(pieces.at.into())
        )
    }

    /// ", 2 holes in the stamped part only" where one part has holes that the other lacks, as before the last piercing,
    /// which is no difference of the shapes.
    fn holes_of_one_part(&self) -> String {
        let BorderFit {
            only_source,
            only_target,
            ..
        } = self.borders;
        let Some((n, role)) = of_one_part(only_source, only_target) else {
            return String::new();
        };
        format!(", {} in the {role} part only", counted(n, "hole"))
    }
}

/// How many of something only one part has, and which part it is; `None` where both have some, or neither.
fn of_one_part(only_source: usize, only_target: usize) -> Option<(usize, &'static str)> {
    match (only_source, only_target) {
        (n @ 1.., 0) => Some((n, "stamped")),
        (0, n @ 1..) => Some((n, "crash")),
        _ => None,
    }
}
