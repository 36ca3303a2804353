//! What the surroundings of a particle say: whether it has torn off, and whether a wall may hold it.
//!
//! *Spray* is what has torn off from the body of the fluid. While a particle tears off, its departing
//! neighbours leave it with a density below ρ0. Nothing holds a drop under tension, yet without
//! neighbours nothing restores its density either, and the missing part would later let it run deep
//! into a wall or a pool before any pressure arises. Its density is therefore kept at ρ0 or above.
//! Marrone, Colagrossi, Le Touzé & Graziani (2010), J. Comput. Phys. 229, tell such particles by an
//! eigenvalue; here it is the divergence of the positions, which the density sweep has for one
//! multiplication a pair (Lee, Moulinec, Xu, Violeau, Laurence & Stansby 2008, J. Comput. Phys. 227).
//!
//! *Suction*: a wall holds on to fluid that no air can come to, and lets go of fluid at a free surface.

use crate::terms::DensityRate;

/// Fluid fills less than this of the space around spray that is not wall. A flat surface fills one
/// half, a right-angled edge of fluid one quarter.
const SPRAY: f64 = 0.3;

/// Fluid fills more than this of the space around a particle away from the free surface that is not wall.
/// Of that space alone: in a narrow gap between two walls there is little of it, and air in the rest is a
/// free surface all the same.
const INSIDE: f64 = 0.7;

/// Whether a particle has torn off from the body of the fluid.
#[inline]
pub fn is_spray(around: &DensityRate) -> bool {
    around.fluid < SPRAY * (1.0 - around.wall)
}

/// Whether a particle is away from the free surface.
#[inline]
pub fn is_inside(around: &DensityRate) -> bool {
    around.fluid > INSIDE * (1.0 - around.wall)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(fluid: f64, wall: f64) -> DensityRate {
        DensityRate { rate: 0.0, fluid, wall }
    }

    #[test]
    fn surfaces_are_no_spray_and_drops_are() {
        assert!(!is_spray(&around(0.5, 0.0)) && !is_spray(&around(0.25, 0.5)));
        assert!(is_spray(&around(0.1, 0.0)) && is_spray(&around(0.1, 0.5)));
    }

    #[test]
    fn a_wall_holds_what_is_not_at_the_surface() {
        assert!(is_inside(&around(0.5, 0.5)) && is_inside(&around(1.0, 0.0)));
        assert!(!is_inside(&around(0.5, 0.0)) && !is_inside(&around(0.25, 0.5)));
        assert!(!is_inside(&around(0.1, 0.8)));
    }
}
