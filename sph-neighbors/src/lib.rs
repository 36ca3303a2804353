//! Cell lists and neighbour lists over particle positions and radii, in a canonical order.
//!
//! * [`Grid`]: cells and fixed-point coordinates that depend on an origin and a cell size only.
//! * [`CellList`]: particles sorted by cell, then by id.
//! * [`LevelList`]: the same for particles of different radii, in several grids.
//! * `TreeList`, with the feature `kiddo`: the same for radii that differ by more than 1 : 10⁴,
//!   in one k-d tree per factor of two.
//! * [`NeighborList`]: who is within reach of whom.
//! * [`ClusterList`]: who is within reach of any of eight targets that are close together.
//!
//! Lists depend on the set of particles alone: not on the order in which they are given, not on the
//! number of threads, and not on which other particles are present further away. So a particle has
//! the same neighbours in the same order in every decomposition of a domain.

#![deny(unsafe_code)]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod cells;
mod clusters;
mod grid;
mod levels;
mod list;
#[cfg(feature = "kiddo")]
mod trees;

pub use cells::CellList;
pub use clusters::{CLUSTER, ClusterList, Clusters, ColumnOrder};
pub use grid::{Grid, GridError};
pub use levels::LevelList;
pub use list::{NeighborList, PairReach};
#[cfg(feature = "kiddo")]
pub use trees::TreeList;
