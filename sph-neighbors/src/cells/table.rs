//! Where the particles of a cell are in canonical order.

use crate::Grid;
use std::ops::Range;

/// Table of the occupied cells.
#[derive(Debug, Clone)]
pub struct Table<const D: usize> {
    /// Lowest and highest occupied cell along each axis; none when nothing is in a cell.
    bounds: Option<([i64; D], [i64; D])>,
    /// Dense: none. Sparse: keys of the occupied cells, ascending.
    keys: Vec<u64>,
    /// First place of each cell (dense: of every cell of the box, x fastest), then the end.
    starts: Vec<u32>,
    dense: bool,
}

impl<const D: usize> Default for Table<D> {
    fn default() -> Self {
        Self { bounds: None, keys: Vec::new(), starts: vec![0], dense: true }
    }
}

/// Number of cells of the box `low..=high`, or `None` when it exceeds `limit`.
pub fn volume<const D: usize>(low: &[i64; D], high: &[i64; D], limit: usize) -> Option<usize> {
    let mut volume = 1_usize;
    for axis in 0..D {
        let edge = usize::try_from(high[axis] - low[axis] + 1).ok()?;
        volume = volume.checked_mul(edge).filter(|&v| v <= limit)?;
    }
    Some(volume)
}

/// Number of a cell in the box that starts at `low` and reaches to `high`.
#[inline(always)]
pub fn number<const D: usize>(cell: &[i64; D], low: &[i64; D], high: &[i64; D]) -> usize {
    let mut number = 0;
    for axis in (0..D).rev() {
        number = number * (high[axis] - low[axis] + 1) as usize + (cell[axis] - low[axis]) as usize;
    }
    number
}

impl<const D: usize> Table<D> {
    /// Forgets everything; no particle is in a cell.
    pub fn clear(&mut self) {
        self.bounds = None;
        self.keys.clear();
        self.starts.clear();
        self.starts.push(0);
        self.dense = true;
    }

    /// Starts a dense table of a box; returns zeroed counts of its cells to be filled, with a last
    /// element to spare. [`dense_order`](Self::dense_order) finishes it.
    pub fn dense(&mut self, low: [i64; D], high: [i64; D], volume: usize) -> &mut Vec<u32> {
        self.clear();
        self.bounds = Some((low, high));
        self.starts.clear();
        self.starts.resize(volume + 1, 0);
        &mut self.starts
    }

    /// Fills a sparse table from the keys of the particles in canonical order.
    pub fn sparse(&mut self, low: [i64; D], high: [i64; D], keys: impl Iterator<Item = u64>) {
        self.clear();
        self.bounds = Some((low, high));
        self.dense = false;
        self.starts.clear();
        let mut count = 0;
        for key in keys {
            if self.keys.last() != Some(&key) {
                self.keys.push(key);
                self.starts.push(count);
            }
            count += 1;
        }
        self.starts.push(count);
    }

    /// First place of each cell, then the end.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    pub fn bounds(&self) -> Option<([i64; D], [i64; D])> {
        self.bounds
    }

    /// Number of particles in cells.
    pub fn particles(&self) -> usize {
        self.starts.last().map_or(0, |&end| end as usize)
    }

    pub fn bytes(&self) -> usize {
        self.keys.capacity() * 8 + self.starts.capacity() * 4
    }

    /// Numbers of the cells of the table from cell `first` to the cell `last` along x.
    #[inline(always)]
    pub fn row(&self, mut first: [i64; D], last: i64) -> Range<usize> {
        let Some((low, high)) = &self.bounds else {
            return 0..0;
        };
        first[0] = first[0].max(low[0]);
        let last = last.min(high[0]);
        if last < first[0] || (1..D).any(|axis| first[axis] < low[axis] || first[axis] > high[axis])
        {
            return 0..0;
        }
        if self.dense {
            let from = number(&first, low, high);
            return from..from + (last - first[0]) as usize + 1;
        }
        // Both cells are in the box, whose corners have keys.
        let Some(key) = Grid::<D>::key_of(&first) else {
            return 0..0;
        };
        let end = key + (last - first[0]) as u64;
        let from = self.keys.partition_point(|&k| k < key);
        from..from + self.keys[from..].partition_point(|&k| k <= end)
    }

    /// Places of the particles in cells of the table, given their numbers.
    #[inline(always)]
    pub fn places(&self, cells: Range<usize>) -> Range<usize> {
        self.starts[cells.start] as usize..self.starts[cells.end] as usize
    }

    /// Occupied cells in canonical order, with the places of their particles.
    pub fn occupied(&self) -> impl Iterator<Item = ([i64; D], Range<usize>)> {
        self.starts.windows(2).enumerate().filter(|(_, ends)| ends[0] < ends[1]).map(
            |(number, ends)| {
                let cell = match self.bounds {
                    Some((low, high)) if self.dense => cell(number, &low, &high),
                    _ => Grid::cell_of(self.keys[number]),
                };
                (cell, ends[0] as usize..ends[1] as usize)
            },
        )
    }
}

/// Inverse of [`number`].
fn cell<const D: usize>(mut number: usize, low: &[i64; D], high: &[i64; D]) -> [i64; D] {
    std::array::from_fn(|axis| {
        let edge = (high[axis] - low[axis] + 1) as usize;
        let c = low[axis] + (number % edge) as i64;
        number /= edge;
        c
    })
}
