//! The global grid: cells, their keys, and fixed-point coordinates.

mod error;

pub use error::GridError;

/// A cell is this many bits of fixed-point units wide.
const CELL_BITS: u32 = 20;

/// Most times that [`Grid::finer`] halves the cells.
const MOST_LEVELS: u32 = 12;

/// Largest reach in cells: fixed-point differences of candidates must not wrap around.
const MOST_CELLS: f64 = 256.0;

/// Largest reach in cells for searches that need every bit of the coordinates.
const MOST_EXACT_CELLS: f64 = 4.0;

/// A grid of cubic cells over all of space, defined by an origin and a cell size.
///
/// It also defines fixed-point coordinates: whole numbers of [`resolution`](Self::resolution) from
/// the origin. Cells and distance tests use them, so that both are functions of the position alone:
/// the same on every rank, at any distance from the origin.
///
/// ```
/// use sph_neighbors::Grid;
///
/// let grid = Grid::new([0.0, 0.0], 0.5)?;
/// assert_eq!(grid.cell(&[1.2, -0.1]), [2, -1]);
/// // x runs fastest in keys.
/// assert!(grid.key(&[9.0, 0.1]) < grid.key(&[0.0, 0.6]));
/// # Ok::<(), sph_neighbors::GridError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid<const D: usize> {
    origin: [f64; D],
    cell_size: f64,
    units_per_length: f64,
    /// A cell is 2^bits units wide.
    bits: u32,
    periods: [Option<f64>; D],
    /// Periods in units, 0 for none.
    period_units: [i64; D],
}

impl<const D: usize> Grid<D> {
    /// Bits of a cell number along an axis.
    const AXIS_BITS: u32 = if D <= 2 { 31 } else { 63 / D as u32 };
    /// Cell numbers lie in `-LIMIT..LIMIT`.
    const LIMIT: i64 = 1 << (Self::AXIS_BITS - 1);

    /// Key of positions that are not numbers or out of range: after all others.
    pub(crate) const OUTSIDE: u64 = u64::MAX;

    /// A grid with a corner of a cell at `origin` and cells of edge `cell_size`.
    ///
    /// Cells as large as the reach of the search, or half as large, work best. Cell numbers must fit
    /// 31 bits in two dimensions and 21 bits in three, so put the origin near the particles.
    pub fn new(origin: [f64; D], cell_size: f64) -> Result<Self, GridError> {
        let units_per_length = f64::from(1 << CELL_BITS) / cell_size;
        if !(cell_size > 0.0 && cell_size.is_finite() && units_per_length.is_finite()) {
            return Err(GridError::CellSize(cell_size));
        }
        if let Some(axis) = origin.iter().position(|x| !x.is_finite()) {
            return Err(GridError::Origin { axis, value: origin[axis] });
        }
        let (periods, period_units) = ([None; D], [0; D]);
        Ok(Self { origin, cell_size, units_per_length, bits: CELL_BITS, periods, period_units })
    }

    /// This grid in a box that repeats along the axes with a period, from the origin on.
    ///
    /// Positions outside the box count as their images inside, and distances are to the nearest
    /// image. Periods need not be whole numbers of cells.
    ///
    /// ```
    /// use sph_neighbors::{CellList, Grid, NeighborList};
    ///
    /// let grid = Grid::new([0.0, 0.0], 1.0)?.periodic([Some(10.0), None])?;
    /// let positions = [[0.1, 0.5], [9.8, 0.5]];
    /// let cells = CellList::build(&grid, &positions, &[0, 1]);
    /// let list = NeighborList::build(&cells, &positions, |t| t as u32, 1.0, 1);
    /// assert_eq!(list.of(0), [1]);
    /// # Ok::<(), sph_neighbors::GridError>(())
    /// ```
    pub fn periodic(mut self, periods: [Option<f64>; D]) -> Result<Self, GridError> {
        for (axis, period) in periods.iter().enumerate() {
            let Some(value) = *period else {
                self.period_units[axis] = 0;
                continue;
            };
            let cells = value / self.cell_size;
            if !(cells >= 1.0 && cells <= Self::LIMIT as f64) {
                return Err(GridError::Period { axis, value });
            }
            self.period_units[axis] = (value * self.units_per_length).round() as i64;
        }
        self.periods = periods;
        Ok(self)
    }

    /// This grid with every cell halved `level` times along each axis, at most 12 times. Fixed-point
    /// coordinates stay the same.
    pub fn finer(mut self, level: u32) -> Self {
        let level = level.min(MOST_LEVELS + self.bits - CELL_BITS);
        self.bits -= level;
        self.cell_size /= f64::from(1 << level);
        self
    }

    /// How often to halve the cells for particles of this radius: until a cell is smaller than the
    /// radius, but no smaller than half of it.
    pub fn level(&self, radius: f64) -> u32 {
        (0..MOST_LEVELS)
            .find(|&level| radius > self.cell_size / f64::from(1 << level))
            .unwrap_or(MOST_LEVELS)
    }

    /// The origin.
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }

    /// Edge of a cell.
    pub fn cell_size(&self) -> f64 {
        self.cell_size
    }

    /// Lengths after which the axes repeat, if they do.
    pub fn periods(&self) -> [Option<f64>; D] {
        self.periods
    }

    /// Unit of the fixed-point coordinates: the cell size / 2²⁰, of the coarsest grid if this is a
    /// finer one.
    pub fn resolution(&self) -> f64 {
        1.0 / self.units_per_length
    }

    /// Whether this grid can be used to search within `reach`: at most 256 cells, or in a periodic
    /// box at most 4 cells and half of each period.
    pub fn check_reach(&self, reach: f64) -> Result<(), GridError> {
        let is_periodic = self.periods.iter().any(Option::is_some);
        let most = self.cell_size * if is_periodic { MOST_EXACT_CELLS } else { MOST_CELLS };
        if !(reach >= 0.0 && reach <= most) {
            return Err(GridError::Reach { reach, most });
        }
        for (axis, period) in self.periods.iter().enumerate() {
            // Distances are found up to a few units too short.
            if let Some(period) = period.filter(|p| *p < 2.0 * (reach + 8.0 * self.resolution())) {
                return Err(GridError::ShortPeriod { axis, period, reach });
            }
        }
        Ok(())
    }

    /// Whether particles of this radius can be searched in levels that start with this grid: at
    /// most 4 cells, and half of each period.
    pub fn check_radius(&self, radius: f64) -> Result<(), GridError> {
        let most = MOST_EXACT_CELLS * self.cell_size;
        if !(radius >= 0.0 && radius <= most) {
            return Err(GridError::Reach { reach: radius, most });
        }
        self.check_reach(radius)
    }

    /// Number of the cell that holds `x`, along each axis.
    pub fn cell(&self, x: &[f64; D]) -> [i64; D] {
        self.cell_at(&self.fixed(x))
    }

    /// Key of the cell that holds `x`: keys order cells by their last axis first, and x is fastest.
    ///
    /// Positions that are not numbers or beyond the range of the grid share the key `u64::MAX`.
    pub fn key(&self, x: &[f64; D]) -> u64 {
        self.place(x).and_then(|q| Self::key_of(&self.cell_at(&q))).unwrap_or(Self::OUTSIDE)
    }

    /// Fixed-point coordinates of a position that is in a cell.
    #[inline]
    pub(crate) fn place(&self, x: &[f64; D]) -> Option<[i64; D]> {
        let fixed = self.fixed(x);
        let range = -(Self::LIMIT << self.bits)..Self::LIMIT << self.bits;
        (0..D).all(|axis| x[axis].is_finite() && range.contains(&fixed[axis])).then_some(fixed)
    }

    /// Number of the cell at fixed-point coordinates.
    #[inline]
    pub(crate) fn cell_at(&self, fixed: &[i64; D]) -> [i64; D] {
        fixed.map(|q| q >> self.bits)
    }

    /// Key of a cell in range.
    #[inline]
    pub(crate) fn key_of(cell: &[i64; D]) -> Option<u64> {
        let mut key = 0;
        let mut fits = true;
        for (axis, &c) in cell.iter().enumerate() {
            fits &= (-Self::LIMIT..Self::LIMIT).contains(&c);
            key |= ((c + Self::LIMIT) as u64) << (Self::AXIS_BITS * axis as u32);
        }
        fits.then_some(key)
    }

    /// The cell with this key, which must not be [`OUTSIDE`](Self::OUTSIDE).
    #[inline]
    pub(crate) fn cell_of(key: u64) -> [i64; D] {
        std::array::from_fn(|axis| {
            let bits = key >> (Self::AXIS_BITS * axis as u32);
            (bits & (2 * Self::LIMIT as u64 - 1)) as i64 - Self::LIMIT
        })
    }

    /// Fixed-point coordinates.
    #[inline]
    pub(crate) fn fixed(&self, x: &[f64; D]) -> [i64; D] {
        std::array::from_fn(|axis| self.fixed_axis(x, axis))
    }

    /// Fixed-point coordinate along an axis.
    #[inline]
    pub(crate) fn fixed_axis(&self, x: &[f64; D], axis: usize) -> i64 {
        let inside = self.inside(x, axis);
        match self.periods[axis] {
            None => floor(inside * self.units_per_length),
            Some(_) => floor(inside * self.units_per_length).clamp(0, self.period_units[axis] - 1),
        }
    }

    /// Coordinate relative to the origin, of the image inside the box.
    #[inline]
    pub(crate) fn inside(&self, x: &[f64; D], axis: usize) -> f64 {
        let x = x[axis] - self.origin[axis];
        match self.periods[axis] {
            None => x,
            Some(period) => x - period * floor(x / period) as f64,
        }
    }

    /// Units per length.
    pub(crate) fn units_per_length(&self) -> f64 {
        self.units_per_length
    }

    /// A cell is 2^bits units wide.
    #[inline]
    pub(crate) fn bits(&self) -> u32 {
        self.bits
    }

    /// Periods in units, 0 for none.
    pub(crate) fn period_units(&self) -> [i64; D] {
        self.period_units
    }
}

/// The largest integer not above `x`; `f64::floor` is a slow call on plain x86-64.
#[inline]
pub(crate) fn floor(x: f64) -> i64 {
    let truncated = x as i64;
    truncated.saturating_sub(i64::from(truncated as f64 > x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_go_back_to_cells() {
        let grid = Grid::new([0.5, -2.0, 3.0], 0.25).unwrap();
        for x in [[0.0, 0.0, 0.0], [-7.3, 1e4, -1e4], [0.5, -2.0, 3.0]] {
            assert_eq!(Grid::<3>::cell_of(grid.key(&x)), grid.cell(&x));
        }
    }

    #[test]
    fn the_last_axis_is_most_significant() {
        let grid = Grid::new([0.0; 3], 1.0).unwrap();
        let keys: Vec<u64> = [[5.5, -9.5, -3.5], [-5.5, 9.5, -3.5], [-4.5, 9.5, -3.5], [-9.5; 3]]
            .iter()
            .map(|x| grid.key(x))
            .collect();
        assert!(keys[3] < keys[0] && keys[0] < keys[1] && keys[1] + 1 == keys[2]);
    }

    #[test]
    fn cells_are_half_open() {
        let grid = Grid::new([0.0], 0.5).unwrap();
        assert_eq!([-0.5, -1e-9, 0.0, 0.5].map(|x| grid.cell(&[x])[0]), [-1, -1, 0, 1]);
    }

    #[test]
    fn positions_out_of_range_have_the_last_key() {
        let grid = Grid::new([0.0; 3], 1.0).unwrap();
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 2e6, -2e6] {
            assert_eq!(grid.key(&[0.0, x, 0.0]), u64::MAX, "{x}");
        }
        assert_ne!(grid.key(&[1e6, -1e6, 1e6]), u64::MAX);
    }

    #[test]
    fn bad_grids_are_refused() {
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-310] {
            assert!(matches!(Grid::new([0.0; 2], size), Err(GridError::CellSize(_))), "{size}");
        }
        let error = Grid::new([0.0, f64::NAN], 1.0).unwrap_err();
        assert!(matches!(error, GridError::Origin { axis: 1, .. }));
    }

    #[test]
    fn finer_cells_share_their_faces() {
        let grid = Grid::new([0.5, 0.5], 0.3).unwrap();
        let fine = grid.finer(2);
        assert_eq!(fine.cell_size(), 0.075);
        for x in [[0.49, 7.3], [-3.0, 0.51], [1e3, -1e3]] {
            assert_eq!(fine.fixed(&x), grid.fixed(&x));
            assert_eq!(fine.cell(&x).map(|c| c >> 2), grid.cell(&x));
        }
        assert_eq!(grid.finer(7).finer(9), grid.finer(12));
    }

    #[test]
    fn levels_have_cells_of_half_a_radius_to_a_radius() {
        let grid = Grid::new([0.0], 0.5).unwrap();
        for radius in [0.5000001, 0.6, 1.0, 0.5, 0.4, 0.25, 0.24, 0.001] {
            let cell = grid.finer(grid.level(radius)).cell_size();
            assert!(cell < radius && radius <= 2.0 * cell, "{radius}: {cell}");
        }
        assert_eq!((grid.level(7.0), grid.level(0.0)), (0, 12));
    }

    #[test]
    fn images_are_in_the_same_cell() {
        let grid = Grid::new([-1.0, 0.0], 0.4).unwrap().periodic([Some(3.0), None]).unwrap();
        for x in [-1.0, -0.3, 0.0, 1.9] {
            for images in [-4.0, -1.0, 1.0, 1000.0] {
                let image = [x + 3.0 * images + 1e-9, 0.0];
                assert_eq!(grid.cell(&image), grid.cell(&[x + 1e-9, 0.0]), "{image:?}");
            }
        }
        assert_eq!(grid.cell(&[2.0, 0.0])[0], 0);
        // Rounding must not lift a position out of the box: this one is a whole period up.
        let grid = Grid::new([0.0], 0.5).unwrap().periodic([Some(3.0)]).unwrap();
        assert_eq!(grid.cell(&[-1e-18]), [5]);
    }

    #[test]
    fn bad_periods_are_refused() {
        let grid = Grid::new([0.0; 2], 0.5).unwrap();
        for period in [0.4, 0.0, -2.0, f64::NAN, f64::INFINITY] {
            let error = grid.periodic([None, Some(period)]).unwrap_err();
            assert!(matches!(error, GridError::Period { axis: 1, .. }), "{period}");
        }
        let grid = grid.periodic([None, Some(2.0)]).unwrap();
        assert!(grid.check_reach(0.99).is_ok());
        assert!(matches!(grid.check_reach(1.0), Err(GridError::ShortPeriod { axis: 1, .. })));
        assert!(matches!(grid.check_reach(2.1), Err(GridError::Reach { .. })));
        assert!(matches!(grid.check_reach(f64::NAN), Err(GridError::Reach { .. })));
    }
}
