//! What stands for the two parts it was made of, and for no others.

use super::Document;
use crate::role::PerRole;

/// A value with the parts it was made of. It can be had only as long as these are loaded, and again when a
/// step in the history brings them back.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OfParts<T> {
    parts: PerRole<u64>,
    value: T,
}

impl<T> OfParts<T> {
    /// A value of the parts that are loaded.
    pub fn new(document: &Document, value: T) -> Self {
        Self {
            parts: document.stamp().parts,
            value,
        }
    }

    /// The value, if its parts are those that are loaded.
    pub fn current(&self, document: &Document) -> Option<&T> {
        (self.parts == document.stamp().parts).then_some(&self.value)
    }

    /// The same, to be changed.
    pub(super) fn current_mut(&mut self, document: &Document) -> Option<&mut T> {
        (self.parts == document.stamp().parts).then_some(&mut self.value)
    }
}
