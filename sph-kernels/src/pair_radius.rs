//! The support radius of a pair of particles whose own radii differ.

use crate::Lanes;

/// How the radius `R_ij` of a pair follows from the radii of its particles: a zero-sized type.
///
/// A pair interacts when `|r_ij| < R_ij`. When `R_ij = R_ji`, `∇_i W_ij = −∇_j W_ji` and pair
/// forces conserve momentum exactly.
pub trait PairRadius: Copy + Send + Sync + 'static {
    /// Name in files, such as `"mean"`.
    const NAME: &'static str;

    /// Whether `R_ij = R_ji` for all radii.
    const SYMMETRIC: bool;

    /// `R_ij` from `R_i` (`own`) and `R_j` (`neighbor`), in their unit.
    fn of<L: Lanes>(own: L, neighbor: L) -> L;
}

/// `R_ij = (R_i + R_j) / 2`, the usual choice.
///
/// Source: W. Benz, in: The Numerical Modelling of Nonlinear Stellar Pulsations (1990) 269.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeanRadius;

/// `R_ij = max(R_i, R_j)`: each particle sees every particle that sees it by its own radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MaxRadius;

/// `R_ij = R_i`: a particle collects what lies within its own radius. Not symmetric.
///
/// Source: L. Hernquist and N. Katz, Astrophys. J. Suppl. 70 (1989) 419.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GatherRadius;

/// `R_ij = R_j`: a particle is reached by the neighbours whose radius covers it. Not symmetric.
///
/// Source: L. Hernquist and N. Katz, Astrophys. J. Suppl. 70 (1989) 419.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ScatterRadius;

impl PairRadius for MeanRadius {
    const NAME: &'static str = "mean";
    const SYMMETRIC: bool = true;

    #[inline(always)]
    fn of<L: Lanes>(own: L, neighbor: L) -> L {
        (own + neighbor) * L::splat(crate::Real::from_f64(0.5))
    }
}

impl PairRadius for MaxRadius {
    const NAME: &'static str = "max";
    const SYMMETRIC: bool = true;

    #[inline(always)]
    fn of<L: Lanes>(own: L, neighbor: L) -> L {
        own.max(neighbor)
    }
}

impl PairRadius for GatherRadius {
    const NAME: &'static str = "gather";
    const SYMMETRIC: bool = false;

    #[inline(always)]
    fn of<L: Lanes>(own: L, _: L) -> L {
        own
    }
}

impl PairRadius for ScatterRadius {
    const NAME: &'static str = "scatter";
    const SYMMETRIC: bool = false;

    #[inline(always)]
    fn of<L: Lanes>(_: L, neighbor: L) -> L {
        neighbor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kernel, WendlandC2};
    use proptest::prelude::*;

    fn forces_cancel<R: PairRadius>(x: [f64; 3], own: f64, neighbor: f64) -> bool {
        let forward = WendlandC2::gradient(x, R::of(own, neighbor));
        let backward = WendlandC2::gradient(x.map(|x| -x), R::of(neighbor, own));
        forward == backward.map(|g| -g)
    }

    proptest! {
        #[test]
        fn symmetric_radii_conserve_momentum(
            x in prop::array::uniform3(-0.5..0.5f64), own in 0.5..4.0f64, neighbor in 0.5..4.0f64,
        ) {
            prop_assert!(MeanRadius::SYMMETRIC && forces_cancel::<MeanRadius>(x, own, neighbor));
            prop_assert!(MaxRadius::SYMMETRIC && forces_cancel::<MaxRadius>(x, own, neighbor));
        }

        #[test]
        fn gather_and_scatter_are_transposes(own in 0.5..4.0f64, neighbor in 0.5..4.0f64) {
            prop_assert_eq!(GatherRadius::of(own, neighbor), own);
            prop_assert_eq!(ScatterRadius::of(neighbor, own), own);
        }
    }

    #[test]
    fn gather_and_scatter_do_not_conserve_momentum() {
        let x = [0.3, 0.1, -0.2];
        assert!(!GatherRadius::SYMMETRIC && !forces_cancel::<GatherRadius>(x, 1.0, 2.0));
        assert!(!ScatterRadius::SYMMETRIC && !forces_cancel::<ScatterRadius>(x, 1.0, 2.0));
    }
}
