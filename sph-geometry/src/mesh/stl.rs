//! STL files: binary and ASCII in, binary out.

use super::{MeshError, TriangleMesh};
use crate::vector::{cross, norm, scaled, sub};
use std::io::Cursor;
use std::path::Path;

/// Header and triangle count of a binary file.
const HEAD: usize = 84;
/// A triangle of a binary file.
const TRIANGLE: usize = 50;

impl TriangleMesh {
    /// Reads a binary or ASCII STL file. Equal corners become one vertex; triangles with two equal
    /// corners are left out. Several solids in one ASCII file become one mesh.
    ///
    /// STL holds numbers of 24 bits. Each is taken as the shortest decimal number that it may
    /// stand for, so that a wall drawn at 0.68 m is at 0.68 m and not at 0.680000007 m.
    pub fn read_stl(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path)
            .map_err(|source| MeshError::Read { path: path.to_owned(), source })?;
        Self::from_stl(&bytes).map_err(|error| match error {
            MeshError::Format { reason, .. } => MeshError::Format { path: path.to_owned(), reason },
            other => other,
        })
    }

    /// Reads the contents of a binary or ASCII STL file, as [`read_stl`](Self::read_stl) does.
    /// The path in errors is empty.
    pub fn from_stl(bytes: &[u8]) -> Result<Self, MeshError> {
        let format = |reason: String| MeshError::Format { path: "".into(), reason };
        let prepared = if is_ascii(bytes) { prepare_ascii(bytes) } else { prepare_binary(bytes) };
        let mut cursor = Cursor::new(prepared.map_err(format)?);
        let reader = stl_io::create_stl_reader(&mut cursor).map_err(|e| format(e.to_string()))?;
        let mut corners = Vec::new();
        for (index, triangle) in reader.enumerate() {
            let triangle = triangle.map_err(|e| format(format!("triangle {index}: {e}")))?;
            let triangle = triangle.vertices.map(|vertex| vertex.0.map(shortest_decimal));
            if !triangle.iter().all(crate::vector::is_finite) {
                return Err(format(format!("triangle {index} has a corner that is not finite")));
            }
            corners.push(triangle);
        }
        Self::from_corners(corners)
    }

    /// The contents of a binary STL file. Coordinates are rounded to 24 bits.
    pub fn to_stl(&self) -> Result<Vec<u8>, MeshError> {
        self.validate()?;
        let triangles = (0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle);
            let normal = cross(&sub(&b, &a), &sub(&c, &a));
            let length = norm(&normal);
            let unit = if length > 0.0 { scaled(1.0 / length, &normal) } else { [0.0; 3] };
            stl_io::Triangle {
                normal: stl_io::Normal::new(unit.map(|x| x as f32)),
                vertices: [a, b, c].map(|x| stl_io::Vertex::new(x.map(|x| x as f32))),
            }
        });
        let mut bytes = Vec::with_capacity(HEAD + TRIANGLE * self.triangles.len());
        stl_io::write_stl(&mut bytes, triangles)
            .map_err(|source| MeshError::Write { path: "".into(), source })?;
        Ok(bytes)
    }

    /// Writes a binary STL file: first under a temporary name, so that a file under the final name
    /// is always whole.
    pub fn write_stl(&self, path: impl AsRef<Path>) -> Result<(), MeshError> {
        let path = path.as_ref();
        let bytes = self.to_stl()?;
        let mut temporary = path.as_os_str().to_owned();
        temporary.push(".tmp");
        std::fs::write(&temporary, bytes)
            .and_then(|()| std::fs::rename(&temporary, path))
            .map_err(|source| MeshError::Write { path: path.to_owned(), source })
    }
}

/// Many binary files start with "solid" too: their length tells them apart.
fn is_ascii(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let solid = start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid");
    solid && binary_length(bytes) != Some(bytes.len())
}

/// The length that a binary file should have.
fn binary_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEAD - 4..HEAD)?.try_into().ok().map(u32::from_le_bytes)?;
    TRIANGLE.checked_mul(count as usize)?.checked_add(HEAD)
}

/// Clears the header, which the reader would take for ASCII if it starts with "solid".
fn prepare_binary(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let have = bytes.len();
    match binary_length(bytes) {
        None => Err(format!("it has only {have} bytes and does not start with \"solid\"")),
        Some(needed) if needed > have => {
            let count = (needed - HEAD) / TRIANGLE;
            Err(format!("it promises {count} triangles in {needed} bytes but has {have} bytes"))
        }
        Some(_) => {
            let mut bytes = bytes.to_vec();
            bytes[..HEAD - 4].fill(0);
            Ok(bytes)
        }
    }
}

/// One solid in lower case with a name, which is all that the reader takes.
fn prepare_ascii(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let text = String::from_utf8_lossy(bytes).to_ascii_lowercase();
    let mut one = String::with_capacity(text.len());
    one.push_str("solid mesh\n");
    let mut open = false;
    for (index, line) in text.lines().enumerate() {
        match line.split_whitespace().next() {
            Some("solid") if open => {
                return Err(format!("line {}: a solid starts inside a solid", index + 1));
            }
            Some("solid") => open = true,
            Some("endsolid") if open => open = false,
            Some(_) if !open => {
                return Err(format!("line {}: text between solids", index + 1));
            }
            _ => {
                one.push_str(line);
                one.push('\n');
            }
        }
    }
    if open {
        return Err("it ends before \"endsolid\"".into());
    }
    one.push_str("endsolid mesh\n");
    Ok(one.into_bytes())
}

fn shortest_decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ascii(mesh: &TriangleMesh, upper: bool) -> String {
        let mut text = String::from("solid\n");
        for triangle in 0..mesh.triangles.len() {
            text.push_str(" facet normal 0 0 0\n  outer loop\n");
            for [x, y, z] in mesh.corners(triangle) {
                text.push_str(&format!("   vertex {x:e} {y} {z}\n"));
            }
            text.push_str("  endloop\n endfacet\n");
        }
        text.push_str("endsolid\n");
        if upper { text.to_uppercase() } else { text }
    }

    fn reason(bytes: &[u8]) -> String {
        match TriangleMesh::from_stl(bytes) {
            Err(MeshError::Format { reason, .. }) => reason,
            other => panic!("{other:?}"),
        }
    }

    proptest! {
        #[test]
        fn numbers_of_few_digits_survive(
            min in prop::array::uniform3(-9999..9999i32),
            size in prop::array::uniform3(1..9999i32),
        ) {
            // Up to six digits: what people type.
            let place = |i: i32| f64::from(i) / 1000.0;
            let max = [0, 1, 2].map(|k| place(min[k] + size[k]));
            let mesh = TriangleMesh::cuboid(min.map(place), max);
            let binary = TriangleMesh::from_stl(&mesh.to_stl().unwrap()).unwrap();
            prop_assert_eq!(binary.bounding_box(), mesh.bounding_box());
            prop_assert_eq!((binary.vertices.len(), binary.triangles.len()), (8, 12));
            for upper in [false, true] {
                let text = ascii(&mesh, upper);
                prop_assert_eq!(&TriangleMesh::from_stl(text.as_bytes()).unwrap(), &binary);
            }
        }

        #[test]
        fn any_bytes_are_an_error_and_not_a_panic(
            mut bytes in prop::collection::vec(any::<u8>(), 0..300),
            solid in any::<bool>(),
        ) {
            if solid {
                bytes.splice(0..0, *b"solid ");
            }
            if let Ok(mesh) = TriangleMesh::from_stl(&bytes) {
                prop_assert!(mesh.vertices.iter().all(crate::vector::is_finite));
            }
        }
    }

    #[test]
    fn a_binary_file_may_start_with_solid() {
        let mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        let mut bytes = mesh.to_stl().unwrap();
        bytes[..11].copy_from_slice(b"solid thing");
        assert_eq!(TriangleMesh::from_stl(&bytes).unwrap().triangles.len(), 12);
    }

    #[test]
    fn several_solids_become_one_mesh() {
        let one = ascii(&TriangleMesh::cuboid([0.0; 3], [1.0; 3]), false);
        let two = ascii(&TriangleMesh::cuboid([3.0; 3], [4.0; 3]), false);
        let mesh = TriangleMesh::from_stl((one + &two).as_bytes()).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (16, 24));
    }

    #[test]
    fn broken_files_say_what_is_wrong() {
        let mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        let binary = mesh.to_stl().unwrap();
        assert!(reason(&binary[..300]).contains("12 triangles in 684 bytes but has 300"));
        assert!(reason(b"").contains("only 0 bytes"));
        assert!(reason(b"# a text file\n").contains("does not start with \"solid\""));
        let text = ascii(&mesh, false);
        assert!(
            reason(text.trim_end().trim_end_matches("endsolid").as_bytes()).contains("endsolid")
        );
        assert!(reason(text.replace("vertex 0", "vertex O").as_bytes()).contains("triangle 0"));
        assert!(reason((text.clone() + "more").as_bytes()).contains("between solids"));
        let mut infinite = binary;
        infinite[96..100].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert!(reason(&infinite).contains("not finite"));
    }

    #[test]
    fn files_are_read_and_written_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("box.stl");
        let mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        mesh.write_stl(&path).unwrap();
        assert_eq!(TriangleMesh::read_stl(&path).unwrap().triangles.len(), 12);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        let missing = TriangleMesh::read_stl(folder.path().join("tank.stl")).unwrap_err();
        assert!(missing.to_string().contains("tank.stl"), "{missing}");
        let nowhere = mesh.write_stl(folder.path().join("no/box.stl")).unwrap_err();
        assert!(matches!(nowhere, MeshError::Write { .. }));
    }

    #[test]
    fn empty_solids_read_as_empty_meshes() {
        let mesh = TriangleMesh::from_stl(b"solid nothing\nendsolid nothing\n").unwrap();
        assert!(mesh.triangles.is_empty());
    }
}
