//! The model beside real runs on ranks that are threads.

use crate::Outcome;
use crate::series::scene_of;
use sph_decomp::scale::{
    Layout, Network, Prediction, RankLoad, RankTraffic, Rates, Rebuilds, StepTime, Variant,
};
use sph_solver::partition::{Costs, Field};
use sph_solver::run::{Existing, RunOptions, Summary, World, run};
use sph_solver::scene::Scene;
use std::path::PathBuf;

/// Fluid particles and simulated time of the runs.
const PARTICLES: f64 = 40_000.0;
const END: f64 = 0.05;
/// Simulated time of two steps.
const TINY: f64 = 1e-9;

/// All ranks in one node: messages are copies.
const MEMORY: Network =
    Network { latency: 1e-6, overhead: 1e-6, gap: 1e-7, node_bandwidth: 1e10, ranks_per_node: 1e6 };

pub fn compare() -> Outcome<()> {
    let scene = scene_of(PARTICLES)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "\n### The model beside runs of {PARTICLES} particles, ranks as threads on {cores} cores\n"
    );
    println!(
        "| ranks | outer, predicted | outer, run | imbalance, predicted | imbalance, run | \
         core-seconds over one rank, predicted | run | wall time over one rank, predicted | run |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut one = None;
    for ranks in [1, 2, 3, 4, 8] {
        // The program's core-seconds so far; what setting up takes is in both differences.
        let (_, before) = simulate(&scene, ranks, TINY)?;
        let (_, between) = simulate(&scene, ranks, TINY)?;
        let (summary, after) = simulate(&scene, ranks, END)?;
        let core = (after - between) - (between - before);
        let (rates, seconds, core_of_one) =
            *one.get_or_insert((rates(&summary), loop_seconds(&summary), core));
        let layout = Field::<3>::read(&scene, Costs::Lists, false)?.layout(ranks)?;
        let work = work(&layout, &rates);
        let slowest = Prediction::of(&layout, &rates, &MEMORY, Variant::BEST).step;
        let alone = Prediction::of(&layout, &rates, &MEMORY, Variant::BEST).one_rank;
        let outer: usize = summary.local_inner_outer.iter().map(|rank| rank[2]).sum();
        println!(
            "| {ranks} | {:.0} | {outer} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
            layout.sum(|rank| rank.outer),
            layout.imbalance(RankLoad::pairs).ratio(),
            summary.imbalance,
            work / alone,
            core / core_of_one,
            slowest.max(work / cores as f64) / alone,
            loop_seconds(&summary) / seconds,
        );
    }
    Ok(())
}

/// Core-seconds of a step of all ranks; waiting ranks leave their core to others.
fn work(layout: &Layout, rates: &Rates) -> f64 {
    let ranks = layout.ranks.len();
    let traffic = RankTraffic::of(layout, &MEMORY);
    let times = layout.ranks.iter().zip(&traffic).map(|(load, traffic)| {
        let time = StepTime::of(load, traffic, rates, &MEMORY, ranks, Variant::BEST);
        time.total() - time.exposed
    });
    times.sum()
}

/// Runs until `end` (s); also returns the core-seconds of this program until then, NaN where the
/// system does not tell.
fn simulate(scene: &Scene, ranks: usize, end: f64) -> Outcome<(Summary, f64)> {
    let folder = Scratch(std::env::temp_dir().join(format!("sph-scaling-{}", std::process::id())));
    let options = RunOptions {
        out: folder.0.clone(),
        end_time: Some(end),
        ranks: Some(ranks),
        threads: Some(1),
        existing: Existing::Overwrite,
        ..RunOptions::default()
    };
    let summary = run(&World::Process, scene, &options, &|_| ())?;
    let core = summary.cpu_seconds.unwrap_or(f64::NAN);
    Ok((summary, core))
}

struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        // Nothing depends on it.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn loop_seconds(summary: &Summary) -> f64 {
    summary.phases.rebuild + summary.phases.density + summary.phases.force
}

fn rates(summary: &Summary) -> Rates {
    Rates {
        pairs: summary.pair_interactions_per_second,
        packs: 2e8,
        element_bytes: [12.0, 24.0],
        rebuilds: Rebuilds {
            share: summary.phases.rebuild / loop_seconds(summary),
            steps: summary.steps_per_rebuild,
            per_partition: 20.0,
        },
    }
}
