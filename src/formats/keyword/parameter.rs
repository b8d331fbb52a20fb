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

/// Why a field with a parameter in it has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// No such parameter is visible here.
    #[error("parameter {0:?} is not defined")]
    Unresolved(String),
    /// Text with a minus sign before it.
    #[error("parameter {0:?} is text and has no negative")]
    NotANumber(String),
    /// Arithmetic in the field fails.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

/// What a definition did wrong.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterProblem {
    /// No `R`, `I` or `C` before the name, or a name that is none.
    #[error("{0:?} is not a parameter name with its type R, I or C before it")]
    BadName(String),
    /// LS-DYNA keeps this name for itself.
    #[error("parameter name {0:?} is reserved")]
    Reserved(String),
    /// The value does not suit the type.
    #[error("{found:?} is not a value for parameter {name:?}")]
    BadValue {
        /// The parameter.
        name: String,
        /// What stands in the value field.
        found: String,
    },
    /// The value names a parameter that does not exist.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A second definition that does not count.
    #[error("parameter {0:?} is defined again, the first definition stays")]
    KeptFirst(String),
    /// A second definition that counts.
    #[error("parameter {0:?} is defined again, the later definition counts")]
    TookLater(String),
}

/// A problem with its place in the block.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterFinding {
    /// Index into the lines given to [`ParameterTable::read_block`].
    pub line_idx: usize,
    /// Column in bytes, from 1.
    pub column: usize,
    /// What is wrong.
    pub problem: ParameterProblem,
}

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

    /// True if nothing is defined, so that no field can hold a parameter.
    pub fn is_empty(&self) -> bool {
        self.global.is_empty() && self.local.iter().all(BTreeMap::is_empty)
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
        for finding in self.read_block(keyword, &lines, block.layout.width(10)) {
            let kind = match finding.problem {
                ParameterProblem::KeptFirst(_) | ParameterProblem::TookLater(_) => {
                    DiagnosticKind::DuplicateParameter
                }
                ParameterProblem::Field(FieldError::Unresolved(_)) => {
                    DiagnosticKind::UnresolvedParameter
                }
                _ => DiagnosticKind::BadParameter,
            };
            let position = cards[finding.line_idx].position(finding.column - 1);
            diagnostics.push_with(kind, || {
                Diagnostic::new(kind, finding.problem.to_string()).at(position)
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
    pub fn field(&self, text: &str) -> Option<Result<Value, FieldError>> {
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

    fn reference(&self, name: &str, negative: bool) -> Result<Value, FieldError> {
        let value = self
            .resolve(name)
            .ok_or_else(|| FieldError::Unresolved(name.to_owned()))?;
        if negative {
            negated(value).ok_or_else(|| FieldError::NotANumber(name.to_owned()))
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
    ) -> Vec<ParameterFinding> {
        let mut findings = Vec::new();
        if keyword.layout == ParameterLayout::Expression {
            for card in expression_cards(lines, width) {
                if let Err(problem) = self.define_expression(&card, keyword) {
                    findings.push(card.finding(problem));
                }
            }
            return findings;
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
                    findings.push(ParameterFinding {
                        line_idx,
                        column: at.column,
                        problem,
                    });
                }
            }
        }
        findings
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
            self.evaluate(&text).map_err(FieldError::from)?
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(table: &mut ParameterTable, keyword: &str, text: &str) -> Vec<ParameterFinding> {
        let keyword = ParameterKeyword::parse(keyword).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        table.read_block(keyword, &lines, 10)
    }

    fn table(blocks: &[(&str, &str)]) -> ParameterTable {
        let mut table = ParameterTable::new();
        for (keyword, text) in blocks {
            assert_eq!(read(&mut table, keyword, text), [], "{text}");
        }
        table
    }

    #[test]
    fn every_way_of_writing_a_pair() {
        let table = table(&[
            ("parameter", "rterm, 0.2, istaTES, 80 "),
            ("PARAMETER", "r E          12.3\nr pR          00.321"),
            (
                "PARAMETER_NOECHO",
                "R   thick      1.5-3I     pid         17",
            ),
            ("PARAMETER", "cpaR1, foo, CPar2, bar"),
            ("PARAMETER", "I    copy       &pidR     neg        -&e"),
            ("PARAMETER", "R loose 2.5"),
            ("PARAMETER_TYPE", "I      nid       100       NID"),
            ("parameter_expression", "rPlot, tErm/(States-30)"),
            (
                "PARAMETER_EXPRESSION",
                "R     both   max(plot,\n             4.0) + 1.0",
            ),
        ]);
        let expected = [
            ("term", Value::Real(0.2)),
            ("STATES", Value::Int(80)),
            ("e", Value::Real(12.3)),
            ("&pr", Value::Real(0.321)),
            ("thick", Value::Real(1.5e-3)),
            ("pid", Value::Int(17)),
            ("par1", Value::Text("foo".into())),
            ("Par2", Value::Text("bar".into())),
            ("copy", Value::Int(17)),
            ("neg", Value::Real(-12.3)),
            ("loose", Value::Real(2.5)),
            ("nid", Value::Int(100)),
            ("plot", Value::Real(0.004)),
            ("both", Value::Real(5.0)),
        ];
        for (name, value) in expected {
            assert_eq!(table.resolve(name), Some(&value), "{name}");
        }
    }

    #[test]
    fn long_fields_are_twenty_wide() {
        let mut table = ParameterTable::new();
        let line = format!("{:<20}{:>20}{:<20}{:>20}", "R a", "1.25", "I b", "7");
        let keyword = ParameterKeyword::parse("PARAMETER").unwrap();
        assert_eq!(table.read_block(keyword, &[&line], 20), []);
        assert_eq!(table.resolve("a"), Some(&Value::Real(1.25)));
        assert_eq!(table.resolve("b"), Some(&Value::Int(7)));
    }

    #[test]
    fn fields_with_parameters() {
        let table = table(&[("PARAMETER", "rthk, 1.5, ipid, 3, cname, door")]);
        let value = |text| table.field(text).transpose();
        assert_eq!(value("1.5"), Ok(None));
        assert_eq!(value(" &THK "), Ok(Some(Value::Real(1.5))));
        assert_eq!(value("-&pid"), Ok(Some(Value::Int(-3))));
        assert_eq!(value("&thk/3."), Ok(Some(Value::Real(0.5))));
        assert_eq!(value("<thk*pid>"), Ok(Some(Value::Real(4.5))));
        assert_eq!(value("&nope"), Err(FieldError::Unresolved("nope".into())));
        assert_eq!(value("-&name"), Err(FieldError::NotANumber("name".into())));
        assert!(matches!(value("&"), Err(FieldError::Expression(_))));
        assert_eq!(table.substitute("a/&name^_&pid.k"), "a/door_3.k");
        assert_eq!(table.substitute("&&x &"), "&&x &");
    }

    #[test]
    fn a_local_parameter_ends_with_its_file() {
        let mut table = table(&[("PARAMETER", "rgbl, 200., rloc, 1.")]);
        table.push_scope();
        table.push_scope();
        assert_eq!(
            read(&mut table, "PARAMETER_LOCAL", "Rloc          999.0"),
            []
        );
        assert_eq!(table.resolve("loc"), Some(&Value::Real(999.0)));
        table.push_scope();
        assert_eq!(
            table.resolve("loc"),
            Some(&Value::Real(999.0)),
            "seen below"
        );
        table.pop_scope();
        table.pop_scope();
        assert_eq!(table.resolve("loc"), Some(&Value::Real(1.0)));
        assert_eq!(table.resolve("gbl"), Some(&Value::Real(200.0)));
        table.pop_scope();
        table.pop_scope();
    }

    #[test]
    fn second_definitions() {
        let case = |flag: Option<i64>, first: &str| {
            let mut table = ParameterTable::new();
            if let Some(flag) = flag {
                assert!(table.set_duplication(Duplication::from_flag(flag)));
                assert!(!table.set_duplication(Duplication::TakeLater));
            }
            read(&mut table, first, "rx, 1.0");
            let findings = read(&mut table, "PARAMETER", "rx, 2.0");
            (table.resolve("x").cloned(), findings.len())
        };
        assert_eq!(case(None, "PARAMETER"), (Some(Value::Real(1.0)), 1));
        assert_eq!(case(Some(1), "PARAMETER"), (Some(Value::Real(1.0)), 1));
        assert_eq!(case(Some(2), "PARAMETER"), (Some(Value::Real(2.0)), 1));
        assert_eq!(case(Some(4), "PARAMETER"), (Some(Value::Real(2.0)), 0));
        assert_eq!(case(Some(5), "PARAMETER"), (Some(Value::Real(1.0)), 0));
        assert_eq!(case(None, "PARAMETER_MUTABLE"), (Some(Value::Real(2.0)), 0));
    }

    #[test]
    fn findings_have_a_place() {
        let mut table = ParameterTable::new();
        let findings = read(
            &mut table,
            "PARAMETER",
            "rok, 1, ibad, x1\n1abc, 3\nrtime, 1",
        );
        let places: Vec<_> = findings.iter().map(|f| (f.line_idx, f.column)).collect();
        assert_eq!(places, [(0, 15), (1, 1), (2, 1)]);
        let text = "R        x2.0*\n          (1.0 + nope)";
        let findings = read(&mut table, "PARAMETER_EXPRESSION", text);
        assert_eq!((findings[0].line_idx, findings[0].column), (1, 18));
        assert_eq!(ParameterKeyword::parse("PARAMETER_DUPLICATION"), None);
        assert_eq!(ParameterKeyword::parse("PARAMETERS"), None);
    }

    proptest! {
        #[test]
        fn never_panics(
            lines in proptest::collection::vec("[-+*/()., &a-zé0-9<>]{0,60}", 0..5),
            expression: bool,
        ) {
            let mut table = ParameterTable::new();
            let keyword = if expression { "PARAMETER_EXPRESSION" } else { "PARAMETER_LOCAL" };
            let keyword = ParameterKeyword::parse(keyword).unwrap();
            let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
            table.read_block(keyword, &lines, 10);
            for line in lines {
                table.field(line);
                table.substitute(line);
            }
        }
    }
}
