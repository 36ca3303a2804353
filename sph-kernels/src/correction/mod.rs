//! Corrections that make sums over disordered or one-sided neighbours consistent.

mod eigen;
mod gradient;
mod shepard;

pub use gradient::{GradientCorrection, GradientSum};
pub use shepard::ShepardSum;
