//! Lattice points inside shapes and near their surfaces.

use super::{Lattice, LatticeError, LatticeRuns, ON_SURFACE};
use crate::aabb::Aabb;
use crate::shape::Shape;

/// The lattice points inside a shape. Points on the surface, up to a millionth of the spacing, are
/// not inside.
///
/// Points far from the surface are skipped, so that the work grows with the surface.
pub fn lattice_inside<const D: usize>(
    region: &Shape<D>,
    lattice: &Lattice<D>,
) -> Result<LatticeRuns<D>, LatticeError> {
    let cells = lattice.cells("region", &region.bounding_box())?;
    let margin = ON_SURFACE * lattice.spacing();
    Ok(LatticeRuns::trace(*lattice, cells, |x| region.signed_distance(x) + margin))
}

/// Positions of the lattice points inside a region, x fastest: one particle in the middle of every
/// cell. A box whose sides lie on cell sides, up to a millionth of the spacing, gets exactly as
/// many particles as cells.
pub fn fill_lattice<const D: usize>(
    region: &Shape<D>,
    lattice: &Lattice<D>,
) -> Result<Vec<[f64; D]>, LatticeError> {
    Ok(lattice_inside(region, lattice)?.points().collect())
}

/// A lattice point near a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearSurface<const D: usize> {
    /// Index of the point.
    pub index: [i64; D],
    /// Distance to the surface in m, negative inside.
    pub distance: f64,
}

/// The signed distance at all lattice points closer to the surface of a shape than `reach` (m), in
/// ascending order of their indices, x fastest. Points farther away are skipped, not visited.
pub fn near_surface<const D: usize>(
    shape: &Shape<D>,
    lattice: &Lattice<D>,
    reach: f64,
) -> Result<Vec<NearSurface<D>>, LatticeError> {
    near_surface_within(shape, lattice, reach, &Aabb::EVERYWHERE)
}

/// The same for the points in a box.
pub fn near_surface_within<const D: usize>(
    shape: &Shape<D>,
    lattice: &Lattice<D>,
    reach: f64,
    bounds: &Aabb<D>,
) -> Result<Vec<NearSurface<D>>, LatticeError> {
    if !reach.is_finite() || reach <= 0.0 {
        return Err(LatticeError::Support { support: reach });
    }
    let around = shape.bounding_box().inflated(reach).intersection(bounds);
    let cells = lattice.cells("shape", &around)?;
    let runs = LatticeRuns::trace(*lattice, cells, |x| shape.signed_distance(x).abs() - reach);
    let measured = |index| {
        let distance = shape.signed_distance(&lattice.point(&index));
        NearSurface { index, distance }
    };
    Ok(runs.indices().map(measured).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn boxes_get_one_particle_per_cell(
            first in prop::array::uniform3(-400..400i32),
            size in prop::array::uniform3(1..12i32),
            spacing in 1e-3..2.0,
            origin in prop::array::uniform3(-5.0..5.0),
        ) {
            // Corners as a user would compute them, with rounding of their own.
            let corner = |i: [i32; 3]| [0, 1, 2].map(|k| f64::from(i[k]) * spacing + origin[k]);
            let (min, max) = (corner(first), corner([0, 1, 2].map(|k| first[k] + size[k])));
            let lattice = Lattice::new(origin, spacing).unwrap();
            let expected: i32 = size.iter().product();
            let cuboid = fill_lattice(&Shape::cuboid(min, max).unwrap(), &lattice).unwrap();
            prop_assert_eq!(cuboid.len(), expected as usize);
            prop_assert_eq!(cuboid[0], lattice.point(&first.map(i64::from)));
            let mesh = Shape::mesh(&TriangleMesh::cuboid(min, max)).unwrap();
            prop_assert_eq!(fill_lattice(&mesh, &lattice).unwrap(), cuboid);
        }

        #[test]
        fn points_on_the_surface_are_not_inside(cells in 1..20i32, spacing in 1e-3..2.0) {
            // Sides run through the middle of cells.
            let side = (f64::from(cells) + 0.5) * spacing;
            let lattice = Lattice::new([0.0; 2], spacing).unwrap();
            let region = Shape::cuboid([0.0; 2], [side; 2]).unwrap();
            let count = fill_lattice(&region, &lattice).unwrap().len();
            prop_assert_eq!(count, (cells * cells) as usize);
        }

        #[test]
        fn near_points_agree_with_brute_force(
            center in prop::array::uniform2(-1.0..1.0),
            radius in 0.05..1.0,
            reach in 0.01..0.5,
        ) {
            let lattice = Lattice::new([0.03, 0.07], 0.11).unwrap();
            let shape = Shape::sphere(center, radius).unwrap();
            let found = near_surface(&shape, &lattice, reach).unwrap();
            let mut expected = Vec::new();
            for index in (-30..30).flat_map(|y| (-30..30).map(move |x| [x, y])) {
                let distance = shape.signed_distance(&lattice.point(&index));
                if distance.abs() < reach {
                    expected.push(NearSurface { index, distance });
                }
            }
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn the_order_is_x_fastest() {
        let lattice = Lattice::new([0.0; 2], 1.0).unwrap();
        let region = Shape::cuboid([0.0; 2], [2.0, 2.0]).unwrap();
        let points = fill_lattice(&region, &lattice).unwrap();
        assert_eq!(points, [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [1.5, 1.5]]);
    }

    #[test]
    fn endless_regions_are_refused() {
        let lattice = Lattice::new([0.0; 2], 1.0).unwrap();
        let region = Shape::half_space([0.0; 2], [0.0, 1.0]).unwrap();
        let error = fill_lattice(&region, &lattice).unwrap_err();
        assert!(error.to_string().contains("along x"), "{error}");
        assert!(near_surface(&region, &lattice, f64::NAN).is_err());
    }
}
