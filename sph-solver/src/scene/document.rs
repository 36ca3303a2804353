//! The parsed TOML text of a scene: every key and value knows where it was written.

use super::error::{ErrorKind, SceneError};
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// A text that part of a scene was written in: the scene file or a `--set` argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// What to call it: the path of the file, or `--set`.
    pub name: String,
    /// All of it.
    pub text: String,
}

/// Where something was written: bytes of one of the [`Sources`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Place {
    /// Index of the source.
    pub source: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// All texts of a scene: the file first, then the `--set` arguments.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Sources(Arc<Vec<Source>>);

impl Sources {
    /// The texts in the order that [`Place::source`] counts them.
    pub fn new(sources: Vec<Source>) -> Self {
        Self(Arc::new(sources))
    }

    /// The source of a place.
    pub fn get(&self, place: Place) -> Option<&Source> {
        self.0.get(place.source)
    }

    /// Line and column of the start of a place, both from 1; columns count characters.
    pub fn line_and_column(&self, place: Place) -> Option<(usize, usize)> {
        let text = &self.get(place)?.text;
        let before = text.get(..place.start.min(text.len()))?;
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = 1 + before.bytes().filter(|byte| *byte == b'\n').count();
        Some((line, 1 + before[line_start..].chars().count()))
    }

    /// The `--set` arguments.
    pub fn arguments(&self) -> impl Iterator<Item = &str> {
        self.0.iter().skip(1).map(|source| source.text.as_str())
    }

    /// The error of `kind` at `place`.
    pub fn error(&self, place: Place, kind: ErrorKind) -> SceneError {
        SceneError::new(kind, Some(place), self.clone())
    }
}

/// A value and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where.
    pub place: Place,
    /// What.
    pub value: Value,
}

/// A TOML value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A string.
    String(String),
    /// A whole number.
    Integer(i64),
    /// Any other number.
    Float(f64),
    /// true or false.
    Boolean(bool),
    /// A date or time, as written.
    Datetime(String),
    /// A list.
    Array(Vec<Node>),
    /// Keys and values in the order of the file.
    Table(Vec<Entry>),
}

/// A key of a table with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key was written.
    pub place: Place,
    /// Its value.
    pub node: Node,
}

impl Value {
    /// The kind of value in words, with the value itself where it is short.
    pub fn describe(&self) -> String {
        match self {
            Self::String(text) => format!("the string {text:?}"),
            Self::Integer(number) => format!("the number {number}"),
            Self::Float(number) => format!("the number {number}"),
            Self::Boolean(truth) => format!("the truth value {truth}"),
            Self::Datetime(date) => format!("the date {date}"),
            Self::Array(_) => "an array".into(),
            Self::Table(_) => "a table".into(),
        }
    }
}

/// Parses the scene file, the source of index 0 in the places of the result.
pub fn parse_file(sources: &Sources, text: &str) -> Result<Node, SceneError> {
    match DeTable::parse(text) {
        Ok(table) => {
            let mut root = Builder { sources, source: 0, offset: 0 }.table(table.get_ref())?;
            root.place = Place { source: 0, start: 0, end: 0 };
            Ok(root)
        }
        Err(error) => {
            let span = error.span().unwrap_or(0..0);
            let place = Place { source: 0, start: span.start, end: span.end };
            Err(sources.error(place, ErrorKind::Syntax { message: one_line(error.message()) }))
        }
    }
}

/// Parses the value of a `--set` argument, which starts at byte `offset` of source `source`.
/// A text that is no TOML value stands for itself, so that `--set name=test` needs no quotes.
pub fn parse_value(
    sources: &Sources,
    source: usize,
    offset: usize,
    text: &str,
) -> Result<Node, SceneError> {
    let offset = offset + text.len() - text.trim_start().len();
    let text = text.trim();
    match DeValue::parse(text) {
        Ok(value) => {
            let span = value.span();
            Builder { sources, source, offset }.value(value.get_ref(), span)
        }
        Err(error) if text.starts_with(['[', '{', '"', '\'']) => {
            let span = error.span().unwrap_or(0..text.len());
            let place = Place { source, start: offset + span.start, end: offset + span.end };
            Err(sources.error(place, ErrorKind::Syntax { message: one_line(error.message()) }))
        }
        Err(_) => Ok(Node {
            place: Place { source, start: offset, end: offset + text.len() },
            value: Value::String(text.into()),
        }),
    }
}

/// Turns the parser's tree into ours.
struct Builder<'a> {
    sources: &'a Sources,
    source: usize,
    offset: usize,
}

impl Builder<'_> {
    fn place(&self, span: std::ops::Range<usize>) -> Place {
        let (start, end) = (self.offset + span.start, self.offset + span.end);
        Place { source: self.source, start, end }
    }

    fn table(&self, table: &DeTable<'_>) -> Result<Node, SceneError> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            entries.push(Entry {
                key: key.get_ref().to_string(),
                place: self.place(key.span()),
                node: self.value(value.get_ref(), value.span())?,
            });
        }
        // The parser sorts by key; messages should name the first mistake of the file.
        entries.sort_by_key(|entry| entry.place.start);
        Ok(Node { place: Place::default(), value: Value::Table(entries) })
    }

    fn value(&self, value: &DeValue<'_>, span: std::ops::Range<usize>) -> Result<Node, SceneError> {
        let place = self.place(span);
        let unreadable = || self.sources.error(place, ErrorKind::NotFinite);
        let value = match value {
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Integer(number) => {
                let parsed = i64::from_str_radix(number.as_str(), number.radix());
                Value::Integer(parsed.map_err(|_| unreadable())?)
            }
            DeValue::Float(number) => {
                let parsed: Option<f64> = number.as_str().parse().ok();
                Value::Float(parsed.filter(|x| x.is_finite()).ok_or_else(unreadable)?)
            }
            DeValue::Boolean(truth) => Value::Boolean(*truth),
            DeValue::Datetime(date) => Value::Datetime(date.to_string()),
            DeValue::Array(array) => {
                let nodes = array.iter().map(|node| self.value(node.get_ref(), node.span()));
                Value::Array(nodes.collect::<Result<_, _>>()?)
            }
            DeValue::Table(table) => self.table(table)?.value,
        };
        Ok(Node { place, value })
    }
}

fn one_line(message: &str) -> String {
    message.lines().map(str::trim).collect::<Vec<_>>().join(", ")
}
