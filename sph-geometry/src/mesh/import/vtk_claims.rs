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

    #[test]
    fn claims_beyond_the_file_are_refused() {
        // Three words of eight bytes: one block of 2^48 bytes, the last as large.
        let claim = "AQAAAAAAAAAAAAAAAAABAAAAAAAAAAEA";
        let file = |numbers: &str| {
            format!(
                "<VTKFile header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\
                 <DataArray format=\"binary\">{numbers}</DataArray></VTKFile>"
            )
        };
        assert!(check(file(claim).as_bytes()).is_err());
        // One block of 100 bytes.
        let small = "AQAAAAAAAABkAAAAAAAAAGQAAAAAAAAA";
        assert_eq!(check(file(small).as_bytes()), Ok(()));
        assert_eq!(check(b"<VTKFile></VTKFile>"), Ok(()));
    }
}
