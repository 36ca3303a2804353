//! The spacing of the particles as a function of the place.

use crate::aabb::Aabb;
use crate::shape::Shape;

/// Something around which particles are finer than elsewhere.
#[derive(Debug, Clone)]
pub struct Refinement<const D: usize> {
    /// What they are finer around, and in.
    pub target: Shape<D>,
    /// Spacing there, m.
    pub spacing: f64,
    /// Distance from the target up to which they are as fine, m.
    pub within: f64,
    /// Spacing over that of the next particle towards the target, a little more than 1.
    pub growth: f64,
}

impl<const D: usize> Refinement<D> {
    /// The spacing that this refinement asks for, without end, at a distance (m) from the target.
    fn at_distance(&self, distance: f64) -> f64 {
        let (beyond, bend) = ((distance - self.within).max(0.0), BEND * self.spacing);
        let run = if beyond < bend { 0.5 * beyond * beyond / bend } else { beyond - 0.5 * bend };
        self.spacing + (self.growth - 1.0) * run
    }

    /// Distance from the target (m) beyond which it asks for more than a spacing.
    fn distance_of(&self, spacing: f64) -> f64 {
        let run = (spacing - self.spacing).max(0.0) / (self.growth - 1.0);
        self.within + run + 0.5 * BEND * self.spacing
    }
}

/// Distance over which spacings begin to grow, in spacings. The sums of particles beside a wall take the
/// growth for constant within their support.
const BEND: f64 = 8.0;

/// Share of the coarsest spacing in which growth ends before and after it would be reached.
const ROUND: f64 = 0.15;

/// The smaller of a spacing and the coarsest, without a kink.
fn rounded(spacing: f64, coarsest: f64) -> f64 {
    let margin = ROUND * coarsest;
    let over = (spacing - coarsest + margin).clamp(0.0, 2.0 * margin);
    (spacing - over * over / (4.0 * margin)).min(coarsest)
}

/// The spacing at every place: the smallest that any refinement asks for, and no more than the coarsest.
/// It grows linearly with the distance from what is refined, so that neighbours differ by a constant
/// factor, and begins and ends to grow little by little.
#[derive(Debug, Clone)]
pub struct SpacingField<const D: usize> {
    coarsest: f64,
    refinements: Vec<Refinement<D>>,
    periods: [Option<f64>; D],
}

impl<const D: usize> SpacingField<D> {
    /// Where nothing is refined the spacing is `coarsest` (m). In a box that repeats along axes with a
    /// period (m), targets repeat too.
    pub fn new(coarsest: f64, refinements: Vec<Refinement<D>>, periods: [Option<f64>; D]) -> Self {
        Self { coarsest, refinements, periods }
    }

    /// The largest spacing, m.
    pub fn coarsest(&self) -> f64 {
        self.coarsest
    }

    /// The smallest spacing, m.
    pub fn finest(&self) -> f64 {
        self.refinements.iter().map(|one| one.spacing).fold(self.coarsest, f64::min)
    }

    /// The spacing at a place, m.
    pub fn at(&self, x: &[f64; D]) -> f64 {
        let mut spacing = self.coarsest;
        for one in &self.refinements {
            self.for_each_image(x, |image| {
                // Nearer than it seems is no surprise: distances of combined shapes are bounds.
                let distance = one.target.signed_distance(&image).max(0.0);
                spacing = spacing.min(rounded(one.at_distance(distance), self.coarsest));
            });
        }
        spacing
    }

    /// The smallest spacing anywhere in a box, from its distances to the targets: a lower bound, m.
    pub fn least_in(&self, bounds: &Aabb<D>) -> f64 {
        let middle: [f64; D] = std::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
        let half = (0..D).map(|k| (0.5 * (bounds.max[k] - bounds.min[k])).powi(2)).sum::<f64>();
        let mut spacing = self.coarsest;
        for one in &self.refinements {
            self.for_each_image(&middle, |image| {
                let distance = one.target.signed_distance(&image) - half.sqrt();
                let distance = distance.max(0.0);
                spacing = spacing.min(rounded(one.at_distance(distance), self.coarsest));
            });
        }
        spacing
    }

    /// A box that holds all places, between its periodic sides, where the spacing is smaller than this
    /// (m); empty when there is none.
    pub fn bounds_of(&self, spacing: f64) -> Aabb<D> {
        let mut bounds = Aabb::EMPTY;
        // Where growth ends, a spacing is reached later.
        let rounding = spacing > (1.0 - ROUND) * self.coarsest;
        let asked = if rounding { (1.0 + ROUND) * self.coarsest } else { spacing };
        for one in self.refinements.iter().filter(|one| one.spacing < spacing) {
            let around = one.target.bounding_box().inflated(one.distance_of(asked));
            bounds = bounds.union(&around);
        }
        for k in (0..D).filter(|&k| self.periods[k].is_some()) {
            (bounds.min[k], bounds.max[k]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        bounds
    }

    fn for_each_image(&self, x: &[f64; D], mut visit: impl FnMut([f64; D])) {
        for number in 0..3_usize.pow(D as u32) {
            let turn = |k: usize| [0.0, 1.0, -1.0][number / 3_usize.pow(k as u32) % 3];
            if (0..D).all(|k| self.periods[k].is_some() || turn(k) == 0.0) {
                visit(std::array::from_fn(|k| x[k] + turn(k) * self.periods[k].unwrap_or(0.0)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(periods: [Option<f64>; 2]) -> SpacingField<2> {
        let target = Shape::sphere([0.0; 2], 0.5).unwrap();
        let one = Refinement { target, spacing: 0.01, within: 0.1, growth: 1.05 };
        SpacingField::new(0.04, vec![one], periods)
    }

    #[test]
    fn it_grows_from_the_finest_to_the_coarsest() {
        let field = field([None; 2]);
        assert_eq!((field.finest(), field.coarsest()), (0.01, 0.04));
        for (x, spacing) in [(0.2, 0.01), (0.6, 0.01), (0.84, 0.02), (1.04, 0.03), (3.0, 0.04)] {
            assert!((field.at(&[x, 0.0]) - spacing).abs() < 1e-15, "{x}");
        }
        // The next particle is 5 % larger.
        let (here, there) = (field.at(&[0.84, 0.0]), field.at(&[0.86, 0.0]));
        assert!((there / here - 1.05).abs() < 1e-12);
    }

    #[test]
    fn it_has_no_kinks() {
        let field = field([None; 2]);
        let step = 1e-4;
        let slope = |x: f64| (field.at(&[x + step, 0.0]) - field.at(&[x, 0.0])) / step;
        let (mut before, mut most) = (slope(0.5), 0.0_f64);
        for n in 0..15_000 {
            let now = slope(0.5 + f64::from(n) * step);
            assert!((now - before).abs() < 1e-3, "{n}: {before} {now}");
            (before, most) = (now, most.max(now));
        }
        assert!((most - 0.05).abs() < 1e-9 && before.abs() < 1e-9, "{most} {before}");
    }

    #[test]
    fn boxes_hold_what_is_finer() {
        let field = field([None, Some(10.0)]);
        for spacing in [0.015, 0.02, 0.035, 0.04] {
            let bounds = field.bounds_of(spacing);
            let inside = (0..4000).map(|n| f64::from(n) * 1e-3);
            let last = inside.filter(|x| field.at(&[*x, 0.0]) < spacing).fold(0.0, f64::max);
            assert!(bounds.max[0] >= last && bounds.max[0] < last + 0.4, "{spacing} {last}");
            assert_eq!(bounds.max[1], f64::INFINITY);
        }
        assert!(field.bounds_of(0.005).min[0] > field.bounds_of(0.005).max[0]);
        assert_eq!(field.least_in(&Aabb::new([2.0, 2.0], [3.0, 3.0])), 0.04);
        assert_eq!(field.least_in(&Aabb::new([0.5, 0.0], [1.5, 1.0])), 0.01);
    }

    #[test]
    fn targets_repeat_with_the_box() {
        assert_eq!(field([Some(4.0), None]).at(&[3.6, 0.0]), 0.01);
        assert_eq!(field([None; 2]).at(&[3.6, 0.0]), 0.04);
    }
}
