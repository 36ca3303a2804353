//! The canonical order of particles of any radius.

use crate::Grid;
use crate::grid::floor;

/// Cells are halved at most this many times.
const MOST_LEVELS: i32 = 60;

/// Squares of larger coordinates are not finite.
const LARGEST: f64 = 1e150;

/// A cell of a level, in canonical order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place<const D: usize> {
    pub level: i32,
    /// Number of the cell along each axis, last axis first.
    cell: [i64; D],
}

impl<const D: usize> Place<D> {
    /// Of positions that nobody finds: after all others.
    pub const OUTSIDE: Self = Self { level: i32::MAX, cell: [0; D] };
}

/// Whether a particle can be found.
#[inline]
pub fn is_inside<const D: usize>(x: &[f64; D]) -> bool {
    x.iter().all(|c| c.abs() <= LARGEST)
}

/// The cell of a particle.
///
/// As far as grids become finer, it is the cell of the finer grid. Cells beyond the range of an
/// `i64` are one: their particles are ordered by id.
pub fn place<const D: usize>(grid: &Grid<D>, x: &[f64; D], radius: f64) -> Place<D> {
    if !is_inside(x) {
        return Place::OUTSIDE;
    }
    let level = (0..MOST_LEVELS)
        .find(|&level| radius > grid.cell_size() * 0.5_f64.powi(level))
        .unwrap_or(MOST_LEVELS);
    let mut cell = match grid.finer(level as u32) {
        finer if finer.cell_size() == grid.cell_size() * 0.5_f64.powi(level) => {
            finer.cell_at(&finer.fixed(x))
        }
        _ => {
            let units = 2.0_f64.powi(level - grid.bits() as i32) * grid.units_per_length();
            std::array::from_fn(|axis| floor(grid.inside(x, axis) * units))
        }
    };
    cell.reverse();
    Place { level, cell }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_go_on_where_those_of_grids_end() {
        let grid = Grid::new([0.5, -1.0], 0.5).unwrap();
        for level in [0, 5, 11, 12, 13, 30, 50] {
            let (x, cell) = ([1.3, -7.0], 0.5 * 0.5_f64.powi(level));
            let at = place(&grid, &x, 1.5 * cell);
            assert_eq!(at.level, level);
            for (axis, &number) in at.cell.iter().rev().enumerate() {
                let low = grid.origin()[axis] + number as f64 * cell;
                assert!((low..=low + cell).contains(&x[axis]), "{level}: {low}");
            }
        }
        assert_eq!(place(&grid, &[0.0; 2], 0.0).level, 60);
        assert_eq!(place(&grid, &[0.0, f64::NAN], 1.0), Place::OUTSIDE);
    }
}
