//! The loop of a run on one rank: steps, outputs, checkpoints.

use super::checkpoints::{self, Kept, Progress};
use super::cpu_time::cpu_seconds;
use super::digest::Digest;
use super::energy_log::{EnergyLog, EnergyRow, Worst};
use super::files::Files;
use super::gather::gather_by_id;
use super::load_log::{LoadLog, LoadTotal};
use super::plan::RunPlan;
use super::samples::{self, Budget};
use super::schedule::Schedule;
use super::stop::StopReason;
use crate::bodies::Bodies;
use crate::energy::EnergyScale;
use crate::error::RunError;
use crate::loads::LoadScale;
use crate::model::Model;
use crate::scheme::Scheme;
use crate::simulation::{FullStep, Lost, Simulation};
use crate::state::State;
use crate::team::Team;
use crate::timings::Phase;
use crate::walls::WallElements;
use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_kernels::Real;
use std::time::{Duration, Instant};

/// How far a run has come, for whoever watches it.
#[derive(Debug, Clone, Copy)]
pub struct Status {
    /// Steps of the run.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// Time at which the run began or was resumed, s.
    pub start: f64,
    /// Time at which it ends, s.
    pub end: f64,
    /// Fluid particles times steps since the start, taking all ranks to have as many as this one.
    pub particle_updates: u64,
    /// Wall-clock time since the start.
    pub elapsed: Duration,
    /// Communication that was not hidden on this rank, s.
    pub exposed_seconds: f64,
}

/// What the loop leaves behind on one rank.
#[derive(Debug)]
pub struct Finished<const D: usize> {
    /// State at the end.
    pub last: FullStep<D>,
    /// Budget in the first report of this process and at the end.
    pub budgets: (Budget<D>, Budget<D>),
    /// Digest of the final state of all ranks.
    pub digest: Digest,
    /// Last time step, s.
    pub time_step: f64,
    /// Particles taken out, on all ranks, over the whole run.
    pub lost: u64,
    /// The energy budget over the whole run, if there is one: at the end, and where it was worst.
    pub energy: Option<(EnergyRow, Worst)>,
    /// Loads on the solids over the whole run, by name.
    pub loads: Vec<(String, LoadTotal)>,
    /// Snapshots written by this process.
    pub snapshots: u64,
    /// Time of the checkpoint that the run continued.
    pub resumed_at: Option<f64>,
    /// Wall-clock time of the loop.
    pub elapsed: Duration,
    /// CPU seconds of this process in the loop, where the system tells.
    pub cpu_seconds: Option<f64>,
    /// Largest speed of the fluid (m/s) and when it had it (s).
    pub fastest: (f64, f64),
}

/// What one rank begins with: its share of the initial particles, and all that move as one. A resumed run
/// drops the fluid for that of the checkpoint.
#[derive(Debug)]
pub struct Start<const D: usize> {
    /// Fluid.
    pub state: State<D>,
    /// Elements of walls at rest.
    pub elements: WallElements<D>,
    /// Solids that move.
    pub bodies: Bodies<D>,
}

/// Runs one rank to the end. Collective.
pub fn drive<'a, const D: usize, S: Real + Pod>(
    comm: &'a dyn Communicator,
    team: Team,
    model: Model<D>,
    scheme: Scheme<D, S>,
    Start { state, elements, mut bodies }: Start<D>,
    plan: &RunPlan<D>,
    watch: &(dyn Fn(Status) + Sync),
) -> Result<(Simulation<'a, D, S>, Finished<D>), RunError> {
    let start = Instant::now();
    let cpu_start = cpu_seconds();
    let solids = model.solids.len();
    let mut loads = LoadLog::new(solids, LoadScale::of_model(&model));
    let mut energy = plan.energy_budget.then(|| EnergyLog::new(EnergyScale::of_model(&model)));
    let (state, clock, progress) = if plan.resume {
        drop(state);
        let loaded = checkpoints::load(comm, plan)?;
        loads.restore(&loaded.loads);
        if !bodies.restore(&loaded.bodies) {
            return Err(RunError::OtherBodies { path: plan.out.clone() });
        }
        if let Some(log) = &mut energy
            && !log.restore(&loaded.energy, comm.rank() == 0)
            && comm.rank() == 0
        {
            plan.notes.add(format!(
                "the checkpoint has no energy budget: that of this run counts from t = {} s on",
                loaded.clock.time
            ));
        }
        (loaded.state, Some(loaded.clock), loaded.progress)
    } else {
        (state, None, Progress::start(plan))
    };
    let resumed_at = clock.map(|clock| clock.time);
    // Outputs of steps that the checkpoint has not seen yet are written again.
    let written_until = resumed_at.map(f64::next_down);
    if comm.rank() == 0 {
        clear(plan, resumed_at.is_some())?;
        plan.record.clone().write(&plan.out, resumed_at.is_some())?;
    }
    let moving: Vec<u16> = bodies.kinematics().iter().map(|(solid, _)| *solid).collect();
    let names = model
        .solids
        .iter()
        .zip(0..)
        .map(|(solid, number)| (solid.name.as_str(), moving.contains(&number)));
    let names: Vec<(&str, bool)> = names.collect();
    let mut files =
        if comm.rank() == 0 { Some(Files::open(plan, &names, written_until)?) } else { None };
    let mut out = Outputs {
        comm,
        plan,
        snapshots: progress.snapshots,
        samples: progress.samples,
        checkpoints: progress.checkpoints,
        lost: progress.lost,
        loads,
        energy,
        first_budget: None,
        kept: None,
        saved: None,
        fast: false,
        fastest: (0.0, 0.0),
        compressed: false,
        open: false,
    };
    let mut stopping = None;
    let mut simulation =
        Simulation::new(comm, team, model, scheme, state, elements, clock)?.with_bodies(bodies);
    if solids > 0 {
        simulation.count_loads(out.loads.scale());
    }
    let begin = simulation.time();
    if resumed_at.is_none() {
        out.walls(&simulation, files.as_mut())?;
    }
    loop {
        let time = simulation.time();
        if simulation.lists_due() {
            if out.checkpoints.due(time) || stopping.is_some() {
                out.checkpoint(&simulation)?;
            } else if plan.keeps_state {
                out.keep(&simulation)?;
            }
            if let Some(reason) = stopping {
                return Err(out.stopped(&simulation, reason));
            }
        }
        let last = time >= plan.end_time;
        if last {
            // So that nothing outside the domain is in the last report.
            simulation.renew_lists();
        }
        simulation.ask(StopReason::to_number(plan.stop.reason()));
        let time_step = simulation.time_step();
        let starts = out.energy.as_ref().is_some_and(EnergyLog::wants_start);
        let report = last || starts || out.snapshots.due(time) || out.samples.due(time);
        let full = simulation.step(report)?;
        if solids > 0 {
            out.loads.record(comm, simulation.loads(), time_step, simulation.time_step())?;
        }
        if let (Some(log), Some(taken)) = (&mut out.energy, simulation.energy_taken()) {
            log.record(taken);
        }
        out.lost(&mut simulation, files.as_mut())?;
        if let Some(full) = full {
            let (budget, energy) = out.report(&simulation, &full, last, files.as_mut())?;
            if last {
                let first = out.first_budget.unwrap_or(budget);
                if plan.checkpoints.is_some() {
                    out.save_kept(&simulation)?;
                }
                let solids = simulation.model().solids.iter().map(|solid| solid.name.clone());
                let loads = solids.zip(out.loads.totals(comm)?).collect();
                let finished = Finished {
                    digest: digest(comm, &full)?,
                    last: full,
                    budgets: (first, budget),
                    time_step,
                    lost: out.lost,
                    energy: energy.zip(out.energy.as_ref().map(EnergyLog::worst)),
                    loads,
                    snapshots: files.map_or(0, |files| files.snapshots()),
                    resumed_at,
                    elapsed: start.elapsed(),
                    cpu_seconds: cpu_seconds().zip(cpu_start).map(|(end, start)| end - start),
                    fastest: out.fastest,
                };
                return Ok((simulation, finished));
            }
        }
        out.notice_speed(&simulation);
        stopping = stopping.or(StopReason::from_number(simulation.asked()));
        if let Some(reason) = stopping
            && out.save_kept(&simulation)?
        {
            return Err(out.stopped(&simulation, reason));
        }
        watch(Status {
            step: simulation.steps(),
            time,
            start: begin,
            end: plan.end_time,
            particle_updates: simulation.counters().particle_updates * comm.size() as u64,
            elapsed: start.elapsed(),
            exposed_seconds: simulation.exposed().wait_seconds,
        });
    }
}

/// Takes away what an earlier run left in the folder and could be mistaken for a result of this one.
fn clear<const D: usize>(plan: &RunPlan<D>, resumes: bool) -> Result<(), RunError> {
    let folder = |source| RunError::Folder { path: plan.out.clone(), source };
    std::fs::create_dir_all(&plan.out).map_err(folder)?;
    match std::fs::remove_file(plan.out.join("summary.json")) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(folder(error)),
        _ => (),
    }
    if !resumes {
        sph_io::remove_checkpoints(&plan.out, ..)?;
    }
    Ok(())
}

struct Outputs<'a, const D: usize> {
    comm: &'a dyn Communicator,
    plan: &'a RunPlan<D>,
    snapshots: Schedule,
    samples: Schedule,
    checkpoints: Schedule,
    lost: u64,
    loads: LoadLog,
    energy: Option<EnergyLog>,
    first_budget: Option<Budget<D>>,
    /// State of the last rebuild, unless it is in a checkpoint.
    kept: Option<Kept<D>>,
    /// Step of the last checkpoint of this process.
    saved: Option<u64>,
    /// Whether the flow has been called too fast.
    fast: bool,
    /// Largest speed (m/s) and its time (s).
    fastest: (f64, f64),
    /// Whether the fluid has been called too compressed.
    compressed: bool,
    /// Whether it has been said that the energy budget does not close.
    open: bool,
}

/// Flows faster than this fraction of the sound speed are called too fast: the density then varies
/// by more than 2 %.
const FASTEST_MACH: f64 = 0.15;

/// A density that differs by more than this fraction from that at rest is called too compressed: what
/// is simulated is hardly a liquid any more.
const LARGEST_COMPRESSION: f64 = 0.03;

/// A larger share of the energy than this that no term explains casts doubt on all results.
const LARGEST_RESIDUAL: f64 = 0.03;

impl<const D: usize> Outputs<'_, D> {
    fn walls<S: Real + Pod>(
        &self,
        simulation: &Simulation<'_, D, S>,
        files: Option<&mut Files>,
    ) -> Result<(), RunError> {
        if self.plan.snapshots.is_none() {
            return Ok(());
        }
        let mut columns = simulation.rank().elements.clone().into_columns();
        gather_by_id(self.comm, &mut columns, |columns| columns.0.clone())?;
        let thin = |number| simulation.model().thin(number);
        let walls = WallElements::from_columns(columns).shown(thin);
        let density0 = simulation.model().equation_of_state.density0();
        match files {
            Some(files) if !walls.is_empty() => files.walls(&walls, density0),
            _ => Ok(()),
        }
    }

    fn lost<S: Real + Pod>(
        &mut self,
        simulation: &mut Simulation<'_, D, S>,
        files: Option<&mut Files>,
    ) -> Result<(), RunError> {
        // Particles are taken out in rebuilds only, on all ranks in the same step.
        if !simulation.just_rebuilt() {
            return Ok(());
        }
        let lost = simulation.take_lost();
        let mut count = [lost.len() as u64];
        self.comm.sum_u64(&mut count)?;
        self.lost += count[0];
        if count[0] == 0 {
            return Ok(());
        }
        let mut columns = (
            lost.iter().map(|one| one.id).collect::<Vec<_>>(),
            lost.iter().map(|one| one.position).collect::<Vec<_>>(),
            lost.iter().map(|one| one.time).collect::<Vec<_>>(),
        );
        gather_by_id(self.comm, &mut columns, |columns| columns.0.clone())?;
        let Some(files) = files else { return Ok(()) };
        let (id, position, time) = columns;
        let all = id.iter().zip(position).zip(time);
        let all = all.map(|((&id, position), time)| Lost { id, position, time });
        files.lost(&all.collect::<Vec<_>>())
    }

    fn checkpoint<S: Real + Pod>(
        &mut self,
        simulation: &Simulation<'_, D, S>,
    ) -> Result<(), RunError> {
        let _timer = simulation.timings().measure(Phase::Output);
        // Also makes sure that no rank has met a fault: a bad state never becomes a checkpoint.
        let clock = simulation.clock()?;
        self.checkpoints.done(clock.time);
        let kept = Kept {
            fluid: simulation.state(),
            clock,
            progress: self.progress(),
            loads: self.loads.save(self.comm)?,
            bodies: simulation.bodies().save(),
            energy: self.save_energy()?,
        };
        checkpoints::save(self.comm, self.plan, kept)?;
        self.saved = Some(clock.step);
        self.kept = None;
        Ok(())
    }

    fn save_energy(&self) -> Result<Vec<f64>, RunError> {
        self.energy.as_ref().map_or_else(|| Ok(Vec::new()), |log| log.save(self.comm))
    }

    fn progress(&self) -> Progress {
        Progress {
            snapshots: self.snapshots,
            samples: self.samples,
            checkpoints: self.checkpoints,
            lost: self.lost,
        }
    }

    /// Keeps a copy of the present state, from which new lists are about to be built.
    fn keep<S: Real + Pod>(&mut self, simulation: &Simulation<'_, D, S>) -> Result<(), RunError> {
        let _timer = simulation.timings().measure(Phase::Output);
        let clock = simulation.clock()?;
        let mut fluid = self.kept.take().map_or_else(State::default, |kept| kept.fluid);
        fluid.clone_from(&simulation.rank().state);
        let loads = self.loads.save(self.comm)?;
        let (bodies, energy) = (simulation.bodies().save(), self.save_energy()?);
        self.kept = Some(Kept { fluid, clock, progress: self.progress(), loads, bodies, energy });
        Ok(())
    }

    /// Makes sure that a checkpoint of the last rebuild is there. Without a kept state there may be
    /// none, which is what this tells.
    fn save_kept<S: Real + Pod>(
        &mut self,
        simulation: &Simulation<'_, D, S>,
    ) -> Result<bool, RunError> {
        let _timer = simulation.timings().measure(Phase::Output);
        let Some(kept) = self.kept.take() else {
            return Ok(self.plan.keeps_state && self.saved.is_some());
        };
        // No rank has met a fault since, or the run would have ended.
        let step = kept.clock.step;
        checkpoints::save(self.comm, self.plan, kept)?;
        self.saved = Some(step);
        Ok(true)
    }

    /// What a run that was asked to end tells.
    fn stopped<S: Real + Pod>(
        &self,
        simulation: &Simulation<'_, D, S>,
        reason: StopReason,
    ) -> RunError {
        let (step, time) = (simulation.steps(), simulation.time());
        let checkpoint = checkpoints::path(self.plan, self.saved.unwrap_or(step));
        RunError::Stopped { reason, step, time, checkpoint }
    }

    /// Says it, once, when the flow is faster than the sound speed allows for.
    fn notice_speed<S: Real + Pod>(&mut self, simulation: &Simulation<'_, D, S>) {
        let speed = simulation.largest_speed();
        let sound_speed = simulation.model().limits.sound_speed;
        if speed > self.fastest.0 {
            self.fastest = (speed, simulation.time());
        }
        if self.comm.rank() != 0 || self.fast || speed <= FASTEST_MACH * sound_speed {
            return;
        }
        self.fast = true;
        self.plan.notes.add(format!(
            "at t = {:.4} s the flow has reached {speed:.3} m/s, {:.2} of the sound speed of \
             {sound_speed:.3} m/s: beyond {FASTEST_MACH} it is visibly compressible. Set \
             numerics.sound_speed to about {:.3}",
            simulation.time(),
            speed / sound_speed,
            10.0 * speed,
        ));
    }

    /// Says it, once, when the fluid is compressed beyond what a liquid would be.
    fn notice_compression(&mut self, model: &Model<D>, time: f64, budget: &Budget<D>) {
        let compression = budget.compression;
        if self.comm.rank() != 0 || self.compressed || compression <= LARGEST_COMPRESSION {
            return;
        }
        self.compressed = true;
        self.plan.notes.add(format!(
            "at t = {time:.4} s the density differs from that at rest by {:.1} % somewhere: beyond \
             {:.0} % the fluid is no liquid any more. A larger numerics.sound_speed than {:.3} m/s \
             makes it stiffer",
            100.0 * compression,
            100.0 * LARGEST_COMPRESSION,
            model.limits.sound_speed,
        ));
    }

    /// The row of the energy budget; says, once, when it does not close. Collective.
    fn energy_row(&mut self, time: f64, budget: &Budget<D>) -> Result<Option<EnergyRow>, RunError> {
        let Some(log) = &mut self.energy else { return Ok(None) };
        let row = log.row(self.comm, time, budget)?;
        if self.comm.rank() == 0 && !self.open && row.share.abs() > LARGEST_RESIDUAL {
            self.open = true;
            let way = if row.share > 0.0 { "more" } else { "less" };
            self.plan.notes.add(format!(
                "at t = {time:.4} s the fluid has {:.1} % {way} energy than it had or was given and no term \
                 explains: beyond {:.0} % do not believe the results. Try a smaller \
                 numerics.cfl or spacing",
                100.0 * row.share.abs(),
                100.0 * LARGEST_RESIDUAL,
            ));
        }
        Ok(Some(row))
    }

    fn report<S: Real + Pod>(
        &mut self,
        simulation: &Simulation<'_, D, S>,
        full: &FullStep<D>,
        last: bool,
        mut files: Option<&mut Files>,
    ) -> Result<(Budget<D>, Option<EnergyRow>), RunError> {
        let _timer = simulation.timings().measure(Phase::Output);
        // A fault in this very step is not known to the other ranks yet.
        simulation.clock()?;
        let model = simulation.model();
        let budget = samples::budget(self.comm, model, full)?;
        self.notice_compression(model, full.time, &budget);
        self.first_budget.get_or_insert(budget);
        let energy = self.energy_row(full.time, &budget)?;
        if last || self.samples.due(full.time) {
            let kernel = &simulation.scheme().kernel;
            let read = |(_, probe)| samples::read(self.comm, model, kernel, full, probe);
            let probes = self.plan.probes.iter().map(|(name, probe)| (name, probe));
            let readings = probes.map(read).collect::<Result<Vec<_>, _>>()?;
            let reference = self.plan.reference.as_ref();
            let errors = reference.map(|known| known.errors(self.comm, model, full)).transpose()?;
            let loads = self.loads.rows(self.comm)?;
            if let Some(files) = files.as_deref_mut() {
                files.samples(full.time, &budget, energy.as_ref(), &readings)?;
                files.loads::<D>(full.time, &loads, &simulation.bodies().kinematics())?;
                if let Some(errors) = errors {
                    files.errors(full.time, &errors)?;
                }
            }
            self.samples.done(full.time);
        }
        if self.plan.snapshots.is_some() && (last || self.snapshots.due(full.time)) {
            let mut columns = (
                full.id.clone(),
                full.position.clone(),
                full.velocity.clone(),
                full.density.clone(),
            );
            gather_by_id(self.comm, &mut columns, |columns| columns.0.clone())?;
            if let Some(files) = files {
                let (id, position, velocity, density) = columns;
                let all = FullStep { id, position, velocity, density, mass: vec![], ..*full };
                let moving = simulation.bodies().in_full_step().shown(|number| model.thin(number));
                files.snapshot(model, &all, &moving)?;
            }
            self.snapshots.done(full.time);
        }
        Ok((budget, energy))
    }
}

/// Digest of the fluid of all ranks.
fn digest<const D: usize>(comm: &dyn Communicator, full: &FullStep<D>) -> Result<Digest, RunError> {
    let mut digest = Digest::default();
    for (i, &id) in full.id.iter().enumerate() {
        let words = full.position[i].into_iter().chain(full.velocity[i]);
        digest.add(id, words.chain([full.density[i]]));
    }
    let all = comm.all_gather(&digest.to_bytes())?;
    let parts = all.iter().filter_map(|bytes| bytes.as_slice().try_into().ok());
    Ok(parts.map(Digest::from_bytes).fold(Digest::default(), Digest::merge))
}
