//! What a row of the table of settings says.

use std::ops::RangeInclusive;

use super::{ChoiceWords, MatchRecipe, Value};
use crate::registration::Floor;
use crate::text::{Lengths, counted, grouped, trimmed, yes_no};

/// One setting of a match, or of another work whose choices are an `R`.
#[derive(Debug)]
pub struct Setting<R: 'static = MatchRecipe> {
    /// The field of `R` as it is stored, for example `settings.starts.method`.
    pub field: &'static str,
    /// Option of the command line, without hyphens.
    pub option: &'static str,
    /// Key in the parameters of a record.
    pub key: &'static str,
    /// Label in the window and in reports.
    pub label: &'static str,
    /// One line of help, without a full stop.
    pub help: &'static str,
    /// Heading it stands under.
    pub group: Group,
    /// Which values it takes.
    pub domain: Domain,
    /// How it is read and changed.
    pub access: Access<R>,
}

/// A heading of the settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// What is computed, and from where.
    Method,
    /// The poses the match starts from.
    Starts,
    /// Pairs, and what is minimised over them.
    Correspondences,
    /// Points, meshes and iterations.
    Search,
    /// How forming results pass over.
    Values,
}

impl Group {
    /// Heading of the group.
    pub fn title(self) -> &'static str {
        match self {
            Self::Method => "Method",
            Self::Starts => "Start poses",
            Self::Correspondences => "Correspondences",
            Self::Search => "Search",
            Self::Values => "Values",
        }
    }
}

/// Which values a setting takes.
#[derive(Debug)]
pub enum Domain {
    /// One of a few, with their words.
    Choice(fn() -> Vec<ChoiceWords>),
    /// On or off.
    Switch,
    /// A whole number.
    Count(RangeInclusive<usize>),
    /// A maximum, or none.
    Limit(RangeInclusive<usize>),
    /// A number in a range.
    Number {
        /// Unit of the number.
        unit: Unit,
        /// The range outside of which it is refused.
        range: RangeInclusive<f64>,
        /// By how much a drag of one point changes it.
        step: f64,
    },
    /// A length, `auto` or `none`.
    Floor,
    /// A length above 0, or `auto`.
    Reach,
    /// A list of poses.
    Poses,
}

/// The unit of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Without unit.
    One,
    /// The length unit of the crash part.
    Length,
    /// The same, and 0 leaves the length to the program.
    LengthOrAuto,
    /// Angle in degrees.
    Degrees,
    /// Mean edge lengths.
    EdgeLengths,
}

impl Unit {
    /// What follows a number.
    pub fn suffix(self, lengths: Lengths) -> &'static str {
        match self {
            Self::One => "",
            Self::Length | Self::LengthOrAuto => lengths.suffix(),
            Self::Degrees => "°",
            Self::EdgeLengths => " edge lengths",
        }
    }
}

/// A length that the program finds, in words for people.
const AUTOMATIC: &str = "automatic";

/// How a setting is read from and written to a recipe.
#[derive(Debug)]
pub struct Access<R: 'static = MatchRecipe> {
    /// Its value; `None` where other settings leave no place for it.
    pub get: fn(&R) -> Option<Value>,
    /// Changes it; false where there is no place for it, or the value is of another kind.
    pub set: fn(&mut R, &Value) -> bool,
    /// Why it has no effect beside the other settings, if so.
    pub unused: fn(&R) -> Option<&'static str>,
}

/// The one setting of a table in which two recipes differ, with its value in the second; `None` where they differ in
/// several, or in none.
pub fn changed_setting<'t, R>(
    table: &'t [Setting<R>],
    [before, after]: [&R; 2],
) -> Option<(&'t Setting<R>, Value)> {
    let mut changed = table
        .iter()
        .filter(|setting| setting.get(before) != setting.get(after));
    let setting = changed.next()?;
    let value = setting.get(after)?;
    changed.next().is_none().then_some((setting, value))
}

impl<R> Setting<R> {
    /// Its value; `None` where other settings leave no place for it.
    pub fn get(&self, recipe: &R) -> Option<Value> {
        (self.access.get)(recipe)
    }

    /// Changes it; false where there is no place for it, or the value is of another kind.
    pub fn set(&self, recipe: &mut R, value: &Value) -> bool {
        (self.access.set)(recipe, value)
    }

    /// Why it has no effect beside the other settings, if so.
    pub fn unused(&self, recipe: &R) -> Option<&'static str> {
        (self.access.unused)(recipe)
    }

    /// A value for people, with its unit.
    pub fn shown(&self, value: &Value, lengths: Lengths) -> String {
        match value {
            Value::Choice(name) => self.label_of(name).to_owned(),
            Value::Switch(value) => yes_no(*value).to_owned(),
            Value::Count(n) | Value::Limit(Some(n)) => grouped(*n),
            Value::Limit(None) => "full meshes".to_owned(),
            Value::Number(value) => match &self.domain {
                Domain::Number {
                    unit: Unit::LengthOrAuto,
                    ..
                } if *value == 0.0 => AUTOMATIC.to_owned(),
                Domain::Number { unit, .. } => trimmed(*value, 9) + unit.suffix(lengths),
                _ => trimmed(*value, 9),
            },
            Value::Floor(Floor::Auto) => "estimated".to_owned(),
            Value::Floor(Floor::None) => "none".to_owned(),
            Value::Reach(None) => AUTOMATIC.to_owned(),
            Value::Floor(Floor::Length(value)) | Value::Reach(Some(value)) => lengths.of(*value),
            Value::Poses(poses) => counted(poses.len(), "pose"),
        }
    }

    fn label_of(&self, name: &str) -> &'static str {
        let words = match self.domain {
            Domain::Choice(words) => words(),
            _ => Vec::new(),
        };
        let found = words.into_iter().find(|words| words.name == name);
        found.map_or("", |words| words.label)
    }
}
