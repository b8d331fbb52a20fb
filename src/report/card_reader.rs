//! Reads cards back as a solver would.

use crate::formats::Diagnostics;
use crate::formats::keyword::block::{Block, Blocks};
use crate::formats::keyword::card::{Card, EIGHT_BY_10, FieldError, Layout};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::keyword::transform::{TransformError, Transformation};
use crate::geometry::{Matrix3, Matrix4, MatrixError, Point3, Similarity, Vector3};

/// Rounding to ten columns leaves this much of |RᵀR − I| at the very most.
const TOLERANCE: f64 = 1e-6;

/// Why a text holds no cards with a pose.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadBackError {
    /// No keyword that carries a pose.
    #[error("there is neither INCLUDE_STAMPED_PART_MATRIX nor DEFINE_TRANSFORMATION")]
    NoKeyword,
    /// The block ends before its cards are complete.
    #[error("a card is missing")]
    MissingCard,
    /// A field that cannot be read.
    #[error("{found:?} stands in column {column}, expected {expected}")]
    Field {
        /// The field's text.
        found: String,
        /// Column from 1.
        column: usize,
        /// What should stand there.
        expected: &'static str,
    },
    /// A row of a transformation that cannot be read.
    #[error("the transformation cannot be read: {0}")]
    Rows(String),
    /// A row of a transformation that cannot be carried out.
    #[error(transparent)]
    Transform(#[from] TransformError),
    /// The numbers make no rigid motion.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// ISYM is not 0 to 4, or three points make no plane.
    #[error("the symmetry cannot be carried out")]
    Symmetry,
}

impl From<FieldError> for ReadBackError {
    fn from(error: FieldError) -> Self {
        Self::Field {
            found: error.found,
            column: error.column + 1,
            expected: error.expected,
        }
    }
}

/// The pose `crash_from_stamped` that a text of cards holds, mirror included.
pub fn read_back(text: &str) -> Result<Similarity, ReadBackError> {
    read_back_in(text, Layout::Standard)
}

/// The same in a deck whose fields are those of `layout` where a keyword has no suffix.
pub fn read_back_in(text: &str, layout: Layout) -> Result<Similarity, ReadBackError> {
    let file = SourceFile::new("cards", text);
    for block in Blocks::new(&file, layout) {
        let name = block.name.as_str();
        if name.starts_with("DEFINE_TRANSFORMATION") {
            return transformation(&block);
        }
        for target in ["PART", "SET"] {
            if name == format!("INCLUDE_STAMPED_{target}_MATRIX") {
                return stamped(&block, false);
            }
            if name == format!("INCLUDE_STAMPED_{target}_MATRIX_INVERSE") {
                return stamped(&block, true);
            }
        }
    }
    Err(ReadBackError::NoKeyword)
}

fn transformation(block: &Block<'_>) -> Result<Similarity, ReadBackError> {
    let mut diagnostics = Diagnostics::default();
    let found = Transformation::from_block(block, &mut diagnostics);
    if let Some(problem) = diagnostics.iter().next() {
        return Err(ReadBackError::Rows(problem.to_string()));
    }
    let (_, rows) = found.ok_or(ReadBackError::MissingCard)?;
    let matrix = rows.matrix(&|_| None)?;
    Ok(Similarity::from_matrix4(&matrix, TOLERANCE)?)
}

fn stamped(block: &Block<'_>, is_inverse: bool) -> Result<Similarity, ReadBackError> {
    let mut cards = block.cards();
    let mut next = || cards.next().ok_or(ReadBackError::MissingCard);
    while next()?.line_text().ends_with(" +") {}
    next()?;
    let mut matrix = Matrix4::identity();
    for row in 0..3 {
        let card = next()?;
        for column in 0..4 {
            matrix[(row, column)] = card.real_or_zero(EIGHT_BY_10, column)?;
        }
    }
    let mut motion = Similarity::from_matrix4(&matrix, TOLERANCE)?;
    if is_inverse {
        motion = motion.inverse();
    }
    let Ok(flags) = next() else {
        return Ok(motion);
    };
    let kind = flags.int_or_zero(EIGHT_BY_10, 0)?;
    let is_after = flags.int_or_zero(EIGHT_BY_10, 1)? != 0;
    let plane: Vec<Card<'_>> = [next(), next()].into_iter().flatten().collect();
    let mirror = symmetry(kind, &plane)?;
    Ok(if is_after {
        mirror.after(&motion)
    } else {
        motion.after(&mirror)
    })
}

/// The motion of ISYM.
fn symmetry(kind: i64, plane: &[Card<'_>]) -> Result<Similarity, ReadBackError> {
    let about_origin = |x: f64, y: f64| Similarity {
        rotation: Matrix3::from_diagonal(&Vector3::new(x, y, 1.0)),
        ..Similarity::identity()
    };
    match kind {
        0 => Ok(Similarity::identity()),
        1 => Ok(about_origin(-1.0, 1.0)),
        2 => Ok(about_origin(1.0, -1.0)),
        3 => Ok(about_origin(-1.0, -1.0)),
        4 => three_points(plane),
        _ => Err(ReadBackError::Symmetry),
    }
}

fn three_points(plane: &[Card<'_>]) -> Result<Similarity, ReadBackError> {
    let [first, rest] = plane else {
        return Err(ReadBackError::MissingCard);
    };
    let point = |card: &Card<'_>, from: usize| -> Result<Point3, FieldError> {
        let mut point = Point3::origin();
        for axis in 0..3 {
            point[axis] = card.real_or_zero(EIGHT_BY_10, from + axis)?;
        }
        Ok(point)
    };
    let (a, b, c) = (point(first, 0)?, point(rest, 0)?, point(rest, 3)?);
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
    let normal = normal.ok_or(ReadBackError::Symmetry)?;
    let rotation = Matrix3::identity() - normal * normal.transpose() * 2.0;
    Ok(Similarity {
        rotation,
        translation: normal * (2.0 * normal.dot(&a.coords)),
        scale: 1.0,
    })
}
