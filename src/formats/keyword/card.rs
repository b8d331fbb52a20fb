//! One data line ("card") and its fields: fixed columns in three widths, or values between commas.
//!
//! A card's fields are described by their *standard* widths, for example `&[8, 16, 16, 16, 8, 8]`
//! for a node. The same description serves I10, long and free format.

mod misread;
mod tabs;

use std::borrow::Cow;

pub(crate) use misread::Misread;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Position};
use super::super::{MAX_LENGTH, text};
use super::number::{parse_int, parse_real};
use super::source_file::SourceFile;

/// Ten fields of eight columns: element cards.
pub const TEN_BY_8: &[u8] = &[8; 10];
/// Eight fields of ten columns: most other cards.
pub const EIGHT_BY_10: &[u8] = &[10; 8];
/// Five fields of sixteen columns: thickness cards and large forming results.
pub const FIVE_BY_16: &[u8] = &[16; 5];

/// How wide the fields of a card are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Hash)]
pub enum Layout {
    /// Fields of 8, 10 and 16 columns.
    #[default]
    Standard,
    /// `%` or `I10=Y`: fields narrower than 10 columns become 10 wide.
    I10,
    /// `+` or `LONG=Y`: fields narrower than 20 columns become 20 wide, names of 80 become 160.
    Long,
}

impl Layout {
    /// The narrowest whose fields hold an id on every card.
    pub fn holding(id: u64) -> Self {
        match id {
            0..=99_999_999 => Self::Standard,
            100_000_000..=9_999_999_999 => Self::I10,
            _ => Self::Long,
        }
    }

    /// The width of a field whose standard width is given.
    #[inline]
    pub fn width(self, standard: u8) -> usize {
        match (self, standard) {
            (Self::Standard, w) => w.into(),
            (Self::I10, w) => w.max(10).into(),
            (Self::Long, 80) => 160,
            (Self::Long, w) => w.max(20).into(),
        }
    }

    /// The suffix of a keyword that asks for the layout.
    pub fn suffix(self) -> u8 {
        match self {
            Self::Standard => b'-',
            Self::I10 => b'%',
            Self::Long => b'+',
        }
    }

    /// The layout a suffix of the keyword asks for.
    pub fn of_suffix(suffix: u8) -> Option<Self> {
        match suffix {
            b'%' => Some(Self::I10),
            b'+' => Some(Self::Long),
            b'-' => Some(Self::Standard),
            _ => None,
        }
    }
}

/// Where the first `N` fields of a card begin and, last, where the last of them ends.
pub fn columns<const N: usize>(widths: &[u8], layout: Layout) -> [usize; N] {
    let mut at = 0;
    std::array::from_fn(|i| {
        let column = at;
        at += widths.get(i).map_or(0, |&w| layout.width(w));
        column
    })
}

/// What a parameter stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `I` parameters.
    Int(i64),
    /// `R` parameters.
    Real(f64),
    /// `C` parameters.
    Text(String),
}

/// Knows the value of `&name`.
pub trait Parameters: Sync {
    /// The value of a parameter, whose name comes without `&` in any letter case, or of an expression.
    fn value(&self, name: &str) -> Option<Value>;
}

/// Why a field cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldError {
    /// `BadField`, `NotFinite`, `NumberTooLarge` or `UnresolvedParameter`.
    pub kind: DiagnosticKind,
    /// Column of the field's text, from 0.
    pub column: usize,
    /// The field's text.
    pub found: String,
    /// What it should have been.
    pub expected: &'static str,
}

/// A trimmed field and the column, from 0, where its text starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field<'a> {
    /// The text without blanks around it.
    pub text: &'a [u8],
    /// Column of its first character, from 0.
    pub column: usize,
}

/// A data line of a block.
#[derive(Clone)]
pub struct Card<'a> {
    text: Cow<'a, [u8]>,
    /// Byte offset of the line in its file.
    offset: usize,
    layout: Layout,
    free: bool,
    had_tabs: bool,
    file: &'a SourceFile,
    parameters: Option<&'a dyn Parameters>,
}

impl<'a> Card<'a> {
    /// Takes a line without its line end. Tabs that separate numbers are taken as commas, others are expanded to
    /// columns of eight.
    pub fn new(
        line: &'a [u8],
        offset: usize,
        layout: Layout,
        file: &'a SourceFile,
        parameters: Option<&'a dyn Parameters>,
    ) -> Self {
        let had_tabs = line.contains(&b'\t');
        let text = if had_tabs {
            Cow::Owned(tabs::between_numbers(line).unwrap_or_else(|| tabs::expanded(line)))
        } else {
            Cow::Borrowed(line)
        };
        Self {
            free: text.contains(&b','),
            text,
            offset,
            layout,
            had_tabs,
            file,
            parameters,
        }
    }

    /// The whole line, without tabs.
    pub fn line(&self) -> &[u8] {
        &self.text
    }

    /// The whole line as text without blanks at its end; for file names.
    pub fn line_text(&self) -> String {
        text::decoded(self.text.trim_ascii_end()).into_owned()
    }

    /// The whole line without blanks around it, byte by byte; for titles.
    pub fn title(&self) -> &[u8] {
        self.text.trim_ascii()
    }

    /// True if there is nothing but blanks.
    pub fn is_blank(&self) -> bool {
        self.text.iter().all(u8::is_ascii_whitespace)
    }

    /// True if the values stand between commas, or between tabs that are taken as such.
    pub fn is_free(&self) -> bool {
        self.free
    }

    /// True if there were tabs.
    pub fn had_tabs(&self) -> bool {
        self.had_tabs
    }

    /// Byte offset of the line in its file.
    pub fn offset(&self) -> usize {
        self.offset
    }

    /// How wide the fields are.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The field at `index` of a card with the given standard widths; empty beyond the line's end.
    #[inline]
    pub fn field(&self, widths: &[u8], index: usize) -> Field<'_> {
        if self.free {
            return self.free_field(index);
        }
        let start: usize = widths[..index].iter().map(|&w| self.layout.width(w)).sum();
        let end = start + self.layout.width(widths[index]);
        self.slice(start, end)
    }

    fn free_field(&self, index: usize) -> Field<'_> {
        let mut start = 0;
        for (i, value) in self.text.split(|&b| b == b',').enumerate() {
            if i == index {
                return self.slice(start, start + value.len());
            }
            start += value.len() + 1;
        }
        self.slice(self.text.len(), self.text.len())
    }

    #[inline]
    fn slice(&self, start: usize, end: usize) -> Field<'_> {
        let end = end.min(self.text.len());
        let start = start.min(end);
        let field = &self.text[start..end];
        let text = field.trim_ascii_start();
        Field {
            column: start + field.len() - text.len(),
            text: text.trim_ascii_end(),
        }
    }

    /// True if the field holds nothing but blanks.
    pub fn is_empty_field(&self, widths: &[u8], index: usize) -> bool {
        self.field(widths, index).text.is_empty()
    }

    /// How many values stand between commas; for a fixed card, how many fields of `width` columns
    /// the line reaches into.
    pub fn n_fields(&self, width: u8) -> usize {
        if self.free {
            return self.text.iter().filter(|&&b| b == b',').count() + 1;
        }
        let filled = self.text.trim_ascii_end().len();
        filled.div_ceil(self.layout.width(width))
    }

    /// An integer; `None` for a blank field.
    #[inline]
    pub fn int(&self, widths: &[u8], index: usize) -> Result<Option<i64>, FieldError> {
        let field = self.field(widths, index);
        if field.text.is_empty() {
            return Ok(None);
        }
        match parse_int(field.text) {
            Some(value) => Ok(Some(value)),
            None => self.int_by_parameter(field).map(Some),
        }
    }

    /// An integer; 0 for a blank field.
    #[inline]
    pub fn int_or_zero(&self, widths: &[u8], index: usize) -> Result<i64, FieldError> {
        Ok(self.int(widths, index)?.unwrap_or(0))
    }

    /// An id: an integer from 0; 0 for a blank field.
    #[inline]
    pub fn id(&self, widths: &[u8], index: usize) -> Result<u64, FieldError> {
        let value = self.int_or_zero(widths, index)?;
        u64::try_from(value).map_err(|_| {
            let field = self.field(widths, index);
            field_error(
                DiagnosticKind::BadField,
                field,
                "an id, which is not negative",
            )
        })
    }

    /// An id that must be there: an integer from 1.
    #[inline]
    pub fn required_id(&self, widths: &[u8], index: usize) -> Result<u64, FieldError> {
        match self.id(widths, index)? {
            0 => {
                let field = self.field(widths, index);
                Err(field_error(DiagnosticKind::BadField, field, "an id from 1"))
            }
            id => Ok(id),
        }
    }

    /// A finite real number; `None` for a blank field.
    #[inline]
    pub fn real(&self, widths: &[u8], index: usize) -> Result<Option<f64>, FieldError> {
        let field = self.field(widths, index);
        if field.text.is_empty() {
            return Ok(None);
        }
        let value = match parse_real(field.text) {
            Some(value) => value,
            None => self.real_by_parameter(field)?,
        };
        if value.is_finite() {
            Ok(Some(value))
        } else {
            let kind = DiagnosticKind::NumberTooLarge;
            Err(field_error(kind, field, "a number below 1.8e308"))
        }
    }

    /// A length: a real number of at most [`MAX_LENGTH`]; `None` for a blank field.
    #[inline]
    pub fn length(&self, widths: &[u8], index: usize) -> Result<Option<f64>, FieldError> {
        let value = self.real(widths, index)?;
        if value.is_some_and(|value| value.abs() > MAX_LENGTH) {
            let field = self.field(widths, index);
            let kind = DiagnosticKind::NumberTooLarge;
            return Err(field_error(kind, field, "a length of at most 1e15"));
        }
        Ok(value)
    }

    /// A length; 0 for a blank field.
    #[inline]
    pub fn length_or_zero(&self, widths: &[u8], index: usize) -> Result<f64, FieldError> {
        Ok(self.length(widths, index)?.unwrap_or(0.0))
    }

    /// A finite real number; 0 for a blank field.
    #[inline]
    pub fn real_or_zero(&self, widths: &[u8], index: usize) -> Result<f64, FieldError> {
        Ok(self.real(widths, index)?.unwrap_or(0.0))
    }

    /// Text; a parameter stands for its value.
    pub fn text(&self, widths: &[u8], index: usize) -> Result<String, FieldError> {
        let field = self.field(widths, index);
        if field.text.first() == Some(&b'&') {
            return Ok(match self.parameter(field)?.1 {
                Value::Text(text) => text,
                Value::Int(value) => value.to_string(),
                Value::Real(value) => value.to_string(),
            });
        }
        Ok(text::decoded(field.text).into_owned())
    }

    /// The sign before `&` and the parameter's value, or the value of an expression in `<>`.
    fn parameter(&self, field: Field<'_>) -> Result<(bool, Value), FieldError> {
        let (negative, name) = match field.text {
            [b'-', b'&', name @ ..] => (true, name),
            [b'+', b'&', name @ ..] | [b'&', name @ ..] => (false, name),
            [b'<', expression @ .., b'>'] => {
                return match self.value_of(expression) {
                    Some(value) => Ok((false, value)),
                    None => {
                        let kind = DiagnosticKind::BadField;
                        Err(field_error(kind, field, "an expression that has a value"))
                    }
                };
            }
            _ => return Err(field_error(DiagnosticKind::BadField, field, "a number")),
        };
        let name = String::from_utf8_lossy(name.trim_ascii());
        match self.parameters.and_then(|table| table.value(&name)) {
            Some(value) => Ok((negative, value)),
            None => {
                let kind = DiagnosticKind::UnresolvedParameter;
                Err(field_error(
                    kind,
                    field,
                    "a parameter defined before its use",
                ))
            }
        }
    }

    fn value_of(&self, expression: &[u8]) -> Option<Value> {
        // In brackets, so that nothing is taken for a parameter's name.
        let text = format!("({})", String::from_utf8_lossy(expression));
        self.parameters?.value(&text)
    }

    #[cold]
    fn int_by_parameter(&self, field: Field<'_>) -> Result<i64, FieldError> {
        let bad = || field_error(DiagnosticKind::BadField, field, "an integer");
        if is_non_finite_word(field.text) {
            return Err(field_error(DiagnosticKind::NotFinite, field, "an integer"));
        }
        if !field.text.contains(&b'&') && field.text.first() != Some(&b'<') {
            let digits = field.text.strip_prefix(b"-").unwrap_or(field.text);
            return Err(if digits.iter().all(u8::is_ascii_digit) {
                let kind = DiagnosticKind::NumberTooLarge;
                field_error(kind, field, "an integer of at most 18 digits")
            } else {
                bad()
            });
        }
        let (negative, value) = self.parameter(field)?;
        let value = match value {
            Value::Int(value) => Some(value),
            Value::Real(value) => parse_int(format!("{value:e}").as_bytes()),
            Value::Text(text) => parse_int(text.trim().as_bytes()),
        };
        let value = if negative {
            value.and_then(i64::checked_neg)
        } else {
            value
        };
        value.ok_or_else(bad)
    }

    #[cold]
    fn real_by_parameter(&self, field: Field<'_>) -> Result<f64, FieldError> {
        let bad = || field_error(DiagnosticKind::BadField, field, "a number");
        if is_non_finite_word(field.text) {
            return Err(field_error(
                DiagnosticKind::NotFinite,
                field,
                "a finite number",
            ));
        }
        let (negative, value) = self.parameter(field)?;
        let value = match value {
            Value::Int(value) => value as f64,
            Value::Real(value) => value,
            Value::Text(text) => parse_real(text.trim().as_bytes()).ok_or_else(bad)?,
        };
        Ok(if negative { -value } else { value })
    }

    /// Where a column (from 0) of this card stands in its file.
    pub fn position(&self, column: usize) -> Position {
        let mut position = self.file.position(self.offset);
        position.column = u32::try_from(column + 1).unwrap_or(u32::MAX);
        position
    }

    /// A diagnostic about one field; `what` names the thing that is lost, for example `"node 12"`.
    pub fn diagnose(&self, error: &FieldError, what: &str) -> Diagnostic {
        let message = match error.kind {
            DiagnosticKind::UnresolvedParameter => format!("{what} uses an undefined parameter"),
            DiagnosticKind::NotFinite => format!("{what} holds a number that is not finite"),
            DiagnosticKind::NumberTooLarge => format!("{what} holds a number too large"),
            DiagnosticKind::Unsupported => {
                format!("{what} has an option that is not carried out")
            }
            _ => format!("{what} cannot be read"),
        };
        Diagnostic::new(error.kind, message)
            .at(self.position(error.column))
            .found(error.found.clone())
            .expected(error.expected)
    }

    /// The same line in fields of other widths.
    pub(crate) fn with_layout(&self, layout: Layout) -> Self {
        Self {
            layout,
            ..self.clone()
        }
    }
}

fn field_error(kind: DiagnosticKind, field: Field<'_>, expected: &'static str) -> FieldError {
    FieldError {
        kind,
        column: field.column,
        found: text::decoded(field.text).into_owned(),
        expected,
    }
}

/// `NaN`, `Infinity` and Fortran's row of stars for a number that did not fit its columns.
fn is_non_finite_word(text: &[u8]) -> bool {
    let word = text.strip_prefix(b"-").or(text.strip_prefix(b"+"));
    let word = word.unwrap_or(text).to_ascii_lowercase();
    let is_name = [&b"nan"[..], b"inf", b"infinity"].contains(&&word[..]);
    is_name || (!word.is_empty() && word.iter().all(|&b| b == b'*'))
}
