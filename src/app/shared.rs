//! Shared values that are equal if they are the same.

use std::ops::Deref;
use std::sync::Arc;

/// A large value that is shared, never changed, and equal only to itself.
///
/// Comparing two documents must not compare millions of coordinates; two parts are the same part
/// exactly when they are the same memory.
#[derive(Debug)]
pub struct Shared<T>(Arc<T>);

impl<T> Shared<T> {
    /// The pointer, to be handed to a job.
    pub fn to_arc(&self) -> Arc<T> {
        Arc::clone(&self.0)
    }
}

impl<T: Clone> Shared<T> {
    /// A value of its own.
    pub fn clone_inner(&self) -> T {
        T::clone(&self.0)
    }
}

impl<T> From<Arc<T>> for Shared<T> {
    fn from(value: Arc<T>) -> Self {
        Self(value)
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(self.to_arc())
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
