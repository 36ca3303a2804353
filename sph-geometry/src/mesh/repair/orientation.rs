//! Turning triangles so that neighbours agree about which side is outside.

use crate::mesh::check::{Defects, middle};
use crate::mesh::{TriangleMesh, sides};

/// Turns the fewer triangles of each connected part until all neighbours agree. A part where that
/// cannot be, such as a Möbius strip, stays as it is, as do parts that touch others in an edge.
pub fn agree(mesh: &mut TriangleMesh, turned: &mut Defects) {
    let all = sides::sorted(mesh);
    let edges = || all.chunk_by(|a, b| a.ends == b.ends);
    let disagree = |edge: &[sides::Side]| edge.len() == 2 && edge[0].forward == edge[1].forward;
    if !edges().any(disagree) || edges().any(|edge| edge.len() > 2) {
        return;
    }
    // Neighbours of each triangle over its sides, and whether they agree.
    let mut neighbours: Vec<[(u32, bool); 3]> = vec![[(u32::MAX, true); 3]; mesh.triangles.len()];
    let mut add = |from: usize, to: usize, agrees: bool| {
        let free = neighbours[from].iter_mut().find(|(other, _)| *other == u32::MAX);
        if let Some(free) = free {
            *free = (to as u32, agrees);
        }
    };
    for edge in edges() {
        if let [one, other] = edge {
            let agrees = one.forward != other.forward;
            add(one.triangle, other.triangle, agrees);
            add(other.triangle, one.triangle, agrees);
        }
    }
    let mut over: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    for first in 0..mesh.triangles.len() {
        if over[first].is_some() {
            continue;
        }
        over[first] = Some(false);
        let mut part = vec![first];
        let mut next = 0;
        let mut possible = true;
        while let Some(&triangle) = part.get(next) {
            next += 1;
            let here = over[triangle].unwrap_or(false);
            for &(other, agrees) in neighbours[triangle].iter().filter(|(to, _)| *to != u32::MAX) {
                let wanted = here == agrees;
                let other = other as usize;
                match over[other] {
                    None => {
                        over[other] = Some(wanted);
                        part.push(other);
                    }
                    Some(found) => possible &= found == wanted,
                }
            }
        }
        let count = part.iter().filter(|&&triangle| over[triangle] == Some(true)).count();
        let minority = 2 * count <= part.len();
        if possible {
            part.sort_unstable();
            for triangle in part.into_iter().filter(|&t| over[t] == Some(minority)) {
                turned.add(middle(mesh, triangle));
                mesh.triangles[triangle].swap(1, 2);
            }
        }
    }
}
