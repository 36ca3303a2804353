//! The inside of a closed triangle mesh, through parry.
//!
//! The nearest point comes from parry's bounding volume hierarchy. The sign comes from the
//! pseudo-normal there: that of the face, the sum over the two faces of an edge, or the sum over
//! the faces of a vertex weighted by their angles. It is right everywhere for closed, consistently
//! oriented surfaces (J. A. Bærentzen, H. Aanæs, Signed distance computation using the angle
//! weighted pseudonormal, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243–253,
//! doi:10.1109/TVCG.2005.49).

use super::Nearest;
use crate::aabb::Aabb;
use crate::mesh::{MeshError, TriangleMesh, is_collapsed};
use crate::vector::{axis, scaled, sub};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

pub struct MeshSurface {
    mesh: TriMesh,
    aabb: Aabb<3>,
}

impl std::fmt::Debug for MeshSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "mesh of {} triangles in {:?}", self.mesh.num_triangles(), self.aabb)
    }
}

impl MeshSurface {
    /// A closed, consistently oriented surface, with inside and outside exchanged if `turned`. Shells in
    /// it must not meet, nor share vertices.
    pub fn closed(mesh: &TriangleMesh, turned: bool, aabb: Aabb<3>) -> Result<Self, MeshError> {
        let triangles = mesh
            .triangles
            .iter()
            .filter(|triangle| !is_collapsed(triangle))
            .map(|&[a, b, c]| if turned { [a, c, b] } else { [a, b, c] })
            .collect();
        let vertices = mesh.vertices.iter().map(|x| Vector::from_array(*x)).collect();
        let mesh = TriMesh::with_flags(vertices, triangles, TriMeshFlags::ORIENTED)
            .map_err(|_| MeshError::Empty)?;
        Ok(Self { mesh, aabb })
    }

    /// The surface with its points moved.
    pub fn mesh(&self, moved: impl Fn([f64; 3]) -> [f64; 3]) -> TriangleMesh {
        TriangleMesh {
            vertices: self.mesh.vertices().iter().map(|x| moved(x.to_array())).collect(),
            triangles: self.mesh.indices().to_vec(),
        }
    }

    /// The nearest point of the surface, whether `x` is inside, and the triangle.
    fn project(&self, x: &[f64; 3]) -> ([f64; 3], bool, u32) {
        let (projection, (triangle, _)) =
            self.mesh.project_local_point_and_get_location(Vector::from_array(*x), false);
        let inside = projection.is_inside && self.aabb.contains(x);
        (projection.point.to_array(), inside, triangle)
    }

    pub fn signed_distance(&self, x: &[f64; 3]) -> f64 {
        let (point, inside, _) = self.project(x);
        let distance = crate::vector::distance(x, &point);
        if inside { -distance } else { distance }
    }

    pub fn nearest(&self, x: &[f64; 3]) -> Nearest<3> {
        let (point, inside, triangle) = self.project(x);
        let offset = sub(x, &point);
        let length = crate::vector::norm(&offset);
        let distance = if inside { -length } else { length };
        // On the surface the offset is rounding and has no direction.
        let scale = self.aabb.max.iter().chain(&self.aabb.min).fold(0.0_f64, |s, x| s.max(x.abs()));
        let normal = if length > 1e-12 * scale {
            scaled(1.0 / distance, &offset)
        } else {
            let face = self.mesh.triangle(triangle).normal();
            face.map_or_else(|| axis(0, true), |normal| normal.to_array())
        };
        Nearest { distance, normal }
    }

    pub fn bounding_box(&self) -> Aabb<3> {
        self.aabb
    }
}
