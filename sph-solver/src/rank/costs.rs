//! What particles cost in a step, in pairs: the weights of a partition.

/// Cost of a wall particle: no sweep visits it as a target. It is stored, sorted and sent when space
/// is divided, so that a rank is not left with all the walls of a dry half for nothing.
pub(crate) const WALL_COST: f64 = 0.5;
/// Cost of a fluid particle besides its neighbours.
pub(crate) const FLUID_COST: f64 = 20.0;
/// Neighbours of a fluid particle before there are lists.
pub(crate) const USUAL_NEIGHBOURS: usize = 90;
/// Largest over mean cost of a rank that is tolerated beyond the best that a partition reaches. A
/// new partition is cheap beside the rebuild that it is part of, so this is tight.
pub(crate) const TOLERATED_IMBALANCE: f64 = 1.02;
