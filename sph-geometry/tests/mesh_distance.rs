//! Signed distances to meshes against brute force: the distance to every triangle, and the sign by
//! the winding number (A. van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE
//! Trans. Biomed. Eng. 30 (1983) 125–126, doi:10.1109/TBME.1983.325207).

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use sph_geometry::{Lattice, Shape, TriangleMesh, check, near_surface};

type V = Vector3<f64>;

fn to_segment(x: V, a: V, b: V) -> f64 {
    let s = ((x - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
    (x - a - (b - a) * s).norm()
}

fn to_triangle(x: V, [a, b, c]: [V; 3]) -> f64 {
    let rim = to_segment(x, a, b).min(to_segment(x, b, c)).min(to_segment(x, c, a));
    let n = (b - a).cross(&(c - a)).normalize();
    let p = x - n * n.dot(&(x - a));
    let side = |a: V, b: V| (b - a).cross(&(p - a)).dot(&n) >= 0.0;
    if side(a, b) && side(b, c) && side(c, a) { rim.min(n.dot(&(x - a)).abs()) } else { rim }
}

/// Solid angle of the mesh over 4π: 1 inside, 0 outside.
fn winding(mesh: &TriangleMesh, x: V) -> f64 {
    let angle = |[a, b, c]: [V; 3]| {
        let [a, b, c] = [a - x, b - x, c - x];
        let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        2.0 * a.dot(&b.cross(&c)).atan2(below)
    };
    triangles(mesh).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

fn triangles(mesh: &TriangleMesh) -> impl Iterator<Item = [V; 3]> + '_ {
    (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle).map(V::from))
}

fn brute(mesh: &TriangleMesh, x: [f64; 3]) -> f64 {
    let x = V::from(x);
    let distance = triangles(mesh).map(|t| to_triangle(x, t)).fold(f64::INFINITY, f64::min);
    if winding(mesh, x).abs() > 0.5 { -distance } else { distance }
}

/// A box without a corner: with edges and vertices that are concave, convex and both.
fn notched_box() -> TriangleMesh {
    let mut corners = Vec::new();
    let mut quad = |a: V, b: V, c: V, d: V| {
        corners.extend([[a, b, c], [a, c, d]].map(|t| t.map(<[f64; 3]>::from)));
    };
    // Unit squares of the surface of seven of eight unit cubes.
    let filled = |i: [i32; 3]| i.iter().all(|k| (0..2).contains(k)) && i != [1, 1, 1];
    for i in (0..8).map(|n| [n & 1, n >> 1 & 1, n >> 2]).filter(|i| filled(*i)) {
        for k in 0..3 {
            for side in [0, 1] {
                let mut next = i;
                next[k] += 2 * side - 1;
                if filled(next) {
                    continue;
                }
                let (u, v) = (V::ith((k + 1) % 3, 1.0), V::ith((k + 2) % 3, 1.0));
                let corner = V::from(i.map(f64::from)) + V::ith(k, f64::from(side));
                if side == 1 {
                    quad(corner, corner + u, corner + u + v, corner + v);
                } else {
                    quad(corner, corner + v, corner + u + v, corner + u);
                }
            }
        }
    }
    TriangleMesh::from_corners(corners).unwrap()
}

/// A needle: a tetrahedron with angles of a few degrees.
fn needle() -> TriangleMesh {
    TriangleMesh {
        vertices: vec![[0.0; 3], [0.1, 0.0, 0.02], [0.05, 0.08, -0.03], [0.04, 0.02, 2.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

/// A sphere with dents and spikes.
fn star(radii: &[f64]) -> TriangleMesh {
    let mut mesh = TriangleMesh::sphere([0.0; 3], 1.0, 1);
    for (vertex, radius) in mesh.vertices.iter_mut().zip(radii) {
        *vertex = vertex.map(|x| x * radius);
    }
    mesh
}

fn hollow() -> TriangleMesh {
    let mut mesh = TriangleMesh::sphere([0.0; 3], 1.5, 1);
    let inner = TriangleMesh::cuboid([-0.5; 3], [0.4, 0.6, 0.5]).flipped();
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(&inner.vertices);
    mesh.triangles.extend(inner.triangles.iter().map(|t| t.map(|vertex| vertex + first)));
    mesh
}

fn turned(mut mesh: TriangleMesh, angles: [f64; 3]) -> TriangleMesh {
    let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
    for vertex in &mut mesh.vertices {
        *vertex = (rotation * V::from(*vertex)).into();
    }
    mesh
}

/// Points where signs go wrong if they do: close to vertices, edges and faces, and far away.
fn hard_points(mesh: &TriangleMesh, directions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    let mut around = |x: V| {
        for direction in directions {
            let unit = V::from(*direction).normalize();
            points.extend([1e-6, 1e-3, 0.05].map(|r| <[f64; 3]>::from(x + unit * r)));
        }
    };
    for [a, b, c] in triangles(mesh).take(40) {
        around(a);
        around((a + b) * 0.5);
        around(a * 0.999 + b * 0.001);
        around((a + b + c) / 3.0);
    }
    for direction in directions {
        let unit = V::from(*direction).normalize();
        points.extend([10.0, 1e3, 1e6].map(|r| <[f64; 3]>::from(unit * r)));
    }
    points
}

fn agrees(mesh: &TriangleMesh, points: &[[f64; 3]]) -> Result<(), TestCaseError> {
    prop_assert!(check(mesh).unwrap().error().is_none());
    let shape = Shape::mesh(mesh).unwrap();
    for x in points {
        let (found, expected) = (shape.signed_distance(x), brute(mesh, *x));
        let size = V::from(*x).norm().max(1.0);
        prop_assert!((found - expected).abs() < 1e-13 * size, "{found} {expected} at {x:?}");
        let nearest = shape.nearest(x);
        prop_assert_eq!(nearest.distance, found);
        prop_assert!((V::from(nearest.normal).norm() - 1.0).abs() < 1e-9);
        let closest = shape.closest_point(x);
        prop_assert!(shape.signed_distance(&closest).abs() < 1e-12 * size);
    }
    Ok(())
}

fn directions(count: usize) -> impl Strategy<Value = Vec<[f64; 3]>> {
    let unit = prop::array::uniform3(-1.0..1.0)
        .prop_filter("no direction", |x: &[f64; 3]| V::from(*x).norm() > 0.1);
    prop::collection::vec(unit, count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn fixed_meshes(
        angles in prop::array::uniform3(-3.0..3.0),
        points in prop::collection::vec(prop::array::uniform3(-2.5..2.5), 60),
        directions in directions(6),
    ) {
        let cuboid = TriangleMesh::cuboid([-1.0, -0.5, -0.2], [1.0, 0.7, 0.3]);
        for mesh in [cuboid.clone(), cuboid.flipped(), notched_box(), needle(), hollow()] {
            let mesh = turned(mesh, angles);
            agrees(&mesh, &points)?;
            agrees(&mesh, &hard_points(&mesh, &directions))?;
        }
    }

    #[test]
    fn stars(
        radii in prop::collection::vec(0.3..2.0, 42),
        points in prop::collection::vec(prop::array::uniform3(-2.5..2.5), 60),
        directions in directions(4),
    ) {
        let mesh = star(&radii);
        agrees(&mesh, &points)?;
        agrees(&mesh, &hard_points(&mesh, &directions))?;
    }

    #[test]
    fn lattice_points_near_a_mesh(angles in prop::array::uniform3(-3.0..3.0), reach in 0.05..0.4) {
        let mesh = turned(notched_box(), angles);
        let shape = Shape::mesh(&mesh).unwrap();
        let lattice = Lattice::new([0.01, 0.02, 0.03], 0.17).unwrap();
        let found = near_surface(&shape, &lattice, reach).unwrap();
        let mut expected = Vec::new();
        for z in -26..26 {
            for y in -26..26 {
                for x in -26..26 {
                    let distance = shape.signed_distance(&lattice.point(&[x, y, z]));
                    if distance.abs() < reach {
                        expected.push(([x, y, z], distance));
                    }
                }
            }
        }
        let found: Vec<_> = found.iter().map(|near| (near.index, near.distance)).collect();
        prop_assert_eq!(found, expected);
    }
}

#[test]
fn on_the_surface_the_normal_is_that_of_the_face() {
    let shape = Shape::mesh(&TriangleMesh::cuboid([0.0; 3], [1.6, 0.68, 0.6])).unwrap();
    assert_eq!(shape.normal(&[0.3, 0.3, 0.6]), [0.0, 0.0, 1.0]);
    assert_eq!(shape.normal(&[0.3, 0.0, 0.3]), [0.0, -1.0, 0.0]);
    assert_eq!(shape.normal(&[0.3, 0.01, 0.3]), [0.0, -1.0, 0.0]);
    assert_eq!(shape.normal(&[0.3, -0.01, 0.3]), [0.0, -1.0, 0.0]);
}
