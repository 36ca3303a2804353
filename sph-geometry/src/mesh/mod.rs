//! Triangle meshes: surfaces from files.

mod bodies;
mod check;
mod error;
mod import;
mod make;
mod mass;
mod repair;
mod sets;
mod sides;
mod stl;
mod weld;

pub use bodies::{Bodies, bodies};
pub use check::{Defects, MeshReport, check};
pub use error::MeshError;
pub use import::{MeshFile, MeshFormat};
pub use mass::{MassProperties, mass_properties};
pub use repair::{Repaired, Repairs, repaired};

use crate::aabb::Aabb;
use crate::affine::Affine;
use parry3d_f64::math::Vector;

/// A surface made of triangles that share vertices. Seen from outside, the corners of a triangle
/// run counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriangleMesh {
    /// Corners, m.
    pub vertices: Vec<[f64; 3]>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The corners of a triangle.
    ///
    /// # Panics
    /// When the triangle or one of its vertices does not exist.
    pub fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The smallest box around all vertices.
    pub fn bounding_box(&self) -> Aabb<3> {
        Aabb::around(&self.vertices)
    }

    /// The same surface with inside and outside exchanged.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let triangles = self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        Self { vertices: self.vertices.clone(), triangles }
    }

    /// The mesh scaled, rotated and translated; where the map mirrors, triangles are turned so that
    /// the outside stays outside.
    #[must_use]
    pub fn moved(&self, map: &Affine<3>) -> Self {
        let vertices = self.vertices.iter().map(|x| map.apply(x)).collect();
        let moved = Self { vertices, triangles: self.triangles.clone() };
        if map.determinant() < 0.0 { moved.flipped() } else { moved }
    }

    /// The convex hull of all vertices.
    ///
    /// # Errors
    ///
    /// When there are no triangles, or all vertices lie in a plane.
    pub fn convex_hull(&self) -> Result<Self, MeshError> {
        self.validate()?;
        let points: Vec<Vector> = self.vertices.iter().map(|x| Vector::from_array(*x)).collect();
        let (vertices, triangles) = parry3d_f64::transformation::try_convex_hull(&points)
            .map_err(|_| MeshError::NoVolume)?;
        let vertices = vertices.iter().map(Vector::to_array).collect();
        Ok(Self { vertices, triangles })
    }

    /// Finite vertices and indices that exist: what everything else here relies on.
    pub(crate) fn validate(&self) -> Result<(), MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        if let Some(vertex) = self.vertices.iter().position(|x| !crate::vector::is_finite(x)) {
            return Err(MeshError::NotFinite { vertex, value: self.vertices[vertex] });
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= self.vertices.len()) {
                let vertices = self.vertices.len();
                return Err(MeshError::Index { triangle, index, vertices });
            }
        }
        Ok(())
    }
}

/// Two triangles have the same corner twice: they have collapsed and bound nothing.
pub(crate) fn is_collapsed(&[a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}
