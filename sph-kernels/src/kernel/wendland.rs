//! Kernels of Wendland (1995), as Dehnen and Aly (2012) recommend them for SPH.
//!
//! H. Wendland, Adv. Comput. Math. 4 (1995) 389; W. Dehnen and H. Aly, MNRAS 425 (2012) 1068,
//! table 1. In one dimension they use other polynomials, `(1 − q)³ (1 + 3q)` for C2. Here it is the
//! polynomials of two and three dimensions with norms of their own, so that one definition serves
//! all dimensions.

use super::{Kernel, constant, inside, of_dimension};
use crate::Lanes;
use core::f64::consts::PI;

/// Wendland C2: `w = (1 − q)⁴ (1 + 4q)`, `w'/q = −20 (1 − q)³`.
///
/// The usual choice: no pairing of particles, the cheapest slope of all kernels here (no division),
/// and of its family the smallest error on disordered particles at equal support.
///
/// Norm 3/2, 7/π, 21/(2π) in 1-D, 2-D, 3-D. Source: Wendland (1995); Dehnen and Aly, MNRAS 425
/// (2012) 1068, table 1. The 1-D kernel there is another polynomial, `(1 − q)³ (1 + 3q)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    const NAME: &'static str = "wendland-c2";
    const RADIUS_OVER_H: f64 = 2.0;
    const SLOPE_FACTOR: f64 = -20.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension([3.0 / 2.0, 7.0 / PI, 21.0 / (2.0 * PI)], dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let m = inside(q);
        let m2 = m * m;
        m2 * m2 * q.mul_add(constant(4.0), constant(1.0))
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        let m = inside(q);
        m * m * m
    }
}

/// Wendland C4: `w = (1 − q)⁶ (1 + 6q + 35/3 q²)`, `w'/q = −56/3 (1 − q)⁵ (1 + 5q)`.
///
/// Norm 27/16, 9/π, 495/(32π) in 1-D, 2-D, 3-D. Source: Wendland (1995); Dehnen and Aly, MNRAS 425
/// (2012) 1068, table 1. The 1-D kernel there is another polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WendlandC4;

impl Kernel for WendlandC4 {
    const NAME: &'static str = "wendland-c4";
    const RADIUS_OVER_H: f64 = 2.0;
    const SLOPE_FACTOR: f64 = -56.0 / 3.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension([27.0 / 16.0, 9.0 / PI, 495.0 / (32.0 * PI)], dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let m = inside(q);
        let m2 = m * m;
        let polynomial = q.mul_add(constant(35.0 / 3.0), constant(6.0)).mul_add(q, constant(1.0));
        m2 * m2 * m2 * polynomial
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        let m = inside(q);
        let m2 = m * m;
        m2 * m2 * (m * q.mul_add(constant(5.0), constant(1.0)))
    }
}

/// Wendland C6: `w = (1 − q)⁸ (1 + 8q + 25q² + 32q³)`, `w'/q = −22 (1 − q)⁷ (1 + 7q + 16q²)`.
///
/// Norm 15/8, 78/(7π), 1365/(64π) in 1-D, 2-D, 3-D. Source: Wendland (1995); Dehnen and Aly, MNRAS
/// 425 (2012) 1068, table 1. The 1-D kernel there is another polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WendlandC6;

impl Kernel for WendlandC6 {
    const NAME: &'static str = "wendland-c6";
    const RADIUS_OVER_H: f64 = 2.0;
    const SLOPE_FACTOR: f64 = -22.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension([15.0 / 8.0, 78.0 / (7.0 * PI), 1365.0 / (64.0 * PI)], dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let m = inside(q);
        let m2 = m * m;
        let m4 = m2 * m2;
        let polynomial = q
            .mul_add(constant(32.0), constant(25.0))
            .mul_add(q, constant(8.0))
            .mul_add(q, constant(1.0));
        m4 * m4 * polynomial
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        let m = inside(q);
        let m2 = m * m;
        let polynomial = q.mul_add(constant(16.0), constant(7.0)).mul_add(q, constant(1.0));
        m2 * m2 * m2 * (m * polynomial)
    }
}
