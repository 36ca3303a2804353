//! Particles of different spacings: a spacing as a function of the place, cells that match it, and the
//! wall elements of those cells.

mod cells;
mod field;
mod walls;

pub use cells::{Cell, CellTree};
pub use field::{Refinement, SpacingField};
pub use walls::{graded_body_elements, graded_wall_elements};
