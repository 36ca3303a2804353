//! What a file is, by its content.

use super::MeshFormat;
use super::number::shown;
use super::stl_binary;
use super::text::{Lines, is_comment};
use std::borrow::Cow;

/// A file of a known kind.
pub struct Content<'a> {
    pub format: MeshFormat,
    /// Without byte-order mark and padding; text in UTF-8.
    pub bytes: Cow<'a, [u8]>,
}

/// What is read, for messages.
pub const FORMATS: &str = "STL, OBJ, PLY and VTK files are read";

/// Starts of files that are no meshes, or none that can be read.
const OTHERS: &[(&[u8], &str)] = &[
    (b"\x1f\x8b", "a gzip archive: unpack it first"),
    (b"PK\x03\x04", "a zip archive (as 3MF is): unpack it, or export as STL"),
    (b"BZh", "a bzip2 archive: unpack it first"),
    (b"\xfd7zXZ", "an xz archive: unpack it first"),
    (b"\x28\xb5\x2f\xfd", "a zstd archive: unpack it first"),
    (b"7z\xbc\xaf", "a 7-zip archive: unpack it first"),
    (b"ISO-10303", "a STEP file: export the surface as STL"),
    (b"glTF", "a glTF file: export the surface as STL"),
    (b"Kaydara FBX", "an FBX file: export the surface as STL"),
    (b"BLENDER", "a Blender file: export the surface as STL"),
    (b"$MeshFormat", "a Gmsh file: export the surface as STL"),
    (b"<!DOCTYPE", "a web page: download the mesh itself"),
    (b"<html", "a web page: download the mesh itself"),
    (b"version https://git-lfs", "a pointer of Git LFS: fetch the file with `git lfs pull`"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a PNG picture"),
    (b"\x7fELF", "a program"),
    (b"OFF", "an OFF file: export the surface as STL"),
];

/// Tells what a file is, or what it is instead.
pub fn content(bytes: &[u8]) -> Result<Content<'_>, String> {
    let found = |format, bytes| Ok(Content { format, bytes });
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    if stl_binary::is_exact(bytes) {
        return found(MeshFormat::StlBinary, bytes.into());
    }
    let text = decoded(bytes);
    let start = text.trim_ascii_start();
    if let Some((_, what)) = OTHERS.iter().find(|(magic, _)| start.starts_with(magic)) {
        return Err(format!("it is {what}"));
    }
    if start.starts_with(b"# vtk DataFile") {
        let skipped = text.len() - start.len();
        return found(MeshFormat::VtkLegacy, tail(text, skipped));
    }
    let head = &start[..start.len().min(1000)];
    if start.starts_with(b"<") && head.windows(8).any(|word| word == b"<VTKFile") {
        let skipped = text.len() - start.len();
        return found(MeshFormat::VtkXml, tail(text, skipped));
    }
    if start.starts_with(b"<?xml") {
        let what = "it is an XML file, no mesh that can be read: export the surface as STL";
        return Err(what.into());
    }
    if start.starts_with(b"ply\n") || start.starts_with(b"ply\r") {
        let ascii = start.windows(12).take(400).any(|words| words == b"format ascii");
        let format = if ascii { MeshFormat::PlyAscii } else { MeshFormat::PlyBinary };
        // The bytes of the first element may look like padding: only text is trimmed.
        let skipped = text.len() - start.len();
        return found(format, tail(text, skipped));
    }
    if !is_text(&text) {
        stl_binary::plausible(bytes)?;
        return found(MeshFormat::StlBinary, bytes.into());
    }
    let end = text.len() - text.iter().rev().take_while(|b| is_padding(**b)).count();
    let text = match text {
        Cow::Borrowed(text) => Cow::Borrowed(&text[..end]),
        Cow::Owned(mut text) => {
            text.truncate(end);
            Cow::Owned(text)
        }
    };
    match text_format(&text) {
        Ok(format) => found(format, text),
        Err(reason) => Err(reason),
    }
}

fn tail(bytes: Cow<'_, [u8]>, from: usize) -> Cow<'_, [u8]> {
    match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[from..]),
        Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(from)),
    }
}

/// STL or OBJ, by the first line that is no comment; if that says nothing, by any line.
fn text_format(text: &[u8]) -> Result<MeshFormat, String> {
    let mut first = None;
    for (_, line) in Lines::new(text) {
        if line.trim().is_empty() || is_comment(&line) {
            continue;
        }
        let word = line.split_whitespace().next().unwrap_or("").to_ascii_lowercase();
        match word.as_str() {
            "solid" | "facet" => return Ok(MeshFormat::StlAscii),
            "v" | "vn" | "vt" | "vp" | "f" | "o" | "g" | "s" | "mtllib" | "usemtl" => {
                return Ok(MeshFormat::Obj);
            }
            _ => first = first.or(Some(shown(line.trim()))),
        }
    }
    Err(match first {
        None => "it has no content but comments".into(),
        Some(line) => {
            format!("it is text without facets or vertices; it starts with `{line}`")
        }
    })
}

/// The bytes without a byte-order mark, as UTF-8.
fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let wide = |swap: bool| {
        let units = bytes[2..].chunks_exact(2).map(|pair| {
            let unit = u16::from_le_bytes([pair[0], pair[1]]);
            if swap { unit.swap_bytes() } else { unit }
        });
        let units: Vec<u16> = units.collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, ..] => wide(false),
        [0xfe, 0xff, ..] => wide(true),
        _ => Cow::Borrowed(bytes),
    }
}

/// What editors and old systems leave at the end of a text.
fn is_padding(byte: u8) -> bool {
    byte == 0 || byte == 0x1a || byte.is_ascii_whitespace()
}

/// Whether the start has no bytes that texts lack. (A binary STL file has zeros in the count.)
fn is_text(bytes: &[u8]) -> bool {
    let end = bytes.len() - bytes.iter().rev().take_while(|b| is_padding(**b)).count();
    let start = &bytes[..end.min(4096)];
    let odd = |b: &u8| *b < 9 || (14..32).contains(b) && *b != 0x1b;
    // Letters beyond ASCII are in names only.
    let foreign = start.iter().filter(|b| !b.is_ascii()).count();
    !start.iter().any(odd) && foreign <= start.len() / 2
}
