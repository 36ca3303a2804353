use super::{BesideWall, Deviation, Target, WallPair, WallPush, WallTerm, dot, lanes};
use sph_kernels::Lanes;

/// Conservation of mass beside a wall at rest: dρ_i/dt = ρ_i v_i·Σ_w ∇W_iw V_w, the sum as [`WallPush`]
/// leaves it, and the share of the support that the wall fills.
///
/// As [`Continuity`](super::Continuity), but a plane sees only the velocity along its normal: what flows
/// along it is neither compressed nor stretched.
#[derive(Debug, Clone, Copy)]
pub struct WallContinuity;

/// The sums of [`WallContinuity`].
#[derive(Debug, Clone, Copy)]
pub struct WallFlux<const D: usize, L> {
    push: WallPush<D, L>,
    filled: L,
}

impl<const D: usize> WallTerm<D, Deviation> for WallContinuity {
    type Total<L: Lanes> = WallFlux<D, L>;

    #[inline(always)]
    fn zero<L: Lanes>() -> WallFlux<D, L> {
        WallFlux { push: WallPush::zero(), filled: L::zero() }
    }

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        _: &Target<D, L>,
        _: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        total: &mut WallFlux<D, L>,
    ) {
        total.push.add(lanes(1.0), L::zero(), pair);
        let metres = pair.unit * lanes(-1.0 / D as f64);
        total.filled = (pair.distance2 * metres).mul_add(pair.weight, total.filled);
    }

    #[inline(always)]
    fn finish<L: Lanes>(
        &self,
        i: &Target<D, L>,
        beside: &BesideWall<D, L>,
        total: &WallFlux<D, L>,
    ) -> [L; 3] {
        [dot(&i.velocity, &total.push.felt(beside.flatness)), L::zero(), total.filled]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    fn rate(velocity: [f64; 2]) -> f64 {
        let pair = scalar::wall([0.03, 0.1], [0.0, 1.0], 0.05, (velocity, 0.0), 0.01, -50.0);
        let rate = scalar::wall_rate::<Deviation, _>(&WallContinuity, &pair, [0.0; 2], 0.0);
        assert!((rate.wall - 0.5 * (0.03 * 0.03 + 0.1 * 0.1) * 50.0 * 0.01).abs() < 1e-15);
        rate.rate
    }

    #[test]
    fn an_approach_compresses_and_a_slide_does_not() {
        assert!((rate([0.0, -2.0]) - 1000.0 * 2.0 * 0.1 * 50.0 * 0.01).abs() < 1e-12);
        assert_eq!(rate([3.0, 0.0]), 0.0);
    }
}
