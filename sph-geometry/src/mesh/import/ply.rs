//! Stanford PLY: vertices and faces, in text or in bytes of either order.

use super::number::number;
use super::ply_header::{self, Encoding, Property, Scalar};
use super::soup::Soup;

/// Adds the faces, cut into triangles, and returns the number of bytes behind the last element.
pub fn read(bytes: &[u8], soup: &mut Soup) -> Result<usize, String> {
    let (header, rest) = ply_header::read(bytes)?;
    let mut numbers = Numbers { encoding: header.encoding, rest };
    let mut vertices: Option<Vec<u32>> = None;
    let mut corners = Vec::new();
    for element in &header.elements {
        if element.name == "tristrips" && element.count > 0 {
            return Err("it holds strips of triangles; export faces instead".into());
        }
        let room = numbers.room(&element.properties);
        if element.count > room {
            return Err(format!(
                "it promises {} elements `{}`, but has room for {room} of them",
                element.count, element.name
            ));
        }
        match element.name.as_str() {
            "vertex" => {
                let axes = axes(&element.properties)?;
                let mut all = Vec::with_capacity(element.count as usize);
                for index in 0..element.count {
                    let vertex = numbers.vertex(&element.properties, axes, soup);
                    all.push(vertex.map_err(|reason| format!("vertex {index}: {reason}"))?);
                }
                vertices = Some(all);
            }
            "face" => {
                let vertices = vertices.as_deref().ok_or("it has faces before vertices")?;
                for index in 0..element.count {
                    numbers
                        .face(&element.properties, vertices, &mut corners)
                        .map_err(|reason| format!("face {index}: {reason}"))?;
                    soup.polygon(&corners);
                }
            }
            _ => {
                for index in 0..element.count {
                    for property in &element.properties {
                        numbers.each(property, |_| Ok(())).map_err(|reason| {
                            format!("element {index} of `{}`: {reason}", element.name)
                        })?;
                    }
                }
            }
        }
    }
    let rest = numbers.rest;
    Ok(if header.encoding == Encoding::Ascii { rest.trim_ascii().len() } else { rest.len() })
}

/// Where x, y and z are among the properties of a vertex.
fn axes(properties: &[Property]) -> Result<[usize; 3], String> {
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        let of = |p: &Property| p.name == name && p.list.is_none();
        *axis = properties
            .iter()
            .position(of)
            .ok_or_else(|| format!("its vertices have no coordinate {name}"))?;
    }
    Ok(axes)
}

/// The numbers of the body, one after the other.
struct Numbers<'a> {
    encoding: Encoding,
    rest: &'a [u8],
}

impl Numbers<'_> {
    /// How many elements with these properties there can be.
    fn room(&self, properties: &[Property]) -> u64 {
        let least: usize = match self.encoding {
            // A digit and a space each.
            Encoding::Ascii => 2 * properties.len(),
            _ => properties.iter().map(|p| p.list.unwrap_or(p.scalar).size()).sum(),
        };
        (self.rest.len() as u64 + 1) / (least as u64).max(1)
    }

    fn vertex(
        &mut self,
        properties: &[Property],
        axes: [usize; 3],
        soup: &mut Soup,
    ) -> Result<u32, String> {
        let mut place = [0.0; 3];
        for (index, property) in properties.iter().enumerate() {
            let axis = axes.iter().position(|axis| *axis == index);
            self.each(property, |x| {
                if let Some(axis) = axis {
                    place[axis] = x;
                }
                Ok(())
            })?;
        }
        if !crate::vector::is_finite(&place) {
            return Err(format!("its coordinates {place:?} are not finite"));
        }
        let single = axes.iter().any(|axis| properties[*axis].scalar == Scalar::F32);
        Ok(if single && self.encoding != Encoding::Ascii {
            soup.vertex_f32(place.map(|x| x as f32))
        } else {
            soup.vertex(place)
        })
    }

    fn face(
        &mut self,
        properties: &[Property],
        vertices: &[u32],
        corners: &mut Vec<u32>,
    ) -> Result<(), String> {
        corners.clear();
        for property in properties {
            let is_corner = property.name == "vertex_indices" || property.name == "vertex_index";
            self.each(property, |index| {
                if !is_corner {
                    return Ok(());
                }
                let known = (index >= 0.0 && index.fract() == 0.0).then_some(index as usize);
                let Some(vertex) = known.and_then(|index| vertices.get(index)) else {
                    let count = vertices.len();
                    return Err(format!("it names vertex {index}, but there are {count}"));
                };
                corners.push(*vertex);
                Ok(())
            })?;
        }
        Ok(())
    }

    /// Calls `take` with the number, or with each of a list.
    fn each(
        &mut self,
        property: &Property,
        mut take: impl FnMut(f64) -> Result<(), String>,
    ) -> Result<(), String> {
        let Some(length) = property.list else { return take(self.next(property.scalar)?) };
        let length = self.next(length)?;
        if !(length >= 0.0 && length.fract() == 0.0) {
            return Err(format!("a list has the length {length}"));
        }
        // Ends with the file at the latest.
        for _ in 0..length as u64 {
            take(self.next(property.scalar)?)?;
        }
        Ok(())
    }

    fn next(&mut self, scalar: Scalar) -> Result<f64, String> {
        const MISSING: &str = "the end of the file is missing";
        if self.encoding == Encoding::Ascii {
            let start = self.rest.trim_ascii_start();
            let end = start.iter().position(u8::is_ascii_whitespace).unwrap_or(start.len());
            let (word, rest) = start.split_at(end);
            self.rest = rest;
            return match std::str::from_utf8(word) {
                Ok("") => Err(MISSING.into()),
                Ok(word) => number(word),
                Err(_) => Err("it holds bytes that are no text".into()),
            };
        }
        let (bytes, rest) = self.rest.split_at_checked(scalar.size()).ok_or(MISSING)?;
        self.rest = rest;
        let mut eight = [0; 8];
        for (k, byte) in bytes.iter().enumerate() {
            let at = if self.encoding == Encoding::Little { k } else { bytes.len() - 1 - k };
            eight[at] = *byte;
        }
        let bits = u64::from_le_bytes(eight);
        Ok(match scalar {
            Scalar::I8 => f64::from(bits as u8 as i8),
            Scalar::U8 => f64::from(bits as u8),
            Scalar::I16 => f64::from(bits as u16 as i16),
            Scalar::U16 => f64::from(bits as u16),
            Scalar::I32 => f64::from(bits as u32 as i32),
            Scalar::U32 => f64::from(bits as u32),
            Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
            Scalar::F64 => f64::from_bits(bits),
        })
    }
}
