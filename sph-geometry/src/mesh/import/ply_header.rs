//! The header of a PLY file: which elements follow, and how they are stored.

use super::number::shown;
use super::text::Lines;

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    Little,
    Big,
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn new(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(format!("`{}` is no type of numbers", shown(name))),
        })
    }

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A property of an element: a number, or a list with its length in front.
#[derive(Debug, Clone, PartialEq)]
pub struct Property {
    pub name: String,
    pub scalar: Scalar,
    /// Type of the length of a list.
    pub list: Option<Scalar>,
}

/// Some elements of a kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// Everything in front of the numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

/// Reads the header and returns it with the bytes behind it.
pub fn read(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let mut lines = Lines::new(bytes);
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, text)) = lines.next() {
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let result = match words.as_slice() {
            [] | ["ply" | "comment" | "obj_info", ..] => Ok(()),
            ["format", format, ..] => match *format {
                "ascii" => Ok(encoding = Some(Encoding::Ascii)),
                "binary_little_endian" => Ok(encoding = Some(Encoding::Little)),
                "binary_big_endian" => Ok(encoding = Some(Encoding::Big)),
                other => Err(format!("the format `{}` is unknown", shown(other))),
            },
            ["element", name, count] => match count.parse() {
                Ok(count) => {
                    let (name, properties) = (name.to_string(), Vec::new());
                    elements.push(Element { name, count, properties });
                    Ok(())
                }
                Err(_) => Err(format!("`{}` is no number of elements", shown(count))),
            },
            ["property", words @ ..] => property(words).and_then(|property| {
                let element = elements.last_mut().ok_or("a property without an element")?;
                element.properties.push(property);
                Ok(())
            }),
            ["end_header"] => {
                let encoding = encoding.ok_or("its header names no format")?;
                return Ok((Header { encoding, elements }, lines.rest()));
            }
            [word, ..] => Err(format!("`{}` is no part of a header", shown(word))),
        };
        result.map_err(|reason| format!("line {line}: {reason}"))?;
    }
    Err("its header has no end".into())
}

fn property(words: &[&str]) -> Result<Property, String> {
    match words {
        ["list", length, scalar, name] => Ok(Property {
            name: name.to_string(),
            scalar: Scalar::new(scalar)?,
            list: Some(Scalar::new(length)?),
        }),
        [scalar, name] => {
            Ok(Property { name: name.to_string(), scalar: Scalar::new(scalar)?, list: None })
        }
        _ => Err("a property has a type and a name".into()),
    }
}
