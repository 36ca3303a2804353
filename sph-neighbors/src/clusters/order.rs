//! An order in which consecutive particles are close together.

use crate::{Grid, GridError};

/// Sorts particles into square columns, and in a column by height: eight consecutive particles of a
/// fluid then fill about a cube (a square in two dimensions), wherever they start.
///
/// Only the speed of a sweep over a [`ClusterList`](crate::ClusterList) depends on this order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColumnOrder<const D: usize> {
    grid: Grid<D>,
}

impl<const D: usize> ColumnOrder<D> {
    /// Columns for particles at about this distance from each other.
    pub fn new(origin: [f64; D], spacing: f64) -> Result<Self, GridError> {
        // Eight particles in a cube of this edge.
        let edge = spacing * (super::CLUSTER as f64).powf(1.0 / D as f64);
        Ok(Self { grid: Grid::new(origin, edge)? })
    }

    /// Sort by this key.
    ///
    /// Keys of positions very far apart may coincide, which only makes clusters less compact.
    #[inline]
    pub fn key(&self, x: &[f64; D]) -> u64 {
        let fixed = self.grid.fixed(x);
        let cell = self.grid.cell_at(&fixed);
        let height = (fixed[D - 1] >> HEIGHT_DROP) as u64 & 0xffff_ffff;
        let column = match D {
            1 => 0,
            2 => cell[0] as u64 & 0xffff_ffff,
            _ => (cell[1] as u64 & 0xffff) << 16 | (cell[0] as u64 & 0xffff),
        };
        column << 32 | height
    }
}

/// Heights are compared in units of 2⁻⁸ of a column's edge.
const HEIGHT_DROP: u32 = 12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_first_then_height() {
        let order = ColumnOrder::<3>::new([0.0; 3], 0.5).unwrap();
        let key = |x: [f64; 3]| order.key(&x);
        assert!(key([0.1, 0.9, 7.0]) > key([0.9, 0.1, 6.0]));
        assert!(key([0.1, 0.1, 1e3]) < key([1.1, 0.1, 0.0]));
        assert!(key([5.0, 0.1, 0.0]) < key([0.1, 1.1, 0.0]));
    }
}
