//! The options of the settings, made from the tables of settings.

use std::ops::RangeInclusive;

use clap::builder::{BoolishValueParser, PossibleValue, PossibleValuesParser};
use clap::error::Result;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use super::numbers::{WIDE, count, number, within};
use crate::mapping::{MapOptions, limits as map_limits};
use crate::registration::{Floor, limits};
use crate::settings::{ChoiceWords, Domain, MAP_SETTINGS, SETTINGS, Setting, Unit, Value};
use crate::text::trimmed;

/// What was typed of the settings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SettingArgs {
    /// Settings with their values, in the order of the table.
    pub typed: Vec<(&'static str, Value)>,
    /// The words of `--start-pose`: files, or numbers.
    pub start_poses: Vec<String>,
}

impl SettingArgs {
    /// The value typed for an option.
    pub fn value(&self, option: &str) -> Option<&Value> {
        let typed = self.typed.iter().find(|(name, _)| *name == option);
        typed.map(|(_, value)| value)
    }
}

impl Args for SettingArgs {
    fn augment_args(command: Command) -> Command {
        command.args(SETTINGS.iter().map(arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SettingArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self> {
        let is_poses = |setting: &&Setting| matches!(setting.domain, Domain::Poses);
        let poses = SETTINGS.iter().filter(is_poses);
        let words = poses.flat_map(|row| matches.get_many::<String>(row.option));
        Ok(Self {
            typed: typed(&SETTINGS, matches),
            start_poses: words.flatten().cloned().collect(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<()> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// What was typed of the settings of a mapping.
#[derive(Debug, Clone, Default)]
pub struct MapSettingArgs(Vec<(&'static str, Value)>);

impl MapSettingArgs {
    /// Whether an option was typed.
    pub fn is_typed(&self, option: &str) -> bool {
        self.0.iter().any(|(name, _)| *name == option)
    }

    /// The usual choices with what was typed.
    pub fn options(&self) -> MapOptions {
        let mut options = MapOptions::default();
        for setting in &MAP_SETTINGS {
            for (_, value) in self.0.iter().filter(|(name, _)| *name == setting.option) {
                setting.set(&mut options, value);
            }
        }
        options
    }
}

impl Args for MapSettingArgs {
    fn augment_args(command: Command) -> Command {
        command.args(MAP_SETTINGS.iter().map(arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for MapSettingArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self> {
        Ok(Self(typed(&MAP_SETTINGS, matches)))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<()> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The settings that were typed, with their values.
fn typed<R>(rows: &'static [Setting<R>], matches: &ArgMatches) -> Vec<(&'static str, Value)> {
    let typed = |row: &'static Setting<R>| Some((row.option, value(row, matches)?));
    rows.iter().filter_map(typed).collect()
}

/// The option of one setting.
fn arg<R: Default>(setting: &'static Setting<R>) -> Arg {
    let arg = Arg::new(setting.option)
        .long(setting.option)
        .help(help(setting))
        .help_heading(setting.group.title())
        .allow_negative_numbers(true);
    match &setting.domain {
        Domain::Choice(words) => {
            let values: Vec<PossibleValue> = words().iter().map(possible).collect();
            arg.value_name("NAME")
                .value_parser(PossibleValuesParser::new(values))
        }
        Domain::Switch => arg
            .value_name("YES|NO")
            .hide_possible_values(true)
            .value_parser(BoolishValueParser::new()),
        Domain::Count(range) | Domain::Limit(range) => {
            arg.value_name("N").value_parser(count(range.clone()))
        }
        Domain::Number { unit, range, .. } => arg
            .value_name(match unit {
                Unit::Length | Unit::LengthOrAuto => "LENGTH",
                Unit::Degrees => "DEG",
                Unit::One | Unit::EdgeLengths => "NUMBER",
            })
            .value_parser(number(range.clone(), sign(*unit))),
        Domain::Floor => arg.value_name("LENGTH|auto|none").value_parser(floor),
        Domain::Reach => arg.value_name("LENGTH|auto").value_parser(reach),
        Domain::Poses => arg
            .value_name("FILE|NUMBERS")
            .action(ArgAction::Append)
            .allow_hyphen_values(true),
    }
}

fn possible(words: &ChoiceWords) -> PossibleValue {
    PossibleValue::new(words.name).help(words.help)
}

/// The help of the table with range and default.
fn help<R: Default>(setting: &Setting<R>) -> String {
    let mut help = setting.help.to_owned();
    if let Domain::Number { unit, range, .. } = &setting.domain
        && *range.end() < WIDE
    {
        let suffix = sign(*unit);
        let [low, high] = [range.start(), range.end()].map(|end| trimmed(*end, 6));
        help += &format!(" [{low}{suffix} to {high}{suffix}]");
    }
    let usual = setting.get(&R::default());
    let word = usual.as_ref().and_then(Value::word);
    match word {
        Some(word) => help + &format!(" [default: {}]", word.trim_end_matches(".0")),
        None => help,
    }
}

/// What follows a number where no unit of length is known.
fn sign(unit: Unit) -> &'static str {
    match unit {
        Unit::Degrees => "°",
        _ => "",
    }
}

/// The value typed for a setting.
fn value<R>(setting: &Setting<R>, matches: &ArgMatches) -> Option<Value> {
    let name = setting.option;
    match &setting.domain {
        Domain::Choice(words) => {
            let word: &String = matches.get_one(name)?;
            let is_it = |words: &ChoiceWords| words.name == word.as_str();
            let found = words().into_iter().find(is_it)?;
            Some(Value::Choice(found.name))
        }
        Domain::Switch => matches.get_one(name).copied().map(Value::Switch),
        Domain::Count(_) => matches.get_one(name).copied().map(Value::Count),
        Domain::Limit(_) => {
            let n: &usize = matches.get_one(name)?;
            Some(Value::Limit(Some(*n)))
        }
        Domain::Number { .. } => matches.get_one(name).copied().map(Value::Number),
        Domain::Floor => matches.get_one(name).copied().map(Value::Floor),
        Domain::Reach => {
            let Reach(length) = matches.get_one(name)?;
            Some(Value::Reach(*length))
        }
        Domain::Poses => None,
    }
}

/// `--floor`.
fn floor(word: &str) -> std::result::Result<Floor, String> {
    match word {
        "auto" => Ok(Floor::Auto),
        "none" => Ok(Floor::None),
        word => length(word, &limits::LENGTH, "a length, auto or none").map(Floor::Length),
    }
}

/// A largest length; `None` leaves it to the program.
#[derive(Debug, Clone, Copy)]
struct Reach(Option<f64>);

fn reach(word: &str) -> std::result::Result<Reach, String> {
    if word == "auto" {
        return Ok(Reach(None));
    }
    let length = length(word, &map_limits::POSITIVE, "a length or auto")?;
    Ok(Reach(Some(length)))
}

/// A length in its range, where a word may stand for it too.
fn length(
    word: &str,
    range: &RangeInclusive<f64>,
    expected: &str,
) -> std::result::Result<f64, String> {
    let length = word.parse().map_err(|_| format!("expected {expected}"))?;
    within(length, range, "")
}
