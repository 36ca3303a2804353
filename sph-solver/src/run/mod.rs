//! A run from a scene to its files.

pub mod checkpoints;
pub mod columns;
pub mod cpu_time;
pub mod digest;
pub mod driver;
mod energy_log;
pub mod files;
pub mod folder;
pub mod gather;
pub mod gauges;
pub mod identity;
pub mod launch;
pub mod load_log;
pub mod notes;
pub mod plan;
pub mod record;
pub mod reference;
pub mod samples;
pub mod schedule;
pub mod shares;
pub mod snapshot_choice;
pub mod stop;
pub mod summary;
pub mod table;
pub mod world;

pub use driver::Status;
pub use folder::Existing;
pub use launch::{RunOptions, run};
pub use notes::Notes;
pub use record::{Record, shell_line};
pub use stop::{Stop, StopReason};
pub use summary::Summary;
pub use world::World;
