//! The same bits on any number of ranks and threads, in both precisions and dimensions.

mod common;

use bytemuck::Pod;
use common::{Case, digest};
use sph_decomp::ThreadRanks;
use sph_kernels::Real;
use sph_solver::error::RunError;
use sph_solver::run::digest::Digest;

const FLAT: Case<2> = Case { column: [12, 20], tank: [40, 30], spacing: 0.05, skin: 0.15 };
const SOLID: Case<3> = Case { column: [8, 6, 8], tank: [20, 6, 12], spacing: 0.05, skin: 0.15 };

/// Digest after `steps` steps, and the pairs summed over the ranks.
fn run<const D: usize, S: Real + Pod>(
    case: &Case<D>,
    ranks: usize,
    threads: usize,
    steps: usize,
) -> (Digest, u64) {
    let parts = ThreadRanks::run(ranks, |comm| {
        let mut simulation = case.simulation::<S>(&comm, threads)?;
        for _ in 0..steps {
            simulation.step(false)?;
        }
        let full = simulation.step(true)?.expect("a report was asked for");
        Ok::<_, RunError>((digest(&full), simulation.counters().pairs))
    })
    .expect("the run succeeds");
    let digests = parts.iter().map(|part| part.0);
    let digest = digests.fold(Digest::default(), Digest::merge);
    (digest, parts.iter().map(|part| part.1).sum())
}

fn check<const D: usize, S: Real + Pod>(case: &Case<D>, steps: usize) {
    let alone = run::<D, S>(case, 1, 1, steps);
    for (ranks, threads) in [(1, 2), (2, 1), (3, 1), (4, 2), (7, 1)] {
        let shared = run::<D, S>(case, ranks, threads, steps);
        assert_eq!(alone, shared, "{D}-D, {ranks} ranks with {threads} threads");
    }
}

#[test]
fn two_dimensions_mixed() {
    check::<2, f32>(&FLAT, 120);
}

#[test]
fn two_dimensions_double() {
    check::<2, f64>(&FLAT, 60);
}

#[test]
fn three_dimensions_mixed() {
    check::<3, f32>(&SOLID, 60);
}

#[test]
fn three_dimensions_double() {
    check::<3, f64>(&SOLID, 30);
}

/// The test above could pass with a digest that sees nothing.
#[test]
fn one_step_more_is_another_state() {
    assert_ne!(run::<2, f32>(&FLAT, 1, 1, 5).0, run::<2, f32>(&FLAT, 1, 1, 6).0);
}
