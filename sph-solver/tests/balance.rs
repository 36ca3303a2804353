//! The load of the ranks stays even while the water moves.

mod common;

use common::Case;
use sph_decomp::{Evenness, Solo, ThreadRanks};
use sph_solver::error::RunError;

const FLAT: Case<2> = Case { column: [40, 60], tank: [120, 80], spacing: 0.02, skin: 0.15 };
const SOLID: Case<3> = Case { column: [15, 10, 17], tank: [36, 10, 24], spacing: 0.04, skin: 0.15 };
const RANKS: usize = 8;

/// Runs on eight ranks with weights that do not depend on clocks. Returns the mean over the steps
/// of the largest over the mean number of pairs of a rank, how far the front has come, and what the
/// balancer says.
fn run<const D: usize>(case: &Case<D>, steps: usize) -> (f64, f64, Evenness) {
    let ranks = ThreadRanks::run(RANKS, |comm| {
        let mut simulation = case.simulation::<f32>(&comm, 1)?;
        simulation.weigh_by_prediction();
        let mut pairs = Vec::new();
        for _ in 0..steps {
            let before = simulation.counters().pairs;
            simulation.step(false)?;
            pairs.push(simulation.counters().pairs - before);
        }
        let fluid = &simulation.state().position[..simulation.rank().fluid.owned()];
        let front = fluid.iter().map(|x| x[0]).fold(0.0, f64::max);
        Ok::<_, RunError>((pairs, front, simulation.evenness()))
    });
    let ranks = ranks.expect("the run succeeds");
    let imbalance = |step: usize| {
        let pairs = ranks.iter().map(|(pairs, ..)| pairs[step] as f64);
        pairs.clone().fold(0.0, f64::max) * RANKS as f64 / pairs.sum::<f64>()
    };
    let mean = (0..steps).map(imbalance).sum::<f64>() / steps as f64;
    let front = ranks.iter().map(|(_, front, _)| *front).fold(0.0, f64::max);
    assert!(ranks.iter().all(|(.., evenness)| *evenness == ranks[0].2), "all ranks agree");
    (mean, front, ranks[0].2)
}

fn check<const D: usize>(case: &Case<D>, steps: usize) {
    let (mean, front, evenness) = run(case, steps);
    println!("{D}-D: pairs {mean:.4}, front at {front:.3} m, {evenness:?}");
    let start = f64::from(case.column[0]) * case.spacing;
    assert!(front > 1.5 * start, "the water has hardly moved: {front} m after {start} m");
    assert!(evenness.partitions > 5, "{evenness:?}");
    assert!(evenness.predicted <= 1.05, "{evenness:?}");
    assert!(evenness.measured.is_none(), "{evenness:?}");
    assert!(mean <= 1.05, "{mean}");
}

#[test]
fn pairs_are_even_over_a_dam_break_in_the_plane() {
    check(&FLAT, 700);
}

#[test]
fn pairs_are_even_over_a_dam_break_in_space() {
    check(&SOLID, 350);
}

/// Ranks that wait for each other in every step do not scale: only rebuilds have blocking operations.
#[test]
fn a_step_without_a_rebuild_has_no_blocking_operation() {
    let calls = ThreadRanks::run(3, |comm| {
        let mut simulation = FLAT.simulation::<f32>(&comm, 1)?;
        let mut calls = Vec::new();
        for _ in 0..60 {
            let before = simulation.collectives().calls;
            simulation.step(false)?;
            calls.push((simulation.just_rebuilt(), simulation.collectives().calls - before));
        }
        Ok::<_, RunError>(calls)
    });
    for calls in calls.expect("the run succeeds") {
        assert!(calls.iter().all(|&(rebuilt, calls)| rebuilt == (calls > 0)), "{calls:?}");
        let rebuilds = calls.iter().filter(|(rebuilt, _)| *rebuilt).count();
        assert!((2..50).contains(&rebuilds), "{rebuilds} rebuilds in 60 steps");
    }
}

#[test]
fn one_rank_is_not_balanced() {
    let mut simulation = FLAT.simulation::<f32>(&Solo, 1).expect("a simulation");
    for _ in 0..3 {
        simulation.step(false).expect("a step");
    }
    let evenness = simulation.evenness();
    assert_eq!((evenness.predicted, evenness.partitions), (1.0, 0));
}
