//! The matrix as text in every form users ask for, and back from text.

use std::fmt::Write as _;

use crate::geometry::{Matrix3, Matrix4, MatrixError, Rotation, Similarity, Vector3};
use crate::text::trimmed;

/// Largest entry of |AᵀA/c² − I| that a pasted matrix may have; six written digits stay below it.
const ORTHOGONALITY_TOLERANCE: f64 = 1e-4;

/// What is told of a matrix with a negative determinant.
const MIRRORS: &str = "the matrix mirrors, as its determinant is negative: it is the pose of a part of the opposite hand";
/// What is told of a matrix that ends in 0 0 0 1 by columns.
const TRANSPOSED: &str = "the translation stands in the last row, so the matrix was taken as transposed, column by \
                          column; write it in the last column to have it read by rows";

/// A way to write the pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MatrixForm {
    /// 4×4, row by row.
    Rows,
    /// 4×4, column by column.
    Columns,
    /// 4×4 of the way back (stamped from crash), row by row.
    Inverse,
    /// R, t and scale on one line between commas.
    Csv,
    /// Unit quaternion and translation.
    Quaternion,
    /// JSON with matrix, rotation, translation and scale.
    Json,
}

impl MatrixForm {
    /// Every form, in the order of the menus.
    pub const ALL: &[Self] = &[
        Self::Rows,
        Self::Columns,
        Self::Inverse,
        Self::Csv,
        Self::Quaternion,
        Self::Json,
    ];

    /// Its name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Rows => "4×4 by rows",
            Self::Columns => "4×4 by columns",
            Self::Inverse => "Inverse 4×4 by rows",
            Self::Csv => "R and t as CSV",
            Self::Quaternion => "Quaternion and t",
            Self::Json => "JSON",
        }
    }

    /// A word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Columns => "columns",
            Self::Inverse => "inverse",
            Self::Csv => "csv",
            Self::Quaternion => "quaternion",
            Self::Json => "json",
        }
    }

    /// [`MatrixForm::write`] with remarks at its head, for a file; JSON has no place for them.
    pub fn write_with(self, crash_from_stamped: &Similarity, remarks: &[String]) -> String {
        let text = self.write(crash_from_stamped);
        if self == Self::Json {
            return text;
        }
        let lines = remarks.iter().flat_map(|remark| remark.lines());
        let head: String = lines.map(|line| format!("# {line}\n")).collect();
        head + &text
    }

    /// The text of `crash_from_stamped`, ending in a newline. Every number is the shortest text
    /// that reads back to the same bits. Lines that begin with `#` say what is what.
    pub fn write(self, crash_from_stamped: &Similarity) -> String {
        let motion = crash_from_stamped;
        match self {
            Self::Rows => {
                let head = "# crash = M * stamped, column vectors, M row by row\n";
                head.to_owned() + &table(&motion.to_rows())
            }
            Self::Columns => {
                let rows = motion.to_rows();
                let columns = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
                let head = "# crash = M * stamped, column vectors, M column by column\n";
                head.to_owned() + &table(&columns)
            }
            Self::Inverse => {
                let head = "# stamped = M * crash, column vectors, M row by row\n";
                head.to_owned() + &table(&motion.inverse().to_rows())
            }
            Self::Csv => csv(motion),
            Self::Quaternion => quaternion(motion),
            Self::Json => json(motion),
        }
    }
}

/// The shortest text that reads back to the same bits; a negative zero loses its sign.
pub fn number(value: f64) -> String {
    format!("{:?}", value + 0.0)
}

fn table(rows: &[[f64; 4]; 4]) -> String {
    let cells = rows.map(|row| row.map(number));
    let width = cells.iter().flatten().map(String::len).max().unwrap_or(0);
    let mut text = String::new();
    for row in cells {
        let row = row.map(|cell| format!("{cell:>width$}"));
        text += row.join("  ").trim_end();
        text.push('\n');
    }
    text
}

fn csv(motion: &Similarity) -> String {
    let rotation = motion.rotation.transpose();
    let values = rotation.iter().chain(motion.translation.iter());
    let values: Vec<String> = values.chain([&motion.scale]).map(|&v| number(v)).collect();
    let head =
        "# crash = scale * R * stamped + t\nr11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz,scale\n";
    format!("{head}{}\n", values.join(","))
}

/// The rotation of a motion; of a mirrored one the rotation after the mirror x → −x.
pub(super) fn proper_rotation(motion: &Similarity) -> Rotation {
    let mut rotation = motion.rotation;
    if motion.is_mirrored() {
        rotation *= Similarity::mirror_x().rotation;
    }
    let turn = nalgebra::Rotation3::from_matrix_unchecked(rotation);
    Rotation::from_rotation_matrix(&turn)
}

fn quaternion(motion: &Similarity) -> String {
    let mut text = String::from("# crash = scale * q * stamped * q^-1 + t\n");
    if motion.is_mirrored() {
        text += "# the stamped part is mirrored first: x becomes -x\n";
    }
    let q = proper_rotation(motion);
    let t = motion.translation;
    let mut line = |names: &str, values: &[f64]| {
        let values: Vec<String> = values.iter().map(|&v| number(v)).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "# {names}\n{}", values.join(" "));
    };
    line("qw qx qy qz", &[q.w, q.i, q.j, q.k]);
    line("tx ty tz", &[t.x, t.y, t.z]);
    line("scale", &[motion.scale]);
    text
}

fn json(motion: &Similarity) -> String {
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|&v| number(v)).collect();
        format!("[{}]", values.join(", "))
    };
    let rows = motion.to_rows().map(|row| list(&row)).join(",\n    ");
    let r = motion.rotation;
    let rotation: [String; 3] = std::array::from_fn(|i| list(&[r[(i, 0)], r[(i, 1)], r[(i, 2)]]));
    let rotation = rotation.join(",\n    ");
    let translation = list(motion.translation.as_slice());
    let scale = number(motion.scale);
    format!(
        "{{\n  \"direction\": \"crash = matrix * stamped (column vectors)\",\n  \
         \"matrix\": [\n    {rows}\n  ],\n  \"rotation\": [\n    {rotation}\n  ],\n  \
         \"translation\": {translation},\n  \"scale\": {scale}\n}}\n"
    )
}

/// How a pasted text was laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixLayout {
    /// 16 numbers, row by row.
    Rows4x4,
    /// 16 numbers, column by column.
    Columns4x4,
    /// 12 numbers: three rows of R and t side by side.
    Rows3x4,
    /// 12 or 13 numbers: R row by row, t, and perhaps the scale.
    RotationTranslation,
    /// 7 or 8 numbers: quaternion w x y z, t, and perhaps the scale.
    QuaternionTranslation,
}

impl MatrixLayout {
    /// What was understood, in words.
    pub fn label(self) -> &'static str {
        match self {
            Self::Rows4x4 => "a 4×4 matrix, row by row",
            Self::Columns4x4 => "a 4×4 matrix, column by column",
            Self::Rows3x4 => "a 3×4 matrix, row by row",
            Self::RotationTranslation => "a rotation matrix row by row, then a translation",
            Self::QuaternionTranslation => "a quaternion w x y z, then a translation",
        }
    }
}

/// A matrix that was read from text.
#[derive(Debug, Clone, PartialEq)]
pub struct ParsedMatrix {
    /// The motion, nothing rounded or projected.
    pub motion: Similarity,
    /// How the text was laid out.
    pub layout: MatrixLayout,
    /// Doubts worth telling, one sentence each.
    pub notes: Vec<&'static str>,
}

impl ParsedMatrix {
    /// What few poses do and nobody should overlook: `scale 2 · det +1`, `mirrored`; `None` for a pose that only
    /// turns and shifts.
    pub fn remark(&self) -> Option<String> {
        let Similarity { scale, .. } = self.motion;
        let scaled = ((scale - 1.0).abs() > ORTHOGONALITY_TOLERANCE)
            .then(|| format!("scale {}", trimmed(scale, 6)));
        match (scaled, self.motion.is_mirrored()) {
            (Some(scaled), true) => Some(format!("{scaled} · mirrored")),
            (Some(scaled), false) => Some(format!("{scaled} · det +1")),
            (None, true) => Some("mirrored".to_owned()),
            (None, false) => None,
        }
    }
}

/// Why a text holds no pose.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ParseMatrixError {
    /// Not a number of numbers that makes sense.
    #[error("the text holds {0} numbers, a pose has 16, 12, 13, 7 or 8")]
    Count(usize),
    /// The numbers make no similarity.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// A quaternion of this length.
    #[error("the quaternion w x y z has the length {}, not 1", trimmed(*.0, 3))]
    NotUnit(f64),
    /// Eight numbers that are two rows of R | t.
    #[error("the text holds two rows of a matrix, a pose has three or four")]
    TwoRows,
}

/// Reads a pose from text: numbers between blanks, tabs, commas, semicolons, bracketed or not,
/// also with decimal commas, by rows or by columns, or JSON with a `matrix`. Lines that begin with
/// `#`, `$`, `%` or `//` are comments. Says what it understood; the order follows from where 0 0 0 1
/// stands.
pub fn parse_matrix(text: &str) -> Result<ParsedMatrix, ParseMatrixError> {
    let is_comment = |line: &str| ["#", "$", "%", "//"].iter().any(|c| line.starts_with(c));
    let lines: Vec<&str> = text
        .lines()
        .map(str::trim)
        .filter(|l| !is_comment(l))
        .collect();
    let text = lines.join("\n");
    let text = json_matrix(&text).unwrap_or(&text);
    // Eight numbers with decimal commas are sixteen whole numbers too, which are no motion.
    let mut found = matrix_of(&numbers(text, false));
    if let Err(error) = &found {
        let with_decimal_commas = matrix_of(&numbers(text, true));
        let is_counted = !matches!(with_decimal_commas, Err(ParseMatrixError::Count(_)));
        if with_decimal_commas.is_ok() || matches!(error, ParseMatrixError::Count(_)) && is_counted
        {
            found = with_decimal_commas.map(|mut found| {
                found.notes.push("commas were read as decimal points");
                found
            });
        }
    }
    let mut found = found?;
    if found.motion.is_mirrored() {
        found.notes.push(MIRRORS);
    }
    Ok(found)
}

fn matrix_of(values: &[f64]) -> Result<ParsedMatrix, ParseMatrixError> {
    let mut notes = Vec::new();
    let (motion, layout) = match values.len() {
        16 => four_by_four(values, &mut notes)?,
        12 | 13 => twelve(values)?,
        7 | 8 => seven(values)?,
        n => return Err(ParseMatrixError::Count(n)),
    };
    Ok(ParsedMatrix {
        motion,
        layout,
        notes,
    })
}

/// The list after the key `matrix`, if the text is JSON.
fn json_matrix(text: &str) -> Option<&str> {
    let from = text.find("\"matrix\"")? + "\"matrix\"".len();
    let rest = &text[from..];
    let open = rest.find('[')?;
    let mut depth = 0usize;
    for (at, c) in rest.char_indices().skip_while(|(at, _)| *at < open) {
        match c {
            '[' => depth += 1,
            ']' if depth == 1 => return Some(&rest[open..=at]),
            ']' => depth -= 1,
            _ => {}
        }
    }
    None
}

fn numbers(text: &str, decimal_commas: bool) -> Vec<f64> {
    let is_separator =
        |c: char| c.is_whitespace() || "[](){};|:=\"".contains(c) || (c == ',' && !decimal_commas);
    let number = |word: &str| {
        let first = word.trim_start_matches(['+', '-']).chars().next()?;
        if !first.is_ascii_digit() && first != '.' && first != ',' {
            return None;
        }
        let plain = word.replace(['d', 'D'], "e").replace(',', ".");
        plain.parse::<f64>().ok()
    };
    text.split(is_separator).filter_map(number).collect()
}

fn similarity(matrix: &Matrix4) -> Result<Similarity, ParseMatrixError> {
    Ok(Similarity::from_matrix4(matrix, ORTHOGONALITY_TOLERANCE)?)
}

fn four_by_four(
    values: &[f64],
    notes: &mut Vec<&'static str>,
) -> Result<(Similarity, MatrixLayout), ParseMatrixError> {
    let rows = Matrix4::from_row_slice(values);
    let last_row = values[12..] == [0.0, 0.0, 0.0, 1.0];
    let last_column = [values[3], values[7], values[11], values[15]] == [0.0, 0.0, 0.0, 1.0];
    if last_row && last_column && rows != rows.transpose() {
        notes.push("without a translation rows and columns look alike; rows were assumed");
    }
    if last_column && !last_row {
        notes.push(TRANSPOSED);
        return Ok((similarity(&rows.transpose())?, MatrixLayout::Columns4x4));
    }
    Ok((similarity(&rows)?, MatrixLayout::Rows4x4))
}

fn from_parts(rotation: &Matrix3, translation: &[f64], scale: f64) -> Matrix4 {
    let mut matrix = (rotation * scale).to_homogeneous();
    let translation = Vector3::from_column_slice(translation);
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&translation);
    matrix
}

fn twelve(values: &[f64]) -> Result<(Similarity, MatrixLayout), ParseMatrixError> {
    if values.len() == 12 {
        let mut rows = values.to_vec();
        rows.extend([0.0, 0.0, 0.0, 1.0]);
        if let Ok(motion) = similarity(&Matrix4::from_row_slice(&rows)) {
            return Ok((motion, MatrixLayout::Rows3x4));
        }
    }
    let rotation = Matrix3::from_row_slice(&values[..9]);
    let scale = values.get(12).copied().unwrap_or(1.0);
    let mut motion = similarity(&from_parts(&rotation, &values[9..12], 1.0))?;
    motion.scale *= scale;
    if motion.scale <= 0.0 || !motion.scale.is_finite() {
        return Err(MatrixError::NotOrthogonal { deviation: 1.0 }.into());
    }
    Ok((motion, MatrixLayout::RotationTranslation))
}

/// Quaternions are written with few digits, but not with a length that is plainly another.
const UNIT_TOLERANCE: f64 = 0.01;

fn is_unit(length: f64) -> bool {
    (length - 1.0).abs() <= UNIT_TOLERANCE
}

fn seven(values: &[f64]) -> Result<(Similarity, MatrixLayout), ParseMatrixError> {
    let q = nalgebra::Quaternion::new(values[0], values[1], values[2], values[3]);
    let scale = values.get(7).copied().unwrap_or(1.0);
    let [first, second] = [0, 4].map(|at| Vector3::from_column_slice(&values[at..at + 3]));
    let are_rows = [first, second].iter().all(|row| is_unit(row.norm()))
        && first.dot(&second).abs() <= UNIT_TOLERANCE;
    if values.len() == 8 && are_rows && scale != 1.0 {
        return Err(ParseMatrixError::TwoRows);
    }
    if !is_unit(q.norm()) {
        return Err(ParseMatrixError::NotUnit(q.norm()));
    }
    let rotation = *Rotation::from_quaternion(q).to_rotation_matrix().matrix();
    let motion = similarity(&from_parts(&rotation, &values[4..7], scale))?;
    Ok((motion, MatrixLayout::QuaternionTranslation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use proptest::prelude::*;

    fn pose(turn: [f64; 3], shift: [f64; 3], scale: f64, mirrored: bool) -> Similarity {
        let rigid = Similarity::from(Pose::new(Vector3::from(shift), Vector3::from(turn)));
        let first = if mirrored {
            Similarity::mirror_x()
        } else {
            Similarity::identity()
        };
        Similarity {
            scale,
            ..rigid.after(&first)
        }
    }

    fn any_pose() -> impl Strategy<Value = Similarity> {
        let turn = proptest::array::uniform3(-3.0..3.0f64);
        let shift = proptest::array::uniform3(-5000.0..5000.0f64);
        let scale = prop_oneof![Just(1.0), Just(25.4), 0.1..10.0f64];
        (turn, shift, scale, any::<bool>()).prop_map(|(r, t, s, m)| pose(r, t, s, m))
    }

    fn distance(a: &Similarity, b: &Similarity) -> f64 {
        (a.to_matrix4() - b.to_matrix4()).amax()
    }

    proptest! {
        #[test]
        fn every_form_reads_back(motion in any_pose()) {
            for &form in MatrixForm::ALL {
                let parsed = parse_matrix(&form.write(&motion));
                let parsed = parsed.map_err(|e| TestCaseError::fail(format!("{form:?}: {e}")))?;
                let mut back = parsed.motion;
                if form == MatrixForm::Inverse {
                    back = back.inverse();
                }
                if form == MatrixForm::Quaternion && motion.is_mirrored() {
                    back = back.after(&Similarity::mirror_x());
                }
                prop_assert!(distance(&back, &motion) < 1e-9, "{:?}", form);
            }
        }

        #[test]
        fn a_rigid_pose_is_bit_identical_by_rows(
            turn in proptest::array::uniform3(-3.0..3.0f64),
            shift in proptest::array::uniform3(-5000.0..5000.0f64),
        ) {
            let motion = pose(turn, shift, 1.0, false);
            for form in [MatrixForm::Rows, MatrixForm::Columns, MatrixForm::Json, MatrixForm::Csv] {
                let parsed = parse_matrix(&form.write(&motion)).unwrap();
                prop_assert_eq!(parsed.motion, motion);
            }
        }

        #[test]
        fn any_text_is_no_panic(text in "[-+0-9.,;eE\"matrix\\[\\]\n ]{0,200}") {
            let _ = parse_matrix(&text);
        }
    }

    #[test]
    fn other_peoples_texts() {
        let expected = Similarity {
            rotation: Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
            translation: Vector3::new(10.5, 20.0, -30.0),
            scale: 1.0,
        };
        let cases = [
            (
                "[0 -1 0 10.5; 1 0 0 20; 0 0 1 -30; 0 0 0 1]",
                MatrixLayout::Rows4x4,
            ),
            (
                "0,-1,0,10.5\n1,0,0,20\n0,0,1,-30\n0,0,0,1\n",
                MatrixLayout::Rows4x4,
            ),
            (
                "0\t1\t0\t0\n-1\t0\t0\t0\n0\t0\t1\t0\n10.5\t20\t-30\t1",
                MatrixLayout::Columns4x4,
            ),
            (
                "[[0.,-1.,0.,10.5],[1,0,0,20],[0,0,1,-30]]",
                MatrixLayout::Rows3x4,
            ),
            (
                "0 -1 0  1 0 0  0 0 1  10.5 2.0D1 -30",
                MatrixLayout::RotationTranslation,
            ),
            (
                "0;-1;0;10,5;1;0;0;20;0;0;1;-30;0;0;0;1",
                MatrixLayout::Rows4x4,
            ),
            (
                "{\"scale\": 1, \"matrix\": [[0,-1,0,10.5],[1,0,0,20],[0,0,1,-30],[0,0,0,1]], \"rmse\": 3}",
                MatrixLayout::Rows4x4,
            ),
        ];
        for (text, layout) in cases {
            let parsed = parse_matrix(text).unwrap();
            assert_eq!((parsed.motion, parsed.layout), (expected, layout), "{text}");
        }
        let half = "0.7071067811865476 0 0 0.7071067811865476 10.5 20 -30";
        let parsed = parse_matrix(half).unwrap();
        assert!(distance(&parsed.motion, &expected) < 1e-15);
    }

    #[test]
    fn remarks_stand_before_the_numbers_and_are_read_past() {
        let motion = Similarity {
            translation: Vector3::new(7.0, 8.0, 9.0),
            ..Similarity::identity()
        };
        let remarks = ["lengths in mm".to_owned(), "16 by 9\nx 1000".to_owned()];
        for form in MatrixForm::ALL
            .iter()
            .filter(|form| **form != MatrixForm::Inverse)
        {
            let text = form.write_with(&motion, &remarks);
            assert_eq!(
                text.starts_with("# lengths in mm\n"),
                *form != MatrixForm::Json
            );
            assert_eq!(parse_matrix(&text).unwrap().motion, motion, "{form:?}");
        }
    }

    #[test]
    fn a_scale_and_a_mirror_are_remarked() {
        for (text, remark) in [
            ("1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1", None),
            ("1.00001 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1", None),
            ("2 0 0 5 0 2 0 6 0 0 2 7 0 0 0 1", Some("scale 2 · det +1")),
            ("-1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1", Some("mirrored")),
            (
                "-25.4 0 0 5 0 25.4 0 6 0 0 25.4 7 0 0 0 1",
                Some("scale 25.4 · mirrored"),
            ),
        ] {
            let parsed = parse_matrix(text).unwrap();
            assert_eq!(parsed.remark().as_deref(), remark, "{text}");
        }
    }

    #[test]
    fn a_mirror_and_a_transposed_matrix_are_told() {
        let notes = |text: &str| parse_matrix(text).unwrap().notes;
        assert_eq!(notes("-1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1"), [MIRRORS]);
        assert_eq!(notes("-1 0 0 5 0 -1 0 6 0 0 1 7 0 0 0 1"), [""; 0]);
        assert_eq!(notes("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1"), [TRANSPOSED]);
        let both = notes("-1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1");
        assert_eq!(both, [TRANSPOSED, MIRRORS]);
    }

    #[test]
    fn doubts_are_told() {
        let turned = "0 -1 0 0 1 0 0 0 0 0 1 0 0 0 0 1";
        assert_eq!(parse_matrix(turned).unwrap().notes.len(), 1);
        let identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
        assert!(parse_matrix(identity).unwrap().notes.is_empty());
        assert_eq!(parse_matrix("1 2 3"), Err(ParseMatrixError::Count(3)));
        let sheared = "1 1 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
        assert!(matches!(
            parse_matrix(sheared),
            Err(ParseMatrixError::Matrix(_))
        ));
        for (text, error) in [
            ("0 0 0 0 1 2 3", ParseMatrixError::NotUnit(0.0)),
            (
                "1 0 0 10 4 5 6",
                ParseMatrixError::NotUnit(101.0_f64.sqrt()),
            ),
            ("1 0 0 10 0 1 0 20", ParseMatrixError::TwoRows),
            ("1 0 0 0\n0 1 0 20", ParseMatrixError::TwoRows),
        ] {
            assert_eq!(parse_matrix(text), Err(error), "{text}");
        }
        let told = parse_matrix("2 0 0 0 1 2 3").unwrap_err().to_string();
        assert_eq!(told, "the quaternion w x y z has the length 2, not 1");
        // Few digits are no other length, and a pose may go one unit along an axis.
        assert!(parse_matrix("0.71 0 0 0.71 10.5 20 -30").is_ok());
        assert!(parse_matrix("1 0 0 0 0 1 0 1").is_ok());
    }
}
