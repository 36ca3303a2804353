//! A run from a scene to its files.

pub mod checkpoints;
pub mod cpu_time;
pub mod digest;
pub mod driver;
pub mod files;
pub mod gather;
pub mod plan;
pub mod samples;
pub mod schedule;
pub mod summary;
pub mod table;
