//! Where fluid can be, and the layer of material beside it.
//!
//! [`wall_particles`] are whole cells of the lattice: a cell is material when its middle is. A wall on
//! the side of cells lies half a spacing from the last layer of fluid and half a spacing from the first
//! layer of wall particles, and fluid and walls together are a perfect lattice. Any other wall becomes a
//! stair whose steps lie up to half a spacing from it. Where that matters,
//! [`wall_elements`](crate::wall_elements) cut the cells at the surface.
//!
//! Moving whole cells along the normal into layers at depths of (k + ½) spacings measured worse than a
//! stair: particles come as close as 0.17 spacings, and `ΣVW − 1` at the fluid beside tilted walls grows
//! from 0.005 to between 0.016 and 0.06, at worst 0.19 (`examples/wall_quality.rs`).

use crate::aabb::Aabb;
use crate::lattice::{CellBox, Lattice, LatticeError, LatticeRuns, ON_SURFACE, Reach, axis_name};
use crate::solid::{Solid, depth_in_solids};

/// Where particles may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain<const D: usize> {
    /// The box; finite.
    pub bounds: Aabb<D>,
    /// Axes along which the box repeats. It must hold a whole number of cells there, and solids
    /// are given as they appear inside the box, both parts if they cross its sides.
    pub periodic: [bool; D],
}

impl<const D: usize> Domain<D> {
    /// A box that does not repeat.
    pub fn new(bounds: Aabb<D>) -> Self {
        Self { bounds, periodic: [false; D] }
    }

    /// The box without its periodic sides, which bound nothing.
    fn walls(&self) -> Aabb<D> {
        let mut walls = self.bounds;
        for k in (0..D).filter(|&k| self.periodic[k]) {
            (walls.min[k], walls.max[k]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        walls
    }

    /// Cells of the domain, and `margin` (m) around it along axes that do not repeat.
    pub(crate) fn cells(
        &self,
        lattice: &Lattice<D>,
        margin: f64,
    ) -> Result<CellBox<D>, LatticeError> {
        let mut cells = lattice.cells("domain", &self.bounds.inflated(margin))?;
        let spacing = lattice.spacing();
        for k in (0..D).filter(|&k| self.periodic[k]) {
            let length = self.bounds.max[k] - self.bounds.min[k];
            let count = (length / spacing).round().max(1.0);
            if (length / spacing - count).abs() > ON_SURFACE * count {
                return Err(LatticeError::Period {
                    axis: axis_name(k),
                    length,
                    cells: length / spacing,
                    nearest: length / count,
                });
            }
            // The first cell whose middle is inside.
            let low = (self.bounds.min[k] - lattice.origin()[k]) / spacing;
            cells.first[k] = (low - 0.5 - ON_SURFACE).ceil() as i64;
            cells.end[k] = cells.first[k] + count as i64;
        }
        lattice.checked(cells)
    }
}

/// Particles of walls.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WallParticles<const D: usize> {
    /// Positions, m.
    pub positions: Vec<[f64; D]>,
    /// Index of the solid of each particle.
    pub solids: Vec<u32>,
    /// Unit vectors out of that solid into the fluid, at the nearest point of its surface.
    pub normals: Vec<[f64; D]>,
    /// Depths below the surface of that solid in m, zero on it; exact where its signed distance is.
    pub depths: Vec<f64>,
}

/// The lattice points where fluid can be: inside the domain and outside of all material. Points on
/// a wall, up to a millionth of the spacing, belong to the material.
pub fn free_cells<const D: usize>(
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    domain: &Domain<D>,
) -> Result<LatticeRuns<D>, LatticeError> {
    let cells = domain.cells(lattice, 0.0)?;
    let walls = domain.walls();
    let margin = ON_SURFACE * lattice.spacing();
    Ok(LatticeRuns::trace(*lattice, cells, |x| {
        depth_in_solids(solids, x).max(walls.signed_distance(x)) + margin
    }))
}

/// The first solid whose material a point lies in or on, up to a millionth of the spacing.
pub fn solid_at<const D: usize>(
    solids: &[Solid<D>],
    x: &[f64; D],
    lattice: &Lattice<D>,
) -> Option<usize> {
    let margin = ON_SURFACE * lattice.spacing();
    solids.iter().position(|solid| solid.depth_in_solid(x) >= -margin)
}

/// The material less than a support radius below the surface.
pub(crate) struct Layer<const D: usize> {
    material: LatticeRuns<D>,
    free: LatticeRuns<D>,
    reach: Reach<D>,
}

impl<const D: usize> Layer<D> {
    /// The lattice points deeper than `least` (m, negative outside of the material) and less deep than
    /// `support` (m).
    pub fn trace(
        solids: &[Solid<D>],
        lattice: &Lattice<D>,
        support: f64,
        domain: &Domain<D>,
        least: f64,
    ) -> Result<Self, LatticeError> {
        if !support.is_finite() || support <= 0.0 {
            return Err(LatticeError::Support { support });
        }
        let free = free_cells(solids, lattice, domain)?;
        let reach = Reach::new(support / lattice.spacing(), domain.periodic);
        let margin = ON_SURFACE * lattice.spacing();
        let around = domain.cells(lattice, support)?;
        let material = LatticeRuns::trace(*lattice, around, |x| {
            let depth = depth_in_solids(solids, x);
            (least - depth).max(depth - support + margin)
        });
        Ok(Self { material, free, reach })
    }

    /// Those that lie less than the support radius from a cell where fluid can be.
    pub fn near_fluid(&self) -> impl Iterator<Item = [i64; D]> + '_ {
        self.material.indices().filter(|index| self.free.is_near(index, &self.reach))
    }
}

/// Makes the wall particles: the lattice points inside material that lie
///
/// * less than `support` (m) below the surface of the material, and
/// * less than `support` from a cell where fluid can be ([`free_cells`]).
///
/// The order is that of the lattice, x fastest. A point in several solids is made once and belongs
/// to the first of them. No particle is made for the domain itself: outside of it there are only
/// particles of solids.
pub fn wall_particles<const D: usize>(
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    support: f64,
    domain: &Domain<D>,
) -> Result<WallParticles<D>, LatticeError> {
    let margin = ON_SURFACE * lattice.spacing();
    let layer = Layer::trace(solids, lattice, support, domain, -margin)?;
    let mut particles = WallParticles::default();
    for index in layer.near_fluid() {
        let position = lattice.point(&index);
        if let Some(solid) = solid_at(solids, &position, lattice) {
            let (depth, normal) = solids[solid].depth_and_normal(&position);
            particles.positions.push(position);
            particles.solids.push(solid as u32);
            particles.normals.push(normal);
            particles.depths.push(depth.max(0.0));
        }
    }
    Ok(particles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use crate::solid::FluidSide;
    use proptest::prelude::*;

    const SUPPORT: f64 = 0.3;

    fn lattice<const D: usize>() -> Lattice<D> {
        Lattice::new([0.0; D], 0.1).unwrap()
    }

    fn tank<const D: usize>(size: [f64; D]) -> Solid<D> {
        Solid::new("tank", Shape::cuboid([0.0; D], size).unwrap(), FluidSide::Inside)
    }

    fn walls<const D: usize>(solids: &[Solid<D>], domain: &Domain<D>) -> WallParticles<D> {
        wall_particles(solids, &lattice(), SUPPORT, domain).unwrap()
    }

    /// Distance of a point from the cell around a lattice point.
    fn to_cell(x: &[f64; 2], cell: &[f64; 2]) -> f64 {
        Aabb::new(*cell, *cell).inflated(0.05).signed_distance(x).max(0.0)
    }

    proptest! {
        #[test]
        fn walls_agree_with_brute_force(
            center in prop::array::uniform2(0.0..2.0),
            radius in 0.1..0.6,
            floor in -0.1..0.5,
            slope in -1.0..1.0,
        ) {
            let ball = Shape::sphere(center, radius).unwrap();
            let slope = Shape::half_space([1.0, floor], [slope, 1.0]).unwrap();
            let solids = [
                Solid::new("slope", slope, FluidSide::Outside),
                Solid::new("ball", ball, FluidSide::Outside),
                tank([2.0, 1.0]),
            ];
            let domain = Domain::new(Aabb::new([0.0, 0.0], [2.0, 0.8]));
            let found = walls(&solids, &domain);

            let all: Vec<[f64; 2]> = (-10..20)
                .flat_map(|y| (-10..30).map(move |x| lattice().point(&[x, y])))
                .collect();
            let on = ON_SURFACE * lattice::<2>().spacing();
            let depth = |x: &[f64; 2]| depth_in_solids(&solids, x);
            let is_free = |x: &&[f64; 2]| domain.bounds.contains(x) && depth(x) < -on;
            let free: Vec<&[f64; 2]> = all.iter().filter(is_free).collect();
            let mut expected = WallParticles::default();
            for x in &all {
                let near = free.iter().any(|cell| to_cell(x, cell) < SUPPORT - 1e-9);
                if near && depth(x) >= -on && depth(x) < SUPPORT - on {
                    let owner = solids.iter().position(|s| s.depth_in_solid(x) >= -on).unwrap();
                    expected.positions.push(*x);
                    expected.solids.push(owner as u32);
                    expected.normals.push(solids[owner].normal(x));
                    expected.depths.push(solids[owner].depth_in_solid(x).max(0.0));
                }
            }
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_tank_gets_three_layers() {
        let domain = Domain::new(Aabb::new([0.0; 3], [1.0, 0.5, 0.4]));
        let found = walls(&[tank([1.0, 0.5, 0.4])], &domain);
        // The rounded corners lack cells, so count them by their distance from the box.
        let mut expected = 0;
        for [x, y, z] in
            (-9..19).flat_map(|z| (-9..19).flat_map(move |y| (-9..19).map(move |x| [x, y, z])))
        {
            let depth = domain.bounds.signed_distance(&lattice().point(&[x, y, z]));
            expected += usize::from(depth > 0.0 && depth < SUPPORT);
        }
        assert_eq!(found.positions.len(), expected);
        let on_floor =
            |p: &&[f64; 3]| p[2] < 0.0 && p[0] > 0.0 && p[0] < 0.1 && p[1] > 0.2 && p[1] < 0.3;
        assert_eq!(found.positions.iter().filter(on_floor).count(), 3);
        let floor: Vec<usize> = (0..expected).filter(|&i| on_floor(&&found.positions[i])).collect();
        for (i, depth) in floor.into_iter().zip([0.25, 0.15, 0.05]) {
            assert_eq!(found.normals[i], [0.0, 0.0, 1.0]);
            assert!((found.depths[i] - depth).abs() < 1e-12, "{}", found.depths[i]);
        }
    }

    #[test]
    fn nothing_under_the_middle_of_a_building() {
        let building = Shape::cuboid([0.5, 0.0], [1.5, 0.6]).unwrap();
        let solids = [tank([2.0, 1.0]), Solid::new("building", building, FluidSide::Outside)];
        let domain = Domain::new(Aabb::new([0.0, 0.0], [2.0, 1.0]));
        let found = walls(&solids, &domain);
        let at = |x: [f64; 2]| {
            let here = found.positions.iter().position(|p| crate::vector::distance(p, &x) < 1e-9);
            here.map(|index| found.solids[index])
        };
        assert_eq!(at([1.05, -0.05]), None); // the floor there sees no fluid
        assert_eq!(at([0.55, -0.05]), Some(0));
        assert_eq!(at([0.55, 0.05]), Some(1));
        assert_eq!(at([1.05, 0.25]), None); // too deep
        assert_eq!(at([1.05, 0.35]), Some(1));
    }

    #[test]
    fn a_point_in_two_solids_is_made_once_and_belongs_to_the_first() {
        let other = Shape::cuboid([-1.0, -1.0], [3.0, 0.2]).unwrap();
        let slab = Solid::new("slab", other, FluidSide::Outside);
        let domain = Domain::new(Aabb::new([0.0, 0.0], [2.0, 1.0]));
        for solids in [[tank([2.0, 1.0]), slab.clone()], [slab, tank([2.0, 1.0])]] {
            let found = walls(&solids, &domain);
            let mut sorted = found.positions.clone();
            sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
            sorted.dedup();
            assert_eq!(sorted.len(), found.positions.len());
            for (x, &owner) in found.positions.iter().zip(&found.solids) {
                let first = solids.iter().position(|s| s.depth_in_solid(x) > 0.0);
                assert_eq!(first, Some(owner as usize));
            }
        }
    }

    #[test]
    fn periodic_domains_end_at_their_sides_and_see_across_them() {
        let floor = Shape::half_space([0.0, 0.0], [0.0, 1.0]).unwrap();
        // A plate from the seam to the middle: its left side faces the fluid across the seam.
        let plate = Shape::cuboid([0.0, -1.0], [0.8, 2.0]).unwrap();
        let solids = [
            Solid::new("floor", floor, FluidSide::Outside),
            Solid::new("plate", plate, FluidSide::Outside),
        ];
        let bounds = Aabb::new([0.0, 0.0], [1.2, 0.5]);
        let domain = Domain { bounds, periodic: [true, false] };
        let found = walls(&solids, &domain);
        assert!(found.positions.iter().all(|x| x[0] > 0.0 && x[0] < 1.2));
        let count = |column: f64, closed: &WallParticles<2>| {
            let here = |x: &&[f64; 2]| (x[0] - column).abs() < 1e-9 && x[1] > 0.2 && x[1] < 0.3;
            closed.positions.iter().filter(here).count()
        };
        assert_eq!(count(0.55, &found), 1);
        assert_eq!(count(0.45, &found), 0);
        assert_eq!(count(0.05, &found), 1);
        assert_eq!(count(0.05, &walls(&solids, &Domain::new(bounds))), 0);
    }

    #[test]
    fn lengths_must_make_sense() {
        let domain = Domain { bounds: Aabb::new([0.0, 0.0], [1.03, 1.0]), periodic: [true, false] };
        let error = wall_particles(&[], &lattice(), SUPPORT, &domain).unwrap_err();
        assert!(matches!(error, LatticeError::Period { axis: 'x', .. }), "{error}");
        let domain = Domain::new(Aabb::EVERYWHERE);
        let error = wall_particles(&[], &lattice::<2>(), SUPPORT, &domain).unwrap_err();
        assert!(matches!(error, LatticeError::Unbounded { .. }), "{error}");
        let error = wall_particles(&[], &lattice::<2>(), -1.0, &domain).unwrap_err();
        assert!(matches!(error, LatticeError::Support { .. }), "{error}");
    }
}
