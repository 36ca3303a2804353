//! The search: all sources within reach of a group of targets that are close together.

use super::compress::{LANES, compress, less};
use crate::{CellList, Grid};
use std::ops::Range;
use wide::f32x8;

/// Coordinates relative to a group stay below this many units, so that they and their differences
/// are exact in `f32`.
const EXACT: f64 = 4_194_304.0;

/// Largest reach in cells: fixed-point differences of candidates must not wrap around.
const MOST_CELLS: f64 = 256.0;

/// What to search for.
#[derive(Debug, Clone, Copy)]
pub struct Query {
    /// Reach in units, with a margin for the rounding of coordinates.
    reach: f64,
    /// Square of the reach in the units of the test.
    threshold: f32,
    /// The test drops this many bits of the coordinates, to stay exact when reach ≫ cell size.
    drop: u32,
}

impl Query {
    /// # Panics
    ///
    /// When the reach is not a number, negative, or larger than 256 cells.
    pub fn new<const D: usize>(grid: &Grid<D>, reach: f64) -> Self {
        assert!(
            reach >= 0.0 && reach <= MOST_CELLS * grid.cell_size(),
            "reach {reach} must be positive and at most {MOST_CELLS} cells of {}",
            grid.cell_size()
        );
        let units = reach * grid.units_per_length();
        let mut drop = 0;
        while units * 0.5_f64.powi(drop) > EXACT {
            drop += 1;
        }
        // Each coordinate is rounded down to a unit of the test: no pair may be lost by that.
        let unit = 2.0_f64.powi(drop);
        let reach = units + unit * (D as f64).sqrt();
        let threshold = ((reach / unit) * (reach / unit) * (1.0 + 1e-6)) as f32;
        Self { reach, threshold, drop: drop as u32 }
    }
}

/// Targets that are searched together.
#[derive(Debug, Clone, Copy)]
pub struct Group<const D: usize> {
    /// Lowest and highest fixed-point coordinates.
    low: [i64; D],
    high: [i64; D],
    /// Coordinates of candidates are relative to this.
    base: [i64; D],
}

impl<const D: usize> Group<D> {
    /// A group of the targets in a box.
    pub fn new(query: &Query, low: [i64; D], high: [i64; D]) -> Self {
        // Whole units of the test, so that dropped bits do not depend on the group.
        Self { low, high, base: low.map(|q| q >> query.drop << query.drop) }
    }
}

/// The candidates of a group of targets, and room for the hits of one.
#[derive(Debug, Clone, Default)]
pub struct Search {
    /// Coordinates relative to the base of the group, in units of the test, by axis.
    coordinates: Vec<Vec<f32>>,
    /// Index of each candidate in the input of the cell list.
    index: Vec<u32>,
    /// Hits as numbers of candidates.
    hits: Vec<u32>,
}

impl Search {
    /// Number of candidates of the group.
    pub fn candidates(&self) -> usize {
        self.index.len()
    }

    /// Collects the candidates of a group, in canonical order.
    pub fn collect<const D: usize>(
        &mut self,
        cells: &CellList<D>,
        query: &Query,
        group: &Group<D>,
    ) {
        self.index.clear();
        self.coordinates.resize_with(D, Vec::new);
        self.coordinates.iter_mut().for_each(Vec::clear);
        for_each_row(cells, query.reach, group, |range| {
            for (axis, column) in self.coordinates.iter_mut().enumerate() {
                let base = group.base[axis] as i32;
                let source = &cells.coordinates(axis)[range.clone()];
                column.extend(source.iter().map(|c| (c.wrapping_sub(base) >> query.drop) as f32));
            }
            self.index.extend_from_slice(&cells.order()[range]);
        });
        self.fill_up();
    }

    /// Adds candidates that nobody hits up to whole lanes.
    fn fill_up(&mut self) {
        let whole = self.index.len().next_multiple_of(LANES);
        for column in &mut self.coordinates {
            column.resize(whole, f32::INFINITY);
        }
        if self.hits.len() < whole + LANES {
            self.hits.resize(whole + LANES, 0);
        }
    }

    /// Appends the indices of the candidates within reach of the target to `found`.
    #[inline]
    pub fn test<const D: usize>(
        &mut self,
        query: &Query,
        group: &Group<D>,
        target: &[i64; D],
        found: &mut Vec<u32>,
    ) {
        let me: [f32x8; D] = std::array::from_fn(|axis| {
            f32x8::splat(((target[axis] - group.base[axis]) >> query.drop) as f32)
        });
        let threshold = f32x8::splat(query.threshold);
        let columns: [&[[f32; LANES]]; D] =
            std::array::from_fn(|axis| self.coordinates[axis].as_chunks().0);
        let blocks = columns[0].len();
        let columns = columns.map(|column| &column[..blocks]);
        let mut n = 0;
        for block in 0..blocks {
            let mut distance2 = f32x8::ZERO;
            for (column, me) in columns.iter().zip(&me) {
                let d = f32x8::from(column[block]) - *me;
                distance2 += d * d;
            }
            let pattern = less(distance2, threshold);
            let Some(room) = self.hits[n..].first_chunk_mut() else {
                break;
            };
            n += compress(pattern, (block * LANES) as u32, room);
        }
        found.extend(self.hits[..n].iter().map(|&hit| self.index[hit as usize]));
    }
}

/// Calls `visit` with the places of the particles in each row of cells that may be within reach of
/// the group, in canonical order.
fn for_each_row<const D: usize>(
    cells: &CellList<D>,
    reach: f64,
    group: &Group<D>,
    mut visit: impl FnMut(Range<usize>),
) {
    let Some((first, last)) = cells.bounds() else {
        return;
    };
    let Group { low, high, .. } = group;
    let bits = Grid::<D>::CELL_BITS;
    let whole = reach.ceil() as i64;
    let from: [i64; D] = std::array::from_fn(|a| first[a].max((low[a] - whole) >> bits));
    let to: [i64; D] = std::array::from_fn(|a| last[a].min((high[a] + whole) >> bits));
    if (0..D).any(|axis| from[axis] > to[axis]) {
        return;
    }
    let mut row = from;
    loop {
        // Distance of the row from the box of the targets, across the row.
        let mut across = 0.0;
        for axis in 1..D {
            let near = row[axis] << bits;
            let far = near + (1 << bits) - 1;
            let gap = (low[axis] - far).max(near - high[axis]).max(0) as f64;
            across += gap * gap;
        }
        let along = reach * reach - across;
        if along >= 0.0 {
            let along = along.sqrt().ceil() as i64;
            row[0] = (low[0] - along) >> bits;
            let range = cells.row(row, (high[0] + along) >> bits);
            if !range.is_empty() {
                visit(range);
            }
        }
        let Some(axis) = (1..D).find(|&axis| row[axis] < to[axis]) else {
            return;
        };
        row[axis] += 1;
        row[1..axis].copy_from_slice(&from[1..axis]);
    }
}
