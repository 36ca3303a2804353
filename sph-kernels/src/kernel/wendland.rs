//! Kernels of Wendland (1995), as Dehnen and Aly (2012) recommend them for SPH.

use super::{Kernel, constant, of_dimension};
use crate::Lanes;
use core::f64::consts::PI;

/// Wendland C2: `w = (1 − q)⁴ (1 + 4q)`, `w'/q = −20 (1 − q)³`.
///
/// The usual choice: smooth enough, no pairing of particles, the cheapest slope of all kernels
/// (no division), and of its family the smallest error on disordered particles at equal support.
///
/// Source: H. Wendland, Adv. Comput. Math. 4 (1995) 389; W. Dehnen and H. Aly, MNRAS 425 (2012)
/// 1068, table 1. In one dimension they use `(1 − q)³ (1 + 3q)`; here it is the polynomial of two
/// and three dimensions with a norm of its own, so that one definition serves all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    const NAME: &'static str = "wendland-c2";
    const RADIUS_OVER_H: f64 = 2.0;

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
    fn slope<L: Lanes>(q: L) -> L {
        let m = inside(q);
        m * m * (m * constant(-20.0))
    }
}

/// `max(1 − q, 0)`.
#[inline(always)]
fn inside<L: Lanes>(q: L) -> L {
    (constant::<L>(1.0) - q).max(L::zero())
}
