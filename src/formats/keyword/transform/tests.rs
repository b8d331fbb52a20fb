//! Unit tests of transformations.

use proptest::prelude::*;

use super::super::block::Blocks;
use super::super::card::Layout;
use super::super::source_file::SourceFile;
use super::*;
use crate::geometry::Similarity;

fn nodes(id: u64) -> Option<Point3> {
    match id {
        1 => Some(Point3::new(0.0, 0.0, 0.0)),
        2 => Some(Point3::new(0.0, 0.0, 10.0)),
        3 => Some(Point3::new(5.0, 0.0, 0.0)),
        4 => Some(Point3::new(1.0, 1.0, 1.0)),
        5 => Some(Point3::new(1.0, 2.0, 1.0)),
        6 => Some(Point3::new(-1.0, 1.0, 1.0)),
        _ => None,
    }
}

fn read(text: &str) -> ((u64, Transformation), Diagnostics) {
    let file = SourceFile::new("t.k", text);
    let block = Blocks::new(&file, Layout::Standard).next().unwrap();
    let mut diagnostics = Diagnostics::default();
    let found = Transformation::from_block(&block, &mut diagnostics).unwrap();
    (found, diagnostics)
}

fn rows(text: &str) -> Transformation {
    let ((id, found), diagnostics) = read(&format!("*DEFINE_TRANSFORMATION\n7\n{text}\n"));
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    assert_eq!(id, 7);
    found
}

/// Where the rows carry a point.
#[track_caller]
fn carries(text: &str, from: [f64; 3], to: [f64; 3]) {
    let matrix = rows(text).matrix(&nodes).unwrap();
    let found = matrix.transform_point(&Point3::from(from));
    assert!((found - Point3::from(to)).norm() < 1e-12, "{text}: {found}");
}

#[test]
fn every_option_by_hand() {
    let p = [1.0, 2.0, 3.0];
    carries("SCALE,2,,4", p, [2.0, 2.0, 12.0]);
    carries("TRANSL,1,-1,.5", p, [2.0, 1.0, 3.5]);
    carries("transl2nd,1,2,4.", p, [1.0, 2.0, 7.0]);
    carries("TRANSL2ND,1,2,0", p, [1.0, 2.0, 13.0]);
    carries("ROTATE,0,0,2,0,0,0,90", p, [-2.0, 1.0, 3.0]);
    carries("ROTATE,0,0,1,1,0,0,180", p, [1.0, -2.0, 3.0]);
    carries(
        "POINT,8,0,0,0\nPOINT,9,0,0,1\nROTATE,8,9,90",
        p,
        [-2.0, 1.0, 3.0],
    );
    carries("ROTATE3NA,1,2,3,180", p, [9.0, -2.0, 3.0]);
    carries("ROTATE3NA,1,2,,180", p, [-1.0, -2.0, 3.0]);
    carries("ROTATE,0,0,1", p, p);
    carries("MIRROR,0,0,0,0,3,0", p, [1.0, -2.0, 3.0]);
    carries("MIRROR,1,1,1,2,1,1", [3.0, 2.0, 3.0], [-1.0, 2.0, 3.0]);
    carries(
        "MATRIX\n0,1,0,0,-1,0,0,0\n0,0,1,0,10,20,30,1",
        p,
        [8.0, 21.0, 33.0],
    );
    // Node 1 goes to node 4; z turns to y, x turns to −x.
    carries("POS6N,1,2,3,4,5,6", [0.0, 0.0, 2.0], [1.0, 3.0, 1.0]);
    carries("POS6N,1,2,3,4,5,6", [2.0, 0.0, 0.0], [-1.0, 1.0, 1.0]);
}

#[test]
fn rows_apply_from_top_to_bottom() {
    carries(
        "TRANSL,10,0,0\nROTATE,0,0,1,0,0,0,90",
        [0.0; 3],
        [0.0, 10.0, 0.0],
    );
    carries(
        "ROTATE,0,0,1,0,0,0,90\nTRANSL,10,0,0",
        [0.0; 3],
        [10.0, 0.0, 0.0],
    );
}

#[test]
fn points_are_carried_by_the_rows_above_their_use() {
    // The axis moves with the translation, wherever the POINT rows stand.
    let axis = "POINT,1,0,0,0\nPOINT,2,0,0,1";
    let turn = "ROTATE,1,2,180";
    for text in [
        format!("{axis}\nTRANSL,5,0,0\n{turn}"),
        format!("TRANSL,5,0,0\n{turn}\n{axis}"),
    ] {
        carries(&text, [1.0, 1.0, 0.0], [4.0, -1.0, 0.0]);
    }
}

#[test]
fn fixed_columns_and_titles() {
    let deck = "*DEFINE_TRANSFORMATION_TITLE\nmy title\n$ id\n         3\n\
                TRANSL           0.0       0.0      50.0\n";
    let ((id, found), diagnostics) = read(deck);
    assert!(diagnostics.is_empty());
    assert_eq!(id, 3);
    let expected = TransformRow::Translate(Vector3::new(0.0, 0.0, 50.0));
    assert_eq!(found.rows, [expected]);
}

#[test]
fn what_cannot_be_done_is_said() {
    let error = |text| rows(text).matrix(&nodes).unwrap_err();
    assert_eq!(
        error("TRANSL,1,0,0\nTRANSL2ND,1,99,4"),
        TransformError::MissingNode { row: 2, node: 99 }
    );
    assert_eq!(
        error("ROTATE,8,9,5"),
        TransformError::MissingPoint { row: 1, point: 8 }
    );
    assert_eq!(
        error("ROTATE,0,0,0,1,0,0,5"),
        TransformError::NoDirection { row: 1 }
    );
    assert_eq!(
        error("POS6N,1,2,2,4,5,6"),
        TransformError::Collinear { row: 1 }
    );
    assert_eq!(
        error("MATRIX\n1,0,0,5,0,1,0\n0,0,1"),
        TransformError::NotAffine { row: 1 }
    );
    let ((_, found), diagnostics) = read("*DEFINE_TRANSFORMATION\n1\nTWIST,1\nTRANSL,x\nSCALE,2\n");
    assert_eq!(found.rows.len(), 1);
    assert_eq!(diagnostics.total(), 2);
    let ((_, found), diagnostics) = read("*DEFINE_TRANSFORMATION\n1\nMATRIX\n1\n");
    assert_eq!((found.rows.len(), diagnostics.total()), (0, 1));
}

#[test]
fn node_ids_take_an_offset() {
    let mut shifted = rows("POS6N,1,2,3,4,5,6\nROTATE3NA,1,2,,9\nPOINT,1,0,0,0\nTRANSL2ND,1,2,1");
    shifted.offset_nodes(100);
    assert_eq!(
        shifted,
        rows(
            "POS6N,101,102,103,104,105,106\nROTATE3NA,101,102,,9\nPOINT,1,0,0,0\nTRANSL2ND,101,102,1"
        )
    );
}

fn number() -> impl Strategy<Value = f64> {
    -1000.0..1000.0f64
}

proptest! {
    #[test]
    fn rotations_and_mirrors_stay_rigid(
        axis in [number(), number(), number()],
        through in [number(), number(), number()],
        angle_deg in -360.0..360.0f64,
    ) {
        let (axis, through) = (Vector3::from(axis), Point3::from(through));
        prop_assume!(axis.norm() > 1e-3);
        let rows = vec![
            TransformRow::Rotate { axis, through, angle_deg },
            TransformRow::Mirror { point: through, toward: through + axis },
        ];
        let matrix = Transformation { rows }.matrix(&nodes).unwrap();
        let motion = Similarity::from_matrix4(&matrix, 1e-12).unwrap();
        prop_assert!(motion.is_mirrored());
        prop_assert_eq!(motion.scale, 1.0);
        // The point on axis and plane stays.
        prop_assert!((motion.apply(&through) - through).norm() < 1e-9);
    }

    #[test]
    fn six_points_do_what_they_promise(p in proptest::array::uniform18(number())) {
        let p: Vec<Point3> = p.chunks(3).map(|c| Point3::new(c[0], c[1], c[2])).collect();
        let area = |a: usize| (p[a + 1] - p[a]).cross(&(p[a + 2] - p[a])).norm();
        prop_assume!(area(0) > 1.0 && area(3) > 1.0);
        let point = |(i, position): (usize, &Point3)| TransformRow::Point {
            id: i as u64 + 1,
            position: *position,
        };
        let mut rows: Vec<_> = p.iter().enumerate().map(point).collect();
        rows.push(TransformRow::PositionByPoints([1, 2, 3, 4, 5, 6]));
        let matrix = Transformation { rows }.matrix(&nodes).unwrap();
        let motion = Similarity::from_matrix4(&matrix, 1e-9).unwrap();
        let moved: Vec<Point3> = p.iter().map(|p| motion.apply(p)).collect();
        prop_assert!(!motion.is_mirrored());
        prop_assert!((moved[0] - p[3]).norm() < 1e-9, "point 1 exactly");
        let along = (p[4] - p[3]).normalize();
        prop_assert!((moved[1] - p[3]).normalize().dot(&along) > 1.0 - 1e-9);
        let normal = along.cross(&(p[5] - p[3])).normalize();
        prop_assert!((moved[2] - p[3]).normalize().dot(&normal).abs() < 1e-6);
        prop_assert!((moved[2] - p[3]).dot(&(p[5] - p[3] - along * along.dot(&(p[5] - p[3])))) > 0.0);
    }

    #[test]
    fn never_panics(text in "(ROTATE|POS6P|MATRIX|POINT|X)?[-0-9.,e\n]{0,80}") {
        let deck = format!("*DEFINE_TRANSFORMATION\n1\n{text}\n");
        let ((_, found), _) = read(&deck);
        let _ = found.matrix(&nodes);
    }
}
