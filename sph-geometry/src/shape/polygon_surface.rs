//! The inside of a simple polygon, through parry.
//!
//! The nearest point comes from parry's bounding volume hierarchy over the edges; the sign from
//! the outward normal of the edge there, or from the bisector of both edges at a corner.

use super::error::finite;
use super::{Nearest, ShapeError};
use crate::aabb::Aabb;
use crate::vector::{distance, norm, scaled, sub};
use parry2d_f64::math::Vector;
use parry2d_f64::query::PointQueryWithLocation;
use parry2d_f64::shape::{Polyline, PolylineFlags};

pub struct PolygonSurface {
    edges: Polyline,
    aabb: Aabb<2>,
}

impl std::fmt::Debug for PolygonSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "polygon of {} corners in {:?}", self.edges.num_segments(), self.aabb)
    }
}

impl PolygonSurface {
    pub fn new(corners: &[[f64; 2]]) -> Result<Self, ShapeError> {
        for corner in corners {
            finite("polygon", "corner", corner)?;
        }
        let mut corners = corners.to_vec();
        corners.dedup();
        // Some give the first corner again at the end.
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let count = corners.len();
        if count < 3 {
            return Err(ShapeError::FewCorners { count });
        }
        let area = area(&corners);
        let aabb = Aabb::around(&corners);
        if area.abs() <= 1e-14 * distance(&aabb.min, &aabb.max).powi(2) {
            return Err(ShapeError::NoArea);
        }
        simple(&corners)?;
        if area < 0.0 {
            corners.reverse();
        }
        let vertices = corners.iter().map(|x| Vector::from_array(*x)).collect();
        let count = count as u32;
        let edges = (0..count).map(|i| [i, (i + 1) % count]).collect();
        let edges = Polyline::with_flags(vertices, Some(edges), PolylineFlags::ORIENTED);
        Ok(Self { edges, aabb })
    }

    /// Its corners in order.
    pub fn corners(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.edges.vertices().iter().map(Vector::to_array)
    }

    fn project(&self, x: &[f64; 2]) -> ([f64; 2], bool, u32) {
        let (projection, (edge, _)) =
            self.edges.project_local_point_and_get_location(Vector::from_array(*x), false);
        let inside = projection.is_inside && self.aabb.contains(x);
        (projection.point.to_array(), inside, edge)
    }

    pub fn signed_distance(&self, x: &[f64; 2]) -> f64 {
        let (point, inside, _) = self.project(x);
        let distance = distance(x, &point);
        if inside { -distance } else { distance }
    }

    pub fn nearest(&self, x: &[f64; 2]) -> Nearest<2> {
        let (point, inside, edge) = self.project(x);
        let offset = sub(x, &point);
        let length = norm(&offset);
        let distance = if inside { -length } else { length };
        // On the surface the offset is rounding and has no direction.
        let scale = self.aabb.max.iter().chain(&self.aabb.min).fold(0.0_f64, |s, x| s.max(x.abs()));
        let normal = if length > 1e-12 * scale {
            scaled(1.0 / distance, &offset)
        } else {
            let segment = self.edges.segment(edge);
            let [x, y] = (segment.b - segment.a).to_array();
            scaled(1.0 / norm(&[x, y]), &[y, -x])
        };
        Nearest { distance, normal }
    }

    pub fn bounding_box(&self) -> Aabb<2> {
        self.aabb
    }
}

fn perp(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Positive when the corners run counter-clockwise.
fn area(corners: &[[f64; 2]]) -> f64 {
    let from = |x| sub(x, &corners[0]);
    0.5 * corners.windows(2).map(|pair| perp(&from(&pair[0]), &from(&pair[1]))).sum::<f64>()
}

/// No two edges meet, save neighbours in their common corner.
fn simple(corners: &[[f64; 2]]) -> Result<(), ShapeError> {
    let count = corners.len();
    let edge = |i: usize| [corners[i], corners[(i + 1) % count]];
    let low = |i: usize| edge(i)[0][0].min(edge(i)[1][0]);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)));
    for (place, &i) in order.iter().enumerate() {
        let high = edge(i)[0][0].max(edge(i)[1][0]);
        for &j in order[place + 1..].iter().take_while(|&&j| low(j) <= high) {
            let (first, second) = (i.min(j), i.max(j));
            if let Some(place) = meeting(first, second, count, edge) {
                return Err(ShapeError::Crossing { first, second, place });
            }
        }
    }
    Ok(())
}

/// Where the edges after two corners meet, if they do so in another point than a common corner.
fn meeting(
    first: usize,
    second: usize,
    count: usize,
    edge: impl Fn(usize) -> [[f64; 2]; 2],
) -> Option<[f64; 2]> {
    let neighbors = second == first + 1 || (first == 0 && second == count - 1);
    if neighbors {
        // They meet elsewhere only if one runs back over the other.
        let [before, after] = if second == first + 1 { [first, second] } else { [second, first] };
        let ([a, b], [_, c]) = (edge(before), edge(after));
        let (back, on) = (sub(&a, &b), sub(&c, &b));
        let along = back[0] * on[0] + back[1] * on[1];
        return (perp(&back, &on) == 0.0 && along > 0.0).then_some(b);
    }
    let ([a, b], [c, d]) = (edge(first), edge(second));
    let side = |p: &[f64; 2], q: &[f64; 2], x: &[f64; 2]| perp(&sub(q, p), &sub(x, p));
    let [a_side, b_side] = [side(&c, &d, &a), side(&c, &d, &b)];
    let [c_side, d_side] = [side(&a, &b, &c), side(&a, &b, &d)];
    if a_side * b_side > 0.0 || c_side * d_side > 0.0 {
        return None;
    }
    let boxes = Aabb::around(&[a, b]).intersection(&Aabb::around(&[c, d]));
    (0..2).all(|k| boxes.min[k] <= boxes.max[k]).then_some(boxes.min)
}

#[cfg(test)]
mod tests {
    use super::super::Shape;
    use super::*;
    use proptest::prelude::*;

    /// Even-odd rule and distance to every edge.
    fn brute(corners: &[[f64; 2]], x: &[f64; 2]) -> f64 {
        let mut inside = false;
        let mut least = f64::INFINITY;
        for i in 0..corners.len() {
            let [a, b] = [corners[i], corners[(i + 1) % corners.len()]];
            let ab = sub(&b, &a);
            let s = (crate::vector::dot(&sub(x, &a), &ab) / crate::vector::dot(&ab, &ab))
                .clamp(0.0, 1.0);
            least = least.min(distance(x, &crate::vector::add_scaled(&a, s, &ab)));
            if (a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / ab[1] * ab[0] {
                inside = !inside;
            }
        }
        if inside { -least } else { least }
    }

    proptest! {
        #[test]
        fn stars_agree_with_brute_force(
            radii in prop::collection::vec(0.1..2.0, 3..40),
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0), 50),
            clockwise in any::<bool>(),
        ) {
            // The centre is inside the hull of three corners or more, so the star is simple.
            let step = std::f64::consts::TAU / radii.len() as f64;
            let mut corners: Vec<[f64; 2]> = radii
                .iter()
                .enumerate()
                .map(|(i, r)| { let a = step * i as f64; [r * a.cos(), r * a.sin()] })
                .collect();
            if clockwise {
                corners.reverse();
            }
            let shape = Shape::polygon(&corners).unwrap();
            for x in &points {
                let expected = brute(&corners, x);
                prop_assert!((shape.signed_distance(x) - expected).abs() < 1e-12);
                let nearest = shape.nearest(x);
                prop_assert!((nearest.distance - expected).abs() < 1e-12);
                prop_assert!(shape.signed_distance(&shape.closest_point(x)).abs() < 1e-12);
            }
            for x in &corners {
                prop_assert!(shape.signed_distance(x).abs() < 1e-12);
                // Close to corners, sharp or not, on either side.
                for i in 0..8 {
                    let a = f64::from(i) * 0.785;
                    let x = [x[0] + 1e-5 * a.cos(), x[1] + 1e-5 * a.sin()];
                    prop_assert!((shape.signed_distance(&x) - brute(&corners, &x)).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn polygons_that_do_not_exist() {
        let error = |corners: &[[f64; 2]]| Shape::polygon(corners).unwrap_err();
        assert!(matches!(error(&[[0.0, 0.0], [1.0, 0.0]]), ShapeError::FewCorners { count: 2 }));
        let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        assert!(matches!(error(&line), ShapeError::NoArea));
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 2.0]];
        assert!(matches!(error(&bow), ShapeError::Crossing { first: 0, second: 2, .. }));
        let touching = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 0.0], [0.0, 3.0]];
        assert!(matches!(error(&touching), ShapeError::Crossing { .. }));
        let spike = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [2.0, 1.0], [0.0, 2.0]];
        assert!(matches!(error(&spike), ShapeError::Crossing { .. }));
        let infinite = [[0.0, 0.0], [f64::INFINITY, 0.0], [0.0, 1.0]];
        assert!(matches!(error(&infinite), ShapeError::NotFinite { .. }));
    }

    #[test]
    fn repeated_corners_are_one() {
        let square = [[0.0, 0.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
        let shape = Shape::polygon(&square).unwrap();
        assert_eq!(shape.signed_distance(&[1.0, 0.5]), -0.5);
        assert_eq!(shape.normal(&[1.0, 0.0]), [0.0, -1.0]);
        assert_eq!(shape.bounding_box(), Aabb::new([0.0, 0.0], [2.0, 2.0]));
    }
}
