//! A surface with or without holes as a sheet of some thickness, through parry.

use super::Nearest;
use crate::aabb::Aabb;
use crate::mesh::{MeshError, TriangleMesh, is_collapsed};
use crate::vector::{axis, norm, scaled, sub};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;

/// All points closer to a surface than half a thickness: material on both sides of it, so that it needs
/// neither be closed nor know its outside.
pub struct Sheet {
    mesh: TriMesh,
    /// Half the thickness, m.
    half: f64,
    aabb: Aabb<3>,
}

impl std::fmt::Debug for Sheet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (count, thickness) = (self.mesh.num_triangles(), 2.0 * self.half);
        write!(f, "sheet of {count} triangles and {thickness} m in {:?}", self.aabb)
    }
}

impl Sheet {
    pub fn new(mesh: &TriangleMesh, thickness: f64) -> Result<Self, MeshError> {
        mesh.validate()?;
        let half = 0.5 * thickness;
        let aabb = mesh.bounding_box().inflated(half);
        let triangles = mesh.triangles.iter().filter(|t| !is_collapsed(t)).copied().collect();
        let vertices = mesh.vertices.iter().map(|x| Vector::from_array(*x)).collect();
        let mesh = TriMesh::new(vertices, triangles).map_err(|_| MeshError::Empty)?;
        Ok(Self { mesh, half, aabb })
    }

    pub fn thickness(&self) -> f64 {
        2.0 * self.half
    }

    /// The surface with its points moved.
    pub fn mesh(&self, moved: impl Fn([f64; 3]) -> [f64; 3]) -> TriangleMesh {
        TriangleMesh {
            vertices: self.mesh.vertices().iter().map(|x| moved(x.to_array())).collect(),
            triangles: self.mesh.indices().to_vec(),
        }
    }

    pub fn signed_distance(&self, x: &[f64; 3]) -> f64 {
        self.nearest(x).distance
    }

    pub fn nearest(&self, x: &[f64; 3]) -> Nearest<3> {
        let (projection, (triangle, _)) =
            self.mesh.project_local_point_and_get_location(Vector::from_array(*x), false);
        let offset = sub(x, &projection.point.to_array());
        let length = norm(&offset);
        // In the middle of the sheet the offset is rounding and has no direction.
        let normal = if length > 1e-12 * self.half {
            scaled(1.0 / length, &offset)
        } else {
            let face = self.mesh.triangle(triangle).normal();
            face.map_or_else(|| axis(0, true), |normal| normal.to_array())
        };
        Nearest { distance: length - self.half, normal }
    }

    pub fn bounding_box(&self) -> Aabb<3> {
        self.aabb
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Shape, ShapeError};
    use super::*;
    use crate::affine::Affine;

    #[test]
    fn a_box_without_lid_is_a_vessel() {
        let mut mesh = TriangleMesh::cuboid([0.0; 3], [2.0; 3]);
        let top = |t: &[u32; 3]| t.iter().all(|&v| mesh.vertices[v as usize][2] == 2.0);
        let triangles = mesh.triangles.iter().filter(|t| !top(t)).copied().collect();
        mesh.triangles = triangles;
        assert!(Shape::<3>::mesh(&mesh).is_err());
        let vessel = Shape::<3>::sheet(&mesh, 0.2).unwrap();
        for (x, distance) in [
            ([1.0, 1.0, 0.5], 0.4),
            ([1.0, 1.0, 0.0], -0.1),
            ([1.0, 1.0, -0.5], 0.4),
            ([2.05, 1.0, 1.0], -0.05),
            ([1.0, 1.0, 2.0], 0.9),
            ([1.0, 1.0, 9.0], 50.0_f64.sqrt() - 0.1),
        ] {
            assert!((vessel.signed_distance(&x) - distance).abs() < 1e-12, "{x:?}");
        }
        assert_eq!(vessel.normal(&[1.0, 1.0, 0.5]), [0.0, 0.0, 1.0]);
        assert!((norm(&vessel.normal(&[1.0, 1.0, 0.0])) - 1.0).abs() < 1e-12);
        assert_eq!(vessel.bounding_box(), Aabb::new([-0.1; 3], [2.1; 3]));
        let larger = vessel.moved(&Affine::scaling([2.0; 3])).unwrap();
        assert!((larger.signed_distance(&[2.0, 2.0, 1.0]) - 0.8).abs() < 1e-12);
        let stretched = vessel.moved(&Affine::scaling([2.0, 1.0, 1.0]));
        assert!(matches!(stretched, Err(ShapeError::Stretched { .. })));
        assert!(matches!(Shape::<3>::sheet(&mesh, 0.0), Err(ShapeError::Thickness { .. })));
    }
}
