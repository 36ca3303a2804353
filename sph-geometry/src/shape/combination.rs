//! Unions and differences.
//!
//! The minimum and maximum of signed distances have the right sign everywhere and never exceed the
//! distance to the surface of the combination: enough to skip points far from it.

use super::{Nearest, Shape, ShapeError};
use crate::aabb::Aabb;

/// What is in any of several shapes.
#[derive(Debug)]
pub struct Union<const D: usize>(Vec<Shape<D>>);

impl<const D: usize> Union<D> {
    pub fn new(shapes: Vec<Shape<D>>) -> Result<Self, ShapeError> {
        if shapes.is_empty() { Err(ShapeError::EmptyUnion) } else { Ok(Self(shapes)) }
    }

    pub fn shapes(&self) -> &[Shape<D>] {
        &self.0
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        self.0.iter().map(|shape| shape.signed_distance(x)).fold(f64::INFINITY, f64::min)
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let (first, others) = (&self.0[0], &self.0[1..]);
        others.iter().fold(first.nearest(x), |best, shape| {
            let other = shape.nearest(x);
            if other.distance < best.distance { other } else { best }
        })
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        self.0.iter().fold(Aabb::EMPTY, |all, shape| all.union(&shape.bounding_box()))
    }
}

/// What is in one shape and in none of several others.
#[derive(Debug)]
pub struct Difference<const D: usize> {
    first: Shape<D>,
    others: Vec<Shape<D>>,
}

impl<const D: usize> Difference<D> {
    pub fn new(first: Shape<D>, others: Vec<Shape<D>>) -> Self {
        Self { first, others }
    }

    pub fn shapes(&self) -> (&Shape<D>, &[Shape<D>]) {
        (&self.first, &self.others)
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        let outside = |shape: &Shape<D>| -shape.signed_distance(x);
        self.others.iter().map(outside).fold(self.first.signed_distance(x), f64::max)
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        self.others.iter().fold(self.first.nearest(x), |best, shape| {
            let other = shape.nearest(x);
            if -other.distance > best.distance {
                Nearest { distance: -other.distance, normal: other.normal.map(|n| -n) }
            } else {
                best
            }
        })
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        self.first.bounding_box()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring() {
        let disc = |radius| Shape::sphere([0.0, 0.0], radius).unwrap();
        let ring = Shape::difference(disc(2.0), vec![disc(1.0)]);
        assert!(ring.contains(&[1.5, 0.0]) && !ring.contains(&[0.5, 0.0]));
        assert!((ring.signed_distance(&[0.5, 0.0]) - 0.5).abs() < 1e-15);
        assert_eq!(ring.normal(&[1.2, 0.0]), [-1.0, 0.0]);
        assert_eq!(ring.normal(&[1.8, 0.0]), [1.0, 0.0]);
        let closest = ring.closest_point(&[0.0, 0.7]);
        assert!((closest[1] - 1.0).abs() < 1e-15);
        assert_eq!(ring.bounding_box(), Aabb::new([-2.0, -2.0], [2.0, 2.0]));
    }

    #[test]
    fn two_boxes() {
        let cuboid = |min: f64| Shape::cuboid([min, 0.0, 0.0], [min + 1.0, 1.0, 1.0]).unwrap();
        let both = Shape::union(vec![cuboid(0.0), cuboid(2.0)]).unwrap();
        assert!(both.contains(&[0.5; 3]) && both.contains(&[2.5, 0.5, 0.5]));
        assert_eq!(both.signed_distance(&[1.25, 0.5, 0.5]), 0.25);
        assert_eq!(both.normal(&[1.75, 0.5, 0.5]), [-1.0, 0.0, 0.0]);
        assert_eq!(both.bounding_box(), Aabb::new([0.0; 3], [3.0, 1.0, 1.0]));
        assert!(matches!(Shape::<2>::union(vec![]), Err(ShapeError::EmptyUnion)));
    }
}
