//! What the program says to its user.

use std::fmt;

/// A message on standard error. Searching it ignores frames and line breaks, which depend on the
/// length of paths.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message(pub String);

impl Message {
    /// Whether the words are in the message.
    pub fn contains(&self, words: &str) -> bool {
        squeeze(&self.0).contains(&squeeze(words))
    }

    /// How often the words are in the message.
    pub fn count(&self, words: &str) -> usize {
        squeeze(&self.0).matches(&squeeze(words)).count()
    }

    /// Asserts that all these words are there.
    ///
    /// # Panics
    ///
    /// With the whole message when some are missing.
    #[track_caller]
    pub fn assert_contains(&self, words: &[&str]) {
        for words in words {
            assert!(self.contains(words), "\"{words}\" is not in the message:\n{self}");
        }
    }

    /// Asserts that the message is for a user: no panic, no backtrace, no escape codes.
    ///
    /// # Panics
    ///
    /// With the whole message otherwise.
    #[track_caller]
    pub fn assert_readable(&self) {
        for ugly in ["panicked", "RUST_BACKTRACE", "unwrap", "src/", "\u{1b}"] {
            assert!(!self.0.contains(ugly), "{ugly:?} is in the message:\n{self}");
        }
        assert!(!self.0.trim().is_empty(), "there is no message");
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The text without white space and frames.
fn squeeze(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && !"│┃|·".contains(*c)).collect()
}

#[cfg(test)]
mod tests {
    use super::Message;

    #[test]
    fn broken_lines_do_not_hide_words() {
        let message = Message("error: the mesh /tmp/a-\n  | b.stl cannot\n  | be used".into());
        assert!(message.contains("the mesh /tmp/a-b.stl cannot be used"));
        assert!(!message.contains("can be used"));
        assert_eq!(message.count("be used"), 1);
    }
}
