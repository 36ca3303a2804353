use super::{Deviation, Pair, PairTerm, Source, Target, difference, dot, lanes};
use sph_kernels::Lanes;

/// Conservation of mass with the density diffusion of δ-SPH, in a form that leaves a hydrostatic
/// column alone:
/// dρ_i/dt = ρ_i Σ_j (v_i − v_j)·∇W_ij V_j + δ h c0 · 2 Σ_j Ψ_ij (r_ji·∇W_ij)/|r_ij|² V_j with
/// Ψ_ij = (ρ_j − ρ_i) − (ρ0/c0²) g·r_ji, r_ji = x_j − x_i.
///
/// Source: Antuono, Colagrossi, Marrone & Molteni (2010), Comput. Phys. Commun. 181, eq. 3–4;
/// Ψ of Fourtakas, Dominguez, Vacondio & Rogers (2019), Comput. Fluids 190, eq. 13–15, with the
/// hydrostatic density difference of the linear equation of state; for the Tait equation that
/// difference is exact to first order in the Mach number squared.
///
/// Because ∇W_ij = F r_ij, the quotient is −F and no division is left. The hydrostatic part is
/// linear in r_ij like the flux of mass, so it enters as a shift of the target's velocity, which
/// costs nothing per pair: one term does both.
#[derive(Debug, Clone, Copy)]
pub struct DeltaContinuity<const D: usize> {
    /// δ h c0 for the largest smoothing length, m²/s.
    pub strength: f64,
    /// (ρ0/c0²) g, kg/m⁴.
    pub hydrostatic_gradient: [f64; D],
}

impl<const D: usize> PairTerm<D, Deviation> for DeltaContinuity<D> {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        // Per target: −2 δ h c0 / ρ_i times Ψ, whose hydrostatic part is +G·r_ij.
        let strength = pair.stretched(lanes::<L>(-2.0 * self.strength) * i.inverse_density);
        let gradient: [L; D] = self.hydrostatic_gradient.map(lanes);
        let shifted = std::array::from_fn(|k| strength.mul_add(gradient[k], i.velocity[k]));
        let flux = dot(&difference(&shifted, &j.velocity), &pair.offset);
        (strength * pair.per_unit).mul_add(j.quantity - i.quantity, flux)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{Continuity, scalar};

    const C0: f64 = 20.0;

    fn term() -> DeltaContinuity<2> {
        DeltaContinuity {
            strength: 0.1 * 0.05 * C0,
            hydrostatic_gradient: [0.0, -9.81 * 1000.0 / (C0 * C0)],
        }
    }

    fn rate(v: ([f64; 2], [f64; 2]), q: (f64, f64), r_ij: [f64; 2]) -> f64 {
        scalar::rate::<Deviation, _>(&term(), &scalar::pair(r_ij, v, q, 0.01, -50.0)).rate
    }

    const REST: ([f64; 2], [f64; 2]) = ([0.0; 2], [0.0; 2]);

    #[test]
    fn a_tank_at_rest_feels_nothing() {
        // j lies 0.1 m below i and is denser by ρ0 g 0.1 / c0².
        let hydrostatic = 1000.0 * 9.81 * 0.1 / (C0 * C0);
        assert!(rate(REST, (0.0, hydrostatic), [0.0, 0.1]).abs() < 1e-12);
    }

    #[test]
    fn a_denser_neighbour_raises_the_density() {
        // δ h c0 · 2 · Ψ · (−F) V with Ψ = 1.
        let expected = 0.1 * 0.05 * C0 * 2.0 * 50.0 * 0.01;
        assert!((rate(REST, (0.0, 1.0), [0.1, 0.0]) - expected).abs() < 1e-12);
    }

    #[test]
    fn without_differences_of_density_it_is_the_continuity_equation() {
        let (v, r_ij) = (([2.0, 0.3], [-1.0, 0.5]), [-0.1, 0.04]);
        let hydrostatic = 1000.0 * 9.81 * 0.04 / (C0 * C0);
        let pair = scalar::pair(r_ij, v, (0.0, hydrostatic), 0.01, -50.0);
        let plain = scalar::rate::<Deviation, _>(&Continuity, &pair).rate;
        assert!((rate(v, (0.0, hydrostatic), r_ij) - plain).abs() < 1e-11 * plain.abs());
    }
}
