//! Smoothing kernels.

mod gaussian;
mod spline;
mod wendland;

pub use gaussian::Gaussian;
pub use spline::{CubicSpline, QuinticSpline};
pub use wendland::{WendlandC2, WendlandC4, WendlandC6};

use crate::{Lanes, Real};

/// A smoothing kernel with compact support of radius `R`: a zero-sized type.
///
/// `W(r, R) = σ_d / R^d · w(q)`, `q = |r| / R`, `σ_d` = [`norm(d)`](Self::norm), in 1/m^d.
///
/// `∇_i W(r_ij, R) = σ_d / R^(d+2) · slope(q) · r_ij`, `r_ij = x_i − x_j`, in 1/m^(d+1).
///
/// [`w`](Self::w), [`slope`](Self::slope) and its two factors are for loops that keep the constants outside;
/// [`value`](Self::value) and [`gradient`](Self::gradient) are complete.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// Name in files, such as `"wendland-c2"`.
    const NAME: &'static str;

    /// Support radius divided by the smoothing length h of the literature.
    const RADIUS_OVER_H: f64;

    /// `σ_d`: makes the integral of W over `dimension` dimensions equal to 1.
    ///
    /// # Panics
    /// If `dimension` is not 1, 2 or 3.
    fn norm(dimension: usize) -> f64;

    /// `w(q)` for finite q ≥ 0; zero for q ≥ 1. No branch.
    fn w<L: Lanes>(q: L) -> L;

    /// A constant factor of the slope. Loops that multiply by constants anyway take it with them and
    /// save a multiplication per pair: `slope(q) = SLOPE_FACTOR · slope_shape(q)`.
    const SLOPE_FACTOR: f64 = 1.0;

    /// [`slope`](Self::slope) without [`SLOPE_FACTOR`](Self::SLOPE_FACTOR).
    fn slope_shape<L: Lanes>(q: L) -> L;

    /// `w'(q) / q` for finite q ≥ 0; finite at q = 0, zero for q ≥ 1. No branch.
    #[inline(always)]
    fn slope<L: Lanes>(q: L) -> L {
        Self::slope_shape(q) * constant(Self::SLOPE_FACTOR)
    }

    /// `W(r, R)` in `D` dimensions, 1/m^D, from the distance and the support radius in m.
    #[inline(always)]
    fn value<const D: usize, L: Lanes>(distance: L, radius: L) -> L {
        let inverse = constant::<L>(1.0).div(radius);
        Self::w(distance * inverse) * scale::<D, L>(Self::norm(D), inverse)
    }

    /// `∇_i W(r_ij, R)`, 1/m^(D+1), from `r_ij = x_i − x_j` and the support radius in m.
    #[inline(always)]
    fn gradient<const D: usize, L: Lanes>(offset: [L; D], radius: L) -> [L; D] {
        let mut distance2 = L::zero();
        for x in offset {
            distance2 = x.mul_add(x, distance2);
        }
        let factor = Self::gradient_factor::<D, L>(distance2.sqrt(), radius);
        offset.map(|x| x * factor)
    }

    /// `F` with `∇_i W(r_ij, R) = F r_ij`, 1/m^(D+2). Never positive for the kernels of this crate.
    #[inline(always)]
    fn gradient_factor<const D: usize, L: Lanes>(distance: L, radius: L) -> L {
        let inverse = constant::<L>(1.0).div(radius);
        Self::slope(distance * inverse)
            * (scale::<D, L>(Self::norm(D), inverse) * (inverse * inverse))
    }
}

/// `norm / R^D`.
#[inline(always)]
fn scale<const D: usize, L: Lanes>(norm: f64, inverse_radius: L) -> L {
    let mut scale = constant::<L>(norm);
    for _ in 0..D {
        scale = scale * inverse_radius;
    }
    scale
}

/// The entry of a table of norms for one, two and three dimensions.
#[inline]
fn of_dimension(norms: [f64; 3], dimension: usize) -> f64 {
    assert!((1..=3).contains(&dimension), "kernels have 1, 2 or 3 dimensions, not {dimension}");
    norms[dimension - 1]
}

/// A constant in every lane.
#[inline(always)]
fn constant<L: Lanes>(x: f64) -> L {
    L::splat(L::Scalar::from_f64(x))
}

/// `max(1 − q, 0)`.
#[inline(always)]
fn inside<L: Lanes>(q: L) -> L {
    (constant::<L>(1.0) - q).max(L::zero())
}

#[cfg(test)]
mod tests;
