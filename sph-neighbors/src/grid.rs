//! The global grid: cells, their keys, and fixed-point coordinates.

use thiserror::Error;

/// A cell is this many bits of fixed-point units wide.
const CELL_BITS: u32 = 20;

/// Why a grid cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum GridError {
    /// The cell size is zero, negative or not a number.
    #[error("cell size {0} is not a positive finite number: use the largest reach or half of it")]
    CellSize(f64),
    /// A coordinate of the origin is not a finite number.
    #[error("origin coordinate {value} of axis {axis} is not finite: use a corner of the domain")]
    Origin {
        /// Axis of the coordinate.
        axis: usize,
        /// The offending value.
        value: f64,
    },
}

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
}

impl<const D: usize> Grid<D> {
    /// Bits of a cell number along an axis.
    const AXIS_BITS: u32 = if D <= 2 { 31 } else { 63 / D as u32 };
    /// Cell numbers lie in `-LIMIT..LIMIT`.
    const LIMIT: i64 = 1 << (Self::AXIS_BITS - 1);

    /// Key of positions that are not numbers or out of range: after all others.
    pub(crate) const OUTSIDE: u64 = u64::MAX;
    /// Bits of the fixed-point coordinates within a cell.
    pub(crate) const CELL_BITS: u32 = CELL_BITS;

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
        Ok(Self { origin, cell_size, units_per_length })
    }

    /// The origin.
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }

    /// Edge of a cell.
    pub fn cell_size(&self) -> f64 {
        self.cell_size
    }

    /// Unit of the fixed-point coordinates: the cell size / 2²⁰.
    pub fn resolution(&self) -> f64 {
        1.0 / self.units_per_length
    }

    /// Number of the cell that holds `x`, along each axis.
    pub fn cell(&self, x: &[f64; D]) -> [i64; D] {
        self.fixed(x).map(|q| q >> CELL_BITS)
    }

    /// Key of the cell that holds `x`: keys order cells by their last axis first, and x is fastest.
    ///
    /// Positions that are not numbers or beyond the range of the grid share the key `u64::MAX`.
    pub fn key(&self, x: &[f64; D]) -> u64 {
        self.place(x)
            .and_then(|q| Self::key_of(&q.map(|q| q >> CELL_BITS)))
            .unwrap_or(Self::OUTSIDE)
    }

    /// Fixed-point coordinates of a position that is in a cell.
    #[inline]
    pub(crate) fn place(&self, x: &[f64; D]) -> Option<[i64; D]> {
        let fixed = self.fixed(x);
        let range = -(Self::LIMIT << CELL_BITS)..Self::LIMIT << CELL_BITS;
        (0..D).all(|axis| !x[axis].is_nan() && range.contains(&fixed[axis])).then_some(fixed)
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
        floor((x[axis] - self.origin[axis]) * self.units_per_length)
    }

    /// Units per length.
    pub(crate) fn units_per_length(&self) -> f64 {
        self.units_per_length
    }
}

/// The largest integer not above `x`; `f64::floor` is a slow call on plain x86-64.
#[inline]
fn floor(x: f64) -> i64 {
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
}
