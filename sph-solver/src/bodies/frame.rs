//! How a rigid set of wall elements moves at a moment: what a sum over it must know.

use super::{in_scene, in_space};
use crate::space::offset;
use nalgebra::Vector3;

/// Velocity and spin of a rigid set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<const D: usize> {
    /// Where its reference point is, m: what spins, spins about it, and moments are about it.
    pub center: [f64; D],
    /// Velocity of the reference point, m/s.
    pub velocity: [f64; D],
    /// Angular velocity about x, y and z, rad/s.
    pub spin: [f64; 3],
    /// Lengths after which the axes repeat, m.
    pub periods: [Option<f64>; D],
}

impl<const D: usize> Frame<D> {
    /// Velocity V + Ω × r of the set, continued to the point `x` (m), in m/s.
    #[inline]
    pub fn velocity_at(&self, x: &[f64; D]) -> [f64; D] {
        let turning = turning(&self.spin, &offset(x, &self.center, &self.periods));
        std::array::from_fn(|k| self.velocity[k] + turning[k])
    }
}

/// Ω × r, of which two dimensions have the part in the plane.
#[inline]
pub fn turning<const D: usize>(spin: &[f64; 3], r: &[f64; D]) -> [f64; D] {
    in_scene(&Vector3::from(*spin).cross(&in_space(r)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_turns_about_its_middle() {
        let (center, periods) = ([1.0, 1.0], [None, Some(4.0)]);
        let wheel = Frame { center, velocity: [0.5, 0.0], spin: [0.0, 0.0, 2.0], periods };
        assert_eq!(wheel.velocity_at(&[1.0, 1.25]), [0.0, 0.0]);
        assert_eq!(wheel.velocity_at(&[1.5, 1.0]), [0.5, 1.0]);
        // The nearest image counts.
        assert_eq!(wheel.velocity_at(&[1.0, 5.25]), [0.0, 0.0]);
        assert_eq!(turning(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
    }
}
