//! `[[refine]]`: where particles are finer.

use super::located::At;
use super::shape::with_shape_keys;

with_shape_keys! {
    /// Something around and in which particles are finer than `numerics.spacing`, from where they grow to
    /// that spacing: a shape, or a solid where it is at the start.
    Refine {
        /// How many times finer: 2, 4, 8 or 16.
        factor: At<u32>,
        /// Distance from the shape, m, up to which particles are as fine as in it. 0 when absent.
        within: Option<At<f64>>,
        /// Spacing of a particle over that of the next one towards the shape, more than 1 and at most 1.1.
        /// 1.05 when absent.
        growth: Option<At<f64>>,
        /// Name of the solid to refine around, in place of a shape.
        solid: Option<At<String>>,
    }
}

/// Growth when a scene does not say.
const GROWTH: f64 = 1.05;

impl Refine {
    /// Distance from the shape up to which particles are as fine as in it, m.
    pub fn within(&self) -> f64 {
        self.within.as_deref().copied().unwrap_or(0.0)
    }

    /// Spacing of a particle over that of the next one towards the shape.
    pub fn growth(&self) -> f64 {
        self.growth.as_deref().copied().unwrap_or(GROWTH)
    }
}
