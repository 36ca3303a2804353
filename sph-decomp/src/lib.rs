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
    Blocking, Collectives, CommError, Communicator, Exposed, Metered, Operation, Part, Progress,
    RanksError, Solo, ThreadRank, ThreadRanks, Traffic, check_same_build,
};
pub use halo::{Halo, HaloPlan, PlanError};
pub use migrate::{MigrateError, MigrationReport, migrate};
pub use partition::{
    Askew, Balancer, Evenness, HilbertCurve, Imbalance, Load, Orb, Partition, PartitionError,
    Rebalance, Review,
};
pub use parts::Parts;
pub use statistics::RankStatistics;
pub use sums::{ExactSum, global_ranges, global_sums};
pub use zone::{MaxReach, MeanReach, PairReach, Reach, Zone, ZoneError, ZoneOptions};
