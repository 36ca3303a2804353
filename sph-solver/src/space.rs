//! Differences of coordinates, in open space and between periodic sides.

use sph_kernels::{Lanes, Real};

/// Scale of the pairs of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairScale<const D: usize> {
    /// Metres per unit of coordinate differences.
    pub unit: f64,
    /// Support radius R, the largest where radii vary, m.
    pub support_radius: f64,
    /// Lengths after which the axes repeat, m; none for an open axis.
    pub periods: [Option<f64>; D],
}

impl<const D: usize> PairScale<D> {
    /// Scale of the pairs in open space with this support radius (m).
    pub fn new(support_radius: f64) -> Self {
        Self { unit: unit(support_radius), support_radius, periods: [None; D] }
    }

    /// Metres per unit of the coordinate *words* along an axis: a periodic axis is as long as the
    /// words of single precision are wide, so that they wrap around where it repeats.
    pub fn coordinate_unit<S: Real>(&self, axis: usize) -> f64 {
        match self.periods[axis] {
            Some(period) if S::WRAPS_AT > 0.0 => period / S::WRAPS_AT,
            _ => self.unit,
        }
    }

    /// Whether any axis repeats.
    pub fn is_periodic(&self) -> bool {
        self.periods.iter().any(Option::is_some)
    }
}

/// Unit of the coordinate differences for a support radius, m: R / 2²⁴.
pub fn unit(support_radius: f64) -> f64 {
    support_radius / f64::from(1u32 << 24)
}

/// How coordinate words are subtracted. A type, so that open space costs nothing for the sake of
/// periodic sides.
pub trait Metric: Copy + Send + Sync + 'static {
    /// Whether pairs have support radii of their own.
    const GRADED: bool = false;

    /// `a − b` along an axis, in units.
    fn difference<const D: usize, L: Lanes>(a: L, b: L, scale: &PairScale<D>, axis: usize) -> L;
}

/// No axis repeats.
#[derive(Debug, Clone, Copy)]
pub struct Open;

/// Some axes repeat: differences along them are to the nearest image.
#[derive(Debug, Clone, Copy)]
pub struct Periodic;

/// Axes may repeat, and support radii vary from particle to particle.
#[derive(Debug, Clone, Copy)]
pub struct Graded;

impl Metric for Graded {
    const GRADED: bool = true;

    #[inline(always)]
    fn difference<const D: usize, L: Lanes>(a: L, b: L, scale: &PairScale<D>, axis: usize) -> L {
        Periodic::difference(a, b, scale, axis)
    }
}

impl Metric for Open {
    #[inline(always)]
    fn difference<const D: usize, L: Lanes>(a: L, b: L, _: &PairScale<D>, _: usize) -> L {
        L::coordinate_difference(a, b)
    }
}

impl Metric for Periodic {
    #[inline(always)]
    fn difference<const D: usize, L: Lanes>(a: L, b: L, scale: &PairScale<D>, axis: usize) -> L {
        let difference = L::coordinate_difference(a, b);
        let Some(period) = scale.periods[axis] else { return difference };
        let period = period / scale.unit;
        if L::Scalar::WRAPS_AT > 0.0 {
            // The words wrap around once a period: the difference is to the nearest image already.
            return difference * splat(period / L::Scalar::WRAPS_AT);
        }
        let (half, whole) = (splat::<L>(0.5 * period), splat::<L>(period));
        let below = L::select_lt(half, difference, difference - whole, difference);
        L::select_lt(below, -half, below + whole, below)
    }
}

fn splat<L: Lanes>(x: f64) -> L {
    L::splat(<L::Scalar as Real>::from_f64(x))
}

/// A position in the box of the periodic axes, which begins at `lower`.
pub fn wrapped<const D: usize>(
    mut x: [f64; D],
    lower: &[f64; D],
    periods: &[Option<f64>; D],
) -> [f64; D] {
    for axis in 0..D {
        let Some(period) = periods[axis] else { continue };
        let turns = ((x[axis] - lower[axis]) / period).floor();
        // Nothing is added when there is nothing to wrap, so that −0 stays −0.
        if turns != 0.0 {
            x[axis] -= turns * period;
        }
    }
    x
}

/// `x − y`, to the nearest image along periodic axes, m.
pub fn offset<const D: usize>(x: &[f64; D], y: &[f64; D], periods: &[Option<f64>; D]) -> [f64; D] {
    std::array::from_fn(|axis| {
        let d = x[axis] - y[axis];
        periods[axis].map_or(d, |period| d - period * (d / period).round())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn differences_are_to_the_nearest_image(
            x in -0.2..2.2_f64,
            y in -0.2..2.2_f64,
            near in -0.4..0.4_f64,
        ) {
            let scale = PairScale { periods: [Some(2.0), None], ..PairScale::<2>::new(0.5) };
            for (axis, a, b) in [(0, x, x + near), (0, y + near, y), (1, x, y)] {
                let expected = if axis == 1 { a - b } else { offset(&[a, 0.0], &[b, 0.0], &scale.periods)[0] };
                let f = |x| f32::encode_coordinate(x, scale.coordinate_unit::<f32>(axis));
                let d = |x| f64::encode_coordinate(x, scale.coordinate_unit::<f64>(axis));
                let single = Periodic::difference(f(a), f(b), &scale, axis).to_f64() * scale.unit;
                let double = Periodic::difference(d(a), d(b), &scale, axis) * scale.unit;
                prop_assert!((single - expected).abs() < 1e-6, "{single} {expected}");
                prop_assert!((double - expected).abs() < 1e-12, "{double} {expected}");
            }
        }
    }

    #[test]
    fn positions_are_wrapped_into_the_box() {
        let periods = [Some(2.0), None];
        assert_eq!(wrapped([3.25, 5.0], &[1.0, 0.0], &periods), [1.25, 5.0]);
        assert_eq!(wrapped([0.5, -5.0], &[1.0, 0.0], &periods), [2.5, -5.0]);
        assert_eq!(wrapped([1.0, 0.0], &[1.0, 0.0], &periods), [1.0, 0.0]);
    }
}
