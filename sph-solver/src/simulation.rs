//! A simulation: the particles of one rank and the loop over the steps.

use crate::bodies::{Bodies, Wrench};
use crate::energy::{Sink, Taken, open_books};
use crate::error::RunError;
use crate::lio::{Copies, Exchange, Extremes, lio_pass};
use crate::loads::{LoadScale, Loads, on_all_ranks};
use crate::model::{Model, OnLost};
use crate::passes::{DensityPass, ForcePass, kicked};
use crate::rank::costs::TOLERATED_IMBALANCE;
use crate::rank::{Gone, Rank, first_of_all};
use crate::records::Encoder;
use crate::scheme::Scheme;
use crate::space::PairScale;
use crate::state::State;
use crate::team::Team;
use crate::terms::{Acceleration, MOST};
use crate::timestep::Skin;
use crate::timings::{Counters, Phase, Timings};
use crate::walls::WallElements;
use bytemuck::Pod;
use sph_decomp::{Balancer, Collectives, Communicator, Evenness, Exposed, Load, Metered};
use sph_kernels::Real;

/// Where a run is between two steps, and what the next step needs besides the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Number of finished steps.
    pub step: u64,
    /// Time of the positions, s.
    pub time: f64,
    /// Step that led to the present positions, s; 0 at the start.
    pub dt: f64,
    /// Largest speed and acceleration of the last force pass, over all ranks.
    pub extremes: Extremes,
    /// Largest speed in any step before, squared, m²/s²: what shifts are shares of.
    pub fastest2: f64,
}

/// Fluid particles of this rank at a full step, with everything at the same time.
#[derive(Debug, Clone)]
pub struct FullStep<const D: usize> {
    /// Time, s.
    pub time: f64,
    /// Number of the step.
    pub step: u64,
    /// Global ids.
    pub id: Vec<u64>,
    /// Masses, kg.
    pub mass: Vec<f64>,
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Velocities, m/s.
    pub velocity: Vec<[f64; D]>,
    /// Densities, kg/m³.
    pub density: Vec<f64>,
}

/// A particle that was taken out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lost<const D: usize> {
    /// Global id.
    pub id: u64,
    /// Where it was, m.
    pub position: [f64; D],
    /// When, s.
    pub time: f64,
}

/// One rank of a run.
pub struct Simulation<'a, const D: usize, S: Real> {
    comm: Metered<&'a dyn Communicator>,
    team: Team,
    model: Model<D>,
    scheme: Scheme<D, S>,
    scale: PairScale<D>,
    rank: Rank<D, S>,
    clock: Clock,
    skin: Skin,
    /// Extremes of the last passes of this rank, not yet known to the others.
    pending: Extremes,
    /// Largest values of the last reduction over the ranks.
    reduced: Extremes,
    /// What this rank, and what any rank, asks of all of them; see [`Simulation::ask`].
    request: (f64, f64),
    lists_due: bool,
    just_rebuilt: bool,
    lost: Vec<Lost<D>>,
    counters: Counters,
    exposed: Exposed,
    balancer: Balancer,
    by_prediction: bool,
    /// Steps and exposed communication at the last rebuild.
    at_rebuild: (u64, Exposed),
    timings: Timings,
    /// How loads are counted, if somebody asks for them.
    load_scale: Option<LoadScale>,
    /// Loads of this rank's fluid in the last step.
    loads: Loads,
    /// Energy that terms took from the fluid of this rank in the last step, if somebody keeps books.
    energy: Option<Taken>,
    bodies: Bodies<D>,
}

impl<'a, const D: usize, S: Real + Pod> Simulation<'a, D, S> {
    /// Starts from the particles in `state` and the walls in `elements`, which may lie on any rank.
    /// `clock` is that of a checkpoint, or `None` for a new run.
    pub fn new(
        comm: &'a dyn Communicator,
        team: Team,
        model: Model<D>,
        scheme: Scheme<D, S>,
        mut state: State<D>,
        elements: WallElements<D>,
        clock: Option<Clock>,
    ) -> Result<Self, RunError> {
        let start = at_start(comm, &model, &state)?;
        let clock = match clock {
            // The velocities of a checkpoint are those of the last force pass.
            Some(clock) => {
                Clock { extremes: Extremes { velocity: start.velocity, ..clock.extremes }, ..clock }
            }
            None => Clock { step: 0, time: 0.0, dt: 0.0, extremes: start, fastest2: 0.0 },
        };
        if clock.step == 0 && state.pressure_gradient.is_empty() {
            // As at rest: the pressure gradient carries the weight.
            state.pressure_gradient = vec![model.gravity; state.len()];
        }
        let skin = Skin::new(model.skin);
        Ok(Self {
            comm: Metered::new(comm),
            team,
            scale: model.scale(),
            rank: Rank::new(
                state,
                if scheme.has_walls() { elements } else { WallElements::default() },
            ),
            scheme,
            clock,
            skin,
            pending: clock.extremes,
            reduced: clock.extremes,
            request: (0.0, 0.0),
            lists_due: true,
            just_rebuilt: false,
            lost: Vec::new(),
            counters: Counters::default(),
            exposed: Exposed::default(),
            balancer: Balancer::new(TOLERATED_IMBALANCE),
            by_prediction: false,
            at_rebuild: (0, Exposed::default()),
            timings: Timings::default(),
            load_scale: None,
            loads: Loads::NONE,
            energy: None,
            bodies: Bodies::default(),
            model,
        })
    }

    /// The same with solids that move, whose state is that at the start of the run or of the checkpoint
    /// that it goes on from.
    #[must_use]
    pub fn with_bodies(mut self, bodies: Bodies<D>) -> Self {
        if !bodies.is_empty() {
            self.load_scale.get_or_insert_with(|| LoadScale::of_model(&self.model));
        }
        self.bodies = bodies;
        self
    }

    /// The solids that move.
    pub fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }

    /// Whether the next step begins with new lists: the moment when a checkpoint can be taken,
    /// because whoever starts from the state then builds the same lists.
    pub fn lists_due(&self) -> bool {
        self.lists_due
    }

    /// The clock that goes with [`state`](Self::state). Collective.
    pub fn clock(&self) -> Result<Clock, RunError> {
        let mut maxima = self.pending.to_array();
        self.comm.max_f64(&mut maxima)?;
        let extremes = Extremes::from_array(maxima);
        self.stop_at_fault(extremes)?;
        Ok(Clock { extremes, ..self.clock })
    }

    /// A copy of the state of the particles of this rank between two steps: positions of the present
    /// time, velocities half a step behind it, densities of the time before.
    pub fn state(&self) -> State<D> {
        self.rank.state.clone()
    }

    /// Time of the present positions, s: the next step ends there.
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// The step that leads to the present positions, s.
    pub fn time_step(&self) -> f64 {
        self.clock.dt
    }

    /// Constants of the run.
    pub fn model(&self) -> &Model<D> {
        &self.model
    }

    /// Makes the next step begin with new lists, and with a look for particles outside the domain.
    pub fn renew_lists(&mut self) {
        self.lists_due = true;
    }

    /// Lets all ranks know a number with the reduction of the next step, which costs nothing; each
    /// then finds the largest in [`asked`](Self::asked), in the same step.
    pub fn ask(&mut self, number: f64) {
        self.request.0 = number;
    }

    /// The largest number that any rank had asked with before the last step; 0 when there was none.
    pub fn asked(&self) -> f64 {
        self.request.1
    }

    /// Largest speed in the last reduction over the ranks, m/s: one step old.
    pub fn largest_speed(&self) -> f64 {
        self.reduced.speed2.sqrt()
    }

    /// Number of finished steps.
    pub fn steps(&self) -> u64 {
        self.clock.step
    }

    /// Whether the last step began with a rebuild, which is when particles are taken out.
    pub fn just_rebuilt(&self) -> bool {
        self.just_rebuilt
    }

    /// Particles of this rank that were taken out since the last call.
    pub fn take_lost(&mut self) -> Vec<Lost<D>> {
        std::mem::take(&mut self.lost)
    }

    /// What was counted on this rank.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Communication that was not hidden on this rank.
    pub fn exposed(&self) -> Exposed {
        self.exposed
    }

    /// Blocking operations of this rank in steps and rebuilds, those of outputs left out.
    pub fn collectives(&self) -> Collectives {
        self.comm.collectives()
    }

    /// How evenly the ranks were loaded from the first rebuild to the last, and how often space was
    /// divided. The same on all ranks.
    pub fn evenness(&self) -> Evenness {
        self.balancer.evenness()
    }

    /// From now on particles are weighed by their lists alone, without measured seconds: the
    /// partitions then do not depend on clocks. Call it on all ranks.
    pub fn weigh_by_prediction(&mut self) {
        self.by_prediction = true;
    }

    /// Seconds by phase on this rank.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }

    /// The rank itself: layout and lists, for reports.
    pub fn rank(&self) -> &Rank<D, S> {
        &self.rank
    }

    /// From now on counts the loads on solids, with quanta of this size.
    pub fn count_loads(&mut self, scale: LoadScale) {
        self.load_scale = Some(scale);
    }

    /// Loads of the fluid of this rank on solids in the last step; nothing without
    /// [`count_loads`](Self::count_loads).
    pub fn loads(&self) -> &Loads {
        &self.loads
    }

    /// Energy that terms took from the fluid of this rank in the last step; nothing unless the scheme
    /// keeps [accounts](crate::scheme::Accounts).
    pub fn energy_taken(&self) -> Option<&Taken> {
        self.energy.as_ref()
    }

    /// What is summed over which neighbours.
    pub fn scheme(&self) -> &Scheme<D, S> {
        &self.scheme
    }

    /// Number of threads of this rank.
    pub fn threads(&self) -> usize {
        self.team.threads()
    }

    /// Completes the step that ends at the present time and moves on to the next positions. With
    /// `report`, also returns the state at the present time. Collective.
    pub fn step(&mut self, report: bool) -> Result<Option<FullStep<D>>, RunError> {
        self.just_rebuilt = self.lists_due;
        self.energy = open_books(&self.model, &self.scheme);
        if self.lists_due {
            self.rebuild()?;
        }
        let extremes = self.density_pass()?;
        self.stop_at_fault(extremes)?;
        let dt_before = self.clock.dt;
        let dt = self.choose_step(extremes)?;
        let staged = report.then(|| self.stage());
        self.force_pass(dt_before, dt)?;
        let full_step = staged.map(|staged| self.complete(staged, dt_before));
        self.move_bodies(dt_before, dt)?;
        self.counters.steps += 1;
        let fluid = self.rank.fluid.owned();
        self.counters.particle_updates += fluid as u64;
        self.counters.pairs += 2 * self.rank.pairs();
        self.clock.step += 1;
        self.clock.time += dt;
        self.clock.dt = dt;
        Ok(full_step)
    }

    fn rebuild(&mut self) -> Result<(), RunError> {
        let _timer = self.timings.measure(Phase::Rebuild);
        // A particle without a usable position is a fault, not one that has left the domain.
        self.clock()?;
        let gone = self.renew_rank()?;
        if self.counters.rebuilds == 0 && self.comm.size() > 1 {
            // Now there are lists, from which costs are better known than from nothing.
            self.renew_rank()?;
        }
        let time = self.clock.time;
        self.lost.extend(gone.iter().map(|one| Lost { id: one.id, position: one.position, time }));
        if let Some(taken) = &mut self.energy {
            gone.iter().for_each(|one| taken.add(Sink::Lost, [one.energy, 0.0]));
        }
        if self.model.on_lost == OnLost::Stop {
            let first = gone.iter().min_by_key(|one| one.id).map(|one| (one.id, one.position));
            if let Some((id, position)) = first_of_all(&self.comm, first.as_ref())? {
                let (lower, upper) = &self.model.domain;
                let (lower, upper) = (lower.to_vec(), upper.to_vec());
                let position = position.to_vec();
                return Err(RunError::Left { id, position, time, lower, upper });
            }
        }
        self.skin.renew();
        self.lists_due = false;
        self.counters.rebuilds += 1;
        Ok(())
    }

    /// Divides space anew if that is due, and brings the rank up to date. Returns the particles that
    /// have left the domain.
    fn renew_rank(&mut self) -> Result<Vec<Gone<D>>, RunError> {
        let review = self.balancer.review(&self.comm, self.load())?;
        let division = review.divide.then_some(review.rate);
        let encoder = self.encoder();
        let (comm, team, model) = (&self.comm, &self.team, &self.model);
        let gone = self.rank.rebuild(comm, team, model, &encoder, division, &self.bodies)?;
        self.rank.make_room(self.scheme.shifting.is_some());
        self.rank.find_slopes(&self.scheme, &self.scale);
        self.at_rebuild = (self.counters.steps, self.exposed);
        Ok(gone)
    }

    /// What this rank did since the last rebuild.
    fn load(&self) -> Load {
        // With a team the calling thread only waits for it, and the wall clock has to do.
        let sweeps = |exposed: &Exposed| match self.team.threads() {
            _ if self.by_prediction => 0.0,
            1 => exposed.thread_seconds,
            _ => exposed.work_seconds,
        };
        let (steps, exposed) = &self.at_rebuild;
        Load {
            predicted: self.rank.predicted_cost(),
            seconds: sweeps(&self.exposed) - sweeps(exposed),
            steps: self.counters.steps - steps,
        }
    }

    fn encoder(&self) -> Encoder<D, S> {
        Encoder::new(&self.scale, &self.scheme.kernel)
    }

    fn density_pass(&mut self) -> Result<Extremes, RunError> {
        let _timer = self.timings.measure(Phase::Density);
        let encoder = self.encoder();
        let mut maxima = [0.0; 10];
        maxima[..9].copy_from_slice(&self.pending.to_array());
        maxima[9] = self.request.0;
        let view = self.rank.passing();
        let pass = DensityPass {
            around: view.surroundings(&self.scale),
            scheme: &self.scheme,
            encoder,
            model: &self.model,
            dt: self.clock.dt,
        };
        let exchange = Exchange {
            comm: &self.comm,
            halo: view.density_halo,
            plan: view.plan,
            maxima: &mut maxima,
        };
        let (own, exposed) = lio_pass(
            &pass,
            &self.team,
            &view.parts,
            exchange,
            Copies { old: view.deviation, new: view.pressure },
            view.columns,
            view.density_rate,
        )?;
        self.exposed += exposed;
        self.book(own.effects.energy.as_deref());
        self.pending = Extremes { fault: own.extremes.fault, ..Extremes::NONE };
        let [extremes @ .., request] = maxima;
        self.request.1 = request;
        self.reduced = Extremes::from_array(extremes);
        self.clock.fastest2 = self.clock.fastest2.max(self.reduced.speed2);
        Ok(self.reduced)
    }

    fn force_pass(&mut self, dt_before: f64, dt: f64) -> Result<(), RunError> {
        let _timer = self.timings.measure(Phase::Force);
        let encoder = self.encoder();
        let view = self.rank.passing();
        let pass = ForcePass {
            around: view.surroundings(&self.scale),
            scheme: &self.scheme,
            encoder,
            model: &self.model,
            loads: self.load_scale,
            dt_before,
            dt,
            speed: self.clock.fastest2.sqrt(),
            bodies: &self.bodies,
        };
        let exchange =
            Exchange { comm: &self.comm, halo: view.force_halo, plan: view.plan, maxima: &mut [] };
        let (own, exposed) = lio_pass(
            &pass,
            &self.team,
            &view.parts,
            exchange,
            Copies { old: view.pressure, new: view.deviation },
            view.columns,
            view.force_rate,
        )?;
        self.exposed += exposed;
        self.pending = self.pending.max(own.extremes);
        self.book(own.effects.energy.as_deref());
        self.loads = own.effects.loads;
        Ok(())
    }

    /// Notes energy that terms took in a pass.
    fn book(&mut self, taken: Option<&Taken>) {
        if let (Some(all), Some(more)) = (&mut self.energy, taken) {
            all.join(more);
        }
    }

    /// Moves the bodies on, from the loads of the fluid of all ranks. Collective.
    fn move_bodies(&mut self, dt_before: f64, dt: f64) -> Result<(), RunError> {
        let Some(scale) = self.load_scale.filter(|_| !self.bodies.is_empty()) else {
            return Ok(());
        };
        let free: Vec<u16> = self.bodies.free().collect();
        let own = free.iter().map(|&solid| self.loads.of(solid));
        let all = if free.is_empty() { Vec::new() } else { on_all_ranks(&self.comm, own)? };
        let load = |solid: u16| {
            let of_solid = free.iter().zip(&all).find(|(other, _)| **other == solid);
            of_solid.map_or(Wrench::NONE, |(_, quanta)| Wrench::of(&scale.in_newtons(quanta)))
        };
        let time = self.clock.time;
        self.bodies.advance(time, [dt_before, dt], &self.model.gravity, load);
        let encoder = self.encoder();
        self.bodies.place(&mut self.rank.walls, &encoder);
        Ok(())
    }

    /// The next step, and whether it uses up the skin. `extremes` are those of the last force pass:
    /// one step old, so that their reduction could hide behind the density pass.
    fn choose_step(&mut self, extremes: Extremes) -> Result<f64, RunError> {
        let extremes = extremes.max(self.bodies.extremes());
        let acceleration = extremes.acceleration2.sqrt();
        let speeds = [extremes.speed2, self.clock.fastest2].map(f64::sqrt);
        let moves = match self.scheme.shifting {
            Some(_) => Extremes { speed2: (speeds[0] + MOST * speeds[1]).powi(2), ..extremes },
            None => extremes,
        };
        self.skin.moved(self.clock.dt, &moves);
        let dt = self.model.limits.step(extremes);
        let calm = self.model.limits.step(Extremes::NONE);
        if dt.is_nan() || dt <= SMALLEST_STEP * calm {
            return Err(RunError::StepCollapsed {
                step: self.clock.step,
                time: self.clock.time,
                dt,
            });
        }
        self.counters.stale_steps += u64::from(self.skin.exceeded());
        // The kick before the coming drift is not known yet; twice the last one bounds it but in
        // an impact, where a stale step is counted and harmless: the kernel's slope vanishes at R.
        let kick = acceleration * (self.clock.dt + dt);
        self.lists_due = self.skin.would_exceed(dt, &moves, kick);
        Ok(dt)
    }

    fn stage(&self) -> FullStep<D> {
        let n = self.rank.fluid.owned();
        let state = &self.rank.state;
        FullStep {
            time: self.clock.time,
            step: self.clock.step,
            id: state.id[..n].to_vec(),
            mass: state.mass[..n].to_vec(),
            position: state.position[..n].to_vec(),
            velocity: state.velocity[..n].to_vec(),
            density: state.density[..n].to_vec(),
        }
    }

    /// Brings staged velocities to the full step, with the arithmetic of the force pass itself.
    fn complete(&self, mut staged: FullStep<D>, dt_before: f64) -> FullStep<D> {
        for (v, Acceleration(a)) in staged.velocity.iter_mut().zip(&self.rank.force_rate) {
            *v = kicked(*v, 0.5 * dt_before, *a, self.model.gravity);
        }
        staged
    }

    /// Ends the run on all ranks with the same message when any particle of any rank is faulty.
    fn stop_at_fault(&self, extremes: Extremes) -> Result<(), RunError> {
        if extremes.fault == 0.0 {
            return Ok(());
        }
        let density0 = self.model.equation_of_state.density0();
        let first = self.rank.faulty(self.model.speed_limit(), density0);
        match first_of_all(&self.comm, first.as_ref())? {
            Some((id, position)) => Err(RunError::Diverged {
                id,
                position: position.to_vec(),
                step: self.clock.step,
                time: self.clock.time,
            }),
            None => Err(RunError::Overflow { step: self.clock.step, time: self.clock.time }),
        }
    }
}

/// A step this much shorter than the acoustic one means that the run has failed.
const SMALLEST_STEP: f64 = 1e-5;

fn at_start<const D: usize>(
    comm: &dyn Communicator,
    model: &Model<D>,
    state: &State<D>,
) -> Result<Extremes, RunError> {
    let square = |v: &[f64; D]| v.iter().map(|c| c * c).sum::<f64>();
    let of = |v: &[f64; D]| Extremes {
        speed2: square(v),
        velocity: Extremes::ways(v),
        ..Extremes::NONE
    };
    let own = state.velocity.iter().map(of).fold(Extremes::NONE, Extremes::max);
    let mut maxima = own.to_array();
    comm.max_f64(&mut maxima)?;
    let all = Extremes::from_array(maxima);
    Ok(Extremes { acceleration2: square(&model.gravity), ..all })
}
