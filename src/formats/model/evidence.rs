//! What in a file speaks for the end of a forming simulation.

use super::Model;

/// What in a file speaks for the end of a forming simulation, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FormingEvidence {
    /// Nothing.
    None,
    /// It is one part with a thickness for each element.
    ThicknessPerElement,
    /// It has stresses or strains.
    Results,
}

impl FormingEvidence {
    /// What the file carries; of a whole crash deck some parts may have a thickness for each element too.
    pub fn of(model: &Model) -> Self {
        if !model.forming.is_empty() {
            Self::Results
        } else if model.parts.len() == 1 && model.has_results() {
            Self::ThicknessPerElement
        } else {
            Self::None
        }
    }

    /// What the file carries, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::None => "no forming results",
            Self::ThicknessPerElement => "a thickness for each element",
            Self::Results => "forming results",
        }
    }
}

/// What the first of two files carries if they were probably named in the other order: the second one carries no
/// results of forming at all. `None` where their contents do not say so.
pub fn other_order(crash: &Model, stamped: &Model) -> Option<FormingEvidence> {
    let carries = FormingEvidence::of(crash);
    (carries > FormingEvidence::None && !stamped.has_results()).then_some(carries)
}
