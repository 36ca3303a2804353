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
        self.spacing + (self.growth - 1.0) * (distance - self.within).max(0.0)
    }

    /// Distance from the target (m) at which it asks for a spacing.
    fn distance_of(&self, spacing: f64) -> f64 {
        self.within + ((spacing - self.spacing) / (self.growth - 1.0)).max(0.0)
    }
}

/// The spacing at every place: the smallest that any refinement asks for, and no more than the coarsest.
/// It grows linearly with the distance from what is refined, so that neighbours differ by a constant
/// factor.
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
                spacing = spacing.min(one.at_distance(distance));
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
                spacing = spacing.min(one.at_distance(distance.max(0.0)));
            });
        }
        spacing
    }

    /// A box that holds all places, between its periodic sides, where the spacing is smaller than this
    /// (m); empty when there is none.
    pub fn bounds_of(&self, spacing: f64) -> Aabb<D> {
        let mut bounds = Aabb::EMPTY;
        for one in self.refinements.iter().filter(|one| one.spacing < spacing) {
            let around = one.target.bounding_box().inflated(one.distance_of(spacing));
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
        for (x, spacing) in [(0.2, 0.01), (0.6, 0.01), (0.8, 0.02), (1.0, 0.03), (3.0, 0.04)] {
            assert!((field.at(&[x, 0.0]) - spacing).abs() < 1e-15, "{x}");
        }
        // The next particle is 5 % larger.
        let (here, there) = (field.at(&[0.8, 0.0]), field.at(&[0.82, 0.0]));
        assert!((there / here - 1.05).abs() < 1e-12);
    }

    #[test]
    fn boxes_hold_what_is_finer() {
        let field = field([None, Some(10.0)]);
        let bounds = field.bounds_of(0.02);
        assert!((bounds.max[0] - 0.8).abs() < 1e-12 && bounds.max[1] == f64::INFINITY);
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
