//! Axis-parallel boxes.

/// An axis-parallel box. Sides may be infinite; a box with `min > max` is empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb<const D: usize> {
    /// Lowest corner.
    pub min: [f64; D],
    /// Highest corner.
    pub max: [f64; D],
}

impl<const D: usize> Aabb<D> {
    /// The box that contains nothing: the start of a union.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; D], max: [f64::NEG_INFINITY; D] };
    /// All of space.
    pub const EVERYWHERE: Self = Self { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] };

    /// The box between two corners.
    pub const fn new(min: [f64; D], max: [f64; D]) -> Self {
        Self { min, max }
    }

    /// The smallest box around points; empty without any.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |all, x| all.union(&Self::new(*x, *x)))
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    /// What is in both.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].max(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].min(other.max[k])),
        }
    }

    /// The box with every side moved out by `margin`.
    #[must_use]
    pub fn inflated(&self, margin: f64) -> Self {
        Self { min: self.min.map(|x| x - margin), max: self.max.map(|x| x + margin) }
    }

    /// Whether the box has no volume.
    pub fn is_empty(&self) -> bool {
        !(0..D).all(|k| self.min[k] < self.max[k])
    }

    /// Whether every side is finite.
    pub fn is_finite(&self) -> bool {
        self.min.iter().chain(&self.max).all(|x| x.is_finite())
    }

    /// Whether a point is inside or on the surface.
    pub fn contains(&self, x: &[f64; D]) -> bool {
        (0..D).all(|k| self.min[k] <= x[k] && x[k] <= self.max[k])
    }

    /// Distance to the surface in m, negative inside. Infinite sides are infinitely far.
    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        let mut outside = 0.0;
        let mut inside = f64::NEG_INFINITY;
        for ((x, min), max) in x.iter().zip(self.min).zip(self.max) {
            let beyond = (min - x).max(x - max);
            inside = inside.max(beyond);
            outside += beyond.max(0.0).powi(2);
        }
        if inside > 0.0 { outside.sqrt() } else { inside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_box() {
        let aabb = Aabb::new([0.0, 0.0], [4.0, 2.0]);
        assert_eq!(aabb.signed_distance(&[2.0, 0.5]), -0.5);
        assert_eq!(aabb.signed_distance(&[7.0, 6.0]), 5.0);
        assert_eq!(aabb.signed_distance(&[-1.0, 1.0]), 1.0);
        assert_eq!(aabb.signed_distance(&[4.0, 1.0]), 0.0);
    }

    #[test]
    fn boxes_without_sides() {
        assert_eq!(Aabb::<3>::EVERYWHERE.signed_distance(&[1.0; 3]), f64::NEG_INFINITY);
        assert!(Aabb::<3>::EMPTY.is_empty() && !Aabb::<3>::EVERYWHERE.is_empty());
        let half = Aabb::new([f64::NEG_INFINITY, 0.0], [f64::INFINITY, f64::INFINITY]);
        assert_eq!(half.signed_distance(&[1e9, 3.0]), -3.0);
        assert!(!half.is_finite());
    }

    #[test]
    fn union_and_intersection() {
        let a = Aabb::new([0.0, 0.0], [2.0, 2.0]);
        let b = Aabb::new([1.0, -1.0], [3.0, 1.0]);
        assert_eq!(a.union(&b), Aabb::new([0.0, -1.0], [3.0, 2.0]));
        assert_eq!(a.intersection(&b), Aabb::new([1.0, 0.0], [2.0, 1.0]));
        assert_eq!(Aabb::around(&[[1.0, 2.0], [0.0, 5.0]]), Aabb::new([0.0, 2.0], [1.0, 5.0]));
    }
}
