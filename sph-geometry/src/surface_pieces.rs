//! The surface of solids in pieces that are plane within a cell.

use crate::lattice::{CellBox, Lattice, LatticeRuns};
use crate::solid::{Solid, depth_in_solids};
use crate::vector::{add_scaled, dot, perpendicular, scaled, sub};
use std::array::from_fn;

/// A piece of surface in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece<const D: usize> {
    /// The cell: that of the material just below the piece.
    pub cell: [i64; D],
    /// Index of its solid.
    pub owner: usize,
    /// Middle, m.
    pub center: [f64; D],
    /// Unit vector out of the material.
    pub normal: [f64; D],
    /// m², m in two dimensions.
    pub area: f64,
    /// Curvatures along [`tangents`], 1/m: positive where the material is convex.
    pub curvature: [f64; 2],
}

/// Points along a cell at which a surface is looked at.
const SAMPLES: usize = 8;
/// Points along a cell from which its surfaces are looked for.
const LOOKS: i64 = 4;
/// Pieces of a cell whose normals have a cosine above this are one.
const SAME: f64 = 0.9;
/// A plane is the surface where it is closer to it than this part of the spacing.
const CLOSE: f64 = 0.06;
/// How far points are moved off a surface to see on which side of something they are, in spacings.
const OFF: f64 = 0.01;

/// Distance of the samples on a surface, m.
pub fn sample_distance<const D: usize>(lattice: &Lattice<D>) -> f64 {
    lattice.spacing() / SAMPLES as f64
}

/// Unit vectors along a plane: D − 1 of them, and zeros.
pub fn tangents<const D: usize>(normal: &[f64; D]) -> [[f64; D]; 2] {
    let first = perpendicular(normal);
    let second = match D {
        3 => {
            let ([a, b, c], [x, y, z]) = (from_fn(|k| normal[k]), from_fn(|k| first[k]));
            let across = [b * z - c * y, c * x - a * z, a * y - b * x];
            from_fn(|k| across[k])
        }
        _ => [0.0; D],
    };
    [first, second]
}

/// The cell in which a point lies.
pub fn cell_of<const D: usize>(lattice: &Lattice<D>, x: &[f64; D]) -> [i64; D] {
    from_fn(|k| ((x[k] - lattice.origin()[k]) / lattice.spacing()).floor() as i64)
}

/// The pieces of the surface of some solids in these cells, but for what lies in or on one of the others.
/// The order is that of the lattice, x fastest.
pub fn pieces<const D: usize>(
    solids: &[Solid<D>],
    others: &[Solid<D>],
    lattice: &Lattice<D>,
    cells: CellBox<D>,
) -> Vec<Piece<D>> {
    // A surface in a cell is at most half a diagonal from its middle.
    let near = 0.501 * lattice.spacing() * (D as f64).sqrt();
    let band = LatticeRuns::trace(*lattice, cells, |x| depth_in_solids(solids, x).abs() - near);
    let mut all = Vec::new();
    for cell in band.indices() {
        for (owner, foot, normal) in planes(solids, lattice, &cell) {
            let free = |x: &[f64; D]| {
                let rest = solids.iter().enumerate().filter(|(k, _)| *k != owner);
                let rest = rest.map(|(_, solid)| solid).chain(others);
                rest.fold(f64::NEG_INFINITY, |most, solid| most.max(solid.depth_above(x, most)))
                    < -1e-6 * lattice.spacing()
            };
            all.extend(piece(&solids[owner], owner, lattice, cell, &foot, &normal, free));
        }
    }
    all
}

/// The planes of the surface in a cell: solid, point and normal.
fn planes<const D: usize>(
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    cell: &[i64; D],
) -> Vec<(usize, [f64; D], [f64; D])> {
    let (spacing, center) = (lattice.spacing(), lattice.point(cell));
    let mut planes: Vec<(usize, [f64; D], [f64; D])> = Vec::new();
    let mut look = |x: &[f64; D]| {
        for (owner, solid) in solids.iter().enumerate() {
            if solid.depth_above(x, -spacing) <= -spacing {
                continue;
            }
            let (depth, normal) = solid.depth_and_normal(x);
            if depth.abs() > spacing {
                continue;
            }
            let foot = add_scaled(x, depth, &normal);
            // At edges normals lie between those of the faces, which shows a little way off.
            let flat = |side: f64| {
                let beside = add_scaled(&foot, side * OFF * spacing, &normal);
                (solid.depth_in_solid(&beside) / (OFF * spacing) + side).abs() < 0.1
            };
            let known = |plane: &(usize, [f64; D], [f64; D])| {
                plane.0 == owner
                    && dot(&plane.2, &normal) > SAME
                    && dot(&sub(&plane.1, &foot), &normal).abs() < 0.15 * spacing
            };
            if flat(1.0) && flat(-1.0) && !planes.iter().any(known) {
                planes.push((owner, foot, normal));
            }
        }
    };
    look(&center);
    for number in 0..LOOKS.pow(D as u32) {
        let mut rest = number;
        let x = from_fn(|k| {
            let i = rest % LOOKS;
            rest /= LOOKS;
            center[k] + ((i as f64 + 0.5) / LOOKS as f64 - 0.5) * spacing
        });
        look(&x);
    }
    planes
}

/// That part of a plane in a cell which is the surface of the solid and free.
fn piece<const D: usize>(
    solid: &Solid<D>,
    owner: usize,
    lattice: &Lattice<D>,
    cell: [i64; D],
    foot: &[f64; D],
    normal: &[f64; D],
    free: impl Fn(&[f64; D]) -> bool,
) -> Option<Piece<D>> {
    let (spacing, step) = (lattice.spacing(), sample_distance(lattice));
    let along = tangents(normal);
    let (center, origin) = (lattice.point(&cell), lattice.origin());
    let half = 0.5 * spacing * (D as f64).sqrt();
    // The samples of a plane are the same in all of its cells: counted from the origin.
    let range = |t: &[f64; D]| {
        let middle = dot(&sub(&center, &origin), t);
        let number = |x: f64| (x / step - 0.5).round() as i64;
        if *t == [0.0; D] { 0..1 } else { number(middle - half)..number(middle + half) + 1 }
    };
    let place = |i: i64, t: &[f64; D]| {
        if *t == [0.0; D] { 0.0 } else { (i as f64 + 0.5) * step - dot(&sub(foot, &origin), t) }
    };
    let (mut count, mut sum) = (0_u32, [0.0; D]);
    for i in range(&along[0]) {
        for j in range(&along[1]) {
            let x = add_scaled(foot, place(i, &along[0]), &along[0]);
            let x = add_scaled(&x, place(j, &along[1]), &along[1]);
            let below = add_scaled(&x, -1e-6 * spacing, normal);
            if cell_of(lattice, &below) == cell
                && solid.depth_in_solid(&x).abs() < CLOSE * spacing
                && free(&x)
            {
                count += 1;
                sum = add_scaled(&sum, 1.0, &x);
            }
        }
    }
    if count == 0 {
        return None;
    }
    let center = scaled(1.0 / f64::from(count), &sum);
    Some(Piece {
        cell,
        owner,
        center,
        normal: *normal,
        area: f64::from(count) * step.powi(D as i32 - 1),
        curvature: along.map(|t| curvature(solid, &center, normal, &t, 0.5 * spacing)),
    })
}

/// Curvature of a surface along a tangent at a point, 1/m; 0 at an edge.
fn curvature<const D: usize>(
    solid: &Solid<D>,
    x: &[f64; D],
    normal: &[f64; D],
    tangent: &[f64; D],
    step: f64,
) -> f64 {
    if *tangent == [0.0; D] {
        return 0.0;
    }
    let [before, after] = [-step, step].map(|step| {
        let beside = add_scaled(x, step, tangent);
        let (depth, found) = solid.depth_and_normal(&beside);
        (depth.abs() < 0.5 * step.abs() && dot(&found, normal) > SAME).then_some(found)
    });
    match (before, after) {
        (Some(before), Some(after)) => dot(&sub(&after, &before), tangent) / (2.0 * step),
        _ => 0.0,
    }
}
