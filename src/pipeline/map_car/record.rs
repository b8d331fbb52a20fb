//! What became of each stamped part of a car: rows for tables, pages and JSON.

use std::path::Path;

use serde::Serialize;

use crate::assess::Verdict;
use crate::pipeline::names::file_name;
use crate::pipeline::tools::tools_line;
use crate::registration::UnitGuess;
use crate::text::{counted, fixed, length, parts_by_id, percent};

/// How certain it is that a stamped part lies where it belongs, with all its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CarState {
    /// One crash part fits, and it has values.
    Sure,
    /// Mapped; the reasons say what to look at.
    Check,
    /// Nothing was mapped from it.
    None,
}

impl CarState {
    /// The word for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Sure => "sure",
            Self::Check => "check",
            Self::None => "not mapped",
        }
    }
}

/// Why a stamped part is not sure.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CarReason {
    /// It cannot be read or mapped.
    Failed(String),
    /// It is the crash model.
    SameFile,
    /// No crash part fits.
    NoPart,
    /// One would if the files were in these units.
    OtherUnit(UnitGuess),
    /// The verdict of the match is no better than CHECK.
    Pose,
    /// What the match says against it first.
    Match(String),
    /// It fits these crash parts about as well.
    Rivals(Vec<u64>),
    /// Another stamped part lies on this share of the same area.
    Conflict(f64),
    /// Its mirror image lies on most of what it leaves of the crash part, in the pose with these rows.
    MirrorImage([[f64; 4]; 4]),
    /// Another stamped part lies in its place and fits better.
    Displaced,
    /// No element takes its values: others lie there that are as near.
    GivesNothing,
    /// The crash part it belongs to is not there: it fits these, which are shaped differently, about as badly.
    Absent(Vec<u64>),
    /// It is so many times as thick as the first of these.
    Gauge(f64),
    /// The crash part is perhaps not there: the surfaces differ by so many tolerances.
    Doubtful(f64),
    /// Only this share of the area has values.
    Area(f64),
    /// The mapped thickness is so many times the section's.
    Thickness(f64),
    /// So many elements have initial stresses or strains in the crash deck already, which are not replaced.
    OldStates(usize),
    /// A card of the crash deck lets the solver map onto the crash part too.
    MappedBySolver(String),
    /// Something in its file could not be read, or is perhaps not as it was meant.
    Unread(String),
    /// Elements with other values have no thickness or no stresses.
    Bare(String),
}

impl CarReason {
    /// The reason as words for people.
    pub fn text(&self) -> String {
        match self {
            Self::Failed(text)
            | Self::Match(text)
            | Self::MappedBySolver(text)
            | Self::Unread(text)
            | Self::Bare(text) => text.clone(),
            Self::SameFile => {
                "this is the crash model itself: both files have the same content".to_owned()
            }
            Self::NoPart => "no part of the crash model fits".to_owned(),
            Self::OtherUnit(unit) => format!(
                "one would if the stamped part is in {} and the crash part in {} (--stamped-length-factor {})",
                unit.source.plural(),
                unit.target.plural(),
                unit.factor()
            ),
            Self::Pose => "the pose needs a look".to_owned(),
            Self::Rivals(ids) => format!("fits {} about as well", parts_by_id(ids)),
            Self::Conflict(share) => {
                format!(
                    "another stamped part lies on {} of the area too",
                    percent(*share)
                )
            }
            Self::MirrorImage(_) => {
                "its mirror image lies on the rest: shapematch map takes the file twice, with \
                                     its pose and the mirrored one (--pose, both are in --json)"
                    .to_owned()
            }
            Self::Displaced => "another stamped part lies there and fits better".to_owned(),
            Self::GivesNothing => {
                "no element takes its values: another stamped part lies there as well".to_owned()
            }
            Self::Absent(ids) => format!(
                "its crash part does not seem to be there: it fits {}, which differ in shape, about as badly \
                 (shapematch map with --crash-part maps it all the same)",
                parts_by_id(ids)
            ),
            Self::Gauge(ratio) => format!("it is {} times as thick as the first", length(*ratio)),
            Self::Doubtful(times) => format!(
                "its crash part may not be there: the surfaces differ by {} times what is accepted",
                fixed(*times, 1)
            ),
            Self::Area(share) => format!("{} of the area has values", percent(*share)),
            Self::Thickness(ratio) => {
                format!(
                    "the mapped thickness is {} times the section's",
                    length(*ratio)
                )
            }
            Self::OldStates(n) => format!(
                "{} in the crash deck would count beside the mapped ones (--replace-states yes writes it \
                 without them)",
                counted(*n, "initial state")
            ),
        }
    }
}

/// What became of one stamped part.
#[derive(Debug, Clone, Serialize)]
pub struct CarRow {
    /// The stamped file.
    pub file: String,
    /// How tables name it.
    #[serde(skip)]
    pub(super) name: String,
    /// Whether to look at it.
    pub state: CarState,
    /// Why.
    pub reasons: Vec<CarReason>,
    /// Ids of its parts that are left out as tools of the forming simulation.
    pub tools_left_out: Vec<u64>,
    /// Ids of the crash parts it belongs to.
    pub crash_parts: Vec<u64>,
    /// Their titles, each once.
    pub title: String,
    /// Rows of the 4×4 matrix of its pose.
    pub crash_from_stamped: Option<[[f64; 4]; 4]>,
    /// The verdict of its match.
    pub verdict: Option<Verdict>,
    /// Root mean square distance of the surfaces.
    pub rms: Option<f64>,
    /// Share of the crash parts' area that takes its values from it.
    pub mapped_area: Option<f64>,
    /// Mean thickness that it gives the crash parts.
    pub thickness: Option<f64>,
    /// Names of the files with its values, and with those of other stamped parts on the same crash parts.
    pub files: Vec<String>,
    /// Name of its page, if one was written.
    pub page: Option<String>,
}

impl CarRow {
    pub(super) fn new(file: &Path) -> Self {
        Self {
            file: file.display().to_string(),
            name: file_name(file),
            state: CarState::None,
            reasons: Vec::new(),
            tools_left_out: Vec::new(),
            crash_parts: Vec::new(),
            title: String::new(),
            crash_from_stamped: None,
            verdict: None,
            rms: None,
            mapped_area: None,
            thickness: None,
            files: Vec::new(),
            page: None,
        }
    }

    /// Says which of its parts are left out as tools; `None` if none are.
    pub fn tools_line(&self) -> Option<String> {
        tools_line(&self.name, &self.tools_left_out)
    }

    /// Cells of a table: file, crash part, state, verdict, RMS, mapped area, thickness, reasons.
    pub fn cells(&self) -> [String; 8] {
        let ids: Vec<String> = self.crash_parts.iter().map(u64::to_string).collect();
        let reasons: Vec<String> = self.reasons.iter().map(CarReason::text).collect();
        let or_blank = |cell: Option<String>| cell.unwrap_or_default();
        [
            self.name.clone(),
            format!("{} {}", ids.join(", "), self.title)
                .trim()
                .to_owned(),
            self.state.label().to_owned(),
            or_blank(self.verdict.map(|verdict| verdict.label().to_owned())),
            or_blank(self.rms.map(length)),
            or_blank(self.mapped_area.map(percent)),
            or_blank(self.thickness.map(length)),
            reasons.join("; "),
        ]
    }
}

/// Names files of one name by their paths.
pub(super) fn tell_apart(rows: &mut [CarRow]) {
    let names: Vec<String> = rows.iter().map(|row| row.name.clone()).collect();
    for row in rows {
        if names.iter().filter(|name| **name == row.name).count() > 1 {
            row.name.clone_from(&row.file);
        }
    }
}

/// Heads of [`CarRow::cells`].
pub const CAR_COLUMNS: [&str; 8] = [
    "Stamped part",
    "Crash part",
    "State",
    "Pose",
    "RMS",
    "Area",
    "Thickness",
    "Look at",
];

/// The result for a whole car.
#[derive(Debug, Clone, Serialize)]
pub struct CarRecord {
    /// Which program made it.
    pub build: String,
    /// Version of this layout.
    pub schema: &'static str,
    /// What the matrices mean.
    pub direction: String,
    /// The crash deck.
    pub crash: String,
    /// What became of each stamped part, in the order they were named.
    pub rows: Vec<CarRow>,
    /// Copies of files of the crash deck without the states that were replaced.
    pub copies: Vec<CarCopy>,
}

/// A copy of a file of the crash deck.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CarCopy {
    /// Its name in the folder.
    pub file: String,
    /// The file whose place it takes.
    pub replaces: String,
}

impl CarCopy {
    /// What it is for, in words.
    pub fn text(&self) -> String {
        let Self { file, replaces } = self;
        format!(
            "{file} takes the place of {replaces}: it is without the initial states that are replaced"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_one_name_are_told_apart() {
        let paths = ["left/door.k", "right/door.k", "left/sill.k"];
        let mut rows = paths.map(|path| CarRow::new(Path::new(path)));
        tell_apart(&mut rows);
        let names = rows.map(|row| row.cells()[0].clone());
        assert_eq!(names, ["left/door.k", "right/door.k", "sill.k"]);
    }
}
