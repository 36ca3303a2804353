//! Binary STL out.

use super::{MeshError, TriangleMesh};
use crate::vector::{cross, norm, scaled, sub};
use std::path::Path;

impl TriangleMesh {
    /// The contents of a binary STL file. Coordinates are rounded to 24 bits.
    pub fn to_stl(&self) -> Result<Vec<u8>, MeshError> {
        self.validate()?;
        let count = self.triangles.len();
        let promised = u32::try_from(count).map_err(|_| MeshError::TooLarge { count })?;
        let mut bytes = vec![0; 80];
        bytes.reserve(4 + 50 * count);
        bytes.extend(promised.to_le_bytes());
        for triangle in 0..count {
            let [a, b, c] = self.corners(triangle);
            let normal = cross(&sub(&b, &a), &sub(&c, &a));
            let length = norm(&normal);
            let unit = if length > 0.0 { scaled(1.0 / length, &normal) } else { [0.0; 3] };
            for x in [unit, a, b, c].into_iter().flatten() {
                bytes.extend((x as f32).to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_and_written_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("box.stl");
        let mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        mesh.write_stl(&path).unwrap();
        assert_eq!(TriangleMesh::read(&path).unwrap().triangles.len(), 12);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        let missing = TriangleMesh::read(folder.path().join("tank.stl")).unwrap_err();
        assert!(missing.to_string().contains("tank.stl"), "{missing}");
        let nowhere = mesh.write_stl(folder.path().join("no/box.stl")).unwrap_err();
        assert!(matches!(nowhere, MeshError::Write { .. }));
    }
}
