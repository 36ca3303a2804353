use super::{Deviation, Pair, PairTerm, Source, Target, difference, dot};
use sph_kernels::Lanes;

/// Conservation of mass: dρ_i/dt = ρ_i Σ_j (v_i − v_j)·∇W_ij V_j.
///
/// Source: Antuono, Colagrossi, Marrone & Molteni (2010), Comput. Phys. Commun. 181, eq. 3 (the
/// term without diffusion).
#[derive(Debug, Clone, Copy)]
pub struct Continuity;

impl<const D: usize> PairTerm<D, Deviation> for Continuity {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        dot(&difference(&i.velocity, &j.velocity), &pair.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    #[test]
    fn approaching_neighbours_compress() {
        // i moves towards j, which lies at +x: r_ij = −x, F < 0.
        let pair = scalar::pair([-0.1, 0.0], ([2.0, 0.0], [0.0; 2]), (0.0, 0.0), 0.01, -50.0);
        let rate = scalar::rate::<Deviation, _>(&Continuity, &pair).rate;
        assert!((rate - 1000.0 * 2.0 * (-0.1) * (-50.0) * 0.01).abs() < 1e-12);
    }
}
