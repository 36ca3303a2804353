//! Binary STL: a header of 80 bytes, a count, and triangles of 50 bytes.

use super::sniff::FORMATS;
use super::soup::Soup;

/// Header and triangle count.
pub const HEAD: usize = 84;
/// Normal, three corners, two bytes of anything.
pub const TRIANGLE: usize = 50;

/// Whether the length is exactly that of a binary file with so many triangles. Many start with
/// "solid" too.
pub fn is_exact(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| count > 0 && bytes.len() as u64 == length(count))
}

/// Refuses what cannot be a binary STL file, in particular one whose end is missing.
pub fn plausible(bytes: &[u8]) -> Result<(), String> {
    let have = bytes.len();
    let Some(count) = count(bytes) else {
        return Err(format!("it has only {have} bytes, which are no text; {FORMATS}"));
    };
    let room = (have - HEAD) / TRIANGLE;
    let sane = (0..room.min(16)).all(|t| corners(bytes, t).iter().flatten().all(|x| x.is_finite()));
    if !sane {
        return Err(format!("it is neither text nor a mesh that can be read; {FORMATS}"));
    }
    if counted(bytes, count).is_none() {
        let needed = length(count);
        return Err(format!(
            "it is binary STL whose end is missing: it promises {count} triangles in {needed} \
             bytes but has {have} bytes, room for {room}"
        ));
    }
    Ok(())
}

/// Adds the triangles and returns the number of bytes after them.
pub fn read(bytes: &[u8], soup: &mut Soup) -> Result<usize, String> {
    let promised = count(bytes).unwrap_or(0);
    let triangles = counted(bytes, promised).unwrap_or(0);
    for triangle in 0..triangles {
        let corners = corners(bytes, triangle);
        if !corners.iter().flatten().all(|x| x.is_finite()) {
            return Err(format!("triangle {triangle} has a corner that is not finite"));
        }
        let corners = corners.map(|x| soup.vertex_f32(x));
        soup.triangle(corners);
    }
    Ok(bytes.len() - HEAD - TRIANGLE * triangles)
}

fn count(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEAD - 4..HEAD)?.try_into().ok().map(u32::from_le_bytes)
}

fn length(count: u32) -> u64 {
    HEAD as u64 + TRIANGLE as u64 * u64::from(count)
}

/// How many triangles to read, if the file has them. Programs that write before they know the
/// count leave 0 or the largest number there: then all that there is room for.
fn counted(bytes: &[u8], promised: u32) -> Option<usize> {
    let room = (bytes.len() - HEAD) / TRIANGLE;
    if promised == 0 || promised == u32::MAX {
        return Some(room);
    }
    usize::try_from(promised).ok().filter(|promised| *promised <= room)
}

fn corners(bytes: &[u8], triangle: usize) -> [[f32; 3]; 3] {
    let start = HEAD + TRIANGLE * triangle + 12;
    let number = |index: usize| {
        let at = start + 4 * index;
        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    };
    [0, 3, 6].map(|corner| [0, 1, 2].map(|axis| number(corner + axis)))
}
