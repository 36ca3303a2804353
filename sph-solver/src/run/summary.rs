//! `summary.json`: what a run did and what it cost.

use super::cpu_time::cpu_seconds;
use super::driver::Finished;
use super::energy_log::{EnergyRow, Worst};
use super::load_log::LoadTotal;
use super::samples::Budget;
use crate::energy::Sink;
use crate::error::RunError;
use crate::setup::SchemeChoice;
use crate::simulation::Simulation;
use crate::timings::Phase;
use bytemuck::Pod;
use serde::Serialize;
use sph_decomp::Communicator;
use sph_kernels::Real;
use std::collections::BTreeMap;

/// What the caller of a run knows about it.
#[derive(Debug, Clone)]
pub struct Meta {
    /// Name of the scene.
    pub name: String,
    /// "mixed" or "double".
    pub precision: &'static str,
    /// The scheme, and why.
    pub scheme: SchemeChoice,
    /// "solo", "threads" or "mpi".
    pub communicator: &'static str,
    /// Whether messages travel while the local particles are computed.
    pub overlapped: bool,
    /// Whether all ranks are in this process, so that its CPU time counts once.
    pub one_process: bool,
}

/// Results and cost of a run. Times are of the slowest rank, counts of all ranks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub name: String,
    /// Version of the program.
    pub version: &'static str,
    /// Dimension.
    pub dimension: usize,
    /// "mixed" or "double".
    pub precision: &'static str,
    /// The scheme with its artificial viscosity, and why.
    pub scheme: SchemeChoice,
    /// Vector unit that the sweeps used.
    pub simd: &'static str,
    /// Number of ranks.
    pub ranks: usize,
    /// "solo", "threads" or "mpi".
    pub communicator: &'static str,
    /// Threads per rank.
    pub threads: usize,
    /// Particles by kind at the end.
    pub particles: Particles,
    /// Steps made, those before a restart included.
    pub steps: u64,
    /// Simulated time at the end, s.
    pub simulated_time: f64,
    /// Last time step, s.
    pub time_step: f64,
    /// Wall-clock seconds of the stepping, output included.
    pub wall_seconds: f64,
    /// CPU seconds of all threads of all ranks since the program began, where the system tells.
    pub cpu_seconds: Option<f64>,
    /// CPU seconds of all threads of all ranks in the steps of this process, output included: what the
    /// result cost. Where the system tells, in units of 0.01 s.
    pub core_seconds: Option<f64>,
    /// Seconds by phase, of the rank that spent most on it.
    pub phases: Phases,
    /// Fluid particles times steps per second, over all ranks.
    pub particle_updates_per_second: f64,
    /// Pairs evaluated in both passes of all steps of this process, over all ranks, walls included;
    /// list entries in the skin count. The same on any number of ranks: no pair is computed twice.
    pub pair_interactions: u64,
    /// Pairs evaluated in both passes per second, over all ranks; list entries in the skin count.
    pub pair_interactions_per_second: f64,
    /// List entries per fluid particle, skin included.
    pub neighbours_per_particle: f64,
    /// Steps between two list rebuilds.
    pub steps_per_rebuild: f64,
    /// Steps in which a particle had moved farther than the lists allow for.
    pub stale_steps: u64,
    /// Bytes of particle data and lists per particle.
    pub bytes_per_particle: f64,
    /// Whether messages travelled while the local particles were computed.
    pub overlapped: bool,
    /// Communication of the passes that was not hidden (waiting in step 7, reduction of the time
    /// step included), s, of the rank with most.
    pub exposed_seconds: f64,
    /// The same as a fraction of the time of the steps, of the rank with the largest.
    pub exposed_share: f64,
    /// Time in the blocking operations of rebuilds, s, of the rank with most: waiting for slower
    /// ranks included. No other step has any.
    pub collective_seconds: f64,
    /// The same as a fraction of the time of the steps, of the rank with the largest.
    pub collective_share: f64,
    /// Messages sent in the passes, over all ranks.
    pub messages: u64,
    /// Bytes sent in the passes, over all ranks.
    pub bytes_sent: u64,
    /// Received copies of fluid particles divided by owned ones at the end.
    pub halo_redundancy: f64,
    /// Local, inner and outer fluid particles of each rank at the end.
    pub local_inner_outer: Vec<[usize; 3]>,
    /// Largest over mean time of the sweeps of a rank between two rebuilds, averaged over the run.
    /// With one thread per rank it is the time for which that thread had a core.
    pub imbalance: f64,
    /// Largest over mean predicted cost of a rank (list lengths and walls), averaged over the run.
    pub predicted_imbalance: f64,
    /// How often space was divided among the ranks.
    pub partitions: u64,
    /// Energies at the start of this process and at the end, J.
    pub energies: Energies,
    /// Where energy went, if the scene asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_budget: Option<EnergyBudget>,
    /// Momentum at the end, kg m/s.
    pub momentum: Vec<f64>,
    /// Largest |ρ/ρ0 − 1| at the end.
    pub compression: f64,
    /// Largest speed of the fluid divided by the sound speed since this process began, and when.
    pub largest_mach: Mach,
    /// Particles taken out because they left the domain.
    pub lost_particles: u64,
    /// Loads on the solids over the whole run.
    pub solids: Vec<SolidLoad>,
    /// Snapshots written by this process.
    pub snapshots: u64,
    /// Time at which this process took over from a checkpoint, s.
    pub resumed_at: Option<f64>,
    /// Remarks about the scene and the run, as they were told while it ran.
    pub notes: Vec<String>,
    /// Hash of the final state ordered by id: equal digests mean equal bits.
    pub state_digest: String,
}

/// A Mach number at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mach {
    /// Speed divided by sound speed.
    pub number: f64,
    /// When, s.
    pub time: f64,
}

/// Particles by kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Particles {
    /// Fluid particles.
    pub fluid: u64,
    /// Wall particles.
    pub wall: u64,
}

/// Seconds by phase.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Phases {
    /// Migration, overlap zone, sorting and lists.
    pub rebuild: f64,
    /// Density passes.
    pub density: f64,
    /// Force passes.
    pub force: f64,
    /// Snapshots, tables, checkpoints.
    pub output: f64,
}

/// Energies at two times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Energies {
    /// When this process began.
    pub start: Energy,
    /// At the end.
    pub end: Energy,
}

/// Energies of the fluid, J (J/m in two dimensions).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy in gravity, zero at the origin.
    pub potential: f64,
    /// Elastic energy.
    pub elastic: f64,
}

/// Where energy went over the whole run, J (J/m in two dimensions).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergyBudget {
    /// What each term took, by the names of the columns of `energies.csv`.
    pub taken: BTreeMap<&'static str, f64>,
    /// Energy at the end and all that was taken, less the energy at the start: what no term explains.
    pub residual: f64,
    /// The largest residual of any row as a share of the energy that the fluid had or was given.
    pub largest_residual_share: f64,
    /// When that was, s.
    pub largest_residual_time: f64,
}

impl EnergyBudget {
    fn of((row, worst): &(EnergyRow, Worst)) -> Self {
        Self {
            taken: Sink::ALL.iter().zip(row.taken).map(|(sink, j)| (sink.column(), j)).collect(),
            residual: row.residual,
            largest_residual_share: worst.share,
            largest_residual_time: worst.time,
        }
    }
}

/// Puts the summary together from all ranks; all of them get the same. Collective.
pub fn summarize<const D: usize, S: Real + Pod>(
    comm: &dyn Communicator,
    simulation: &Simulation<'_, D, S>,
    finished: &Finished<D>,
    meta: Meta,
) -> Result<Summary, RunError> {
    let rank = simulation.rank();
    let counters = simulation.counters();
    let (fluid, solid) = (rank.fluid, rank.solid);
    let exposed = simulation.exposed();
    let mut counts = [
        fluid.owned() as u64,
        // Every rank knows all of those that move.
        solid.owned() as u64
            + if comm.rank() == 0 { simulation.bodies().elements() as u64 } else { 0 },
        counters.particle_updates,
        counters.pairs,
        rank.bytes() as u64,
        fluid.outer as u64,
        rank.pairs(),
        exposed.messages,
        exposed.bytes_sent,
    ];
    comm.sum_u64(&mut counts)?;
    let [fluid_count, wall_count, updates, pairs, bytes, outer, near, ..] =
        counts.map(|n| n as f64);

    let timings = simulation.timings();
    let seconds = [Phase::Rebuild, Phase::Density, Phase::Force].map(|p| timings.seconds(p));
    // A run without steps has no shares.
    let share = |part: f64| part / seconds.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let (waited, blocked) = (exposed.wait_seconds, simulation.collectives().seconds);
    let mut slowest = [
        finished.elapsed.as_secs_f64(),
        seconds[0],
        seconds[1],
        seconds[2],
        timings.seconds(Phase::Output),
        waited,
        share(waited),
        blocked,
        share(blocked),
    ];
    comm.max_f64(&mut slowest)?;
    let [wall_seconds, rebuild, density, force, output, ..] = slowest;
    let [exposed_seconds, exposed_share, collective_seconds, collective_share] =
        [slowest[5], slowest[6], slowest[7], slowest[8]];
    let evenness = simulation.evenness();

    let row = [fluid.local as u64, fluid.inner as u64, fluid.outer as u64];
    let rows = comm.all_gather(bytemuck::cast_slice(&row))?;
    let rows: Vec<[u64; 3]> =
        rows.iter().filter_map(|bytes| bytemuck::try_pod_read_unaligned(bytes).ok()).collect();

    // The threads of a process share one count.
    let once = !meta.one_process || comm.rank() == 0;
    let of_all = |mine: Option<f64>| -> Result<Option<f64>, RunError> {
        let mine = if once { mine } else { Some(0.0) };
        let all = comm.all_gather(&mine.unwrap_or(f64::NAN).to_ne_bytes())?;
        let numbers = all.iter().filter_map(|bytes| bytes.as_slice().try_into().ok());
        let sum: f64 = numbers.map(f64::from_ne_bytes).sum();
        Ok(sum.is_finite().then_some(sum))
    };
    let cpu_seconds = of_all(cpu_seconds())?;
    let core_seconds = of_all(finished.cpu_seconds)?;

    let loop_seconds = rebuild + density + force;
    let (first, last) = &finished.budgets;
    Ok(Summary {
        name: meta.name,
        version: env!("CARGO_PKG_VERSION"),
        dimension: D,
        precision: meta.precision,
        scheme: meta.scheme,
        simd: sph_kernels::simd_level(),
        ranks: comm.size(),
        communicator: meta.communicator,
        threads: simulation.threads(),
        particles: Particles { fluid: counts[0], wall: counts[1] },
        steps: finished.last.step,
        simulated_time: finished.last.time,
        time_step: finished.time_step,
        wall_seconds,
        cpu_seconds,
        core_seconds,
        phases: Phases { rebuild, density, force, output },
        particle_updates_per_second: updates / loop_seconds,
        pair_interactions: counts[3],
        pair_interactions_per_second: pairs / (density + force),
        neighbours_per_particle: near / fluid_count,
        steps_per_rebuild: counters.steps as f64 / counters.rebuilds as f64,
        stale_steps: counters.stale_steps,
        bytes_per_particle: bytes / (fluid_count + wall_count),
        overlapped: meta.overlapped,
        exposed_seconds,
        exposed_share,
        collective_seconds,
        collective_share,
        messages: counts[7],
        bytes_sent: counts[8],
        halo_redundancy: outer / fluid_count,
        local_inner_outer: rows.iter().map(|row| row.map(|count| count as usize)).collect(),
        imbalance: evenness.measured.unwrap_or(evenness.predicted),
        predicted_imbalance: evenness.predicted,
        partitions: evenness.partitions,
        energies: Energies { start: Energy::of(first), end: Energy::of(last) },
        energy_budget: finished.energy.as_ref().map(EnergyBudget::of),
        momentum: last.momentum.to_vec(),
        compression: last.compression,
        largest_mach: Mach {
            number: finished.fastest.0 / simulation.model().limits.sound_speed,
            time: finished.fastest.1,
        },
        lost_particles: finished.lost,
        solids: finished.loads.iter().map(|(name, load)| SolidLoad::of::<D>(name, load)).collect(),
        snapshots: finished.snapshots,
        resumed_at: finished.resumed_at,
        // The caller collects them.
        notes: Vec::new(),
        state_digest: finished.digest.to_string(),
    })
}

/// The load on a solid over a run (per metre of depth in two dimensions).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolidLoad {
    /// Name of the solid.
    pub name: String,
    /// Largest magnitude of the force, N.
    pub largest_force: f64,
    /// Time integral of the force, N s.
    pub impulse: Vec<f64>,
}

impl SolidLoad {
    fn of<const D: usize>(name: &str, load: &LoadTotal) -> Self {
        let impulse = (0..D).map(|k| load.impulse[k] + load.impulse[6 + k]).collect();
        Self { name: name.into(), largest_force: load.largest, impulse }
    }
}

impl Energy {
    fn of<const D: usize>(budget: &Budget<D>) -> Self {
        let Budget { kinetic, potential, elastic, .. } = *budget;
        Self { kinetic, potential, elastic }
    }
}
