//! Lanes: several scalars side by side, with the operations that pair sums need.

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) mod avx512;
pub(crate) mod portable;
mod scalar;

use crate::Real;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A fixed number of scalars that are computed together.
///
/// Code written once for `L: Lanes` runs on plain `f32` and `f64` (one lane), on portable vectors
/// and on AVX2 registers. Lane types cannot be named outside this crate: [`Real::dispatch`] picks
/// one and hands it to a [`Vectorized`] operation.
pub trait Lanes:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + 'static
{
    /// What one lane holds.
    type Scalar: Real;

    /// Number of lanes.
    const LANES: usize;

    /// The same scalar in every lane.
    fn splat(x: Self::Scalar) -> Self;

    /// Zero in every lane.
    fn zero() -> Self;

    /// `self · b + c`, rounded once where the CPU has fused multiply-add.
    fn mul_add(self, b: Self, c: Self) -> Self;

    /// `self / o`.
    fn div(self, o: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// The larger one; `o` if either is not a number.
    fn max(self, o: Self) -> Self;

    /// The smaller one; `o` if either is not a number.
    fn min(self, o: Self) -> Self;

    /// Per lane: `then` where `a < b`, `other` elsewhere, also where `a` or `b` is not a number.
    fn select_lt(a: Self, b: Self, then: Self, other: Self) -> Self;

    /// Sum of all lanes, halves first: `((0+4) + (2+6)) + ((1+5) + (3+7))` for eight lanes,
    /// `(0+2) + (1+3)` for four. The order is the same for every lane type of that count.
    fn sum(self) -> Self::Scalar;

    /// Loads the first [`LANES`](Self::LANES) scalars of a slice.
    ///
    /// # Panics
    /// If the slice is shorter.
    fn load(from: &[Self::Scalar]) -> Self;

    /// Writes the lanes to the start of a slice.
    ///
    /// # Panics
    /// If the slice is shorter than [`LANES`](Self::LANES).
    fn store(self, to: &mut [Self::Scalar]);

    /// Loads one record a lane and transposes: lane `l` of `result[k]` is `table[index[l]][k]`.
    ///
    /// Reads the first [`LANES`](Self::LANES) indices. Words that the caller does not use cost
    /// nothing but the load. The table needs no alignment; records that are aligned to their own
    /// size never straddle cache lines and load faster.
    ///
    /// # Panics
    /// If there are fewer indices than lanes, or an index is out of range.
    fn gather(table: &[[Self::Scalar; 8]], index: &[u32]) -> [Self; 8];

    /// Difference of two coordinate words made by [`Real::encode_coordinate`], in its units.
    ///
    /// `f32`: wrapping difference of the bits as 32-bit integers, then rounded to `f32`.
    /// `f64`: plain difference.
    fn coordinate_difference(a: Self, b: Self) -> Self;
}

/// An operation that is compiled for every kind of lanes. Run it with [`Real::dispatch`].
pub trait Vectorized {
    /// Scalar of the lanes.
    type Scalar: Real;
    /// What the operation returns.
    type Output;

    /// Does the work.
    ///
    /// Mark the implementation `#[inline(always)]`, and likewise the functions that it calls with
    /// `L` in their signatures: only code inlined into the entry point of [`Real::dispatch`] is
    /// compiled for the CPU that was found.
    fn run<L: Lanes<Scalar = Self::Scalar>>(self) -> Self::Output;
}

/// Name of the lanes that [`Real::dispatch`] uses here, for reports: `"avx512"`, `"avx2+fma"` or
/// `"portable"`.
pub fn simd_level() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if avx512::Avx512::detect().is_some() {
        return "avx512";
    }
    #[cfg(target_arch = "x86_64")]
    if avx2::Avx2::detect().is_some() {
        return "avx2+fma";
    }
    "portable"
}

/// Ends a gather whose indices do not fit the table.
#[cold]
#[inline(never)]
fn out_of_range(records: usize, index: &[u32]) -> ! {
    panic!("gather from {records} records with an index out of range: {index:?}");
}

/// Ends a call with too few indices or scalars.
#[cold]
#[inline(never)]
fn too_short(lanes: usize, given: usize) -> ! {
    panic!("{lanes} lanes need a slice of {lanes} elements, got {given}");
}

/// The first `N` elements.
#[inline(always)]
fn head<T, const N: usize>(slice: &[T]) -> &[T; N] {
    match slice.first_chunk() {
        Some(head) => head,
        None => too_short(N, slice.len()),
    }
}

/// The first `N` elements, to be written.
#[inline(always)]
fn head_mut<T, const N: usize>(slice: &mut [T]) -> &mut [T; N] {
    let given = slice.len();
    match slice.first_chunk_mut() {
        Some(head) => head,
        None => too_short(N, given),
    }
}

#[cfg(test)]
mod tests;
