//! The lattice on which particles are placed, and sets of its points.

mod fill;
mod runs;

pub use fill::{NearSurface, fill_lattice, lattice_inside, near_surface, near_surface_within};
pub use runs::LatticeRuns;
pub(crate) use runs::Reach;

use crate::aabb::Aabb;
use thiserror::Error;

/// Points closer to a surface than this fraction of the spacing count as on it: rounding must not
/// decide where they belong. Points on a surface are never inside and always in the material.
pub(crate) const ON_SURFACE: f64 = 1e-6;

/// A simple cubic (square) lattice of points in the middle of cells:
/// `x = origin + (i + ½) spacing`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice<const D: usize> {
    origin: [f64; D],
    spacing: f64,
}

/// Why points of a lattice cannot be listed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// The spacing is no length.
    #[error("the spacing is {spacing}; give a positive length in metres")]
    Spacing {
        /// The spacing, m.
        spacing: f64,
    },
    /// The origin is no point.
    #[error("the origin of the lattice is {origin:?}; coordinates must be finite")]
    Origin {
        /// The origin, m.
        origin: Vec<f64>,
    },
    /// Points without end.
    #[error(
        "the {what} reaches from {min} to {max} along {axis}, without end; intersect it with a \
         box of finite size"
    )]
    Unbounded {
        /// What has no end.
        what: &'static str,
        /// The axis.
        axis: char,
        /// Lowest coordinate, m.
        min: f64,
        /// Highest coordinate, m.
        max: f64,
    },
    /// More points than can be visited.
    #[error(
        "a spacing of {spacing} m makes {cells:.1e} lattice cells in {rows:.1e} rows, more than \
         can be visited (1e12 and 2e8); use a greater spacing or a smaller domain"
    )]
    TooMany {
        /// The spacing, m.
        spacing: f64,
        /// Number of cells.
        cells: f64,
        /// Number of rows of cells along x.
        rows: f64,
    },
    /// A support radius that is no length.
    #[error("the support radius is {support}; give a positive length in metres")]
    Support {
        /// The support radius, m.
        support: f64,
    },
    /// A periodic length that does not hold whole cells.
    #[error(
        "the domain repeats every {length} m along {axis}, which is {cells} spacings; choose a \
         spacing that divides it, for example {nearest}"
    )]
    Period {
        /// The axis.
        axis: char,
        /// Length of the domain along it, m.
        length: f64,
        /// Length over spacing.
        cells: f64,
        /// The nearest spacing that fits, m.
        nearest: f64,
    },
}

/// The most cells and rows of cells that a set may be searched in: hours of work, gigabytes of rows.
const MOST_CELLS: f64 = 1e12;
const MOST_ROWS: f64 = 2e8;

/// Name of an axis in messages.
pub(crate) fn axis_name(axis: usize) -> char {
    ['x', 'y', 'z'][axis.min(2)]
}

impl<const D: usize> Lattice<D> {
    /// The lattice whose cell with index 0 has its lowest corner at `origin`.
    pub fn new(origin: [f64; D], spacing: f64) -> Result<Self, LatticeError> {
        if !spacing.is_finite() || spacing <= 0.0 {
            return Err(LatticeError::Spacing { spacing });
        }
        if !crate::vector::is_finite(&origin) {
            return Err(LatticeError::Origin { origin: origin.to_vec() });
        }
        Ok(Self { origin, spacing })
    }

    /// Lowest corner of the cell with index 0, m.
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }

    /// Distance of neighbouring points, m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The lattice with the same corner whose cells are so many times longer.
    ///
    /// # Panics
    ///
    /// When the factor is not positive and finite.
    pub fn coarser(&self, factor: f64) -> Self {
        assert!(factor > 0.0 && factor.is_finite(), "a factor of lengths");
        Self { origin: self.origin, spacing: self.spacing * factor }
    }

    /// The point with an index.
    pub fn point(&self, index: &[i64; D]) -> [f64; D] {
        std::array::from_fn(|k| self.origin[k] + (index[k] as f64 + 0.5) * self.spacing)
    }

    /// Cells whose points may lie in a box: one more on each side than rounding asks for.
    pub(crate) fn cells(
        &self,
        what: &'static str,
        bounds: &Aabb<D>,
    ) -> Result<CellBox<D>, LatticeError> {
        let mut cells = CellBox { first: [0; D], end: [0; D] };
        for k in 0..D {
            let (min, max) = (bounds.min[k], bounds.max[k]);
            if min > max {
                return Ok(CellBox { first: [0; D], end: [0; D] });
            }
            if !min.is_finite() || !max.is_finite() {
                return Err(LatticeError::Unbounded { what, axis: axis_name(k), min, max });
            }
            // Saturates for huge numbers, which the test below refuses.
            cells.first[k] =
                (((min - self.origin[k]) / self.spacing).floor() as i64).saturating_sub(1);
            cells.end[k] =
                (((max - self.origin[k]) / self.spacing).ceil() as i64).saturating_add(1);
        }
        self.checked(cells)
    }

    pub(crate) fn checked(&self, cells: CellBox<D>) -> Result<CellBox<D>, LatticeError> {
        let side = |k: usize| cells.end[k] as f64 - cells.first[k] as f64;
        let rows: f64 = (1..D).map(side).product();
        let count = side(0) * rows;
        let far = cells.first.iter().chain(&cells.end).any(|i| i.unsigned_abs() > 1 << 52);
        if count <= MOST_CELLS && rows <= MOST_ROWS && !far {
            Ok(cells)
        } else {
            Err(LatticeError::TooMany { spacing: self.spacing, cells: count, rows })
        }
    }
}

/// A box of cells: from `first` to before `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CellBox<const D: usize> {
    pub first: [i64; D],
    pub end: [i64; D],
}

impl<const D: usize> CellBox<D> {
    pub fn len(&self, axis: usize) -> i64 {
        self.end[axis] - self.first[axis]
    }

    /// Number of rows along x.
    pub fn rows(&self) -> usize {
        if self.len(0) <= 0 {
            return 0;
        }
        (1..D).map(|k| self.len(k).max(0) as usize).product()
    }

    /// The first cell of a row. Rows are counted with y fastest.
    pub fn row_start(&self, row: usize) -> [i64; D] {
        let mut rest = row as i64;
        let mut index = self.first;
        for (k, i) in index.iter_mut().enumerate().skip(1) {
            *i += rest % self.len(k);
            rest /= self.len(k);
        }
        index
    }

    /// The row of a cell, if it has one.
    pub fn row(&self, index: &[i64; D]) -> Option<usize> {
        let mut row = 0;
        for k in (1..D).rev() {
            if index[k] < self.first[k] || index[k] >= self.end[k] {
                return None;
            }
            row = row * self.len(k) + (index[k] - self.first[k]);
        }
        Some(row as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_middle_of_cells() {
        let lattice = Lattice::new([1.0, 2.0], 0.5).unwrap();
        assert_eq!(lattice.point(&[0, 0]), [1.25, 2.25]);
        assert_eq!(lattice.point(&[-1, 3]), [0.75, 3.75]);
    }

    #[test]
    fn rows_and_cells_belong_together() {
        let cells = CellBox { first: [-2, 5, 1], end: [3, 9, 4] };
        assert_eq!(cells.rows(), 12);
        for row in 0..cells.rows() {
            assert_eq!(cells.row(&cells.row_start(row)), Some(row));
        }
        assert_eq!(cells.row_start(5), [-2, 6, 2]);
        assert_eq!(cells.row(&[0, 4, 1]), None);
        assert_eq!(cells.row(&[0, 5, 4]), None);
    }

    #[test]
    fn lattices_that_cannot_be() {
        assert!(matches!(Lattice::new([0.0; 2], 0.0), Err(LatticeError::Spacing { .. })));
        assert!(matches!(Lattice::new([0.0; 2], f64::NAN), Err(LatticeError::Spacing { .. })));
        assert!(matches!(Lattice::new([f64::NAN; 2], 1.0), Err(LatticeError::Origin { .. })));
        let lattice = Lattice::new([0.0; 3], 1e-9).unwrap();
        let cells = |bounds| lattice.cells("region", &bounds);
        let big = Aabb::new([0.0; 3], [1.0; 3]);
        assert!(matches!(cells(big), Err(LatticeError::TooMany { .. })));
        let huge = Aabb::new([1e300; 3], [1e301; 3]);
        assert!(matches!(cells(huge), Err(LatticeError::TooMany { .. })));
        let tall = Aabb::new([0.0; 3], [1e-9, 1.0, 1e-9]);
        assert!(matches!(cells(tall), Err(LatticeError::TooMany { .. })));
        let endless = Aabb::new([0.0; 3], [1.0, f64::INFINITY, 1.0]);
        assert!(matches!(cells(endless), Err(LatticeError::Unbounded { axis: 'y', .. })));
        assert_eq!(cells(Aabb::EMPTY).unwrap().rows(), 0);
    }
}
