//! Merging vertices that are the same point.

use super::{MeshError, TriangleMesh, is_collapsed};
use crate::vector::distance;
use std::collections::HashMap;

impl TriangleMesh {
    /// A mesh from loose triangles, as files hold them: equal corners become one vertex. Triangles
    /// that have two equal corners are left out, because they bound nothing.
    pub fn from_corners(
        corners: impl IntoIterator<Item = [[f64; 3]; 3]>,
    ) -> Result<Self, MeshError> {
        let mut welder = Welder { known: HashMap::new(), vertices: Vec::new() };
        let mut triangles = Vec::new();
        for [a, b, c] in corners {
            let triangle = [welder.vertex(a)?, welder.vertex(b)?, welder.vertex(c)?];
            if !is_collapsed(&triangle) {
                triangles.push(triangle);
            }
        }
        Ok(Self { vertices: welder.vertices, triangles })
    }

    /// The mesh with vertices closer than `tolerance` (m) to an earlier one merged into it:
    /// closes the seams that some programs leave. Triangles that collapse are left out.
    pub fn welded(&self, tolerance: f64) -> Result<Self, MeshError> {
        self.validate()?;
        if tolerance.is_nan() || tolerance <= 0.0 {
            return Self::from_corners((0..self.triangles.len()).map(|t| self.corners(t)));
        }
        let mut near = Near::new(tolerance);
        let mut kept: Vec<[f64; 3]> = Vec::new();
        let mut merged = Vec::with_capacity(self.vertices.len());
        for x in &self.vertices {
            let earlier = near.earliest(x, |vertex| kept[vertex as usize]);
            merged.push(earlier.unwrap_or_else(|| {
                // The input has no more vertices than 32 bits count: its indices were checked.
                let vertex = kept.len() as u32;
                kept.push(*x);
                near.add(x, vertex);
                vertex
            }));
        }
        let triangles = self.triangles.iter().map(|t| t.map(|vertex| merged[vertex as usize]));
        Ok(Self { vertices: kept, triangles: triangles.filter(|t| !is_collapsed(t)).collect() })
    }
}

/// Vertices in cells as wide as they may lie apart to merge: what merges lies in neighbouring cells.
pub(super) struct Near {
    width: f64,
    cells: HashMap<[u64; 3], Vec<u32>>,
}

impl Near {
    /// No vertices, which merge when they are closer than `width` (m).
    pub fn new(width: f64) -> Self {
        Self { width, cells: HashMap::new() }
    }

    /// The first of the vertices that merge with one at `x`; `place` tells where a vertex is.
    pub fn earliest(&self, x: &[f64; 3], place: impl Fn(u32) -> [f64; 3]) -> Option<u32> {
        let home = self.cell(x);
        (0..27)
            .filter_map(|n| {
                let shift = [n % 3, n / 3 % 3, n / 9].map(|k| f64::from(k) - 1.0);
                self.cells.get(&key([0, 1, 2].map(|k| home[k] + shift[k])))
            })
            .flatten()
            .copied()
            .filter(|&vertex| distance(x, &place(vertex)) < self.width)
            .min()
    }

    /// Adds a vertex at `x`.
    pub fn add(&mut self, x: &[f64; 3], vertex: u32) {
        self.cells.entry(key(self.cell(x))).or_default().push(vertex);
    }

    fn cell(&self, x: &[f64; 3]) -> [f64; 3] {
        x.map(|x| (x / self.width).floor())
    }
}

struct Welder {
    known: HashMap<[u64; 3], u32>,
    vertices: Vec<[f64; 3]>,
}

impl Welder {
    fn vertex(&mut self, x: [f64; 3]) -> Result<u32, MeshError> {
        if let Some(&vertex) = self.known.get(&key(x)) {
            return Ok(vertex);
        }
        let count = self.vertices.len();
        let vertex = u32::try_from(count).map_err(|_| MeshError::TooLarge { count })?;
        self.known.insert(key(x), vertex);
        self.vertices.push(x);
        Ok(vertex)
    }
}

/// Bits that are equal for equal numbers. Adding zero makes −0 the same as 0.
fn key(x: [f64; 3]) -> [u64; 3] {
    x.map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check;

    #[test]
    fn zero_and_minus_zero_are_one_vertex() {
        let mesh = TriangleMesh::from_corners([
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            [[-0.0, 0.0, 0.0], [0.0, 1.0, -0.0], [0.0, 0.0, 1.0]],
            [[5.0, 5.0, 5.0], [5.0, 5.0, 5.0], [0.0, 0.0, 1.0]],
        ])
        .unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.vertices.len(), 5);
    }

    #[test]
    fn welding_closes_seams() {
        let mesh = TriangleMesh::cuboid([-1.0; 3], [1.0; 3]);
        // Every triangle gets corners of its own, a little apart.
        let mut loose = TriangleMesh::default();
        for t in 0..mesh.triangles.len() {
            let first = loose.vertices.len() as u32;
            let shift = 1e-7 * t as f64;
            loose.vertices.extend(mesh.corners(t).map(|x| x.map(|x| x + shift)));
            loose.triangles.push([first, first + 1, first + 2]);
        }
        assert_eq!(check(&loose).unwrap().open_edges.count, 36);
        assert_eq!(check(&loose.welded(0.0).unwrap()).unwrap().open_edges.count, 36);
        let welded = loose.welded(1e-5).unwrap();
        assert_eq!(welded.vertices.len(), 8);
        assert!(check(&welded).unwrap().error().is_none());
    }
}
