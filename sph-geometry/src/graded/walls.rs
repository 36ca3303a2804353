//! Wall elements of different sizes.

use super::{CellTree, Refinement, SpacingField};
use crate::aabb::Aabb;
use crate::body_elements::body_elements;
use crate::boundary::Domain;
use crate::lattice::{Lattice, LatticeError};
use crate::shape::Shape;
use crate::solid::Solid;
use crate::wall_elements::{WallElements, wall_elements};

/// Makes the wall elements of solids in the cells of a tree: what [`wall_elements`] makes in those of a
/// lattice. `supports` is the support radius in spacings.
///
/// # Errors
///
/// As [`wall_elements`].
pub fn graded_wall_elements<const D: usize>(
    solids: &[Solid<D>],
    tree: &CellTree<'_, D>,
    supports: f64,
    domain: &Domain<D>,
) -> Result<WallElements<D>, LatticeError> {
    let tree = tree.of_walls(solids, supports);
    let mut all = WallElements::default();
    for (level, lattice) in tree.lattices().iter().enumerate() {
        let edge = lattice.spacing();
        // Cells of a level hold what particles of up to twice its spacing see.
        let seen = supports * (2.0 * edge).min(tree.field().coarsest());
        // A cell is as large as what sees the middle of the one that it is a part of.
        let support = seen + if level > 0 { edge * (D as f64).sqrt() } else { 0.0 };
        let mut part = *domain;
        if level > 0 {
            // Cells of this level, the walls that particles in them see, and what is around these.
            let bounds = tree.field().bounds_of(2.0 * edge).inflated(2.0 * support + 2.0 * edge);
            part.bounds = common(&domain.bounds, &bounds);
        }
        if (0..D).any(|k| part.bounds.min[k] >= part.bounds.max[k]) {
            continue;
        }
        let some = wall_elements(solids, lattice, support, &part)?;
        all.extend_with(&some, |x| tree.cell_at(x).level as usize == level);
    }
    Ok(all)
}

/// Makes the wall elements of one solid that moves: what [`body_elements`] makes in the cells of a lattice,
/// in cells of `spacing` (m) at its surface and larger ones in its depth, up to those of `coarsest` (m).
/// `supports` is the support radius in spacings, and the lattice that of the coarsest.
///
/// # Errors
///
/// As [`body_elements`].
pub fn graded_body_elements<const D: usize>(
    solid: &Solid<D>,
    lattice: &Lattice<D>,
    spacing: f64,
    supports: f64,
) -> Result<WallElements<D>, LatticeError> {
    let target = Shape::custom(solid.clone());
    let fine = Refinement { target, spacing, within: f64::INFINITY, growth: 2.0 };
    let field = SpacingField::new(lattice.spacing(), vec![fine], [None; D]);
    let tree = CellTree::new(lattice, &field)?;
    let tree = tree.of_walls(std::slice::from_ref(solid), supports);
    let mut all = WallElements::default();
    for (level, lattice) in tree.lattices().iter().enumerate() {
        let edge = lattice.spacing();
        let seen = supports * (2.0 * edge).min(field.coarsest());
        let support = seen + if level > 0 { edge * (D as f64).sqrt() } else { 0.0 };
        let some = body_elements(solid, lattice, support)?;
        all.extend_with(&some, |x| tree.cell_at(x).level as usize == level);
    }
    Ok(all)
}

fn common<const D: usize>(a: &Aabb<D>, b: &Aabb<D>) -> Aabb<D> {
    Aabb {
        min: std::array::from_fn(|k| a.min[k].max(b.min[k])),
        max: std::array::from_fn(|k| a.max[k].min(b.max[k])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::FluidSide;

    #[test]
    fn a_body_is_fine_outside_and_coarse_inside() {
        let ball = Shape::sphere([0.1, 0.2], 0.4).unwrap();
        let ball = Solid::new("ball", ball, FluidSide::Outside);
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let graded = graded_body_elements(&ball, &lattice, 0.0125, 3.0).unwrap();
        let plain = body_elements(&ball, &lattice.coarser(0.125), 0.3).unwrap();
        let volume = |elements: &WallElements<2>| elements.volumes.iter().sum::<f64>();
        assert!((volume(&graded) / volume(&plain) - 1.0).abs() < 0.05);
        assert!(2 * graded.positions.len() < plain.positions.len());
    }

    #[test]
    fn a_tank_is_as_thick_and_as_large_as_of_one_size() {
        let tank = Shape::cuboid([0.0; 2], [2.0, 1.0]).unwrap();
        let solids = [Solid::new("tank", tank, FluidSide::Inside)];
        let target = Shape::sphere([1.0, 0.0], 0.05).unwrap();
        let one = Refinement { target, spacing: 0.0125, within: 0.1, growth: 1.1 };
        let field = SpacingField::new(0.05, vec![one], [None; 2]);
        let lattice = Lattice::new([0.0; 2], 0.05).unwrap();
        let tree = CellTree::new(&lattice, &field).unwrap();
        let domain = Domain::new(Aabb::new([-0.5, -0.5], [2.5, 1.5]));
        let graded = graded_wall_elements(&solids, &tree, 3.0, &domain).unwrap();
        let plain = wall_elements(&solids, &lattice, 0.15, &domain).unwrap();
        let (fine, coarse) =
            (graded.volumes.iter().sum::<f64>(), plain.volumes.iter().sum::<f64>());
        assert!((fine / coarse - 1.0).abs() < 0.02, "{fine} {coarse}");
        assert!(graded.positions.len() < 3 * plain.positions.len());
        let below: f64 = (0..graded.positions.len())
            .filter(|&i| (graded.positions[i][0] - 1.0).abs() < 0.05 && graded.depths[i] < 0.025)
            .map(|i| graded.volumes[i])
            .sum();
        assert!((below - 0.1 * 0.025).abs() < 1e-12, "{below}");
    }
}
