//! One named quantity of all particles, borrowed or owned.

use std::borrow::Cow;

use bytemuck::Pod;

use crate::IoError;

macro_rules! numbers {
    ($($variant:ident, $number:ty, $what:literal;)*) => {
        /// Machine type of one number of a column.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Scalar {
            $(#[doc = $what] $variant,)*
        }

        impl Scalar {
            /// Bytes of one number.
            #[must_use]
            pub const fn size(self) -> usize {
                match self { $(Self::$variant => size_of::<$number>(),)* }
            }

            /// The name in Rust.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($number),)* }
            }
        }

        /// Numbers of one machine type, borrowed or owned.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Values<'a> {
            $(#[doc = $what] $variant(Cow<'a, [$number]>),)*
        }

        impl Values<'_> {
            /// How many numbers there are.
            #[must_use]
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(numbers) => numbers.len(),)* }
            }

            /// Their machine type.
            #[must_use]
            pub fn scalar(&self) -> Scalar {
                match self { $(Self::$variant(_) => Scalar::$variant,)* }
            }

            /// The numbers as bytes in this machine's order.
            #[must_use]
            pub fn bytes(&self) -> &[u8] {
                match self { $(Self::$variant(numbers) => bytemuck::cast_slice(numbers),)* }
            }
        }

        impl Column<'_> {
            /// The selected rows as VTK wants them: vectors of the plane get a zero third
            /// component. Borrowed when they are so already.
            pub(crate) fn in_space(&self, selection: Option<&[u32]>) -> Column<'_> {
                let values = match &self.values {
                    $(Values::$variant(numbers) => {
                        Values::$variant(in_space(numbers, self.components, selection))
                    })*
                };
                Column { values, components: padded(self.components) }
            }
        }

        impl Column<'static> {
            /// Rows of `components` numbers out of bytes in this machine's order.
            pub(crate) fn from_bytes(scalar: Scalar, bytes: &[u8], components: usize) -> Self {
                match scalar {
                    $(Scalar::$variant => Self::from_numbers(
                        bytemuck::pod_collect_to_vec::<u8, $number>(bytes),
                        components,
                    ),)*
                }
            }
        }

        $(
            impl sealed::Sealed for $number {}
            impl Number for $number {
                const SCALAR: Scalar = Scalar::$variant;
                fn wrap(numbers: Cow<'_, [Self]>) -> Values<'_> {
                    Values::$variant(numbers)
                }
                fn unwrap<'c>(values: &'c Values<'_>) -> Option<&'c [Self]> {
                    match values { Values::$variant(numbers) => Some(numbers), _ => None }
                }
            }
        )*
    };
}

numbers! {
    F32, f32, "32-bit floating point.";
    F64, f64, "64-bit floating point.";
    U8, u8, "8-bit unsigned integers.";
    U16, u16, "16-bit unsigned integers.";
    U32, u32, "32-bit unsigned integers.";
    U64, u64, "64-bit unsigned integers.";
    I64, i64, "64-bit signed integers.";
}

impl Values<'_> {
    /// True when there is no number.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

mod sealed {
    pub trait Sealed {}
}

/// A machine number that files hold.
pub trait Number: Pod + sealed::Sealed {
    /// Its machine type.
    const SCALAR: Scalar;
    /// Numbers as values of any type.
    fn wrap(numbers: Cow<'_, [Self]>) -> Values<'_>;
    /// The numbers, when they are of this type.
    fn unwrap<'c>(values: &'c Values<'_>) -> Option<&'c [Self]>;
}

/// A row of a column: one number, or an array of numbers for a vector or tensor.
pub trait Element: Pod {
    /// The type of its numbers.
    type Number: Number;
    /// Numbers per row.
    const COMPONENTS: usize;
}

impl<T: Number> Element for T {
    type Number = T;
    const COMPONENTS: usize = 1;
}

impl<T: Number, const N: usize> Element for [T; N] {
    type Number = T;
    const COMPONENTS: usize = N;
}

/// One quantity of all particles, one row per particle, borrowed or owned.
///
/// Slices, vectors and references to vectors of numbers (`f32`, `f64`, `u8`, `u16`, `u32`, `u64`,
/// `i64`) or of arrays of numbers convert with `into()`. Borrowing copies nothing.
///
/// # Examples
///
/// ```
/// use sph_io::{Column, Scalar};
///
/// let velocity = [[1.0_f32, 0.0], [0.0, 1.0]];
/// let column: Column<'_> = (&velocity[..]).into();
/// assert_eq!((column.rows(), column.components()), (2, 2));
/// assert_eq!(column.values().scalar(), Scalar::F32);
/// assert_eq!(column.view::<[f32; 2]>(), Some(&velocity[..]));
/// assert_eq!(column.view::<f64>(), None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Column<'a> {
    values: Values<'a>,
    components: usize,
}

impl<'a> Column<'a> {
    /// A column of `components` numbers per row, given one after the other.
    ///
    /// Numbers that do not fill a row are not part of the column.
    #[must_use]
    pub fn from_numbers<T: Number>(numbers: impl Into<Cow<'a, [T]>>, components: usize) -> Self {
        Self { values: T::wrap(numbers.into()), components: components.max(1) }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.values.len() / self.components
    }

    /// Numbers per row.
    #[must_use]
    pub fn components(&self) -> usize {
        self.components
    }

    /// The numbers, row after row.
    #[must_use]
    pub fn values(&self) -> &Values<'a> {
        &self.values
    }

    pub(crate) fn into_values(self) -> Values<'a> {
        self.values
    }

    /// The rows, when they are of type `T`.
    #[must_use]
    pub fn view<T: Element>(&self) -> Option<&[T]> {
        let numbers = T::Number::unwrap(&self.values)?;
        (self.components == T::COMPONENTS).then(|| bytemuck::cast_slice(numbers))
    }

    /// What a row is, in Rust's spelling.
    pub(crate) fn type_name(&self) -> String {
        type_name(self.values.scalar(), self.components)
    }
}

/// Components in the file of a row of `components`: VTK knows no vectors in the plane.
pub(crate) const fn padded(components: usize) -> usize {
    if components == 2 { 3 } else { components }
}

fn in_space<'v, T: Number>(
    numbers: &'v [T],
    components: usize,
    selection: Option<&[u32]>,
) -> Cow<'v, [T]> {
    let width = padded(components);
    let rows = selection.map_or(numbers.len() / components, <[u32]>::len);
    if selection.is_none() && width == components {
        return Cow::Borrowed(numbers);
    }
    let mut out = Vec::with_capacity(rows * width);
    for row in 0..rows {
        let start = selection.map_or(row, |selection| selection[row] as usize) * components;
        out.extend_from_slice(&numbers[start..start + components]);
        out.resize((row + 1) * width, T::zeroed());
    }
    Cow::Owned(out)
}

fn type_name(scalar: Scalar, components: usize) -> String {
    match components {
        1 => scalar.name().to_owned(),
        n => format!("[{}; {n}]", scalar.name()),
    }
}

impl<'a, T: Number> From<&'a [T]> for Column<'a> {
    fn from(rows: &'a [T]) -> Self {
        Self::from_numbers(rows, 1)
    }
}

impl<'a, T: Number> From<&'a Vec<T>> for Column<'a> {
    fn from(rows: &'a Vec<T>) -> Self {
        Self::from_numbers(&rows[..], 1)
    }
}

impl<T: Number> From<Vec<T>> for Column<'_> {
    fn from(rows: Vec<T>) -> Self {
        Self::from_numbers(rows, 1)
    }
}

impl<'a, T: Number, const N: usize> From<&'a [[T; N]]> for Column<'a> {
    fn from(rows: &'a [[T; N]]) -> Self {
        Self::from_numbers(rows.as_flattened(), N)
    }
}

impl<'a, T: Number, const N: usize> From<&'a Vec<[T; N]>> for Column<'a> {
    fn from(rows: &'a Vec<[T; N]>) -> Self {
        Self::from(&rows[..])
    }
}

impl<T: Number, const N: usize> From<Vec<[T; N]>> for Column<'_> {
    fn from(rows: Vec<[T; N]>) -> Self {
        Self::from_numbers(rows.into_flattened(), N)
    }
}

/// The column `name` as rows of type `T`, or what is wrong.
pub(crate) fn find<'c, T: Element>(
    columns: &'c [(String, Column<'_>)],
    name: &str,
) -> Result<&'c [T], IoError> {
    let Some((_, column)) = columns.iter().find(|(n, _)| n == name) else {
        let present: Vec<&str> = columns.iter().map(|(n, _)| n.as_str()).collect();
        return Err(IoError::MissingColumn { name: name.to_owned(), present: present.join(", ") });
    };
    column.view().ok_or_else(|| IoError::ColumnType {
        name: name.to_owned(),
        found: column.type_name(),
        expected: type_name(T::Number::SCALAR, T::COMPONENTS),
    })
}

/// Refuses names that XML, HDF5 paths or a reader of the file would trip over.
pub(crate) fn check_name(name: &str) -> Result<(), IoError> {
    let problem = if name.is_empty() {
        "it is empty"
    } else if name.chars().any(char::is_control) {
        "it holds a control character"
    } else if name.contains(['\u{fffe}', '\u{ffff}']) {
        "it holds a character that XML does not know"
    } else if name.contains(['/', '\\']) || name == "." || name == ".." {
        "it reads as a path"
    } else {
        return Ok(());
    };
    Err(IoError::Name { name: name.to_owned(), problem })
}

/// Checks names (valid, no two alike) and lengths of a set of columns.
pub(crate) fn check_columns(
    columns: &[(String, Column<'_>)],
    particles: usize,
) -> Result<(), IoError> {
    for (i, (name, column)) in columns.iter().enumerate() {
        check_name(name)?;
        if columns[..i].iter().any(|(other, _)| other == name) {
            return Err(IoError::Name { name: name.clone(), problem: "two columns carry it" });
        }
        if column.rows() != particles || column.values.len() % column.components != 0 {
            return Err(IoError::ColumnLength {
                name: name.clone(),
                found: column.rows(),
                expected: particles,
            });
        }
    }
    Ok(())
}
