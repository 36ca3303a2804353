//! The bodies that the shells of a mesh bound.
//!
//! A shell is a part of a surface whose triangles are connected by edges. Which side of it is material
//! follows from the number of times that shells wind around a point, as the winding number of a whole
//! surface does (A. Jacobson, L. Kavan, O. Sorkine-Hornung, Robust inside-outside segmentation using
//! generalized winding numbers, ACM Trans. Graph. 32 (2013) 33, doi:10.1145/2461912.2461916), after each
//! shell has been oriented by its nesting:
//!
//! * in empty space (not inside another shell, or in a cavity) a shell bounds a body, whichever way it
//!   faces;
//! * in material, a shell that faces the other way than the one around it bounds a cavity;
//! * in material, a shell that faces the same way bounds a body in a body. It changes nothing and is
//!   left out with what is inside of it, unless that is a cavity of both.
//!
//! Bodies that overlap are united.

use super::sets::Sets;
use super::{MeshError, TriangleMesh, check, is_collapsed, sides};
use crate::aabb::Aabb;
use crate::shape::MeshSurface;

/// What [`bodies`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    /// Closed surfaces, right side out. Within one, no shells meet; shells of different ones may.
    pub surfaces: Vec<TriangleMesh>,
    /// Number of shells.
    pub shells: usize,
    /// Bodies among them.
    pub bodies: usize,
    /// Cavities in bodies.
    pub cavities: usize,
    /// Shells that bound nothing: flat ones, and those inside of bodies that face as these do.
    pub idle: usize,
    /// Shells that were inside out.
    pub turned: usize,
    /// Volume of all bodies without their cavities in m³; where bodies overlap, it counts for each.
    pub volume: f64,
}

impl Bodies {
    /// Whether bodies may overlap: their bounding boxes do.
    pub fn may_overlap(&self) -> bool {
        self.surfaces.len() > 1
    }
}

/// A part of a surface whose triangles are connected.
struct Shell {
    mesh: TriangleMesh,
    bounds: Aabb<3>,
    /// m³, negative when inside out.
    volume: f64,
}

/// Finds the shells of a mesh and what they bound. The mesh must be closed and consistently oriented
/// within each shell, see [`check`] and [`repaired`](super::repaired).
pub fn bodies(mesh: &TriangleMesh) -> Result<Bodies, MeshError> {
    let report = check(mesh)?;
    if let Some(error) = report.error() {
        return Err(error);
    }
    let mut shells = shells(mesh)?;
    let all = shells.len();
    let flat = |shell: &Shell| {
        let size = crate::vector::distance(&shell.bounds.min, &shell.bounds.max);
        // Coordinates so large that volumes overflow bound nothing either.
        shell.volume.is_nan() || shell.volume.abs() <= check::NO_VOLUME * size.powi(3)
    };
    shells.retain(|shell| !flat(shell));
    if shells.is_empty() {
        return Err(MeshError::NoVolume);
    }
    // Those that may contain others first.
    shells.sort_by(|a, b| b.volume.abs().total_cmp(&a.volume.abs()));
    let around = containers(&shells)?;
    let mut found = Bodies {
        surfaces: Vec::new(),
        shells: all,
        bodies: 0,
        cavities: 0,
        idle: all - shells.len(),
        turned: 0,
        volume: 0.0,
    };
    // Whether the file has it, and all in it, the wrong way round; times that shells wind around what
    // is just inside; the body that it belongs to.
    let mut family: Vec<(bool, i64, usize)> = Vec::with_capacity(shells.len());
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, shell) in shells.iter().enumerate() {
        let parent = around[index].last().map(|&parent| family[parent]);
        let inwards = shell.volume < 0.0;
        let (flipped, winding, group) = match parent {
            Some((flipped, winding, group)) if winding > 0 => {
                let step = if inwards == flipped { 1 } else { -1 };
                (flipped, winding + step, group)
            }
            _ => (inwards, 1, groups.len()),
        };
        family.push((flipped, winding, group));
        found.turned += usize::from(flipped);
        let outside = parent.map_or(0, |(_, winding, _)| winding);
        match (outside > 0, winding > 0) {
            (false, _) => {
                groups.push(vec![index]);
                found.bodies += 1;
                found.volume += shell.volume.abs();
            }
            (true, false) => {
                groups[group].push(index);
                found.cavities += 1;
                found.volume -= shell.volume.abs();
            }
            (true, true) => found.idle += 1,
        }
    }
    for layer in layers(&groups, &shells, &around) {
        let mut surface = TriangleMesh::default();
        for &index in layer.iter().flat_map(|&group| &groups[group]) {
            surface.append(&shells[index].mesh, family[index].0)?;
        }
        found.surfaces.push(surface);
    }
    Ok(found)
}

/// The connected parts of a closed mesh, each with vertices of its own.
fn shells(mesh: &TriangleMesh) -> Result<Vec<Shell>, MeshError> {
    let parts = separated(mesh)?;
    let origin = mesh.bounding_box().min;
    let shell = |mesh: TriangleMesh| {
        let triangles = 0..mesh.triangles.len();
        let volume = triangles.map(|t| check::wedge(&mesh, t, &origin)).sum();
        Shell { bounds: mesh.bounding_box(), volume, mesh }
    };
    Ok(parts.into_iter().map(shell).collect())
}

/// The connected parts of a mesh, each with vertices of its own. Where several touch in an edge, they
/// are told apart.
pub fn separated(mesh: &TriangleMesh) -> Result<Vec<TriangleMesh>, MeshError> {
    let mut sets = Sets::new(mesh.triangles.len());
    let all = sides::sorted(mesh);
    for edge in all.chunk_by(|a, b| a.ends == b.ends) {
        match sides::pairs(mesh, edge) {
            Some(pairs) => pairs.iter().for_each(|[a, b]| sets.join(*a, *b)),
            None => edge.windows(2).for_each(|two| sets.join(two[0].triangle, two[1].triangle)),
        }
    }
    let mut number = vec![u32::MAX; mesh.triangles.len()];
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for triangle in 0..mesh.triangles.len() {
        if is_collapsed(&mesh.triangles[triangle]) {
            continue;
        }
        let root = sets.root(triangle);
        if number[root] == u32::MAX {
            number[root] = parts.len() as u32;
            parts.push(Vec::new());
        }
        parts[number[root] as usize].push(triangle);
    }
    let mut place = vec![(u32::MAX, 0_u32); mesh.vertices.len()];
    let part = |(part, triangles): (usize, Vec<usize>)| {
        let mut own = TriangleMesh::default();
        for triangle in triangles {
            let corners = mesh.triangles[triangle].map(|vertex| {
                let known = &mut place[vertex as usize];
                if known.0 != part as u32 {
                    *known = (part as u32, own.vertices.len() as u32);
                    own.vertices.push(mesh.vertices[vertex as usize]);
                }
                known.1
            });
            own.triangles.push(corners);
        }
        own
    };
    Ok(parts.into_iter().enumerate().map(part).collect())
}

/// For each shell the shells around it, the outermost first. Shells are given from large to small.
fn containers(shells: &[Shell]) -> Result<Vec<Vec<usize>>, MeshError> {
    let mut surfaces: Vec<Option<MeshSurface>> = shells.iter().map(|_| None).collect();
    let mut around = vec![Vec::new(); shells.len()];
    for inner in 1..shells.len() {
        for outer in 0..inner {
            let (bounds, room) = (&shells[inner].bounds, &shells[outer].bounds);
            if !room.contains(&bounds.min) || !room.contains(&bounds.max) {
                continue;
            }
            if surfaces[outer].is_none() {
                let Shell { mesh, volume, bounds } = &shells[outer];
                surfaces[outer] = Some(MeshSurface::closed(mesh, *volume < 0.0, *bounds)?);
            }
            let contained =
                surfaces[outer].as_ref().is_some_and(|outer| contains(outer, &shells[inner]));
            if contained {
                around[inner].push(outer);
            }
        }
    }
    Ok(around)
}

/// Whether all corners of a shell are inside a surface or on it.
fn contains(outer: &MeshSurface, inner: &Shell) -> bool {
    let size = crate::vector::distance(&inner.bounds.min, &inner.bounds.max);
    // Everything within `clear` of `center` is inside.
    let (mut center, mut clear) = ([0.0; 3], 0.0);
    let mut deepest = 0.0_f64;
    for x in &inner.mesh.vertices {
        if crate::vector::distance(x, &center) < clear {
            continue;
        }
        let distance = outer.signed_distance(x);
        if distance > 1e-9 * size {
            return false;
        }
        deepest = deepest.max(-distance);
        (center, clear) = (*x, -distance);
    }
    // A shell whose corners are all on the other one is no part of its inside for that.
    deepest > 1e-9 * size
}

/// Groups of shells in layers. Bounding boxes within a layer do not meet, unless one group lies inside
/// a shell of the other.
fn layers(groups: &[Vec<usize>], shells: &[Shell], around: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let meet = |a: usize, b: usize| {
        let [outer, inner] = [groups[a][0], groups[b][0]];
        if around[inner].contains(&outer) || around[outer].contains(&inner) {
            return false;
        }
        let both = shells[outer].bounds.intersection(&shells[inner].bounds);
        (0..3).all(|k| both.min[k] <= both.max[k])
    };
    let mut layers: Vec<Vec<usize>> = Vec::new();
    for group in 0..groups.len() {
        let free = layers.iter_mut().find(|layer| layer.iter().all(|other| !meet(*other, group)));
        match free {
            Some(layer) => layer.push(group),
            None => layers.push(vec![group]),
        }
    }
    layers
}

impl TriangleMesh {
    /// Adds the triangles of another mesh, with inside and outside exchanged if `turned`.
    pub fn append(&mut self, other: &Self, turned: bool) -> Result<(), MeshError> {
        let count = self.vertices.len() + other.vertices.len();
        if u32::try_from(count).is_err() {
            return Err(MeshError::TooLarge { count });
        }
        let first = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|vertex| vertex + first);
            if turned { [a, c, b] } else { [a, b, c] }
        }));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> TriangleMesh {
        TriangleMesh::cuboid(min, max)
    }

    /// All of these in one mesh; with `true`, turned inside out.
    fn together(parts: &[(TriangleMesh, bool)]) -> TriangleMesh {
        let mut all = TriangleMesh::default();
        for (part, turned) in parts {
            all.append(part, *turned).unwrap();
        }
        all
    }

    fn nested(inside_out: [bool; 3]) -> TriangleMesh {
        let [a, b, c] = inside_out;
        together(&[
            (cuboid([1.0; 3], [3.0; 3]), b),
            (cuboid([0.0; 3], [4.0; 3]), a),
            (cuboid([1.5; 3], [2.5; 3]), c),
        ])
    }

    #[test]
    fn bodies_beside_each_other_face_outwards() {
        let [left, right] = [cuboid([0.0; 3], [1.0; 3]), cuboid([2.0; 3], [3.0; 3])];
        for turned in [[false, false], [true, false], [false, true], [true, true]] {
            let mesh = together(&[(left.clone(), turned[0]), (right.clone(), turned[1])]);
            let found = bodies(&mesh).unwrap();
            assert_eq!((found.shells, found.bodies, found.surfaces.len()), (2, 2, 1));
            assert_eq!(found.turned, turned.into_iter().filter(|turned| *turned).count());
            assert!((found.volume - 2.0).abs() < 1e-12);
            let shape = Shape::<3>::mesh(&mesh).unwrap();
            assert!(shape.contains(&[0.5; 3]) && shape.contains(&[2.5; 3]));
            assert!(!shape.contains(&[1.5; 3]) && !shape.contains(&[5.0; 3]));
        }
    }

    #[test]
    fn cavities_stay_cavities_and_hold_bodies() {
        // The whole file may be inside out, and the body in the cavity may face either way.
        for flipped in [false, true] {
            for innermost in [false, true] {
                let mesh = nested([flipped, !flipped, innermost]);
                let found = bodies(&mesh).unwrap();
                assert_eq!((found.bodies, found.cavities, found.idle), (2, 1, 0));
                assert_eq!(found.surfaces.len(), 1);
                assert!((found.volume - (64.0 - 8.0 + 1.0)).abs() < 1e-12);
                let shape = Shape::<3>::mesh(&mesh).unwrap();
                let inside = [0.5, 1.25, 2.0].map(|x| shape.contains(&[x, 2.0, 2.0]));
                assert_eq!(inside, [true, false, true]);
                assert!((shape.signed_distance(&[1.3, 2.0, 2.0]) - 0.2).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_body_in_a_body_changes_nothing() {
        let mesh = nested([false, false, true]);
        let found = bodies(&mesh).unwrap();
        // The innermost hollow is one of the inner body only: the outer one fills it.
        assert_eq!((found.bodies, found.cavities, found.idle), (1, 0, 2));
        assert!((found.volume - 64.0).abs() < 1e-12);
        let shape = Shape::<3>::mesh(&mesh).unwrap();
        assert_eq!(shape.signed_distance(&[1.5, 2.0, 2.0]), -1.5);
    }

    #[test]
    fn bodies_that_cross_are_united() {
        let mesh = together(&[
            (cuboid([0.0, 0.3, 0.0], [1.0, 0.5, 0.2]), false),
            (cuboid([0.4, 0.0, 0.0], [0.6, 0.8, 0.2]), true),
        ]);
        let found = bodies(&mesh).unwrap();
        assert_eq!((found.bodies, found.turned, found.surfaces.len()), (2, 1, 2));
        assert!(found.may_overlap());
        let shape = Shape::<3>::mesh(&mesh).unwrap();
        for x in [[0.5, 0.4, 0.1], [0.1, 0.4, 0.1], [0.5, 0.1, 0.1], [0.41, 0.31, 0.1]] {
            assert!(shape.contains(&x), "{x:?}");
        }
        assert!(!shape.contains(&[0.3, 0.2, 0.1]));
        assert!((shape.signed_distance(&[0.3, 0.2, 0.1]) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn boxes_that_touch_are_told_apart() {
        // In an edge, in a whole face, in a part of a face, in a corner.
        let others = [
            cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]),
            cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]),
            cuboid([1.0, 0.0, 0.0], [2.0, 0.5, 1.0]),
            cuboid([1.0; 3], [2.0; 3]),
        ];
        for other in others {
            let one = cuboid([0.0; 3], [1.0; 3]);
            let corners = [&one, &other].map(|m| (0..12).map(|t| m.corners(t)).collect::<Vec<_>>());
            let mesh = TriangleMesh::from_corners(corners.concat()).unwrap();
            let parts = separated(&mesh).unwrap();
            assert_eq!(parts.len(), 2, "{other:?}");
            let mesh = together(&parts.map_to_pairs());
            let found = bodies(&mesh).unwrap();
            assert_eq!(found.bodies, 2);
            let shape = Shape::<3>::mesh(&mesh).unwrap();
            assert!(shape.contains(&[0.9; 3]) && !shape.contains(&[0.5, 0.5, 1.1]));
        }
    }

    trait Pairs {
        fn map_to_pairs(self) -> Vec<(TriangleMesh, bool)>;
    }

    impl Pairs for Vec<TriangleMesh> {
        fn map_to_pairs(self) -> Vec<(TriangleMesh, bool)> {
            self.into_iter().map(|part| (part, false)).collect()
        }
    }
}
