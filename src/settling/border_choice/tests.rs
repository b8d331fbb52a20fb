//! Which of several poses borders and holes support.

use super::*;
use crate::assess::AssessSettings;
use crate::geometry::{Point3, TriMesh};
use crate::monitor::Monitor;
use crate::registration::Surface;

/// A pose of parts that lie on each other but for their borders.
pub(super) fn refined(held: f64, paired: f64, n_holes: usize) -> Refined {
    Refined {
        pose: Similarity::identity(),
        held,
        paired,
        alike: paired,
        grain: 0.002,
        n_holes,
        worst_hole: 0.0,
        missing: 0.0,
        met: 1.0,
        gap: 0.0,
    }
}

#[test]
fn a_few_borders_hold_no_pose_unless_a_hole_is_among_them() {
    let points = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]].map(Point3::from);
    let mesh = TriMesh::new(points.to_vec(), vec![[0, 1, 2]]).unwrap();
    let plate = Surface::new(&mesh, "source").unwrap();
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([&plate, &plate], &settings, &monitor);
    let comparison = PoseComparison::new(&context, 1.0);
    let off = |held, worst_hole| Refined {
        worst_hole,
        ..refined(held, 0.8, 3)
    };
    for (result, rival, wins) in [
        (refined(0.0, 0.3, 0), refined(0.14, 0.3, 0), false),
        (refined(0.0, 0.3, 0), refined(0.14, 0.3, 1), true),
        (refined(0.0, 0.3, 0), refined(0.4, 0.6, 0), true),
        (refined(0.4, 0.6, 0), refined(0.401, 0.6, 0), false),
        (refined(0.4, 0.6, 2), refined(0.4, 0.6, 1), false),
        // Outlines may be trimmed elsewhere, holes may not lie elsewhere.
        (off(0.3, 1.8), off(0.6, 5.5), false),
        (off(0.3, 0.9), off(0.6, 1.1), false),
        (off(0.3, 1.8), off(0.6, 2.2), true),
    ] {
        let choice = comparison.choice(&result, &result, &[rival]);
        assert_eq!(choice.is_some(), wins, "{} of {}", rival.held, result.held);
    }
    // Among rivals too an end that lies on an outline is worth less than a hole on its counterpart, …
    let chosen = |rivals: &[Refined]| comparison.choice(&off(0.3, 17.0), &off(0.3, 17.0), rivals);
    let (exact, shifted) = (off(0.6, 0.1), off(0.7, 7.0));
    for rivals in [[exact, shifted], [shifted, exact]] {
        assert_eq!(chosen(&rivals).unwrap().worst_hole, 0.1);
    }
    // … unless more holes lie where the other part is solid, less of the part meets it, or surfaces lie farther off.
    for worse in [
        Refined {
            missing: 0.1,
            ..exact
        },
        Refined { met: 0.9, ..exact },
        Refined { gap: 0.2, ..exact },
    ] {
        assert_eq!(chosen(&[worse, shifted]).unwrap().worst_hole, 7.0);
    }
}

#[test]
fn borders_beyond_the_other_part_count_only_where_one_part_covers_the_other() {
    let (winner, shifted) = (refined(0.8, 0.8, 4), refined(0.6, 0.6, 3));
    assert!((shifted.behind(&winner) - 0.2).abs() < 1e-12);
    let overhanging = |pose: Refined| Refined { met: 0.9, ..pose };
    let behind = overhanging(shifted).behind(&overhanging(winner));
    assert!(behind.abs() < 1e-12, "{behind}");
    // Those beside the other part's that lie apart count all the same.
    let apart = Refined {
        held: 0.3,
        ..overhanging(shifted)
    };
    assert!((apart.behind(&overhanging(winner)) - 0.5).abs() < 1e-12);
}

#[test]
fn outlines_that_lie_apart_under_the_winner_too_do_not_distinguish_a_pose() {
    let within = 1.0;
    let (winner, other) = (refined(0.57, 0.8, 1), refined(0.44, 0.81, 1));
    assert!(other.is_held_as_well(&winner, within));
    // All outlines of the winner lie together, hardly any of the other's do, or a hole has no counterpart.
    assert!(!other.is_held_as_well(&refined(0.78, 0.8, 1), within));
    assert!(!refined(0.2, 0.81, 1).is_held_as_well(&winner, within));
    assert!(!refined(0.44, 0.81, 0).is_held_as_well(&winner, within));
    // A cut through a hole lies beside no like border, however the parts were trimmed.
    let cut_through = Refined {
        alike: 0.6,
        ..winner
    };
    assert!(!other.is_held_as_well(&cut_through, within));
    let aside = Refined {
        worst_hole: 1.2,
        ..other
    };
    assert!(!aside.is_held_as_well(&winner, within));
    // Ends trimmed by a little on either side, with holes that springback moves under both poses.
    let off = |held, worst_hole| Refined {
        worst_hole,
        ..refined(held, 0.87, 2)
    };
    assert!(off(0.64, 2.8).is_held_as_well(&off(0.77, 1.7), within));
    assert!(!off(0.64, 3.6).is_held_as_well(&off(0.77, 1.7), within));
    assert!(!off(0.64, 37.0).is_held_as_well(&off(0.77, 22.0), within));
    // What holes that one part lacks take from the borders held is no trim.
    let unpierced = |held| Refined {
        missing: 0.11,
        ..refined(held, 0.89, 0)
    };
    assert!(!unpierced(0.75).is_held_as_well(&unpierced(0.78), within));
}
