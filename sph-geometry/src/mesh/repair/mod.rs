//! Mending what is safe to mend in a mesh.
//!
//! In this order, and each step only where there is something to mend: copies of triangles are removed;
//! vertices on the rims of holes that are the same point but for a little are merged; corners that lie
//! on the side of another triangle (T-junctions) become corners of it; triangles are turned so that
//! neighbours agree; surfaces that touch in an edge are told apart. Holes stay holes.

mod junctions;
mod orientation;
mod seams;

use super::bodies::separated;
use super::check::Defects;
use super::{MeshError, TriangleMesh, is_collapsed, sides};
use crate::vector::distance;
use std::collections::HashSet;

/// A mesh and what was mended in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What was mended.
    pub repairs: Repairs,
}

/// What [`repaired`] mended.
#[derive(Debug, Clone, PartialEq)]
pub struct Repairs {
    /// Copies of triangles, removed.
    pub duplicates: Defects,
    /// Vertices on the rims of holes, merged into others.
    pub welded: Defects,
    /// The longest way that a vertex was moved for that, m.
    pub gap: f64,
    /// Corners on the side of another triangle, made corners of it.
    pub junctions: Defects,
    /// Triangles turned so that neighbours agree about which side is outside.
    pub turned: Defects,
    /// Edges in which surfaces touch that were told apart.
    pub parted: Defects,
}

impl Repairs {
    /// What was mended, in words; nothing for a mesh that was in order.
    pub fn in_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        let mut add = |what: &str, defects: &Defects| {
            if !defects.is_empty() {
                words.push(format!("{what} {defects}"));
            }
        };
        add("removed copies:", &self.duplicates);
        add(&format!("closed seams up to {:.1e} m wide by merging", self.gap), &self.welded);
        add("joined T-junctions:", &self.junctions);
        add("turned over", &self.turned);
        add("parted bodies that touch in", &self.parted);
        words
    }
}

/// Mends a mesh. What cannot be mended safely stays as it is for [`check`](super::check) to find.
pub fn repaired(mesh: &TriangleMesh) -> Result<Repaired, MeshError> {
    mesh.validate()?;
    let mut repairs = Repairs {
        duplicates: Defects::new("triangle"),
        welded: Defects::new("vertex"),
        gap: 0.0,
        junctions: Defects::new("corner"),
        turned: Defects::new("triangle"),
        parted: Defects::new("edge"),
    };
    let mut mended = mesh.clone();
    mended.triangles.retain(|triangle| !is_collapsed(triangle));
    if is_in_order(&mended) {
        return Ok(Repaired { mesh: mended, repairs });
    }
    without_copies(&mut mended, &mut repairs.duplicates);
    if has_rims(&mended) {
        let bounds = mended.bounding_box();
        let size = distance(&bounds.min, &bounds.max);
        seams::close(&mut mended, size, &mut repairs);
        junctions::join(&mut mended, size, &mut repairs.junctions);
        without_copies(&mut mended, &mut repairs.duplicates);
    }
    orientation::agree(&mut mended, &mut repairs.turned);
    part(&mut mended, &mut repairs.parted)?;
    if mended.triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    Ok(Repaired { mesh: mended, repairs })
}

/// Whether every edge belongs to two triangles that agree about it.
fn is_in_order(mesh: &TriangleMesh) -> bool {
    let all = sides::sorted(mesh);
    let mut edges = all.chunk_by(|a, b| a.ends == b.ends);
    !all.is_empty()
        && edges.all(|edge| matches!(edge, [one, other] if one.forward != other.forward))
}

/// Removes triangles that have the same corners as an earlier one and face the same way; if there are
/// still edges of an odd number of triangles, also those that face the other way.
fn without_copies(mesh: &mut TriangleMesh, copies: &mut Defects) {
    let turned_to_first = |&[a, b, c]: &[u32; 3]| {
        if a < b && a < c {
            [a, b, c]
        } else if b < a && b < c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let mut seen: HashSet<[u32; 3]> = HashSet::with_capacity(mesh.triangles.len());
    let kept: Vec<bool> =
        mesh.triangles.iter().map(|triangle| seen.insert(turned_to_first(triangle))).collect();
    remove(mesh, &kept, copies);
    let other_way = |[a, b, c]: [u32; 3]| [a, c, b];
    let both = |triangle: &[u32; 3]| seen.contains(&other_way(turned_to_first(triangle)));
    if !mesh.triangles.iter().any(both) {
        return;
    }
    let odd = sides::sorted(mesh).chunk_by(|a, b| a.ends == b.ends).any(|edge| edge.len() % 2 == 1);
    if odd {
        let mut seen: HashSet<[u32; 3]> = HashSet::new();
        let first = |&[a, b, c]: &[u32; 3]| {
            let mut corners = [a, b, c];
            corners.sort_unstable();
            seen.insert(corners)
        };
        let kept: Vec<bool> = mesh.triangles.iter().map(first).collect();
        remove(mesh, &kept, copies);
    }
}

fn remove(mesh: &mut TriangleMesh, kept: &[bool], copies: &mut Defects) {
    for triangle in (0..kept.len()).filter(|&triangle| !kept[triangle]) {
        copies.add(super::check::middle(mesh, triangle));
    }
    let mut keep = kept.iter();
    mesh.triangles.retain(|_| keep.next().copied().unwrap_or(true));
}

fn has_rims(mesh: &TriangleMesh) -> bool {
    sides::sorted(mesh).chunk_by(|a, b| a.ends == b.ends).any(|edge| edge.len() == 1)
}

/// Gives connected parts that touch vertices of their own, if all edges can be told apart.
fn part(mesh: &mut TriangleMesh, parted: &mut Defects) -> Result<(), MeshError> {
    let all = sides::sorted(mesh);
    let mut crowded = Vec::new();
    for edge in all.chunk_by(|a, b| a.ends == b.ends).filter(|edge| edge.len() > 2) {
        if sides::pairs(mesh, edge).is_none() {
            return Ok(());
        }
        crowded.push(edge[0].ends);
    }
    if crowded.is_empty() {
        return Ok(());
    }
    let mut apart = TriangleMesh::default();
    for one in separated(mesh)? {
        apart.append(&one, false)?;
    }
    // One body that touches itself keeps its edge, and stays for the check to find.
    for ends in crowded {
        let [a, b] = ends.map(|vertex| mesh.vertices[vertex as usize]);
        parted.add([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])));
    }
    *mesh = apart;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{bodies, check};
    use proptest::prelude::*;

    fn sphere() -> TriangleMesh {
        TriangleMesh::sphere([1.0, -2.0, 0.5], 1.0, 2)
    }

    #[test]
    fn a_mesh_in_order_stays_as_it_is() {
        let Repaired { mesh, repairs } = repaired(&sphere()).unwrap();
        assert_eq!(mesh, sphere());
        assert!(repairs.in_words().is_empty());
    }

    proptest! {
        #[test]
        fn copies_are_removed(triangle in 0..320usize, turn in 0..3usize, over: bool) {
            let mut mesh = sphere();
            let mut copy = mesh.triangles[triangle];
            copy.rotate_left(turn);
            if over {
                copy.swap(0, 1);
            }
            mesh.triangles.push(copy);
            let found = repaired(&mesh).unwrap();
            prop_assert_eq!(found.repairs.duplicates.count, 1);
            prop_assert_eq!(found.mesh, sphere());
        }

        #[test]
        fn turned_triangles_are_turned_back(
            turned in prop::collection::btree_set(0..320usize, 1..100),
        ) {
            let mut mesh = sphere();
            turned.iter().for_each(|&triangle| mesh.triangles[triangle].swap(1, 2));
            let found = repaired(&mesh).unwrap();
            prop_assert_eq!(found.repairs.turned.count, turned.len());
            prop_assert_eq!(found.mesh.triangles.len(), 320);
            let report = check(&found.mesh).unwrap();
            prop_assert!(report.error().is_none());
            prop_assert!((report.volume - check(&sphere()).unwrap().volume).abs() < 1e-12);
        }

        #[test]
        fn seams_are_closed(
            shifts in prop::collection::vec(prop::array::uniform3(-1.0..1.0), 960),
            gap in 1e-9..5e-6_f64,
        ) {
            // Every triangle has corners of its own, a little apart.
            let whole = sphere();
            let mut mesh = TriangleMesh::default();
            for t in 0..whole.triangles.len() {
                let first = mesh.vertices.len() as u32;
                for (x, shift) in whole.corners(t).iter().zip(&shifts[3 * t..]) {
                    mesh.vertices.push([0, 1, 2].map(|k| x[k] + gap * shift[k]));
                }
                mesh.triangles.push([first, first + 1, first + 2]);
            }
            let found = repaired(&mesh).unwrap();
            prop_assert!(found.repairs.gap <= 4.0 * gap);
            let report = check(&found.mesh).unwrap();
            prop_assert!(report.error().is_none() && report.triangles == 320);
            prop_assert!((report.volume - check(&whole).unwrap().volume).abs() < 1e-3);
        }

        #[test]
        fn t_junctions_are_joined(
            triangle in 0..320usize,
            parts in prop::collection::vec(0.05..0.95_f64, 1..5),
        ) {
            // The triangle is cut into a fan from one corner; its neighbour does not know.
            let whole = sphere();
            let mut mesh = whole.clone();
            let [a, b, c] = mesh.triangles.remove(triangle);
            let [from, to] = [b, c].map(|v| mesh.vertices[v as usize]);
            let mut parts = parts;
            parts.sort_by(f64::total_cmp);
            parts.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
            let mut last = b;
            for s in &parts {
                let next = mesh.vertices.len() as u32;
                mesh.vertices.push([0, 1, 2].map(|k| from[k] + s * (to[k] - from[k])));
                mesh.triangles.push([a, last, next]);
                last = next;
            }
            mesh.triangles.push([a, last, c]);
            prop_assert!(check(&mesh).unwrap().open_edges.count > 0);
            let found = repaired(&mesh).unwrap();
            prop_assert_eq!(found.repairs.junctions.count, parts.len());
            let report = check(&found.mesh).unwrap();
            prop_assert!(report.error().is_none(), "{:?}", report);
            prop_assert!((report.volume - check(&whole).unwrap().volume).abs() < 1e-12);
        }
    }

    #[test]
    fn bodies_that_share_a_face_become_two() {
        let [one, other] = [[0.0; 3], [1.0, 0.0, 0.0]]
            .map(|min| TriangleMesh::cuboid(min, [min[0] + 1.0, 1.0, 1.0]));
        let corners = [one, other].map(|m| (0..12).map(|t| m.corners(t)).collect::<Vec<_>>());
        let mesh = TriangleMesh::from_corners(corners.concat()).unwrap();
        assert!(check(&mesh).unwrap().error().is_some());
        let found = repaired(&mesh).unwrap();
        assert!(found.repairs.parted.count >= 4);
        let bodies = bodies(&found.mesh).unwrap();
        assert_eq!(bodies.bodies, 2);
        assert!((bodies.volume - 2.0).abs() < 1e-12);
    }

    #[test]
    fn holes_stay_holes() {
        let mut mesh = sphere();
        mesh.triangles.pop();
        let found = repaired(&mesh).unwrap();
        assert!(matches!(check(&found.mesh).unwrap().error(), Some(MeshError::Open { .. })));
    }
}
