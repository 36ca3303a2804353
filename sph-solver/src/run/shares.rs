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
    /// Numbers of the solids that move, of which every rank has all.
    moving: Vec<u16>,
    /// The particles, and how many ranks of this process have not taken their share yet.
    rest: Mutex<(Particles<D>, usize)>,
}

impl<const D: usize> Shares<D> {
    /// For so many ranks in this process. Solids of the numbers `moving` are shared out to nobody.
    pub fn new(particles: Particles<D>, moving: Vec<u16>, ranks: usize) -> Self {
        Self { len: particles.len(), moving, rest: Mutex::new((particles, ranks)) }
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
        let mut walls = all.walls(share(comm, all.len() - fluid));
        if !self.moving.is_empty() {
            let rests = |&i: &u32| !self.moving.contains(&walls.solid[i as usize]);
            let kept: Vec<u32> = (0..walls.len() as u32).filter(rests).collect();
            walls.keep(&kept);
        }
        *ranks = ranks.saturating_sub(1);
        if *ranks == 0 {
            *all = Particles::default();
        }
        (state, walls)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::setup::Setup;
    use sph_decomp::ThreadRanks;

    #[test]
    fn every_particle_goes_to_one_rank_and_none_stays_behind() {
        let text = "dimension = 2\nend_time = 1\ngravity = [0, -9.81]\n\
            [numerics]\nspacing = 0.1\n\
            [fluid.water]\ndensity = 1000\n\
            regions = [{ box = { min = [0, 0], max = [0.7, 0.5] } }]\n\
            [[solid]]\nname = \"tank\"\nfluid_side = \"inside\"\n\
            box = { min = [0, 0], max = [1, 1] }\n";
        let scene = Scene::parse("a.toml", text.into(), &[]).unwrap();
        let particles = Setup::<2>::new(&scene).unwrap().particles;
        let expected: Vec<u64> = (0..particles.len() as u64).collect();
        let shares = Shares::new(particles, vec![], 3);
        let taken = ThreadRanks::run(3, |comm| {
            let (state, walls) = shares.take(&comm);
            Ok::<_, String>([state.id, walls.id].concat())
        });
        let mut ids = taken.unwrap().concat();
        ids.sort_unstable();
        assert_eq!(ids, expected);
        assert_eq!(shares.particles(), expected.len());
        assert!(shares.rest.lock().unwrap().0.is_empty());
    }
}
