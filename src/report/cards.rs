//! LS-DYNA cards that carry a pose: `*INCLUDE_STAMPED_PART_MATRIX`, its inverse form, and
//! `*DEFINE_TRANSFORMATION` with `*INCLUDE_TRANSFORM`.
//!
//! A card has ten columns a number, or twenty in a long deck. Every text written here is read back at once by the
//! same code that reads decks, so that the error of rounding is known and not assumed.

mod file_name;

use crate::formats::keyword::card::Layout;
use crate::formats::keyword::fixed_width::fixed_width;
use crate::formats::keyword::rename::name_lines;
use crate::geometry::{Aabb, Matrix3, MatrixError, Point3, Similarity, Vector3};

pub use super::card_reader::{ReadBackError, read_back, read_back_in};
pub use file_name::{check_file_name, file_name_fault};

/// A set of cards that aligns the stamped part with the crash part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CardForm {
    /// `*INCLUDE_STAMPED_PART_MATRIX`: the solver maps the forming results.
    StampedPart,
    /// `*INCLUDE_STAMPED_PART_MATRIX_INVERSE`: the same from the matrix of the way back.
    StampedPartInverse,
    /// `*DEFINE_TRANSFORMATION` and `*INCLUDE_TRANSFORM`: the stamped mesh joins the crash model.
    IncludeTransform,
}

impl CardForm {
    /// Every form, in the order of the menus.
    pub const ALL: &[Self] = &[
        Self::StampedPart,
        Self::StampedPartInverse,
        Self::IncludeTransform,
    ];

    /// Its name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::StampedPart => "*INCLUDE_STAMPED_PART_MATRIX",
            Self::StampedPartInverse => "*INCLUDE_STAMPED_PART_MATRIX_INVERSE",
            Self::IncludeTransform => "*DEFINE_TRANSFORMATION with *INCLUDE_TRANSFORM",
        }
    }

    /// A word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::StampedPart => "stamped",
            Self::StampedPartInverse => "stamped-inverse",
            Self::IncludeTransform => "transform",
        }
    }
}

/// The crash part, or set of parts, that receives the forming results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Receiver {
    /// A part id.
    Part(u64),
    /// The id of a part set.
    Set(u64),
}

/// What `*INCLUDE_TRANSFORM` adds to ids; 0 for those that keep theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IdOffsets {
    /// To those of nodes.
    pub node: u64,
    /// To those of elements.
    pub element: u64,
    /// To those of parts.
    pub part: u64,
    /// To those of materials.
    pub material: u64,
    /// To those of sets.
    pub set: u64,
    /// To those of curves and of what else `*DEFINE` makes.
    pub curve: u64,
    /// To those of sections and all other kinds.
    pub section: u64,
}

/// What the cards hold besides the pose.
#[derive(Debug, Clone, PartialEq)]
pub struct CardOptions {
    /// Name of the stamped file as the deck shall call it, at most 236 columns.
    pub file_name: String,
    /// Who receives the forming results; [`CardForm::IncludeTransform`] does not name it.
    pub receiver: Receiver,
    /// Search radius RMAX in model units, from the measured deviation; rounded up.
    pub search_radius: f64,
    /// PERCELE: share of elements in percent that must be mapped, from the measured overlap;
    /// rounded down.
    pub mapped_percent: f64,
    /// Id of the transformation.
    pub transformation_id: u64,
    /// Added to the ids of the stamped mesh where it joins the crash model.
    pub offsets: IdOffsets,
    /// Format of the deck that takes the cards. Where it is not the standard one, every keyword has a suffix.
    pub deck_layout: Layout,
    /// Format of the stamped file. The suffix of the card that includes it names it and holds for the card too.
    pub stamped_layout: Layout,
    /// Box around the stamped part: where rounding errors count.
    pub bounds: Aabb,
    /// Lines for the head: files, build, fit.
    pub comments: Vec<String>,
}

impl Default for CardOptions {
    fn default() -> Self {
        Self {
            file_name: "dynain".to_owned(),
            receiver: Receiver::Part(1),
            search_radius: 20.0,
            mapped_percent: 0.0,
            transformation_id: 1,
            offsets: IdOffsets::default(),
            deck_layout: Layout::Standard,
            stamped_layout: Layout::Standard,
            bounds: Aabb {
                min: Point3::from([-5000.0; 3]),
                max: Point3::from([5000.0; 3]),
            },
            comments: Vec::new(),
        }
    }
}

/// A search radius rounded up to a thousandth of itself or of a length. The solver takes one below 0.001 for its own
/// default.
fn rounded_radius(radius: f64) -> f64 {
    let digits = (3.0 - radius.log10().floor()).clamp(3.0, 6.0);
    let per_step = 10_f64.powf(digits).round();
    ((radius * per_step).ceil() / per_step).max(0.001)
}

/// Scales that are no change of units: parts of one unit differ by less in size.
const NO_UNIT: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// What to do about a scale that cards cannot hold.
fn without_scale(scale: f64) -> &'static str {
    if NO_UNIT.contains(&scale) {
        "match again with a rigid motion, without a free scale or a start pose that has one"
    } else {
        "bring the stamped file to the unit of the crash model first"
    }
}

/// Why a pose cannot be put on cards.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CardError {
    /// The cards hold a rigid motion only.
    #[error(
        "the pose has the scale {scale}, which the cards cannot hold: the solver would scale \
         coordinates but neither thickness nor stresses; {}",
        without_scale(*scale)
    )]
    Scaled {
        /// Scale factor of the pose.
        scale: f64,
    },
    /// The 3×3 block is no rotation.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// A number that no field of ten columns can hold.
    #[error("{value} does not fit {width} columns")]
    DoesNotFit {
        /// Number that does not fit the field.
        value: f64,
        /// Columns of the field.
        width: usize,
    },
    /// An id with more digits than its field.
    #[error("the id {id} has more than {width} digits")]
    IdTooLong {
        /// Id that does not fit the field.
        id: u64,
        /// Columns of the field.
        width: usize,
    },
    /// No deck can include a file of this name.
    #[error("no deck can include the file {name:?}, because its name {fault}; rename it")]
    FileName {
        /// Name that cannot stand in a card.
        name: String,
        /// What is wrong with it.
        fault: &'static str,
    },
    /// The written text reads back as something else.
    #[error("the written cards cannot be read back: {0}")]
    ReadBack(#[from] ReadBackError),
}

/// Cards and what a solver makes of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Cards {
    /// The text, ending in a newline.
    pub text: String,
    /// The pose as it reads back, with all rounding.
    pub read_back: Similarity,
    /// The pose that was asked for.
    pub asked: Similarity,
}

impl Cards {
    /// Largest distance between where the cards and where the exact pose put these points of the
    /// stamped part. The distance is largest at corners of any convex hull.
    pub fn largest_node_error<'a>(&self, points: impl IntoIterator<Item = &'a Point3>) -> f64 {
        self.asked.max_displacement(&self.read_back, points)
    }
}

/// Writes the pose `crash_from_stamped` as cards and reads them back. A mirrored pose becomes a
/// mirror in the plane x = 0 of the stamped part and a rotation after it.
pub fn write(
    form: CardForm,
    crash_from_stamped: &Similarity,
    options: &CardOptions,
) -> Result<Cards, CardError> {
    let asked = *crash_from_stamped;
    if asked.scale != 1.0 {
        let scale = asked.scale;
        return Err(CardError::Scaled { scale });
    }
    Similarity::from_matrix4(&asked.to_matrix4(), 1e-6)?;
    match form {
        CardForm::StampedPart => stamped_part(&asked, options, false),
        CardForm::StampedPartInverse => stamped_part(&asked, options, true),
        CardForm::IncludeTransform => include_transform(&asked, options),
    }
}

/// The rigid motion that follows the mirror x → −x, if there is a mirror.
fn proper_part(motion: &Similarity) -> Similarity {
    if motion.is_mirrored() {
        motion.after(&Similarity::mirror_x())
    } else {
        *motion
    }
}

fn finish(sheet: Sheet, asked: &Similarity) -> Result<Cards, CardError> {
    let read_back = read_back_in(&sheet.text, sheet.deck_layout)?;
    Ok(Cards {
        text: sheet.text,
        read_back,
        asked: *asked,
    })
}

/// Builds lines of right-aligned fields.
struct Sheet {
    text: String,
    /// Columns of a number.
    width: usize,
    deck_layout: Layout,
}

impl Sheet {
    fn new(options: &CardOptions) -> Self {
        Self {
            text: String::new(),
            width: options.deck_layout.width(10),
            deck_layout: options.deck_layout,
        }
    }

    fn line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text.push('\n');
    }

    /// Begins a keyword whose cards have the fields of a layout.
    fn keyword(&mut self, name: &str, layout: Layout) {
        self.width = layout.width(10);
        if [layout, self.deck_layout] == [Layout::Standard; 2] {
            self.line(&format!("*{name}"));
        } else {
            self.line(&format!("*{name}{}", char::from(layout.suffix())));
        }
    }

    fn comments(&mut self, lines: &[String]) {
        for line in lines.iter().flat_map(|text| text.lines()) {
            self.line(&format!("$ {line}"));
        }
    }

    /// Field names over a card, as LS-PrePost writes them.
    fn names(&mut self, names: &str) {
        let mut line = String::from("$#");
        for (i, name) in names.split(' ').enumerate() {
            let width = if i == 0 { self.width - 2 } else { self.width };
            line += &format!("{:>width$}", if name == "-" { "" } else { name });
        }
        self.line(&line);
    }

    fn file_name(&mut self, name: &str) -> Result<(), CardError> {
        check_file_name(name)?;
        for line in name_lines(name).into_iter().flatten() {
            self.line(&line);
        }
        Ok(())
    }

    fn real(&self, value: f64) -> Result<String, CardError> {
        let width = self.width;
        let text = fixed_width(value + 0.0, width);
        let text = text.ok_or(CardError::DoesNotFit { value, width })?;
        Ok(format!("{text:>width$}"))
    }

    fn int(&self, id: u64) -> Result<String, CardError> {
        let width = self.width;
        let text = format!("{id:>width$}");
        if text.len() > width {
            return Err(CardError::IdTooLong { id, width });
        }
        Ok(text)
    }

    fn blank(&self) -> String {
        " ".repeat(self.width)
    }

    fn reals(&mut self, values: &[f64]) -> Result<(), CardError> {
        let fields: Result<Vec<String>, CardError> = values.iter().map(|&v| self.real(v)).collect();
        self.line(&fields?.concat());
        Ok(())
    }

    fn ints(&mut self, values: &[u64]) -> Result<(), CardError> {
        let fields: Result<Vec<String>, CardError> = values.iter().map(|&v| self.int(v)).collect();
        self.line(&fields?.concat());
        Ok(())
    }

    fn option_row(&mut self, option: &str, fields: &[String]) {
        let width = self.width;
        self.line(&format!("{option:<width$}{}", fields.concat()));
    }
}

/// Translation that balances the rounding of the rotation at `center`, so that the error grows
/// from the part's middle and not from a far origin.
fn balanced(exact: &Similarity, rounded: &Matrix3, center: &Point3) -> Vector3 {
    exact.translation + (exact.rotation - rounded) * center.coords
}

/// The matrix as its fields will read.
fn rounded(matrix: &Matrix3, width: usize) -> Result<Matrix3, CardError> {
    let mut result = *matrix;
    for value in result.iter_mut() {
        let exact = *value + 0.0;
        let read = fixed_width(exact, width).and_then(|text| text.parse().ok());
        let lost = CardError::DoesNotFit {
            value: exact,
            width,
        };
        *value = read.ok_or(lost)?;
    }
    Ok(result)
}

/// Says that the solver may map from the wrong sheet: with `ISYM` it has the mirrored and the unmirrored one, and
/// both can lie on the crash part if the stamped part reaches over the plane of the mirror.
pub fn two_sheets(crash_from_stamped: &Similarity, bounds: &Aabb) -> Option<String> {
    let reaches_over = bounds.min.x < 0.0 && bounds.max.x > 0.0;
    (crash_from_stamped.is_mirrored() && reaches_over).then(|| {
        "the stamped part reaches over the plane of the mirror, x = 0, so that its unmirrored sheet may lie on the \
         crash part too; name the moved deck (--moved), which holds the mirrored sheet alone, with a matrix of unity"
            .to_owned()
    })
}

fn stamped_part(
    asked: &Similarity,
    options: &CardOptions,
    is_inverse: bool,
) -> Result<Cards, CardError> {
    let forward = proper_part(asked);
    let center = options.bounds.center();
    let (motion, center) = if is_inverse {
        (forward.inverse(), asked.apply(&center))
    } else if asked.is_mirrored() {
        (forward, Similarity::mirror_x().apply(&center))
    } else {
        (forward, center)
    };
    let mut sheet = Sheet::new(options);
    let rotation = rounded(&motion.rotation, options.stamped_layout.width(10))?;
    let translation = balanced(&motion, &rotation, &center);
    sheet.comments(&options.comments);
    sheet.line(if is_inverse {
        "$ The matrix carries the crash part to the stamped part: stamped = R * crash + t"
    } else {
        "$ The matrix carries the stamped part to the crash part: crash = R * stamped + t"
    });
    if asked.is_mirrored() {
        sheet
            .line("$ Opposite hand: ISYM 1 with IAFTER 0 mirrors the stamped part at x = 0 first;");
        sheet.line("$ its unmirrored sheet stays beside the mirrored one and gets the same matrix");
    }
    sheet.comments(
        &two_sheets(asked, &options.bounds)
            .into_iter()
            .collect::<Vec<_>>(),
    );
    let (target, id) = match options.receiver {
        Receiver::Part(id) => ("PART", id),
        Receiver::Set(id) => ("SET", id),
    };
    let inverse = if is_inverse { "_INVERSE" } else { "" };
    let name = format!("INCLUDE_STAMPED_{target}_MATRIX{inverse}");
    sheet.keyword(&name, options.stamped_layout);
    sheet.file_name(&options.file_name)?;
    sheet.names("pid thick pstrn strain stress incout - rmax");
    let zero = sheet.int(0)?;
    let radius = rounded_radius(options.search_radius);
    let mut fields = vec![sheet.int(id)?];
    fields.extend(std::iter::repeat_n(zero.clone(), 5));
    fields.extend([sheet.blank(), sheet.real(radius)?]);
    sheet.line(&fields.concat());
    sheet.names("r11 r12 r13 xp tensor thkscl");
    for (row, t) in translation.iter().enumerate() {
        let r = rotation.row(row);
        let mut fields = String::new();
        for value in [r[0], r[1], r[2], *t] {
            fields += &sheet.real(value)?;
        }
        if row == 0 {
            fields = fields + &zero + &sheet.real(1.0)?;
        }
        sheet.line(&fields);
    }
    sheet.names("isym iafter percele iortho - isrcout mtype");
    let percent = (options.mapped_percent.clamp(0.0, 100.0) * 100.0).floor() / 100.0;
    let fields = [
        sheet.int(asked.is_mirrored().into())?,
        zero.clone(),
        sheet.real(percent)?,
        zero.clone(),
        sheet.blank(),
        zero.clone(),
        zero,
    ];
    sheet.line(&fields.concat());
    sheet.reals(&[0.0; 3])?;
    sheet.reals(&[0.0; 6])?;
    finish(sheet, asked)
}

/// Tries the ways to write the motion and takes the one that reads back best.
fn include_transform(asked: &Similarity, options: &CardOptions) -> Result<Cards, CardError> {
    let corners = options.bounds.corners();
    let mut best: Option<(f64, Cards)> = None;
    for way in [Way::Rotate, Way::Points(1000.0), Way::Points(4000.0)] {
        let cards = transform_cards(asked, options, way)?;
        let error = cards.largest_node_error(&corners);
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, cards));
        }
    }
    Ok(best.expect("one of three ways is the best").1)
}

#[derive(Debug, Clone, Copy)]
enum Way {
    /// A rotation about an axis through the origin, then a translation.
    Rotate,
    /// Six points, the legs of their triangle this long.
    Points(f64),
}

fn transform_cards(
    asked: &Similarity,
    options: &CardOptions,
    way: Way,
) -> Result<Cards, CardError> {
    let mut sheet = Sheet::new(options);
    sheet.comments(&options.comments);
    sheet.line(
        "$ The transformation carries the stamped part to the crash part; rows apply in turn",
    );
    sheet.keyword("DEFINE_TRANSFORMATION", options.deck_layout);
    sheet.ints(&[options.transformation_id])?;
    sheet.names("option a1 a2 a3 a4 a5 a6 a7");
    if asked.is_mirrored() {
        let fields = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0].map(|v| sheet.real(v));
        let fields: Result<Vec<String>, CardError> = fields.into_iter().collect();
        sheet.option_row("MIRROR", &fields?);
    }
    let motion = proper_part(asked);
    let center = options.bounds.center();
    let center = if asked.is_mirrored() {
        Similarity::mirror_x().apply(&center)
    } else {
        center
    };
    match way {
        Way::Rotate => rotate_rows(&mut sheet, &motion, &center)?,
        Way::Points(length) => point_rows(&mut sheet, &motion, &center, length)?,
    }
    sheet.keyword("INCLUDE_TRANSFORM", options.stamped_layout);
    sheet.file_name(&options.file_name)?;
    sheet.names("idnoff ideoff idpoff idmoff idsoff idfoff iddoff");
    let by = options.offsets;
    sheet.ints(&[
        by.node,
        by.element,
        by.part,
        by.material,
        by.set,
        by.curve,
        by.curve,
    ])?;
    sheet.names("idroff");
    sheet.ints(&[by.section])?;
    sheet.names("fctmas fcttim fctlen");
    sheet.reals(&[1.0; 3])?;
    sheet.names("tranid");
    sheet.ints(&[options.transformation_id])?;
    finish(sheet, asked)
}

fn rotate_rows(sheet: &mut Sheet, motion: &Similarity, center: &Point3) -> Result<(), CardError> {
    let (axis, angle_deg) = axis_angle(&motion.rotation);
    let mut turned = Similarity::identity();
    if angle_deg != 0.0 {
        let mut fields = Vec::new();
        for value in [axis.x, axis.y, axis.z, 0.0, 0.0, 0.0, angle_deg] {
            fields.push(sheet.real(value)?);
        }
        sheet.option_row("ROTATE", &fields);
        // What the row does as it reads back decides what is left for the translation.
        turned = read_back_in(&sheet.text, sheet.deck_layout)?;
        if turned.is_mirrored() {
            turned = turned.after(&Similarity::mirror_x());
        }
    }
    let shift = balanced(motion, &turned.rotation, center);
    let mut fields = Vec::new();
    for value in shift.iter() {
        fields.push(sheet.real(*value)?);
    }
    sheet.option_row("TRANSL", &fields);
    Ok(())
}

/// Axis with its largest component ±1 and angle in degrees, 0 to 180; exact also near both ends.
fn axis_angle(rotation: &Matrix3) -> (Vector3, f64) {
    let turn = nalgebra::Rotation3::from_matrix_unchecked(*rotation);
    let mut q = nalgebra::UnitQuaternion::from_rotation_matrix(&turn).into_inner();
    if q.w < 0.0 {
        q = -q;
    }
    let axis = q.imag();
    let largest = axis.amax();
    if largest == 0.0 {
        return (Vector3::z(), 0.0);
    }
    let angle = 2.0 * axis.norm().atan2(q.w);
    (axis / largest, angle.to_degrees())
}

/// `POINT` rows and one `POS6P`. The first point is carried exactly, so the error grows from it.
fn point_rows(
    sheet: &mut Sheet,
    motion: &Similarity,
    center: &Point3,
    length: f64,
) -> Result<(), CardError> {
    // Whole coordinates are written without error; legs towards the origin keep numbers short.
    let first = center.map(f64::round);
    let leg = |axis: usize| {
        let mut point = first;
        point[axis] += if first[axis] > 0.0 { -length } else { length };
        point
    };
    let start = [first, leg(0), leg(1)];
    let target = start.map(|point| motion.apply(&point));
    for (id, point) in (1..).zip(start.iter().chain(&target)) {
        let mut fields = vec![sheet.int(id)?];
        for value in point.iter() {
            fields.push(sheet.real(*value)?);
        }
        sheet.option_row("POINT", &fields);
    }
    let ids: Result<Vec<String>, CardError> = (1..=6).map(|id| sheet.int(id)).collect();
    sheet.option_row("POS6P", &ids?);
    Ok(())
}

#[cfg(test)]
mod tests;
