//! Wall elements of a solid that moves: all around it, wherever fluid may meet it later.

use crate::lattice::{Lattice, LatticeError, LatticeRuns, ON_SURFACE};
use crate::solid::{FluidSide, Solid};
use crate::wall_elements::{WallElements, element};

/// Makes the wall elements of one solid: those in cells that lie less than `support` (m) below its
/// surface, whatever is around. The lattice lies as that of the fluid does before the solid moves.
///
/// The order is that of the lattice, x fastest.
///
/// # Errors
///
/// When the surface has no end, as that of a half space, or there are too many cells.
pub fn body_elements<const D: usize>(
    solid: &Solid<D>,
    lattice: &Lattice<D>,
    support: f64,
) -> Result<WallElements<D>, LatticeError> {
    if !support.is_finite() || support <= 0.0 {
        return Err(LatticeError::Support { support });
    }
    let spacing = lattice.spacing();
    let margin = ON_SURFACE * spacing;
    let around = match solid.fluid_side {
        FluidSide::Outside => spacing,
        FluidSide::Inside => support + spacing,
    };
    let cells = lattice.cells("moving solid", &solid.shape.bounding_box().inflated(around))?;
    let half = 0.5 * spacing * (D as f64).sqrt();
    let layer = LatticeRuns::trace(*lattice, cells, |x| {
        let depth = solid.depth_in_solid(x);
        (margin - half - depth).max(depth - support + margin)
    });
    let mut elements = WallElements::default();
    let alone = std::slice::from_ref(solid);
    for index in layer.indices() {
        if let Some((position, share)) = element(alone, &lattice.point(&index), spacing) {
            elements.add(alone, 0, position, share * spacing.powi(D as i32));
        }
    }
    Ok(elements)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aabb::Aabb;
    use crate::boundary::Domain;
    use crate::shape::Shape;
    use crate::wall_elements::wall_elements;

    #[test]
    fn a_body_in_the_open_is_as_a_wall_at_rest() {
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let ball = Shape::sphere([1.0, 0.93], 0.42).unwrap();
        let ball = Solid::new("ball", ball, FluidSide::Outside);
        let domain = Domain::new(Aabb::new([0.0; 2], [2.0; 2]));
        let at_rest = wall_elements(std::slice::from_ref(&ball), &lattice, 0.3, &domain).unwrap();
        assert_eq!(body_elements(&ball, &lattice, 0.3).unwrap(), at_rest);
    }

    #[test]
    fn a_tank_has_its_layer_outside() {
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let tank = Shape::cuboid([0.0; 2], [1.0, 0.6]).unwrap();
        let tank = Solid::new("tank", tank, FluidSide::Inside);
        let elements = body_elements(&tank, &lattice, 0.3).unwrap();
        // Three layers, the corners rounded off.
        let volume: f64 = elements.volumes.iter().sum();
        assert!(volume > 0.32 * 3.0 && volume < 1.6 * 1.2 - 0.6, "{volume}");
        assert!(elements.depths.iter().all(|depth| *depth > 0.0 && *depth < 0.3));
    }

    #[test]
    fn a_half_space_cannot_move() {
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let plane = Shape::half_space([0.0; 2], [0.0, 1.0]).unwrap();
        let plane = Solid::new("floor", plane, FluidSide::Outside);
        let error = body_elements(&plane, &lattice, 0.3).unwrap_err();
        assert!(matches!(error, LatticeError::Unbounded { .. }));
    }
}
