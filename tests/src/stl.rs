//! Meshes of boxes, whole and spoilt, as ASCII STL.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The twelve triangles of a box, normals outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxMesh {
    triangles: Vec<[[f64; 3]; 3]>,
}

/// Corners of the faces, counted by their bits x + 2 y + 4 z, anticlockwise seen from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

impl BoxMesh {
    /// The box between two corners, m.
    pub fn new(min: [f64; 3], max: [f64; 3]) -> Self {
        let corner = |bits: usize| -> [f64; 3] {
            std::array::from_fn(|axis| if bits >> axis & 1 == 1 { max[axis] } else { min[axis] })
        };
        let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
        let triangles = FACES.into_iter().flat_map(halves).map(|face| face.map(corner)).collect();
        Self { triangles }
    }

    /// Leaves out a triangle: the surface has a hole.
    #[must_use]
    pub fn open(mut self) -> Self {
        self.triangles.pop();
        self
    }

    /// Turns one triangle over: the surface has no consistent outside.
    #[must_use]
    pub fn with_a_turned_triangle(mut self) -> Self {
        if let Some(triangle) = self.triangles.last_mut() {
            triangle.swap(0, 1);
        }
        self
    }

    /// Turns all triangles over: inside and outside are exchanged.
    #[must_use]
    pub fn inside_out(mut self) -> Self {
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        self
    }

    /// Both boxes in one file.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self { triangles: [&self.triangles[..], &other.triangles].concat() }
    }

    /// Writes the mesh.
    ///
    /// # Panics
    ///
    /// When it cannot be written.
    pub fn write(&self, path: &Path) {
        let mut text = String::from("solid box\n");
        for triangle in &self.triangles {
            // Readers take the normal from the order of the corners.
            text.push_str("facet normal 0 0 0\nouter loop\n");
            for [x, y, z] in triangle {
                // Writing to a String cannot fail.
                let _ = writeln!(text, "vertex {x} {y} {z}");
            }
            text.push_str("endloop\nendfacet\n");
        }
        text.push_str("endsolid box\n");
        fs::write(path, text).expect("a scratch file");
    }
}

#[cfg(test)]
mod tests {
    use super::BoxMesh;

    /// Six times the volume that the triangles enclose, by the divergence theorem.
    fn volume(mesh: &BoxMesh) -> f64 {
        let of = |[a, b, c]: &[[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        mesh.triangles.iter().map(of).sum::<f64>() / 6.0
    }

    #[test]
    fn a_box_has_its_volume_until_it_is_spoilt() {
        let mesh = BoxMesh::new([1.0, 2.0, 3.0], [2.0, 4.0, 6.0]);
        assert!((volume(&mesh) - 6.0).abs() < 1e-12);
        assert_eq!(mesh.clone().open().triangles.len(), 11);
        assert!((volume(&mesh.with_a_turned_triangle()) - 6.0).abs() > 0.1);
    }
}
