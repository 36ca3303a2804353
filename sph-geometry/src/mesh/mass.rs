//! Mass, centre and inertia of a solid bounded by a mesh.

use super::{MeshError, TriangleMesh, bodies};
use crate::vector::sub;
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::math::Vector;

/// Mass properties of a rigid solid of uniform density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Volume, m³.
    pub volume: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub center: Vector3<f64>,
    /// Inertia tensor about the centre of mass in the axes of the mesh, kg m².
    pub inertia: Matrix3<f64>,
}

/// Mass properties of what a closed mesh encloses. `density` in kg/m³.
///
/// The inertia is the sum over the tetrahedra between the centre and each triangle. What is a body and
/// what a cavity is as [`bodies`] says; where bodies overlap, each counts. Fails as
/// [`MeshReport::error`](super::MeshReport::error) says.
pub fn mass_properties(mesh: &TriangleMesh, density: f64) -> Result<MassProperties, MeshError> {
    let found = bodies(mesh)?;
    let mut all = TriangleMesh::default();
    for surface in &found.surfaces {
        all.append(surface, false)?;
    }
    // Relative to the box of the mesh, so that the distance from the origin costs no digits.
    let origin = all.bounding_box().min;
    let local = |x: &[f64; 3]| Vector::from_array(sub(x, &origin));
    let vertices: Vec<Vector> = all.vertices.iter().map(local).collect();
    let parry = parry3d_f64::mass_properties::MassProperties::from_trimesh(
        density,
        &vertices,
        &all.triangles,
    );
    let inertia = parry.reconstruct_inertia_matrix();
    let volume = found.volume;
    Ok(MassProperties {
        volume,
        mass: density * volume,
        center: Vector3::from(parry.local_com.to_array()) + Vector3::from(origin),
        inertia: Matrix3::from_fn(|row, column| inertia.col(column)[row]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_far_from_the_origin() {
        let size = [2.0, 3.0, 5.0];
        let min = [100.0, -70.0, 40.0];
        let mesh = TriangleMesh::cuboid(min, [0, 1, 2].map(|k| min[k] + size[k]));
        for mesh in [mesh.clone(), mesh.flipped()] {
            let found = mass_properties(&mesh, 10.0).unwrap();
            assert!((found.mass - 300.0).abs() < 1e-9);
            assert!((found.center - Vector3::new(101.0, -68.5, 42.5)).norm() < 1e-9);
            let square = Vector3::from(size).map(|a| a * a);
            let exact =
                (Matrix3::identity() * square.sum() - Matrix3::from_diagonal(&square)) * 25.0;
            assert!((found.inertia - exact).norm() < 1e-9 * exact.norm());
        }
    }

    #[test]
    fn a_hollow_counts_as_a_hollow() {
        let mut mesh = TriangleMesh::cuboid([0.0; 3], [4.0; 3]);
        let hollow = TriangleMesh::cuboid([1.0; 3], [2.0; 3]).flipped();
        mesh.vertices.extend(&hollow.vertices);
        mesh.triangles.extend(hollow.triangles.iter().map(|t| t.map(|vertex| vertex + 8)));
        let found = mass_properties(&mesh, 1.0).unwrap();
        assert!((found.volume - 63.0).abs() < 1e-12);
        let center = (64.0 * 2.0 - 1.5) / 63.0;
        assert!((found.center - Vector3::repeat(center)).norm() < 1e-12);
    }

    #[test]
    fn bodies_inside_out_beside_others_have_their_mass() {
        let mut mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        mesh.append(&TriangleMesh::cuboid([3.0, 0.0, 0.0], [4.0, 1.0, 1.0]), true).unwrap();
        let found = mass_properties(&mesh, 2.0).unwrap();
        assert!((found.mass - 4.0).abs() < 1e-12);
        assert!((found.center - Vector3::new(2.0, 0.5, 0.5)).norm() < 1e-12);
        // Two cubes of mass 2 that are 1.5 away from the centre: 2 · (1/3 + 4.5). Two equal principal
        // moments cost half of the digits.
        assert!((found.inertia[(1, 1)] - (2.0 / 3.0 + 9.0)).abs() < 1e-6, "{}", found.inertia);
    }

    #[test]
    fn an_open_mesh_has_no_mass() {
        let mut mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        mesh.triangles.pop();
        assert!(matches!(mass_properties(&mesh, 1.0), Err(MeshError::Open { .. })));
    }
}
