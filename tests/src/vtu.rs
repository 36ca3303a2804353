//! Reads `.vtu` files with raw appended data, checking that every byte is accounted for.

use crate::series::attribute;
use std::fs;
use std::path::Path;

/// An array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// VTK's name of its type.
    pub kind: String,
    /// Numbers per point.
    pub components: usize,
    /// The numbers.
    pub values: Vec<f64>,
}

/// The points of a file and what is known at them.
#[derive(Debug, Clone, PartialEq)]
pub struct Vtu {
    /// Number of points.
    pub points: usize,
    /// Positions, point arrays and cells.
    pub arrays: Vec<Array>,
}

impl Vtu {
    /// The array of this name.
    ///
    /// # Panics
    ///
    /// When there is none.
    #[track_caller]
    pub fn array(&self, name: &str) -> &Array {
        let found = self.arrays.iter().find(|array| array.name == name);
        found.unwrap_or_else(|| panic!("there is no array \"{name}\""))
    }
}

const TAIL: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

/// Reads a file strictly.
///
/// # Panics
///
/// When it is cut, or holds other than what its head says.
#[track_caller]
pub fn read_vtu(path: &Path) -> Vtu {
    let bytes = fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    parse(&bytes).unwrap_or_else(|problem| panic!("{}: {problem}", path.display()))
}

fn parse(bytes: &[u8]) -> Result<Vtu, String> {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let head = bytes.windows(mark.len()).position(|window| window == mark).ok_or("no data")?;
    let data = bytes[head + mark.len()..].strip_suffix(TAIL).ok_or("the end is missing")?;
    let head = std::str::from_utf8(&bytes[..head]).map_err(|e| e.to_string())?;
    if !head.starts_with("<?xml") || !head.contains("byte_order=\"LittleEndian\"") {
        return Err("another head than expected".into());
    }
    let points = piece(head).ok_or("no number of points")?;
    let mut arrays = Vec::new();
    let mut used = 0;
    for element in head.split('<').filter(|element| element.starts_with("DataArray")) {
        if attribute(element, "format") != Some("appended") {
            continue;
        }
        let (array, length) = read_array(element, points, data)
            .ok_or_else(|| format!("<{element} does not fit the data"))?;
        used += length;
        arrays.push(array);
    }
    if used != data.len() {
        return Err(format!("{used} bytes of {} belong to arrays", data.len()));
    }
    Ok(Vtu { points, arrays })
}

fn piece(head: &str) -> Option<usize> {
    let element = head.split('<').find(|element| element.starts_with("Piece"))?;
    attribute(element, "NumberOfPoints")?.parse().ok()
}

/// The array and the bytes that it takes with its length.
fn read_array(element: &str, points: usize, data: &[u8]) -> Option<(Array, usize)> {
    let kind = attribute(element, "type")?;
    let components: usize = attribute(element, "NumberOfComponents")?.parse().ok()?;
    let offset: usize = attribute(element, "offset")?.parse().ok()?;
    let size = match kind {
        "Int8" | "UInt8" => 1,
        "Int16" | "UInt16" => 2,
        "Int32" | "UInt32" | "Float32" => 4,
        "Int64" | "UInt64" | "Float64" => 8,
        _ => return None,
    };
    let block = data.get(offset..)?;
    let (length, block) = block.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    if length != points * components * size {
        return None;
    }
    let values = block.get(..length)?.chunks_exact(size).map(|bytes| number(kind, bytes));
    let name = attribute(element, "Name")?.into();
    Some((Array { name, kind: kind.into(), components, values: values.collect() }, length + 8))
}

fn number(kind: &str, bytes: &[u8]) -> f64 {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    match kind {
        "Float64" => f64::from_le_bytes(word),
        "Float32" => f64::from(f32::from_bits(u64::from_le_bytes(word) as u32)),
        // Ids and kinds are never negative, and far below 2^53.
        _ => u64::from_le_bytes(word) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::parse;
    use sph_io::{ParticleFrame, write_vtu};

    #[test]
    fn whole_files_are_read_and_cut_ones_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let positions = [[1.0, 2.0], [3.0, 4.5]];
        let frame = ParticleFrame::new(0.5, &positions)
            .with("id", vec![7_u64, 8])
            .with("pressure", vec![-1.5_f32, f32::NAN]);
        write_vtu(&path, &frame).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let vtu = parse(&bytes).unwrap();
        assert_eq!(vtu.points, 2);
        assert_eq!(vtu.array("Points").values, [1.0, 2.0, 0.0, 3.0, 4.5, 0.0]);
        assert_eq!(vtu.array("id").values, [7.0, 8.0]);
        assert_eq!(vtu.array("pressure").values[0], -1.5);
        assert!(vtu.array("pressure").values[1].is_nan());
        for cut in [1, 20, 40, bytes.len() / 2] {
            assert!(parse(&bytes[..bytes.len() - cut]).is_err(), "{cut}");
        }
        let mut gap = bytes.clone();
        gap.remove(bytes.len() - 40);
        assert!(parse(&gap).is_err());
    }
}
