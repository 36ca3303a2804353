//! Working memory that tasks borrow.

use std::sync::{Mutex, PoisonError};

/// A store of working memories, as many as tasks have run at once.
#[derive(Debug)]
pub struct Pool<T>(Mutex<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::new(Vec::new()))
    }
}

impl<T> Clone for Pool<T> {
    /// An empty store: what tasks left in memory is no state.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T: Default> Pool<T> {
    /// Runs `task` with a memory whose contents are left from earlier tasks.
    pub fn with<R>(&self, task: impl FnOnce(&mut T) -> R) -> R {
        let take = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut memory = take().pop().unwrap_or_default();
        let result = task(&mut memory);
        take().push(memory);
        result
    }
}
