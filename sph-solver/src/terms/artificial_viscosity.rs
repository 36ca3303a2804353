use super::{Pair, PairTerm, Pressure, Source, Target, lanes, viscous};
use sph_kernels::Lanes;

/// Artificial viscosity of the inviscid scheme:
/// dv_i/dt += α h c0 (ρ0/ρ_i) Σ_j π_ij ∇W_ij V_j, π_ij = (v_j − v_i)·r_ji / (|r_ij|² + 0.01 h²).
///
/// Source: Antuono, Colagrossi, Marrone & Molteni (2010), eq. 3–5; Marrone et al. (2011), Comput.
/// Methods Appl. Mech. Eng. 200, eq. 3. It acts on approaching and receding pairs alike.
///
/// Between particles of different support radii it is 1 + 40 |R_j − R_i|/R_ij times as strong: sums over
/// neighbours of different sizes have errors in proportion to the pressure, and what these set in motion
/// along a wall nothing else would stop.
#[derive(Debug, Clone, Copy)]
pub struct ArtificialViscosity {
    /// α h c0 ρ0 for the largest smoothing length, kg/(m s).
    pub strength: f64,
    /// 0.01 h² for the largest smoothing length, m²: keeps coincident particles finite.
    pub softening: f64,
}

impl<const D: usize> PairTerm<D, Pressure> for ArtificialViscosity {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        let usual = viscous(self.strength, self.softening, i, j, pair);
        let Some(stretch) = &pair.stretch else { return usual };
        let difference = stretch.difference.max(-stretch.difference) * stretch.inverse;
        usual * difference.mul_add(lanes(OF_SIZES), lanes(1.0))
    }
}

/// What the difference of support radii adds to the strength, times the relative difference.
const OF_SIZES: f64 = 40.0;

/// How many times as strong artificial viscosity is between particles whose spacings grow by `growth`
/// from one to the next.
pub fn strengthened(growth: f64) -> f64 {
    // Pairs are two spacings apart on average.
    1.0 + 2.0 * OF_SIZES * (growth - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    #[test]
    fn it_slows_an_approach() {
        // i moves towards j at +x: the acceleration of i must point back.
        let pair = scalar::pair([-0.1, 0.0], ([2.0, 0.0], [0.0; 2]), (0.0, 0.0), 0.01, -50.0);
        let term = ArtificialViscosity { strength: 1.0, softening: 0.0 };
        let a = scalar::rate::<Pressure, _>(&term, &pair).0;
        let expected = (2.0 * -0.1 / 0.01) * -50.0 * 0.01 / 1000.0 * -0.1;
        assert!((a[0] - expected).abs() < 1e-15 && expected < 0.0);
    }
}
