//! The tables.

use crate::lists::ListRow;
use crate::machine::Machine;
use crate::steps::{Span, StepRow};
use crate::sweeps::SweepRow;
use serde::Serialize;

/// Everything, as it goes into the JSON file.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Limits of the machine.
    pub machine: Machine,
    /// The sweeps alone.
    pub sweeps: Vec<SweepRow>,
    /// Cell and neighbour lists alone.
    pub lists: Vec<ListRow>,
    /// Whole steps.
    pub steps: Vec<StepRow>,
}

/// Prints the limits of the machine.
pub fn print_machine(machine: &Machine) {
    let Machine { simd, cores, fma_single, fma_double, triad_one, triad_two } = machine;
    println!("machine: {cores} cores, {simd} lanes");
    println!("multiply-add, one core: {fma_single:.1} GFLOP/s single, {fma_double:.1} double");
    println!("triad: {triad_one:.1} GB/s on one thread, {triad_two:.1} on two");
}

/// Prints the sweeps.
pub fn print_sweeps(rows: &[SweepRow]) {
    println!();
    println!("sweeps, per core: rates are of pairs within the support");
    println!(
        "| precision | particles | support | skin | neighbours (lanes) | density visits M/s | \
         force visits M/s | δ-SPH pairs M/s | of FMA peak | 2 threads |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        println!(
            "| {} | {} | {} | {} | {:.0} ({:.0}) | {:.0} | {:.0} | {:.0} | {:.3} | {:.2} × |",
            row.precision,
            row.particles,
            row.support,
            row.skin,
            row.neighbors,
            row.lanes,
            row.density_visits * 1e-6,
            row.force_visits * 1e-6,
            row.pairs * 1e-6,
            row.peak_fraction,
            row.two_threads,
        );
    }
}

/// Prints the lists.
pub fn print_lists(rows: &[ListRow]) {
    println!();
    println!("lists, per core");
    println!(
        "| lists | particles | reach | neighbours | tests per neighbour | cells ns/particle | \
         lists ns/particle | neighbours M/s | bytes/particle | 2 threads |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        println!(
            "| {} | {} | {} | {:.0} | {:.2} | {:.0} | {:.0} | {:.0} | {:.0} | {:.2} × |",
            row.kind,
            row.particles,
            row.reach,
            row.neighbors,
            row.tests_per_neighbor,
            row.cells,
            row.lists,
            row.rate * 1e-6,
            row.bytes,
            row.two_threads,
        );
    }
}

/// Prints the whole steps.
pub fn print_steps(rows: &[StepRow]) {
    println!();
    println!("whole steps of the dam break, per core");
    println!(
        "| case | precision | threads | support | skin | fluid (all) particles | neighbours | \
         M updates/s fluid (with one layer of wall) | visits M/s | ms/step | density / force / rebuild % | \
         steps per rebuild | ms/rebuild | peak bytes per particle (per fluid particle; counted) | \
         cores had |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        let span = match row.case.span {
            Span::Collapse(steps) => format!("collapse, {steps} steps"),
            Span::FromRest(end) => format!("rest to {end} s, {} steps", row.steps),
        };
        println!(
            "| {span} | {} | {} | {} | {} | {} ({}) | {:.0} | {:.2} ({:.2}) | {:.0} | {:.1} | \
             {:.0} / {:.0} / {:.0} | {:.1} | {:.1} | {:.0} ({:.0}; {:.0}) | {:.2} |",
            if row.case.double { "double" } else { "mixed" },
            row.case.threads,
            row.case.support,
            row.case.skin,
            row.fluid,
            row.particles,
            row.neighbors,
            row.fluid_updates * 1e-6,
            row.layer_updates * 1e-6,
            row.visits * 1e-6,
            row.seconds_per_step * 1e3,
            row.density_share * 100.0,
            row.force_share * 100.0,
            row.rebuild_share * 100.0,
            row.steps_per_rebuild,
            row.rebuild_milliseconds,
            row.peak_bytes,
            row.peak_bytes * row.particles as f64 / row.fluid as f64,
            row.counted_bytes,
            row.cores_had,
        );
    }
}
