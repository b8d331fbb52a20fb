//! The value of a setting apart from the setting, so that all of them can be walked.

use serde::Serialize;

use super::Choice;
use crate::geometry::Similarity;
use crate::registration::Floor;
use crate::text::yes_no;

/// The value of one setting. In a record it is written as the plain value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// One of a few, by its name.
    Choice(&'static str),
    /// On or off.
    Switch(bool),
    /// A whole number.
    Count(usize),
    /// A maximum, if there is one.
    Limit(Option<usize>),
    /// A number in the unit of the setting.
    Number(f64),
    /// The floor of Fractional ICP.
    Floor(Floor),
    /// A largest length; `None` leaves it to the program.
    Reach(Option<f64>),
    /// Start poses, crash from stamped.
    Poses(Vec<Similarity>),
}

/// The shortest text of a number that reads back to the same bits.
pub fn exact(value: f64) -> String {
    format!("{value:?}")
}

impl Value {
    /// The word for the command line, which reads back to the same bits; `None` where there is none, as
    /// for poses, which the command line writes one by one.
    pub fn word(&self) -> Option<String> {
        Some(match self {
            Self::Choice(name) => (*name).to_owned(),
            Self::Switch(value) => yes_no(*value).to_owned(),
            Self::Count(n) => n.to_string(),
            Self::Limit(n) => n.as_ref()?.to_string(),
            Self::Number(value) | Self::Floor(Floor::Length(value)) | Self::Reach(Some(value)) => {
                exact(*value)
            }
            Self::Floor(Floor::Auto) | Self::Reach(None) => "auto".to_owned(),
            Self::Floor(Floor::None) => "none".to_owned(),
            Self::Poses(_) => return None,
        })
    }
}

/// A field of the settings that can be taken as a [`Value`].
pub(super) trait Field {
    /// The value as text, number or switch.
    fn value(&self) -> Value;

    /// Takes a value; false if it is of another kind.
    fn put(&mut self, value: &Value) -> bool;
}

impl<T: Choice> Field for T {
    fn value(&self) -> Value {
        Value::Choice(self.name())
    }

    fn put(&mut self, value: &Value) -> bool {
        let Value::Choice(name) = value else {
            return false;
        };
        // The same choice again keeps its parameters.
        if self.name() != *name {
            let Some(choice) = T::from_name(name) else {
                return false;
            };
            *self = choice;
        }
        true
    }
}

/// Fields that are a value as they stand.
macro_rules! fields {
    ($($kind:ident($type:ty)),*) => {$(
        impl Field for $type {
            fn value(&self) -> Value {
                Value::$kind(self.clone())
            }

            fn put(&mut self, value: &Value) -> bool {
                let Value::$kind(value) = value else {
                    return false;
                };
                self.clone_from(value);
                true
            }
        }
    )*};
}

fields! {
    Switch(bool), Count(usize), Limit(Option<usize>), Number(f64), Floor(Floor), Reach(Option<f64>),
    Poses(Vec<Similarity>)
}

/// Access to a field, and why it may have no effect.
macro_rules! at {
    ($($field:ident).+) => {
        at!($($field).+, |_| None)
    };
    ($($field:ident).+, $unused:expr) => {
        Access {
            get: |recipe| Some(recipe.$($field).+.value()),
            set: |recipe, value| recipe.$($field).+.put(value),
            unused: $unused,
        }
    };
}
pub(super) use at;
