//! Lanes in AVX2 registers.
//!
//! A value of these lane types, and a call of their methods, exists only below [`Avx2::run_f32`] or
//! [`Avx2::run_f64`], because nobody outside this crate can name the types. Both need an [`Avx2`],
//! which exists only after the CPU was found to have AVX2 and FMA. All `unsafe` of the intrinsics
//! rests on that.

use super::{Lanes, Vectorized, head, head_mut, out_of_range};
use core::arch::x86_64::*;
use core::fmt;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Proof that this CPU has AVX2 and FMA.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(());

impl Avx2 {
    /// Asks the CPU; the standard library remembers the answer.
    #[inline]
    pub fn detect() -> Option<Self> {
        #[cfg(feature = "std")]
        let found = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
        #[cfg(not(feature = "std"))]
        let found = cfg!(all(target_feature = "avx2", target_feature = "fma"));
        found.then_some(Self(()))
    }

    /// Runs `op` on eight `f32`.
    #[inline(always)]
    pub fn run_f32<O: Vectorized<Scalar = f32>>(self, op: O) -> O::Output {
        // SAFETY: `self` proves that the CPU has the features of the callee.
        unsafe { enter_f32(op) }
    }

    /// Runs `op` on four `f64`.
    #[inline(always)]
    pub fn run_f64<O: Vectorized<Scalar = f64>>(self, op: O) -> O::Output {
        // SAFETY: `self` proves that the CPU has the features of the callee.
        unsafe { enter_f64(op) }
    }
}

#[target_feature(enable = "avx2,fma")]
unsafe fn enter_f32<O: Vectorized<Scalar = f32>>(op: O) -> O::Output {
    op.run::<F32x8>()
}

#[target_feature(enable = "avx2,fma")]
unsafe fn enter_f64<O: Vectorized<Scalar = f64>>(op: O) -> O::Output {
    op.run::<F64x4>()
}

/// Eight `f32`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x8(__m256);

/// Four `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x4(pub(super) __m256d);

/// Calls intrinsics that touch no memory.
macro_rules! cpu {
    ($call:expr) => {
        // SAFETY: only AVX2 and FMA instructions on values; the module documentation says why the
        // CPU has them.
        unsafe { $call }
    };
}

macro_rules! operators {
    ($lanes:ident, $add:ident, $sub:ident, $mul:ident, $xor:ident, $set:ident) => {
        impl Add for $lanes {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self(cpu!($add(self.0, o.0)))
            }
        }

        impl Sub for $lanes {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self(cpu!($sub(self.0, o.0)))
            }
        }

        impl Mul for $lanes {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                Self(cpu!($mul(self.0, o.0)))
            }
        }

        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(cpu!($xor(self.0, $set(-0.0))))
            }
        }

        impl AddAssign for $lanes {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }

        impl fmt::Debug for $lanes {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let mut lanes = [0.0; Self::LANES];
                self.store(&mut lanes);
                f.debug_tuple(stringify!($lanes)).field(&lanes).finish()
            }
        }
    };
}

/// What both lane types do in the same way.
macro_rules! arithmetic {
    ($set:ident, $zero:ident, $fmadd:ident, $div:ident, $sqrt:ident, $max:ident, $min:ident,
     $cmp:ident, $blend:ident) => {
        #[inline(always)]
        fn splat(x: Self::Scalar) -> Self {
            Self(cpu!($set(x)))
        }

        #[inline(always)]
        fn zero() -> Self {
            Self(cpu!($zero()))
        }

        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            Self(cpu!($fmadd(self.0, b.0, c.0)))
        }

        #[inline(always)]
        fn div(self, o: Self) -> Self {
            Self(cpu!($div(self.0, o.0)))
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(cpu!($sqrt(self.0)))
        }

        #[inline(always)]
        fn max(self, o: Self) -> Self {
            Self(cpu!($max(self.0, o.0)))
        }

        #[inline(always)]
        fn min(self, o: Self) -> Self {
            Self(cpu!($min(self.0, o.0)))
        }

        #[inline(always)]
        fn select_lt(a: Self, b: Self, then: Self, other: Self) -> Self {
            Self(cpu!($blend(other.0, then.0, $cmp::<_CMP_LT_OQ>(a.0, b.0))))
        }
    };
}

operators!(F32x8, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_xor_ps, _mm256_set1_ps);
operators!(F64x4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_xor_pd, _mm256_set1_pd);

impl Lanes for F32x8 {
    type Scalar = f32;
    const LANES: usize = 8;

    arithmetic!(
        _mm256_set1_ps,
        _mm256_setzero_ps,
        _mm256_fmadd_ps,
        _mm256_div_ps,
        _mm256_sqrt_ps,
        _mm256_max_ps,
        _mm256_min_ps,
        _mm256_cmp_ps,
        _mm256_blendv_ps
    );

    #[inline(always)]
    fn sum(self) -> f32 {
        cpu!({
            let half =
                _mm_add_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let pair = _mm_add_ps(half, _mm_movehl_ps(half, half));
            _mm_cvtss_f32(_mm_add_ss(pair, _mm_movehdup_ps(pair)))
        })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from: &[f32; 8] = head(from);
        // SAFETY: eight readable floats, no alignment needed; AVX as in the module documentation.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to: &mut [f32; 8] = head_mut(to);
        // SAFETY: eight writable floats, no alignment needed; AVX as in the module documentation.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn gather(table: &[[f32; 8]], index: &[u32]) -> [Self; 8] {
        let index: &[u32; 8] = head(index);
        // SAFETY: eight readable indices, no alignment needed.
        let wanted = unsafe { _mm256_loadu_si256(index.as_ptr().cast()) };
        let last = last_index(table.len());
        let fits = cpu!({
            let last = _mm256_set1_epi32(last.cast_signed());
            // i ≤ last, unsigned, is max(i, last) = last.
            _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_max_epu32(wanted, last), last)) == -1
        });
        if table.is_empty() || !fits {
            out_of_range(table.len(), index);
        }
        let table = table.as_ptr();
        // SAFETY: every index is below the length of the table, so each row is eight readable
        // floats; no alignment needed.
        let row = |l: usize| unsafe { _mm256_loadu_ps(table.add(reload(&index[l])).cast()) };
        transpose_8x8([row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)])
    }

    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        Self(cpu!(_mm256_cvtepi32_ps(_mm256_sub_epi32(
            _mm256_castps_si256(a.0),
            _mm256_castps_si256(b.0)
        ))))
    }
}

impl Lanes for F64x4 {
    type Scalar = f64;
    const LANES: usize = 4;

    arithmetic!(
        _mm256_set1_pd,
        _mm256_setzero_pd,
        _mm256_fmadd_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        _mm256_max_pd,
        _mm256_min_pd,
        _mm256_cmp_pd,
        _mm256_blendv_pd
    );

    #[inline(always)]
    fn sum(self) -> f64 {
        cpu!({
            let pair =
                _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(pair, _mm_unpackhi_pd(pair, pair)))
        })
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from: &[f64; 4] = head(from);
        // SAFETY: four readable floats, no alignment needed; AVX as in the module documentation.
        Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to: &mut [f64; 4] = head_mut(to);
        // SAFETY: four writable floats, no alignment needed; AVX as in the module documentation.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn gather(table: &[[f64; 8]], index: &[u32]) -> [Self; 8] {
        let index: &[u32; 4] = head(index);
        // SAFETY: four readable indices, no alignment needed.
        let wanted = unsafe { _mm_loadu_si128(index.as_ptr().cast()) };
        let last = last_index(table.len());
        let fits = cpu!({
            let last = _mm_set1_epi32(last.cast_signed());
            _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_max_epu32(wanted, last), last)) == 0xffff
        });
        if table.is_empty() || !fits {
            out_of_range(table.len(), index);
        }
        let table = table.as_ptr();
        let at = [0, 1, 2, 3].map(|l: usize| reload(&index[l]));
        // SAFETY: every index is below the length of the table, so each row is two times four
        // readable floats; no alignment needed.
        let row = |l: usize, half: usize| unsafe {
            _mm256_loadu_pd(table.add(at[l]).cast::<f64>().add(4 * half))
        };
        let [a, b, c, d] = transpose_4x4([row(0, 0), row(1, 0), row(2, 0), row(3, 0)]);
        let [e, f, g, h] = transpose_4x4([row(0, 1), row(1, 1), row(2, 1), row(3, 1)]);
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        a - b
    }
}

/// The largest index into a table of this length that a `u32` can hold; 0 for an empty table.
#[inline(always)]
fn last_index(length: usize) -> u32 {
    u32::try_from(length.saturating_sub(1)).unwrap_or(u32::MAX)
}

/// Reads an index again from memory.
///
/// The compiler would rather extract the indices from the register that the bounds check loaded,
/// which takes the units that the transpose needs: gathers are then a third slower.
#[inline(always)]
fn reload(index: &u32) -> usize {
    // SAFETY: a reference is valid to read, and nobody writes behind a shared one, so this is the
    // index that was checked.
    unsafe { core::ptr::from_ref(index).read_volatile() as usize }
}

/// Rows to columns: pairs, quadruples, halves; 24 shuffles.
#[inline(always)]
fn transpose_8x8(r: [__m256; 8]) -> [F32x8; 8] {
    cpu!({
        let pair = |a, b| (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let quad = |a, b| {
            (_mm256_shuffle_ps::<0b01_00_01_00>(a, b), _mm256_shuffle_ps::<0b11_10_11_10>(a, b))
        };
        let (a01, b01) = pair(r[0], r[1]);
        let (a23, b23) = pair(r[2], r[3]);
        let (a45, b45) = pair(r[4], r[5]);
        let (a67, b67) = pair(r[6], r[7]);
        // Words 0 | 4, 1 | 5, 2 | 6, 3 | 7 of rows 0–3 and 4–7.
        let (w0a, w1a) = quad(a01, a23);
        let (w2a, w3a) = quad(b01, b23);
        let (w0b, w1b) = quad(a45, a67);
        let (w2b, w3b) = quad(b45, b67);
        let low = |a, b| F32x8(_mm256_permute2f128_ps::<0x20>(a, b));
        let high = |a, b| F32x8(_mm256_permute2f128_ps::<0x31>(a, b));
        [
            low(w0a, w0b),
            low(w1a, w1b),
            low(w2a, w2b),
            low(w3a, w3b),
            high(w0a, w0b),
            high(w1a, w1b),
            high(w2a, w2b),
            high(w3a, w3b),
        ]
    })
}

/// Rows to columns: pairs, halves; 8 shuffles.
#[inline(always)]
fn transpose_4x4(r: [__m256d; 4]) -> [F64x4; 4] {
    cpu!({
        let (a0, b0) = (_mm256_unpacklo_pd(r[0], r[1]), _mm256_unpackhi_pd(r[0], r[1]));
        let (a1, b1) = (_mm256_unpacklo_pd(r[2], r[3]), _mm256_unpackhi_pd(r[2], r[3]));
        [
            F64x4(_mm256_permute2f128_pd::<0x20>(a0, a1)),
            F64x4(_mm256_permute2f128_pd::<0x20>(b0, b1)),
            F64x4(_mm256_permute2f128_pd::<0x31>(a0, a1)),
            F64x4(_mm256_permute2f128_pd::<0x31>(b0, b1)),
        ]
    })
}
