//! Unit tests of forming results.

use super::super::super::model::OtherResults;
use super::super::block::Blocks;
use super::super::card::Layout;
use super::super::source_file::SourceFile;
use super::*;

fn read(text: &str) -> (Forming, Diagnostics) {
    let file = Arc::new(SourceFile::new("dynain", text));
    let (mut forming, mut diagnostics) = (RawForming::default(), Diagnostics::default());
    for block in Blocks::new(&file, Layout::Standard) {
        read_block(
            &file,
            &block,
            AS_IT_IS,
            &mut forming,
            &mut diagnostics,
            &Monitor::silent(),
        );
    }
    (forming.of_shells, diagnostics)
}

const AS_IT_IS: ResultUnits = ResultUnits {
    element: 0,
    set: 0,
    stress: 1.0,
};

/// Nothing is said but that layers lie in one place, as those of these tests do.
#[track_caller]
fn clean(text: &str) -> Forming {
    let (forming, diagnostics) = read(text);
    let n_doubts = diagnostics.count(DiagnosticKind::DoubtfulForming);
    assert_eq!(diagnostics.total(), n_doubts, "{diagnostics:?}");
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
        // The decks with history variables have one tensor a point too.
        let n_tensors = usize::from(n_history > 0);
        assert_eq!(shell.n_tensors, n_tensors);
        assert_eq!(shell.tensors.len(), n_tensors * n_points);
        for tensor in shell.tensors {
            assert_eq!(tensor, &HISTORY[..6]);
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
    let (forming, found) = read(&deck);
    check(&forming, 1, 1, 0);
    let told: Vec<String> = found.iter().map(|d| d.to_string()).collect();
    assert!(
        told.len() == 1 && told[0].contains("NTENSR = 1"),
        "{told:?}"
    );
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
fn the_first_card_of_the_next_element_is_no_rest_of_a_short_line() {
    let mut deck = String::from("*INITIAL_STRESS_SHELL\n");
    for id in [100, 101] {
        deck += &(ints(10, &[id, 1, 1]) + &row(10, &POINT[..5]));
    }
    let free = "*INITIAL_STRESS_SHELL\n100,1,1\n-.5,1.,2.,3.,4.\n101,1,1\n-.5,1.,2.,3.,4.\n";
    for deck in [deck.as_str(), free] {
        let forming = clean(deck);
        assert_eq!(forming.n_stress(), 2, "{deck}");
        for shell in forming.stresses() {
            assert_eq!(shell.points[0].stress, [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]);
            assert_eq!(shell.points[0].plastic_strain, 0.0);
        }
    }
    let mut deck = String::from("*INITIAL_STRAIN_SHELL\n");
    for id in [100, 101] {
        deck += &(ints(10, &[id, 1, 1]) + &row(10, &[1.0, 2.0, 3.0, 4.0]));
    }
    assert_eq!(clean(&deck).n_strain(), 2);
}

#[test]
fn what_is_left_out_behind_a_bad_card_is_told_with_its_line() {
    let good = |id| ints(10, &[id, 1, 1]) + &row(10, &POINT);
    let deck = String::from("*INITIAL_STRESS_SHELL\n") + &good(100) + &ints(10, &[101, 1, -1]);
    let (forming, found) = read(&(deck + &row(10, &POINT) + &good(102)));
    check(&forming, 1, 1, 0);
    let lines = |found: &Diagnostics| -> Vec<u64> {
        let positions = found.iter().map(|d| d.position.as_ref());
        positions
            .map(|position| position.map_or(0, |p| p.line))
            .collect()
    };
    assert_eq!(lines(&found), [4, 5]);
    let last = found.iter().last().map(|d| d.message.clone());
    assert!(last.is_some_and(|text| text.contains("to the end of the block are left out")));
    // The end of the file within the second element.
    let deck = String::from("*INITIAL_STRESS_SHELL\n") + &good(100) + &ints(10, &[101, 1, 2]);
    let (forming, found) = read(&(deck + &row(10, &POINT)));
    check(&forming, 1, 1, 0);
    assert_eq!(lines(&found), [4]);
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
        }
    }
    let places = |shell: usize| -> Vec<f64> {
        let points = forming.strain(shell).points.iter();
        points.map(|point| point.t).collect()
    };
    // One T for both surfaces says nothing.
    assert_eq!(places(0), [-1.0, 1.0]);
    assert_eq!(places(1), [-1.0; 3]);
}

/// The form with an inner and an outer surface needs no T, and has places of its own where it gives some.
#[test]
fn strains_of_two_surfaces_need_no_place() {
    for large in [0, 1] {
        for t in [None, Some(0.0), Some(-0.25)] {
            let mut deck = String::from("*INITIAL_STRAIN_SHELL\n");
            for id in [7, 8, 9] {
                deck += &match large {
                    0 => ints(10, &[id]),
                    large => ints(10, &[id, 0, 0, large]),
                };
                for side in [-1.0, 1.0] {
                    let mut values = vec![side, 2.0, 3.0, 4.0, 5.0, 6.0];
                    values.extend(t.map(|t: f64| t.abs().copysign(-side)));
                    let (width, per_line) = if large == 0 { (10, 8) } else { (16, 5) };
                    for line in values.chunks(per_line) {
                        deck += &row(width, line);
                    }
                }
            }
            let (forming, diagnostics) = read(&deck);
            assert!(diagnostics.is_empty(), "{diagnostics:?}");
            assert_eq!(forming.n_strain(), 3);
            let expected = if t == Some(-0.25) {
                [0.25, -0.25]
            } else {
                [-1.0, 1.0]
            };
            for shell in forming.strains() {
                let places: Vec<f64> = shell.points.iter().map(|point| point.t).collect();
                let first: Vec<f64> = shell.points.iter().map(|point| point.strain[0]).collect();
                assert_eq!((&places[..], &first[..]), (&expected[..], &[-1.0, 1.0][..]));
            }
        }
    }
}

#[test]
fn places_and_plastic_strains_that_cannot_be_are_told() {
    let deck = |places: [f64; 2], plastic: f64| {
        let point = |t: f64| format!("{t},1,1,1,0,0,0,{plastic}\n");
        format!(
            "*INITIAL_STRESS_SHELL\n1,1,2\n{}{}",
            point(places[0]),
            point(places[1])
        )
    };
    let found = |places, plastic| {
        let (forming, diagnostics) = read(&deck(places, plastic));
        let kinds = [DiagnosticKind::BadForming, DiagnosticKind::DoubtfulForming];
        (
            forming.n_stress(),
            kinds.map(|kind| diagnostics.count(kind)),
        )
    };
    assert_eq!(found([-0.577, 0.577], 0.1), (1, [0, 0]));
    assert_eq!(found([-1.0, 1.000_5], -1e-9), (1, [0, 0]));
    assert_eq!(found([1.0, 2.0], 0.1), (0, [1, 0]));
    assert_eq!(found([0.0, 0.0], 0.1), (1, [0, 1]));
    assert_eq!(found([-0.577, 0.577], -0.1), (1, [0, 1]));
    let (forming, diagnostics) =
        read("*INITIAL_STRAIN_SHELL\n1,1,2\n1,0,0,0,0,0,1\n1,0,0,0,0,0,2\n");
    assert_eq!(forming.n_strain(), 0);
    let told: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "dynain:2:1: error: the layers of an element lie outside of its sheet, and its results are left \
             out, found \"T = 2\", expected places of the layers from -1 to 1"
        ]
    );
}

#[test]
fn what_cannot_be_used_is_said() {
    let (forming, diagnostics) = read("*INITIAL_STRESS_BEAM\n1\n*INITIAL_STRESS_SOLID_SET\n2\n");
    assert!(forming.is_empty());
    assert_eq!(diagnostics.count(DiagnosticKind::Unsupported), 2);
    let (_, diagnostics) = read("*INITIAL_STRESS_SHELL\n1,99999,99999\n");
    assert_eq!(diagnostics.count(DiagnosticKind::BadForming), 1);
    let (forming, diagnostics) =
        read("*INITIAL_STRESS_SHELL\n1,1,1\n0,x\n2,1,1\n0,1,1,1,1,1,1,0\n");
    assert_eq!((forming.n_stress(), diagnostics.total()), (1, 1));
    let (_, diagnostics) = read("*INITIAL_STRAIN_SHELL\n1,1,1,0,,,,1\n0,1,1,1,1,1,1\n");
    assert_eq!(diagnostics.count(DiagnosticKind::LocalStrains), 1);
}

#[test]
fn ids_are_shifted_either_way_and_stresses_scaled() {
    let deck = "*INITIAL_STRESS_SHELL\n100,1,1\n-.5,1.,2.,3.,4.,5.,6.,.25\n\
        *INITIAL_STRESS_SHELL_SET\n9,1,1\n-.5,1.,2.,3.,4.,5.,6.,.25\n";
    let file = Arc::new(SourceFile::new("dynain", deck));
    let (mut forming, mut diagnostics) = (RawForming::default(), Diagnostics::default());
    let units = ResultUnits {
        element: -40,
        set: 1,
        stress: 10.0,
    };
    for block in Blocks::new(&file, Layout::Standard) {
        read_block(
            &file,
            &block,
            units,
            &mut forming,
            &mut diagnostics,
            &Monitor::silent(),
        );
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
    let deck = stress_deck("", 10, 16, true) + "*INITIAL_STRAIN_SHELL\n 1,1,1\n1,2,3,4,5,6,.7\n";
    let whole = clean(&deck).n_stress();
    for end in 0..deck.len() {
        let (forming, _) = read(&deck[..end]);
        assert!(forming.n_stress() <= whole);
    }
}

#[test]
fn a_cancel_request_ends_a_block() {
    let rows = (1..=3 * CHECKED_AFTER).map(|id| format!("{id},1,1\n0.,1.,2.,3.,4.,5.,6.,.25\n"));
    let deck = "*INITIAL_STRESS_SHELL\n".to_owned() + &rows.collect::<String>();
    let file = Arc::new(SourceFile::new("dynain", &*deck));
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let (mut forming, mut found) = (RawForming::default(), Diagnostics::default());
    for block in Blocks::new(&file, Layout::Standard) {
        read_block(&file, &block, AS_IT_IS, &mut forming, &mut found, &monitor);
    }
    assert_eq!(forming.of_shells.n_stress(), CHECKED_AFTER - 1);
}
