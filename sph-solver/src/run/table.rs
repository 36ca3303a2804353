//! The table from what a scene models to the loop compiled for exactly that.
//!
//! Adding a term means a file in [`crate::terms`] and a line here. The table is a choice, not the
//! full product of all options: library users compose [`Terms`] themselves.

use super::driver::{Finished, Status, drive};
use super::plan::RunPlan;
use super::summary::{Meta, Summary, summarize};
use crate::error::RunError;
use crate::model::Model;
use crate::physics::{Physics, Terms};
use crate::simulation::Simulation;
use crate::state::State;
use crate::team::Team;
use crate::terms::{
    ArtificialViscosity, Continuity, DeltaContinuity, LaminarViscosity, OneSidedRiemannWall,
    PairTerm, Pressure, SymmetricPressure,
};
use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_kernels::{Real, WendlandC2};

/// What a scene models; everything else is not compiled into its loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// Pair arithmetic in single precision.
    pub precision: Precision,
    /// Strength δ of the density diffusion.
    pub density_diffusion: f64,
    /// Friction in the fluid.
    pub viscosity: Viscosity,
    /// Whether there are walls.
    pub walls: bool,
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
    /// Particles that this rank begins with.
    pub state: State<D>,
    /// Called after each step.
    pub watch: &'a (dyn Fn(Status) + Sync),
    /// What the summary says about the set-up.
    pub meta: Meta,
}

/// Runs a job with the loop that its features call for. Collective.
pub fn run_job<const D: usize>(job: Job<'_, D>, features: Features) -> Result<Summary, RunError> {
    match features.precision {
        Precision::Mixed => by_viscosity::<D, f32>(job, features),
        Precision::Double => by_viscosity::<D, f64>(job, features),
    }
}

fn by_viscosity<const D: usize, S: Real + Pod>(
    job: Job<'_, D>,
    features: Features,
) -> Result<Summary, RunError> {
    let (model, pressure) = (&job.model, SymmetricPressure);
    let (h, sound_speed) = (model.limits.smoothing_length, model.limits.sound_speed);
    let softening = 0.01 * h * h;
    let wall = OneSidedRiemannWall { gravity: model.gravity, sound_speed };
    match features.viscosity {
        Viscosity::None => by_walls::<D, S, _, _>(job, features, pressure, wall),
        Viscosity::Artificial(alpha) => {
            let strength = alpha * h * sound_speed * model.equation_of_state.density0();
            let friction = ArtificialViscosity { strength, softening };
            by_walls::<D, S, _, _>(job, features, (pressure, friction), wall)
        }
        Viscosity::Laminar(dynamic_viscosity) => {
            let friction = LaminarViscosity { dynamic_viscosity, softening };
            by_walls::<D, S, _, _>(job, features, (pressure, friction), (wall, friction))
        }
    }
}

fn by_walls<const D: usize, S: Real + Pod, FF, WF>(
    job: Job<'_, D>,
    features: Features,
    fluid_force: FF,
    wall_force: WF,
) -> Result<Summary, RunError>
where
    FF: PairTerm<D, Pressure> + 'static,
    WF: PairTerm<D, Pressure> + 'static,
{
    let model = &job.model;
    let sound_speed = model.limits.sound_speed;
    let stiffness = model.equation_of_state.density0() / (sound_speed * sound_speed);
    let fluid_density = DeltaContinuity {
        strength: features.density_diffusion * model.limits.smoothing_length * sound_speed,
        hydrostatic_gradient: model.gravity.map(|g| g * stiffness),
    };
    if features.walls {
        finish::<D, S, _>(
            job,
            Terms { fluid_density, fluid_force, wall_density: Continuity, wall_force },
        )
    } else {
        let terms = Terms { fluid_density, fluid_force, wall_density: (), wall_force: () };
        finish::<D, S, _>(job, terms)
    }
}

fn finish<const D: usize, S: Real + Pod, P: Physics<D>>(
    job: Job<'_, D>,
    physics: P,
) -> Result<Summary, RunError> {
    let Job { comm, team, model, plan, state, watch, meta } = job;
    let (simulation, finished): (Simulation<'_, D, S, WendlandC2, P>, Finished<D>) =
        drive(comm, team, model, physics, state, plan, watch)?;
    summarize(comm, &simulation, &finished, meta)
}
