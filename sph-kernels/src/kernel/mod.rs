//! Smoothing kernels.

mod wendland;

pub use wendland::WendlandC2;

use crate::Lanes;

/// A smoothing kernel with compact support of radius `R`: a zero-sized type.
///
/// `W(r, R) = σ_d / R^d · w(q)`, `q = |r| / R`, `σ_d` = [`norm(d)`](Self::norm), in 1/m^d.
///
/// `∇_i W(r_ij, R) = σ_d / R^(d+2) · slope(q) · r_ij`, `r_ij = x_i − x_j`, in 1/m^(d+1).
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

    /// `w(q)` for q ≥ 0; zero for q ≥ 1. No branch.
    fn w<L: Lanes>(q: L) -> L;

    /// `w'(q) / q` for q ≥ 0; finite at q = 0, zero for q ≥ 1. No branch.
    fn slope<L: Lanes>(q: L) -> L;
}

/// The entry of a table of norms for one, two and three dimensions.
fn of_dimension(norms: [f64; 3], dimension: usize) -> f64 {
    assert!((1..=3).contains(&dimension), "kernels have 1, 2 or 3 dimensions, not {dimension}");
    norms[dimension - 1]
}

/// A constant in every lane.
#[inline(always)]
fn constant<L: Lanes>(x: f64) -> L {
    L::splat(crate::Real::from_f64(x))
}
