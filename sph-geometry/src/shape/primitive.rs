//! Primitives: shapes with a formula for the signed distance, in any dimension.

use super::Nearest;
use super::error::{ShapeError, finite, positive_radius};
use crate::aabb::Aabb;
use crate::vector::{add_scaled, axis, dot, norm, perpendicular, scaled, sub};

#[derive(Clone, Debug)]
pub struct Cuboid<const D: usize>(Aabb<D>);

impl<const D: usize> Cuboid<D> {
    pub fn new(min: [f64; D], max: [f64; D]) -> Result<Self, ShapeError> {
        finite("box", "lowest corner", &min)?;
        finite("box", "highest corner", &max)?;
        for ((axis, min), max) in ['x', 'y', 'z'].into_iter().zip(min).zip(max) {
            if min >= max {
                return Err(ShapeError::EmptyBox { axis, min, max });
            }
        }
        Ok(Self(Aabb::new(min, max)))
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        self.0.signed_distance(x)
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let distance = self.0.signed_distance(x);
        if distance > 0.0 {
            let beyond = std::array::from_fn(|k| x[k] - x[k].clamp(self.0.min[k], self.0.max[k]));
            return Nearest { distance, normal: scaled(1.0 / norm(&beyond), &beyond) };
        }
        let mut best = (f64::NEG_INFINITY, 0, true);
        for (k, x) in x.iter().enumerate() {
            for (beyond, positive) in [(self.0.min[k] - x, false), (x - self.0.max[k], true)] {
                if beyond > best.0 {
                    best = (beyond, k, positive);
                }
            }
        }
        Nearest { distance, normal: axis(best.1, best.2) }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        self.0
    }
}

#[derive(Clone, Debug)]
pub struct Ball<const D: usize> {
    center: [f64; D],
    radius: f64,
}

impl<const D: usize> Ball<D> {
    pub fn new(center: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        finite("sphere", "center", &center)?;
        positive_radius("sphere", radius)?;
        Ok(Self { center, radius })
    }

    pub fn center(&self) -> [f64; D] {
        self.center
    }

    pub fn radius(&self) -> f64 {
        self.radius
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        norm(&sub(x, &self.center)) - self.radius
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let offset = sub(x, &self.center);
        let length = norm(&offset);
        let normal = if length > 0.0 { scaled(1.0 / length, &offset) } else { axis(0, true) };
        Nearest { distance: length - self.radius, normal }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        Aabb::new(self.center, self.center).inflated(self.radius)
    }
}

/// A segment with a direction, the base of cylinder and capsule.
#[derive(Clone, Debug)]
struct Axis<const D: usize> {
    middle: [f64; D],
    /// Unit vector.
    along: [f64; D],
    half_length: f64,
}

impl<const D: usize> Axis<D> {
    fn new(shape: &'static str, from: [f64; D], to: [f64; D]) -> Result<Self, ShapeError> {
        finite(shape, "start", &from)?;
        finite(shape, "end", &to)?;
        let offset = sub(&to, &from);
        let length = norm(&offset);
        if length == 0.0 {
            return Err(ShapeError::NoLength { shape, point: from.to_vec() });
        }
        let middle = add_scaled(&from, 0.5, &offset);
        Ok(Self { middle, along: scaled(1.0 / length, &offset), half_length: 0.5 * length })
    }

    /// Coordinate along the axis from its middle, and the vector from the axis to the point.
    fn split(&self, x: &[f64; D]) -> (f64, [f64; D]) {
        let offset = sub(x, &self.middle);
        let height = dot(&offset, &self.along);
        (height, add_scaled(&offset, -height, &self.along))
    }

    /// Unit vector away from the axis.
    fn radial(&self, across: &[f64; D]) -> [f64; D] {
        let length = norm(across);
        if length > 0.0 { scaled(1.0 / length, across) } else { perpendicular(&self.along) }
    }

    fn ends(&self) -> [[f64; D]; 2] {
        [-1.0, 1.0].map(|s| add_scaled(&self.middle, s * self.half_length, &self.along))
    }
}

#[derive(Clone, Debug)]
pub struct Cylinder<const D: usize> {
    axis: Axis<D>,
    radius: f64,
}

impl<const D: usize> Cylinder<D> {
    pub fn new(from: [f64; D], to: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        let axis = Axis::new("cylinder", from, to)?;
        positive_radius("cylinder", radius)?;
        Ok(Self { axis, radius })
    }

    pub fn ends(&self) -> [[f64; D]; 2] {
        self.axis.ends()
    }

    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// A cylinder is a rectangle in the plane of distance from the axis and height.
    fn profile(&self) -> Aabb<2> {
        let Self { axis, radius } = self;
        Aabb::new([-radius, -axis.half_length], [*radius, axis.half_length])
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        let (height, across) = self.axis.split(x);
        self.profile().signed_distance(&[norm(&across), height])
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let (height, across) = self.axis.split(x);
        let Nearest { distance, normal: [out, up] } =
            Cuboid(self.profile()).nearest(&[norm(&across), height]);
        let normal = add_scaled(&scaled(out, &self.axis.radial(&across)), up, &self.axis.along);
        Nearest { distance, normal }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        let mut aabb = Aabb::around(&self.axis.ends());
        for k in 0..D {
            // The end discs reach this far: the part of e_k at right angles to the axis.
            let reach = self.radius * (1.0 - self.axis.along[k].powi(2)).max(0.0).sqrt();
            aabb.min[k] -= reach;
            aabb.max[k] += reach;
        }
        aabb
    }
}

#[derive(Clone, Debug)]
pub struct Capsule<const D: usize> {
    axis: Axis<D>,
    radius: f64,
}

impl<const D: usize> Capsule<D> {
    pub fn new(from: [f64; D], to: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        let axis = Axis::new("capsule", from, to)?;
        positive_radius("capsule", radius)?;
        Ok(Self { axis, radius })
    }

    pub fn ends(&self) -> [[f64; D]; 2] {
        self.axis.ends()
    }

    pub fn radius(&self) -> f64 {
        self.radius
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        self.nearest(x).distance
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let (height, across) = self.axis.split(x);
        let beyond = height - height.clamp(-self.axis.half_length, self.axis.half_length);
        let offset = add_scaled(&across, beyond, &self.axis.along);
        let length = norm(&offset);
        let normal = if length > 0.0 {
            scaled(1.0 / length, &offset)
        } else {
            perpendicular(&self.axis.along)
        };
        Nearest { distance: length - self.radius, normal }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        Aabb::around(&self.axis.ends()).inflated(self.radius)
    }
}

#[derive(Clone, Debug)]
pub struct HalfSpace<const D: usize> {
    point: [f64; D],
    /// Unit vector.
    normal: [f64; D],
}

impl<const D: usize> HalfSpace<D> {
    pub fn new(point: [f64; D], normal: [f64; D]) -> Result<Self, ShapeError> {
        finite("half space", "point", &point)?;
        finite("half space", "normal", &normal)?;
        let length = norm(&normal);
        if length == 0.0 {
            return Err(ShapeError::NoDirection);
        }
        Ok(Self { point, normal: scaled(1.0 / length, &normal) })
    }

    pub fn point(&self) -> [f64; D] {
        self.point
    }

    pub fn normal(&self) -> [f64; D] {
        self.normal
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        dot(&sub(x, &self.point), &self.normal)
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        Nearest { distance: self.signed_distance(x), normal: self.normal }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        let mut aabb = Aabb::EVERYWHERE;
        for k in 0..D {
            if self.normal == axis(k, true) {
                aabb.max[k] = self.point[k];
            } else if self.normal == axis(k, false) {
                aabb.min[k] = self.point[k];
            }
        }
        aabb
    }
}

#[cfg(test)]
mod tests {
    use super::super::Shape;
    use super::*;
    use crate::vector::distance;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(-3.0..3.0)
    }

    /// Shapes with a finite surface, and points spread evenly over that surface.
    fn shapes() -> Vec<(Shape<3>, Vec<[f64; 3]>)> {
        let n = 120;
        let unit = |i: usize| i as f64 / (n - 1) as f64;
        let mut cuboid = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (unit(i), unit(j)))) {
            for k in 0..3 {
                for side in [0.0, 1.0] {
                    let mut u = [side; 3];
                    u[(k + 1) % 3] = i;
                    u[(k + 2) % 3] = j;
                    cuboid.push([-1.0 + 2.0 * u[0], -0.5 + 1.5 * u[1], 2.0 * u[2]]);
                }
            }
        }
        // Around the axis z from −1 to 1, radius 0.5, then turned so that z is (0, 0.6, 0.8).
        let turn = |[x, y, z]: [f64; 3]| [x, 0.8 * y + 0.6 * z, -0.6 * y + 0.8 * z];
        let round = |a: f64, r: f64| (r * a.cos(), r * a.sin());
        let mut cylinder = Vec::new();
        let mut capsule = Vec::new();
        let mut ball = Vec::new();
        for (i, j) in
            (0..2 * n).flat_map(|i| (0..n).map(move |j| (i as f64 / (2 * n) as f64, unit(j))))
        {
            let angle = i * std::f64::consts::TAU;
            let (x, y) = round(angle, 0.5);
            cylinder.push(turn([x, y, 2.0 * j - 1.0]));
            capsule.push(turn([x, y, 2.0 * j - 1.0]));
            let (x, y) = round(angle, 0.5 * j);
            cylinder.extend([turn([x, y, 1.0]), turn([x, y, -1.0])]);
            let polar = j * std::f64::consts::PI;
            let (x, y) = round(angle, polar.sin());
            let z = polar.cos();
            ball.push([x, y, z]);
            capsule.push(turn([0.5 * x, 0.5 * y, 0.5 * z + 1.0f64.copysign(z)]));
        }
        let (from, to) = (turn([0.0, 0.0, -1.0]), turn([0.0, 0.0, 1.0]));
        vec![
            (Shape::cuboid([-1.0, -0.5, 0.0], [1.0, 1.0, 2.0]).unwrap(), cuboid),
            (Shape::sphere([0.0; 3], 1.0).unwrap(), ball),
            (Shape::cylinder(from, to, 0.5).unwrap(), cylinder),
            (Shape::capsule(from, to, 0.5).unwrap(), capsule),
        ]
    }

    #[test]
    fn distances_agree_with_points_of_the_surface() {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        for (shape, surface) in shapes() {
            runner
                .run(&point(), |x| {
                    let brute =
                        surface.iter().map(|y| distance(&x, y)).fold(f64::INFINITY, f64::min);
                    let found = shape.signed_distance(&x);
                    // The samples are at most 0.03 apart.
                    prop_assert!(found.abs() <= brute + 1e-12, "{shape:?} {found} {brute}");
                    prop_assert!(
                        brute <= (found * found + 0.03 * 0.03).sqrt(),
                        "{shape:?} {found} {brute}"
                    );
                    Ok(())
                })
                .unwrap();
        }
    }

    #[test]
    fn samples_of_the_surface_are_on_it_and_in_the_box() {
        for (shape, surface) in shapes() {
            let around = Aabb::around(&surface);
            let aabb = shape.bounding_box();
            for k in 0..3 {
                assert!((around.min[k] - aabb.min[k]).abs() < 1e-2, "{shape:?}");
                assert!((around.max[k] - aabb.max[k]).abs() < 1e-2, "{shape:?}");
            }
            for x in surface.iter().step_by(7) {
                assert!(shape.signed_distance(x).abs() < 1e-12, "{shape:?} {x:?}");
                assert!(aabb.inflated(1e-12).contains(x));
            }
        }
    }

    proptest! {
        #[test]
        fn the_normal_leads_to_the_surface(x in point()) {
            let half = Shape::half_space([0.1, 0.2, 0.3], [1.0, -2.0, 2.0]).unwrap();
            for shape in shapes().into_iter().map(|(shape, _)| shape).chain([half]) {
                let nearest = shape.nearest(&x);
                prop_assert!((norm(&nearest.normal) - 1.0).abs() < 1e-12);
                prop_assert!((nearest.distance - shape.signed_distance(&x)).abs() < 1e-15);
                let closest = shape.closest_point(&x);
                prop_assert!(shape.signed_distance(&closest).abs() < 1e-12, "{:?} {:?}", shape, x);
                let out = add_scaled(&closest, 1e-3, &nearest.normal);
                prop_assert!(!shape.contains(&out), "{:?} {:?}", shape, x);
            }
        }
    }

    #[test]
    fn normals_exist_on_axes_and_centres() {
        for (shape, _) in shapes() {
            for x in [[0.0; 3], [0.0, 0.6, 0.8], [0.0, 0.25, 1.0]] {
                let normal = shape.normal(&x);
                assert!((norm(&normal) - 1.0).abs() < 1e-12, "{shape:?} {x:?} {normal:?}");
            }
        }
    }

    #[test]
    fn signs_inside_and_outside() {
        for (shape, _) in shapes() {
            assert!(shape.contains(&[0.0, 0.0, 0.25]), "{shape:?}");
            assert!(!shape.contains(&[0.0, 0.0, -1.2]), "{shape:?}");
        }
        let floor = Shape::half_space([5.0, 0.0], [0.0, 3.0]).unwrap();
        assert_eq!(floor.signed_distance(&[-9.0, -0.5]), -0.5);
        assert_eq!(floor.bounding_box().max, [f64::INFINITY, 0.0]);
    }

    #[test]
    fn shapes_that_do_not_exist() {
        let error = |shape: Result<Shape<2>, ShapeError>| shape.unwrap_err();
        let box_ = error(Shape::cuboid([0.0, 1.0], [1.0, 1.0]));
        assert!(matches!(box_, ShapeError::EmptyBox { axis: 'y', .. }));
        assert!(matches!(error(Shape::sphere([0.0; 2], -1.0)), ShapeError::Radius { .. }));
        assert!(matches!(error(Shape::sphere([f64::NAN; 2], 1.0)), ShapeError::NotFinite { .. }));
        assert!(matches!(
            error(Shape::capsule([1.0; 2], [1.0; 2], 1.0)),
            ShapeError::NoLength { .. }
        ));
        assert!(matches!(error(Shape::half_space([1.0; 2], [0.0; 2])), ShapeError::NoDirection));
    }
}
