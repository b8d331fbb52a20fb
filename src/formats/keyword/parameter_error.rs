//! What can be wrong with a parameter: its definition, or a field that uses it.

use super::expression::ExpressionError;

/// Why a field with a parameter in it has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
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
        /// Name of the parameter, without `&`.
        name: String,
        /// What stands in the value field.
        found: String,
    },
    /// The value names a parameter that does not exist.
    #[error(transparent)]
    Field(#[from] ParameterError),
    /// A second definition that does not count.
    #[error("parameter {0:?} is defined again, the first definition stays")]
    KeptFirst(String),
    /// A second definition that counts.
    #[error("parameter {0:?} is defined again, the later definition counts")]
    TookLater(String),
}

/// A problem with its place in the block.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterProblemAt {
    /// Index into the lines given to `ParameterTable::read_block`.
    pub line_idx: usize,
    /// Column in bytes, from 1.
    pub column: usize,
    /// What is wrong.
    pub problem: ParameterProblem,
}
