use super::{Pair, PairTerm, Pressure, Source, Target, viscous};
use sph_kernels::Lanes;

/// Physical viscosity: dv_i/dt += (K μ/ρ_i) Σ_j π_ij ∇W_ij V_j, K = 2 (d + 2),
/// π_ij = (v_j − v_i)·r_ji / (|r_ij|² + 0.01 h²).
///
/// Source: Monaghan & Gingold (1983), J. Comput. Phys. 52; the factor K and its consistency with
/// the Laplacian: Colagrossi, Antuono & Le Touzé (2009), Phys. Rev. E 79, eq. 17.
#[derive(Debug, Clone, Copy)]
pub struct LaminarViscosity {
    /// Dynamic viscosity μ, Pa s.
    pub dynamic_viscosity: f64,
    /// 0.01 h², m².
    pub softening: f64,
}

impl<const D: usize> PairTerm<D, Pressure> for LaminarViscosity {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        let strength = 2.0 * (D as f64 + 2.0) * self.dynamic_viscosity;
        viscous(strength, self.softening, i, j, pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;
    use sph_kernels::{Kernel, WendlandC2};

    /// A shear flow v_x = y² on a lattice has Laplacian 2: the term must give ν · 2.
    #[test]
    fn laplacian_of_a_parabola() {
        let (dp, radius) = (0.01, 0.05);
        let norm = WendlandC2::norm(2) / f64::powi(radius, 4);
        let term = LaminarViscosity { dynamic_viscosity: 1.0, softening: 0.0 };
        let mut sum = 0.0;
        let n = (radius / dp) as i32;
        for a in -n..=n {
            for b in -n..=n {
                let (x, y) = (f64::from(a) * dp, f64::from(b) * dp);
                let q = x.hypot(y) / radius;
                if q >= 1.0 || (a, b) == (0, 0) {
                    continue;
                }
                let slope = norm * WendlandC2::slope(q);
                let pair =
                    scalar::pair([-x, -y], ([0.0; 2], [y * y, 0.0]), (0.0, 0.0), dp * dp, slope);
                sum += scalar::rate::<Pressure, _>(&term, &pair).0[0];
            }
        }
        let expected = 2.0 / 1000.0;
        assert!((sum / expected - 1.0).abs() < 0.02, "{sum}");
    }
}
