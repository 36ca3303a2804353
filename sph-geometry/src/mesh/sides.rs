//! The sides of triangles, and which of them belong together.

use super::{TriangleMesh, is_collapsed};
use crate::vector::{cross, dot, norm, scaled, sub};

/// One side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// Its ends in ascending order.
    pub ends: [u32; 2],
    /// Whether the triangle runs through them in that order.
    pub forward: bool,
    /// The triangle.
    pub triangle: usize,
}

/// All sides of triangles that have not collapsed, sorted by their ends: those of one edge follow each
/// other.
pub fn sorted(mesh: &TriangleMesh) -> Vec<Side> {
    let mut sides: Vec<Side> = Vec::with_capacity(3 * mesh.triangles.len());
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if is_collapsed(corners) {
            continue;
        }
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            sides.push(Side { ends: [a.min(b), a.max(b)], forward: a < b, triangle });
        }
    }
    sides.sort_unstable();
    sides
}

/// The sides at one edge in pairs, such that each pair bounds a wedge of material: two of them are a
/// pair; more are surfaces that touch in the edge, and are told apart by going around it. `None` when
/// one is left over.
pub fn pairs(mesh: &TriangleMesh, edge: &[Side]) -> Option<Vec<[usize; 2]>> {
    if let [one, other] = edge {
        return Some(vec![[one.triangle, other.triangle]]);
    }
    let forward = edge.iter().filter(|side| side.forward).count();
    if 2 * forward != edge.len() {
        return None;
    }
    let mut around = edge.to_vec();
    let angles = angles(mesh, edge);
    // Two angles that differ by rounding are one, and there a wedge ends before the next one begins.
    let key = |side: &Side| {
        let place = edge.iter().position(|other| other == side).unwrap_or(0);
        (angles[place], !side.forward)
    };
    around.sort_by_key(key);
    // Seen along the edge, material is in front of forward sides and behind the others.
    let mut level = 0_i64;
    let mut lowest = (0, 0);
    for (place, side) in around.iter().enumerate() {
        level += if side.forward { -1 } else { 1 };
        if level < lowest.0 {
            lowest = (level, place + 1);
        }
    }
    around.rotate_left(lowest.1 % edge.len());
    let (mut open, mut pairs) = (Vec::new(), Vec::new());
    for side in &around {
        if side.forward {
            pairs.push([open.pop()?, side.triangle]);
        } else {
            open.push(side.triangle);
        }
    }
    Some(pairs)
}

/// Angles of triangles around their common edge, in steps of about 1e-9.
fn angles(mesh: &TriangleMesh, edge: &[Side]) -> Vec<i64> {
    let [a, b] = edge[0].ends.map(|vertex| mesh.vertices[vertex as usize]);
    let along = sub(&b, &a);
    let along = scaled(1.0 / norm(&along).max(f64::MIN_POSITIVE), &along);
    let first = crate::vector::perpendicular(&along);
    let second = cross(&along, &first);
    let steps = (std::f64::consts::TAU * 1e9).round();
    let angle = |side: &Side| {
        let tip = mesh.triangles[side.triangle].iter().find(|v| !side.ends.contains(v));
        let tip = tip.map_or(a, |vertex| mesh.vertices[*vertex as usize]);
        let out = sub(&tip, &a);
        let angle = dot(&out, &second).atan2(dot(&out, &first));
        (angle * 1e9).round().rem_euclid(steps) as i64
    };
    let mut angles: Vec<i64> = edge.iter().map(angle).collect();
    // Neighbouring steps are joined: rounding may fall on either side of one.
    let mut order: Vec<usize> = (0..angles.len()).collect();
    order.sort_by_key(|&i| angles[i]);
    for pair in order.windows(2) {
        if angles[pair[1]] - angles[pair[0]] <= 4 {
            angles[pair[1]] = angles[pair[0]];
        }
    }
    let (first, last) = (angles[order[0]], angles[order[order.len() - 1]]);
    if first + steps as i64 - last <= 4 {
        angles.iter_mut().filter(|angle| **angle == last).for_each(|angle| *angle = first);
    }
    angles
}
