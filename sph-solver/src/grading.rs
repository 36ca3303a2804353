//! Support radii where the spacing of the fluid varies.
//!
//! A particle of mass m fills a cube of edge (m/ρ0)^(1/D) at rest, its own spacing, and its support radius
//! is as many spacings as everywhere. Mass never changes, so neither do radii; nothing else has to be
//! kept, sent or checkpointed for them.

/// How the support radius follows from the mass of a particle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Mass of a particle of the largest radius, kg.
    largest_mass: f64,
    /// The smallest radius over the largest.
    smallest: f64,
}

impl Grading {
    /// For particles of up to `largest_mass` (kg), the finest of which have a spacing `smallest` times
    /// theirs.
    pub fn new(largest_mass: f64, smallest: f64) -> Self {
        Self { largest_mass, smallest }
    }

    /// The smallest radius over the largest.
    pub fn smallest(&self) -> f64 {
        self.smallest
    }

    /// The radius of a particle of this mass (kg) over the largest, from `smallest` to 1.
    #[inline]
    pub fn ratio<const D: usize>(&self, mass: f64) -> f64 {
        root::<D>(mass / self.largest_mass).clamp(self.smallest, 1.0)
    }
}

/// The D-th root of a positive number, of operations alone that round the same way on every machine:
/// the cube root of a library for mathematics does not.
#[inline]
pub fn root<const D: usize>(x: f64) -> f64 {
    match D {
        1 => x,
        2 => x.sqrt(),
        _ => cube_root(x),
    }
}

fn cube_root(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return 0.0;
    }
    // A third of the exponent is a first guess; Newton's steps double its digits.
    let mut root = f64::from_bits(x.to_bits() / 3 + (1023 << 52) / 3 * 2);
    for _ in 0..6 {
        root = (2.0 * root + x / (root * root)) / 3.0;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_is_the_root_of_a_mass() {
        let grading = Grading::new(8.0, 0.125);
        assert_eq!((grading.ratio::<2>(2.0), grading.ratio::<2>(8.0)), (0.5, 1.0));
        assert!((grading.ratio::<3>(1.0) - 0.5).abs() < 1e-15);
        assert_eq!((grading.ratio::<3>(1e-9), grading.ratio::<3>(9.0)), (0.125, 1.0));
    }

    #[test]
    fn cube_roots_are_right_for_all_sizes() {
        for x in [1e-200, 1e-12, 0.3, 1.0, 7.0, 27.0, 1e9, 1e200] {
            assert!((cube_root(x).powi(3) / x - 1.0).abs() < 1e-14, "{x}");
        }
        assert_eq!((cube_root(-1.0), cube_root(f64::NAN)), (0.0, 0.0));
    }
}
