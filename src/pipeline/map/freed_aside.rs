//! Values whose memory is given back on another thread.

/// A large value that is given back to the system on another thread, so that the work that had it, and a cancel of
/// it, need not wait for that.
pub(super) struct FreedAside<T: Send + 'static>(Option<T>);

impl<T: Send + 'static> FreedAside<T> {
    pub(super) fn new(value: T) -> Self {
        Self(Some(value))
    }

    pub(super) fn value(&self) -> &T {
        self.0.as_ref().expect("only taken out when dropped")
    }
}

impl<T: Send + 'static> Drop for FreedAside<T> {
    fn drop(&mut self) {
        if let Some(value) = self.0.take() {
            rayon::spawn(move || drop(value));
        }
    }
}
