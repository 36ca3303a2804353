//! Reads typed values out of a [`Node`] through serde, with errors that say where and why.
//!
//! serde's derives declare the keys once, for reading and for the JSON schema; this deserializer
//! keeps what serde knows about a mistake (the unknown key, the keys that would be valid) as data
//! instead of as text.

use super::document::{Entry, Node, Place, Value};
use super::error::ErrorKind;
use super::located::LOCATED;
use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, Expected, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, VariantAccess, Visitor, value::StrDeserializer,
};
use std::fmt;

/// A mistake, with its place as soon as that is known.
#[derive(Debug)]
pub struct ReadError {
    /// What.
    pub kind: Box<ErrorKind>,
    /// Where.
    pub place: Option<Place>,
}

impl ReadError {
    fn new(kind: ErrorKind) -> Self {
        Self { kind: Box::new(kind), place: None }
    }

    /// Fills in what only the caller knows: the place, and the name of the thing.
    fn within(mut self, place: Place, path: &Path<'_>) -> Self {
        if self.place.is_some() {
            return self;
        }
        self.place = Some(place);
        match &mut *self.kind {
            ErrorKind::UnknownKey { table, .. } | ErrorKind::MissingKey { table, .. } => {
                *table = path.table();
            }
            ErrorKind::UnknownChoice { key, .. } | ErrorKind::WrongType { key, .. } => {
                *key = path.to_string();
            }
            _ => {}
        }
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

impl std::error::Error for ReadError {}

impl de::Error for ReadError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(ErrorKind::Invalid { what: message.to_string(), help: String::new() })
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::new(ErrorKind::WrongType {
            key: String::new(),
            expected: in_words(&expected.to_string()),
            found: String::new(),
        })
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::new(ErrorKind::UnknownChoice {
            key: String::new(),
            found: variant.into(),
            valid: expected.iter().map(ToString::to_string).collect(),
        })
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::new(ErrorKind::UnknownKey {
            key: field.into(),
            table: String::new(),
            valid: expected.iter().map(ToString::to_string).collect(),
        })
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(ErrorKind::MissingKey { key: field.into(), table: String::new() })
    }
}

/// What serde calls a type, for people.
fn in_words(expected: &str) -> String {
    match expected {
        "f64" => "a number".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number that is not negative".into(),
        "a sequence" => "an array".into(),
        other if other.starts_with("struct ") || other == "a map" => "a table".into(),
        other if other.starts_with("enum ") => "one of the choices, as a string".into(),
        other => other.into(),
    }
}

/// The keys that lead to a node.
#[derive(Debug, Clone, Copy)]
enum Path<'a> {
    /// The whole scene.
    Root,
    /// The value of a key.
    Key(&'a Path<'a>, &'a str),
    /// An element of an array.
    Index(&'a Path<'a>, usize),
}

impl Path<'_> {
    /// The table at this path in words.
    fn table(&self) -> String {
        match self {
            Self::Root => "the scene".into(),
            _ => format!("[{self}]"),
        }
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => f.write_str("scene"),
            Self::Key(Path::Root, key) => f.write_str(key),
            Self::Key(parent, key) => write!(f, "{parent}.{key}"),
            Self::Index(parent, index) => write!(f, "{parent}.{index}"),
        }
    }
}

/// A node being read.
#[derive(Debug, Clone, Copy)]
struct Reader<'a, 'p> {
    node: &'a Node,
    path: Path<'p>,
}

/// Reads a value of type `T` out of the whole document.
pub fn read<'a, T: de::Deserialize<'a>>(root: &'a Node) -> Result<T, ReadError> {
    T::deserialize(Reader { node: root, path: Path::Root })
}

impl Reader<'_, '_> {
    fn finish<T>(self, result: Result<T, ReadError>) -> Result<T, ReadError> {
        result.map_err(|mut error| {
            if error.place.is_none()
                && let ErrorKind::WrongType { found, .. } = &mut *error.kind
            {
                *found = self.node.value.describe();
            }
            error.within(self.node.place, &self.path)
        })
    }
}

impl<'de> Deserializer<'de> for Reader<'de, '_> {
    type Error = ReadError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let result = match &self.node.value {
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Integer(number) => visitor.visit_i64(*number),
            Value::Float(number) => visitor.visit_f64(*number),
            Value::Boolean(truth) => visitor.visit_bool(*truth),
            Value::Datetime(date) => {
                Err(de::Error::invalid_type(Unexpected::Other(date), &visitor))
            }
            Value::Array(nodes) => visitor.visit_seq(Elements { nodes, next: 0, path: &self.path }),
            Value::Table(entries) => visitor.visit_map(Entries { entries, path: &self.path }),
        };
        self.finish(result)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        _: usize,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        if name == LOCATED {
            visitor.visit_seq(Located { reader: self, next: 0 })
        } else {
            self.deserialize_any(visitor)
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let result = match &self.node.value {
            Value::String(text) => visitor.visit_enum(Choice(text)),
            _ => Err(ReadError::new(ErrorKind::WrongType {
                key: String::new(),
                expected: "one of the choices, as a string".into(),
                found: String::new(),
            })),
        };
        self.finish(result)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct seq tuple map struct identifier ignored_any
    }
}

/// The place of a node in numbers, then the node.
struct Located<'a, 'p> {
    reader: Reader<'a, 'p>,
    next: usize,
}

impl<'a> SeqAccess<'a> for Located<'a, '_> {
    type Error = ReadError;

    fn next_element_seed<S: DeserializeSeed<'a>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, ReadError> {
        let place = self.reader.node.place;
        self.next += 1;
        match self.next {
            1 => seed.deserialize(place.source.into_deserializer()).map(Some),
            2 => seed.deserialize(place.start.into_deserializer()).map(Some),
            3 => seed.deserialize(place.end.into_deserializer()).map(Some),
            4 => seed.deserialize(self.reader).map(Some),
            _ => Ok(None),
        }
    }
}

struct Elements<'a, 'p> {
    nodes: &'a [Node],
    next: usize,
    path: &'p Path<'p>,
}

impl<'a> SeqAccess<'a> for Elements<'a, '_> {
    type Error = ReadError;

    fn next_element_seed<S: DeserializeSeed<'a>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, ReadError> {
        let Some(node) = self.nodes.get(self.next) else { return Ok(None) };
        let path = Path::Index(self.path, self.next);
        self.next += 1;
        seed.deserialize(Reader { node, path }).map(Some)
    }
}

struct Entries<'a, 'p> {
    entries: &'a [Entry],
    path: &'p Path<'p>,
}

impl<'a> MapAccess<'a> for Entries<'a, '_> {
    type Error = ReadError;

    fn next_key_seed<S: DeserializeSeed<'a>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, ReadError> {
        let Some(entry) = self.entries.first() else { return Ok(None) };
        let key: StrDeserializer<'_, ReadError> = entry.key.as_str().into_deserializer();
        let key = seed.deserialize(key).map_err(|error| error.within(entry.place, self.path))?;
        Ok(Some(key))
    }

    fn next_value_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<S::Value, ReadError> {
        let Some((entry, rest)) = self.entries.split_first() else {
            return Err(de::Error::custom("a key has no value"));
        };
        self.entries = rest;
        seed.deserialize(Reader { node: &entry.node, path: Path::Key(self.path, &entry.key) })
    }
}

/// A word that chooses a variant without content.
struct Choice<'a>(&'a str);

impl<'a> EnumAccess<'a> for Choice<'a> {
    type Error = ReadError;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'a>>(self, seed: S) -> Result<(S::Value, Self), ReadError> {
        let word: StrDeserializer<'a, ReadError> = self.0.into_deserializer();
        Ok((seed.deserialize(word)?, self))
    }
}

impl<'a> VariantAccess<'a> for Choice<'a> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        Ok(())
    }

    fn newtype_variant_seed<S: DeserializeSeed<'a>>(self, _: S) -> Result<S::Value, ReadError> {
        Err(no_content())
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, _: V) -> Result<V::Value, ReadError> {
        Err(no_content())
    }

    fn struct_variant<V: Visitor<'a>>(
        self,
        _: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, ReadError> {
        Err(no_content())
    }
}

fn no_content() -> ReadError {
    de::Error::custom("a choice is one word and has no further content")
}
