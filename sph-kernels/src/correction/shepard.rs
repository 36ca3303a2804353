//! Shepard's correction: interpolation that is exact for constants.

use crate::{Lanes, Real};

/// Sums for the interpolation `f(x_i) = Σ f_j W_ij V_j / Σ W_ij V_j`, exact for constant fields.
///
/// Source: D. Shepard, Proc. 23rd ACM National Conference (1968) 517.
///
/// ```
/// use sph_kernels::{Kernel, ShepardSum, WendlandC2};
///
/// let mut sum = ShepardSum::<f64>::zero();
/// for distance in [0.0, 0.7, 0.9] {
///     let weight = 0.1 * WendlandC2::value::<3, f64>(distance, 2.0);
///     sum.add(21.0, weight);
/// }
/// assert!((sum.value().unwrap() - 21.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ShepardSum<L> {
    weight: L,
    weighted: L,
}

impl<L: Lanes> ShepardSum<L> {
    /// Nothing added yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { weight: L::zero(), weighted: L::zero() }
    }

    /// Adds a neighbour a lane: its field value and `W_ij V_j`.
    #[inline(always)]
    pub fn add(&mut self, field: L, weight: L) {
        self.weight += weight;
        self.weighted = field.mul_add(weight, self.weighted);
    }

    /// `Σ W_ij V_j`: near 1 inside, about half at a plane free surface, 0 without neighbours.
    #[inline(always)]
    pub fn weight(&self) -> f64 {
        self.weight.sum().to_f64()
    }

    /// The interpolated value; nothing if no neighbour carried any weight.
    #[inline(always)]
    pub fn value(&self) -> Option<f64> {
        let weight = self.weight();
        (weight > 0.0).then(|| self.weighted.sum().to_f64() / weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CubicSpline, Kernel};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn constants_are_exact(
            distances in prop::collection::vec(0.0..0.99f64, 1..40), field in -5.0..5.0f64,
        ) {
            let mut sum = ShepardSum::<f64>::zero();
            for q in distances {
                sum.add(field, 0.3 * CubicSpline::w(q));
            }
            prop_assert!((sum.value().unwrap() - field).abs() < 1e-12);
        }
    }

    #[test]
    fn no_neighbor_gives_no_value() {
        let mut sum = ShepardSum::<f32>::zero();
        assert_eq!((sum.weight(), sum.value()), (0.0, None));
        sum.add(3.0, CubicSpline::w(1.5));
        assert_eq!((sum.weight(), sum.value()), (0.0, None));
    }
}
