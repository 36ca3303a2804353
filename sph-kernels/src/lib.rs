//! Smoothing kernels for SPH with variable support radii, for scalars and SIMD lanes.
//!
//! * [`Kernel`] and its implementations: `W`, `∇W` and their dimensionless forms.
//! * [`PairRadius`]: the radius `R_ij` of a pair whose particles have radii of their own.
//! * [`ShepardSum`], [`GradientSum`], [`GradientCorrection`]: sums that are exact for constant and
//!   linear fields. [`Moments`] measures how exact plain sums are.
//! * [`Real`], [`Lanes`], [`Vectorized`]: pair sums on several neighbours at a time.
//!
//! Notation: `r_ij = x_i − x_j`, R the support radius where W becomes zero, `q = |r_ij|/R`, V the
//! volume of a particle, d the dimension.
//!
//! The README shows both ways to use it: kernels on plain floats, and sums on SIMD lanes.

#![cfg_attr(not(any(test, feature = "std")), no_std)]

mod correction;
mod kernel;
mod lanes;
mod moments;
mod pair_radius;
mod real;

pub use correction::{GradientCorrection, GradientSum, ShepardSum};
pub use kernel::{
    CubicSpline, Gaussian, Kernel, QuinticSpline, WendlandC2, WendlandC4, WendlandC6,
};
pub use lanes::{Lanes, Vectorized, simd_level};
pub use moments::Moments;
pub use pair_radius::{GatherRadius, MaxRadius, MeanRadius, PairRadius, ScatterRadius};
pub use real::Real;

/// Runs the programs of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
