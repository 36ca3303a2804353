//! Whole steps of the dam break: two sweeps with walls, list maintenance, integration.

use serde::{Deserialize, Serialize};
use sph_benches::{Clock, DamBreak, peak_memory};
use sph_decomp::Solo;
use sph_kernels::Real;
use sph_solver::timings::Phase;
use std::error::Error;
use std::process::Command;

/// One case of whole steps.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Case {
    /// Distance of particles, m.
    pub spacing: f64,
    /// Support radius / spacing.
    pub support: f64,
    /// Skin / support radius.
    pub skin: f64,
    /// Pair arithmetic in 64 bits.
    pub double: bool,
    /// Threads.
    pub threads: usize,
    /// What is measured.
    pub span: Span,
}

/// Part of the flow that is measured.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub enum Span {
    /// So many steps in the middle of the collapse.
    Collapse(u64),
    /// From rest to a time in s.
    FromRest(f64),
}

/// What the steps of a case cost.
#[derive(Debug, Serialize, Deserialize)]
pub struct StepRow {
    /// The case.
    pub case: Case,
    /// Fluid particles.
    pub fluid: usize,
    /// Fluid and wall particles.
    pub particles: usize,
    /// Steps measured.
    pub steps: u64,
    /// Mean number of neighbours of a fluid particle within support and skin, walls included.
    pub neighbors: f64,
    /// Fluid particles × steps per core second.
    pub fluid_updates: f64,
    /// Fluid particles and one layer of wall particles × steps per core second: what codes count
    /// whose walls are one layer of particles.
    pub layer_updates: f64,
    /// Visits of these neighbours in both sweeps per core second of everything.
    pub visits: f64,
    /// Wall seconds of a step.
    pub seconds_per_step: f64,
    /// Core seconds per wall second: less than the threads where others took the cores.
    pub cores_had: f64,
    /// Share of wall time in the density pass.
    pub density_share: f64,
    /// Share of wall time in the force pass.
    pub force_share: f64,
    /// Share of wall time in rebuilds: domain check, zone, sorting, cell and neighbour lists.
    pub rebuild_share: f64,
    /// Steps between two rebuilds.
    pub steps_per_rebuild: f64,
    /// Milliseconds of wall time of a rebuild.
    pub rebuild_milliseconds: f64,
    /// Peak of resident memory per particle, walls included, of a process that did only this.
    pub peak_bytes: f64,
    /// Bytes per particle, walls included, by the solver's own count between steps.
    pub counted_bytes: f64,
}

/// Runs all cases, each in a process of its own.
pub fn measure(quick: bool, skin: f64) -> Result<Vec<StepRow>, Box<dyn Error>> {
    let case = |spacing: f64, span: Span| Case {
        spacing,
        support: 3.46,
        skin,
        double: false,
        threads: 1,
        span,
    };
    let collapse = |spacing: f64, steps: u64| case(spacing, Span::Collapse(steps));
    let mut cases = Vec::new();
    if quick {
        let small = collapse(0.02, 20);
        cases.extend([small, Case { double: true, ..small }, Case { threads: 2, ..small }]);
    } else {
        for (spacing, steps) in
            [(0.0133, 120), (0.009, 60), (0.00625, 30), (0.0043, 16), (0.0034, 10)]
        {
            cases.push(collapse(spacing, steps));
        }
        for large in [collapse(0.009, 60), collapse(0.0043, 16)] {
            cases.extend([Case { double: true, ..large }, Case { threads: 2, ..large }]);
        }
        let small = collapse(0.009, 60);
        cases.extend([0.05, 0.1, 0.2, 0.3].map(|skin| Case { skin, ..small }));
        // The default support of scenes, and one with 92 neighbours.
        cases.push(Case { support: 3.0, ..small });
        cases.push(Case { support: 2.8, ..collapse(0.0043, 16) });
        cases.push(case(0.0133, Span::FromRest(1.0)));
    }
    cases.iter().map(in_a_process).collect()
}

fn in_a_process(case: &Case) -> Result<StepRow, Box<dyn Error>> {
    let program = std::env::current_exe()?;
    let output = Command::new(program).arg("--steps").arg(serde_json::to_string(case)?).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Runs one case in this process.
pub fn run(case: &Case) -> Result<StepRow, Box<dyn Error>> {
    if case.double { steps::<f64>(case) } else { steps::<f32>(case) }
}

fn steps<S: Real + bytemuck::Pod>(case: &Case) -> Result<StepRow, Box<dyn Error>> {
    let Case { spacing, support, skin, .. } = *case;
    let collapsing = matches!(case.span, Span::Collapse(_));
    let dam = DamBreak { spacing, support, skin, collapsing };
    let mut simulation = dam.simulation::<S>(&Solo, case.threads)?;
    if collapsing {
        // Memory is touched and lists exist.
        for _ in 0..2 {
            simulation.step(false)?;
        }
    }
    let phases = [Phase::Density, Phase::Force, Phase::Rebuild];
    let before = simulation.counters();
    let timed = phases.map(|phase| simulation.timings().seconds(phase));
    let clock = Clock::start();
    let more = |steps: u64, time: f64| match case.span {
        Span::Collapse(count) => steps < count,
        Span::FromRest(end) => time < end,
    };
    while more(simulation.counters().steps - before.steps, simulation.time()) {
        simulation.step(false)?;
    }
    let spent = clock.spent();
    let after = simulation.counters();
    let seconds = |k: usize| simulation.timings().seconds(phases[k]) - timed[k];
    let steps = after.steps - before.steps;
    let rebuilds = (after.rebuilds - before.rebuilds) as f64;
    let updates = (after.particle_updates - before.particle_updates) as f64;
    let visits = (after.pairs - before.pairs) as f64;
    let rank = simulation.rank();
    let particles = rank.state.len() + rank.elements.len();
    Ok(StepRow {
        case: *case,
        fluid: rank.fluid.owned(),
        particles,
        steps,
        neighbors: 0.5 * visits / updates,
        fluid_updates: updates / spent.core,
        layer_updates: (updates + (steps * dam.layer()) as f64) / spent.core,
        visits: visits / spent.core,
        seconds_per_step: spent.wall / steps as f64,
        cores_had: spent.core / spent.wall,
        density_share: seconds(0) / spent.wall,
        force_share: seconds(1) / spent.wall,
        rebuild_share: seconds(2) / spent.wall,
        steps_per_rebuild: steps as f64 / rebuilds,
        rebuild_milliseconds: 1e3 * seconds(2) / rebuilds,
        peak_bytes: peak_memory().map_or(f64::NAN, |bytes| bytes as f64) / particles as f64,
        counted_bytes: rank.bytes() as f64 / particles as f64,
    })
}
