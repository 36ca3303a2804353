//! Free fluid without walls: momentum is conserved, on several ranks that share it out anew.

mod common;

use common::{Case, digest, indices};
use sph_decomp::{Communicator, ThreadRanks};
use sph_kernels::WendlandC2;
use sph_solver::error::RunError;
use sph_solver::run::checkpoints::share;
use sph_solver::run::digest::Digest;
use sph_solver::run::samples::budget;
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::team::Team;
use sph_solver::terms::{ArtificialViscosity, Continuity, SymmetricPressure};
use sph_solver::walls::WallElements;

const DROP: Case<2> = Case { column: [20, 20], tank: [20, 20], spacing: 0.05, skin: 0.1 };

/// Digest and momentum per |momentum| after a while: a drop that is squeezed and flies.
fn fly(ranks: usize) -> (Digest, f64) {
    let results = ThreadRanks::run(ranks, |comm| {
        let mut model = DROP.model();
        model.gravity = [0.0; 2];
        model.domain = ([-10.0; 2], [10.0; 2]);
        let mut state = DROP.fluid();
        for (v, x) in state.velocity.iter_mut().zip(&state.position) {
            *v = [3.0 - 2.0 * x[0], 1.0 + 2.0 * x[1]];
        }
        state.keep(&indices(share(&comm, state.len())));
        let h = model.limits.smoothing_length;
        let friction = ArtificialViscosity {
            strength: 0.02 * h * model.limits.sound_speed * 1000.0,
            softening: 0.01 * h * h,
        };
        let scheme = Scheme::<2, f64>::of::<WendlandC2>(Continuity, (SymmetricPressure, friction));
        let mut simulation = Simulation::new(
            &comm as &dyn Communicator,
            Team::new(1)?,
            model,
            scheme.build(),
            state,
            WallElements::default(),
            None,
        )?;
        let first = simulation.step(true)?.expect("a report was asked for");
        let before = budget(&comm, simulation.model(), &first)?;
        // Long enough for several partitions of space.
        for _ in 0..400 {
            simulation.step(false)?;
        }
        assert!(simulation.counters().rebuilds > 41, "{:?}", simulation.counters());
        let last = simulation.step(true)?.expect("a report was asked for");
        let after = budget(&comm, simulation.model(), &last)?;
        let drift = (0..2).map(|k| (after.momentum[k] - before.momentum[k]).abs()).sum::<f64>();
        Ok::<_, RunError>((digest(&last), drift / before.momentum[0].hypot(before.momentum[1])))
    })
    .expect("the run succeeds");
    let merged = results.iter().fold(Digest::default(), |all, one| all.merge(one.0));
    (merged, results[0].1)
}

#[test]
fn momentum_is_conserved_on_any_ranks() {
    let (alone, drift) = fly(1);
    assert!(drift < 1e-11, "{drift:e}");
    for ranks in [2, 3] {
        assert_eq!(fly(ranks).0, alone, "{ranks} ranks");
    }
}
