//! `*PARAMETER` in all its forms, and what `&name` stands for.
//!
//! Rules of the LS-DYNA manual: names ignore case; a parameter holds from its definition on, also
//! in later includes; `_LOCAL` ones end with the file that defines them and hide global ones; a
//! second definition is ignored unless the first was `_MUTABLE` or `*PARAMETER_DUPLICATION` says
//! otherwise.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::block::Block;
use super::card::{Card, EIGHT_BY_10, Parameters, Value};
use super::expression::{self, ExpressionError, Number, Operand};
use super::number::{parse_int, parse_real};
use super::parameter_card::{
    ExpressionCard, Kind, expression_cards, is_name, is_name_char, pairs, typed_name,
};
use super::parameter_error::{ParameterError, ParameterProblem, ParameterProblemAt};

/// The number, or `None` for text.
fn number(value: &Value) -> Option<Number> {
    match value {
        Value::Int(value) => Some(Number::Integer(*value)),
        Value::Real(value) => Some(Number::Real(*value)),
        Value::Text(_) => None,
    }
}

fn negated(value: &Value) -> Option<Value> {
    match value {
        Value::Int(value) => value.checked_neg().map(Value::Int),
        Value::Real(value) => Some(Value::Real(-value)),
        Value::Text(_) => None,
    }
}

fn text_of(value: &Value) -> String {
    match value {
        Value::Int(value) => value.to_string(),
        Value::Real(value) => format!("{value:?}"),
        Value::Text(text) => text.clone(),
    }
}

fn value_of(number: Number) -> Value {
    match number {
        Number::Integer(value) => Value::Int(value),
        Number::Real(value) => Value::Real(value),
    }
}

/// How the cards of a `*PARAMETER…` keyword are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterLayout {
    /// Name and value, four pairs a card.
    Pairs,
    /// Name and expression, which may continue on lines with a blank name.
    Expression,
    /// Name, value and what kind of id it is, one a card.
    Typed,
}

/// What the options of a `*PARAMETER…` keyword ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ParameterKeyword {
    /// How its cards are laid out.
    pub layout: ParameterLayout,
    /// Ends with the file it stands in.
    pub local: bool,
    /// May be defined again.
    pub mutable: bool,
}

impl ParameterKeyword {
    /// Reads a keyword without its star, any case; `None` if it defines no parameters.
    pub fn parse(keyword: &str) -> Option<Self> {
        let upper = keyword.to_ascii_uppercase();
        let mut words = upper.split('_');
        if words.next() != Some("PARAMETER") {
            return None;
        }
        let mut found = Self {
            layout: ParameterLayout::Pairs,
            local: false,
            mutable: false,
        };
        for word in words {
            match word {
                "EXPRESSION" => found.layout = ParameterLayout::Expression,
                "TYPE" => found.layout = ParameterLayout::Typed,
                "LOCAL" => found.local = true,
                "MUTABLE" => found.mutable = true,
                "NOECHO" => {}
                _ => return None,
            }
        }
        Some(found)
    }
}

/// What happens to a second definition (`DFLAG` of `*PARAMETER_DUPLICATION`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Duplication {
    /// 1 (and 3, which also stops the solver): warn, keep the first.
    #[default]
    WarnKeepFirst,
    /// 2: warn, take the later.
    WarnTakeLater,
    /// 4: take the later.
    TakeLater,
    /// 5: keep the first.
    KeepFirst,
}

impl Duplication {
    /// Reads `DFLAG`; 0 and unknown values mean the default.
    pub fn from_flag(flag: i64) -> Self {
        match flag {
            2 => Self::WarnTakeLater,
            4 => Self::TakeLater,
            5 => Self::KeepFirst,
            _ => Self::WarnKeepFirst,
        }
    }

    fn takes_later(self) -> bool {
        matches!(self, Self::WarnTakeLater | Self::TakeLater)
    }

    fn warns(self) -> bool {
        matches!(self, Self::WarnKeepFirst | Self::WarnTakeLater)
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Entry {
    value: Value,
    mutable: bool,
}

/// All parameters visible at one place of the input. A clone is a snapshot of that place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterTable {
    global: BTreeMap<String, Entry>,
    /// `_LOCAL` parameters of the open files, the innermost last.
    local: Vec<BTreeMap<String, Entry>>,
    duplication: Option<Duplication>,
}

impl ParameterTable {
    /// No parameters, no open file; local parameters then belong to the whole input.
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a file; its `_LOCAL` parameters end with [`ParameterTable::pop_scope`].
    pub fn push_scope(&mut self) {
        self.local.push(BTreeMap::new());
    }

    /// Ends the innermost file.
    pub fn pop_scope(&mut self) {
        self.local.pop();
    }

    /// Takes `*PARAMETER_DUPLICATION`. Only the first such card counts; false for a later one.
    pub fn set_duplication(&mut self, duplication: Duplication) -> bool {
        let first = self.duplication.is_none();
        self.duplication.get_or_insert(duplication);
        first
    }

    /// What `name` stands for: the innermost local parameter, else the global one. Case and a
    /// leading `&` are ignored.
    pub fn resolve(&self, name: &str) -> Option<&Value> {
        let name = name.trim().trim_start_matches('&').to_ascii_lowercase();
        let mut scopes = self.local.iter().rev().chain([&self.global]);
        scopes.find_map(|scope| scope.get(&name)).map(|e| &e.value)
    }

    /// Reads one `*PARAMETER…` block.
    pub fn define(&mut self, block: &Block<'_>, diagnostics: &mut Diagnostics) {
        if block.name == "PARAMETER_DUPLICATION" {
            self.define_duplication(block, diagnostics);
            return;
        }
        let Some(keyword) = ParameterKeyword::parse(&block.name) else {
            return;
        };
        let cards: Vec<Card<'_>> = block.cards().collect();
        let lines: Vec<String> = cards.iter().map(Card::line_text).collect();
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        for diagnostic in self.read_block(keyword, &lines, block.layout.width(10)) {
            let kind = match diagnostic.problem {
                ParameterProblem::KeptFirst(_) | ParameterProblem::TookLater(_) => {
                    DiagnosticKind::DuplicateParameter
                }
                ParameterProblem::Field(ParameterError::Unresolved(_)) => {
                    DiagnosticKind::UnresolvedParameter
                }
                _ => DiagnosticKind::BadParameter,
            };
            let position = cards[diagnostic.line_idx].position(diagnostic.column - 1);
            diagnostics.push_with(kind, || {
                Diagnostic::new(kind, diagnostic.problem.to_string()).at(position)
            });
        }
    }

    fn define_duplication(&mut self, block: &Block<'_>, diagnostics: &mut Diagnostics) {
        let kind = DiagnosticKind::BadParameter;
        let Some(card) = block.cards().next() else {
            return;
        };
        match card.int_or_zero(EIGHT_BY_10, 0) {
            Ok(flag) if !self.set_duplication(Duplication::from_flag(flag)) => {
                let text = "only the first PARAMETER_DUPLICATION counts";
                let kind = DiagnosticKind::DuplicateParameter;
                diagnostics.push_with(kind, || block.diagnose(kind, text));
            }
            Ok(_) => {}
            Err(error) => diagnostics.push_with(kind, || card.diagnose(&error, "DFLAG")),
        }
    }

    /// Defines one parameter under the rules for second definitions.
    fn insert(
        &mut self,
        name: &str,
        value: Value,
        keyword: ParameterKeyword,
    ) -> Result<(), ParameterProblem> {
        let name = name.to_ascii_lowercase();
        let duplication = self.duplication.unwrap_or_default();
        // Hiding a global parameter by a local one is what locals are for; hiding a local is not.
        let existing = if keyword.local {
            let mut scopes = self.local.iter().rev();
            scopes.find_map(|scope| scope.get(&name))
        } else {
            self.global.get(&name)
        };
        let mutable = existing.map_or(keyword.mutable, |entry| entry.mutable);
        let is_second = existing.is_some() && !mutable;
        if is_second && !duplication.takes_later() {
            return if duplication.warns() {
                Err(ParameterProblem::KeptFirst(name))
            } else {
                Ok(())
            };
        }
        // The manual excludes text from MUTABLE.
        let mutable = mutable && number(&value).is_some();
        let scope = match self.local.last_mut() {
            Some(innermost) if keyword.local => innermost,
            _ => &mut self.global,
        };
        scope.insert(name.clone(), Entry { value, mutable });
        if is_second && duplication.warns() {
            return Err(ParameterProblem::TookLater(name));
        }
        Ok(())
    }

    /// The value of a field that holds `&name`, `-&name`, `<expression>` or arithmetic with `&`;
    /// `None` if the field holds none of these.
    pub fn field(&self, text: &str) -> Option<Result<Value, ParameterError>> {
        let text = text.trim();
        if let Some(inner) = text.strip_prefix('<').and_then(|t| t.strip_suffix('>')) {
            return Some(self.evaluate(inner).map_err(Into::into));
        }
        if !text.contains('&') {
            return None;
        }
        let (negative, unsigned) = match text.as_bytes()[0] {
            b'-' => (true, &text[1..]),
            b'+' => (false, &text[1..]),
            _ => (false, text),
        };
        Some(match unsigned.strip_prefix('&') {
            Some(name) if is_name(name) => self.reference(name, negative),
            _ => self.evaluate(text).map_err(Into::into),
        })
    }

    fn reference(&self, name: &str, negative: bool) -> Result<Value, ParameterError> {
        let value = self
            .resolve(name)
            .ok_or_else(|| ParameterError::Unresolved(name.to_owned()))?;
        if negative {
            negated(value).ok_or_else(|| ParameterError::NotANumber(name.to_owned()))
        } else {
            Ok(value.clone())
        }
    }

    fn evaluate(&self, text: &str) -> Result<Value, ExpressionError> {
        let lookup = |name: &str| {
            self.resolve(name)
                .map(|value| number(value).map_or(Operand::Text, Operand::Number))
        };
        expression::evaluate(text, &lookup).map(value_of)
    }

    /// Puts values in for every `&name` (or `&name^`) in a text such as a file name. Names that
    /// are not defined stay as they are.
    pub fn substitute<'a>(&self, text: &'a str) -> Cow<'a, str> {
        if !text.contains('&') {
            return Cow::Borrowed(text);
        }
        let mut pieces = text.split('&');
        let mut filled = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let end = piece.find(|c| !is_name_char(c)).unwrap_or(piece.len());
            let (name, rest) = piece.split_at(end);
            match self.resolve(name) {
                Some(value) => {
                    filled.push_str(&text_of(value));
                    filled.push_str(rest.strip_prefix('^').unwrap_or(rest));
                }
                None => {
                    filled.push('&');
                    filled.push_str(piece);
                }
            }
        }
        Cow::Owned(filled)
    }

    /// Reads the data lines of one `*PARAMETER…` block, comments left out. `width` is the width of
    /// a field: 10 in standard and I10 format, 20 in long format.
    pub fn read_block(
        &mut self,
        keyword: ParameterKeyword,
        lines: &[&str],
        width: usize,
    ) -> Vec<ParameterProblemAt> {
        let mut diagnostics = Vec::new();
        if keyword.layout == ParameterLayout::Expression {
            for card in expression_cards(lines, width) {
                if let Err(problem) = self.define_expression(&card, keyword) {
                    diagnostics.push(card.diagnostic(problem));
                }
            }
            return diagnostics;
        }
        for (line_idx, line) in lines.iter().enumerate() {
            let n_pairs = if keyword.layout == ParameterLayout::Typed {
                1
            } else {
                usize::MAX
            };
            for (name, value) in pairs(line, width).into_iter().take(n_pairs) {
                if let Err(problem) = self.define_pair(name.text, value.text, keyword) {
                    let at = if matches!(problem, ParameterProblem::BadValue { .. }) {
                        value
                    } else {
                        name
                    };
                    diagnostics.push(ParameterProblemAt {
                        line_idx,
                        column: at.column,
                        problem,
                    });
                }
            }
        }
        diagnostics
    }

    fn define_pair(
        &mut self,
        name: &str,
        text: &str,
        keyword: ParameterKeyword,
    ) -> Result<(), ParameterProblem> {
        let (kind, name) = typed_name(name)?;
        let value = match self.field(text).transpose()? {
            Some(value) => value,
            None => Value::Text(text.to_owned()),
        };
        let value = convert(kind, value).ok_or_else(|| ParameterProblem::BadValue {
            name: name.clone(),
            found: text.to_owned(),
        })?;
        self.insert(&name, value, keyword)
    }

    fn define_expression(
        &mut self,
        card: &ExpressionCard<'_>,
        keyword: ParameterKeyword,
    ) -> Result<(), ParameterProblem> {
        let (kind, name) = typed_name(card.name)?;
        let text = card.text();
        let value = if kind == Kind::Text {
            Value::Text(text.trim().to_owned())
        } else {
            self.evaluate(&text).map_err(ParameterError::from)?
        };
        let value = convert(kind, value).ok_or_else(|| ParameterProblem::BadValue {
            name: name.clone(),
            found: text.trim().to_owned(),
        })?;
        self.insert(&name, value, keyword)
    }
}

impl Parameters for ParameterTable {
    /// Also takes what may follow `&` in a field besides a name: `&tend/6.` arrives as `tend/6.`.
    fn value(&self, name: &str) -> Option<Value> {
        if is_name(name) {
            self.resolve(name).cloned()
        } else {
            self.evaluate(name).ok()
        }
    }
}

/// Fits a value to the declared type; text that is a number is read as one.
fn convert(kind: Kind, value: Value) -> Option<Value> {
    match (kind, value) {
        (Kind::Text, value) => Some(Value::Text(text_of(&value))),
        (Kind::Integer, Value::Text(text)) => parse_int(text.as_bytes()).map(Value::Int),
        (Kind::Integer, value) => number(&value)?.to_i64().map(Value::Int),
        (Kind::Real, Value::Text(text)) => parse_real(text.as_bytes())
            .filter(|value| value.is_finite())
            .map(Value::Real),
        (Kind::Real, value) => Some(Value::Real(number(&value)?.to_f64())),
    }
}

#[cfg(test)]
mod tests;
