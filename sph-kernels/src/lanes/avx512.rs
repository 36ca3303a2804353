//! Lanes in AVX-512 registers: eight `f64`; and eight `f32` with the instructions of AVX-512VL, which
//! broadcast from memory while they compute and have twice as many registers.
//!
//! As with [`avx2`](super::avx2), a value of the lane type exists only below [`Avx512::run_f64`],
//! because nobody outside this crate can name it; that needs an [`Avx512`], which exists only after the
//! CPU was found to have AVX-512 F, DQ and VL besides AVX2 and FMA. All `unsafe` of the intrinsics rests
//! on that.

use super::avx2::{Avx2, F32x8, F64x4};
use super::{Lanes, Vectorized, head, head_mut, out_of_range};
use core::arch::x86_64::*;
use core::fmt;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Proof that this CPU has AVX-512 F, DQ and VL, AVX2 and FMA.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(());

impl Avx512 {
    /// Asks the CPU; the standard library remembers the answer.
    #[inline]
    pub fn detect() -> Option<Self> {
        #[cfg(feature = "std")]
        let found = std::is_x86_feature_detected!("avx512f")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("avx512vl");
        #[cfg(not(feature = "std"))]
        let found = cfg!(all(
            target_feature = "avx512f",
            target_feature = "avx512dq",
            target_feature = "avx512vl"
        ));
        (found && Avx2::detect().is_some()).then_some(Self(()))
    }

    /// Runs `op` on eight `f32`.
    #[inline(always)]
    pub fn run_f32<O: Vectorized<Scalar = f32>>(self, op: O) -> O::Output {
        // SAFETY: `self` proves that the CPU has the features of the callee.
        unsafe { enter_f32(op) }
    }

    /// Runs `op` on eight `f64`.
    #[inline(always)]
    pub fn run_f64<O: Vectorized<Scalar = f64>>(self, op: O) -> O::Output {
        // SAFETY: `self` proves that the CPU has the features of the callee.
        unsafe { enter_f64(op) }
    }
}

#[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512vl")]
unsafe fn enter_f32<O: Vectorized<Scalar = f32>>(op: O) -> O::Output {
    op.run::<F32x8>()
}

#[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512vl")]
unsafe fn enter_f64<O: Vectorized<Scalar = f64>>(op: O) -> O::Output {
    op.run::<F64x8>()
}

/// Eight `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x8(__m512d);

/// Calls intrinsics that touch no memory.
macro_rules! cpu {
    ($call:expr) => {
        // SAFETY: only AVX-512 F and DQ and AVX instructions on values; the module documentation says
        // why the CPU has them.
        unsafe { $call }
    };
}

impl Add for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(cpu!(_mm512_add_pd(self.0, o.0)))
    }
}

impl Sub for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self(cpu!(_mm512_sub_pd(self.0, o.0)))
    }
}

impl Mul for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self(cpu!(_mm512_mul_pd(self.0, o.0)))
    }
}

impl Neg for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(cpu!(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))))
    }
}

impl AddAssign for F64x8 {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl fmt::Debug for F64x8 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lanes = [0.0; Self::LANES];
        self.store(&mut lanes);
        f.debug_tuple("F64x8").field(&lanes).finish()
    }
}

impl Lanes for F64x8 {
    type Scalar = f64;
    const LANES: usize = 8;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(cpu!(_mm512_set1_pd(x)))
    }

    #[inline(always)]
    fn zero() -> Self {
        Self(cpu!(_mm512_setzero_pd()))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(cpu!(_mm512_fmadd_pd(self.0, b.0, c.0)))
    }

    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Self(cpu!(_mm512_div_pd(self.0, o.0)))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(cpu!(_mm512_sqrt_pd(self.0)))
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(cpu!(_mm512_max_pd(self.0, o.0)))
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(cpu!(_mm512_min_pd(self.0, o.0)))
    }

    #[inline(always)]
    fn select_lt(a: Self, b: Self, then: Self, other: Self) -> Self {
        Self(cpu!({
            let less = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0);
            _mm512_mask_blend_pd(less, other.0, then.0)
        }))
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let half = cpu!(_mm256_add_pd(
            _mm512_castpd512_pd256(self.0),
            _mm512_extractf64x4_pd::<1>(self.0)
        ));
        F64x4(half).sum()
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from: &[f64; 8] = head(from);
        // SAFETY: eight readable floats, no alignment needed; the CPU as in the module documentation.
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to: &mut [f64; 8] = head_mut(to);
        // SAFETY: eight writable floats, no alignment needed; the CPU as in the module documentation.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn gather(table: &[[f64; 8]], index: &[u32]) -> [Self; 8] {
        let index: &[u32; 8] = head(index);
        let mut columns = [[0.0; 8]; 8];
        for (l, &i) in index.iter().enumerate() {
            let Some(row) = table.get(i as usize) else { out_of_range(table.len(), index) };
            for (column, &word) in columns.iter_mut().zip(row) {
                column[l] = word;
            }
        }
        columns.map(|column| Self::load(&column))
    }

    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        a - b
    }
}
