//! What the words of an assessment say, and what they leave out.

use super::as_well;
use super::ratio::{alternative_words, error_beside, fit_beside};
use crate::assess::tolerance::ShapeTolerance;
use crate::assess::{
    FreeMotion, FreeMotionKind, PoseKind, Reason, ShapeKind, ShapeStatement, Verdict,
};
use crate::geometry::{Point3, Vector3};
use crate::text::{Lengths, whole_percent};

#[test]
fn equally_is_said_only_of_what_rounds_to_no_difference() {
    for (ratio, words) in [
        (1.0, "equally well"),
        (1.004, "equally well"),
        (0.997, "equally well"),
        (1.04, "nearly as well"),
        (0.98, "at least as well"),
    ] {
        assert_eq!(as_well(ratio), words);
    }
}

/// They are no difference of the shapes, and worth a look.
#[test]
fn holes_of_one_part_alone_are_told() {
    let nothing = ShapeStatement::nothing_met(ShapeTolerance {
        remainder: 1.0,
        springback: 5.0,
    });
    let words = |only_source, only_target| {
        let mut shape = nothing.clone();
        (shape.kind, shape.remainder) = (ShapeKind::Same, 0.1);
        (shape.borders.only_source, shape.borders.only_target) = (only_source, only_target);
        shape.words(Lengths::new(None))
    };
    assert!(words(2, 0).ends_with("of 1.00, 2 holes in the stamped part only"));
    assert!(words(0, 1).ends_with(", 1 hole in the crash part only"));
    // Where each part has some, that is a reason of its own.
    for of_both in [[0, 0], [1, 2]] {
        assert!(!words(of_both[0], of_both[1]).contains("hole"));
    }
}

/// What stands beside them as figures is not said in the sentences too; all else is.
#[test]
fn sentences_beside_figures_leave_these_out() {
    let lengths = Lengths::default();
    let good = Reason::InOrder {
        overlap: 0.87,
        p95: 0.4,
        rivals_sought: true,
    };
    assert!(good.words(lengths).contains("87"));
    let beside = good.words_beside_figures(lengths);
    assert_eq!(beside, "no other pose fits nearly as well");
    assert!(good.words(lengths).ends_with(&beside));
    let both = Reason::BothOverhang {
        source: 0.61,
        target: 0.55,
    };
    let beside = both.words_beside_figures(lengths);
    assert_eq!(beside, "neither part contains the other");
    let sliding = |held_across| Reason::Sliding {
        motion: FreeMotion {
            kind: FreeMotionKind::Extruded,
            direction: Vector3::x(),
            point: Point3::origin(),
        },
        held_across,
    };
    let by_one_end = sliding(Some(0.5)).words(lengths);
    assert!(
        by_one_end.ends_with("and only 50.0 % of the outlines across it lie together"),
        "{by_one_end}"
    );
    for held_across in [None, Some(0.02)] {
        let words = sliding(held_across).words(lengths);
        assert!(!words.contains("outlines"), "{words}");
    }
    let elsewhere = Reason::Elsewhere { share: 0.043 };
    assert!(
        elsewhere
            .words(lengths)
            .starts_with("4.3 % of the smaller part")
    );
    assert_eq!(
        Reason::Stopped.words_beside_figures(lengths),
        Reason::Stopped.words(lengths)
    );
}

#[test]
fn ratios_are_read_as_differences_of_the_error() {
    let pairs = [
        (1.08, "error 8 % higher"),
        (1.0004, "equal error"),
        (1.003, "error 0.3 % higher"),
        (0.93, "error 7 % lower"),
        (0.18, "error 5.6 × lower"),
        (12.34, "error 12.3 × higher"),
        (f64::INFINITY, "error far higher"),
        (0.0, "error far lower"),
    ];
    for (ratio, words) in pairs {
        assert_eq!(error_beside(ratio), words);
        assert_eq!(fit_beside(ratio, false), words);
    }
}

#[test]
fn no_error_is_told_of_poses_that_their_shapes_tell_apart() {
    let pairs = [
        (1.0, "as likely by its shape"),
        (1.5, "less likely by its shape"),
        (0.67, "more likely by its shape"),
    ];
    for (ratio, words) in pairs {
        assert_eq!(fit_beside(ratio, true), words);
    }
}

#[test]
fn a_pose_that_is_one_of_several_is_not_probably_right() {
    let check = Verdict::Check;
    assert!(check.advice(None).contains("probably right"));
    let certain = check.advice(Some(PoseKind::Certain));
    assert!(certain.contains("probably right"));
    let ambiguous = check.advice(Some(PoseKind::Ambiguous));
    assert!(ambiguous.contains("one of several"), "{ambiguous}");
}

#[test]
fn an_equal_alternative_is_not_called_worse() {
    let equal = "An alternative: it fits as well as the best pose.";
    assert_eq!(alternative_words(1.0, false), equal);
    assert_eq!(alternative_words(1.003, false), equal);
    assert_eq!(alternative_words(1.0, true), equal);
    assert!(alternative_words(1.082, false).contains(&format!("{} higher", whole_percent(0.08))));
    let by_shape = alternative_words(1.5, true);
    assert!(by_shape.contains("less likely") && !by_shape.contains('%'));
}
