//! Shapes: sets of points with a signed distance.

mod combination;
mod error;
mod mesh_surface;
mod moved;
mod polygon_surface;
mod primitive;
mod sheet;

pub use error::ShapeError;

use crate::aabb::Aabb;
use crate::mesh::{Bodies, MeshError, TriangleMesh, bodies};
use crate::vector::{add_scaled, resized};
use combination::{Difference, Union};
pub(crate) use mesh_surface::MeshSurface;
use moved::Moved;
use polygon_surface::PolygonSurface;
use primitive::{Ball, Capsule, Cuboid, Cylinder, HalfSpace};
use sheet::Sheet;
use std::sync::Arc;

/// A set of points in D dimensions: a primitive, what a closed surface bounds, or a combination.
/// Cheap to clone.
///
/// Its signed distance is negative inside. It is exact for all but combinations: there the sign is
/// exact, and the true surface is at least as far away as the distance says.
#[derive(Clone, Debug)]
pub struct Shape<const D: usize>(Kind<D>);

#[derive(Clone, Debug)]
enum Kind<const D: usize> {
    Cuboid(Cuboid<D>),
    Ball(Ball<D>),
    Cylinder(Cylinder<D>),
    Capsule(Capsule<D>),
    HalfSpace(HalfSpace<D>),
    /// Only for D = 2: `polygon` makes no other.
    Polygon(Arc<PolygonSurface>),
    /// Only for D = 3: `mesh` makes no other.
    Mesh(Arc<MeshSurface>),
    /// Only for D = 3: `sheet` makes no other.
    Sheet(Arc<Sheet>),
    Union(Arc<Union<D>>),
    Difference(Arc<Difference<D>>),
    Custom(Arc<dyn SignedDistance<D>>),
    Moved(Arc<Moved<D>>),
}

/// A set of points that a program defines itself; becomes a shape by [`Shape::custom`].
pub trait SignedDistance<const D: usize>: std::fmt::Debug + Send + Sync {
    /// Distance to the surface in m, negative inside, and the unit vector out of the set: the
    /// gradient of the distance. The sign must be right everywhere and the distance at most the
    /// true one, as points that it skips are never looked at.
    fn nearest(&self, x: &[f64; D]) -> Nearest<D>;

    /// A box around the set, infinite where the set is.
    fn bounding_box(&self) -> Aabb<D>;

    /// The distance alone, for those who have it for less.
    fn signed_distance(&self, x: &[f64; D]) -> f64 {
        self.nearest(x).distance
    }
}

/// How far a surface is, and in which direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest<const D: usize> {
    /// Signed distance in m, negative inside.
    pub distance: f64,
    /// Unit vector out of the shape: the gradient of the signed distance. Where several points of
    /// the surface are equally near, that of one of them.
    pub normal: [f64; D],
}

/// Runs the same code for every kind; surfaces take and give arrays of their own dimension.
macro_rules! each_kind {
    ($shape:expr, $one:ident => $plain:expr, $surface:ident => $resized:expr) => {
        match &$shape.0 {
            Kind::Cuboid($one) => $plain,
            Kind::Ball($one) => $plain,
            Kind::Cylinder($one) => $plain,
            Kind::Capsule($one) => $plain,
            Kind::HalfSpace($one) => $plain,
            Kind::Union($one) => $plain,
            Kind::Difference($one) => $plain,
            Kind::Custom($one) => $plain,
            Kind::Moved($one) => $plain,
            Kind::Polygon($surface) => $resized,
            Kind::Mesh($surface) => $resized,
            Kind::Sheet($surface) => $resized,
        }
    };
}

impl<const D: usize> Shape<D> {
    /// An axis-parallel box: a rectangle in two dimensions.
    pub fn cuboid(min: [f64; D], max: [f64; D]) -> Result<Self, ShapeError> {
        Cuboid::new(min, max).map(|shape| Self(Kind::Cuboid(shape)))
    }

    /// A ball: a disc in two dimensions.
    pub fn sphere(center: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        Ball::new(center, radius).map(|shape| Self(Kind::Ball(shape)))
    }

    /// A cylinder with flat ends: a rotated rectangle in two dimensions.
    pub fn cylinder(from: [f64; D], to: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        Cylinder::new(from, to, radius).map(|shape| Self(Kind::Cylinder(shape)))
    }

    /// All points closer than `radius` to a segment.
    pub fn capsule(from: [f64; D], to: [f64; D], radius: f64) -> Result<Self, ShapeError> {
        Capsule::new(from, to, radius).map(|shape| Self(Kind::Capsule(shape)))
    }

    /// The half space behind a plane (a line in two dimensions): `normal`, of any length, points
    /// out of it.
    pub fn half_space(point: [f64; D], normal: [f64; D]) -> Result<Self, ShapeError> {
        HalfSpace::new(point, normal).map(|shape| Self(Kind::HalfSpace(shape)))
    }

    /// The inside of a simple polygon, with corners in either direction; two dimensions only.
    pub fn polygon(corners: &[[f64; D]]) -> Result<Self, ShapeError> {
        if D != 2 {
            return Err(ShapeError::Dimension { shape: "polygon", needed: 2, found: D });
        }
        let corners: Vec<[f64; 2]> = corners.iter().map(resized).collect();
        PolygonSurface::new(&corners).map(|shape| Self(Kind::Polygon(Arc::new(shape))))
    }

    /// The inside of a closed, consistently oriented surface; three dimensions only. Its shells are
    /// oriented by their nesting, and bodies that overlap are united, as [`bodies`](crate::bodies)
    /// says.
    pub fn mesh(mesh: &TriangleMesh) -> Result<Self, ShapeError> {
        Self::bodies(&bodies(mesh)?)
    }

    /// The bodies of a mesh; three dimensions only. The distance is exact where no bodies overlap.
    pub fn bodies(bodies: &Bodies) -> Result<Self, ShapeError> {
        if D != 3 {
            return Err(ShapeError::Dimension { shape: "mesh", needed: 3, found: D });
        }
        let surfaces = bodies.surfaces.iter().map(|mesh| Self::surface(mesh, false));
        let mut shapes = surfaces.collect::<Result<Vec<_>, _>>()?;
        match shapes.pop() {
            Some(only) if shapes.is_empty() => Ok(only),
            Some(last) => {
                shapes.push(last);
                Self::union(shapes)
            }
            None => Err(MeshError::Empty.into()),
        }
    }

    /// All points closer than half a thickness (m) to a surface, which may have holes; three
    /// dimensions only.
    pub fn sheet(mesh: &TriangleMesh, thickness: f64) -> Result<Self, ShapeError> {
        if D != 3 {
            return Err(ShapeError::Dimension { shape: "mesh", needed: 3, found: D });
        }
        if !thickness.is_finite() || thickness <= 0.0 {
            return Err(ShapeError::Thickness { thickness });
        }
        Ok(Self(Kind::Sheet(Arc::new(Sheet::new(mesh, thickness)?))))
    }

    /// The inside of a closed surface whose shells do not meet.
    fn surface(mesh: &TriangleMesh, turned: bool) -> Result<Self, ShapeError> {
        let surface = MeshSurface::closed(mesh, turned, mesh.bounding_box())?;
        Ok(Self(Kind::Mesh(Arc::new(surface))))
    }

    fn of_moved(moved: Moved<D>) -> Self {
        Self(Kind::Moved(Arc::new(moved)))
    }

    /// What is in any of the shapes.
    pub fn union(shapes: Vec<Self>) -> Result<Self, ShapeError> {
        Union::new(shapes).map(|shape| Self(Kind::Union(Arc::new(shape))))
    }

    /// What is in `first` and in none of the others.
    pub fn difference(first: Self, others: Vec<Self>) -> Self {
        Self(Kind::Difference(Arc::new(Difference::new(first, others))))
    }

    /// A set of points with a signed distance of one's own.
    pub fn custom(shape: impl SignedDistance<D> + 'static) -> Self {
        Self(Kind::Custom(Arc::new(shape)))
    }

    /// Distance to the surface in m, negative inside.
    pub fn signed_distance(&self, x: &[f64; D]) -> f64 {
        each_kind!(self,
            shape => shape.signed_distance(x),
            surface => surface.signed_distance(&resized(x)))
    }

    /// Distance and direction of the surface.
    pub fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        each_kind!(self,
        shape => shape.nearest(x),
        surface => {
            let Nearest { distance, normal } = surface.nearest(&resized(x));
            Nearest { distance, normal: resized(&normal) }
        })
    }

    /// Unit vector out of the shape at the nearest point of the surface.
    pub fn normal(&self, x: &[f64; D]) -> [f64; D] {
        self.nearest(x).normal
    }

    /// The nearest point of the surface. For combinations, a point on the way to it.
    pub fn closest_point(&self, x: &[f64; D]) -> [f64; D] {
        let nearest = self.nearest(x);
        add_scaled(x, -nearest.distance, &nearest.normal)
    }

    /// Whether a point is inside. Points on the surface, up to rounding, may be either.
    pub fn contains(&self, x: &[f64; D]) -> bool {
        self.signed_distance(x) < 0.0
    }

    /// A box around the shape, infinite where the shape is.
    pub fn bounding_box(&self) -> Aabb<D> {
        each_kind!(self,
        shape => shape.bounding_box(),
        surface => {
            let Aabb { min, max } = surface.bounding_box();
            Aabb::new(resized(&min), resized(&max))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{norm, scaled};

    /// The points below the cone z = |(x, y)|.
    #[derive(Debug)]
    struct Cone;

    impl SignedDistance<3> for Cone {
        fn nearest(&self, x: &[f64; 3]) -> Nearest<3> {
            let across = [x[0], x[1], 0.0];
            let radius = norm(&across).max(1e-300);
            let [out, up] = [-0.5_f64.sqrt(), 0.5_f64.sqrt()];
            let mut normal = scaled(out / radius, &across);
            normal[2] = up;
            Nearest { distance: up * (x[2] - radius), normal }
        }

        fn bounding_box(&self) -> Aabb<3> {
            Aabb::EVERYWHERE
        }
    }

    #[test]
    fn a_shape_of_ones_own_combines_with_the_others() {
        let below = Shape::custom(Cone);
        let cut = Shape::difference(Shape::cuboid([-1.0; 3], [1.0; 3]).unwrap(), vec![below]);
        assert!(cut.contains(&[0.0, 0.0, 0.5]) && !cut.contains(&[0.5, 0.0, 0.2]));
        assert!((cut.signed_distance(&[0.5, 0.0, 0.2]) - 0.3 * 0.5_f64.sqrt()).abs() < 1e-15);
        let closest = cut.closest_point(&[0.5, 0.0, 0.2]);
        assert!((closest[0] - 0.35).abs() < 1e-15 && (closest[2] - 0.35).abs() < 1e-15);
        assert_eq!(cut.bounding_box(), Aabb::new([-1.0; 3], [1.0; 3]));
    }

    #[test]
    fn surfaces_exist_in_their_own_dimension_only() {
        let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let error = Shape::polygon(&triangle).unwrap_err();
        assert!(matches!(error, ShapeError::Dimension { needed: 2, found: 3, .. }));
        let mesh = TriangleMesh::cuboid([0.0; 3], [1.0; 3]);
        let error = Shape::<2>::mesh(&mesh).unwrap_err();
        assert!(matches!(error, ShapeError::Dimension { needed: 3, found: 2, .. }));
    }
}
