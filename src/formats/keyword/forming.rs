//! Results of a forming simulation: `*INITIAL_STRESS_SHELL` and `*INITIAL_STRAIN_SHELL`, also for
//! sets; those of solids and thick shells are read past and counted.

use std::iter::Peekable;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Forming, StrainPoint, StressPoint};
use super::block::{Block, Cards};
use super::card::{Card, EIGHT_BY_10, FIVE_BY_16, FieldError};
use super::nodes::shifted;

/// More points or history variables than any solver writes for one shell; such a count means that
/// the cards are out of step.
const MAX_COUNT: i64 = 10_000;

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
/// out; counts that make no sense end the block.
pub(crate) fn read_block(
    block: &Block<'_>,
    units: ResultUnits,
    into: &mut RawForming,
    diagnostics: &mut Diagnostics,
) {
    let Some(results) = Results::of_keyword(&block.name) else {
        if is_forming(&block.name) {
            let kind = DiagnosticKind::Unsupported;
            let message = || format!("the results in *{} are left out", block.name);
            diagnostics.push_with(kind, || block.diagnose(kind, message()));
        }
        return;
    };
    let mut reader = Reader {
        block,
        cards: block.cards().peekable(),
        units,
        diagnostics,
        values: Vec::new(),
        bad_field: None,
    };
    while let Some(card) = reader.cards.next() {
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
        if let Err(Stop) = read {
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
    /// The first unreadable field of the element at hand.
    bad_field: Option<FieldError>,
}

/// How the lines of one kind of data are cut.
#[derive(Debug, Clone, Copy)]
struct Lines {
    widths: &'static [u8],
    per_line: usize,
}

const SMALL: Lines = Lines {
    widths: EIGHT_BY_10,
    per_line: 8,
};
const SMALL_TENSOR: Lines = Lines {
    widths: EIGHT_BY_10,
    per_line: 6,
};
const LARGE: Lines = Lines {
    widths: FIVE_BY_16,
    per_line: 5,
};

impl Reader<'_, '_> {
    fn stress(&mut self, head: &Card<'_>, offset: i64, into: &mut Forming) -> Result<(), Stop> {
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
        let mut points = Vec::with_capacity(n_points);
        let mut history = Vec::with_capacity(n_points * n_history);
        for _ in 0..n_points {
            let values = self.take(8, lines)?;
            points.push(StressPoint {
                t: values[0],
                stress: std::array::from_fn(|i| values[i + 1] * factor),
                plastic_strain: values[7],
            });
            history.extend_from_slice(self.take(n_history, lines)?);
            self.take(n_tensor, tensor_lines)?;
        }
        self.thermal(n_thermal_points, n_thermal, large)?;
        if let Some(id) = self.finish_element(head, id, offset) {
            into.add_stress(id, n_plane.max(1), &points, &history);
        }
        Ok(())
    }

    fn strain(&mut self, head: &Card<'_>, offset: i64, into: &mut Forming) -> Result<(), Stop> {
        let [id, n_plane, n_thick, large, _, _, _, is_local] = self.header(head)?;
        let [n_plane, n_thick] = self.counts(head, [n_plane, n_thick])?;
        let lines = if large == 0 { SMALL } else { LARGE };
        // Without counts there is one point at the inner and one at the outer surface.
        let (n_plane, n_points) = match n_plane * n_thick {
            0 => (1, 2),
            n => (n_plane, n),
        };
        let mut points = Vec::with_capacity(n_points);
        for _ in 0..n_points {
            let values = self.take(7, lines)?;
            points.push(StrainPoint {
                t: values[6],
                strain: std::array::from_fn(|i| values[i]),
            });
        }
        let Some(id) = self.finish_element(head, id, offset) else {
            return Ok(());
        };
        if is_local == 0 {
            into.add_strain(id, n_plane, &points);
        } else {
            let kind = DiagnosticKind::Unsupported;
            let what = if self.block.has_option("SET") {
                "shell set"
            } else {
                "shell"
            };
            let message =
                format!("the strains of {what} {id} are in the element's own axes and left out");
            let column = head.field(EIGHT_BY_10, 7).column;
            self.diagnostics.push_with(kind, || {
                let finding = Diagnostic::new(kind, message).at(head.position(column));
                let found = format!("ILOCAL = {is_local}");
                finding.found(found).expected("0 for the global axes")
            });
        }
        Ok(())
    }

    /// `EID NINT NHISV LARGE IVEFLG IALEGP NTHINT NTHHSV`. The initial volume that `IVEFLG` asks
    /// for is one of the history variables. Large data run on over the lines of a point.
    fn solid_stress(&mut self, head: &Card<'_>, counter: &mut usize) -> Result<(), Stop> {
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
    fn thick_shell_stress(&mut self, head: &Card<'_>, counter: &mut usize) -> Result<(), Stop> {
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
    fn tensors(&mut self, head: &Card<'_>, n: usize, counter: &mut usize) -> Result<(), Stop> {
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

    fn header(&mut self, card: &Card<'_>) -> Result<[i64; 8], Stop> {
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
                let finding = self.block.diagnose(kind, message).at(head.position(0));
                finding
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
        self.values.clear();
        while self.values.len() < n {
            let expected = lines.per_line.min(n - self.values.len());
            let Some(card) = self.cards.next() else {
                let kind = DiagnosticKind::MissingCard;
                let message = "the results of the last element are cut off";
                self.diagnostics
                    .push_with(kind, || self.block.diagnose(kind, message));
                return Err(Stop);
            };
            let found = self.append(&card, expected, lines);
            let missing = expected - found;
            let width = lines.widths[0];
            let rest_follows = missing > 0
                && (self.cards.peek()).is_some_and(|next| next.n_fields(width) == missing);
            if rest_follows {
                let next = self.cards.next().expect("it was seen just before");
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

#[cfg(test)]
mod tests {
    use super::super::super::model::OtherResults;
    use super::super::block::{Blocks, SourceFile};
    use super::super::card::Layout;
    use super::*;

    fn read(text: &str) -> (Forming, Diagnostics) {
        let file = SourceFile::from_text("dynain", text);
        let (mut forming, mut diagnostics) = (RawForming::default(), Diagnostics::default());
        for block in Blocks::new(&file, Layout::Standard) {
            read_block(&block, AS_IT_IS, &mut forming, &mut diagnostics);
        }
        (forming.of_shells, diagnostics)
    }

    const AS_IT_IS: ResultUnits = ResultUnits {
        element: 0,
        set: 0,
        stress: 1.0,
    };

    fn clean(text: &str) -> Forming {
        let (forming, diagnostics) = read(text);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        forming
    }

    fn row(width: usize, values: &[f64]) -> String {
        let fields = values.iter().map(|v| format!("{v:>width$}"));
        fields.collect::<String>() + "\n"
    }

    fn ints(width: usize, values: &[i64]) -> String {
        let fields = values.iter().map(|v| format!("{v:>width$}"));
        fields.collect::<String>() + "\n"
    }

    const POINT: [f64; 8] = [-0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.25];
    const HISTORY: [f64; 9] = [10., 11., 12., 13., 14., 15., 16., 17., 18.];

    #[track_caller]
    fn check(forming: &Forming, n_elements: usize, n_points: usize, n_history: usize) {
        assert_eq!(forming.n_stress(), n_elements);
        for (i, shell) in forming.stresses().enumerate() {
            assert_eq!(shell.element_id, 100 + i as u64);
            assert_eq!(shell.points.len(), n_points);
            for point in shell.points {
                assert_eq!(point.t, -0.5);
                assert_eq!(point.stress, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
                assert_eq!(point.plastic_strain, 0.25);
            }
            assert_eq!(shell.n_history, n_history);
            for history in shell.history.chunks(n_history.max(1)) {
                assert_eq!(history, &HISTORY[..n_history]);
            }
        }
    }

    /// Two elements, one point in the plane and two through the thickness, nine history
    /// variables and six tensor values, in any width.
    fn stress_deck(keyword: &str, narrow: usize, wide: usize, large: bool) -> String {
        let mut deck = format!("*INITIAL_STRESS_SHELL{keyword}\n$ comment\n");
        for id in [100, 101] {
            deck += &ints(narrow, &[id, 1, 2, 9, 6, large.into(), 1, 2]);
            for _ in 0..2 {
                let (width, per_line) = if large { (wide, 5) } else { (narrow, 8) };
                for line in POINT.chunks(per_line) {
                    deck += &row(width, line);
                }
                for line in HISTORY.chunks(per_line) {
                    deck += &row(width, line);
                }
                for line in HISTORY[..6].chunks(per_line.min(6)) {
                    deck += &row(width, line);
                }
                deck += "$ between points\n";
            }
            deck += &row(if large { wide } else { narrow }, &[300.0, 301.0]);
        }
        deck
    }

    #[test]
    fn stresses_in_every_width() {
        check(&clean(&stress_deck("", 10, 16, false)), 2, 2, 9);
        check(&clean(&stress_deck("", 10, 16, true)), 2, 2, 9);
        check(&clean(&stress_deck(" %", 10, 16, true)), 2, 2, 9);
        check(&clean(&stress_deck("+", 20, 20, false)), 2, 2, 9);
        check(&clean(&stress_deck("+", 20, 20, true)), 2, 2, 9);
    }

    #[test]
    fn the_header_of_openradioss() {
        let mut deck = String::from("*INITIAL_STRESS_SHELL\n");
        for id in [100, 101] {
            deck += &format!("{id:>8}{:>8}{:>8}{:16}{:>8}\n", 1, 3, "", 1);
            for _ in 0..3 {
                deck += &row(16, &POINT[..5]);
                deck += &row(16, &POINT[5..]);
            }
        }
        check(&clean(&deck), 2, 3, 0);
        // One real tensor value a point is read as such.
        let mut deck = String::from("*INITIAL_STRESS_SHELL\n");
        deck += &ints(10, &[100, 1, 1, 0, 1]);
        deck += &(row(10, &POINT) + &row(10, &[7.0]));
        check(&clean(&deck), 1, 1, 0);
    }

    #[test]
    fn plastic_strain_on_a_line_of_its_own() {
        let mut deck = String::from("*INITIAL_STRESS_SHELL\n");
        for id in [100, 101] {
            deck += &ints(10, &[id, 1, 1]);
            deck += &(row(10, &POINT[..7]) + &row(10, &POINT[7..]));
        }
        check(&clean(&deck), 2, 1, 0);
    }

    #[test]
    fn free_format_and_missing_fields() {
        let deck = "*INITIAL_STRESS_SHELL\n100,1,1\n-.5,1.,2.,3.,4.,5.,6.,.25\n101,1,1\n-.5,1.\n";
        let forming = clean(deck);
        assert_eq!(forming.stress(0).points[0].plastic_strain, 0.25);
        assert_eq!(
            forming.stress(1).points[0].stress,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        );
    }

    #[test]
    fn strains_small_large_and_without_counts() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -1.0];
        let mut deck = String::from("*INITIAL_STRAIN_SHELL\n");
        deck += &(ints(10, &[100]) + &row(10, &values) + &row(10, &values));
        deck += &ints(10, &[101, 1, 3, 1]);
        for _ in 0..3 {
            deck += &(row(16, &values[..5]) + &row(16, &values[5..]));
        }
        // OpenRadioss: 4I8.
        deck += &ints(8, &[102, 1, 1, 1]);
        deck += &(row(16, &values[..5]) + &row(16, &values[5..]));
        let forming = clean(&deck);
        let n_points: Vec<_> = forming.strains().map(|s| s.points.len()).collect();
        assert_eq!(n_points, [2, 3, 1]);
        for shell in forming.strains() {
            for point in shell.points {
                assert_eq!(point.strain, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
                assert_eq!(point.t, -1.0);
            }
        }
    }

    #[test]
    fn what_cannot_be_used_is_said() {
        let (forming, diagnostics) =
            read("*INITIAL_STRESS_BEAM\n1\n*INITIAL_STRESS_SOLID_SET\n2\n");
        assert!(forming.is_empty());
        assert_eq!(diagnostics.count(DiagnosticKind::Unsupported), 2);
        let (_, diagnostics) = read("*INITIAL_STRESS_SHELL\n1,99999,99999\n");
        assert_eq!(diagnostics.count(DiagnosticKind::BadForming), 1);
        let (forming, diagnostics) =
            read("*INITIAL_STRESS_SHELL\n1,1,1\n0,x\n2,1,1\n0,1,1,1,1,1,1,0\n");
        assert_eq!((forming.n_stress(), diagnostics.total()), (1, 1));
        let (_, diagnostics) = read("*INITIAL_STRAIN_SHELL\n1,1,1,0,,,,1\n0,1,1,1,1,1,1\n");
        assert_eq!(diagnostics.count(DiagnosticKind::Unsupported), 1);
    }

    #[test]
    fn ids_are_shifted_either_way_and_stresses_scaled() {
        let deck = "*INITIAL_STRESS_SHELL\n100,1,1\n-.5,1.,2.,3.,4.,5.,6.,.25\n\
            *INITIAL_STRESS_SHELL_SET\n9,1,1\n-.5,1.,2.,3.,4.,5.,6.,.25\n";
        let file = SourceFile::from_text("dynain", deck);
        let (mut forming, mut diagnostics) = (RawForming::default(), Diagnostics::default());
        let units = ResultUnits {
            element: -40,
            set: 1,
            stress: 10.0,
        };
        for block in Blocks::new(&file, Layout::Standard) {
            read_block(&block, units, &mut forming, &mut diagnostics);
        }
        let of_set = forming.of_sets.stress(0);
        let of_shell = forming.of_shells.stress(0);
        assert_eq!((of_shell.element_id, of_set.element_id), (60, 10));
        assert_eq!(of_shell.points, of_set.points);
        assert_eq!(
            of_set.points[0].stress,
            [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
        );
        assert_eq!(of_set.points[0].plastic_strain, 0.25);
    }

    #[test]
    fn results_of_solids_and_thick_shells_are_counted() {
        let values: Vec<f64> = (1..=30).map(f64::from).collect();
        let mut deck = String::from("*INITIAL_STRESS_SOLID\n");
        for id in [1, 2] {
            // Two points with four history variables run on over three lines each.
            deck += &ints(10, &[id, 2, 4, 1, 1, 0, 1, 6]);
            for _ in 0..2 {
                deck += &(row(16, &values[..5]) + &row(16, &values[5..10]) + &row(16, &[11.0]));
            }
            deck += &(row(16, &values[..5]) + &row(16, &[6.0]));
        }
        deck += &(ints(10, &[3, 1]) + &row(10, &values[..7]));
        deck += "*INITIAL_STRAIN_SOLID\n";
        deck += &(ints(10, &[1]) + &row(10, &values[..6]));
        deck += &(ints(10, &[2]) + &row(10, &values[..6]));
        deck += "*INITIAL_STRESS_TSHELL\n";
        deck += &ints(10, &[1, 1, 2, 3, 1]);
        for _ in 0..2 {
            deck += &(row(16, &values[..5]) + &row(16, &values[..3]) + &row(16, &values[..3]));
        }
        deck += &(ints(10, &[2, 1, 1]) + &row(10, &POINT));
        deck += "*INITIAL_STRAIN_TSHELL\n";
        deck += &(ints(10, &[7]) + &row(10, &values[..6]) + &row(10, &values[..6]));
        let forming = clean(&deck);
        assert!(forming.is_empty());
        let expected = OtherResults {
            solid_stress: 3,
            solid_strain: 2,
            thick_shell_stress: 2,
            thick_shell_strain: 1,
        };
        assert_eq!(forming.others, expected);
    }

    #[test]
    fn a_deck_cut_anywhere_is_no_panic() {
        let deck = stress_deck("", 10, 16, true) + "*INITIAL_STRAIN_SHELL\n 1,1,1\n1,2,3,4,5,6,7\n";
        let whole = clean(&deck).n_stress();
        for end in 0..deck.len() {
            let (forming, _) = read(&deck[..end]);
            assert!(forming.n_stress() <= whole);
        }
    }
}
