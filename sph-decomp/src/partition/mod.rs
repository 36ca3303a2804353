//! Who owns which part of space.

mod askew;
mod balance;
mod balancer;
mod divide;
mod hilbert;
mod orb;
mod splitters;
mod weights;

pub use askew::Askew;
pub(crate) use askew::shear;
pub use balance::{Imbalance, Rebalance};
pub use balancer::{Balancer, Evenness, Load, Review};
pub use hilbert::HilbertCurve;
pub(crate) use orb::HEAVY_SHARE;
pub use orb::Orb;

use crate::CommError;

/// A division of space among ranks.
pub trait Partition<const D: usize> {
    /// The rank that owns what lies at `x`. Defined for all of space.
    fn owner(&self, x: &[f64; D]) -> usize;

    /// The owners of many particles, as [`migrate`](crate::migrate) takes them.
    fn owners(&self, positions: &[[f64; D]]) -> Vec<u32> {
        positions.iter().map(|x| self.owner(x) as u32).collect()
    }
}

/// Why a partition cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// A coordinate is NaN or infinite.
    #[error("particle {particle} (index on this rank) is at {value} on axis {axis}")]
    Position {
        /// Index of the particle on this rank.
        particle: usize,
        /// The axis.
        axis: usize,
        /// The coordinate.
        value: f64,
    },
    /// A weight is negative, NaN or infinite.
    #[error(
        "particle {particle} (index on this rank) has weight {value}; a weight must be finite and not negative"
    )]
    Weight {
        /// Index of the particle on this rank.
        particle: usize,
        /// Its weight.
        value: f64,
    },
    /// Not one weight per particle.
    #[error(
        "there are {weights} weights for {particles} particles (give one each, or none at all)"
    )]
    Length {
        /// Number of weights.
        weights: usize,
        /// Number of particles.
        particles: usize,
    },
    /// The ranks could not agree.
    #[error(transparent)]
    Comm(#[from] CommError),
}

fn check_positions<const D: usize>(positions: &[[f64; D]]) -> Result<(), PartitionError> {
    for (particle, x) in positions.iter().enumerate() {
        if let Some(axis) = x.iter().position(|x| !x.is_finite()) {
            return Err(PartitionError::Position { particle, axis, value: x[axis] });
        }
    }
    Ok(())
}
