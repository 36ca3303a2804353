//! What can be wrong with a mesh, and the way out.

use super::check::Defects;
use std::path::PathBuf;
use thiserror::Error;

/// Why a mesh cannot be read, written or used as a solid.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be read.
    #[error("cannot read mesh {path}: {source}; check the path and that the file is readable", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The file is no mesh file that can be read, or a broken one.
    #[error("the mesh {path} cannot be read: {reason}; export the surface again as STL, OBJ, PLY or VTK", path = path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The file cannot be written.
    #[error("cannot write mesh {path}: {source}; check that the folder exists and has space", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// Nothing to work with.
    #[error("the mesh has no triangles; export a closed surface, not points or curves")]
    Empty,
    /// A vertex is not a point.
    #[error("vertex {vertex} of the mesh is at {value:?}; coordinates must be finite numbers")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} of the mesh names vertex {index}, but there are only {vertices}")]
    Index {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex that it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// The surface has holes.
    #[error(
        "the mesh is open: {edges} belong to only one triangle; fill the holes in a mesh editor, \
         or give the surface a `thickness` in metres: material on both sides of it"
    )]
    Open {
        /// Edges of the holes.
        edges: Defects,
    },
    /// Surfaces meet in an edge.
    #[error(
        "{edges} of the mesh belong to three or more triangles; remove inner walls, or join the \
         parts that touch there into one surface (boolean union in a mesh editor)"
    )]
    Crowded {
        /// Edges of more than two triangles.
        edges: Defects,
    },
    /// Some triangles are turned over.
    #[error(
        "the mesh is inconsistently oriented: the triangles on both sides of {edges} disagree \
         about which side is outside; recalculate the normals in a mesh editor"
    )]
    Inconsistent {
        /// Edges between triangles that disagree.
        edges: Defects,
    },
    /// A triangle exists twice.
    #[error(
        "{triangles} of the mesh exist more than once; remove duplicate faces in a mesh editor"
    )]
    Duplicate {
        /// Copies of other triangles.
        triangles: Defects,
    },
    /// The surface encloses nothing.
    #[error("the mesh encloses no volume; give the sheet a `thickness` in metres")]
    NoVolume,
    /// Vertices are too many for 32-bit indices.
    #[error("the mesh has {count} vertices; the most is 4294967295, so simplify it")]
    TooLarge {
        /// Number of vertices.
        count: usize,
    },
}
