use super::{Deviation, Target, WallPair, WallTerm, dot};
use sph_kernels::Lanes;

/// Conservation of mass beside a wall at rest: dρ_i/dt = ρ_i Σ_w (n·v_i) (n·∇W_iw) V_w.
///
/// As [`Continuity`](super::Continuity), but a frictionless wall sees only the velocity along its
/// normal n: what flows along it is neither compressed nor stretched.
#[derive(Debug, Clone, Copy)]
pub struct WallContinuity;

impl<const D: usize> WallTerm<D, Deviation> for WallContinuity {
    #[inline(always)]
    fn add<L: Lanes>(&self, i: &Target<D, L>, pair: &WallPair<D, L>, sum: &mut L) {
        let push = pair.weight * pair.height;
        *sum = dot(&i.velocity, &pair.normal).mul_add(push, *sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    fn rate(velocity: [f64; 2]) -> f64 {
        let pair = scalar::wall([0.03, 0.1], [0.0, 1.0], 0.05, (velocity, 0.0), 0.01, -50.0);
        scalar::wall_rate::<Deviation, _>(&WallContinuity, &pair)
    }

    #[test]
    fn an_approach_compresses_and_a_slide_does_not() {
        assert!((rate([0.0, -2.0]) - 1000.0 * 2.0 * 0.1 * 50.0 * 0.01).abs() < 1e-12);
        assert_eq!(rate([3.0, 0.0]), 0.0);
    }
}
