//! T-junctions: corners on the side of another triangle.

use super::seams::rims;
use crate::mesh::check::Defects;
use crate::mesh::{TriangleMesh, sides};
use crate::vector::{add_scaled, distance, dot, sub};

/// A corner is on a side when it is closer to it than this part of the size of the mesh.
const ON_SIDE: f64 = 1e-7;

/// Cuts triangles with an open side on which corners of other open sides lie, so that these become
/// corners of theirs. `size` is that of the mesh, m.
pub fn join(mesh: &mut TriangleMesh, size: f64, joined: &mut Defects) {
    let rims = rims(mesh);
    let mut corners: Vec<u32> = rims.iter().copied().flatten().collect();
    corners.sort_unstable();
    corners.dedup();
    let x = |vertex: u32| mesh.vertices[vertex as usize][0];
    corners.sort_by(|a, b| x(*a).total_cmp(&x(*b)));
    let near = ON_SIDE * size;
    // Corners on each open side, in its order.
    let mut cuts: Vec<([u32; 2], Vec<u32>)> = Vec::new();
    for ends in rims {
        let [a, b] = ends.map(|vertex| mesh.vertices[vertex as usize]);
        let (low, high) = (a[0].min(b[0]) - near, a[0].max(b[0]) + near);
        let first = corners.partition_point(|&vertex| x(vertex) < low);
        let along = sub(&b, &a);
        let length = distance(&a, &b);
        let mut on: Vec<(f64, u32)> = Vec::new();
        for &vertex in corners[first..].iter().take_while(|&&vertex| x(vertex) <= high) {
            let place = &mesh.vertices[vertex as usize];
            let part = dot(&sub(place, &a), &along) / (length * length);
            let inside = part * length > near && (1.0 - part) * length > near;
            if inside && distance(place, &add_scaled(&a, part, &along)) <= near {
                on.push((part, vertex));
            }
        }
        if !on.is_empty() {
            on.sort_by(|a, b| a.0.total_cmp(&b.0));
            on.dedup_by(|a, b| (a.0 - b.0) * length <= near);
            cuts.push((ends, on.into_iter().map(|(_, vertex)| vertex).collect()));
        }
    }
    if cuts.is_empty() {
        return;
    }
    let all = sides::sorted(mesh);
    for (ends, on) in cuts {
        let first = all.partition_point(|side| side.ends < ends);
        let Some(side) = all.get(first).filter(|side| side.ends == ends) else { continue };
        for vertex in &on {
            joined.add(mesh.vertices[*vertex as usize]);
        }
        cut(mesh, side.triangle, ends, &on);
    }
}

/// Replaces the part of a triangle at one of its sides by a fan. The triangle may have been cut at its
/// other sides before: then the part that still has this side lies among those that were added.
fn cut(mesh: &mut TriangleMesh, triangle: usize, ends: [u32; 2], on: &[u32]) {
    let has = |t: &[u32; 3]| ends.iter().all(|end| t.contains(end));
    let place = if has(&mesh.triangles[triangle]) {
        Some(triangle)
    } else {
        mesh.triangles.iter().rposition(has)
    };
    let Some(place) = place else { return };
    let corners = mesh.triangles[place];
    let Some(tip) = corners.iter().position(|corner| !ends.contains(corner)) else { return };
    let [tip, from, to] = [0, 1, 2].map(|k| corners[(tip + k) % 3]);
    let mut chain: Vec<u32> = on.to_vec();
    if from != ends[0] {
        chain.reverse();
    }
    chain.push(to);
    let mut last = from;
    for (index, &next) in chain.iter().enumerate() {
        let part = [tip, last, next];
        if index == 0 {
            mesh.triangles[place] = part;
        } else {
            mesh.triangles.push(part);
        }
        last = next;
    }
}
