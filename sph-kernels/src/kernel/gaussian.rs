//! Gaussian kernel, cut at three smoothing lengths.

use super::{Kernel, constant, of_dimension};
use crate::Lanes;

/// Truncated Gaussian, support 3h: `w = exp(−9q²)` for q < 1, `w'/q = −18 w`.
///
/// The norm counts the truncation: 3^d / (π^(d/2) P_d), where P_d is the part of the full Gaussian
/// within 3h: erf 3, 1 − e⁻⁹, erf 3 − 6 e⁻⁹/√π. At the edge w drops from 1.2e-4 to zero.
///
/// Source: R. A. Gingold and J. J. Monaghan, Mon. Not. R. Astron. Soc. 181 (1977) 375.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Gaussian;

impl Kernel for Gaussian {
    const NAME: &'static str = "gaussian";
    const RADIUS_OVER_H: f64 = 3.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension(NORM, dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let one = constant(1.0);
        L::select_lt(q, one, exp_minus_9(q.min(one)), L::zero())
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        Self::w(q) * constant(-18.0)
    }
}

/// σ_d = 3^d / (π^(d/2) P_d).
const NORM: [f64; 3] = [1.6926061411541502, 2.8651425623364144, 4.850986001888354];

/// `exp(−9q²)` for 0 ≤ q ≤ 1, relative error below 40 ε of the scalar.
///
/// `exp(−9q²) = e^(−9/2) (e^t)¹⁶` with `t = (9/2 − 9q²)/16`, |t| ≤ 0.29, where twelve terms of the
/// power series are exact to double precision.
#[inline(always)]
fn exp_minus_9<L: Lanes>(q: L) -> L {
    const EXP_MINUS_9_HALVES: f64 = 0.011108996538242306;
    let t = (q * q).mul_add(constant(-9.0 / 16.0), constant(4.5 / 16.0));
    // Horner's scheme in the form 1 + t (1 + t/2 (1 + t/3 (…))).
    let mut sum = constant::<L>(1.0);
    for k in (1..=12u32).rev() {
        sum = (t * constant(1.0 / f64::from(k))).mul_add(sum, constant(1.0));
    }
    for _ in 0..4 {
        sum = sum * sum;
    }
    sum * constant(EXP_MINUS_9_HALVES)
}
