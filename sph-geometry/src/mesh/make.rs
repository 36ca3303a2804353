//! Meshes of simple shapes.

use super::TriangleMesh;
use crate::vector::{add_scaled, norm, scaled};
use std::collections::HashMap;

impl TriangleMesh {
    /// The surface of an axis-parallel box: 12 triangles.
    pub fn cuboid(min: [f64; 3], max: [f64; 3]) -> Self {
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] });
        let sides =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        Self {
            vertices: (0..8).map(corner).collect(),
            triangles: sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    /// A sphere: an icosahedron whose triangles are split into four `splits` times
    /// (20 · 4^splits triangles). Its vertices lie on the sphere, so it is a little smaller.
    pub fn sphere(center: [f64; 3], radius: f64, splits: u32) -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut points: Vec<[f64; 3]> = Vec::new();
        for k in 0..3 {
            for (a, b) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
                let mut point = [0.0; 3];
                point[k] = a;
                point[(k + 1) % 3] = b;
                points.push(scaled(1.0 / norm(&point), &point));
            }
        }
        let mut triangles = icosahedron(&points);
        for _ in 0..splits {
            let mut middles = HashMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = add_scaled(&points[a as usize], 1.0, &points[b as usize]);
                    points.push(scaled(1.0 / norm(&sum), &sum));
                    points.len() as u32 - 1
                })
            };
            triangles = triangles
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        let vertices = points.iter().map(|x| add_scaled(&center, radius, x)).collect();
        Self { vertices, triangles }
    }
}

/// The 20 triples of corners that are neighbours of each other, turned outwards.
fn icosahedron(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
    use crate::vector::{cross, dot};
    let neighbors = |a: usize, b: usize| dot(&points[a], &points[b]) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if neighbors(a, b) && neighbors(b, c) && neighbors(c, a) {
                    let outwards = dot(&points[a], &cross(&points[b], &points[c])) > 0.0;
                    let [b, c] = if outwards { [b, c] } else { [c, b] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check;

    #[test]
    fn a_box_is_closed_and_has_its_volume() {
        let report = check(&TriangleMesh::cuboid([1.0, 2.0, 3.0], [2.0, 4.0, 6.0])).unwrap();
        assert!(report.error().is_none());
        assert_eq!((report.volume, report.area), (6.0, 22.0));
    }

    #[test]
    fn spheres_approach_the_volume_of_a_sphere() {
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        let mut last = 0.0;
        for splits in 0..4 {
            let mesh = TriangleMesh::sphere([1.0, -1.0, 0.5], 2.0, splits);
            assert_eq!(mesh.triangles.len(), 20 * 4_usize.pow(splits));
            let report = check(&mesh).unwrap();
            assert!(report.error().is_none() && report.shells == 1);
            assert!(report.volume > last && report.volume < exact);
            last = report.volume;
        }
        assert!((last / exact - 1.0).abs() < 0.01);
    }
}
