//! What was made of something shared is found again by which one it is.

use std::any::Any;
use std::sync::{Arc, Weak};

/// Names something shared without holding it. Its allocation stays as long as it is named, so that nothing else gets
/// the same address.
#[derive(Debug, Clone)]
pub(super) struct Identity(Weak<dyn Any + Send + Sync>);

impl Identity {
    pub fn of<T: Any + Send + Sync>(shared: &Arc<T>) -> Self {
        let named: Weak<T> = Arc::downgrade(shared);
        Self(named)
    }

    /// True while someone holds it.
    pub fn is_there(&self) -> bool {
        self.0.strong_count() > 0
    }
}

impl PartialEq for Identity {
    fn eq(&self, other: &Self) -> bool {
        self.0.ptr_eq(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_later_is_never_taken_for_what_is_gone() {
        let first = Arc::new([0_u64; 4]);
        let named = Identity::of(&first);
        assert!(named == Identity::of(&Arc::clone(&first)) && named.is_there());
        drop(first);
        assert!(!named.is_there());
        // An allocator gives the place that was freed last to the next thing of the same size.
        for _ in 0..100 {
            assert!(named != Identity::of(&Arc::new([0_u64; 4])));
        }
    }
}
