//! The LIO pass: Algorithm 1 of Oger, Guibert, de Leffe & Piccinali, "Parallelization of a 3-D SPH
//! code for massive HPC simulations", the one function through which every sweep of every run goes.
//!
//! | step of Algorithm 1 | here |
//! |---|---|
//! | 1 post the receptions of the outer particles' new state | [`Halo::exchange`], before its first closure |
//! | 2 fluxes of inner particles | [`Pass::flux`] in the first closure |
//! | 3 update of inner particles | [`Pass::update`] in the first closure |
//! | 4 send the new state of inner particles | [`HaloPlan::pack`], then the exchange posts the sends |
//! | 5 fluxes of local particles | [`Pass::flux`] in the second closure, polling between pieces |
//! | 6 update of local particles | [`Pass::update`] in the second closure |
//! | 7 wait for the outer state | end of [`Halo::exchange`], then [`HaloPlan::unpack`] |
//!
//! Local particles still read the old state of inner ones in step 5, so what neighbours read is
//! kept twice: a pass reads the `old` records and writes the `new` ones. What only the particle
//! itself reads (its double-precision state) needs no second copy, which is also why a block may
//! be updated as soon as its own fluxes are known, while its rates are in cache.

use crate::block::{Block, FluidColumns};
use crate::energy::Taken;
use crate::loads::Loads;
use crate::records::Record;
use crate::team::Team;
use bytemuck::Pod;
use sph_decomp::{CommError, Communicator, Exposed, Halo, HaloPlan, Parts};
use sph_kernels::Real;
use sph_neighbors::Clusters;

/// Pieces of the local particles between which messages are polled.
const POLLS: usize = 16;

/// What a pass computes and how the result enters the state.
pub trait Pass<const D: usize, S: Real>: Sync {
    /// Result of the flux loop per target.
    type Rate: Copy + Send + Sync;
    /// What a neighbouring rank needs to know of an updated particle.
    type Message: Pod + Send + Sync;

    /// How the targets are divided into clusters.
    fn clusters(&self) -> &Clusters;

    /// Fluxes of the targets of a block from the old records, into its rates. Returns what goes with
    /// them.
    fn flux(&self, old: &[Record<S>], block: &mut Block<'_, D, S, Self::Rate>) -> Effects;

    /// New state of a block from its rates. `old` is indexed by particle like in `flux`.
    fn update(&self, old: &[Record<S>], block: &mut Block<'_, D, S, Self::Rate>) -> Extremes;

    /// Message about an inner particle after its update.
    fn message(&self, new: &Record<S>, density: f64) -> Self::Message;

    /// Enters the message about an outer particle into its records.
    fn receive(&self, message: &Self::Message, old: &mut Record<S>, new: &mut Record<S>);
}

/// Largest values over the particles of a pass: what the time step and the watch for faults need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Largest |v|², m²/s².
    pub speed2: f64,
    /// Largest |dv/dt|², m²/s⁴.
    pub acceleration2: f64,
    /// 1 when a particle has left the range of usable numbers, else 0.
    pub fault: f64,
    /// Largest velocity along each axis and against it, m/s; 0 at least, because walls rest.
    pub velocity: [[f64; 2]; 3],
}

impl Extremes {
    /// Of no particle.
    pub const NONE: Self =
        Self { speed2: 0.0, acceleration2: 0.0, fault: 0.0, velocity: [[0.0; 2]; 3] };

    /// Of both sets of particles.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            speed2: self.speed2.max(other.speed2),
            acceleration2: self.acceleration2.max(other.acceleration2),
            fault: self.fault.max(other.fault),
            velocity: std::array::from_fn(|axis| {
                std::array::from_fn(|way| self.velocity[axis][way].max(other.velocity[axis][way]))
            }),
        }
    }

    /// [`velocity`](Self::velocity) of one particle.
    #[inline]
    pub fn ways<const D: usize>(velocity: &[f64; D]) -> [[f64; 2]; 3] {
        std::array::from_fn(|axis| match velocity.get(axis) {
            Some(&v) => [v.max(0.0), (-v).max(0.0)],
            None => [0.0; 2],
        })
    }

    /// As numbers for an all-reduce by maximum.
    pub fn to_array(self) -> [f64; 9] {
        let Self { speed2, acceleration2, fault, velocity: [x, y, z] } = self;
        [speed2, acceleration2, fault, x[0], x[1], y[0], y[1], z[0], z[1]]
    }

    /// Back from [`to_array`](Self::to_array).
    pub fn from_array(numbers: [f64; 9]) -> Self {
        let [speed2, acceleration2, fault, a, b, c, d, e, f] = numbers;
        Self { speed2, acceleration2, fault, velocity: [[a, b], [c, d], [e, f]] }
    }
}

/// What a pass leaves behind besides the new state of the particles.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Largest values over the particles.
    pub extremes: Extremes,
    /// What goes with the fluxes.
    pub effects: Effects,
}

impl Outcome {
    /// Of no particle.
    pub const NONE: Self = Self { extremes: Extremes::NONE, effects: Effects::NONE };

    /// Of both sets of particles.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self {
            extremes: self.extremes.max(other.extremes),
            effects: self.effects.join(other.effects),
        }
    }
}

/// What fluxes do besides changing the fluid, and what it costs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Effects {
    /// Loads on solids.
    pub loads: Loads,
    /// Energy that terms took, if somebody keeps books.
    pub energy: Option<Box<Taken>>,
}

impl Effects {
    /// Of no particle.
    pub const NONE: Self = Self { loads: Loads::NONE, energy: None };

    /// Of both sets of particles.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let energy = match (self.energy, other.energy) {
            (Some(mut all), Some(more)) => {
                all.join(&more);
                Some(all)
            }
            (one, None) | (None, one) => one,
        };
        Self { loads: self.loads.plus(other.loads), energy }
    }
}

/// Who takes part in a pass and over which connection.
pub struct Exchange<'a, M: Pod> {
    /// Ranks.
    pub comm: &'a dyn Communicator,
    /// Buffers for messages of this kind.
    pub halo: &'a mut Halo<M>,
    /// Who sends which particle to whom.
    pub plan: &'a HaloPlan,
    /// Values reduced by maximum over the ranks while the pass runs.
    pub maxima: &'a mut [f64],
}

/// The two copies of the records of all three parts.
#[derive(Debug)]
pub struct Copies<'a, S> {
    /// Read by the pass.
    pub old: &'a mut [Record<S>],
    /// Written by the pass.
    pub new: &'a mut [Record<S>],
}

/// Runs one pass over the fluid particles of a rank, ordered `[local | inner | outer]`.
///
/// `columns` and `rates` belong to the owned particles.
pub fn lio_pass<const D: usize, S: Real, P: Pass<D, S>>(
    pass: &P,
    team: &Team,
    parts: &Parts,
    exchange: Exchange<'_, P::Message>,
    records: Copies<'_, S>,
    columns: FluidColumns<'_, D>,
    rates: &mut [P::Rate],
) -> Result<(Outcome, Exposed), CommError> {
    let Exchange { comm, halo, plan, maxima } = exchange;
    let Copies { old, new } = records;
    let (new, new_outer) = new.split_at_mut(parts.owned());
    let (mut local, mut inner) = columns.block(rates, new).split_at(parts.local);
    let (mut of_inner, mut of_local) = (Outcome::NONE, Outcome::NONE);
    // Without a neighbour nothing is under way.
    let polls = if plan.sends().is_empty() && plan.outer() == 0 { 1 } else { POLLS };
    let old_now: &[Record<S>] = old;
    // 1. The exchange posts the receptions before it calls the first closure.
    let (received, exposed) = halo.exchange(
        &comm,
        plan,
        maxima,
        |send| {
            // 2. and 3. Inner particles: fluxes with all three parts, then their update.
            of_inner = team.advance(pass, old_now, &mut inner);
            // 4. Their new state goes out; the old records stay for the local particles.
            plan.pack(send, |i| {
                let i = i as usize - parts.local;
                pass.message(&inner.new[i], inner.density[i])
            });
        },
        |progress| {
            // 5. and 6. Local particles: they cannot see an outer record.
            let visible = &old_now[..parts.owned()];
            let piece = local.len().div_ceil(polls).max(1);
            for mut piece in local.pieces(piece, pass.clusters()) {
                let outcome = team.advance(pass, visible, &mut piece);
                of_local = std::mem::replace(&mut of_local, Outcome::NONE).join(outcome);
                progress.poll();
            }
        },
    )?;
    // 7. The outer state has arrived.
    let old_outer = &mut old[parts.owned()..];
    plan.unpack(received, |slot, message| {
        pass.receive(message, &mut old_outer[slot], &mut new_outer[slot]);
    });
    Ok((of_inner.join(of_local), exposed))
}
