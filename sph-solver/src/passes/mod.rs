//! The two passes of a step: density first, then forces.
//!
//! Kick–drift–kick with the density in the middle (the leapfrog form of Verlet; Antuono et al.
//! (2010) use it with δ-SPH in higher order, Adami, Hu & Adams (2012), eq. 21–25, in this one):
//!
//! ```text
//! v^{n+½} = v^n + dt_n/2 a^n
//! x^{n+1} = x^n + dt_n v^{n+½}
//! ρ^{n+1} = ρ^n + dt_n dρ/dt(x^{n+1}, v^{n+½}, ρ^n)          density pass
//! a^{n+1} = a(x^{n+1}, v^{n+½}, ρ^{n+1})                     force pass
//! v^{n+1} = v^{n+½} + dt_n/2 a^{n+1}
//! ```
//!
//! The last kick of a step, the first kick of the next one and its drift are one update, at the end
//! of the force pass. Between steps a run therefore holds `x^{n+1}`, `v^{n+½}`, `ρ^n` and `dt_n`.

mod density;
mod force;

pub use density::{DENSEST, DensityPass};
pub use force::{ForcePass, kicked};

use crate::records::Record;
use crate::sweep::Neighbors;
use sph_neighbors::ClusterList;

/// What surrounds the fluid particles of a rank, and the terms of a pass for it.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a, S, F, W> {
    /// Fluid neighbours of every owned fluid particle.
    pub near_fluid: &'a ClusterList,
    /// Terms of fluid neighbours.
    pub fluid: F,
    /// Records of the wall particles. They do not change during a pass.
    pub walls: &'a [Record<S>],
    /// Wall neighbours of every owned fluid particle.
    pub near_walls: &'a ClusterList,
    /// Terms of wall neighbours.
    pub wall: W,
}

impl<'a, S, F: Copy, W: Copy> Surroundings<'a, S, F, W> {
    /// The groups of neighbours of a sweep over the fluid records `fluid`.
    pub fn sources<'b>(
        &'b self,
        fluid: &'b [Record<S>],
    ) -> (Neighbors<'b, S, F>, Neighbors<'b, S, W>) {
        (
            Neighbors { records: fluid, list: self.near_fluid, terms: self.fluid },
            Neighbors { records: self.walls, list: self.near_walls, terms: self.wall },
        )
    }
}
