//! Checkpoints of a run: state in, state out.

use super::gather::gather_by_id;
use super::plan::RunPlan;
use crate::error::RunError;
use crate::lio::Extremes;
use crate::simulation::Clock;
use crate::state::State;
use sph_decomp::Communicator;
use sph_io::{
    Attributes, Checkpoint, checkpoint_name, latest_checkpoint, prune_checkpoints, read_checkpoint,
    write_checkpoint,
};

/// What a checkpoint holds besides particles and clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Number of the next snapshot.
    pub next_snapshot: u64,
    /// Number of the next row of the tables.
    pub next_sample: u64,
    /// Number of the next checkpoint.
    pub next_checkpoint: u64,
    /// Particles taken out so far.
    pub lost: u64,
}

impl Progress {
    /// Of a new run. The start itself needs no checkpoint.
    pub const START: Self = Self { next_snapshot: 0, next_sample: 0, next_checkpoint: 1, lost: 0 };
}

/// Whole checkpoints that are kept; older ones are removed.
const KEPT: usize = 2;

/// Writes a checkpoint of all ranks. Collective.
pub fn save<const D: usize>(
    comm: &dyn Communicator,
    plan: &RunPlan<D>,
    state: State<D>,
    clock: Clock,
    progress: Progress,
    loads: Vec<f64>,
) -> Result<(), RunError> {
    let mut columns = state.into_columns();
    gather_by_id(comm, &mut columns, |columns| columns.0.clone())?;
    if comm.rank() != 0 {
        return Ok(());
    }
    let state = State::from_columns(columns);
    let checkpoint = Checkpoint::new(clock.time, clock.step, &state.id, &state.position)
        .with("velocity", &state.velocity)
        .with("pressure_gradient", &state.pressure_gradient)
        .with("density", &state.density)
        .with("mass", &state.mass)
        .with_attribute("dt", clock.dt)
        .with_attribute("largest_speed_squared", clock.extremes.speed2)
        .with_attribute("largest_acceleration_squared", clock.extremes.acceleration2)
        .with_attribute("next_snapshot", progress.next_snapshot)
        .with_attribute("next_sample", progress.next_sample)
        .with_attribute("next_checkpoint", progress.next_checkpoint)
        .with_attribute("lost_particles", progress.lost)
        .with_attribute("loads", loads)
        .with_attribute("fingerprint", plan.fingerprint.as_str())
        .with_attribute("scene", plan.scene_text.as_str());
    write_checkpoint(plan.out.join(checkpoint_name(clock.step)), &checkpoint)?;
    prune_checkpoints(&plan.out, KEPT)?;
    Ok(())
}

/// What a run goes on from.
#[derive(Debug)]
pub struct Loaded<const D: usize> {
    /// Particles of this rank.
    pub state: State<D>,
    /// Clock.
    pub clock: Clock,
    /// Progress of the outputs.
    pub progress: Progress,
    /// Loads on solids, as [`LoadLog::save`](super::load_log::LoadLog::save) gave them.
    pub loads: Vec<f64>,
}

/// Particles of this rank, clock and progress from the latest whole checkpoint. The number of ranks
/// may differ from that of the run that wrote it. Collective.
pub fn load<const D: usize>(
    comm: &dyn Communicator,
    plan: &RunPlan<D>,
) -> Result<Loaded<D>, RunError> {
    let mine = load_here(comm, plan).and_then(|loaded| {
        let (time, end) = (loaded.clock.time, plan.end_time);
        if time < end { Ok(loaded) } else { Err(RunError::NothingLeft { time, end }) }
    });
    // Each rank has looked for itself, perhaps on another machine: only agreement counts.
    let found = match &mine {
        Ok(loaded) => format!("step {}", loaded.clock.step),
        Err(RunError::NothingToResume { .. }) => "nothing".into(),
        Err(RunError::OtherScene { .. }) => "another scene".into(),
        Err(_) => "an error".into(),
    };
    let all = comm.all_gather(found.as_bytes())?;
    // An error that only this rank has met is worth more than the news that ranks differ.
    let agreed = all.iter().all(|other| other == found.as_bytes());
    let own_error = mine.as_ref().is_err_and(|error| !error.is_on_all_ranks());
    if !agreed && !own_error {
        return Err(RunError::DifferentCheckpoints { path: plan.out.clone() });
    }
    mine
}

fn load_here<const D: usize>(
    comm: &dyn Communicator,
    plan: &RunPlan<D>,
) -> Result<Loaded<D>, RunError> {
    let none = || RunError::NothingToResume { path: plan.out.clone() };
    if !plan.out.is_dir() {
        return Err(none());
    }
    let latest = latest_checkpoint(&plan.out)?.ok_or_else(none)?;
    let file = read_checkpoint::<D>(&latest.path)?;
    let attributes = &file.attributes;
    if attributes.text("fingerprint")? != plan.fingerprint {
        return Err(RunError::OtherScene { path: latest.path });
    }
    let clock = Clock {
        step: file.step,
        time: file.time,
        dt: attributes.f64("dt")?,
        extremes: Extremes {
            speed2: attributes.f64("largest_speed_squared")?,
            acceleration2: attributes.f64("largest_acceleration_squared")?,
            ..Extremes::NONE
        },
    };
    let count = |name: &str, attributes: &Attributes| attributes.u64(name);
    let progress = Progress {
        next_snapshot: count("next_snapshot", attributes)?,
        next_sample: count("next_sample", attributes)?,
        next_checkpoint: count("next_checkpoint", attributes)?,
        lost: count("lost_particles", attributes)?,
    };
    let share = share(comm, file.len());
    let state = State {
        id: file.ids[share.clone()].to_vec(),
        mass: file.column::<f64>("mass")?[share.clone()].to_vec(),
        density: file.column::<f64>("density")?[share.clone()].to_vec(),
        position: file.positions[share.clone()].to_vec(),
        velocity: file.column::<[f64; D]>("velocity")?[share.clone()].to_vec(),
        pressure_gradient: file.column::<[f64; D]>("pressure_gradient")?[share].to_vec(),
    };
    let loads = attributes.f64_array("loads")?.to_vec();
    Ok(Loaded { state, clock, progress, loads })
}

/// The part of `n` particles that a rank begins with: where they belong is found out later.
pub fn share(comm: &dyn Communicator, n: usize) -> std::ops::Range<usize> {
    let (rank, size) = (comm.rank(), comm.size());
    rank * n / size..(rank + 1) * n / size
}
