//! Particles of wildly different radii, in k-d trees.

mod place;
mod tree;

use crate::{Grid, GridError};
use place::{Place, place};
use rayon::prelude::*;
pub(crate) use tree::Tree;

/// Particles of different radii in one k-d tree per factor of two: a choice for radii that differ by
/// more than 1 : 10⁴. Needs the feature `kiddo`.
///
/// A search visits every tree with the largest radius in it, so small particles never search at the
/// largest radius of all.
///
/// The canonical order is that of a [`LevelList`](crate::LevelList): by level, largest radii first,
/// then by cell, then by id. There levels end when the cells have been halved 12 times, and all
/// smaller particles share a level; here they go on, up to 60 times. With radii of up to 1 : 4096
/// [`build_with_tree`](crate::NeighborList::build_with_tree) gives what
/// [`build_with_radii`](crate::NeighborList::build_with_radii) gives, in the same order, but for the
/// sources that the latter lists beyond the reach.
///
/// # When to choose it
///
/// * When radii differ by more than about 1 : 10⁴. A `LevelList` has the resolution of its coarsest
///   grid, a millionth of the largest radius, while here distances are computed from the positions in
///   `f64`. And beyond 1 : 4096 its smallest particles crowd in cells that are too large for them. On
///   50 000 particles with radii of 1 : 10⁶ it lists 57 % too many neighbours and takes three times
///   as long as the trees; with 1 : 10⁴ it lists 0.4 % too many and takes less than half as long.
/// * When lists must hold exactly the neighbours within reach, whatever the radii.
/// * When particles lie further from the origin than the finest cells can be numbered, 2²⁰ of them in
///   three dimensions: here positions have no range, short of 10¹⁵⁰.
///
/// Otherwise choose a `LevelList`: with radii of 1 : 100 it takes about a third of the time. The
/// README has the table.
///
/// ```
/// use sph_neighbors::{Grid, NeighborList, PairReach, TreeList};
///
/// let positions = [[0.0, 0.0], [0.4, 0.0], [0.400_001, 0.0]];
/// let radii = [1.0, 1e-6, 2e-6];
/// let grid = Grid::new([0.0, 0.0], 0.5)?;
/// let trees = TreeList::build(&grid, &positions, &radii, &[0, 1, 2])?;
/// let rule = PairReach::Mean;
/// let list = NeighborList::build_with_tree(&trees, &positions, &radii, |t| t as u32, rule, 1);
/// assert_eq!([list.of(0), list.of(1), list.of(2)], [&[2, 1][..], &[0, 2], &[0, 1]]);
/// # Ok::<(), sph_neighbors::GridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TreeList<const D: usize> {
    grid: Grid<D>,
    levels: Vec<TreeLevel<D>>,
    /// Input index by place in canonical order; those outside come last.
    order: Vec<u32>,
    /// Coordinates and radii in canonical order, of those that are not outside.
    coordinates: Vec<[f64; D]>,
    radii: Vec<f64>,
}

/// Particles of one level that is not empty.
#[derive(Debug, Clone)]
pub(crate) struct TreeLevel<const D: usize> {
    /// Place of the first in canonical order.
    pub first: u32,
    /// Places from there on.
    pub tree: Tree<D>,
    /// The largest radius.
    pub largest_radius: f64,
    /// Lowest and highest coordinates.
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> TreeList<D> {
    /// Puts particles, given in any order, into trees. Levels and the canonical order are those of
    /// `grid`, whose cells should be half as large as the largest radius that may occur anywhere. Ids
    /// must differ within a cell.
    ///
    /// # Errors
    ///
    /// As [`LevelList::build`](crate::LevelList::build): when a radius is negative, not a number,
    /// larger than 4 cells of `grid`, or larger than half a period.
    ///
    /// # Panics
    ///
    /// When the slices differ in length, or hold 2³² particles or more.
    pub fn build(
        grid: &Grid<D>,
        positions: &[[f64; D]],
        radii: &[f64],
        ids: &[u64],
    ) -> Result<Self, GridError> {
        assert_eq!(positions.len(), radii.len(), "every position needs a radius");
        assert_eq!(positions.len(), ids.len(), "every position needs an id");
        assert!(u32::try_from(positions.len()).is_ok(), "indices have 32 bits");
        if let Some(error) = radii.iter().find_map(|&radius| grid.check_radius(radius).err()) {
            return Err(error);
        }
        let mut places: Vec<(Place<D>, u64, u32)> = (0..positions.len())
            .into_par_iter()
            .map(|i| (place(grid, &positions[i], radii[i]), ids[i], i as u32))
            .collect();
        places.par_sort_unstable();
        let order: Vec<u32> = places.iter().map(|place| place.2).collect();
        let inside = places.partition_point(|place| place.0 != Place::OUTSIDE);
        let coordinates: Vec<[f64; D]> =
            order[..inside].iter().map(|&i| coordinates_of(grid, &positions[i as usize])).collect();
        let radii: Vec<f64> = order[..inside].iter().map(|&i| radii[i as usize]).collect();
        let mut first = 0;
        let runs: Vec<_> = places[..inside]
            .chunk_by(|a, b| a.0.level == b.0.level)
            .map(|run| {
                first += run.len();
                first - run.len()..first
            })
            .collect();
        let level = |run: std::ops::Range<usize>| {
            TreeLevel::new(run.start as u32, &coordinates[run.clone()], &radii[run])
        };
        let levels = runs.into_par_iter().map(level).collect();
        Ok(Self { grid: *grid, levels, order, coordinates, radii })
    }

    /// The coarsest grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Input index of each particle, in canonical order. Particles outside come last.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of particles that nobody finds: with coordinates that are not numbers, or larger than
    /// 10¹⁵⁰.
    pub fn outside(&self) -> usize {
        self.order.len() - self.radii.len()
    }

    pub(crate) fn levels(&self) -> &[TreeLevel<D>] {
        &self.levels
    }

    /// Coordinates at a place in canonical order.
    pub(crate) fn coordinates(&self) -> &[[f64; D]] {
        &self.coordinates
    }

    /// Radii in canonical order.
    pub(crate) fn radii(&self) -> &[f64] {
        &self.radii
    }
}

impl<const D: usize> TreeLevel<D> {
    fn new(first: u32, coordinates: &[[f64; D]], radii: &[f64]) -> Self {
        let bound = |of: fn(f64, f64) -> f64| {
            let join = |a: [f64; D], x: &[f64; D]| std::array::from_fn(|axis| of(a[axis], x[axis]));
            coordinates.iter().fold(coordinates[0], join)
        };
        Self {
            first,
            tree: Tree::new(coordinates.iter().copied()),
            largest_radius: radii.iter().copied().fold(0.0, f64::max),
            low: bound(f64::min),
            high: bound(f64::max),
        }
    }
}

/// Coordinates that distances are computed from: those given, but of the image in the box along axes
/// that repeat.
///
/// Origins are not subtracted otherwise: it would round.
#[inline]
pub(crate) fn coordinates_of<const D: usize>(grid: &Grid<D>, x: &[f64; D]) -> [f64; D] {
    let periods = grid.periods();
    std::array::from_fn(|axis| match periods[axis] {
        None => x[axis],
        Some(_) => grid.inside(x, axis),
    })
}

pub(crate) use place::is_inside;
