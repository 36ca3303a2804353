//! What a run on many ranks would be like, without running it.
//!
//! 1. [`Layout::of_points`] divides particles among any number of ranks in one process and counts
//!    what every rank would hold and send, by the very code that ranks run: the same cuts, the same
//!    overlap zone.
//! 2. [`Layout::of_blocks`] does the same for more particles than fit into memory: blocks of a
//!    lattice stand for the particles on their points, and cuts go through blocks.
//! 3. [`Prediction`] turns a layout into seconds, with the LogGP model of a [`Network`] and the
//!    [`Rates`] of a core.
//!
//! *Active* particles are computed in every pass and exchanged in it. *Passive* ones, such as walls
//! at rest, are only read, and sent only when space is divided anew. The zone is that of the active
//! particles: a particle is exchanged where it is near active ones of another rank.

mod block_cut;
mod block_zone;
mod blocks;
mod collective;
mod error;
mod load;
mod near;
mod network;
mod pack;
mod points;
mod predict;
mod rebuild;
mod step;
mod traffic;

pub use blocks::{BlockClass, LatticeBlock};
pub use error::ScaleError;
pub use load::{Layout, Link, RankLoad};
pub use network::Network;
pub use pack::measure_pack_rate;
pub use points::Point;
pub use predict::Prediction;
pub use rebuild::Rebuilds;
pub use step::{Rates, StepTime, Variant};
pub use traffic::RankTraffic;
