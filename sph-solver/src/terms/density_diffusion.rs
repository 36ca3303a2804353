use super::{Deviation, Pair, PairTerm, Source, Sum, Target, dot, lanes};
use sph_kernels::Lanes;

/// Density diffusion that leaves a hydrostatic column alone:
/// dρ_i/dt += δ h c0 · 2 Σ_j Ψ_ij (r_ji·∇W_ij)/|r_ij|² V_j with
/// Ψ_ij = (ρ_j − ρ_i) − (ρ0/c0²) g·r_ji, r_ji = x_j − x_i.
///
/// Source: Fourtakas, Dominguez, Vacondio & Rogers (2019), Comput. Fluids 190, eq. 13–15, with the
/// hydrostatic density difference of the linear equation of state; for the Tait equation that
/// difference is exact to first order in the Mach number squared. Because ∇W_ij = F r_ij, the
/// quotient is −F and no division is left.
#[derive(Debug, Clone, Copy)]
pub struct HydrostaticDiffusion<const D: usize> {
    /// δ h c0, m²/s.
    pub strength: f64,
    /// (ρ0/c0²) g, kg/m⁴.
    pub hydrostatic_gradient: [f64; D],
}

impl<const D: usize> PairTerm<D, Deviation> for HydrostaticDiffusion<D> {
    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        j: &Source<D, L>,
        pair: &Pair<D, L>,
        sum: &mut Sum<D, L>,
    ) {
        let gradient: [L; D] = self.hydrostatic_gradient.map(lanes);
        // r_ji = −r_ij, so the hydrostatic part enters with a plus.
        let psi = (j.quantity - i.quantity) + dot(&gradient, &pair.offset);
        let diffusion = psi * pair.slope_volume;
        sum.density = lanes::<L>(-2.0 * self.strength).mul_add(diffusion, sum.density);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    const C0: f64 = 20.0;

    fn rate(q: (f64, f64), r_ij: [f64; 2]) -> f64 {
        let term = HydrostaticDiffusion {
            strength: 0.1 * 0.05 * C0,
            hydrostatic_gradient: [0.0, -9.81 * 1000.0 / (C0 * C0)],
        };
        let (i, j, p) = scalar::pair(r_ij, ([0.0; 2], [0.0; 2]), q, 0.01, -50.0);
        let mut sum = Sum::zero();
        PairTerm::<2, Deviation>::add(&term, &i, &j, &p, &mut sum);
        sum.density
    }

    #[test]
    fn a_tank_at_rest_feels_nothing() {
        // j lies 0.1 m below i and is denser by ρ0 g 0.1 / c0².
        let hydrostatic = 1000.0 * 9.81 * 0.1 / (C0 * C0);
        assert!(rate((0.0, hydrostatic), [0.0, 0.1]).abs() < 1e-9);
    }

    #[test]
    fn a_denser_neighbour_raises_the_density() {
        assert!(rate((0.0, 1.0), [0.1, 0.0]) > 0.0);
    }
}
