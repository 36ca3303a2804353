//! From what a scene models to the sums compiled for exactly that.
//!
//! Adding a term means a file in [`crate::terms`] and a line here. Every group of pairs is chosen by
//! itself, so that choices add up and do not multiply; library users compose a
//! [`Scheme`] themselves.

use super::driver::{Start, Status, drive};
use super::plan::RunPlan;
use super::summary::{Meta, Summary, summarize};
use crate::bodies::Bodies;
use crate::energy::Sink;
use crate::error::RunError;
use crate::model::Model;
use crate::scheme::Scheme;
use crate::state::State;
use crate::team::Team;
use crate::terms::{
    ArtificialViscosity, AtRest, Continuity, DeltaContinuity, LaminarViscosity, NoSlip,
    RadiusSlope, Shifting, SymmetricPressure, WallContinuity, WallPressure,
};
use crate::walls::WallElements;
use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_kernels::{Kernel, Real, WendlandC2};

/// What a scene models; everything else is not compiled into its loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// Pair arithmetic in single precision.
    pub precision: Precision,
    /// Strength δ of the density diffusion.
    pub density_diffusion: f64,
    /// Friction in the fluid.
    pub viscosity: Viscosity,
    /// Whether particles are shifted.
    pub shifting: bool,
    /// Whether there are walls.
    pub walls: bool,
    /// Whether the energy that each term takes is added up.
    pub energy_budget: bool,
}

/// Scalar of the pair arithmetic. The state is always in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f32` pairs on fixed-point coordinates.
    Mixed,
    /// `f64` pairs.
    Double,
}

/// Friction in the fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Viscosity {
    /// None.
    None,
    /// Artificial viscosity α.
    Artificial(f64),
    /// Dynamic viscosity μ, Pa s, with no-slip walls.
    Laminar(f64),
}

/// One rank of a run, before its types are chosen.
pub struct Job<'a, const D: usize> {
    /// Ranks.
    pub comm: &'a dyn Communicator,
    /// Threads of this rank.
    pub team: Team,
    /// Constants.
    pub model: Model<D>,
    /// Outputs.
    pub plan: &'a RunPlan<D>,
    /// Fluid that this rank begins with.
    pub state: State<D>,
    /// Elements of walls that this rank begins with.
    pub elements: WallElements<D>,
    /// Solids that move, as they are at the start.
    pub bodies: Bodies<D>,
    /// Called after each step.
    pub watch: &'a (dyn Fn(Status) + Sync),
    /// What the summary says about the set-up.
    pub meta: Meta,
}

/// Runs a job with the sums that its features call for. Collective.
pub fn run_job<const D: usize>(job: Job<'_, D>, features: Features) -> Result<Summary, RunError> {
    match features.precision {
        Precision::Mixed => run_in::<D, f32>(job, &features),
        Precision::Double => run_in::<D, f64>(job, &features),
    }
}

fn run_in<const D: usize, S: Real + Pod>(
    job: Job<'_, D>,
    features: &Features,
) -> Result<Summary, RunError> {
    let scheme = delta_scheme::<D, S>(&job.model, features);
    let Job { comm, team, model, plan, state, elements, bodies, watch, meta } = job;
    let start = Start { state, elements, bodies };
    let (simulation, finished) = drive(comm, team, model, scheme, start, plan, watch)?;
    summarize(comm, &simulation, &finished, meta)
}

/// δ-SPH with what a scene models.
fn delta_scheme<const D: usize, S: Real>(model: &Model<D>, features: &Features) -> Scheme<D, S> {
    type K = WendlandC2;
    // The largest smoothing length: pairs know by how much theirs is smaller.
    let h = model.support_radius / K::RADIUS_OVER_H;
    let sound_speed = model.limits.sound_speed;
    let density0 = model.equation_of_state.density0();
    let softening = 0.01 * h * h;
    let stiffness = density0 / (sound_speed * sound_speed);
    let diffusion = DeltaContinuity {
        strength: features.density_diffusion * h * sound_speed,
        hydrostatic_gradient: model.gravity.map(|g| g * stiffness),
    };
    let pressure = SymmetricPressure;
    let diffusive = features.density_diffusion > 0.0;
    let builder = match (features.viscosity, diffusive) {
        (Viscosity::None, true) => Scheme::of::<K>(diffusion, pressure),
        (Viscosity::None, false) => Scheme::of::<K>(Continuity, pressure),
        (Viscosity::Artificial(alpha), diffusive) => {
            let strength = alpha * h * sound_speed * density0;
            let force = (pressure, ArtificialViscosity { strength, softening });
            if diffusive {
                Scheme::of::<K>(diffusion, force)
            } else {
                Scheme::of::<K>(Continuity, force)
            }
        }
        (Viscosity::Laminar(dynamic_viscosity), diffusive) => {
            let force = (pressure, LaminarViscosity { dynamic_viscosity });
            if diffusive {
                Scheme::of::<K>(diffusion, force)
            } else {
                Scheme::of::<K>(Continuity, force)
            }
        }
    };
    let builder = if features.energy_budget {
        let builder = builder.accounts();
        let builder =
            if diffusive { builder.account_diffusion(AtRest(diffusion)) } else { builder };
        match features.viscosity {
            Viscosity::None => builder,
            Viscosity::Artificial(alpha) => {
                let strength = alpha * h * sound_speed * density0;
                let term = ArtificialViscosity { strength, softening };
                builder.account_viscosity(Sink::ArtificialViscosity, term)
            }
            Viscosity::Laminar(dynamic_viscosity) => {
                builder.account_viscosity(Sink::Viscosity, LaminarViscosity { dynamic_viscosity })
            }
        }
    } else {
        builder
    };
    let shifting = Shifting::<K>::new(model.support_radius, model.spacing);
    let builder = if features.shifting { builder.shifting(shifting) } else { builder };
    if !features.walls {
        return builder.build();
    }
    let builder = match model.grading {
        Some(_) => builder.radius_slope(RadiusSlope),
        None => builder,
    };
    let wall = WallPressure { sound_speed };
    let builder =
        builder.walls(WallContinuity, wall).account_walls(WallPressure { sound_speed: 0.0 });
    let builder = if features.shifting { builder.wall_shifting(shifting) } else { builder };
    match features.viscosity {
        Viscosity::Laminar(dynamic_viscosity) => {
            let smallest_distance = 0.25 * model.spacing;
            builder.friction(NoSlip { dynamic_viscosity, smallest_distance }).build()
        }
        _ => builder.build(),
    }
}
