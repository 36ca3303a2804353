//! A small dam break in a closed box, in two or three dimensions, shared by the tests.
#![allow(dead_code, reason = "each test uses a part")]

use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid};
use sph_kernels::{Real, WendlandC2};
use sph_solver::eos::EquationOfState;
use sph_solver::error::RunError;
use sph_solver::model::{Model, OnLost, SolidModel};
use sph_solver::run::checkpoints::share;
use sph_solver::run::digest::Digest;
use sph_solver::scheme::Scheme;
use sph_solver::simulation::{FullStep, Simulation};
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, DeltaContinuity, SymmetricPressure, WallContinuity, WallPressure,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;

pub const GRAVITY: f64 = 9.81;

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
            grading: None,
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
            periods: [None; D],
            lowest_pressure: f64::NEG_INFINITY,
            closed: false,
            on_lost: OnLost::Stop,
            solids: vec![SolidModel {
                name: "tank".into(),
                center: [0.0; D],
                slips: true,
                thin: None,
            }],
        }
    }

    pub fn scheme<S: Real>(&self) -> Scheme<D, S> {
        let model = self.model();
        let (h, c0) = (model.limits.smoothing_length, model.limits.sound_speed);
        let density = DeltaContinuity {
            strength: 0.1 * h * c0,
            hydrostatic_gradient: model.gravity.map(|g| g * 1000.0 / (c0 * c0)),
        };
        let friction =
            ArtificialViscosity { strength: 0.02 * h * c0 * 1000.0, softening: 0.01 * h * h };
        let wall = WallPressure { sound_speed: c0 };
        Scheme::of::<WendlandC2>(density, (SymmetricPressure, friction))
            .walls(WallContinuity, wall)
            .build()
    }

    /// The column in the corner with hydrostatic pressure.
    pub fn fluid(&self) -> State<D> {
        let model = self.model();
        let dp = self.spacing;
        let mut state = State::default();
        let height = f64::from(self.column[D - 1]) * dp;
        let cells: i32 = self.column.iter().product();
        for number in 0..cells {
            let mut rest = number;
            let x: [f64; D] = std::array::from_fn(|k| {
                let cell = rest % self.column[k];
                rest /= self.column[k];
                (f64::from(cell) + 0.5) * dp
            });
            let pressure = 1000.0 * GRAVITY * (height - x[D - 1]);
            state.id.push(state.id.len() as u64);
            state.mass.push(1000.0 * dp.powi(D as i32));
            state.density.push(model.equation_of_state.density(pressure));
            state.position.push(x);
            state.velocity.push([0.0; D]);
        }
        state
    }

    /// The walls of the tank.
    pub fn walls(&self) -> WallElements<D> {
        let size = self.tank.map(|n| f64::from(n) * self.spacing);
        let shape = Shape::cuboid([0.0; D], size).expect("a box");
        let tank = Solid::new("tank", shape, FluidSide::Inside);
        let lattice = Lattice::new([0.0; D], self.spacing).expect("a lattice");
        let domain = Domain::new(Aabb::new([0.0; D], size));
        let support = 3.0 * self.spacing;
        WallElements::of_solids(&[tank], &lattice, support, &domain, 1 << 32).expect("walls")
    }

    pub fn simulation<'a, S: Real + Pod>(
        &self,
        comm: &'a dyn Communicator,
        threads: usize,
    ) -> Result<Simulation<'a, D, S>, RunError> {
        let (mut state, mut walls) = (self.fluid(), self.walls());
        state.keep(&indices(share(comm, state.len())));
        walls.keep(&indices(share(comm, walls.len())));
        let team = Team::new(threads)?;
        Simulation::new(comm, team, self.model(), self.scheme(), state, walls, None)
    }
}

/// Indices of a range.
pub fn indices(range: std::ops::Range<usize>) -> Vec<u32> {
    (range.start as u32..range.end as u32).collect()
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
