//! Spline kernels.

use super::{Kernel, constant, inside, of_dimension};
use crate::Lanes;
use core::f64::consts::PI;

/// Cubic spline M4, support 2h: `w = 2 (1 − q)₊³ − (1 − 2q)₊³`.
///
/// `w'/q` is `18q − 12` for q < 1/2 and `−6 (1 − q)²/q` outside.
///
/// Norm 4/3, 40/(7π), 8/π in 1-D, 2-D, 3-D. Source: J. J. Monaghan and J. C. Lattanzio, Astron.
/// Astrophys. 149 (1985) 135, written with truncated powers and q = r/2h.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CubicSpline;

impl Kernel for CubicSpline {
    const NAME: &'static str = "cubic-spline";
    const RADIUS_OVER_H: f64 = 2.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension([4.0 / 3.0, 40.0 / (7.0 * PI), 8.0 / PI], dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let outer = inside(q);
        let inner = inside(q + q);
        let outer3 = outer * outer * outer;
        outer3 + outer3 - inner * inner * inner
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        let half = constant(0.5);
        let m = inside(q);
        let inner = q.mul_add(constant(18.0), constant(-12.0));
        // Limited below so that the lanes that do not use it divide by no zero.
        let outer = (m * m * constant(-6.0)).div(q.max(half));
        L::select_lt(q, half, inner, outer)
    }
}

/// Quintic spline M6, support 3h: `w = (3 − s)₊⁵ − 6 (2 − s)₊⁵ + 15 (1 − s)₊⁵`, `s = 3q`.
///
/// `w'/q` is `9 (−120 + 120 s² − 50 s³)` for s < 1 and
/// `−45 [(3 − s)₊⁴ − 6 (2 − s)₊⁴]/s` outside.
///
/// Norm 1/40, 63/(478π), 9/(40π) in 1-D, 2-D, 3-D, which is 1/120, 7/(478π), 1/(120π) times 3^d.
/// Source: I. J. Schoenberg, Q. Appl. Math. 4 (1946) 45; in SPH J. P. Morris, P. J. Fox and Y. Zhu,
/// J. Comput. Phys. 136 (1997) 214. The 3-D norm is often printed as 3/(359π), which is
/// 0.3 % too large.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QuinticSpline;

impl Kernel for QuinticSpline {
    const NAME: &'static str = "quintic-spline";
    const RADIUS_OVER_H: f64 = 3.0;

    #[inline]
    fn norm(dimension: usize) -> f64 {
        of_dimension([1.0 / 40.0, 63.0 / (478.0 * PI), 9.0 / (40.0 * PI)], dimension)
    }

    #[inline(always)]
    fn w<L: Lanes>(q: L) -> L {
        let s = q * constant(3.0);
        let [a, b, c] = [3.0, 2.0, 1.0].map(|end| {
            let m = (constant::<L>(end) - s).max(L::zero());
            let m2 = m * m;
            m2 * m2 * m
        });
        c.mul_add(constant(15.0), b.mul_add(constant(-6.0), a))
    }

    #[inline(always)]
    fn slope_shape<L: Lanes>(q: L) -> L {
        let one = constant(1.0);
        let s = q * constant(3.0);
        let [a, b] = [3.0, 2.0].map(|end| {
            let m = (constant::<L>(end) - s).max(L::zero());
            let m2 = m * m;
            m2 * m2
        });
        let inner = s.mul_add(constant(-450.0), constant(1080.0)).mul_add(s * s, constant(-1080.0));
        // Limited below so that the lanes that do not use it divide by no zero.
        let outer = b.mul_add(constant(270.0), a * constant(-45.0)).div(s.max(one));
        L::select_lt(s, one, inner, outer)
    }
}
