//! Triangles on their way from a file to a mesh.

use super::number::shortest_decimal;
use crate::mesh::{TriangleMesh, is_collapsed};
use std::collections::HashMap;

/// Collects triangles and merges vertices at the same place.
#[derive(Debug, Default)]
pub struct Soup {
    /// Vertex of each place, by its bits. Numbers of 32 bits are known by those.
    known: HashMap<[u64; 3], u32>,
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    collapsed: usize,
    /// Whether vertices came in 32 bits.
    single: bool,
    /// Vertices that found no index.
    excess: usize,
}

impl Soup {
    /// The vertex at a place.
    pub fn vertex(&mut self, x: [f64; 3]) -> u32 {
        self.vertex_of(x.map(|x| (x + 0.0).to_bits()), || x)
    }

    /// The vertex at a place in 32 bits.
    pub fn vertex_f32(&mut self, x: [f32; 3]) -> u32 {
        self.single = true;
        self.vertex_of(x.map(|x| u64::from((x + 0.0).to_bits())), || x.map(shortest_decimal))
    }

    fn vertex_of(&mut self, key: [u64; 3], place: impl FnOnce() -> [f64; 3]) -> u32 {
        if let Some(&vertex) = self.known.get(&key) {
            return vertex;
        }
        let Ok(vertex) = u32::try_from(self.vertices.len()) else {
            self.excess += 1;
            return u32::MAX;
        };
        self.known.insert(key, vertex);
        self.vertices.push(place());
        vertex
    }

    /// Adds a triangle, unless it has collapsed.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        if is_collapsed(&corners) {
            self.collapsed += 1;
        } else {
            self.triangles.push(corners);
        }
    }

    /// Adds a polygon, cut into triangles from its first corner.
    pub fn polygon(&mut self, corners: &[u32]) {
        let Some((&first, rest)) = corners.split_first() else { return };
        for pair in rest.windows(2) {
            self.triangle([first, pair[0], pair[1]]);
        }
    }

    /// The number of vertices, when they are more than have an index.
    pub fn too_many(&self) -> Option<usize> {
        (self.excess > 0).then(|| self.vertices.len() + self.excess)
    }

    /// The mesh, how many triangles had collapsed, and the resolution of the numbers.
    pub fn finish(self) -> (TriangleMesh, usize, f64) {
        let largest = self.vertices.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let digit = if self.single { f64::from(f32::EPSILON) } else { f64::EPSILON };
        let mesh = TriangleMesh { vertices: self.vertices, triangles: self.triangles };
        (mesh, self.collapsed, largest * digit)
    }
}
