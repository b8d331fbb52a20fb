//! Values of options that come from lists of the core.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};

use crate::report::CardForm;
use crate::units::Units;

/// `--card-form`.
pub fn card_forms() -> ValueParser {
    let words = CardForm::ALL
        .iter()
        .map(|form| PossibleValue::new(form.name()).help(form.label()));
    let find = |word: String| {
        let found = CardForm::ALL.iter().find(|form| form.name() == word);
        found.copied().ok_or("no such form of cards")
    };
    PossibleValuesParser::new(words).try_map(find).into()
}

/// `--crash-units` and `--stamped-units`.
pub fn units() -> ValueParser {
    let words: Vec<&str> = Units::all().map(Units::label).collect();
    let find = |word: String| Units::from_label(&word).ok_or("no such units");
    PossibleValuesParser::new(words).try_map(find).into()
}
