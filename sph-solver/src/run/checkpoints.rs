//! Checkpoints of a run: state in, state out.

use super::gather::gather_by_id;
use super::identity::Values;
use super::plan::RunPlan;
use super::schedule::Schedule;
use crate::error::RunError;
use crate::lio::Extremes;
use crate::simulation::Clock;
use crate::state::State;
use sph_decomp::Communicator;
use sph_io::{
    Attributes, Checkpoint, CheckpointFile, checkpoint_name, latest_checkpoint, prune_checkpoints,
    write_checkpoint,
};
use std::path::PathBuf;

/// What a checkpoint holds besides particles and clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// When the next snapshot is due.
    pub snapshots: Schedule,
    /// When the next row of the tables is due.
    pub samples: Schedule,
    /// When the next checkpoint is due.
    pub checkpoints: Schedule,
    /// Particles taken out so far.
    pub lost: u64,
}

impl Progress {
    /// Of a new run. The start itself needs no checkpoint.
    pub fn start<const D: usize>(plan: &RunPlan<D>) -> Self {
        Self {
            snapshots: Schedule::new(plan.snapshots),
            samples: Schedule::new(plan.samples),
            checkpoints: Schedule::new(plan.checkpoints).from(1),
            lost: 0,
        }
    }
}

/// The state in which the present lists were built. Whoever starts from it builds the same lists, and
/// so gets the same bits; from any later state only once new lists are due.
#[derive(Debug)]
pub struct Kept<const D: usize> {
    /// The fluid of this rank. Walls at rest need no copy.
    pub fluid: State<D>,
    /// The clock then.
    pub clock: Clock,
    /// What had been written then.
    pub progress: Progress,
    /// Loads on solids, as [`LoadLog::save`](super::load_log::LoadLog::save) gave them.
    pub loads: Vec<f64>,
    /// Solids that move, as [`Bodies::save`](crate::bodies::Bodies::save) gave them.
    pub bodies: Vec<f64>,
    /// The energy budget, as `EnergyLog::save` gave it; nothing
    /// without one.
    pub energy: Vec<f64>,
}

/// Whole checkpoints that are kept; older ones are removed.
const KEPT: usize = 2;

/// Where the checkpoint of a step lies.
pub fn path<const D: usize>(plan: &RunPlan<D>, step: u64) -> PathBuf {
    plan.out.join(checkpoint_name(step))
}

/// Writes a checkpoint of all ranks. Collective.
pub fn save<const D: usize>(
    comm: &dyn Communicator,
    plan: &RunPlan<D>,
    kept: Kept<D>,
) -> Result<(), RunError> {
    let Kept { fluid, clock, progress, loads, bodies, energy } = kept;
    let mut columns = fluid.into_columns();
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
        .with_attribute("largest_speed_squared_so_far", clock.fastest2)
        .with_attribute("largest_acceleration_squared", clock.extremes.acceleration2)
        .with_attribute("next_snapshot", progress.snapshots.next())
        .with_attribute("snapshot_interval", progress.snapshots.interval())
        .with_attribute("next_sample", progress.samples.next())
        .with_attribute("sample_interval", progress.samples.interval())
        .with_attribute("next_checkpoint", progress.checkpoints.next())
        .with_attribute("checkpoint_interval", progress.checkpoints.interval())
        .with_attribute("lost_particles", progress.lost)
        .with_attribute("loads", loads)
        .with_attribute("bodies", bodies)
        .with_attribute("energy_budget", energy)
        .with_attribute("identity", plan.identity.particles.to_text())
        .with_attribute("settings", plan.identity.settings.to_text())
        .with_attribute("simd", sph_kernels::simd_level())
        .with_attribute("scene", plan.scene_text.as_str());
    write_checkpoint(path(plan, clock.step), &checkpoint)?;
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
    /// Solids that move, as [`Bodies::save`](crate::bodies::Bodies::save) gave them.
    pub bodies: Vec<f64>,
    /// The energy budget, as `EnergyLog::save` gave it.
    pub energy: Vec<f64>,
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
    let file = CheckpointFile::open(&latest.path)?;
    let differences = plan
        .identity
        .particles
        .changes_from(&Values::from_text(file.info().attributes.text("identity")?));
    if !differences.is_empty() {
        return Err(RunError::OtherScene { path: latest.path, differences });
    }
    // Only the rows of this rank.
    let share = share(comm, file.info().particles as usize);
    let file = file.read_rows::<D>(share.start as u64..share.end as u64)?;
    let attributes = &file.attributes;
    let clock = Clock {
        step: file.step,
        time: file.time,
        dt: attributes.f64("dt")?,
        extremes: Extremes {
            speed2: attributes.f64("largest_speed_squared")?,
            acceleration2: attributes.f64("largest_acceleration_squared")?,
            ..Extremes::NONE
        },
        fastest2: attributes.f64("largest_speed_squared_so_far")?,
    };
    let schedule = |interval: Option<f64>, output: &str| -> Result<Schedule, RunError> {
        let schedule = Schedule::new(interval);
        let before = attributes.f64(&format!("{output}_interval"))?;
        Ok(if before == schedule.interval() {
            schedule.from(attributes.u64(&format!("next_{output}"))?)
        } else {
            schedule.from_time(file.time)
        })
    };
    let progress = Progress {
        snapshots: schedule(plan.snapshots, "snapshot")?,
        samples: schedule(plan.samples, "sample")?,
        checkpoints: schedule(plan.checkpoints, "checkpoint")?,
        lost: attributes.u64("lost_particles")?,
    };
    if comm.rank() == 0 {
        note_changes(plan, file.time, attributes)?;
    }
    let state = State {
        id: file.ids.to_vec(),
        mass: file.column::<f64>("mass")?.to_vec(),
        density: file.column::<f64>("density")?.to_vec(),
        position: file.positions.to_vec(),
        velocity: file.column::<[f64; D]>("velocity")?.to_vec(),
        pressure_gradient: file.column::<[f64; D]>("pressure_gradient")?.to_vec(),
    };
    let loads = attributes.f64_array("loads")?.to_vec();
    let bodies = attributes.f64_array("bodies")?.to_vec();
    let energy = attributes.f64_array("energy_budget")?.to_vec();
    Ok(Loaded { state, clock, progress, loads, bodies, energy })
}

/// Notes what is not as it was when the checkpoint was written.
fn note_changes<const D: usize>(
    plan: &RunPlan<D>,
    time: f64,
    attributes: &Attributes,
) -> Result<(), RunError> {
    let before = Values::from_text(attributes.text("settings")?);
    let changes = plan.identity.settings.changes_from(&before);
    if !changes.is_empty() {
        plan.notes.add(format!("resumed at t = {time} s with changes: {}", changes.join("; ")));
    }
    let (before, now) = (attributes.text("simd")?, sph_kernels::simd_level());
    // Without fused multiply-adds products are rounded twice; the width of vectors does not matter.
    if before != now && [before, now].contains(&"portable") {
        plan.notes.add(format!(
            "resumed at t = {time} s on a machine with {now} arithmetic, the checkpoint was written \
             with {before}: the last bits of the results may differ from those of a run on one kind \
             of machine"
        ));
    }
    Ok(())
}

/// The part of `n` particles that a rank begins with: where they belong is found out later.
pub fn share(comm: &dyn Communicator, n: usize) -> std::ops::Range<usize> {
    let (rank, size) = (comm.rank(), comm.size());
    rank * n / size..(rank + 1) * n / size
}
