//! Smoothing kernels for SPH with variable support radii, for scalars and SIMD lanes.

#![cfg_attr(not(feature = "std"), no_std)]

mod kernel;
mod lanes;
mod real;

pub use kernel::{
    CubicSpline, Gaussian, Kernel, QuinticSpline, WendlandC2, WendlandC4, WendlandC6,
};
pub use lanes::{Lanes, Vectorized, simd_level};
pub use real::Real;
