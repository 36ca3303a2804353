//! The cell list: particles sorted by cell, then by id.

mod sort;
mod table;

use crate::Grid;
use rayon::prelude::*;
use std::ops::Range;
use table::Table;

/// Particles of one parallel task; small inputs stay on the calling thread.
pub(crate) const TASK: usize = 4096;

/// Columns end in this many elements without meaning, so that rows can be copied by whole lanes.
pub(crate) const MARGIN: usize = 8;

/// Particles sorted by cell and, in a cell, by id: the canonical order.
///
/// Holds compact copies of the positions for the search, so that positions may move on after it is
/// built. [`rebuild`](Self::rebuild) uses the memory of the last build again.
///
/// Particles that the grid cannot place (not a number, or too far away) come last in the order and
/// are in no cell: nobody finds them. [`outside`](Self::outside) counts them.
#[derive(Debug, Clone)]
pub struct CellList<const D: usize> {
    grid: Grid<D>,
    /// Input index by place in canonical order, and a margin.
    order: Vec<u32>,
    /// Low 32 bits of the fixed-point coordinates, in canonical order, and a margin.
    coordinates: [Vec<i32>; D],
    table: Table<D>,
    /// Key of the cell of each particle, in input order.
    keys: Vec<u64>,
}

impl<const D: usize> CellList<D> {
    /// Sorts particles, given in any order. Ids must differ within a cell.
    ///
    /// # Panics
    ///
    /// When `positions` and `ids` differ in length, or hold 2³² particles or more.
    pub fn build(grid: &Grid<D>, positions: &[[f64; D]], ids: &[u64]) -> Self {
        let mut cells = Self {
            grid: *grid,
            order: Vec::new(),
            coordinates: std::array::from_fn(|_| Vec::new()),
            table: Table::default(),
            keys: Vec::new(),
        };
        cells.rebuild(grid, positions, ids);
        cells
    }

    /// Like [`build`](Self::build), in the memory of this list.
    ///
    /// # Panics
    ///
    /// As [`build`](Self::build).
    pub fn rebuild(&mut self, grid: &Grid<D>, positions: &[[f64; D]], ids: &[u64]) {
        assert_eq!(positions.len(), ids.len(), "every position needs an id");
        assert!(u32::try_from(positions.len()).is_ok(), "indices have 32 bits");
        self.grid = *grid;
        positions
            .par_iter()
            .with_min_len(TASK)
            .map(|x| grid.key(x))
            .collect_into_vec(&mut self.keys);
        sort::sort(&self.keys, ids, &mut self.order, &mut self.table);
        self.order.extend([0; MARGIN]);
        if positions.is_empty() {
            self.coordinates.iter_mut().for_each(Vec::clear);
            return;
        }
        for (axis, column) in self.coordinates.iter_mut().enumerate() {
            self.order
                .par_iter()
                .with_min_len(TASK)
                .map(|&i| grid.fixed_axis(&positions[i as usize], axis) as i32)
                .collect_into_vec(column);
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Input index of each particle, in canonical order.
    pub fn order(&self) -> &[u32] {
        &self.order[..self.len()]
    }

    /// [`order`](Self::order) and a margin.
    #[inline]
    pub(crate) fn order_and_margin(&self) -> &[u32] {
        &self.order
    }

    /// Number of particles that are in no cell: not a number, or out of the range of the grid.
    pub fn outside(&self) -> usize {
        self.len() - self.table.particles()
    }

    /// Cells that hold particles, in canonical order, with their places in [`order`](Self::order).
    pub fn occupied(&self) -> impl Iterator<Item = ([i64; D], Range<usize>)> {
        self.table.occupied()
    }

    /// Places in [`order`](Self::order) of the particles in a row of cells: from cell `first` to the
    /// cell `last` (included) along x, the other coordinates those of `first`.
    #[inline(always)]
    pub fn row(&self, first: [i64; D], last: i64) -> Range<usize> {
        self.table.places(self.table.row(first, last))
    }

    /// Numbers of the cells of such a row in the table of cells.
    #[inline(always)]
    pub(crate) fn row_of_cells(&self, first: [i64; D], last: i64) -> Range<usize> {
        self.table.row(first, last)
    }

    /// Places of the particles in cells of the table, given their numbers.
    #[inline(always)]
    pub(crate) fn places(&self, cells: Range<usize>) -> Range<usize> {
        self.table.places(cells)
    }

    /// First place of each cell of the table, then the end.
    pub(crate) fn starts(&self) -> &[u32] {
        self.table.starts()
    }

    /// Lowest and highest occupied cell along each axis.
    pub(crate) fn bounds(&self) -> Option<([i64; D], [i64; D])> {
        self.table.bounds()
    }

    /// Low 32 bits of the fixed-point coordinates along an axis, in canonical order, and a margin.
    #[inline]
    pub(crate) fn coordinates(&self, axis: usize) -> &[i32] {
        &self.coordinates[axis]
    }

    /// Replaces each index of the order by the name at that index.
    pub(crate) fn rename(&mut self, names: &[u32]) {
        let length = self.len();
        self.order[..length].iter_mut().for_each(|i| *i = names[*i as usize]);
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.order.capacity() * 4
            + self.coordinates.iter().map(|c| c.capacity() * 4).sum::<usize>()
            + self.keys.capacity() * 8
            + self.table.bytes()
    }
}
