//! What can be wrong with a grid or a reach.

use thiserror::Error;

/// Why a grid cannot be made, or not be used for a search.
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
    /// A period is not a finite number, or out of range.
    #[error(
        "period {value} of axis {axis} is not between one cell and the range of the grid: use \
         smaller cells, or check the box"
    )]
    Period {
        /// Axis of the period.
        axis: usize,
        /// The offending value.
        value: f64,
    },
    /// The reach is negative or not a number, or much larger than a cell.
    #[error("reach {reach} must be positive and at most {most}: use larger cells")]
    Reach {
        /// The offending value.
        reach: f64,
        /// The largest reach that the cells allow.
        most: f64,
    },
    /// A particle would meet two images of another.
    #[error(
        "period {period} of axis {axis} is shorter than twice the reach {reach}: a particle would \
         meet two images of another; use a longer box or a smaller reach"
    )]
    ShortPeriod {
        /// Axis of the period.
        axis: usize,
        /// The offending period.
        period: f64,
        /// The reach.
        reach: f64,
    },
}
