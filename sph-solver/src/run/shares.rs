//! The initial particles, until every rank of this process has its share of them.

use super::checkpoints::share;
use crate::setup::Particles;
use crate::state::State;
use crate::walls::WallElements;
use sph_decomp::Communicator;
use std::sync::{Mutex, PoisonError};

/// All particles that a process has set up, for the ranks in it. They go when the last of these ranks
/// has taken its share: from then on each particle is in memory once.
#[derive(Debug)]
pub struct Shares<const D: usize> {
    len: usize,
    /// The particles, and how many ranks of this process have not taken their share yet.
    rest: Mutex<(Particles<D>, usize)>,
}

impl<const D: usize> Shares<D> {
    /// For so many ranks in this process.
    pub fn new(particles: Particles<D>, ranks: usize) -> Self {
        Self { len: particles.len(), rest: Mutex::new((particles, ranks)) }
    }

    /// Number of particles of all shares.
    pub fn particles(&self) -> usize {
        self.len
    }

    /// The shares of a rank of fluid and walls, which takes them once.
    pub fn take(&self, comm: &dyn Communicator) -> (State<D>, WallElements<D>) {
        let mut rest = self.rest.lock().unwrap_or_else(PoisonError::into_inner);
        let (all, ranks) = &mut *rest;
        let fluid = all.fluid().len();
        let state = all.state(share(comm, fluid));
        let walls = all.walls(share(comm, all.len() - fluid));
        *ranks = ranks.saturating_sub(1);
        if *ranks == 0 {
            *all = Particles::default();
        }
        (state, walls)
    }
}
