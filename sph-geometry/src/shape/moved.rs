//! Shapes that have been scaled, rotated and translated.

use super::{Kind, Nearest, Shape, ShapeError};
use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::vector::{add_scaled, dot, norm, scaled, sub};

/// A shape in turned axes: `x = R (s y) + b` for its points y, with R orthogonal.
#[derive(Debug)]
pub struct Moved<const D: usize> {
    /// The shape before it was moved at all, and how it was.
    original: (Shape<D>, Affine<D>),
    /// The shape in turned axes.
    inner: Shape<D>,
    /// Columns of R.
    axes: [[f64; D]; D],
    scale: f64,
    offset: [f64; D],
    bounds: Aabb<D>,
}

impl<const D: usize> Moved<D> {
    fn new(original: (Shape<D>, Affine<D>), inner: Shape<D>, scale: f64) -> Self {
        let map = original.1;
        let axes: [[f64; D]; D] = std::array::from_fn(|k| {
            let column = map.column(k);
            scaled(1.0 / norm(&column), &column)
        });
        let offset = map.offset();
        let inside = inner.bounding_box();
        let mut bounds = Aabb::new(offset, offset);
        for (axis, (min, max)) in axes.iter().zip(inside.min.iter().zip(inside.max)) {
            for (k, part) in axis.iter().enumerate() {
                // An endless side along an axis at right angles adds nothing.
                let reach = |x: f64| if *part == 0.0 { 0.0 } else { part * scale * x };
                bounds.min[k] += reach(*min).min(reach(max));
                bounds.max[k] += reach(*min).max(reach(max));
            }
        }
        Self { original, inner, axes, scale, offset, bounds }
    }

    fn local(&self, x: &[f64; D]) -> [f64; D] {
        let offset = sub(x, &self.offset);
        std::array::from_fn(|k| dot(&self.axes[k], &offset) / self.scale)
    }

    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        self.scale * self.inner.signed_distance(&self.local(x))
    }

    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let Nearest { distance, normal } = self.inner.nearest(&self.local(x));
        let turned = (0..D).fold([0.0; D], |sum, k| add_scaled(&sum, normal[k], &self.axes[k]));
        Nearest { distance: self.scale * distance, normal: turned }
    }

    pub fn bounding_box(&self) -> Aabb<D> {
        self.bounds
    }
}

impl<const D: usize> Shape<D> {
    /// The shape scaled, rotated and translated. Signed distance and normal stay as exact as they were.
    ///
    /// # Errors
    ///
    /// When the result is no shape that there is: balls, cylinders, capsules and custom shapes cannot
    /// have different scales along different axes, boxes only along their own sides.
    pub fn moved(&self, map: &Affine<D>) -> Result<Self, ShapeError> {
        let determinant = map.determinant();
        if !determinant.is_finite() || determinant == 0.0 {
            return Err(ShapeError::Flattened);
        }
        if map.is_identity() {
            return Ok(self.clone());
        }
        let uniform =
            |shape: &'static str| map.uniform_scale().ok_or(ShapeError::Stretched { shape });
        match &self.0 {
            Kind::Cuboid(cuboid) => self.moved_cuboid(&cuboid.bounding_box(), map),
            Kind::Ball(ball) => {
                let scale = uniform("sphere")?;
                Self::sphere(map.apply(&ball.center()), scale * ball.radius())
            }
            Kind::Cylinder(cylinder) => {
                let scale = uniform("cylinder")?;
                let [from, to] = cylinder.ends().map(|end| map.apply(&end));
                Self::cylinder(from, to, scale * cylinder.radius())
            }
            Kind::Capsule(capsule) => {
                let scale = uniform("capsule")?;
                let [from, to] = capsule.ends().map(|end| map.apply(&end));
                Self::capsule(from, to, scale * capsule.radius())
            }
            Kind::HalfSpace(half) => {
                Self::half_space(map.apply(&half.point()), map.apply_to_normal(&half.normal()))
            }
            Kind::Polygon(surface) => {
                let corners = surface.corners().map(|x| map.apply(&crate::vector::resized(&x)));
                Self::polygon(&corners.collect::<Vec<_>>())
            }
            Kind::Mesh(surface) => {
                let turned = determinant < 0.0;
                let mesh = surface
                    .mesh(|x| crate::vector::resized(&map.apply(&crate::vector::resized(&x))));
                Self::surface(&mesh, turned)
            }
            Kind::Sheet(sheet) => {
                let scale = uniform("sheet")?;
                let mesh =
                    sheet.mesh(|x| crate::vector::resized(&map.apply(&crate::vector::resized(&x))));
                Self::sheet(&mesh, scale * sheet.thickness())
            }
            Kind::Union(union) => {
                let parts = union.shapes().iter().map(|shape| shape.moved(map));
                Self::union(parts.collect::<Result<_, _>>()?)
            }
            Kind::Difference(difference) => {
                let (first, others) = difference.shapes();
                let others = others.iter().map(|shape| shape.moved(map));
                Ok(Self::difference(first.moved(map)?, others.collect::<Result<_, _>>()?))
            }
            Kind::Custom(_) => {
                let scale = uniform("shape of one's own")?;
                Ok(Self::of_moved(Moved::new((self.clone(), *map), self.clone(), scale)))
            }
            Kind::Moved(moved) => {
                let (shape, before) = &moved.original;
                shape.moved(&map.after(before))
            }
        }
    }

    fn moved_cuboid(&self, sides: &Aabb<D>, map: &Affine<D>) -> Result<Self, ShapeError> {
        if map.keeps_axes() {
            let corners = [map.apply(&sides.min), map.apply(&sides.max)];
            let Aabb { min, max } = Aabb::around(&corners);
            return Self::cuboid(min, max);
        }
        if !map.is_orthogonal() {
            return Err(ShapeError::Stretched { shape: "turned box" });
        }
        let scales: [f64; D] = std::array::from_fn(|k| norm(&map.column(k)));
        let [min, max] =
            [sides.min, sides.max].map(|corner| std::array::from_fn(|k| scales[k] * corner[k]));
        Ok(Self::of_moved(Moved::new((self.clone(), *map), Self::cuboid(min, max)?, 1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;
    use crate::vector::distance;
    use proptest::prelude::*;

    fn shapes() -> Vec<Shape<3>> {
        let cuboid = Shape::cuboid([-1.0, -0.5, 0.0], [1.0, 1.0, 2.0]).unwrap();
        let ball = Shape::sphere([0.3, 0.2, 0.1], 0.8).unwrap();
        vec![
            Shape::cylinder([0.0; 3], [1.0, 1.0, 0.5], 0.4).unwrap(),
            Shape::capsule([0.0; 3], [1.0, -1.0, 0.5], 0.4).unwrap(),
            Shape::half_space([0.1, 0.2, 0.3], [1.0, -2.0, 2.0]).unwrap(),
            Shape::mesh(&TriangleMesh::sphere([0.0; 3], 1.0, 1)).unwrap(),
            Shape::union(vec![cuboid.clone(), ball.clone()]).unwrap(),
            Shape::difference(cuboid.clone(), vec![ball.clone()]),
            cuboid,
            ball,
        ]
    }

    fn similarity() -> impl Strategy<Value = Affine<3>> {
        let vector = || prop::array::uniform3(-2.0..2.0_f64);
        (0.1..3.0_f64, prop::array::uniform3(0.1..1.0_f64), -200.0..200.0_f64, vector()).prop_map(
            |(scale, axis, degrees, offset)| {
                let turn = Affine::rotation(axis, degrees).unwrap();
                Affine::translation(offset).after(&turn).after(&Affine::scaling([scale; 3]))
            },
        )
    }

    proptest! {
        #[test]
        fn distances_and_normals_move_with_the_shape(
            map in similarity(),
            again in similarity(),
            x in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let both = again.after(&map);
            let scale = both.uniform_scale().unwrap();
            let y = both.apply(&x);
            for shape in shapes() {
                let moved = shape.moved(&map).unwrap().moved(&again).unwrap();
                let (before, after) = (shape.nearest(&x), moved.nearest(&y));
                prop_assert!(
                    (after.distance - scale * before.distance).abs() < 1e-10 * (1.0 + scale),
                    "{shape:?}: {} {}", after.distance, scale * before.distance
                );
                prop_assert!((moved.signed_distance(&y) - after.distance).abs() < 1e-12);
                let on = both.apply(&add_scaled(&x, -before.distance, &before.normal));
                let closest = moved.closest_point(&y);
                // Ties between equally near points may be decided differently.
                let tie = (distance(&y, &on) - distance(&y, &closest)).abs() < 1e-9 * (1.0 + scale);
                prop_assert!(distance(&on, &closest) < 1e-9 * (1.0 + scale) || tie);
                if after.distance < 0.0 {
                    prop_assert!(moved.bounding_box().inflated(1e-9).contains(&y), "{shape:?}");
                }
            }
        }
    }

    #[test]
    fn turned_boxes_have_tight_boxes_and_quarter_turns_stay_boxes() {
        let cuboid = Shape::cuboid([0.0, 0.0], [2.0, 1.0]).unwrap();
        let turn = |degrees| Affine::rotation([0.0, 0.0, 1.0], degrees).unwrap();
        let quarter = cuboid.moved(&turn(90.0)).unwrap();
        assert_eq!(quarter.bounding_box(), Aabb::new([-1.0, 0.0], [0.0, 2.0]));
        let half = cuboid.moved(&turn(45.0)).unwrap();
        let root = 0.5_f64.sqrt();
        for (found, exact) in [
            (half.bounding_box().min, [-root, 0.0]),
            (half.bounding_box().max, [2.0 * root, 3.0 * root]),
        ] {
            assert!(distance(&found, &exact) < 1e-12, "{found:?}");
        }
        assert!((half.signed_distance(&[-1.0, -1.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn scales_that_differ_are_for_boxes_planes_polygons_and_meshes() {
        let stretch = Affine::scaling([2.0, 3.0, -0.5]);
        for shape in shapes() {
            let moved = shape.moved(&stretch);
            let name = format!("{shape:?}");
            let round = ["Ball", "Cylinder", "Capsule"].iter().any(|kind| name.contains(kind));
            match moved {
                Err(ShapeError::Stretched { .. }) => assert!(round, "{name}"),
                Ok(moved) => {
                    assert!(!round, "{name}");
                    for x in [[0.2, 0.1, 0.3], [0.9, 0.9, 1.9], [3.0, 1.0, -2.0]] {
                        assert_eq!(
                            shape.contains(&x),
                            moved.contains(&stretch.apply(&x)),
                            "{name}"
                        );
                    }
                }
                Err(error) => panic!("{error}"),
            }
        }
        let turned = shapes()[6].moved(&Affine::rotation([0.0, 0.0, 1.0], 30.0).unwrap()).unwrap();
        assert!(matches!(turned.moved(&stretch), Err(ShapeError::Stretched { .. })));
        let flat = shapes()[6].moved(&Affine::scaling([1.0, 0.0, 1.0]));
        assert!(matches!(flat, Err(ShapeError::Flattened)));
    }
}
