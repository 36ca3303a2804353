//! Meshes from files, told apart by what is in them and not by their names.

mod number;
mod obj;
mod ply;
mod ply_header;
mod sniff;
mod soup;
mod stl_ascii;
mod stl_binary;
mod text;
mod vtk;
mod vtk_claims;

use super::{MeshError, TriangleMesh};
use soup::Soup;
use std::fmt;
use std::path::Path;

/// A kind of mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Binary STL: triangles of 32-bit numbers.
    StlBinary,
    /// ASCII STL.
    StlAscii,
    /// Wavefront OBJ: polygons.
    Obj,
    /// Stanford PLY, ASCII.
    PlyAscii,
    /// Stanford PLY, binary of either byte order.
    PlyBinary,
    /// VTK in its old format, text or binary.
    VtkLegacy,
    /// VTK in XML: `.vtp` and `.vtu`.
    VtkXml,
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::StlBinary => "binary STL",
            Self::StlAscii => "ASCII STL",
            Self::Obj => "OBJ",
            Self::PlyAscii => "ASCII PLY",
            Self::PlyBinary => "binary PLY",
            Self::VtkLegacy => "legacy VTK",
            Self::VtkXml => "VTK XML",
        })
    }
}

/// A mesh and what is to be known about the file that it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The surface: equal corners are one vertex, polygons are cut into triangles.
    pub mesh: TriangleMesh,
    /// What kind of file it was.
    pub format: MeshFormat,
    /// Distance of neighbouring numbers of the file at its largest coordinate, in units of the
    /// file: about 1e-7 of it for numbers of 32 bits.
    pub resolution: f64,
    /// Triangles left out because two of their corners are the same point.
    pub collapsed: usize,
    /// Bytes after the last triangle that the file promises.
    pub surplus: usize,
}

impl MeshFile {
    /// Reads an STL (ASCII or binary), OBJ, PLY (ASCII or binary) or VTK file (polygon data or an
    /// unstructured grid of polygons, legacy or XML). What it is follows from its content. Several bodies in one file become one mesh.
    ///
    /// Numbers of text are read in double precision. Numbers of 32 bits are taken as the shortest
    /// decimal number that they may stand for, so that a wall drawn at 0.68 m is at 0.68 m and not
    /// at 0.680000007 m.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path)
            .map_err(|source| MeshError::Read { path: path.to_owned(), source })?;
        Self::from_bytes(&bytes).map_err(|error| match error {
            MeshError::Format { reason, .. } => MeshError::Format { path: path.to_owned(), reason },
            other => other,
        })
    }

    /// Reads the content of a mesh file, as [`read`](Self::read) does. The path in errors is empty.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, MeshError> {
        let refused = |reason: String| MeshError::Format { path: "".into(), reason };
        let content = sniff::content(bytes).map_err(refused)?;
        let mut soup = Soup::default();
        let surplus = match content.format {
            MeshFormat::StlBinary => stl_binary::read(&content.bytes, &mut soup),
            MeshFormat::StlAscii => stl_ascii::read(&content.bytes, &mut soup).map(|()| 0),
            MeshFormat::Obj => obj::read(&content.bytes, &mut soup).map(|()| 0),
            MeshFormat::PlyAscii | MeshFormat::PlyBinary => ply::read(&content.bytes, &mut soup),
            MeshFormat::VtkLegacy => vtk::read(&content.bytes, false, &mut soup).map(|()| 0),
            MeshFormat::VtkXml => vtk::read(&content.bytes, true, &mut soup).map(|()| 0),
        };
        let surplus = surplus.map_err(refused)?;
        if let Some(count) = soup.too_many() {
            return Err(MeshError::TooLarge { count });
        }
        let (mesh, collapsed, resolution) = soup.finish();
        Ok(Self { mesh, format: content.format, resolution, collapsed, surplus })
    }
}

impl TriangleMesh {
    /// Reads a mesh file, as [`MeshFile::read`] does.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        MeshFile::read(path).map(|file| file.mesh)
    }

    /// Reads the content of a mesh file, as [`MeshFile::from_bytes`] does.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, MeshError> {
        MeshFile::from_bytes(bytes).map(|file| file.mesh)
    }
}

#[cfg(test)]
mod tests;
