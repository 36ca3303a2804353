//! `f32` and `f64` as lanes of one.

use super::{Lanes, head, head_mut};

macro_rules! scalar_lanes {
    ($scalar:ty, $wide:ty, $difference:expr) => {
        impl Lanes for $scalar {
            type Scalar = $scalar;
            const LANES: usize = 1;

            #[inline(always)]
            fn splat(x: Self) -> Self {
                x
            }

            #[inline(always)]
            fn zero() -> Self {
                0.0
            }

            // Not the inherent `mul_add`: without FMA in the target it is a library call.
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                self * b + c
            }

            #[inline(always)]
            fn div(self, o: Self) -> Self {
                self / o
            }

            #[cfg(feature = "std")]
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$scalar>::sqrt(self)
            }

            // `core` has no square root, the vector crate does.
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$wide>::splat(self).sqrt().to_array()[0]
            }

            #[inline(always)]
            fn max(self, o: Self) -> Self {
                if self > o { self } else { o }
            }

            #[inline(always)]
            fn min(self, o: Self) -> Self {
                if self < o { self } else { o }
            }

            #[inline(always)]
            fn select_lt(a: Self, b: Self, then: Self, other: Self) -> Self {
                if a < b { then } else { other }
            }

            #[inline(always)]
            fn sum(self) -> Self {
                self
            }

            #[inline(always)]
            fn load(from: &[Self]) -> Self {
                let &[x] = head(from);
                x
            }

            #[inline(always)]
            fn store(self, to: &mut [Self]) {
                *head_mut(to) = [self];
            }

            #[inline(always)]
            fn gather(table: &[[Self; 8]], index: &[u32]) -> [Self; 8] {
                let &[i] = head(index);
                table[i as usize]
            }

            #[inline(always)]
            fn coordinate_difference(a: Self, b: Self) -> Self {
                $difference(a, b)
            }
        }
    };
}

scalar_lanes!(f32, wide::f32x4, |a: f32, b: f32| {
    a.to_bits().wrapping_sub(b.to_bits()) as i32 as f32
});
scalar_lanes!(f64, wide::f64x2, |a: f64, b: f64| a - b);
