//! Merging vertices on the rims of holes: the seams that some programs leave between faces.

use super::Repairs;
use crate::mesh::weld::Near;
use crate::mesh::{TriangleMesh, is_collapsed, sides};
use crate::vector::distance;

/// Widths of seams that are tried, relative to the size of the mesh, the smallest first.
const WIDTHS: [f64; 4] = [1e-8, 1e-7, 1e-6, 1e-5];

/// A mesh with its open edges counted, and which vertices became which in it.
struct Attempt {
    left: usize,
    mesh: TriangleMesh,
    merged: Vec<(u32, u32)>,
}

/// Merges vertices of open edges that lie closer to each other than a small part of the size (m) of the
/// mesh, by the narrowest width that leaves no open edge, or else the fewest.
pub fn close(mesh: &mut TriangleMesh, size: f64, repairs: &mut Repairs) {
    let mut best: Option<Attempt> = None;
    let before = rims(mesh).len();
    for width in WIDTHS {
        let merged = merges(mesh, width * size);
        if merged.is_empty() {
            continue;
        }
        let welded = welded(mesh, &merged);
        let left = rims(&welded).len();
        if left < best.as_ref().map_or(before, |best| best.left) {
            best = Some(Attempt { left, mesh: welded, merged });
        }
        if left == 0 {
            break;
        }
    }
    let Some(Attempt { mesh: welded, merged, .. }) = best else { return };
    for (from, to) in merged {
        let [from, to] = [from, to].map(|vertex| mesh.vertices[vertex as usize]);
        repairs.welded.add(from);
        repairs.gap = repairs.gap.max(distance(&from, &to));
    }
    *mesh = welded;
}

/// Ends of the edges that belong to one triangle.
pub fn rims(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    let all = sides::sorted(mesh);
    let edges = all.chunk_by(|a, b| a.ends == b.ends);
    edges.filter(|edge| edge.len() == 1).map(|edge| edge[0].ends).collect()
}

/// Pairs of vertices on rims that are closer than `width` (m): each becomes the earliest such.
fn merges(mesh: &TriangleMesh, width: f64) -> Vec<(u32, u32)> {
    let mut vertices: Vec<u32> = rims(mesh).into_iter().flatten().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut near = Near::new(width);
    let mut merged = Vec::new();
    for vertex in vertices {
        let x = &mesh.vertices[vertex as usize];
        match near.earliest(x, |other| mesh.vertices[other as usize]) {
            Some(earlier) => merged.push((vertex, earlier)),
            None => near.add(x, vertex),
        }
    }
    merged
}

fn welded(mesh: &TriangleMesh, merged: &[(u32, u32)]) -> TriangleMesh {
    let mut place: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    for (from, to) in merged {
        place[*from as usize] = *to;
    }
    let triangles = mesh.triangles.iter().map(|t| t.map(|vertex| place[vertex as usize]));
    let triangles = triangles.filter(|triangle| !is_collapsed(triangle)).collect();
    TriangleMesh { vertices: mesh.vertices.clone(), triangles }
}
