//! `*DEFINE_TRANSFORMATION`: rows of elementary motions and the matrix they make together.

use std::collections::BTreeMap;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::block::Block;
use super::card::{Card, EIGHT_BY_10, FieldError};
use crate::geometry::{Matrix3, Matrix4, Point3, Vector3};

/// A row that cannot be carried out. Rows count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TransformError {
    /// A node that no file defines.
    #[error("row {row} of the transformation names node {node}, which is not defined")]
    MissingNode {
        /// Row of the transformation, from 1.
        row: usize,
        /// The node's id.
        node: u64,
    },
    /// A point that no `POINT` row defines.
    #[error("row {row} of the transformation names point {point}, which is not defined")]
    MissingPoint {
        /// Row of the transformation, from 1.
        row: usize,
        /// The point's local id.
        point: u64,
    },
    /// Two points that should span a direction coincide, or a direction is zero.
    #[error("row {row} of the transformation has no direction")]
    NoDirection {
        /// Row of the transformation, from 1.
        row: usize,
    },
    /// Three points that should span a plane lie on a line.
    #[error("row {row} of the transformation has three points on one line")]
    Collinear {
        /// Row of the transformation, from 1.
        row: usize,
    },
    /// The last column of a `MATRIX` row is not 0 0 0 1.
    #[error("row {row} of the transformation holds a matrix whose last column is not 0 0 0 1")]
    NotAffine {
        /// Row of the transformation, from 1.
        row: usize,
    },
}

/// One elementary motion, or a point for later rows. Angles are degrees as in the card.
#[derive(Debug, Clone, PartialEq)]
pub enum TransformRow {
    /// `SCALE`: factors along x, y, z about the origin.
    Scale(Vector3),
    /// `TRANSL`.
    Translate(Vector3),
    /// `TRANSL2ND`: `distance` along two nodes; the whole way between them if it is 0.
    TranslateAlongNodes {
        /// Where the direction starts.
        from: u64,
        /// Where the direction points.
        to: u64,
        /// Length of the motion.
        distance: f64,
    },
    /// `ROTATE` about a direction through a point, right hand.
    Rotate {
        /// Direction of the axis, of any length.
        axis: Vector3,
        /// A point of the axis.
        through: Point3,
        /// Angle in degrees.
        angle_deg: f64,
    },
    /// `ROTATE` about the axis from one `POINT` to another.
    RotateAboutPoints {
        /// Local id of the first point.
        from: u64,
        /// Local id of the second point.
        to: u64,
        /// Angle in degrees.
        angle_deg: f64,
    },
    /// `ROTATE3NA`: the direction from node to node, through a third node.
    RotateAboutNodes {
        /// Where the direction starts.
        from: u64,
        /// Where the direction points.
        to: u64,
        /// The node on the axis; `from` if 0.
        through: u64,
        /// Angle in degrees.
        angle_deg: f64,
    },
    /// `POINT`: moves nothing.
    Point {
        /// Number of the point, by which other rows of the transformation name it.
        id: u64,
        /// Coordinates before any row.
        position: Point3,
    },
    /// `POS6P`: three start points onto three target points.
    PositionByPoints([u64; 6]),
    /// `POS6N`: three start nodes onto three target nodes.
    PositionByNodes([u64; 6]),
    /// `MIRROR` at the plane through `point` whose normal points to `toward`.
    Mirror {
        /// A point of the plane.
        point: Point3,
        /// A point along its normal.
        toward: Point3,
    },
    /// `MATRIX`, kept for column vectors: the card writes the transpose, `(x y z 1)·M`.
    Matrix(Matrix4),
}

/// A `*DEFINE_TRANSFORMATION`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Transformation {
    /// The rows, the first applied first.
    pub rows: Vec<TransformRow>,
}

impl Transformation {
    /// Reads a block: the transformation and its `TRANID`. Rows that cannot be read are reported
    /// and left out.
    pub fn from_block(block: &Block<'_>, diagnostics: &mut Diagnostics) -> Option<(u64, Self)> {
        let mut cards = block.cards();
        if block.has_option("TITLE") {
            cards.next();
        }
        let Some(first) = cards.next() else {
            let text = "the transformation has no card with its id";
            diagnostics.push(block.diagnose(DiagnosticKind::MissingCard, text));
            return None;
        };
        let id = match first.id(EIGHT_BY_10, 0) {
            Ok(id) => id,
            Err(error) => {
                diagnostics.push(first.diagnose(&error, "the id of a transformation"));
                return None;
            }
        };
        let mut rows = Vec::new();
        while let Some(card) = cards.next() {
            if card.is_blank() {
                continue;
            }
            match read_row(&card, &mut cards) {
                Ok(row) => rows.extend(row),
                Err(RowError::Field(error)) => {
                    let what = format!("a row of transformation {id}");
                    diagnostics.push(card.diagnose(&error, &what));
                }
                Err(RowError::Option(option)) => {
                    let text = format!("transformation {id} has a row that is not carried out");
                    let position = card.position(0);
                    let diagnostic = Diagnostic::new(DiagnosticKind::BadTransformation, text)
                        .at(position)
                        .found(option)
                        .expected("SCALE, TRANSL, ROTATE, POS6P or another option of the manual");
                    diagnostics.push(diagnostic);
                }
                Err(RowError::MatrixCards) => {
                    let text = format!("transformation {id} lacks the two cards of its matrix");
                    let diagnostic = Diagnostic::new(DiagnosticKind::MissingCard, text);
                    diagnostics.push(diagnostic.at(card.position(0)));
                }
            }
        }
        Some((id, Self { rows }))
    }

    /// The matrix for column vectors: rows apply from top to bottom, so it is `… · T2 · T1`.
    /// `node` gives the coordinates of a node. A `POINT` is carried through all rows above the
    /// one that uses it. O(rows).
    pub fn matrix(&self, node: &dyn Fn(u64) -> Option<Point3>) -> Result<Matrix4, TransformError> {
        let points = self.points();
        let mut total = Matrix4::identity();
        for (index, row) in self.rows.iter().enumerate() {
            let places = Places {
                row: index + 1,
                node,
                points: &points,
                above: &total,
            };
            total = row.matrix(&places)? * total;
        }
        Ok(total)
    }

    /// Adds `offset` to the ids of all nodes that rows name, as an including deck asks for.
    pub fn offset_nodes(&mut self, offset: i64) {
        let shift = |id: &mut u64| {
            if *id != 0 {
                *id = id.saturating_add_signed(offset);
            }
        };
        for row in &mut self.rows {
            match row {
                TransformRow::TranslateAlongNodes { from, to, .. } => [from, to].map(shift),
                TransformRow::RotateAboutNodes {
                    from, to, through, ..
                } => {
                    shift(through);
                    [from, to].map(shift)
                }
                TransformRow::PositionByNodes(ids) => {
                    ids.iter_mut().for_each(shift);
                    continue;
                }
                _ => continue,
            };
        }
    }

    /// Multiplies all lengths in the rows by the unit factor of an include.
    pub fn scale_lengths(&mut self, factor: f64) {
        if factor == 1.0 {
            return;
        }
        for row in &mut self.rows {
            match row {
                TransformRow::Translate(by) => *by *= factor,
                TransformRow::TranslateAlongNodes { distance, .. } => *distance *= factor,
                TransformRow::Rotate { through: place, .. }
                | TransformRow::Point {
                    position: place, ..
                } => *place *= factor,
                TransformRow::Mirror { point, toward } => {
                    *point *= factor;
                    *toward *= factor;
                }
                TransformRow::Matrix(matrix) => {
                    matrix.fixed_view_mut::<3, 1>(0, 3).scale_mut(factor);
                }
                TransformRow::Scale(_)
                | TransformRow::RotateAboutPoints { .. }
                | TransformRow::RotateAboutNodes { .. }
                | TransformRow::PositionByPoints(_)
                | TransformRow::PositionByNodes(_) => {}
            }
        }
    }

    fn points(&self) -> BTreeMap<u64, Point3> {
        let rows = self.rows.iter();
        rows.filter_map(|row| match row {
            TransformRow::Point { id, position } => Some((*id, *position)),
            _ => None,
        })
        .collect()
    }
}

enum RowError {
    Field(FieldError),
    Option(String),
    MatrixCards,
}

impl From<FieldError> for RowError {
    fn from(error: FieldError) -> Self {
        Self::Field(error)
    }
}

/// `None` for a row that moves nothing.
fn read_row<'a>(
    card: &Card<'a>,
    rest: &mut impl Iterator<Item = Card<'a>>,
) -> Result<Option<TransformRow>, RowError> {
    let option = card.text(EIGHT_BY_10, 0)?.to_ascii_uppercase();
    let mut a = [0.0; 7];
    for (i, value) in a.iter_mut().enumerate() {
        *value = card.real_or_zero(EIGHT_BY_10, i + 1)?;
    }
    let id = |i: usize| card.id(EIGHT_BY_10, i);
    let vector = |i: usize| Vector3::new(a[i], a[i + 1], a[i + 2]);
    let point = |i: usize| Point3::from(vector(i));
    Ok(Some(match option.as_str() {
        "SCALE" => TransformRow::Scale(vector(0).map(|x| if x == 0.0 { 1.0 } else { x })),
        "TRANSL" => TransformRow::Translate(vector(0)),
        "TRANSL2ND" => TransformRow::TranslateAlongNodes {
            from: id(1)?,
            to: id(2)?,
            distance: a[2],
        },
        "ROTATE" if a[3..] != [0.0; 4] => TransformRow::Rotate {
            axis: vector(0),
            through: point(3),
            angle_deg: a[6],
        },
        // No angle in either form.
        "ROTATE" if a[2] == 0.0 || a[0] < 1.0 || a[1] < 1.0 => return Ok(None),
        "ROTATE" => TransformRow::RotateAboutPoints {
            from: id(1)?,
            to: id(2)?,
            angle_deg: a[2],
        },
        "ROTATE3NA" => TransformRow::RotateAboutNodes {
            from: id(1)?,
            to: id(2)?,
            through: id(3)?,
            angle_deg: a[3],
        },
        "POINT" => TransformRow::Point {
            id: id(1)?,
            position: point(1),
        },
        "POS6P" => TransformRow::PositionByPoints(six_ids(card)?),
        "POS6N" => TransformRow::PositionByNodes(six_ids(card)?),
        "MIRROR" => TransformRow::Mirror {
            point: point(0),
            toward: point(3),
        },
        "MATRIX" => {
            let (Some(upper), Some(lower)) = (rest.next(), rest.next()) else {
                return Err(RowError::MatrixCards);
            };
            TransformRow::Matrix(read_matrix(&[upper, lower])?)
        }
        _ => return Err(RowError::Option(option)),
    }))
}

fn six_ids(card: &Card<'_>) -> Result<[u64; 6], FieldError> {
    let mut ids = [0; 6];
    for (i, id) in ids.iter_mut().enumerate() {
        *id = card.id(EIGHT_BY_10, i + 1)?;
    }
    Ok(ids)
}

fn read_matrix(cards: &[Card<'_>; 2]) -> Result<Matrix4, FieldError> {
    let mut values = [0.0; 16];
    for (i, value) in values.iter_mut().enumerate() {
        *value = cards[i / 8].real_or_zero(EIGHT_BY_10, i % 8)?;
    }
    if values[15] == 0.0 {
        values[15] = 1.0;
    }
    // Row by row in the card and for row vectors is column by column for column vectors.
    Ok(Matrix4::from_column_slice(&values))
}

/// Where a row finds nodes and points.
struct Places<'a> {
    row: usize,
    node: &'a dyn Fn(u64) -> Option<Point3>,
    points: &'a BTreeMap<u64, Point3>,
    above: &'a Matrix4,
}

impl Places<'_> {
    fn node(&self, node: u64) -> Result<Point3, TransformError> {
        let row = self.row;
        (self.node)(node).ok_or(TransformError::MissingNode { row, node })
    }

    fn point(&self, point: u64) -> Result<Point3, TransformError> {
        let row = self.row;
        let start = self.points.get(&point);
        start
            .map(|p| self.above.transform_point(p))
            .ok_or(TransformError::MissingPoint { row, point })
    }

    fn six(
        &self,
        ids: &[u64; 6],
        find: impl Fn(u64) -> Result<Point3, TransformError>,
    ) -> Result<Matrix4, TransformError> {
        let mut p = [Point3::origin(); 6];
        for (point, &id) in p.iter_mut().zip(ids) {
            *point = find(id)?;
        }
        let collinear = TransformError::Collinear { row: self.row };
        let start = frame(&p[0], &p[1], &p[2]).ok_or(collinear)?;
        let target = frame(&p[3], &p[4], &p[5]).ok_or(collinear)?;
        Ok(about(&p[0], &p[3], &(target * start.transpose())))
    }
}

impl TransformRow {
    fn matrix(&self, places: &Places<'_>) -> Result<Matrix4, TransformError> {
        let no_direction = TransformError::NoDirection { row: places.row };
        let rotation = |axis: Vector3, through: Point3, angle_deg: f64| {
            let axis = nalgebra::Unit::try_new(axis, 0.0).ok_or(no_direction)?;
            let turn = nalgebra::Rotation3::from_axis_angle(&axis, angle_deg.to_radians());
            Ok(about(&through, &through, turn.matrix()))
        };
        match self {
            Self::Scale(factors) => Ok(Matrix4::new_nonuniform_scaling(factors)),
            Self::Translate(vector) => Ok(Matrix4::new_translation(vector)),
            Self::TranslateAlongNodes { from, to, distance } => {
                let way = places.node(*to)? - places.node(*from)?;
                let direction = way.try_normalize(0.0).ok_or(no_direction)?;
                let vector = if *distance == 0.0 {
                    way
                } else {
                    direction * *distance
                };
                Ok(Matrix4::new_translation(&vector))
            }
            Self::Rotate {
                axis,
                through,
                angle_deg,
            } => rotation(*axis, *through, *angle_deg),
            Self::RotateAboutPoints {
                from,
                to,
                angle_deg,
            } => {
                let (from, to) = (places.point(*from)?, places.point(*to)?);
                rotation(to - from, from, *angle_deg)
            }
            Self::RotateAboutNodes {
                from,
                to,
                through,
                angle_deg,
            } => {
                let through = if *through == 0 { from } else { through };
                let (from, to) = (places.node(*from)?, places.node(*to)?);
                rotation(to - from, places.node(*through)?, *angle_deg)
            }
            Self::Point { .. } => Ok(Matrix4::identity()),
            Self::PositionByPoints(ids) => places.six(ids, |id| places.point(id)),
            Self::PositionByNodes(ids) => places.six(ids, |id| places.node(id)),
            Self::Mirror { point, toward } => {
                let normal = (toward - point).try_normalize(0.0).ok_or(no_direction)?;
                let mirror = Matrix3::identity() - normal * normal.transpose() * 2.0;
                Ok(about(point, point, &mirror))
            }
            Self::Matrix(matrix) if matrix.row(3) == nalgebra::RowVector4::new(0., 0., 0., 1.) => {
                Ok(*matrix)
            }
            Self::Matrix(_) => Err(TransformError::NotAffine { row: places.row }),
        }
    }
}

/// `x' = target + linear · (x − start)`.
fn about(start: &Point3, target: &Point3, linear: &Matrix3) -> Matrix4 {
    let mut matrix = linear.to_homogeneous();
    let shift = target.coords - linear * start.coords;
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&shift);
    matrix
}

/// Columns: the direction 1→2, the direction in the plane across it, the plane's normal.
/// `None` if the points lie on a line to within rounding.
fn frame(first: &Point3, second: &Point3, third: &Point3) -> Option<Matrix3> {
    let along = (second - first).try_normalize(0.0)?;
    let side = third - first;
    let across = side - along * along.dot(&side);
    let across = across.try_normalize(1e-12 * side.norm())?;
    Some(Matrix3::from_columns(&[
        along,
        across,
        along.cross(&across),
    ]))
}

#[cfg(test)]
mod tests;
