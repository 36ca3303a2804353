//! Lanes in the vectors that every CPU of the target has, through the `wide` crate.
//!
//! Eight `f32` are two vectors of four and four `f64` two vectors of two. The 256-bit types of
//! `wide` would be the same thing, but they transpose and convert integers lane by lane.

use super::{Lanes, head, head_mut, out_of_range};
use core::array::from_fn;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};
use wide::{f32x4, f64x2};

/// Eight `f32`: lanes 0–3 and 4–7.
#[derive(Debug, Clone, Copy)]
pub struct F32x8(f32x4, f32x4);

/// Four `f64`: lanes 0–1 and 2–3.
#[derive(Debug, Clone, Copy)]
pub struct F64x4(f64x2, f64x2);

macro_rules! portable_operators {
    ($lanes:ident) => {
        impl Add for $lanes {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self(self.0 + o.0, self.1 + o.1)
            }
        }

        impl Sub for $lanes {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self(self.0 - o.0, self.1 - o.1)
            }
        }

        impl Mul for $lanes {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                Self(self.0 * o.0, self.1 * o.1)
            }
        }

        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0, -self.1)
            }
        }

        impl AddAssign for $lanes {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
    };
}

/// What both lane types do in the same way.
macro_rules! portable_arithmetic {
    ($half:ident) => {
        #[inline(always)]
        fn splat(x: Self::Scalar) -> Self {
            Self($half::splat(x), $half::splat(x))
        }

        #[inline(always)]
        fn zero() -> Self {
            Self::splat(0.0)
        }

        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            Self(self.0.mul_add(b.0, c.0), self.1.mul_add(b.1, c.1))
        }

        #[inline(always)]
        fn div(self, o: Self) -> Self {
            Self(self.0 / o.0, self.1 / o.1)
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(self.0.sqrt(), self.1.sqrt())
        }

        #[inline(always)]
        fn max(self, o: Self) -> Self {
            Self::select_lt(o, self, self, o)
        }

        #[inline(always)]
        fn min(self, o: Self) -> Self {
            Self::select_lt(self, o, self, o)
        }

        #[inline(always)]
        fn select_lt(a: Self, b: Self, then: Self, other: Self) -> Self {
            Self(
                a.0.simd_lt(b.0).bitselect(then.0, other.0),
                a.1.simd_lt(b.1).bitselect(then.1, other.1),
            )
        }
    };
}

portable_operators!(F32x8);
portable_operators!(F64x4);

impl Lanes for F32x8 {
    type Scalar = f32;
    const LANES: usize = 8;

    portable_arithmetic!(f32x4);

    #[inline(always)]
    fn sum(self) -> f32 {
        let [a, b, c, d] = (self.0 + self.1).to_array();
        (a + c) + (b + d)
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let &[a, b, c, d, e, f, g, h] = head(from);
        Self(f32x4::new([a, b, c, d]), f32x4::new([e, f, g, h]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to: &mut [f32; 8] = head_mut(to);
        to[..4].copy_from_slice(self.0.as_array());
        to[4..].copy_from_slice(self.1.as_array());
    }

    #[inline(always)]
    fn gather(table: &[[f32; 8]], index: &[u32]) -> [Self; 8] {
        let index: &[u32; 8] = head(index);
        let rows: [(f32x4, f32x4); 8] = rows(table, index)
            .map(|&[a, b, c, d, e, f, g, h]| (f32x4::new([a, b, c, d]), f32x4::new([e, f, g, h])));
        // Four blocks of 4 × 4: lanes 0–3 and 4–7 of words 0–3 and 4–7.
        let block = |first: usize, word: fn(&(f32x4, f32x4)) -> f32x4| {
            f32x4::transpose(from_fn(|l| word(&rows[first + l])))
        };
        let blocks =
            [[block(0, |r| r.0), block(4, |r| r.0)], [block(0, |r| r.1), block(4, |r| r.1)]];
        from_fn(|k| Self(blocks[k / 4][0][k % 4], blocks[k / 4][1][k % 4]))
    }

    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        let difference =
            |a: f32x4, b: f32x4| f32x4::from_i32x4((a.to_bits() - b.to_bits()).cast_signed());
        Self(difference(a.0, b.0), difference(a.1, b.1))
    }
}

impl Lanes for F64x4 {
    type Scalar = f64;
    const LANES: usize = 4;

    portable_arithmetic!(f64x2);

    #[inline(always)]
    fn sum(self) -> f64 {
        let [a, b] = (self.0 + self.1).to_array();
        a + b
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let &[a, b, c, d] = head(from);
        Self(f64x2::new([a, b]), f64x2::new([c, d]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to: &mut [f64; 4] = head_mut(to);
        to[..2].copy_from_slice(self.0.as_array());
        to[2..].copy_from_slice(self.1.as_array());
    }

    #[inline(always)]
    fn gather(table: &[[f64; 8]], index: &[u32]) -> [Self; 8] {
        let [a, b, c, d] = rows(table, head(index));
        from_fn(|k| Self(f64x2::new([a[k], b[k]]), f64x2::new([c[k], d[k]])))
    }

    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        a - b
    }
}

/// The records of a gather, after one check of all indices.
#[inline(always)]
fn rows<'a, T, const N: usize>(table: &'a [T], index: &[u32; N]) -> [&'a T; N] {
    if index.iter().any(|&i| i as usize >= table.len()) {
        out_of_range(table.len(), index);
    }
    index.map(|i| &table[i as usize])
}
