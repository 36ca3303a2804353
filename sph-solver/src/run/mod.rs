//! A run from a scene to its files.

pub mod checkpoints;
pub mod cpu_time;
pub mod digest;
pub mod driver;
pub mod files;
pub mod gather;
pub mod launch;
pub mod load_log;
pub mod plan;
pub mod samples;
pub mod schedule;
pub mod summary;
pub mod table;
pub mod world;

pub use driver::Status;
pub use launch::{RunOptions, run};
pub use summary::Summary;
pub use world::World;
