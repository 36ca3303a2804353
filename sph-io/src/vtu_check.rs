//! Whether the packed arrays of a VTK XML file can be what they claim.
//!
//! A packed array begins with the number of its blocks, their size unpacked, the size of the last one, and the
//! packed size of each (<https://vtk.org/Wiki/VTK_XML_Formats>). `vtkio` asks for that much memory before it looks at
//! the data, so that one damaged byte may ask for terabytes.

/// No packing makes this many bytes of one: zlib up to 1032, LZ4 up to 255.
const MOST_PER_BYTE: u64 = 1100;

/// Looks at the heads of all packed arrays that are written into the file as base64.
///
/// # Errors
///
/// What cannot be.
pub fn check(file: &[u8]) -> Result<(), &'static str> {
    let text = String::from_utf8_lossy(file);
    let head = text.split('>').find(|tag| tag.contains("<VTKFile")).unwrap_or_default();
    if !head.contains("compressor=") {
        return Ok(());
    }
    let width = if head.contains("\"UInt64\"") { 8 } else { 4 };
    let big = head.contains("\"BigEndian\"");
    for array in text.split("<DataArray").skip(1) {
        let Some((tag, rest)) = array.split_once('>') else { return Err("a tag does not end") };
        // Tags that end at once have no content.
        if !tag.contains("\"binary\"") || tag.ends_with('/') {
            continue;
        }
        let content = rest.split('<').next().unwrap_or_default().trim();
        if !content.is_empty() {
            check_array(content, width, big)?;
        }
    }
    Ok(())
}

fn check_array(content: &str, width: usize, big: bool) -> Result<(), &'static str> {
    let head = decoded(content, 3 * width).ok_or("an array is no base64")?;
    let number = |k: usize| {
        let bytes = &head[k * width..(k + 1) * width];
        let shift = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        if big { bytes.iter().fold(0, shift) } else { bytes.iter().rev().fold(0, shift) }
    };
    let [blocks, size, last] = [0, 1, 2].map(number);
    let room = content.len() as u64;
    let unpacked = match blocks {
        0 => size.max(last),
        _ => size.saturating_mul(blocks - 1).saturating_add(last.max(size)),
    };
    // An array without numbers may name the size of a block all the same.
    let claims_too_much = blocks > 0 && unpacked > room.saturating_mul(MOST_PER_BYTE).max(1 << 26);
    if claims_too_much || blocks > room || (blocks == 0 && size != last) {
        return Err("an array claims more numbers than fit into the file");
    }
    Ok(())
}

/// The first `count` bytes of base64.
fn decoded(text: &str, count: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    for four in text.as_bytes().chunks(4) {
        if bytes.len() >= count {
            break;
        }
        let mut bits = 0;
        for &c in four {
            let six = match c {
                b'A'..=b'Z' => c - b'A',
                b'a'..=b'z' => c - b'a' + 26,
                b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                // Padding: what it stands for is cut off below or is not there.
                b'=' => 0,
                _ => return None,
            };
            bits = bits << 6 | u32::from(six);
        }
        bytes.extend_from_slice(&bits.to_be_bytes()[1..]);
    }
    bytes.truncate(count);
    (bytes.len() == count).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Compression, ParticleFrame, write_vtu};

    #[test]
    fn base64_is_read() {
        assert_eq!(decoded("SGVsbG8h", 6).unwrap(), b"Hello!");
        assert_eq!(decoded("SGVsbG8h", 4).unwrap(), b"Hell");
        assert_eq!(decoded("SGVs", 4), None);
        assert_eq!(decoded("S\"Vs", 3), None);
    }

    #[test]
    fn whole_files_pass_and_claims_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        for count in [0, 1, 5000, 100_000] {
            // It packs as well as anything can.
            let positions = vec![[0.0; 3]; count];
            for compression in [Compression::Lz4, Compression::Zlib] {
                let frame = ParticleFrame::new(0.0, &positions).compressed(compression);
                write_vtu(&path, &frame).unwrap();
                let bytes = std::fs::read(&path).unwrap();
                assert_eq!(check(&bytes), Ok(()), "{count}");
            }
        }
        let claim = |blocks: u64, size: u64, last: u64| {
            let head = "<VTKFile header_type=\"UInt64\" compressor=\"vtkLZ4DataCompressor\">";
            let numbers: Vec<u8> =
                [blocks, size, last].iter().flat_map(|n| n.to_le_bytes()).collect();
            let text = format!(
                "{head}<DataArray format=\"binary\">{}</DataArray></VTKFile>",
                encoded(&numbers)
            );
            check(text.as_bytes())
        };
        assert_eq!(claim(1, 100, 100), Ok(()));
        for [blocks, size, last] in
            [[1, 1 << 48, 1 << 48], [1, 8, 1 << 60], [1 << 61, 8, 8], [u64::MAX, 8, 8], [0, 7, 9]]
        {
            assert!(claim(blocks, size, last).is_err(), "{blocks} {size} {last}");
        }
    }

    fn encoded(bytes: &[u8]) -> String {
        const DIGITS: &[u8; 64] =
            b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let three = |three: &[u8]| {
            let bits = three.iter().fold(0, |bits, &byte| bits << 8 | usize::from(byte));
            [18, 12, 6, 0].map(|shift| char::from(DIGITS[bits >> shift & 63]))
        };
        bytes.chunks_exact(3).flat_map(three).collect()
    }
}
