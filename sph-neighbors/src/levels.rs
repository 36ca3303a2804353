//! Particles of different radii, sorted into grids of matching cells.

use crate::cells::MARGIN;
use crate::list::radius_in_units;
use crate::{CellList, Grid, GridError};

/// Particles of different radii in one [`CellList`] per factor of two: level *l* has the grid
/// [`finer(l)`](Grid::finer), whose cells measure half a radius to a radius.
///
/// The canonical order is by level, largest radii first, then by cell, then by id. Like everything
/// here it follows from grid, position, radius and id alone.
///
/// ```
/// use sph_neighbors::{Grid, LevelList, NeighborList, PairReach};
///
/// let positions = [[0.0, 0.0], [0.9, 0.0], [1.2, 0.0]];
/// let radii = [1.0, 1.0, 0.25];
/// // Cells of the coarsest grid are half as large as the largest radius.
/// let grid = Grid::new([0.0, 0.0], 0.5)?;
/// let levels = LevelList::build(&grid, &positions, &radii, &[0, 1, 2])?;
/// let rule = PairReach::Mean;
/// let list = NeighborList::build_with_radii(&levels, &positions, &radii, |t| t as u32, rule, 1);
/// assert_eq!([list.of(0), list.of(1), list.of(2)], [&[1][..], &[0, 2], &[1]]);
/// # Ok::<(), sph_neighbors::GridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LevelList<const D: usize> {
    grid: Grid<D>,
    levels: Vec<Level<D>>,
    particles: usize,
}

/// Particles of one level.
#[derive(Debug, Clone)]
pub struct Level<const D: usize> {
    /// Sorted particles; their order holds indices into the input of the [`LevelList`].
    pub(crate) cells: CellList<D>,
    /// Radii in units, in canonical order, and a margin.
    pub(crate) radii: Vec<f32>,
    /// The largest of them.
    pub(crate) largest_radius: f32,
    /// The largest in each cell of the table of cells; 0 in empty cells.
    pub(crate) largest_in_cell: Vec<f32>,
    /// Input of the level: indices, positions and ids.
    members: Vec<u32>,
    positions: Vec<[f64; D]>,
    ids: Vec<u64>,
}

impl<const D: usize> LevelList<D> {
    /// Sorts particles, given in any order, into levels that start with `grid`. Its cells should be
    /// half as large as the largest radius that may occur anywhere. Ids must differ within a cell.
    ///
    /// # Errors
    ///
    /// When a radius is negative, not a number, larger than 4 cells of `grid`, or larger than half a
    /// period.
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
        let mut levels = Self { grid: *grid, levels: Vec::new(), particles: 0 };
        levels.rebuild(grid, positions, radii, ids)?;
        Ok(levels)
    }

    /// Like [`build`](Self::build), in the memory of this list. After an error the list holds
    /// nothing.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    ///
    /// # Panics
    ///
    /// As [`build`](Self::build).
    pub fn rebuild(
        &mut self,
        grid: &Grid<D>,
        positions: &[[f64; D]],
        radii: &[f64],
        ids: &[u64],
    ) -> Result<(), GridError> {
        assert_eq!(positions.len(), radii.len(), "every position needs a radius");
        assert_eq!(positions.len(), ids.len(), "every position needs an id");
        assert!(u32::try_from(positions.len()).is_ok(), "indices have 32 bits");
        self.grid = *grid;
        self.levels.iter_mut().for_each(Level::clear);
        self.particles = 0;
        if let Some(error) = radii.iter().find_map(|&radius| grid.check_radius(radius).err()) {
            return Err(error);
        }
        for (i, &radius) in radii.iter().enumerate() {
            let level = grid.level(radius) as usize;
            while self.levels.len() <= level {
                self.levels.push(Level::new(&grid.finer(self.levels.len() as u32)));
            }
            self.levels[level].push(i as u32, positions[i], ids[i]);
        }
        for (number, level) in self.levels.iter_mut().enumerate() {
            level.sort(&grid.finer(number as u32), radii);
        }
        self.particles = positions.len();
        Ok(())
    }

    /// The coarsest grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.particles == 0
    }

    /// Input index of each particle, in canonical order.
    pub fn order(&self) -> impl Iterator<Item = u32> {
        self.levels.iter().flat_map(|level| level.cells.order()).copied()
    }

    /// Number of particles that are in no cell: not a number, or out of the range of a grid.
    pub fn outside(&self) -> usize {
        self.levels.iter().map(|level| level.cells.outside()).sum()
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(Level::bytes).sum()
    }

    pub(crate) fn levels(&self) -> &[Level<D>] {
        &self.levels
    }
}

impl<const D: usize> Level<D> {
    fn new(grid: &Grid<D>) -> Self {
        Self {
            cells: CellList::build(grid, &[], &[]),
            radii: Vec::new(),
            largest_radius: 0.0,
            largest_in_cell: Vec::new(),
            members: Vec::new(),
            positions: Vec::new(),
            ids: Vec::new(),
        }
    }

    fn clear(&mut self) {
        self.members.clear();
        self.positions.clear();
        self.ids.clear();
        let grid = *self.cells.grid();
        self.cells.rebuild(&grid, &[], &[]);
    }

    fn push(&mut self, index: u32, position: [f64; D], id: u64) {
        self.members.push(index);
        self.positions.push(position);
        self.ids.push(id);
    }

    fn sort(&mut self, grid: &Grid<D>, radii: &[f64]) {
        self.cells.rebuild(grid, &self.positions, &self.ids);
        self.cells.rename(&self.members);
        let order = self.cells.order();
        self.radii.clear();
        self.radii.extend(order.iter().map(|&i| radius_in_units(grid, radii[i as usize])));
        self.largest_radius = self.radii.iter().copied().fold(0.0, f32::max);
        let largest = |ends: &[u32]| {
            let radii = &self.radii[ends[0] as usize..ends[1] as usize];
            radii.iter().copied().fold(0.0, f32::max)
        };
        self.largest_in_cell.clear();
        self.largest_in_cell.extend(self.cells.starts().windows(2).map(largest));
        self.radii.extend([0.0; MARGIN]);
    }

    fn bytes(&self) -> usize {
        let member = 4 + size_of::<[f64; D]>() + 8;
        self.cells.bytes()
            + (self.radii.capacity() + self.largest_in_cell.capacity()) * 4
            + self.members.capacity() * member
    }
}
