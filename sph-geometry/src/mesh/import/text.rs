//! Lines of a text that ends them as it likes.

use std::borrow::Cow;

/// The lines of a text, counted from 1. They end with LF, CR LF or, as once on the Macintosh, CR.
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0 }
    }

    /// What has not been read.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let (line, rest) = match end {
            None => (self.rest, &self.rest[self.rest.len()..]),
            Some(end) => {
                let two = self.rest[end..].starts_with(b"\r\n");
                (&self.rest[..end], &self.rest[end + 1 + usize::from(two)..])
            }
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, String::from_utf8_lossy(line)))
    }
}

/// Whether a line is a comment in one of the ways in which programs write them.
pub fn is_comment(line: &str) -> bool {
    ["#", "//", ";", "!", "%"].iter().any(|mark| line.trim_start().starts_with(mark))
}
