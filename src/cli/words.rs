//! The words of the command line for the choices of the core: names, lists and help come from the
//! core's own tables.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};

use crate::registration::{
    DataSide, Floor, Hand, Method, Metric, PairWith, Search, Selection, StartMethod,
};
use crate::report::CardForm;
use crate::units::Units;

/// Understands the name of one of the choices; help lists them all.
fn choice<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
    help: fn(T) -> &'static str,
) -> ValueParser {
    let words = all
        .iter()
        .map(move |&choice| PossibleValue::new(name(choice)).help(help(choice)));
    let find = move |word: String| {
        let found = all.iter().copied().find(|&choice| name(choice) == word);
        found.ok_or("no such choice")
    };
    PossibleValuesParser::new(words).try_map(find).into()
}

/// `--method`.
pub fn methods() -> ValueParser {
    choice(&Method::ALL, Method::name, Method::help)
}

/// `--pairs`.
pub fn pair_targets() -> ValueParser {
    choice(&PairWith::ALL, PairWith::name, PairWith::help)
}

/// `--residual`.
pub fn residuals() -> ValueParser {
    choice(&Metric::ALL, Metric::name, Metric::help)
}

/// `--points-of`.
pub fn data_sides() -> ValueParser {
    choice(&DataSide::ALL, DataSide::name, DataSide::help)
}

/// `--hand`.
pub fn hands() -> ValueParser {
    choice(&Hand::ALL, Hand::name, Hand::help)
}

/// `--search`.
pub fn searches() -> ValueParser {
    choice(&Search::ALL, Search::name, Search::help)
}

/// `--start`.
pub fn start_methods() -> ValueParser {
    choice(&StartMethod::ALL, StartMethod::name, StartMethod::help)
}

/// `--card-form`.
pub fn card_forms() -> ValueParser {
    choice(CardForm::ALL, CardForm::name, CardForm::label)
}

/// `--keep`; the word, because its parameters are options of their own.
pub fn selections() -> PossibleValuesParser {
    PossibleValuesParser::new(
        Selection::ALL.map(|choice| PossibleValue::new(choice.name()).help(choice.help())),
    )
}

/// `--crash-units` and `--stamped-units`.
pub fn units() -> ValueParser {
    let words: Vec<&str> = Units::all().map(Units::label).collect();
    let find = |word: String| Units::from_label(&word).ok_or("no such units");
    PossibleValuesParser::new(words).try_map(find).into()
}

/// `--floor`.
pub fn floor(word: &str) -> Result<Floor, String> {
    match word {
        "auto" => Ok(Floor::Auto),
        "none" => Ok(Floor::None),
        length => length
            .parse()
            .map(Floor::Length)
            .map_err(|_| "expected a length, auto or none".to_owned()),
    }
}
