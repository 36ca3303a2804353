//! Scalars, and the choice of lanes for the CPU at hand.

use crate::lanes::{Lanes, Vectorized, portable};
use core::fmt::{Debug, Display};
use core::ops::{Div, DivAssign, MulAssign, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// Scalars of pair arithmetic: `f32` and `f64`.
///
/// A scalar is also a [`Lanes`] of one lane, so everything written for lanes works on it.
pub trait Real:
    Lanes<Scalar = Self>
    + PartialOrd
    + Div<Output = Self>
    + SubAssign
    + MulAssign
    + DivAssign
    + Default
    + Debug
    + Display
    + sealed::Sealed
{
    /// Units after which encoded coordinates repeat, see [`encode_coordinate`](Self::encode_coordinate):
    /// 2³² for `f32`, 0 for `f64`, whose coordinates never do.
    const WRAPS_AT: f64;

    /// Rounds to this scalar.
    fn from_f64(x: f64) -> Self;

    /// The same number in double precision.
    fn to_f64(self) -> f64;

    /// Encodes a coordinate for a word of a record, see [`Lanes::coordinate_difference`].
    ///
    /// `f32`: the bits of `x / unit` rounded to a 64-bit integer and wrapped to 32 bits. As long as
    /// two points are closer than 2³¹ units, their difference is exact wherever they are, and the
    /// same for every choice of origin that is a multiple of the unit. `f64`: `x / unit`. Either
    /// way differences come out in units.
    fn encode_coordinate(x: f64, unit: f64) -> Self;

    /// Runs `op` with lanes for this CPU: 8 × `f32` or, with AVX-512, 8 × `f64`; 8 × `f32` or
    /// 4 × `f64` in AVX2 registers where the CPU has AVX2 and FMA; otherwise as
    /// [`dispatch_portable`](Self::dispatch_portable).
    ///
    /// The check costs one load and one branch a call: call it per chunk of particles.
    fn dispatch<O: Vectorized<Scalar = Self>>(op: O) -> O::Output;

    /// Runs `op` with 8 × `f32` or 4 × `f64` in vectors that every CPU of the target has (SSE2, NEON).
    ///
    /// Meant for tests and measurements. Results may differ from those of [`dispatch`] in the last
    /// bits: without FMA, [`Lanes::mul_add`] rounds twice.
    ///
    /// [`dispatch`]: Self::dispatch
    fn dispatch_portable<O: Vectorized<Scalar = Self>>(op: O) -> O::Output;
}

impl Real for f32 {
    const WRAPS_AT: f64 = 4_294_967_296.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as Self
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn encode_coordinate(x: f64, unit: f64) -> Self {
        Self::from_bits(round(x / unit) as u32)
    }

    #[inline]
    fn dispatch<O: Vectorized<Scalar = Self>>(op: O) -> O::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = crate::lanes::avx512::Avx512::detect() {
            return cpu.run_f32(op);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = crate::lanes::avx2::Avx2::detect() {
            return cpu.run_f32(op);
        }
        op.run::<portable::F32x8>()
    }

    #[inline]
    fn dispatch_portable<O: Vectorized<Scalar = Self>>(op: O) -> O::Output {
        op.run::<portable::F32x8>()
    }
}

impl Real for f64 {
    const WRAPS_AT: f64 = 0.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn encode_coordinate(x: f64, unit: f64) -> Self {
        x / unit
    }

    #[inline]
    fn dispatch<O: Vectorized<Scalar = Self>>(op: O) -> O::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = crate::lanes::avx512::Avx512::detect() {
            return cpu.run_f64(op);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = crate::lanes::avx2::Avx2::detect() {
            return cpu.run_f64(op);
        }
        op.run::<portable::F64x4>()
    }

    #[inline]
    fn dispatch_portable<O: Vectorized<Scalar = Self>>(op: O) -> O::Output {
        op.run::<portable::F64x4>()
    }
}

/// Nearest integer, halves away from zero. `f64::round` needs the standard library.
#[inline(always)]
fn round(x: f64) -> i64 {
    let whole = x as i64;
    let rest = x - whole as f64;
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_halves_away_from_zero() {
        for x in [0.0, 0.49999999999999994, 0.5, -0.5, 1.5, 2.5, -2.5, 1e9 + 0.5, -7.4999, 4.4e15] {
            assert_eq!(round(x), x.round() as i64, "{x}");
        }
    }

    #[test]
    fn differences_of_encoded_f32_coordinates_wrap() {
        let unit = 1e-6;
        // Two points beyond the range of i32 units: 3 km and 3 km + 0.25 m.
        let a = f32::encode_coordinate(3000.25, unit);
        let b = f32::encode_coordinate(3000.0, unit);
        assert_eq!(f32::coordinate_difference(a, b), 250_000.0);
        assert_eq!(f32::coordinate_difference(b, a), -250_000.0);
    }

    #[test]
    fn both_scalars_give_differences_in_units() {
        let unit = 0.125;
        let f = |x| f32::encode_coordinate(x, unit);
        let d = |x| f64::encode_coordinate(x, unit);
        assert_eq!(f32::coordinate_difference(f(-1.5), f(2.0)), -28.0);
        assert_eq!(f64::coordinate_difference(d(-1.5), d(2.0)), -28.0);
    }
}
