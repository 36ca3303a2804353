//! Named single values of a state: parameters, counters, texts.

use std::collections::BTreeMap;
use std::collections::btree_map::Iter;

use crate::IoError;

/// A value beside the columns.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Attribute {
    /// A number.
    F64(f64),
    /// A count or a switch.
    U64(u64),
    /// A text of any length, the scene for example.
    Text(String),
    /// A few numbers, the state of a rigid body for example.
    F64Array(Vec<f64>),
    /// A few counts.
    U64Array(Vec<u64>),
}

macro_rules! from {
    ($($type:ty, $variant:ident;)*) => {
        $(impl From<$type> for Attribute {
            fn from(value: $type) -> Self {
                Self::$variant(value.into())
            }
        })*
    };
}

from! {
    f64, F64;
    u64, U64;
    u32, U64;
    bool, U64;
    &str, Text;
    String, Text;
    &[f64], F64Array;
    Vec<f64>, F64Array;
    &[u64], U64Array;
    Vec<u64>, U64Array;
}

impl<const N: usize> From<[f64; N]> for Attribute {
    fn from(value: [f64; N]) -> Self {
        Self::F64Array(value.into())
    }
}

/// Attributes by name, in the order of their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes(BTreeMap<String, Attribute>);

macro_rules! getter {
    ($name:ident, $variant:ident, $type:ty, $what:literal, $give:expr) => {
        #[doc = concat!("The ", $what, " called `name`.")]
        ///
        /// # Errors
        ///
        /// [`IoError::MissingAttribute`] when there is none, or one of another type.
        pub fn $name(&self, name: &str) -> Result<$type, IoError> {
            match self.0.get(name) {
                Some(Attribute::$variant(value)) => Ok($give(value)),
                _ => Err(self.missing(name, $what)),
            }
        }
    };
}

impl Attributes {
    /// Sets an attribute; one of the same name is replaced.
    pub fn set(&mut self, name: impl Into<String>, value: impl Into<Attribute>) {
        self.0.insert(name.into(), value.into());
    }

    /// The attribute called `name`.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Attribute> {
        self.0.get(name)
    }

    /// All of them, in the order of their names.
    pub fn iter(&self) -> Iter<'_, String, Attribute> {
        self.0.iter()
    }

    getter!(f64, F64, f64, "number", |v: &f64| *v);
    getter!(u64, U64, u64, "count", |v: &u64| *v);
    getter!(text, Text, &str, "text", String::as_str);
    getter!(f64_array, F64Array, &[f64], "array of numbers", Vec::as_slice);
    getter!(u64_array, U64Array, &[u64], "array of counts", Vec::as_slice);

    pub(crate) fn remove(&mut self, name: &str) -> Option<Attribute> {
        self.0.remove(name)
    }

    fn missing(&self, name: &str, expected: &'static str) -> IoError {
        let present: Vec<&str> = self.0.keys().map(String::as_str).collect();
        IoError::MissingAttribute { name: name.to_owned(), expected, present: present.join(", ") }
    }
}

impl<'a> IntoIterator for &'a Attributes {
    type Item = (&'a String, &'a Attribute);
    type IntoIter = Iter<'a, String, Attribute>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
