//! How far the pose may be off, and which others fit nearly as well.

use maud::{Markup, html};

use super::page::{folded, printable};
use super::sections::pictures;
use super::{Report, charts};
use crate::assess::{PoseUncertainty, Reason};
use crate::report::MatrixForm;
use crate::text::{parts_by_id, vector};

impl Report<'_> {
    /// The section about the pose.
    pub(super) fn pose_section(&self) -> Markup {
        html! {
            @if let Some(stated) = &self.record.pose_uncertainty {
                (self.uncertainty(stated))
            }
            h3 { "Poses that fit nearly as well" }
            @if let Some(ids) = Reason::alike_parts(&self.record.reason_details) {
                p {
                    "On other crash parts: the stamped part fits " (parts_by_id(ids)) " about as well. On the crash \
                     part of this report:"
                }
            }
            @if self.figures.rivals.is_empty() {
                p { (self.no_rivals()) }
            } @else {
                (pictures(&self.figures.rivals))
                @for (index, title) in self.rival_titles().enumerate() {
                    (folded(&title, &self.rival_matrix(index)))
                }
            }
        }
    }

    fn uncertainty(&self, stated: &PoseUncertainty) -> Markup {
        let lengths = self.lengths();
        html! {
            h3 { "How far it may be off" }
            p {
                "At no node of the stamped part by more than about ± " (lengths.of(stated.largest))
                ", " (stated.along.words()) " (direction " (vector(stated.direction.into(), 3))
                "), there at " (vector(stated.place.into(), 1))
                ". Each patch of the part in turn was left out and the pose found again; a wholly \
                 different pose would not show here."
                @if let Some(words) = stated.words_of_unknown_offset(lengths) {
                    " Through the sheet, " (words) "."
                }
            }
            (pictures(&self.figures.uncertainty))
            @if let Some(scale) = &self.uncertainty_scale {
                div.scale { (charts::plain_legend(scale, &lengths.axis("the pose may be off by")) ) }
            }
        }
    }

    /// "None" only where rivals were sought.
    fn no_rivals(&self) -> &'static str {
        if self.outcome.rivals_sought {
            "None: half turns, places shaped alike and all that the wide search left were tried on the \
             result on the full meshes."
        } else {
            "Not known: other poses were not looked for everywhere."
        }
    }

    fn rival_titles(&self) -> impl Iterator<Item = String> {
        let titles = self.figures.rivals.iter();
        titles.map(|figure| format!("Matrix of pose {}", printable(&figure.title)))
    }

    fn rival_matrix(&self, index: usize) -> String {
        let other = self.outcome.alternatives.get(index);
        other.map_or_else(String::new, |other| {
            MatrixForm::Rows.write(&other.target_from_source)
        })
    }
}
