//! What this machine can do, and what the solver makes of it: one run, one table.
//!
//! `cargo run --release -p sph-benches --bin limits [-- --quick] [--json FILE]`
//!
//! Rates are per *core second*, time in which a thread of this process had a core, so that other
//! programs on the machine disturb little; only the speed-up by a second thread compares times on
//! the wall and wants an idle machine. `benches/README.md` explains how everything is counted.
#![forbid(unsafe_code)]

mod lists;
mod machine;
mod report;
mod steps;
mod sweeps;

use clap::Parser;
use report::Report;
use std::error::Error;
use std::path::PathBuf;

/// Measures the machine, the sweeps, the lists and whole steps.
#[derive(Debug, Parser)]
struct Arguments {
    /// Small cases that take seconds.
    #[arg(long)]
    quick: bool,
    /// Also writes the numbers to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Skin of the lists in whole steps, in support radii.
    #[arg(long, default_value_t = 0.15)]
    skin: f64,
    /// Runs one case of whole steps and prints its row: every case has a process of its own,
    /// because a process has one peak of memory.
    #[arg(long, hide = true, value_name = "CASE")]
    steps: Option<String>,
}

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Effort {
    /// Repetitions of which the median counts.
    rounds: usize,
    /// Seconds of one repetition.
    seconds: f64,
    quick: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    if let Some(case) = &arguments.steps {
        let row = steps::run(&serde_json::from_str(case)?)?;
        println!("{}", serde_json::to_string(&row)?);
        return Ok(());
    }
    let quick = arguments.quick;
    let effort = if quick {
        Effort { rounds: 3, seconds: 0.03, quick }
    } else {
        Effort { rounds: 7, seconds: 0.3, quick }
    };
    let machine = machine::measure(effort)?;
    report::print_machine(&machine);
    let sweeps = sweeps::measure(effort)?;
    report::print_sweeps(&sweeps);
    let lists = lists::measure(effort)?;
    report::print_lists(&lists);
    let steps = steps::measure(quick, arguments.skin)?;
    report::print_steps(&steps);
    if let Some(path) = arguments.json {
        let report = Report { machine, sweeps, lists, steps };
        std::fs::write(path, serde_json::to_string_pretty(&report)?)?;
    }
    Ok(())
}
