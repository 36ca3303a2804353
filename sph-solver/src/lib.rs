#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod block;
pub mod cli;
pub mod eos;
pub mod error;
pub mod lio;
pub mod model;
pub mod partition;
pub mod passes;
pub mod physics;
pub mod rank;
pub mod records;
pub mod run;
pub mod scene;
pub mod setup;
pub mod simulation;
pub mod spray;
pub mod state;
pub mod sweep;
pub mod team;
pub mod terms;
pub mod timestep;
pub mod timings;
