//! What the benchmarks share: particle fields of known size, ready sweeps, and the limits of the
//! machine to compare them with.
//!
//! * [`Lattice`], [`DamBreak`]: particles. [`SweepCase`]: particles with records and lists.
//! * [`by_hand`]: the sums of the solver written out, to count the instructions of its terms.
//! * [`fma_flops`], [`triad_bytes`]: arithmetic and memory of this machine.
//! * [`plot`]: SVG files.
//! * [`Clock`], [`median`], [`peak_memory`]: measuring on a machine that others use too.
#![forbid(unsafe_code)]

mod bandwidth;
pub mod by_hand;
mod clock;
mod dam_break;
mod lattice;
mod memory;
mod peak;
pub mod plot;
mod sweep_case;

pub use bandwidth::{Triad, triad_bytes};
pub use clock::{Clock, Spent, median};
pub use dam_break::DamBreak;
pub use lattice::{Lattice, Noise};
pub use memory::peak_memory;
pub use peak::fma_flops;
pub use sweep_case::{
    DensityTerms, ForceTerms, SweepCase, density_terms, force_terms, inviscid_force_terms,
};
