//! What a run has to say besides its results.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Remarks about a run: told to whoever listens when they are made, and kept for `summary.json`.
/// Clones share their remarks.
#[derive(Clone, Default)]
pub struct Notes(Arc<Inner>);

#[derive(Default)]
struct Inner {
    made: Mutex<Vec<String>>,
    tell: Option<Box<Ear>>,
}

/// Who hears a note.
type Ear = dyn Fn(&str) + Send + Sync;

impl Notes {
    /// Notes that `tell` hears at once, each once.
    pub fn told_to(tell: impl Fn(&str) + Send + Sync + 'static) -> Self {
        Self(Arc::new(Inner { made: Mutex::default(), tell: Some(Box::new(tell)) }))
    }

    /// Makes a note, unless the same has been made before.
    pub fn add(&self, note: impl Into<String>) {
        let note = note.into();
        let mut made = self.made();
        if made.contains(&note) {
            return;
        }
        made.push(note.clone());
        drop(made);
        if let Some(tell) = &self.0.tell {
            tell(&note);
        }
    }

    /// All notes so far.
    pub fn all(&self) -> Vec<String> {
        self.made().clone()
    }

    fn made(&self) -> MutexGuard<'_, Vec<String>> {
        // A list of texts is whole whatever its last user met.
        self.0.made.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Notes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Notes").field(&self.all()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_note_is_told_once_and_kept() {
        let heard = Arc::new(Mutex::new(Vec::new()));
        let ear = Arc::clone(&heard);
        let notes = Notes::told_to(move |note| ear.lock().unwrap().push(note.to_owned()));
        let clone = notes.clone();
        for note in ["a", "b", "a"] {
            clone.add(note);
        }
        assert_eq!(notes.all(), ["a", "b"]);
        assert_eq!(*heard.lock().unwrap(), ["a", "b"]);
    }
}
