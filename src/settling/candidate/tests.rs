//! What speaks for one pose and against another.

use super::*;
use crate::assess::{AssessSettings, ShapeTolerance};
use crate::geometry::{Point3, TriMesh};
use crate::registration::Surface;

fn candidate(reasons: &[ShapeReason]) -> Candidate {
    let tolerance = ShapeTolerance {
        remainder: 1.0,
        springback: 5.0,
    };
    let shape = ShapeStatement {
        reasons: reasons.to_vec(),
        ..ShapeStatement::nothing_met(tolerance)
    };
    Candidate::at(Similarity::identity(), &shape)
}

#[test]
fn only_a_difference_beyond_doubt_speaks_against_a_pose() {
    let at = Point3::origin();
    let limit = 1.0;
    let bend = ShapeReason::Bent { by: 9.0, limit };
    let [is_end, is_mean] = [false; 2];
    let hole = |by| ShapeReason::Hole {
        by,
        limit,
        at,
        is_mean,
    };
    let bead = |by| ShapeReason::Local {
        by,
        limit,
        at,
        is_end,
    };
    let holes = ShapeReason::Holes {
        only_source: 1,
        only_target: 1,
        at,
    };
    let hardly = ShapeReason::HardlyMet { share: 0.49 };
    for (fewer, more, beats) in [
        (vec![], vec![hole(2.1)], true),
        (vec![], vec![hole(1.9)], false),
        (vec![], vec![bead(3.0)], true),
        (vec![], vec![holes], true),
        (vec![], vec![bend], false),
        (vec![], vec![hardly], false),
        (vec![bend], vec![bend, holes], true),
        // Another version has its difference under either pose.
        (vec![hole(3.0)], vec![hole(8.0)], false),
        (vec![hole(1.1)], vec![hole(8.0), bead(3.0)], true),
        (vec![hole(1.1)], vec![hole(1.2), bead(3.0)], false),
    ] {
        let (fewer, more) = (candidate(&fewer), candidate(&more));
        assert_eq!(fewer.beats(&more), beats);
        assert!(!more.beats(&fewer));
    }
}

#[test]
fn a_pose_under_which_both_outlines_and_holes_lie_aside_is_beaten() {
    let hole = ShapeReason::Hole {
        by: 1.8,
        limit: 1.0,
        at: Point3::origin(),
        is_mean: true,
    };
    let at = |off: [f64; 2], reasons: &[ShapeReason]| Candidate {
        n_holes: 24,
        off: Some(BordersOff {
            outlines: off[0],
            holes: off[1],
        }),
        ..candidate(reasons)
    };
    let right = at([0.6, 0.4], &[]);
    assert!(right.beats(&at([3.2, 2.4], &[hole])));
    // The outlines alone, or the holes alone, or what nobody remarks.
    assert!(!right.beats(&at([3.2, 1.2], &[hole])));
    assert!(!right.beats(&at([0.9, 2.4], &[hole])));
    assert!(!right.beats(&at([3.2, 2.4], &[])));
    assert!(!at([0.6, 0.4], &[hole]).beats(&at([3.2, 2.4], &[hole])));
}

#[test]
fn holes_and_much_more_of_the_part_tell_a_pose_from_one_that_overhangs() {
    let at = |n_holes, met| Candidate {
        n_holes,
        met,
        ..candidate(&[])
    };
    let overhanging = at(0, 0.76);
    assert!(at(2, 0.95).beats(&overhanging));
    // A single hole lies on another one by chance, and a little more of the part is met by chance too.
    assert!(!at(1, 0.95).beats(&overhanging));
    assert!(!at(2, 0.8).beats(&overhanging));
}

#[test]
fn an_end_drawn_onto_a_border_differs_where_it_did_not() {
    let (at, limit, is_end) = (Point3::origin(), 5.0, true);
    let by = 5.4;
    let end = ShapeReason::Local {
        by,
        limit,
        at,
        is_end,
    };
    let hole = ShapeReason::Hole {
        by,
        limit,
        at,
        is_mean: false,
    };
    let lies = |met, bend, reasons: &[ShapeReason]| Candidate {
        met,
        bend,
        remainder: 0.0,
        ..candidate(reasons)
    };
    let drawn = lies(0.99, 0.03, &[end]);
    assert!(lies(0.94, 0.01, &[]).fits_where_surfaces_differ_under(&drawn));
    // Where it lies farther apart, too little meets or it differs itself, it is no rival; nor of a hole's place.
    for other in [
        lies(0.94, 0.05, &[]),
        lies(0.4, 0.01, &[]),
        lies(0.94, 0.01, &[end]),
    ] {
        assert!(!other.fits_where_surfaces_differ_under(&drawn));
    }
    let by_hole = lies(0.99, 0.03, &[hole]);
    assert!(!lies(0.94, 0.01, &[]).fits_where_surfaces_differ_under(&by_hole));
}

#[test]
fn a_pose_that_settles_as_close_is_as_likely_whatever_it_scored_on_the_way() {
    let at = |bend, remainder, met| Candidate {
        met,
        bend,
        remainder,
        ..candidate(&[])
    };
    let best = at(0.1, 0.3, 0.97);
    let near = |other: &Candidate| other.ratio_to(&best, 0.02);
    assert!(near(&at(0.0, 0.32, 0.97)).unwrap() < 1.05);
    assert_eq!(near(&at(0.0, 0.1, 0.97)), Some(1.0));
    assert!(near(&at(0.1, 0.6, 0.97)).unwrap() > 1.5);
    // What meets less does not fit as well, nor what misses a hole.
    assert_eq!(near(&at(0.1, 0.3, 0.9)), None);
    let alone = Candidate {
        n_alone: 1,
        ..at(0.1, 0.3, 0.97)
    };
    assert_eq!(near(&alone), None);
}

#[test]
fn a_pose_that_differs_and_lies_much_farther_apart_is_no_rival_of_one_that_does_neither() {
    let bead = ShapeReason::Local {
        by: 1.1,
        limit: 1.0,
        at: Point3::origin(),
        is_end: false,
    };
    let at = |remainder, met, reasons: &[ShapeReason]| Candidate {
        met,
        bend: 0.1,
        remainder,
        ..candidate(reasons)
    };
    let right = at(0.04, 0.99, &[]);
    let is_behind =
        |other: &Candidate, noise| right.lies_much_closer_without_difference_than(other, noise);
    assert!(is_behind(&at(1.07, 0.99, &[bead]), 0.1));
    // Facets explain it, nothing differs, or more of the part meets.
    assert!(!is_behind(&at(1.07, 0.99, &[bead]), 1.0));
    assert!(!is_behind(&at(1.07, 0.99, &[]), 0.1));
    let overhanging = at(0.04, 0.9, &[]);
    let whole = at(1.07, 0.99, &[bead]);
    assert!(!overhanging.lies_much_closer_without_difference_than(&whole, 0.1));
    // Another version differs under its right pose too.
    let version = at(0.04, 0.99, &[bead]);
    assert!(!version.lies_much_closer_without_difference_than(&whole, 0.1));
}

/// Distances between parts of 900 by 500 mm.
fn distances_of_plates() -> Distances {
    let points = [[0.0, 0.0, 0.0], [900.0, 0.0, 0.0], [0.0, 500.0, 0.0]].map(Point3::from);
    let mesh = TriMesh::new(points.to_vec(), vec![[0, 1, 2]]).unwrap();
    let plate = Surface::new(&mesh, "source").unwrap();
    Distances::of(&plate, &plate, 1.0, &AssessSettings::default())
}

#[test]
fn a_lug_that_meets_the_other_part_makes_a_pose_as_likely_though_its_hole_lies_alone() {
    let distances = distances_of_plates();
    let at = |met, n_holes, n_alone, remainder| Candidate {
        met,
        n_holes,
        n_alone,
        bend: 0.01,
        remainder,
        ..candidate(&[])
    };
    let hanging = at(0.97, 4, 0, 0.01);
    let covers_more = |other: Candidate| other.covers_more_than(&hanging, &distances);
    assert!(covers_more(at(1.0, 4, 1, 0.01)));
    // Hardly more meets, a hole has lost its counterpart, or the surfaces lie farther apart.
    assert!(!covers_more(at(0.975, 4, 1, 0.01)));
    assert!(!covers_more(at(1.0, 3, 1, 0.01)));
    assert!(!covers_more(at(1.0, 4, 1, 0.9)));
}

#[test]
fn a_smaller_piece_of_an_unpierced_part_is_as_likely() {
    let distances = distances_of_plates();
    let piece = |met, n_alone, reasons: &[ShapeReason]| Candidate {
        met,
        n_alone,
        only_overhangs: true,
        bend: 0.6,
        remainder: 0.1,
        ..candidate(reasons)
    };
    let hardly = [ShapeReason::HardlyMet { share: 0.46 }];
    let best = piece(0.55, 4, &[]);
    let is_as_likely = |other: &Candidate| other.is_equal_partial_fit_beside(&best, &distances);
    assert!(is_as_likely(&piece(0.46, 5, &hardly)));
    assert!(is_as_likely(&piece(0.55, 4, &[])));
    // Much less of the part, or a piece that does not only overhang.
    assert!(!is_as_likely(&piece(0.4, 5, &hardly)));
    let elsewhere = Candidate {
        only_overhangs: false,
        ..piece(0.46, 5, &hardly)
    };
    assert!(!is_as_likely(&elsewhere));
    // A part with a hole that has its counterpart is pierced.
    let pierced = Candidate {
        n_holes: 1,
        ..piece(0.46, 5, &hardly)
    };
    assert!(!is_as_likely(&pierced));
}

#[test]
fn a_flange_that_opened_does_not_rule_out_a_pose_by_itself() {
    let bead = ShapeReason::Local {
        by: 3.8,
        limit: 1.0,
        at: Point3::origin(),
        is_end: false,
    };
    let at = |met, n_holes, reasons: &[ShapeReason]| Candidate {
        met,
        n_holes,
        outlines_are_no_evidence: true,
        ..candidate(reasons)
    };
    let winner = at(0.99, 0, &[]);
    let by_surfaces = |other: Candidate| other.is_distinguished_by_surfaces_only(&winner);
    assert!(by_surfaces(at(0.98, 0, &[bead])));
    assert!(!by_surfaces(at(0.9, 0, &[bead])));
    assert!(!by_surfaces(at(0.98, 2, &[bead])));
    let by_outlines = Candidate {
        outlines_are_no_evidence: false,
        ..at(0.98, 0, &[bead])
    };
    assert!(!by_surfaces(by_outlines));
}

#[test]
fn a_part_that_meets_as_a_whole_with_its_outlines_all_round_is_not_slid_for_a_bend() {
    let meets = |met, together| Candidate {
        met,
        together,
        ..candidate(&[])
    };
    let compared = |pose: Candidate| Candidate {
        outlines_are_no_evidence: false,
        ..pose
    };
    let (whole, slid) = (compared(meets(0.99, 0.98)), compared(meets(0.88, 0.75)));
    assert!(whole.fits_all_round_beside(&slid) && !slid.fits_all_round_beside(&whole));
    // Both may be a whole, one end may lie apart, or outlines may be no evidence.
    assert!(!whole.fits_all_round_beside(&compared(meets(0.97, 0.75))));
    assert!(!compared(meets(0.99, 0.8)).fits_all_round_beside(&slid));
    assert!(!meets(0.99, 0.98).fits_all_round_beside(&slid));
}

/// Beams of which each lacks an end lie on each other all over where one is slid, with their holes beside each other.
#[test]
fn pieces_on_each_other_s_holes_are_more_likely_than_more_of_parts_that_differ() {
    let holes = ShapeReason::Holes {
        only_source: 2,
        only_target: 2,
        at: Point3::origin(),
    };
    let slid = Candidate {
        met: 0.95,
        n_alone: 4,
        bend: 1.1,
        remainder: 0.2,
        ..candidate(&[holes])
    };
    let piece = || Candidate {
        met: 0.7,
        only_overhangs: true,
        n_holes: 2,
        bend: 0.8,
        remainder: 0.08,
        ..candidate(&[])
    };
    let fits = |change: fn(&mut Candidate)| {
        let mut other = piece();
        change(&mut other);
        other.fits_by_holes_as_a_piece_beside(&slid, 0.02)
    };
    assert!(fits(|_| {}));
    // What facets leave does not distinguish them.
    assert!(fits(|other| other.bend = 1.13));
    // With one hole it may be chance, as with little of the part, or where the surfaces lie no closer.
    assert!(!fits(|other| other.n_holes = 1));
    assert!(!fits(|other| other.met = 0.4));
    assert!(!fits(|other| other.remainder = 0.19));
    assert!(!fits(|other| other.bend = 1.5));
    assert!(!fits(|other| other.only_overhangs = false));
    // Where nothing differs beyond doubt, more of the part is more likely.
    let regular = Candidate {
        met: 0.95,
        n_alone: 4,
        ..candidate(&[])
    };
    assert!(!piece().fits_by_holes_as_a_piece_beside(&regular, 0.02));
}
