//! A small fixed slice of the robustness table: always the same pairs, so that a change for the worse
//! is seen at once.

use shapematch::assess::{PoseKind, Verdict};
use shapematch::monitor::Monitor;
use shapematch::pipeline::bench::growth::growth;
use shapematch::pipeline::bench::growth_page::growth_page;
use shapematch::pipeline::bench::robustness::{
    Ending, RobustnessRun, RobustnessSettings, robustness,
};
use shapematch::pipeline::bench::robustness_page::page;
use shapematch::pipeline::bench::robustness_table::RobustnessTable;
use shapematch::samples::SamplePart;
use shapematch::samples::scenario::Scenario;

/// The only run of one scenario on one part.
fn run(seed: u64, part: SamplePart, scenario: Scenario) -> RobustnessRun {
    let settings = RobustnessSettings {
        seed,
        parts: vec![part],
        scenarios: vec![scenario],
        ..RobustnessSettings::default()
    };
    let runs = robustness(&settings, &Monitor::silent(), |_| ()).unwrap();
    runs.into_iter().next().unwrap()
}

#[test]
fn a_slice_of_the_table_is_right_and_honest() {
    let settings = RobustnessSettings {
        parts: vec![SamplePart::Bracket, SamplePart::Crossmember],
        scenarios: vec![
            Scenario::SameSurface,
            Scenario::Cut(0.6),
            Scenario::Springback(1.0),
            Scenario::OtherHand,
            Scenario::OtherVersion(0.1),
        ],
        ..RobustnessSettings::default()
    };
    let mut n_told = 0;
    let runs = robustness(&settings, &Monitor::silent(), |_| n_told += 1).unwrap();
    assert_eq!([runs.len(), n_told], [10, 10]);
    for run in &runs {
        let expected = if run.scenario.is_same_part() {
            Ending::Right
        } else {
            Ending::NoTruth
        };
        assert_eq!(run.ending, expected, "{run:?}");
        assert_ne!(run.is_covered(), Some(false), "{run:?}");
        if run.ending == Ending::NoTruth {
            assert_ne!(run.verdict, Verdict::Good, "{run:?}");
        } else {
            assert_ne!(run.verdict, Verdict::Poor, "{run:?}");
        }
    }
    let table = RobustnessTable::new(settings.seed, &runs);
    assert_eq!(table.rows.len(), 5);
    assert_eq!(table.total.runs, 10);
    assert_eq!(table.total.right.iter().sum::<usize>(), 6);
    let page = page(&table, &runs);
    assert_eq!(page.matches("<tr>").count(), 7);
    assert!(page.contains("springback 1 mm"));
}

/// Surfaces that slide on each other say nothing about the place along them.
#[test]
fn borders_and_holes_place_parts_that_slide() {
    let settings = RobustnessSettings {
        seed: 11,
        parts: vec![SamplePart::Plate, SamplePart::Channel],
        scenarios: vec![Scenario::SameSurface, Scenario::Springback(1.0)],
        ..RobustnessSettings::default()
    };
    let runs = robustness(&settings, &Monitor::silent(), |_| ()).unwrap();
    for run in &runs {
        assert_eq!(run.ending, Ending::Right, "{run:?}");
        assert_ne!(run.verdict, Verdict::Poor, "{run:?}");
        assert!(run.node_error.is_some_and(|error| error < 1.0), "{run:?}");
    }
}

/// Times are not judged here; that the poses stay right while the meshes grow, and that all is told, is.
#[test]
fn growth_tells_times_and_exponents_of_right_poses() {
    let mut n_told = 0;
    let table = growth(12_000, &Monitor::silent(), |_| n_told += 1).unwrap();
    assert_eq!([table.rows.len(), n_told], [3, 3]);
    for pair in table.rows.windows(2) {
        let ratio = pair[1].triangles as f64 / pair[0].triangles as f64;
        assert!((1.5..8.0).contains(&ratio), "{table:?}");
    }
    // Elements of 180 mm do not hold the beads of the floor; those of 60 mm do.
    for (row, most) in table.rows.iter().zip([1.5, 0.5, 0.05]) {
        assert!(row.node_error < most, "{table:?}");
    }
    assert!(table.match_exponent.is_some() && table.prepare_exponent.is_some());
    let page = growth_page(&table);
    // Matching and preparing have marks of different shapes.
    let n_marks = ["<circle", "<rect"].map(|mark| page.matches(mark).count());
    assert_eq!(n_marks, [3, 3]);
    assert_eq!(page.matches("<tr>").count(), 4);
}

/// Where a piece of a sliding part belongs is found along all of the part, and with an addendum around it
/// borders that have no counterpart do not pull surfaces apart.
#[test]
fn pieces_of_parts_that_slide_are_found_along_all_of_the_part() {
    for (seed, part, scenario) in [
        (21, SamplePart::Plate, Scenario::Cut(0.2)),
        (21, SamplePart::Channel, Scenario::Cut(0.2)),
        (21, SamplePart::Channel, Scenario::Coarse),
        (31, SamplePart::Fender, Scenario::Addendum),
        (31, SamplePart::Sill, Scenario::Addendum),
        // Turned by half, two of three holes and a stretch of the addendum's outline coincide.
        (212, SamplePart::Plate, Scenario::Addendum),
        // The true place lies farther from the surface than another until it is moved by less than the ragged
        // cut steps aside.
        (214, SamplePart::Channel, Scenario::Cut(0.2)),
    ] {
        let run = run(seed, part, scenario);
        assert_eq!(run.ending, Ending::Right, "{run:?}");
        assert_ne!(run.verdict, Verdict::Poor, "{run:?}");
        assert!(run.node_error.is_some_and(|error| error < 1.0), "{run:?}");
    }
    // A piece of a cup without its hole belongs to many places; a cut along the hole of the other part by
    // chance does not tell which.
    let piece = run(61, SamplePart::Cup, Scenario::Cut(0.2));
    assert_eq!(piece.ending, Ending::Twin, "{piece:?}");
    assert_eq!(piece.verdict, Verdict::Check, "{piece:?}");
    // The parts of both sides differ by one hole.
    let other = run(21, SamplePart::Crossmember, Scenario::OtherHand);
    assert_eq!(other.verdict, Verdict::Poor, "{other:?}");
}

/// The outline of a part before its last trim lies beside no other: holes place it, and a pose that fits as well
/// is told.
#[test]
fn holes_place_a_part_before_its_last_trim() {
    // It lay 0.55 mm aside where its holes did not count.
    let fender = run(91, SamplePart::Fender, Scenario::Addendum);
    assert_eq!(fender.verdict, Verdict::Good, "{fender:?}");
    assert!(
        fender.node_error.is_some_and(|error| error < 0.2),
        "{fender:?}"
    );
    // Half of the holes are not punched yet, and those that are fit after half a turn as well.
    for seed in [91, 94] {
        let channel = run(seed, SamplePart::Channel, Scenario::Addendum);
        assert_eq!(channel.verdict, Verdict::Check, "{channel:?}");
        assert_eq!(channel.pose, Some(PoseKind::Ambiguous), "{channel:?}");
    }
    // More of them fit under the true pose than under any other.
    let channel = run(95, SamplePart::Channel, Scenario::Addendum);
    assert_eq!(channel.verdict, Verdict::Check, "{channel:?}");
    assert_eq!(channel.ending, Ending::Right, "{channel:?}");
}

/// Outlines that end anywhere lie beside each other under one pose and not under the next one of a row of holes: that
/// speaks for neither.
#[test]
fn outlines_that_lie_together_nowhere_hide_no_rival() {
    for (seed, scenario) in [
        (103, Scenario::Addendum),
        (95, Scenario::AddendumAndCut),
        (108, Scenario::AddendumAndCut),
    ] {
        let channel = run(seed, SamplePart::Channel, scenario);
        assert_eq!(channel.verdict, Verdict::Check, "{channel:?}");
    }
}
