//! The report of a match as one file that needs nothing else: pictures, charts and tables inside it,
//! for the screen in both themes, for narrow windows and for paper. Works without its script.

mod car_page;
mod charts;
mod map_page;
mod page;
mod pose_section;
mod sections;
mod tables;

use maud::html;

pub use car_page::CarReport;
pub use map_page::{CheckReport, FilesReport, MapReport, NumberRow, QuantityReport, map_figure};

use self::page::{document, printable};
use super::MatchRecord;
use crate::assess::deviation::Deviation;
use crate::colormap::ColorScale;
use crate::registration::{MatchOutcome, StartGroup};
use crate::text::Lengths;

/// A picture with its words.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The picture as the bytes of a PNG file.
    pub png: Vec<u8>,
    /// Pixels to each side.
    pub size: [usize; 2],
    /// What it shows, for those who cannot see it.
    pub alt: String,
    /// Title, in bold.
    pub title: String,
    /// The sentence below.
    pub caption: String,
    /// True if a ring marks the middle.
    pub is_marked: bool,
}

/// The pictures of a report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figures {
    /// Each part by itself, in its own frame.
    pub parts: Vec<Figure>,
    /// Both parts at the pose.
    pub overlays: Vec<Figure>,
    /// How far the pose may be off, on the stamped part.
    pub uncertainty: Vec<Figure>,
    /// Both parts at each pose that fits nearly as well.
    pub rivals: Vec<Figure>,
    /// The deviation of the stamped part.
    pub maps: Vec<Figure>,
    /// The worst places from near.
    pub spots: Vec<Figure>,
    /// One small picture for each group of starts.
    pub starts: Vec<Figure>,
}

/// Cards, or why there are none.
#[derive(Debug, Clone, PartialEq)]
pub struct CardsInfo {
    /// Keyword of the cards.
    pub name: &'static str,
    /// The text and the largest error that its rounding makes at a node, or why it cannot be written.
    pub text: Result<(String, f64), String>,
}

/// Everything the report shows.
#[derive(Debug, Clone, Copy)]
pub struct Report<'a> {
    /// Matrix, verdict, settings, times, files.
    pub record: &'a MatchRecord,
    /// Starts and iterations.
    pub outcome: &'a MatchOutcome,
    /// Starts by where they ended.
    pub groups: &'a [StartGroup],
    /// How far the best start of each group ended from the result: millimetres or whatever the unit of
    /// the centre, and degrees.
    pub group_distances: &'a [(f64, f64)],
    /// Distances of all nodes.
    pub deviation: &'a Deviation,
    /// The colours of the map.
    pub scale: ColorScale,
    /// The colours of the uncertainty, where there is one.
    pub uncertainty_scale: Option<ColorScale>,
    /// Pictures of the page.
    pub figures: &'a Figures,
    /// LS-DYNA cards.
    pub cards: &'a [CardsInfo],
}

impl Report<'_> {
    /// The whole page as HTML.
    pub fn write(&self) -> String {
        let record = self.record;
        let names = record.files.as_ref().map(|file| printable(&file.name));
        let title = html! { (names.stamped) " on " (names.crash) ": " (record.verdict.label()) };
        let body = html! {
            (self.header())
            main { (self.main()) }
            (self.footer())
        };
        document(&title, &record.build, &body)
    }

    fn lengths(&self) -> Lengths {
        Lengths::new(self.record.units.length)
    }
}
