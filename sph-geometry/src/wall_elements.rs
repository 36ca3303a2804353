//! Wall elements: what a wall is made of for the fluid beside it.
//!
//! Every cell of the lattice that holds material down to one support radius below the surface gives
//! one element: the material in the cell, at its centroid. A cell that the surface cuts has a part of
//! the volume of a whole one, so that walls at any angle to the lattice are as deep and as smooth as
//! those along it, and walls on cell sides are whole cells in the middle of cells, a perfect lattice
//! with the fluid.

use crate::boundary::{Domain, Layer};
use crate::lattice::{Lattice, LatticeError, ON_SURFACE};
use crate::solid::Solid;

/// Elements of walls, structure of arrays.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WallElements<const D: usize> {
    /// Centroids of the material, m.
    pub positions: Vec<[f64; D]>,
    /// Volumes of the material, m^D.
    pub volumes: Vec<f64>,
    /// Index of the solid of each element.
    pub solids: Vec<u32>,
    /// Unit vectors out of the material at the nearest point of the surface.
    pub normals: Vec<[f64; D]>,
    /// Depths below the surface, m.
    pub depths: Vec<f64>,
}

/// Sub-cells along the edge of a cell that the surface cuts.
const SUB_CELLS: i32 = 8;

/// Less material than this share of a cell is left out: it would be a particle without weight.
const SMALLEST_SHARE: f64 = 0.02;

/// Makes the wall elements of solids: those in cells that lie
///
/// * less than `support` (m) below the surface of the material, and
/// * less than `support` from a cell where fluid can be.
///
/// The order is that of the lattice, x fastest. Material in several solids is made once and belongs to
/// the solid in which it is deepest, the first of equals. Nothing is made for the domain itself.
///
/// # Errors
///
/// As [`wall_particles`](crate::wall_particles).
pub fn wall_elements<const D: usize>(
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    support: f64,
    domain: &Domain<D>,
) -> Result<WallElements<D>, LatticeError> {
    let spacing = lattice.spacing();
    let margin = ON_SURFACE * spacing;
    // Half the diagonal of a cell: the surface may cut a cell whose middle is so far from it.
    let half = 0.5 * spacing * (D as f64).sqrt();
    let layer = Layer::trace(solids, lattice, support, domain, margin - half)?;
    let mut elements = WallElements::default();
    for index in layer.near_fluid() {
        let Some((position, share)) = element(solids, &lattice.point(&index), spacing) else {
            continue;
        };
        let mut deepest = (f64::NEG_INFINITY, None);
        for (k, solid) in solids.iter().enumerate() {
            let depth = solid.depth_above(&position, deepest.0);
            if depth > deepest.0 {
                deepest = (depth, Some(k));
            }
        }
        let Some(owner) = deepest.1 else { continue };
        elements.add(solids, owner, position, share * spacing.powi(D as i32));
    }
    Ok(elements)
}

impl<const D: usize> WallElements<D> {
    /// Adds those of other elements that are at places of this kind.
    pub(crate) fn extend_with(&mut self, other: &Self, is_here: impl Fn(&[f64; D]) -> bool) {
        for i in (0..other.positions.len()).filter(|&i| is_here(&other.positions[i])) {
            self.positions.push(other.positions[i]);
            self.volumes.push(other.volumes[i]);
            self.solids.push(other.solids[i]);
            self.normals.push(other.normals[i]);
            self.depths.push(other.depths[i]);
        }
    }

    /// Appends other elements.
    pub fn append(&mut self, mut other: Self) {
        self.positions.append(&mut other.positions);
        self.volumes.append(&mut other.volumes);
        self.solids.append(&mut other.solids);
        self.normals.append(&mut other.normals);
        self.depths.append(&mut other.depths);
    }

    /// Adds an element of solid number `owner`.
    pub(crate) fn add(
        &mut self,
        solids: &[Solid<D>],
        owner: usize,
        position: [f64; D],
        volume: f64,
    ) {
        let (depth, normal) = solids[owner].depth_and_normal(&position);
        self.positions.push(position);
        self.volumes.push(volume);
        self.solids.push(owner as u32);
        self.normals.push(normal);
        self.depths.push(depth);
    }
}

/// [`material`] in the cell around a lattice point.
pub(crate) fn element<const D: usize>(
    solids: &[Solid<D>],
    center: &[f64; D],
    spacing: f64,
) -> Option<([f64; D], f64)> {
    let half = 0.5 * spacing * (D as f64).sqrt();
    material(solids, center, spacing, half, ON_SURFACE * spacing)
}

/// Centroid of the material in a cell, and the share of the cell that it fills. Solids are taken for
/// half spaces within a cell.
fn material<const D: usize>(
    solids: &[Solid<D>],
    center: &[f64; D],
    spacing: f64,
    half: f64,
    margin: f64,
) -> Option<([f64; D], f64)> {
    let depths: Vec<f64> = solids.iter().map(|solid| solid.depth_above(center, -half)).collect();
    if depths.iter().any(|depth| *depth >= half - margin) {
        return Some((*center, 1.0));
    }
    let cutting = depths.iter().zip(solids).filter(|(depth, _)| **depth > -half);
    let planes: Vec<(f64, [f64; D])> =
        cutting.map(|(depth, solid)| (*depth, solid.normal(center))).collect();
    let total = SUB_CELLS.pow(D as u32);
    let (mut count, mut sum) = (0, [0.0; D]);
    for number in 0..total {
        let mut rest = number;
        let offset: [f64; D] = std::array::from_fn(|_| {
            let k = rest % SUB_CELLS;
            rest /= SUB_CELLS;
            ((f64::from(k) + 0.5) / f64::from(SUB_CELLS) - 0.5) * spacing
        });
        let inside = |(depth, normal): &(f64, [f64; D])| {
            let along: f64 = (0..D).map(|k| normal[k] * offset[k]).sum();
            depth - along >= -margin
        };
        if planes.iter().any(inside) {
            count += 1;
            for k in 0..D {
                sum[k] += offset[k];
            }
        }
    }
    let share = f64::from(count) / f64::from(total);
    if count == total {
        return Some((*center, 1.0));
    }
    if share < SMALLEST_SHARE {
        return None;
    }
    Some((std::array::from_fn(|k| center[k] + sum[k] / f64::from(count)), share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aabb::Aabb;
    use crate::boundary::wall_particles;
    use crate::shape::Shape;
    use crate::solid::FluidSide;
    use proptest::prelude::*;

    const SUPPORT: f64 = 0.3;

    fn lattice<const D: usize>() -> Lattice<D> {
        Lattice::new([0.0; D], 0.1).unwrap()
    }

    #[test]
    fn walls_on_cell_sides_are_whole_cells() {
        let shape = Shape::cuboid([0.0; 3], [1.0, 0.5, 0.4]).unwrap();
        let tank = [Solid::new("tank", shape, FluidSide::Inside)];
        let domain = Domain::new(Aabb::new([0.0; 3], [1.0, 0.5, 0.4]));
        let cells = wall_particles(&tank, &lattice(), SUPPORT, &domain).unwrap();
        let elements = wall_elements(&tank, &lattice(), SUPPORT, &domain).unwrap();
        assert_eq!(elements.positions, cells.positions);
        assert!(elements.volumes.iter().all(|volume| (volume - 1e-3).abs() < 1e-15));
    }

    /// ∫ ∇W dV over a wall, as a particle at a point sees it, with the kernel Wendland C2 without its
    /// norm.
    fn push(elements: &WallElements<2>, x: [f64; 2]) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for k in 0..elements.positions.len() {
            let r: [f64; 2] = std::array::from_fn(|a| x[a] - elements.positions[k][a]);
            let q = r[0].hypot(r[1]) / SUPPORT;
            let slope = -20.0 * (1.0 - q).max(0.0).powi(3) / (SUPPORT * SUPPORT);
            (0..2).for_each(|a| sum[a] += elements.volumes[k] * slope * r[a]);
        }
        sum
    }

    /// The same for a plane at a distance, by Gauss's theorem: ∫ W along the surface.
    fn push_of_plane(height: f64) -> f64 {
        let steps = 2000;
        let w = |t: f64| {
            let q = t.hypot(height) / SUPPORT;
            (1.0 - q).max(0.0).powi(4) * (1.0 + 4.0 * q)
        };
        let step = 2.0 * SUPPORT / f64::from(steps);
        (0..steps).map(|k| step * w((f64::from(k) + 0.5) * step - SUPPORT)).sum()
    }

    proptest! {
        #[test]
        fn a_tilted_wall_pushes_almost_as_a_plane_does(
            angle in 0.0..1.57_f64,
            shift in -0.05..0.05_f64,
            along in -0.5..0.5_f64,
            height in 0.05..0.2_f64,
        ) {
            let normal: [f64; 2] = [-angle.sin(), angle.cos()];
            let point: [f64; 2] = [-shift * normal[0], -shift * normal[1]];
            let tangent: [f64; 2] = [normal[1], -normal[0]];
            let floor = Shape::half_space(point, normal).unwrap();
            let solids = [Solid::new("floor", floor, FluidSide::Outside)];
            let domain = Domain::new(Aabb::new([-1.5, -1.5], [1.5, 1.5]));
            let elements = wall_elements(&solids, &lattice::<2>(), SUPPORT, &domain).unwrap();
            let x: [f64; 2] = std::array::from_fn(|k| {
                point[k] + height * normal[k] + along * tangent[k]
            });
            let found = push(&elements, x);
            let back = -(found[0] * normal[0] + found[1] * normal[1]);
            let across = found[0] * tangent[0] + found[1] * tangent[1];
            // Relative to the push on the first layer of a fluid. A lattice differs from an integral by
            // up to a tenth at any angle.
            let scale = push_of_plane(0.05);
            prop_assert!((back - push_of_plane(height)).abs() < 0.1 * scale, "{back}");
            prop_assert!(across.abs() < 0.08 * scale, "{across}");
        }
    }
}
