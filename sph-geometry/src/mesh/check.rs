//! Whether a mesh is a closed, consistently oriented surface.

use super::sets::Sets;
use super::{MeshError, TriangleMesh, is_collapsed, sides};
use crate::aabb::Aabb;
use crate::vector::{add_scaled, cross, dot, norm, scaled, sub};
use std::fmt;

/// How many places of a defect are kept.
const PLACES: usize = 5;
/// A triangle is degenerate when its height is below this fraction of its longest edge.
const THINNEST: f64 = 1e-9;
/// A surface encloses nothing when its volume is below this fraction of its area to the power 3/2.
pub(super) const NO_VOLUME: f64 = 1e-12;

/// Places where something is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Defects {
    /// What they are, in the singular.
    pub kind: &'static str,
    /// How many.
    pub count: usize,
    /// Where the first ones are: middles of edges or triangles, m.
    pub places: Vec<[f64; 3]>,
}

impl Defects {
    pub(super) fn new(kind: &'static str) -> Self {
        Self { kind, ..Self::default() }
    }

    pub(super) fn add(&mut self, place: [f64; 3]) {
        self.count += 1;
        if self.places.len() < PLACES {
            self.places.push(place);
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl fmt::Display for Defects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}{}", self.count, self.kind, if self.count == 1 { "" } else { "s" })?;
        for (index, [x, y, z]) in self.places.iter().enumerate() {
            write!(f, "{}({x:.6}, {y:.6}, {z:.6})", if index == 0 { " at " } else { ", " })?;
        }
        if self.count > self.places.len() { f.write_str(", …") } else { Ok(()) }
    }
}

/// What [`check`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshReport {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of parts whose triangles are connected by edges.
    pub shells: usize,
    /// Edges of one triangle: the rims of holes.
    pub open_edges: Defects,
    /// Edges of three or more triangles.
    pub crowded_edges: Defects,
    /// Edges whose two triangles disagree about which side is outside.
    pub inconsistent_edges: Defects,
    /// Triangles without area. They do no harm to a closed surface.
    pub degenerate_triangles: Defects,
    /// Triangles with the same corners as an earlier one.
    pub duplicate_triangles: Defects,
    /// Volume in m³, negative when the surface is inside out. Means something only for closed,
    /// consistently oriented surfaces.
    pub volume: f64,
    /// Volume of all shells in m³, whichever way each faces.
    pub enclosed: f64,
    /// Area, m².
    pub area: f64,
    /// The smallest box around all vertices.
    pub bounding_box: Aabb<3>,
}

impl MeshReport {
    /// Whether every edge belongs to exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.open_edges.is_empty() && self.crowded_edges.is_empty()
    }

    /// Whether neighbouring triangles agree about which side is outside.
    pub fn is_oriented(&self) -> bool {
        self.inconsistent_edges.is_empty()
    }

    /// Whether the triangles face inwards. Harmless: such a mesh is turned over when it becomes a
    /// shape.
    pub fn is_inside_out(&self) -> bool {
        self.volume < 0.0
    }

    /// Why the mesh bounds no solid; `None` when it does.
    pub fn error(&self) -> Option<MeshError> {
        // Duplicates and holes make other defects; the cause comes first.
        if !self.duplicate_triangles.is_empty() {
            Some(MeshError::Duplicate { triangles: self.duplicate_triangles.clone() })
        } else if !self.open_edges.is_empty() {
            Some(MeshError::Open { edges: self.open_edges.clone() })
        } else if !self.crowded_edges.is_empty() {
            Some(MeshError::Crowded { edges: self.crowded_edges.clone() })
        } else if !self.inconsistent_edges.is_empty() {
            Some(MeshError::Inconsistent { edges: self.inconsistent_edges.clone() })
        } else if self.enclosed <= NO_VOLUME * self.area.powf(1.5) {
            Some(MeshError::NoVolume)
        } else {
            None
        }
    }
}

/// Looks for everything that would make inside and outside of a mesh ambiguous, save triangles
/// that cut through each other. Fails when there is no mesh to speak of: no triangles, coordinates
/// that are not finite, corners that do not exist.
pub fn check(mesh: &TriangleMesh) -> Result<MeshReport, MeshError> {
    mesh.validate()?;
    let mut report = MeshReport {
        vertices: mesh.vertices.len(),
        triangles: mesh.triangles.len(),
        shells: 0,
        open_edges: Defects::new("edge"),
        crowded_edges: Defects::new("edge"),
        inconsistent_edges: Defects::new("edge"),
        degenerate_triangles: Defects::new("triangle"),
        duplicate_triangles: Defects::new("triangle"),
        volume: 0.0,
        enclosed: 0.0,
        area: 0.0,
        bounding_box: mesh.bounding_box(),
    };
    measure(mesh, &mut report);
    duplicates(mesh, &mut report);
    edges(mesh, &mut report);
    Ok(report)
}

pub(super) fn middle(mesh: &TriangleMesh, triangle: usize) -> [f64; 3] {
    let [a, b, c] = mesh.corners(triangle);
    scaled(1.0 / 3.0, &add_scaled(&add_scaled(&a, 1.0, &b), 1.0, &c))
}

/// Volume by the divergence theorem, `V = Σ a·(b × c)/6`, from a corner of the box so that the
/// distance from the origin costs no digits; area; triangles without area.
fn measure(mesh: &TriangleMesh, report: &mut MeshReport) {
    for triangle in 0..mesh.triangles.len() {
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners.map(|x| sub(&x, &report.bounding_box.min));
        let [ab, bc, ca] = [sub(&b, &a), sub(&c, &b), sub(&a, &c)];
        let twice_area = norm(&cross(&ab, &bc));
        let longest = norm(&ab).max(norm(&bc)).max(norm(&ca));
        if twice_area <= THINNEST * longest * longest {
            report.degenerate_triangles.add(middle(mesh, triangle));
        }
        report.area += 0.5 * twice_area;
        report.volume += wedge(mesh, triangle, &report.bounding_box.min);
    }
}

/// Volume between a triangle and a point, m³.
pub(super) fn wedge(mesh: &TriangleMesh, triangle: usize, point: &[f64; 3]) -> f64 {
    let [a, b, c] = mesh.corners(triangle).map(|x| sub(&x, point));
    dot(&a, &cross(&b, &c)) / 6.0
}

fn duplicates(mesh: &TriangleMesh, report: &mut MeshReport) {
    let mut sorted: Vec<([u32; 3], usize)> = (0..mesh.triangles.len())
        .map(|triangle| {
            let mut corners = mesh.triangles[triangle];
            corners.sort_unstable();
            (corners, triangle)
        })
        .collect();
    sorted.sort_unstable();
    for pair in sorted.windows(2) {
        if pair[0].0 == pair[1].0 && !is_collapsed(&pair[0].0) {
            report.duplicate_triangles.add(middle(mesh, pair[1].1));
        }
    }
}

fn edges(mesh: &TriangleMesh, report: &mut MeshReport) {
    let sides = sides::sorted(mesh);
    let mut shells = Sets::new(mesh.triangles.len());
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        let [a, b] = edge[0].ends.map(|vertex| mesh.vertices[vertex as usize]);
        let place = scaled(0.5, &add_scaled(&a, 1.0, &b));
        match edge {
            [_] => report.open_edges.add(place),
            [one, other] if one.forward == other.forward => report.inconsistent_edges.add(place),
            [_, _] => {}
            _ => report.crowded_edges.add(place),
        }
        for pair in edge.windows(2) {
            shells.join(pair[0].triangle, pair[1].triangle);
        }
    }
    let mut volumes = vec![0.0; mesh.triangles.len()];
    for triangle in 0..mesh.triangles.len() {
        volumes[shells.root(triangle)] += wedge(mesh, triangle, &report.bounding_box.min);
    }
    report.enclosed = volumes.iter().map(|volume| volume.abs()).sum();
    report.shells = (0..mesh.triangles.len())
        .filter(|&t| !is_collapsed(&mesh.triangles[t]) && shells.root(t) == t)
        .count();
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sphere() -> TriangleMesh {
        TriangleMesh::sphere([0.0; 3], 1.0, 2)
    }

    proptest! {
        #[test]
        fn a_missing_triangle_leaves_a_hole(triangle in 0..320usize) {
            let mut mesh = sphere();
            let removed = mesh.corners(triangle);
            mesh.triangles.remove(triangle);
            let report = check(&mesh).unwrap();
            prop_assert!(!report.is_closed() && report.is_oriented());
            prop_assert_eq!(report.open_edges.count, 3);
            for place in &report.open_edges.places {
                let middles = [0, 1, 2].map(|k| {
                    scaled(0.5, &add_scaled(&removed[k], 1.0, &removed[(k + 1) % 3]))
                });
                prop_assert!(middles.iter().any(|m| crate::vector::distance(m, place) < 1e-15));
            }
            prop_assert!(matches!(report.error(), Some(MeshError::Open { .. })), "{:?}", report);
        }

        #[test]
        fn a_flipped_triangle_disagrees_with_three(triangle in 0..320usize) {
            let mut mesh = sphere();
            mesh.triangles[triangle].swap(0, 1);
            let report = check(&mesh).unwrap();
            prop_assert!(report.is_closed() && !report.is_oriented());
            prop_assert_eq!(report.inconsistent_edges.count, 3);
            prop_assert!(matches!(report.error(), Some(MeshError::Inconsistent { .. })), "{:?}", report);
        }

        #[test]
        fn a_triangle_given_twice_is_found(triangle in 0..320usize, turn in 0..3usize) {
            let mut mesh = sphere();
            let mut copy = mesh.triangles[triangle];
            copy.rotate_left(turn);
            mesh.triangles.push(copy);
            let report = check(&mesh).unwrap();
            prop_assert_eq!(report.duplicate_triangles.count, 1);
            prop_assert_eq!(report.crowded_edges.count, 3);
            prop_assert!(matches!(report.error(), Some(MeshError::Duplicate { .. })), "{:?}", report);
        }

        #[test]
        fn volume_and_area_do_not_depend_on_the_place(shift in -1e4..1e4) {
            let mesh = TriangleMesh::cuboid([shift; 3], [shift + 1.0, shift + 2.0, shift + 4.0]);
            let report = check(&mesh).unwrap();
            prop_assert!((report.volume - 8.0).abs() < 1e-10 && (report.area - 28.0).abs() < 1e-10);
        }
    }

    #[test]
    fn inside_out_is_seen_and_harmless() {
        let report = check(&sphere().flipped()).unwrap();
        assert!(report.is_inside_out() && report.error().is_none());
    }

    #[test]
    fn two_boxes_that_share_an_edge() {
        let mut corners = Vec::new();
        for mesh in [
            TriangleMesh::cuboid([0.0; 3], [1.0; 3]),
            TriangleMesh::cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]),
        ] {
            corners.extend((0..12).map(|triangle| mesh.corners(triangle)));
        }
        let report = check(&TriangleMesh::from_corners(corners).unwrap()).unwrap();
        assert_eq!(report.crowded_edges.count, 1);
        assert_eq!(report.crowded_edges.places, [[1.0, 1.0, 0.5]]);
        let message = report.error().unwrap().to_string();
        assert!(message.starts_with("1 edge at (1.000000, 1.000000, 0.500000)"), "{message}");
    }

    #[test]
    fn shells_are_counted_and_slivers_do_no_harm() {
        let mut mesh = sphere();
        let other = TriangleMesh::cuboid([5.0; 3], [6.0; 3]);
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(&other.vertices);
        mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|vertex| vertex + first)));
        assert_eq!(check(&mesh).unwrap().shells, 2);
        // Split an edge of the box on one side only and close the gap with a flat triangle.
        let [a, b, c] = *mesh.triangles.last().unwrap();
        let new = mesh.vertices.len() as u32;
        let [from, to] = [a, b].map(|vertex| mesh.vertices[vertex as usize]);
        mesh.vertices.push(scaled(0.5, &add_scaled(&from, 1.0, &to)));
        mesh.triangles.pop();
        mesh.triangles.extend([[a, new, c], [new, b, c], [a, b, new]]);
        let report = check(&mesh).unwrap();
        assert_eq!(report.degenerate_triangles.count, 1);
        assert!(report.error().is_none() && report.shells == 2);
    }

    #[test]
    fn a_sheet_of_two_sides_has_no_volume() {
        // Two triangles over the same corners plus a corner of their own each would be needed for
        // a volume; a flat pillow of four triangles has none.
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let report = check(&TriangleMesh { vertices, triangles }).unwrap();
        assert!(report.is_closed() && report.is_oriented());
        assert!(matches!(report.error(), Some(MeshError::NoVolume)));
    }

    #[test]
    fn no_mesh_to_speak_of() {
        assert!(matches!(check(&TriangleMesh::default()), Err(MeshError::Empty)));
        let mut mesh = sphere();
        mesh.triangles[3][1] = 4000;
        let error = check(&mesh).unwrap_err();
        assert!(matches!(error, MeshError::Index { triangle: 3, index: 4000, .. }));
        mesh = sphere();
        mesh.vertices[7][2] = f64::NAN;
        assert!(matches!(check(&mesh), Err(MeshError::NotFinite { vertex: 7, .. })));
    }
}
