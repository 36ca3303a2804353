use super::{Pair, PairTerm, Pressure, Source, Target, lanes};
use sph_kernels::Lanes;

/// Physical viscosity: dv_i/dt += (2 μ/ρ_i) Σ_j (v_i − v_j) F_ij V_j, ∇W_ij = F_ij r_ij.
///
/// Source: Morris, Fox & Zhu (1997), J. Comput. Phys. 136, eq. 22, for a fluid of one viscosity. Linear
/// momentum is conserved; angular momentum is up to the viscous stress that the form leaves out. The
/// form of Monaghan & Gingold (1983), which conserves both, took twice the energy of a Taylor–Green
/// vortex that it should.
#[derive(Debug, Clone, Copy)]
pub struct LaminarViscosity {
    /// Dynamic viscosity μ, Pa s.
    pub dynamic_viscosity: f64,
}

impl<const D: usize> PairTerm<D, Pressure> for LaminarViscosity {
    const CENTRAL: bool = false;
    const SHEARS: bool = true;

    #[inline(always)]
    fn coefficient<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, _: &Pair<D, L>) -> L {
        L::zero()
    }

    #[inline(always)]
    fn shear<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, _: &Pair<D, L>) -> L {
        lanes(2.0 * self.dynamic_viscosity)
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
        let term = LaminarViscosity { dynamic_viscosity: 1.0 };
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
