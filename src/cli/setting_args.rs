//! The options of the match settings, made from the table of settings.

use clap::builder::{BoolishValueParser, PossibleValue, PossibleValuesParser};
use clap::error::Result;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, value_parser};

use crate::registration::Floor;
use crate::settings::{ChoiceWords, Domain, MatchRecipe, SETTINGS, Setting, Unit, Value};
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
        let mut found = Self::default();
        for setting in &SETTINGS {
            if let Domain::Poses = setting.domain {
                let words = matches.get_many::<String>(setting.option);
                found.start_poses = words.into_iter().flatten().cloned().collect();
            } else if let Some(value) = value(setting, matches) {
                found.typed.push((setting.option, value));
            }
        }
        Ok(found)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<()> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The option of one setting.
fn arg(setting: &'static Setting) -> Arg {
    let arg = Arg::new(setting.option)
        .long(setting.option)
        .aliases(setting.former.iter().copied())
        .help(help(setting))
        .help_heading(setting.group.title());
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
        Domain::Count(_) | Domain::Limit(_) => {
            arg.value_name("N").value_parser(value_parser!(usize))
        }
        Domain::Number { unit, .. } => arg
            .value_name(match unit {
                Unit::Length => "LENGTH",
                Unit::Degrees => "DEG",
                Unit::One | Unit::EdgeLengths => "NUMBER",
            })
            .allow_negative_numbers(true)
            .value_parser(value_parser!(f64)),
        Domain::Floor => arg.value_name("LENGTH|auto|none").value_parser(floor),
        Domain::Poses => arg
            .value_name("FILE|NUMBERS")
            .action(ArgAction::Append)
            .allow_hyphen_values(true),
    }
}

fn possible(words: &ChoiceWords) -> PossibleValue {
    PossibleValue::new(words.name)
        .aliases(words.former)
        .help(words.help)
}

/// The help of the table with range and default.
fn help(setting: &Setting) -> String {
    let mut help = setting.help.to_owned();
    if let Domain::Number { unit, range, .. } = &setting.domain
        && *range.end() < f64::MAX
    {
        let suffix = match unit {
            Unit::Degrees => "°",
            _ => "",
        };
        let [low, high] = [range.start(), range.end()].map(|end| trimmed(*end, 6));
        help += &format!(" [{low}{suffix} to {high}{suffix}]");
    }
    let usual = setting.get(&MatchRecipe::default());
    let word = usual.as_ref().and_then(Value::word);
    match word {
        Some(word) => help + &format!(" [default: {}]", word.trim_end_matches(".0")),
        None => help,
    }
}

/// The value typed for a setting.
fn value(setting: &Setting, matches: &ArgMatches) -> Option<Value> {
    let name = setting.option;
    match &setting.domain {
        Domain::Choice(words) => {
            let word: &String = matches.get_one(name)?;
            let is_it = |words: &ChoiceWords| {
                words.name == word.as_str() || words.former.contains(&word.as_str())
            };
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
        Domain::Poses => None,
    }
}

/// `--floor`.
fn floor(word: &str) -> std::result::Result<Floor, String> {
    match word {
        "auto" => Ok(Floor::Auto),
        "none" => Ok(Floor::None),
        length => length
            .parse()
            .map(Floor::Length)
            .map_err(|_| "expected a length, auto or none".to_owned()),
    }
}
