//! A small dam break in a closed box, in two or three dimensions, shared by the tests.
#![allow(dead_code, reason = "each test uses a part")]

use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_kernels::{Real, WendlandC2};
use sph_solver::eos::EquationOfState;
use sph_solver::error::RunError;
use sph_solver::model::{Model, OnLost};
use sph_solver::physics::Terms;
use sph_solver::run::checkpoints::share;
use sph_solver::run::digest::Digest;
use sph_solver::simulation::{FullStep, Simulation};
use sph_solver::state::{FLUID, State};
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, Continuity, DeltaContinuity, OneSidedRiemannWall, SymmetricPressure,
};
use sph_solver::timestep::StepLimits;

pub const GRAVITY: f64 = 9.81;

pub type BoxTerms<const D: usize> = Terms<
    DeltaContinuity<D>,
    (SymmetricPressure, ArtificialViscosity),
    Continuity,
    OneSidedRiemannWall<D>,
>;

/// Fluid cells and tank cells per axis; the last axis points up.
#[derive(Clone, Copy)]
pub struct Case<const D: usize> {
    pub column: [i32; D],
    pub tank: [i32; D],
    pub spacing: f64,
    pub skin: f64,
}

impl<const D: usize> Case<D> {
    pub fn model(&self) -> Model<D> {
        let dp = self.spacing;
        let height = f64::from(self.column[D - 1]) * dp;
        let sound_speed = 20.0 * (GRAVITY * height).sqrt();
        let mut gravity = [0.0; D];
        gravity[D - 1] = -GRAVITY;
        Model {
            spacing: dp,
            support_radius: 3.0 * dp,
            skin: self.skin * 3.0 * dp,
            gravity,
            equation_of_state: EquationOfState::Linear { density0: 1000.0, sound_speed },
            limits: StepLimits {
                cfl: 1.0,
                smoothing_length: 1.5 * dp,
                sound_speed,
                kinematic_viscosity: 0.0,
            },
            domain: ([-4.0 * dp; D], self.tank.map(|n| f64::from(n + 4) * dp)),
            on_lost: OnLost::Stop,
        }
    }

    pub fn physics(&self) -> BoxTerms<D> {
        let model = self.model();
        let (h, c0) = (model.limits.smoothing_length, model.limits.sound_speed);
        Terms {
            fluid_density: DeltaContinuity {
                strength: 0.1 * h * c0,
                hydrostatic_gradient: model.gravity.map(|g| g * 1000.0 / (c0 * c0)),
            },
            fluid_force: (
                SymmetricPressure,
                ArtificialViscosity { strength: 0.02 * h * c0 * 1000.0, softening: 0.01 * h * h },
            ),
            wall_density: Continuity,
            wall_force: OneSidedRiemannWall { gravity: model.gravity, sound_speed: c0 },
        }
    }

    /// All particles: the column in the corner with hydrostatic pressure, and three layers of wall.
    pub fn particles(&self) -> State<D> {
        let model = self.model();
        let dp = self.spacing;
        let mut state = State::default();
        let height = f64::from(self.column[D - 1]) * dp;
        let mut cell = [-3; D];
        loop {
            let x = cell.map(|i| (f64::from(i) + 0.5) * dp);
            let within = |size: &[i32; D]| (0..D).all(|k| (0..size[k]).contains(&cell[k]));
            if within(&self.column) || !within(&self.tank) {
                let fluid = within(&self.column);
                let pressure = if fluid { 1000.0 * GRAVITY * (height - x[D - 1]) } else { 0.0 };
                state.id.push(state.id.len() as u64);
                state.kind.push(if fluid { FLUID } else { 1 });
                state.mass.push(1000.0 * dp.powi(D as i32));
                state.density.push(model.equation_of_state.density(pressure));
                state.position.push(x);
                state.velocity.push([0.0; D]);
            }
            let mut k = 0;
            loop {
                if k == D {
                    return state;
                }
                cell[k] += 1;
                if cell[k] < self.tank[k] + 3 {
                    break;
                }
                cell[k] = -3;
                k += 1;
            }
        }
    }

    pub fn simulation<'a, S: Real + Pod>(
        &self,
        comm: &'a dyn Communicator,
        threads: usize,
    ) -> Result<Simulation<'a, D, S, WendlandC2, BoxTerms<D>>, RunError> {
        let mut state = self.particles();
        let share = share(comm, state.len());
        state.keep(&(share.start as u32..share.end as u32).collect::<Vec<_>>());
        let team = Team::new(threads)?;
        Simulation::new(comm, team, self.model(), self.physics(), state, None)
    }
}

/// Digest of a rank's part; parts of all ranks are merged.
pub fn digest<const D: usize>(full: &FullStep<D>) -> Digest {
    let mut digest = Digest::default();
    for i in 0..full.id.len() {
        let words = full.position[i].into_iter().chain(full.velocity[i]).chain([full.density[i]]);
        digest.add(full.id[i], words);
    }
    digest
}
