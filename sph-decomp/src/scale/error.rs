//! Why a prediction cannot be made.

use crate::{PartitionError, ZoneError};

/// Why a prediction cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// More ranks than things to share out.
    #[error("{ranks} ranks cannot share {particles} particles; use fewer ranks")]
    TooManyRanks {
        /// Number of ranks.
        ranks: usize,
        /// Number of particles.
        particles: u64,
    },
    /// A number that must be positive is not.
    #[error("`{name}` is {value}; it must be a positive number{unit}")]
    NotPositive {
        /// What it is called.
        name: &'static str,
        /// Its value.
        value: f64,
        /// " of seconds" or the like.
        unit: &'static str,
    },
    /// A network that is not known by name.
    #[error("there is no network `{name}`; known are {}, or give your own numbers", known.join(", "))]
    UnknownNetwork {
        /// The name asked for.
        name: String,
        /// The names that are known.
        known: Vec<&'static str>,
    },
    /// A block without points, or of a class that is not there.
    #[error("block {block} has no points or names class {class}, which is not given")]
    Block {
        /// Index of the block.
        block: usize,
        /// Its class.
        class: u16,
    },
    /// The particles cannot be divided.
    #[error(transparent)]
    Partition(#[from] PartitionError),
    /// The overlap zone cannot be found.
    #[error(transparent)]
    Zone(#[from] ZoneError),
}

/// Refuses what is not a positive, finite number.
pub(super) fn positive(
    name: &'static str,
    value: f64,
    unit: &'static str,
) -> Result<(), ScaleError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ScaleError::NotPositive { name, value, unit })
}
