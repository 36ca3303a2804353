use super::{Pair, PairTerm, Pressure, Source, Target};
use sph_kernels::Lanes;

/// Pressure force: dv_i/dt = −(1/ρ_i) Σ_j (p_i + p_j) ∇W_ij V_j.
///
/// Source: Colagrossi & Landrini (2003), J. Comput. Phys. 191, eq. 19; the δ-SPH form of Antuono et
/// al. (2010), eq. 3. Antisymmetric in i and j once multiplied by m_i, so momentum is conserved.
#[derive(Debug, Clone, Copy)]
pub struct SymmetricPressure;

impl<const D: usize> PairTerm<D, Pressure> for SymmetricPressure {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, _: &Pair<D, L>) -> L {
        -i.quantity - j.quantity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    #[test]
    fn positive_pressure_pushes_apart() {
        let pair = scalar::pair([-0.1, 0.0], ([0.0; 2], [0.0; 2]), (3.0, 5.0), 0.01, -50.0);
        let a = scalar::rate::<Pressure, _>(&SymmetricPressure, &pair).0;
        assert!((a[0] - 8.0 * 50.0 * 0.01 * (-0.1) / 1000.0).abs() < 1e-15);
        assert_eq!(a[1], 0.0);
    }
}
