//! Groups of targets, and the rows of cells that hold their candidates.

use crate::{CellList, Grid};
use std::array::from_fn;
use std::ops::Range;

/// Coordinates relative to a group stay below a few times this many units, so that they and their
/// differences are exact in `f32`.
const EXACT: f64 = 4_194_304.0;

/// A search within one reach.
#[derive(Debug, Clone, Copy)]
pub struct Query {
    /// Reach in units, with a margin for the rounding of coordinates.
    pub reach: f64,
    /// Square of the reach in the units of the test.
    pub threshold: f32,
    /// The test drops this many bits of the coordinates, to stay exact when reach ≫ cell size.
    pub drop: u32,
    /// Targets of a group are in this many cells along x. One reach measures best: longer groups
    /// test more candidates, shorter ones collect candidates more often.
    pub group_cells: i64,
}

impl Query {
    /// # Panics
    ///
    /// When the grid refuses the reach.
    pub fn new<const D: usize>(grid: &Grid<D>, reach: f64) -> Self {
        if let Err(error) = grid.check_reach(reach) {
            panic!("{error}");
        }
        let units = reach * grid.units_per_length();
        let mut drop = 0;
        while units * 0.5_f64.powi(drop) > EXACT {
            drop += 1;
        }
        let unit = 2.0_f64.powi(drop);
        let group_cells = (reach / grid.cell_size()).round().max(1.0) as i64;
        let reach = units + unit * margin::<D>();
        let threshold = ((reach / unit) * (reach / unit) * (1.0 + 1e-6)) as f32;
        Self { reach, threshold, drop: drop as u32, group_cells }
    }
}

/// A distance of rounded coordinates may exceed the true one by this many units: each coordinate is
/// rounded down, and so is a period.
pub fn margin<const D: usize>() -> f64 {
    (D as f64).sqrt() * 1.5
}

/// Targets that are searched together.
#[derive(Debug, Clone, Copy)]
pub struct Group<const D: usize> {
    /// Lowest and highest fixed-point coordinates.
    pub low: [i64; D],
    pub high: [i64; D],
    /// Coordinates of candidates are relative to this.
    pub base: [i64; D],
}

impl<const D: usize> Group<D> {
    /// The group that starts `targets`, with its length; none for a target that the grid cannot
    /// place. Targets of a group are consecutive, in up to `width` cells of one row, and such that
    /// `fits` their number in `targets`.
    ///
    /// Coordinates are relative to whole units of a test that drops `drop` bits, so that the bits
    /// that are dropped do not depend on the group.
    pub fn first(
        grid: &Grid<D>,
        width: i64,
        drop: u32,
        targets: &[[f64; D]],
        fits: impl Fn(usize) -> bool,
    ) -> (usize, Option<Self>) {
        let Some(mut low) = targets.first().and_then(|x| grid.place(x)) else {
            return (1, None);
        };
        let mut high = low;
        let cell = grid.cell_at(&low);
        let mut length = 1;
        for x in &targets[1..] {
            let Some(fixed) = grid.place(x) else {
                break;
            };
            let other = grid.cell_at(&fixed);
            let near = (other[0] - cell[0]).abs() < width && other[1..] == cell[1..];
            if !near || !fits(length) {
                break;
            }
            low = from_fn(|axis| low[axis].min(fixed[axis]));
            high = from_fn(|axis| high[axis].max(fixed[axis]));
            length += 1;
        }
        (length, Some(Self { low, high, base: low.map(|q| q >> drop << drop) }))
    }

    /// Calls `visit` with this group and then its images in periodic boxes that may have sources
    /// within reach: a source near an image of a target is as far from it as its own image from the
    /// target.
    #[inline(always)]
    pub fn for_each_image(&self, cells: &CellList<D>, reach: f64, mut visit: impl FnMut(&Self)) {
        let periods = cells.grid().period_units();
        if periods.iter().all(|&period| period == 0) {
            visit(self);
            return;
        }
        let reach = reach.ceil() as i64;
        for number in 0..3_usize.pow(D as u32) {
            // Digits 0, 1, 2 mean no shift, up, down.
            let shift: [i64; D] = from_fn(|axis| match number / 3_usize.pow(axis as u32) % 3 {
                0 => 0,
                1 => periods[axis],
                _ => -periods[axis],
            });
            let useful = (0..D).all(|axis| match number / 3_usize.pow(axis as u32) % 3 {
                0 => true,
                1 => periods[axis] > 0 && self.low[axis] - reach < 0,
                _ => periods[axis] > 0 && self.high[axis] + reach >= periods[axis],
            });
            if useful {
                let moved = |x: &[i64; D]| from_fn(|axis| x[axis] + shift[axis]);
                visit(&Self {
                    low: moved(&self.low),
                    high: moved(&self.high),
                    base: moved(&self.base),
                });
            }
        }
    }

    /// Calls `visit` with every row of cells that may be within reach of the group, in canonical
    /// order: with a cell of the row, whose place along it means nothing, and the square of the
    /// distance of the row from the box of the targets, across the row.
    #[inline(always)]
    pub fn for_each_row_across(
        &self,
        cells: &CellList<D>,
        reach: f64,
        mut visit: impl FnMut([i64; D], f64),
    ) {
        let Some((first, last)) = cells.bounds() else {
            return;
        };
        let Self { low, high, .. } = self;
        let bits = cells.grid().bits();
        let whole = reach.ceil() as i64;
        let from: [i64; D] = from_fn(|a| first[a].max((low[a] - whole) >> bits));
        let to: [i64; D] = from_fn(|a| last[a].min((high[a] + whole) >> bits));
        if (0..D).any(|axis| from[axis] > to[axis]) {
            return;
        }
        let mut row = from;
        loop {
            let mut across = 0.0;
            for axis in 1..D {
                let near = row[axis] << bits;
                let far = near + (1 << bits) - 1;
                let gap = (low[axis] - far).max(near - high[axis]).max(0) as f64;
                across += gap * gap;
            }
            visit(row, across);
            let Some(axis) = (1..D).find(|&axis| row[axis] < to[axis]) else {
                return;
            };
            row[axis] += 1;
            row[1..axis].copy_from_slice(&from[1..axis]);
        }
    }

    /// Calls `visit` with the places of the particles in each row of cells that may be within reach
    /// of the group, in canonical order.
    ///
    /// `closer` may shorten the reach for a part of a row, given the numbers of its cells.
    pub fn for_each_row(
        &self,
        cells: &CellList<D>,
        reach: f64,
        closer: impl Fn(Range<usize>) -> Option<f64>,
        mut visit: impl FnMut(Range<usize>),
    ) {
        self.for_each_row_across(cells, reach, |row, across| {
            let part = |reach: f64| self.part_of_row(cells, row, reach * reach - across);
            let (mut reach, mut cells_in_reach) = (reach, part(reach));
            // A shorter part may allow a still shorter reach.
            for _ in 0..2 {
                match closer(cells_in_reach.clone()) {
                    Some(closer) if closer < 0.95 * reach => reach = closer,
                    _ => break,
                }
                cells_in_reach = part(reach);
            }
            let places = cells.places(cells_in_reach);
            if !places.is_empty() {
                visit(places);
            }
        });
    }

    /// Numbers of the cells of a row within reach of the group, of whose square this much is left
    /// along the row.
    #[inline(always)]
    pub fn part_of_row(&self, cells: &CellList<D>, mut row: [i64; D], along: f64) -> Range<usize> {
        if along < 0.0 {
            return 0..0;
        }
        let bits = cells.grid().bits();
        let along = along.sqrt() as i64 + 1;
        row[0] = (self.low[0] - along) >> bits;
        cells.row_of_cells(row, (self.high[0] + along) >> bits)
    }
}
