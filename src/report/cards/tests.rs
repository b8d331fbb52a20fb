//! Cards written, and read back by the deck reader.

use proptest::prelude::*;

use super::*;
use crate::geometry::Pose;

fn pose(turn: [f64; 3], shift: [f64; 3], is_mirrored: bool) -> Similarity {
    let rigid = Similarity::from(Pose::new(Vector3::from(shift), Vector3::from(turn)));
    if is_mirrored {
        rigid.after(&Similarity::mirror_x())
    } else {
        rigid
    }
}

fn any_pose() -> impl Strategy<Value = Similarity> {
    // Plain turns and small ones too, not only those in general position.
    let angle = prop_oneof![
        -3.1..3.1f64,
        Just(0.0),
        Just(std::f64::consts::FRAC_PI_2),
        Just(std::f64::consts::PI),
        -1e-6..1e-6f64,
    ];
    let turn = [angle.clone(), angle.clone(), angle];
    let shift = proptest::array::uniform3(-5000.0..5000.0f64);
    (turn, shift, any::<bool>()).prop_map(|(r, t, m)| pose(r, t, m))
}

proptest! {
    #[test]
    fn every_form_keeps_nodes_within_a_micrometre(motion in any_pose()) {
        let corners = CardOptions::default().bounds.corners();
        for &form in CardForm::ALL {
            for layout in [Layout::Standard, Layout::I10, Layout::Long] {
                let is_long = layout == Layout::Long;
                let options = CardOptions {
                    deck_layout: layout,
                    stamped_layout: layout,
                    ..CardOptions::default()
                };
                let cards = write(form, &motion, &options).unwrap();
                let limit = if is_long { 1e-9 } else { 1e-3 };
                let error = cards.largest_node_error(&corners);
                prop_assert!(error <= limit, "{:?} {}\n{}", form, error, cards.text);
                let r = cards.read_back.rotation;
                prop_assert!((r.transpose() * r - Matrix3::identity()).amax() < 1e-7);
                let longest = cards.text.lines().filter(|l| !l.starts_with('$')).map(str::len).max();
                let widest = if is_long { 160 } else { 80 };
                prop_assert!(longest <= Some(widest));
            }
        }
    }

    #[test]
    fn a_part_far_from_the_origin_loses_no_more(
        motion in any_pose(),
        middle in proptest::array::uniform3(-5000.0..5000.0f64),
    ) {
        let middle = Point3::from(middle);
        let size = Vector3::repeat(500.0);
        let bounds = Aabb { min: middle - size, max: middle + size };
        for &form in CardForm::ALL {
            let options = CardOptions { bounds, ..CardOptions::default() };
            let cards = write(form, &motion, &options).unwrap();
            let error = cards.largest_node_error(&bounds.corners());
            prop_assert!(error <= 1e-3, "{:?} {}\n{}", form, error, cards.text);
        }
    }

    #[test]
    fn any_text_is_read_back_without_panic(text in "[-+0-9.,\n $]{0,200}") {
        for name in ["INCLUDE_STAMPED_PART_MATRIX", "DEFINE_TRANSFORMATION+"] {
            let _ = read_back(&format!("*{name}\n{text}"));
        }
    }
}

#[test]
fn the_stamped_part_card_as_it_is_written() {
    let motion = Similarity {
        rotation: Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        translation: Vector3::new(1234.5, -20.25, 0.0),
        scale: 1.0,
    };
    let options = CardOptions {
        file_name: "door.dynain".into(),
        receiver: Receiver::Part(2000012),
        search_radius: 2.3456,
        mapped_percent: 98.765,
        comments: vec!["crash.k from door.dynain".into()],
        ..CardOptions::default()
    };
    let cards = write(CardForm::StampedPart, &motion, &options).unwrap();
    let expected = "\
$ crash.k from door.dynain
$ The matrix carries the stamped part to the crash part: crash = R * stamped + t
*INCLUDE_STAMPED_PART_MATRIX
door.dynain
$#     pid     thick     pstrn    strain    stress    incout                rmax
   2000012         0         0         0         0         0               2.346
$#     r11       r12       r13        xp    tensor    thkscl
        0.       -1.        0.    1234.5         0        1.
        1.        0.        0.    -20.25
        0.        0.        1.        0.
$#    isym    iafter   percele    iortho             isrcout     mtype
         0         0     98.76         0                   0         0
        0.        0.        0.
        0.        0.        0.        0.        0.        0.
";
    assert_eq!(cards.text, expected);
    assert_eq!(cards.read_back, motion);
    let set = CardOptions {
        receiver: Receiver::Set(7),
        ..options
    };
    let cards = write(CardForm::StampedPartInverse, &motion, &set).unwrap();
    assert!(cards.text.contains("*INCLUDE_STAMPED_SET_MATRIX_INVERSE\n"));
    assert!(cards.text.contains("stamped = R * crash + t"));
}

#[test]
fn cards_of_the_opposite_hand_tell_of_the_second_sheet() {
    let motion = pose([0.1, 0.2, 0.3], [1.0, 2.0, 3.0], true);
    let beside = Aabb {
        min: Point3::new(5.0, -9.0, -9.0),
        max: Point3::new(9.0, 9.0, 9.0),
    };
    let told = |form, motion: &Similarity, bounds| {
        let options = CardOptions {
            bounds,
            ..CardOptions::default()
        };
        let text = write(form, motion, &options).unwrap().text;
        ["unmirrored sheet stays", "(--moved)"].map(|words| text.contains(words))
    };
    let around = CardOptions::default().bounds;
    for form in [CardForm::StampedPart, CardForm::StampedPartInverse] {
        assert_eq!(told(form, &motion, beside), [true, false]);
        assert_eq!(told(form, &motion, around), [true, true]);
        assert_eq!(told(form, &Similarity::identity(), around), [false, false]);
    }
    assert_eq!(
        told(CardForm::IncludeTransform, &motion, around),
        [false, false]
    );
}

#[test]
fn what_cannot_be_written_is_refused() {
    let scaled = Similarity::from_scale(25.4);
    let options = CardOptions::default();
    for &form in CardForm::ALL {
        let error = write(form, &scaled, &options).unwrap_err();
        assert_eq!(error, CardError::Scaled { scale: 25.4 });
        assert!(error.to_string().contains("the unit of the crash model"));
        let nearly_rigid = Similarity::from_scale(1.000_008_3);
        let error = write(form, &nearly_rigid, &options).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("match again with a rigid motion")
        );
    }
    let id = 12_345_678_901;
    let options = CardOptions {
        receiver: Receiver::Part(id),
        ..CardOptions::default()
    };
    let motion = Similarity::identity();
    let error = write(CardForm::StampedPart, &motion, &options).unwrap_err();
    assert_eq!(error, CardError::IdTooLong { id, width: 10 });
    let options = CardOptions {
        file_name: "x".repeat(237),
        ..CardOptions::default()
    };
    let error = write(CardForm::StampedPart, &motion, &options).unwrap_err();
    assert!(matches!(error, CardError::FileName { fault, .. } if fault.contains("236")));
    assert_eq!(read_back("*NODE\n"), Err(ReadBackError::NoKeyword));
}

#[test]
fn long_names_go_on_over_lines() {
    let options = CardOptions {
        file_name: "n".repeat(236),
        ..CardOptions::default()
    };
    let motion = pose([0.1, 0.2, 0.3], [1.0, 2.0, 3.0], false);
    let cards = write(CardForm::StampedPart, &motion, &options).unwrap();
    let names: Vec<usize> = cards
        .text
        .lines()
        .filter(|l| l.starts_with('n'))
        .map(str::len)
        .collect();
    assert_eq!(names, [80, 80, 80]);
}

#[test]
fn every_symmetry_of_other_peoples_cards() {
    let deck = |flags: &str, points: &str| {
        let rows = "1.,0.,0.,10.\n0.,1.,0.,0.\n0.,0.,1.,0.\n";
        let text = format!("*INCLUDE_STAMPED_PART_MATRIX\na,b.k\n1\n{rows}{flags}\n{points}\n");
        read_back(&text).unwrap().apply(&Point3::new(1.0, 2.0, 3.0))
    };
    assert_eq!(deck("0", ""), Point3::new(11.0, 2.0, 3.0));
    assert_eq!(deck("1,0", ""), Point3::new(9.0, 2.0, 3.0));
    assert_eq!(deck("1,1", ""), Point3::new(-11.0, 2.0, 3.0));
    assert_eq!(deck("2", ""), Point3::new(11.0, -2.0, 3.0));
    assert_eq!(deck("3", ""), Point3::new(9.0, -2.0, 3.0));
    // The plane z = 5.
    let moved = deck("4", "0,0,5\n1,0,5,0,1,5");
    assert!((moved - Point3::new(11.0, 2.0, 7.0)).norm() < 1e-12);
}

#[test]
fn a_search_radius_is_rounded_up_by_a_thousandth_in_any_unit() {
    for (radius, rounded) in [
        (5.3, 5.3),
        (5.300_01, 5.301),
        (0.005_300_1, 0.005_301),
        (20.0, 20.0),
        (123.456_7, 123.457),
        (2e-4, 0.001),
    ] {
        assert_eq!(rounded_radius(radius), rounded);
    }
}
