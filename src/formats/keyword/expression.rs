//! Arithmetic of `*PARAMETER_EXPRESSION`.
//!
//! The grammar is Fortran's with two differences the LS-DYNA manual states: a sign binds tighter
//! than `**` (`-3**2` is 9), and a negative integer exponent gives a real (`2**-1` is 0.5).
//! Integers stay integers, so `2/5` is 0 and `2.0/5` is 0.4. Angles are radians.

use std::f64::consts::PI;

/// Deepest nesting of parentheses, signs and exponents; real decks use three or four.
const MAX_DEPTH: usize = 64;

/// A number with its Fortran type, which decides what `/` does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// A whole number.
    Integer(i64),
    /// A real number.
    Real(f64),
}

impl Number {
    /// The value as a real.
    pub fn to_f64(self) -> f64 {
        match self {
            Self::Integer(value) => value as f64,
            Self::Real(value) => value,
        }
    }

    /// The value as an integer, cut towards zero as in a Fortran assignment. A real within 1e-9
    /// of a whole number counts as that number. `None` beyond the range of 64 bits.
    pub fn to_i64(self) -> Option<i64> {
        match self {
            Self::Integer(value) => Some(value),
            Self::Real(value) => {
                let nearest = value.round();
                let close = (value - nearest).abs() <= 1e-9 * nearest.abs().max(1.0);
                integer_of(if close { nearest } else { value.trunc() })
            }
        }
    }
}

/// A whole real as an integer, if 64 bits hold it.
fn integer_of(whole: f64) -> Option<i64> {
    // 2⁶³ itself is the first value that does not fit.
    (whole >= i64::MIN as f64 && whole < i64::MAX as f64).then_some(whole as i64)
}

/// What a name in an expression stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand {
    /// A numeric parameter.
    Number(Number),
    /// A character parameter, which has no value to compute with.
    Text,
}

/// Why an expression has no value, and where: columns count bytes from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason} at column {column} of the expression")]
pub struct ExpressionError {
    /// Column in the expression, from 1.
    pub column: usize,
    /// What is wrong there.
    pub reason: ExpressionProblem,
}

/// What is wrong with an expression.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionProblem {
    /// The text ends where a value should stand.
    #[error("the expression ends where a value is expected")]
    UnexpectedEnd,
    /// A character that has no meaning here.
    #[error("{0:?} is not expected")]
    Unexpected(char),
    /// A name that no earlier parameter has.
    #[error("parameter {0:?} is not defined")]
    UnknownName(String),
    /// A character parameter used as a number.
    #[error("parameter {0:?} is text, not a number")]
    TextName(String),
    /// A function that LS-DYNA does not have.
    #[error("there is no function {0:?}")]
    UnknownFunction(String),
    /// A function with the wrong number of arguments.
    #[error("function {name:?} does not take {found} arguments")]
    ArgumentCount {
        /// Name as it stands in the deck.
        name: String,
        /// How many arguments were given.
        found: usize,
    },
    /// Division by zero.
    #[error("division by zero")]
    DivisionByZero,
    /// Overflow, a root of a negative number and the like.
    #[error("the result is not a finite number")]
    NotFinite,
    /// Nested too deeply.
    #[error("nested more than {MAX_DEPTH} levels deep")]
    TooDeep,
    /// A number that cannot be read.
    #[error("{0:?} is not a number")]
    BadNumber(String),
}

type Result<T> = std::result::Result<T, ExpressionError>;

/// Evaluates `text`; `lookup` gets each name in lower case, without `&`. O(length).
pub fn evaluate(text: &str, lookup: &dyn Fn(&str) -> Option<Operand>) -> Result<Number> {
    let mut parser = Parser {
        text: text.as_bytes(),
        at: 0,
        depth: 0,
        lookup,
    };
    let value = parser.sum()?;
    match parser.peek() {
        None => Ok(value),
        Some(byte) => Err(parser.unexpected(byte)),
    }
}

struct Parser<'a> {
    text: &'a [u8],
    at: usize,
    depth: usize,
    lookup: &'a dyn Fn(&str) -> Option<Operand>,
}

impl Parser<'_> {
    fn sum(&mut self) -> Result<Number> {
        let mut value = self.product()?;
        while let Some(operator @ (b'+' | b'-')) = self.peek() {
            let column = self.at;
            self.at += 1;
            let right = self.product()?;
            value = match operator {
                b'+' => combine(value, right, i64::checked_add, |a, b| a + b),
                _ => combine(value, right, i64::checked_sub, |a, b| a - b),
            }
            .ok_or_else(|| error(column, ExpressionProblem::NotFinite))?;
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<Number> {
        let mut value = self.power()?;
        loop {
            let column = self.at;
            let result = if self.accept(b"/") {
                let right = self.power()?;
                if right.to_f64() == 0.0 {
                    return Err(error(column, ExpressionProblem::DivisionByZero));
                }
                combine(value, right, i64::checked_div, |a, b| a / b)
            } else if self.accept(b"*") {
                let right = self.power()?;
                combine(value, right, i64::checked_mul, |a, b| a * b)
            } else {
                return Ok(value);
            };
            value = result.ok_or_else(|| error(column, ExpressionProblem::NotFinite))?;
        }
    }

    /// `**` groups from the right: `2**3**2` is 512.
    fn power(&mut self) -> Result<Number> {
        let base = self.signed()?;
        let column = self.at;
        if !self.accept(b"**") {
            return Ok(base);
        }
        let exponent = self.nested(Self::power)?;
        raise(base, exponent).ok_or_else(|| error(column, ExpressionProblem::NotFinite))
    }

    fn signed(&mut self) -> Result<Number> {
        let column = self.at;
        match self.peek() {
            Some(b'+') => {
                self.at += 1;
                self.nested(Self::signed)
            }
            Some(b'-') => {
                self.at += 1;
                match self.nested(Self::signed)? {
                    Number::Integer(value) => value
                        .checked_neg()
                        .map(Number::Integer)
                        .ok_or_else(|| error(column, ExpressionProblem::NotFinite)),
                    Number::Real(value) => Ok(Number::Real(-value)),
                }
            }
            _ => self.operand(),
        }
    }

    fn operand(&mut self) -> Result<Number> {
        match self.peek() {
            None => Err(error(self.at, ExpressionProblem::UnexpectedEnd)),
            Some(b'(') => {
                self.at += 1;
                let value = self.nested(Self::sum)?;
                self.expect(b')')?;
                Ok(value)
            }
            Some(b'0'..=b'9' | b'.') => self.number(),
            Some(b'&') => {
                self.at += 1;
                self.name()
            }
            Some(byte) if byte.is_ascii_alphabetic() || byte == b'_' => self.name(),
            Some(byte) => Err(self.unexpected(byte)),
        }
    }

    fn number(&mut self) -> Result<Number> {
        let start = self.at;
        self.skip_digits();
        let mut is_integer = true;
        if self.text.get(self.at) == Some(&b'.') {
            is_integer = false;
            self.at += 1;
            self.skip_digits();
        }
        is_integer &= !self.skip_exponent();
        let text = String::from_utf8_lossy(&self.text[start..self.at]).to_ascii_lowercase();
        let bad = || error(start, ExpressionProblem::BadNumber(text.clone()));
        if is_integer {
            return text.parse().map(Number::Integer).map_err(|_| bad());
        }
        let value: f64 = text.replace('d', "e").parse().map_err(|_| bad())?;
        finite(value).ok_or_else(bad)
    }

    fn skip_digits(&mut self) {
        while self.text.get(self.at).is_some_and(u8::is_ascii_digit) {
            self.at += 1;
        }
    }

    /// Takes `e-3`, `D+5`; leaves an `e` alone that no digit follows.
    fn skip_exponent(&mut self) -> bool {
        if !matches!(self.text.get(self.at), Some(b'e' | b'E' | b'd' | b'D')) {
            return false;
        }
        let sign = usize::from(matches!(self.text.get(self.at + 1), Some(b'+' | b'-')));
        let first_digit = self.at + 1 + sign;
        if !self.text.get(first_digit).is_some_and(u8::is_ascii_digit) {
            return false;
        }
        self.at = first_digit;
        self.skip_digits();
        true
    }

    fn name(&mut self) -> Result<Number> {
        let start = self.at;
        while self
            .text
            .get(self.at)
            .is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_')
        {
            self.at += 1;
        }
        let name = String::from_utf8_lossy(&self.text[start..self.at]).to_ascii_lowercase();
        if self.peek() == Some(b'(') {
            self.at += 1;
            return self.call(&name, start);
        }
        match (self.lookup)(&name) {
            Some(Operand::Number(value)) => Ok(value),
            Some(Operand::Text) => Err(error(start, ExpressionProblem::TextName(name))),
            None => {
                constant(&name).ok_or_else(|| error(start, ExpressionProblem::UnknownName(name)))
            }
        }
    }

    fn call(&mut self, name: &str, start: usize) -> Result<Number> {
        let mut arguments = Vec::new();
        if self.peek() != Some(b')') {
            arguments.push(self.nested(Self::sum)?);
            while self.peek() == Some(b',') {
                self.at += 1;
                arguments.push(self.nested(Self::sum)?);
            }
        }
        self.expect(b')')?;
        apply(name, &arguments).map_err(|reason| error(start, reason))
    }

    fn nested(&mut self, rule: fn(&mut Self) -> Result<Number>) -> Result<Number> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(error(self.at, ExpressionProblem::TooDeep));
        }
        let value = rule(self);
        self.depth -= 1;
        value
    }

    /// The next byte that is not blank.
    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    /// Takes an operator; `*` does not match the first half of `**`.
    fn accept(&mut self, operator: &[u8]) -> bool {
        self.peek();
        let rest = &self.text[self.at..];
        let found = rest.starts_with(operator) && !(operator == b"*" && rest.starts_with(b"**"));
        if found {
            self.at += operator.len();
        }
        found
    }

    fn expect(&mut self, wanted: u8) -> Result<()> {
        match self.peek() {
            Some(byte) if byte == wanted => {
                self.at += 1;
                Ok(())
            }
            Some(byte) => Err(self.unexpected(byte)),
            None => Err(error(self.at, ExpressionProblem::UnexpectedEnd)),
        }
    }

    fn unexpected(&self, byte: u8) -> ExpressionError {
        error(self.at, ExpressionProblem::Unexpected(char::from(byte)))
    }
}

fn error(at: usize, reason: ExpressionProblem) -> ExpressionError {
    ExpressionError {
        column: at + 1,
        reason,
    }
}

fn finite(value: f64) -> Option<Number> {
    value.is_finite().then_some(Number::Real(value))
}

fn combine(
    left: Number,
    right: Number,
    integers: fn(i64, i64) -> Option<i64>,
    reals: fn(f64, f64) -> f64,
) -> Option<Number> {
    match (left, right) {
        (Number::Integer(a), Number::Integer(b)) => integers(a, b).map(Number::Integer),
        _ => finite(reals(left.to_f64(), right.to_f64())),
    }
}

fn raise(base: Number, exponent: Number) -> Option<Number> {
    match (base, exponent) {
        (Number::Integer(a), Number::Integer(b @ 0..)) => {
            a.checked_pow(u32::try_from(b).ok()?).map(Number::Integer)
        }
        (_, Number::Integer(b)) => match i32::try_from(b) {
            Ok(b) => finite(base.to_f64().powi(b)),
            Err(_) => finite(base.to_f64().powf(b as f64)),
        },
        _ => finite(base.to_f64().powf(exponent.to_f64())),
    }
}

/// Names the manual reserves; a parameter of the same name hides them.
fn constant(name: &str) -> Option<Number> {
    match name {
        "pi" => Some(Number::Real(PI)),
        "dtor" => Some(Number::Real(PI / 180.0)),
        "rtod" => Some(Number::Real(180.0 / PI)),
        _ => None,
    }
}

fn apply(name: &str, arguments: &[Number]) -> std::result::Result<Number, ExpressionProblem> {
    let value = match *arguments {
        [x] => unary(name, x),
        [x, y] if name == "atan2" => Some(finite(x.to_f64().atan2(y.to_f64()))),
        [x, y] if name == "sign" => Some(sign(x, y)),
        [x, y] if name == "mod" => {
            let (Some(x), Some(y)) = (nearest(x), nearest(y)) else {
                return Err(ExpressionProblem::NotFinite);
            };
            if y == 0 {
                return Err(ExpressionProblem::DivisionByZero);
            }
            Some(x.checked_rem(y).map(Number::Integer))
        }
        [] if name == "pi" => Some(constant("pi")),
        [_, _, ..] => extremum(name, arguments),
        [] => None,
    };
    match value {
        Some(value) => value.ok_or(ExpressionProblem::NotFinite),
        None if is_function(name) => Err(ExpressionProblem::ArgumentCount {
            name: name.to_owned(),
            found: arguments.len(),
        }),
        None => Err(ExpressionProblem::UnknownFunction(name.to_owned())),
    }
}

fn is_function(name: &str) -> bool {
    unary(name, Number::Integer(0)).is_some()
        || ["atan2", "sign", "mod", "min", "max"].contains(&name)
}

/// Outer `None`: no such function. Inner `None`: no finite value.
fn unary(name: &str, x: Number) -> Option<Option<Number>> {
    let real = x.to_f64();
    let value = match name {
        "abs" => return Some(absolute(x)),
        "int" => return Some(integer_of(real.trunc()).map(Number::Integer)),
        "nint" => return Some(integer_of(real.round()).map(Number::Integer)),
        "aint" => real.trunc(),
        "anint" => real.round(),
        "float" | "real" | "dble" => real,
        "sqrt" => real.sqrt(),
        "exp" => real.exp(),
        "log" | "ln" => real.ln(),
        "log10" => real.log10(),
        "sin" => real.sin(),
        "cos" => real.cos(),
        "tan" => real.tan(),
        "csc" => real.sin().recip(),
        "sec" => real.cos().recip(),
        "ctn" => real.tan().recip(),
        "asin" => real.asin(),
        "acos" => real.acos(),
        "atan" => real.atan(),
        "sinh" => real.sinh(),
        "cosh" => real.cosh(),
        "tanh" => real.tanh(),
        "asinh" => real.asinh(),
        "acosh" => real.acosh(),
        "atanh" => real.atanh(),
        _ => return None,
    };
    Some(finite(value))
}

fn absolute(x: Number) -> Option<Number> {
    match x {
        Number::Integer(value) => value.checked_abs().map(Number::Integer),
        Number::Real(value) => finite(value.abs()),
    }
}

/// Fortran `sign(x, y)`: the size of x with the sign of y.
fn sign(x: Number, y: Number) -> Option<Number> {
    let size = absolute(x)?;
    let negative = y.to_f64() < 0.0;
    Some(match size {
        Number::Integer(value) if negative => Number::Integer(-value),
        Number::Real(value) if negative => Number::Real(-value),
        positive => positive,
    })
}

fn nearest(x: Number) -> Option<i64> {
    match x {
        Number::Integer(value) => Some(value),
        Number::Real(value) => integer_of(value.round()),
    }
}

fn extremum(name: &str, arguments: &[Number]) -> Option<Option<Number>> {
    let pick: fn(f64, f64) -> bool = match name {
        "min" => |new, best| new < best,
        "max" => |new, best| new > best,
        _ => return None,
    };
    let best = arguments.iter().copied().reduce(|best, new| {
        if pick(new.to_f64(), best.to_f64()) {
            new
        } else {
            best
        }
    })?;
    // One real among integers makes the result real.
    let all_integer = arguments.iter().all(|a| matches!(a, Number::Integer(_)));
    Some(Some(if all_integer {
        best
    } else {
        Number::Real(best.to_f64())
    }))
}

#[cfg(test)]
mod tests;
