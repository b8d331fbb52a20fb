//! Results of a forming simulation: `*INITIAL_STRESS_SHELL` and `*INITIAL_STRAIN_SHELL`, also for
//! sets; those of solids and thick shells are read past and counted.

mod cards;
mod checks;
mod lines;

use std::iter::Peekable;
use std::sync::Arc;

pub use self::cards::ResultCards;
pub(crate) use self::cards::result_cards;
use self::lines::{LARGE, Lines, SMALL, SMALL_TENSOR};
use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Forming, StrainPoint, StressPoint};
use super::block::{Block, Cards, next_line};
use super::card::{Card, EIGHT_BY_10, FieldError};
use super::nodes::shifted;
use super::resolve::with_position;
use super::source_file::{Place, SourceFile};
use crate::geometry::tensor::Tensor;
use crate::monitor::Monitor;

/// More points or history variables than any solver writes for one shell; such a count means that
/// the cards are out of step.
const MAX_COUNT: i64 = 10_000;
/// Elements that are read between two questions to the monitor.
const CHECKED_AFTER: usize = 1024;

/// What an include does to the results in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ResultUnits {
    /// Added to element ids.
    pub element: i64,
    /// Added to set ids.
    pub set: i64,
    /// Factor on stresses: mass / (length · time²).
    pub stress: f64,
}

/// Results as the blocks have them.
#[derive(Debug, Default)]
pub(crate) struct RawForming {
    /// Results of single shells.
    pub of_shells: Forming,
    /// Results for all shells of a set; the set's id stands in place of the element's.
    pub of_sets: Forming,
    /// Where the results of sets begin, stresses and strains each in the order of the file.
    pub stress_places: Vec<Place>,
    pub strain_places: Vec<Place>,
    /// The same of those of single shells.
    pub shell_stress_places: Vec<Place>,
    pub shell_strain_places: Vec<Place>,
}

/// The forms of results that are understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Results {
    Stress,
    Strain,
    SetStress,
    SetStrain,
    SolidStress,
    SolidStrain,
    ThickShellStress,
    ThickShellStrain,
}

impl Results {
    fn of_keyword(name: &str) -> Option<Self> {
        Some(match name.strip_prefix("INITIAL_")? {
            "STRESS_SHELL" => Self::Stress,
            "STRAIN_SHELL" => Self::Strain,
            "STRESS_SHELL_SET" => Self::SetStress,
            "STRAIN_SHELL_SET" => Self::SetStrain,
            "STRESS_SOLID" => Self::SolidStress,
            "STRAIN_SOLID" => Self::SolidStrain,
            "STRESS_TSHELL" => Self::ThickShellStress,
            "STRAIN_TSHELL" => Self::ThickShellStrain,
            _ => return None,
        })
    }
}

/// Reads one `*INITIAL_STRESS_…` or `*INITIAL_STRAIN_…` block. Results of beams and others that
/// are not understood are named and left out. An element that cannot be read is named and left
/// out; counts that make no sense end the block, and so does a cancel request.
pub(crate) fn read_block(
    file: &Arc<SourceFile>,
    block: &Block<'_>,
    units: ResultUnits,
    into: &mut RawForming,
    diagnostics: &mut Diagnostics,
    monitor: &Monitor,
) {
    let Some(results) = Results::of_keyword(&block.name) else {
        if is_forming(&block.name) {
            let kind = DiagnosticKind::Unsupported;
            let message = || format!("the results in *{} are left out", block.name);
            diagnostics.push_with(kind, || block.diagnose(kind, message()));
        }
        return;
    };
    let mut reader = Reader::new(block, units, diagnostics);
    let mut n_read = 0_usize;
    while let Some(card) = reader.next_card() {
        n_read += 1;
        if n_read.is_multiple_of(CHECKED_AFTER) && monitor.check().is_err() {
            return;
        }
        if card.is_blank() {
            continue;
        }
        let others = &mut into.of_shells.others;
        let read = match results {
            Results::Stress => reader.stress(&card, units.element, &mut into.of_shells),
            Results::Strain => reader.strain(&card, units.element, &mut into.of_shells),
            Results::SetStress => reader.stress(&card, units.set, &mut into.of_sets),
            Results::SetStrain => reader.strain(&card, units.set, &mut into.of_sets),
            Results::SolidStress => reader.solid_stress(&card, &mut others.solid_stress),
            Results::SolidStrain => reader.tensors(&card, 1, &mut others.solid_strain),
            Results::ThickShellStress => {
                reader.thick_shell_stress(&card, &mut others.thick_shell_stress)
            }
            Results::ThickShellStrain => reader.tensors(&card, 2, &mut others.thick_shell_strain),
        };
        let place = || Place::new(file, card.offset());
        into.stress_places
            .resize_with(into.of_sets.n_stress(), place);
        into.strain_places
            .resize_with(into.of_sets.n_strain(), place);
        into.shell_stress_places
            .resize_with(into.of_shells.n_stress(), place);
        into.shell_strain_places
            .resize_with(into.of_shells.n_strain(), place);
        if let Err(Stop) = read {
            reader.tell_rest();
            return;
        }
    }
}

/// True for keywords that carry results of an earlier simulation.
pub(crate) fn is_forming(name: &str) -> bool {
    name.starts_with("INITIAL_STRESS_") || name.starts_with("INITIAL_STRAIN_")
}

/// The cards are out of step and the rest of the block cannot be read.
struct Stop;

struct Reader<'a, 'd> {
    block: &'a Block<'a>,
    cards: Peekable<Cards<'a>>,
    units: ResultUnits,
    diagnostics: &'d mut Diagnostics,
    /// Values of the element at hand.
    values: Vec<f64>,
    /// The first card of the element at hand.
    head: Option<Card<'a>>,
    /// Values that the last line holds beyond those that were asked for.
    beyond: Vec<f64>,
    /// The first unreadable field of the element at hand.
    bad_field: Option<FieldError>,
    /// Where the line after the last card begins.
    after: usize,
}

/// True for what the first card of an element looks like: whole numbers, an id first.
fn is_head(card: &Card<'_>) -> bool {
    let is_whole = |i: usize| {
        let text = card.field(EIGHT_BY_10, i).text;
        let digits = text.strip_prefix(b"-").unwrap_or(text);
        digits.iter().all(u8::is_ascii_digit)
    };
    let n_fields = card.n_fields(EIGHT_BY_10[0]).min(EIGHT_BY_10.len());
    (0..n_fields).all(is_whole) && card.id(EIGHT_BY_10, 0).is_ok_and(|id| id > 0)
}

impl<'a, 'd> Reader<'a, 'd> {
    fn new(block: &'a Block<'a>, units: ResultUnits, diagnostics: &'d mut Diagnostics) -> Self {
        Self {
            block,
            cards: block.cards().peekable(),
            units,
            diagnostics,
            values: Vec::new(),
            beyond: Vec::new(),
            head: None,
            bad_field: None,
            after: block.body.start,
        }
    }

    fn next_card(&mut self) -> Option<Card<'a>> {
        let card = self.cards.next()?;
        let (bytes, end) = (self.block.file.bytes(), self.block.body.end);
        self.after = next_line(bytes, card.offset(), end).map_or(end, |(_, _, next)| next);
        Some(card)
    }

    fn stress(&mut self, head: &Card<'a>, offset: i64, into: &mut Forming) -> Result<(), Stop> {
        let [
            id,
            n_plane,
            n_thick,
            n_history,
            n_tensor,
            large,
            n_thermal_points,
            n_thermal,
        ] = self.header(head)?;
        let (n_tensor, large) = if self.is_radioss_header(head, n_tensor, large) {
            (0, 1)
        } else {
            (n_tensor, large)
        };
        let counts = [
            n_plane,
            n_thick,
            n_history,
            n_tensor,
            n_thermal_points,
            n_thermal,
        ];
        let [
            n_plane,
            n_thick,
            n_history,
            n_tensor,
            n_thermal_points,
            n_thermal,
        ] = self.counts(head, counts)?;
        let (lines, tensor_lines) = if large == 0 {
            (SMALL, SMALL_TENSOR)
        } else {
            (LARGE, LARGE)
        };
        let n_points = n_plane.max(1) * n_thick.max(1);
        let factor = self.units.stress;
        // The counts are the file's word; memory is taken for what is there.
        let (mut points, mut history, mut tensors) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..n_points {
            let values = self.take(8, lines)?;
            let point = StressPoint {
                t: values[0],
                stress: std::array::from_fn(|i| values[i + 1] * factor),
                plastic_strain: values[7],
            };
            self.check_size(head, &point.stress);
            points.push(point);
            // Some tools go on with them where the line of the plastic strain has room.
            let n_beyond = self.beyond.len().min(n_history);
            history.extend(self.beyond.drain(..n_beyond));
            history.extend_from_slice(self.take(n_history - n_beyond, lines)?);
            let n_before = tensors.len();
            tensors.extend(tensors_in(self.take(n_tensor, tensor_lines)?));
            for tensor in &tensors[n_before..] {
                self.check_size(head, tensor);
            }
        }
        self.check_places(head, n_thick, points.iter().map(|point| point.t));
        self.check_plastic_strain(head, points.iter().map(|point| point.plastic_strain));
        self.thermal(n_thermal_points, n_thermal, large)?;
        if let Some(id) = self.finish_element(head, id, offset) {
            into.add_state(id, n_plane.max(1), &points, &history, &tensors);
        }
        if n_tensor % 6 != 0 {
            let kind = DiagnosticKind::BadForming;
            let message = "tensor data that fill no whole tensors are left out";
            self.diagnostics.push_with(kind, || {
                let finding = self.block.diagnose(kind, message).at(head.position(0));
                finding
                    .found(format!("NTENSR = {n_tensor}"))
                    .expected("a multiple of 6")
            });
        }
        Ok(())
    }

    fn strain(&mut self, head: &Card<'a>, offset: i64, into: &mut Forming) -> Result<(), Stop> {
        let [id, n_plane, n_thick, large, _, _, _, is_local] = self.header(head)?;
        let [n_plane, n_thick] = self.counts(head, [n_plane, n_thick])?;
        let lines = if large == 0 { SMALL } else { LARGE };
        // Without counts there is one point at the inner and one at the outer surface, which need no T.
        let is_of_surfaces = n_plane * n_thick == 0;
        let (n_plane, n_thick) = if is_of_surfaces {
            (1, 2)
        } else {
            (n_plane, n_thick)
        };
        let mut points = Vec::new();
        for _ in 0..n_plane * n_thick {
            let values = self.take_at_least(7 - usize::from(is_of_surfaces), 7, lines)?;
            let point = StrainPoint {
                t: values[6],
                strain: std::array::from_fn(|i| values[i]),
            };
            self.check_size(head, &point.strain);
            points.push(point);
        }
        if is_of_surfaces && points[0].t * points[1].t >= 0.0 {
            (points[0].t, points[1].t) = (-1.0, 1.0);
        }
        self.check_places(head, n_thick, points.iter().map(|point| point.t));
        let Some(id) = self.finish_element(head, id, offset) else {
            return Ok(());
        };
        if is_local == 0 {
            into.add_strain(id, n_plane, &points);
        } else {
            let kind = DiagnosticKind::LocalStrains;
            let what = if self.block.has_option("SET") {
                "shell set"
            } else {
                "shell"
            };
            let message =
                format!("the strains of {what} {id} are in the element's own axes and left out");
            let column = head.field(EIGHT_BY_10, 7).column;
            self.diagnostics.push_with(kind, || {
                let diagnostic = Diagnostic::new(kind, message).at(head.position(column));
                let found = format!("ILOCAL = {is_local}");
                diagnostic.found(found).expected("0 for the global axes")
            });
        }
        Ok(())
    }

    /// `EID NINT NHISV LARGE IVEFLG IALEGP NTHINT NTHHSV`. The initial volume that `IVEFLG` asks
    /// for is one of the history variables. Large data run on over the lines of a point.
    fn solid_stress(&mut self, head: &Card<'a>, counter: &mut usize) -> Result<(), Stop> {
        let [
            id,
            n_points,
            n_history,
            large,
            _,
            _,
            n_thermal_points,
            n_thermal,
        ] = self.header(head)?;
        let [n_points, n_history, n_thermal_points, n_thermal] =
            self.counts(head, [n_points, n_history, n_thermal_points, n_thermal])?;
        for _ in 0..n_points.max(1) {
            if large == 0 {
                self.take(7, SMALL)?;
                self.take(n_history, SMALL)?;
            } else {
                self.take(7 + n_history, LARGE)?;
            }
        }
        self.thermal(n_thermal_points, n_thermal, large)?;
        self.count_element(head, id, counter);
        Ok(())
    }

    /// `EID NPLANE NTHICK NHISV LARGE`, then points as those of a shell.
    fn thick_shell_stress(&mut self, head: &Card<'a>, counter: &mut usize) -> Result<(), Stop> {
        let [id, n_plane, n_thick, n_history, large, ..] = self.header(head)?;
        let [n_plane, n_thick, n_history] = self.counts(head, [n_plane, n_thick, n_history])?;
        let lines = if large == 0 { SMALL } else { LARGE };
        for _ in 0..n_plane.max(1) * n_thick.max(1) {
            self.take(8, lines)?;
            self.take(n_history, lines)?;
        }
        self.count_element(head, id, counter);
        Ok(())
    }

    /// `EID` and lines of one tensor each.
    fn tensors(&mut self, head: &Card<'a>, n: usize, counter: &mut usize) -> Result<(), Stop> {
        let [id, ..] = self.header(head)?;
        for _ in 0..n {
            self.take(6, SMALL_TENSOR)?;
        }
        self.count_element(head, id, counter);
        Ok(())
    }

    fn thermal(&mut self, n_points: usize, n_values: usize, large: i64) -> Result<(), Stop> {
        let lines = if large == 0 { SMALL } else { LARGE };
        for _ in 0..n_points {
            self.take(n_values, lines)?;
        }
        Ok(())
    }

    fn count_element(&mut self, head: &Card<'_>, id: i64, counter: &mut usize) {
        let is_good = self.finish_element(head, id, self.units.element).is_some();
        *counter += usize::from(is_good);
    }

    /// Where an element's results end is not known without its first card, so that the block ends there.
    fn tell_rest(&mut self) {
        let Some(card) = self.next_card() else {
            return;
        };
        let kind = DiagnosticKind::BadForming;
        self.diagnostics.push_with(kind, || {
            let message = "the results from here to the end of the block are left out";
            Diagnostic::new(kind, message).at(card.position(0))
        });
    }

    fn header(&mut self, card: &Card<'a>) -> Result<[i64; 8], Stop> {
        self.head = Some(card.clone());
        let mut fields = [0; 8];
        for (i, field) in fields.iter_mut().enumerate() {
            match card.int_or_zero(EIGHT_BY_10, i) {
                Ok(value) => *field = value,
                Err(error) => {
                    self.diagnostics.push_with(error.kind, || {
                        card.diagnose(&error, "the first card of an element's results")
                    });
                    return Err(Stop);
                }
            }
        }
        Ok(fields)
    }

    /// OpenRadioss writes `3I8,16X,I8`, which in columns of ten says one tensor value and small
    /// fields where large fields without tensors are meant. Both have two lines a point; the
    /// second one is longer than a single small value.
    fn is_radioss_header(&mut self, head: &Card<'_>, n_tensor: i64, large: i64) -> bool {
        let line = head.line().trim_ascii_end();
        let is_suspect = (n_tensor, large, head.is_free()) == (1, 0, false)
            && line.len() == 48
            && line[24..47].iter().all(|&byte| byte == b' ');
        if !is_suspect {
            return false;
        }
        let mut ahead = self.cards.clone();
        let second = ahead.nth(1);
        second.is_some_and(|card| card.line().trim_ascii_end().len() > 10)
    }

    fn counts<const N: usize>(
        &mut self,
        head: &Card<'_>,
        values: [i64; N],
    ) -> Result<[usize; N], Stop> {
        if let Some(bad) = values.iter().find(|&n| !(0..=MAX_COUNT).contains(n)) {
            let kind = DiagnosticKind::BadForming;
            let message = "a count of integration points or variables makes no sense";
            self.diagnostics.push_with(kind, || {
                let diagnostic = self.block.diagnose(kind, message).at(head.position(0));
                diagnostic
                    .found(bad.to_string())
                    .expected("a number from 0 to 10000")
            });
            return Err(Stop);
        }
        Ok(values.map(|n| usize::try_from(n).expect("checked to be a small positive number")))
    }

    /// The next `n` values. Some tools break a line early and put what is missing on a line of its
    /// own; otherwise missing fields at a line's end are zero.
    fn take(&mut self, n: usize, lines: Lines) -> Result<&[f64], Stop> {
        self.take_at_least(n, n, lines)
    }

    /// The same, where those behind `n_needed` may be left out and stand on no line of their own: the next
    /// line may be the first card of another element.
    fn take_at_least(&mut self, n_needed: usize, n: usize, lines: Lines) -> Result<&[f64], Stop> {
        self.values.clear();
        while self.values.len() < n {
            let expected = lines.per_line.min(n - self.values.len());
            let Some(card) = self.next_card() else {
                let kind = DiagnosticKind::MissingCard;
                let message = "the results of the element that begins here are cut off";
                let head = self.head.as_ref().map(|head| head.position(0));
                self.diagnostics.push_with(kind, || {
                    with_position(self.block.diagnose(kind, message), head)
                });
                return Err(Stop);
            };
            let found = self.append(&card, expected, lines);
            let fields = expected..card.n_fields(lines.widths[0]).min(lines.per_line);
            let beyond = fields.map_while(|i| card.real(lines.widths, i).ok().flatten());
            self.beyond.clear();
            self.beyond.extend(beyond);
            let missing = expected - found;
            let width = lines.widths[0];
            let rest_follows = self.values.len() < n_needed
                && missing > 0
                && (self.cards.peek())
                    .is_some_and(|next| next.n_fields(width) == missing && !is_head(next));
            if rest_follows {
                let next = self.next_card().expect("it was seen just before");
                self.append(&next, missing, lines);
            } else {
                let full = self.values.len() + missing;
                self.values.resize(full, 0.0);
            }
        }
        Ok(&self.values)
    }

    /// Adds the fields a line has, at most `n`; says how many.
    fn append(&mut self, card: &Card<'_>, n: usize, lines: Lines) -> usize {
        let n_found = card.n_fields(lines.widths[0]).min(n);
        for i in 0..n_found {
            let value = card.real_or_zero(lines.widths, i).unwrap_or_else(|error| {
                if self.bad_field.is_none() {
                    self.diagnostics
                        .push_with(error.kind, || card.diagnose(&error, "a forming result"));
                    self.bad_field = Some(error);
                }
                0.0
            });
            self.values.push(value);
        }
        n_found
    }

    /// The element's or set's id, unless one of its fields could not be read.
    fn finish_element(&mut self, head: &Card<'_>, id: i64, offset: i64) -> Option<u64> {
        if self.bad_field.take().is_some() {
            return None;
        }
        match u64::try_from(id) {
            Ok(id) if id > 0 => Some(shifted(id, offset)),
            _ => {
                let kind = DiagnosticKind::BadForming;
                let message = "results name no element";
                self.diagnostics.push_with(kind, || {
                    self.block.diagnose(kind, message).at(head.position(0))
                });
                None
            }
        }
    }
}

/// The whole tensors of a point; none if the values are no whole tensors.
fn tensors_in(values: &[f64]) -> impl Iterator<Item = Tensor> {
    let whole = if values.len().is_multiple_of(6) {
        values
    } else {
        &[]
    };
    whole
        .chunks_exact(6)
        .map(|six| std::array::from_fn(|i| six[i]))
}

#[cfg(test)]
mod tests;
