//! What was probably meant by a card that cannot be read.

use std::borrow::Cow;

use super::{Card, FieldError, Layout};
use crate::formats::diagnostic::{Diagnostic, DiagnosticKind};
use crate::formats::keyword::names::{is_known, keyword_name};

/// What its writer probably meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Misread {
    /// Fixed columns with commas in place of decimal points.
    DecimalComma,
    /// Values with blanks between them in place of columns or commas.
    Blanks,
    /// A keyword, which must begin in the first column.
    Keyword,
}

impl Card<'_> {
    /// Looks for the reason why a card cannot be read; `is_good` tells whether another reading of
    /// it can.
    pub(crate) fn misread(&self, is_good: impl Fn(&Card<'_>) -> bool) -> Option<Misread> {
        if self.is_misplaced_keyword() {
            return Some(Misread::Keyword);
        }
        if self.free {
            let with_points = self.text.iter().map(|&b| if b == b',' { b'.' } else { b });
            let card = Card {
                text: Cow::Owned(with_points.collect()),
                free: false,
                ..self.clone()
            };
            return is_good(&card).then_some(Misread::DecimalComma);
        }
        let values: Vec<&[u8]> = (self.text.split(u8::is_ascii_whitespace))
            .filter(|value| !value.is_empty())
            .collect();
        let card = Card {
            text: Cow::Owned(values.join(&b',')),
            free: true,
            ..self.clone()
        };
        is_good(&card).then_some(Misread::Blanks)
    }

    /// A blank before the `*` of a known keyword makes it data.
    pub(crate) fn is_misplaced_keyword(&self) -> bool {
        let text = self.text.trim_ascii_start();
        let name = text.strip_prefix(b"*").and_then(keyword_name);
        text.len() < self.text.len() && name.is_some_and(|name| is_known(&name))
    }

    /// A diagnostic about a card that cannot be read, with the probable reason. `what` names the
    /// thing that is lost.
    pub(crate) fn diagnose_misread(
        &self,
        error: &FieldError,
        misread: Option<Misread>,
        what: &str,
    ) -> Diagnostic {
        let (question, expected) = match misread {
            Some(Misread::Keyword) => return self.diagnose_keyword(),
            Some(Misread::DecimalComma) => {
                ("a decimal comma?", "decimal points; commas separate fields")
            }
            Some(Misread::Blanks) => (
                "blanks between its values?",
                "fields of fixed columns, or commas between the values",
            ),
            None => return self.diagnose(error, what),
        };
        Diagnostic::new(error.kind, format!("{what} cannot be read: {question}"))
            .at(self.position(0))
            .found(self.line_text())
            .expected(expected)
    }

    /// A diagnostic about a block whose cards, of which this is the first, are those of `layout`.
    pub(crate) fn diagnose_shifted(&self, layout: Layout) -> Diagnostic {
        let (message, expected) = match layout {
            Layout::Standard => (
                "columns look shifted: is this a standard deck below a keyword that asks for \
                 wider fields?",
                "fields of the width that the keyword asks for",
            ),
            Layout::I10 => (
                "columns look shifted: is this an I10 or long deck without the keyword?",
                "*KEYWORD I10=Y, or % after the keyword's name",
            ),
            Layout::Long => (
                "columns look shifted: is this an I10 or long deck without the keyword?",
                "*KEYWORD LONG=Y, or + after the keyword's name",
            ),
        };
        Diagnostic::new(DiagnosticKind::ShiftedColumns, message)
            .at(self.position(0))
            .found(self.line_text())
            .expected(expected)
    }

    /// A diagnostic about a keyword that is read as data.
    pub(crate) fn diagnose_keyword(&self) -> Diagnostic {
        let message = "the keyword is taken for data because a blank stands before it";
        Diagnostic::new(DiagnosticKind::MisplacedKeyword, message)
            .at(self.position(0))
            .found(self.line_text())
            .expected("* in the first column")
    }
}

impl Misread {
    /// The kind of the diagnostic; that of the field's error where the reason does not change it.
    pub(crate) fn kind(this: Option<Self>, error: &FieldError) -> DiagnosticKind {
        match this {
            Some(Self::Keyword) => DiagnosticKind::MisplacedKeyword,
            Some(Self::DecimalComma | Self::Blanks) | None => error.kind,
        }
    }
}
