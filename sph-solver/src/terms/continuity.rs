use super::{Deviation, Pair, PairTerm, Source, Sum, Target, dot};
use sph_kernels::Lanes;

/// Conservation of mass: dρ_i/dt = ρ_i Σ_j (v_i − v_j)·∇W_ij V_j.
///
/// Source: Antuono, Colagrossi, Marrone & Molteni (2010), Comput. Phys. Commun. 181, eq. 3 (the
/// term without diffusion). Wall neighbours take part with the velocity of the wall.
#[derive(Debug, Clone, Copy)]
pub struct Continuity;

impl<const D: usize> PairTerm<D, Deviation> for Continuity {
    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        j: &Source<D, L>,
        pair: &Pair<D, L>,
        sum: &mut Sum<D, L>,
    ) {
        let divergence = dot(&j.approach, &pair.offset) * pair.slope_volume;
        sum.density = i.density.mul_add(divergence, sum.density);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    #[test]
    fn approaching_neighbours_compress() {
        // i moves towards j, which lies at +x: r_ij = −x, F < 0.
        let (i, j, p) = scalar::pair([-0.1, 0.0], ([2.0, 0.0], [0.0; 2]), (0.0, 0.0), 0.01, -50.0);
        let mut sum = Sum::zero();
        PairTerm::<2, Deviation>::add(&Continuity, &i, &j, &p, &mut sum);
        assert!((sum.density - 1000.0 * 2.0 * (-0.1) * (-50.0) * 0.01).abs() < 1e-12);
    }
}
