//! A scene on many ranks, without running it: `sph partition`.
//!
//! [`Field`] holds the particles of a scene, or blocks that stand for them, and divides them as a run
//! would. [`PartitionReport`] tells what every number of ranks would hold and send, and how long a
//! step would take.

mod error;
mod field;
mod network_file;
mod rates;
mod report;
mod table;

pub use error::StudyError;
pub use field::{Costs, Field, spacing_for};
pub use network_file::{NamedNetwork, network};
pub use rates::{MeasuredRates, PACKS_PER_CORE_SECOND, element_bytes, measure_rates};
pub use report::{Division, PartitionReport, Spread, Study, Times};
