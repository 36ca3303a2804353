#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod block;
pub mod bodies;
pub mod cli;
mod csv_file;
pub mod energy;
pub mod eos;
pub mod error;
pub mod grading;
mod groups;
pub mod kernel_shape;
pub mod lio;
pub mod loads;
pub mod model;
pub mod partition;
pub mod passes;
pub mod rank;
pub mod records;
pub mod report;
pub mod run;
pub mod scene;
pub mod scheme;
pub mod search;
pub mod setup;
pub mod simulation;
pub mod space;
pub mod spray;
pub mod stability;
pub mod state;
pub mod study;
pub mod sweep;
pub mod team;
pub mod terms;
pub mod timestep;
pub mod timings;
pub mod walls;
