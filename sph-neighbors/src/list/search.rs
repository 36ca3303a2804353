//! The search: all sources within reach of a group of targets that are close together.

use super::compress::{LANES, compress, less};
use crate::{CellList, Grid};
use std::ops::Range;
use wide::{f32x8, i32x8};

/// Coordinates relative to a group stay below this many units, so that they and their differences
/// are exact in `f32`.
const EXACT: f64 = 4_194_304.0;

/// Largest reach in cells: fixed-point differences of candidates must not wrap around.
const MOST_CELLS: f64 = 256.0;

/// Blocks of candidates that are tested before their hits are read: their numbers fit 16 bits.
const WINDOW: usize = 4096;

/// What to search for.
#[derive(Debug, Clone, Copy)]
pub struct Query {
    /// Reach in units, with a margin for the rounding of coordinates.
    reach: f64,
    /// Square of the reach in the units of the test.
    threshold: f32,
    /// The test drops this many bits of the coordinates, to stay exact when reach ≫ cell size.
    drop: u32,
    /// Targets of a group are in this many cells along x. One reach measures best: longer groups
    /// test more candidates, shorter ones collect candidates more often.
    pub group_cells: i64,
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
        let group_cells =
            (units * 0.5_f64.powi(Grid::<D>::CELL_BITS as i32)).round().max(1.0) as i64;
        let threshold = ((reach / unit) * (reach / unit) * (1.0 + 1e-6)) as f32;
        Self { reach, threshold, drop: drop as u32, group_cells }
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
    /// Number of candidates.
    length: usize,
    /// Coordinates relative to the base of the group, in units of the test, by axis; longer than
    /// needed, like the next two.
    coordinates: Vec<Vec<f32>>,
    /// Index of each candidate in the input of the cell list.
    index: Vec<u32>,
    /// Hits as numbers of candidates of a window.
    hits: Vec<u16>,
}

impl Search {
    /// Number of candidates of the group.
    pub fn candidates(&self) -> usize {
        self.length
    }

    /// Collects the candidates of a group, in canonical order.
    pub fn collect<const D: usize>(
        &mut self,
        cells: &CellList<D>,
        query: &Query,
        group: &Group<D>,
    ) {
        self.coordinates.resize_with(D, Vec::new);
        self.length = 0;
        for_each_row(cells, query.reach, group, |range| {
            self.make_room(self.length + range.len());
            for (axis, column) in self.coordinates.iter_mut().enumerate() {
                let base = i32x8::splat(group.base[axis] as i32);
                let relative = |c: [i32; LANES]| {
                    f32x8::from_i32x8((i32x8::from(c) - base) >> query.drop).to_array()
                };
                let room = &mut column[self.length..];
                copy_lanes(&cells.coordinates(axis)[range.start..], room, range.len(), relative);
            }
            let room = &mut self.index[self.length..];
            copy_lanes(&cells.order_and_margin()[range.start..], room, range.len(), |i| i);
            self.length += range.len();
        });
        self.make_room(self.length);
        // Nobody hits the candidates that fill up the last block.
        for column in &mut self.coordinates {
            column[self.length..][..LANES].fill(f32::INFINITY);
        }
    }

    /// Makes room for candidates and a block more.
    fn make_room(&mut self, candidates: usize) {
        let room = candidates + LANES;
        if self.index.len() < room {
            let room = room.next_power_of_two();
            self.index.resize(room, 0);
            self.coordinates.iter_mut().for_each(|column| column.resize(room, 0.0));
            self.hits.resize((WINDOW + 1) * LANES, 0);
        }
    }

    /// Appends the indices of the candidates within reach of the target to `found`.
    #[inline]
    pub fn test<const D: usize>(
        &mut self,
        query: &Query,
        group: &Group<D>,
        target: &[i64; D],
        filler: u32,
        found: &mut Vec<u32>,
    ) {
        let me: [f32x8; D] = std::array::from_fn(|axis| {
            f32x8::splat(((target[axis] - group.base[axis]) >> query.drop) as f32)
        });
        let threshold = f32x8::splat(query.threshold);
        let columns: [&[[f32; LANES]]; D] =
            std::array::from_fn(|axis| self.coordinates[axis].as_chunks().0);
        let blocks = self.length.div_ceil(LANES);
        let columns = columns.map(|column| &column[..blocks]);
        for first in (0..blocks).step_by(WINDOW) {
            let last = blocks.min(first + WINDOW);
            let mut n = 0;
            for block in first..last {
                let mut distance2 = f32x8::ZERO;
                for (column, me) in columns.iter().zip(&me) {
                    let d = f32x8::from(column[block]) - *me;
                    distance2 += d * d;
                }
                let Some(room) = self.hits[n..].first_chunk_mut() else {
                    break;
                };
                n += compress(less(distance2, threshold), ((block - first) * LANES) as u16, room);
            }
            let index = &self.index[first * LANES..];
            let start = found.len();
            found.resize(start + n, 0);
            let room = &mut found[start..];
            let mut kept = 0;
            for &hit in &self.hits[..n] {
                let j = index[usize::from(hit)];
                room[kept] = j;
                kept += usize::from(j != filler);
            }
            found.truncate(start + kept);
        }
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
            let along = along.sqrt() as i64 + 1;
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

/// Maps `length` elements from the start of `source` to the start of `room`, and up to a block more
/// in both: whole blocks take no remainder loop, and rows are short.
#[inline(always)]
fn copy_lanes<S: Copy, T>(
    source: &[S],
    room: &mut [T],
    length: usize,
    map: impl Fn([S; LANES]) -> [T; LANES],
) {
    let blocks = length.div_ceil(LANES);
    let source = &source.as_chunks::<LANES>().0[..blocks];
    let room = &mut room.as_chunks_mut::<LANES>().0[..blocks];
    for (source, room) in source.iter().zip(room) {
        *room = map(*source);
    }
}
