#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod columns;
mod comm;
mod halo;
mod migrate;
mod partition;
mod parts;
pub mod scale;
mod statistics;
mod sums;
mod zone;

pub use columns::{ColumnError, Columns};
#[cfg(feature = "mpi")]
pub use comm::Mpi;
pub use comm::{
    CommError, Communicator, Exposed, Operation, Part, Progress, RanksError, Solo, ThreadRank,
    ThreadRanks, Traffic, check_same_build,
};
pub use halo::{Halo, HaloPlan, PlanError};
pub use migrate::{MigrateError, MigrationReport, migrate};
pub use partition::{HilbertCurve, Imbalance, Orb, Partition, PartitionError, Rebalance};
pub use parts::Parts;
pub use statistics::RankStatistics;
pub use sums::{ExactSum, global_ranges, global_sums};
pub use zone::{MaxReach, MeanReach, PairReach, Reach, Zone, ZoneError, ZoneOptions};
