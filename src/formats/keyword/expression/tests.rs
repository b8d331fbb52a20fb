//! Unit tests of expressions.

use proptest::prelude::*;

use super::*;

fn value(text: &str) -> Result<Number> {
    evaluate(text, &|name| match name {
        "term" => Some(Operand::Number(Number::Real(0.2))),
        "states" => Some(Operand::Number(Number::Integer(80))),
        "file" => Some(Operand::Text),
        _ => None,
    })
}

#[track_caller]
fn integer(text: &str, expected: i64) {
    assert_eq!(value(text), Ok(Number::Integer(expected)), "{text}");
}

#[track_caller]
fn real(text: &str, expected: f64) {
    match value(text) {
        Ok(Number::Real(found)) => {
            assert!(
                (found - expected).abs() <= 1e-15 * expected.abs().max(1.0),
                "{text}: {found}"
            );
        }
        other => panic!("{text}: {other:?}"),
    }
}

#[track_caller]
fn problem(text: &str, column: usize, expected: ExpressionProblem) {
    let reason = expected;
    assert_eq!(
        value(text),
        Err(ExpressionError { column, reason }),
        "{text}"
    );
}

#[test]
fn precedence_and_types() {
    integer("1+2*3", 7);
    integer("2**3**2", 512);
    integer("-3**2", 9);
    integer("2/5", 0);
    integer("-7/2", -3);
    real("2.0/5", 0.4);
    real("2**-1", 0.5);
    real("4**0.5", 2.0);
    real("Term/(&STATES-30)", 0.004);
    real("1.5d-3 + .5 + 2.", 2.5015);
    integer("- - 4", 4);
    integer("2*-3", -6);
}

#[test]
fn functions_are_those_of_fortran() {
    integer("sign(-4, 8)", 4);
    integer("SIGN(4,-8)", -4);
    integer("mod(-7, 2)", -1);
    integer("mod(7.6, 3)", 2);
    integer("int(-48.9)", -48);
    integer("nint(2.5)", 3);
    integer("nint(-2.5)", -3);
    real("aint(-48.9)", -48.0);
    integer("max(3, 9, 4)", 9);
    real("max(3, 9.0, 10)", 10.0);
    integer("abs(-3)", 3);
    real("sin(pi/6)", 0.5);
    real("cos(60*dtor)", 0.5);
    real("atan2(1, 1)*4", PI);
    real("log10(1000)", 3.0);
    real("sqrt(2)**2", 2.0);
}

#[test]
fn says_what_is_wrong_and_where() {
    problem("1+", 3, ExpressionProblem::UnexpectedEnd);
    problem("", 1, ExpressionProblem::UnexpectedEnd);
    problem("(1+2", 5, ExpressionProblem::UnexpectedEnd);
    problem("1 2", 3, ExpressionProblem::Unexpected('2'));
    problem("2*nope", 3, ExpressionProblem::UnknownName("nope".into()));
    problem("file", 1, ExpressionProblem::TextName("file".into()));
    problem(
        "foo(1)",
        1,
        ExpressionProblem::UnknownFunction("foo".into()),
    );
    problem("1/0", 2, ExpressionProblem::DivisionByZero);
    problem("sqrt(-1)", 1, ExpressionProblem::NotFinite);
    problem("9223372036854775807+1", 20, ExpressionProblem::NotFinite);
    let deep = format!("{}1", "(".repeat(10_000));
    problem(&deep, 66, ExpressionProblem::TooDeep);
    assert!(value(&format!("1{}", "**1".repeat(10_000))).is_err());
    assert!(value(&"-".repeat(10_000)).is_err());
    assert_eq!(
        value("sin(1,2)").unwrap_err().reason,
        ExpressionProblem::ArgumentCount {
            name: "sin".into(),
            found: 2
        }
    );
}

#[test]
fn integers_of_reals() {
    assert_eq!(Number::Real(2.999_999_999_999_6).to_i64(), Some(3));
    assert_eq!(Number::Real(-2.7).to_i64(), Some(-2));
    assert_eq!(Number::Real(1e300).to_i64(), None);
}

/// An expression tree with its value by Rust's own arithmetic.
fn tree() -> impl Strategy<Value = (String, f64)> {
    let leaf = (0.001f64..1000.0).prop_map(|x| (format!("{x:?}"), x));
    leaf.prop_recursive(5, 40, 2, |inner| {
        (inner.clone(), inner, 0..6usize).prop_map(|((a, x), (b, y), operator)| match operator {
            0 => (format!("({a} + {b})"), x + y),
            1 => (format!("({a}-{b})"), x - y),
            2 => (format!("({a}*{b})"), x * y),
            3 => (format!("({a}/(1.0+abs({b})))"), x / (1.0 + y.abs())),
            4 => (format!("(cos({a})*sin({b}))"), x.cos() * y.sin()),
            _ => (format!("sqrt(abs({a}))"), x.abs().sqrt()),
        })
    })
}

proptest! {
    #[test]
    fn agrees_with_rust((text, expected) in tree()) {
        prop_assert_eq!(value(&text).map(Number::to_f64), Ok(expected));
    }

    #[test]
    fn integer_arithmetic_agrees(a in -1000i64..1000, b in 1i64..50, c in -9i64..9) {
        let text = format!("{a}/{b}*({c})+{b}**2-({a})");
        prop_assert_eq!(value(&text), Ok(Number::Integer(a / b * c + b * b - a)));
    }

    #[test]
    fn never_panics(text in "[-+*/()., &a-z0-9]{0,60}") {
        let _ = value(&text);
    }
}
