//! The dam break that DualSPHysics ships, without its building: whole steps of the solver.

use bytemuck::Pod;
use sph_decomp::Communicator;
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid};
use sph_kernels::{Real, WendlandC2};
use sph_solver::eos::EquationOfState;
use sph_solver::error::RunError;
use sph_solver::model::{Model, OnLost, SolidModel};
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, DeltaContinuity, SymmetricPressure, WallContinuity, WallPressure,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;

const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1000.0;
/// Box with an open top, m.
const BOX: [f64; 3] = [1.6, 0.67, 0.4];
/// Water column in a corner of it, m.
const COLUMN: [f64; 3] = [0.4, 0.67, 0.3];

/// A water column in a box: 1.6 × 0.67 × 0.4 m, column 0.4 × 0.67 × 0.3 m, walls as thick as the
/// support radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamBreak {
    /// Distance of particles, m.
    pub spacing: f64,
    /// Support radius / spacing.
    pub support: f64,
    /// Skin of the lists / support radius.
    pub skin: f64,
    /// Start in the middle of the collapse instead of at rest: the velocities of a stagnation flow
    /// whose front is as fast as the front of the dam break becomes, 2 √(g H). The lists then live
    /// as briefly from the first step as they do in the run later on.
    pub collapsing: bool,
}

impl DamBreak {
    /// The spacing at which the column holds about this many particles.
    pub fn spacing_for(fluid: usize) -> f64 {
        (COLUMN.iter().product::<f64>() / fluid as f64).cbrt()
    }

    /// Constants of the run.
    pub fn model(&self) -> Model<3> {
        let (dp, radius) = (self.spacing, self.support * self.spacing);
        let sound_speed = 20.0 * (GRAVITY * COLUMN[2]).sqrt();
        let margin = (self.support.ceil() + 1.0) * dp;
        Model {
            spacing: dp,
            support_radius: radius,
            grading: None,
            skin: self.skin * radius,
            gravity: [0.0, 0.0, -GRAVITY],
            equation_of_state: EquationOfState::Tait { density0: DENSITY, sound_speed, gamma: 7.0 },
            limits: StepLimits {
                cfl: 1.0,
                smoothing_length: 0.5 * radius,
                sound_speed,
                kinematic_viscosity: 0.0,
            },
            domain: ([-margin; 3], [BOX[0] + margin, BOX[1] + margin, 3.0 * BOX[2]]),
            periods: [None; 3],
            lowest_pressure: f64::NEG_INFINITY,
            closed: false,
            on_lost: OnLost::Remove,
            solids: vec![SolidModel {
                name: "box".into(),
                center: [0.0; 3],
                slips: true,
                thin: None,
            }],
        }
    }

    /// δ-SPH with artificial viscosity 0.1 and density diffusion 0.1.
    pub fn scheme<S: Real>(&self) -> Scheme<3, S> {
        let model = self.model();
        let (h, c0) = (model.limits.smoothing_length, model.limits.sound_speed);
        let density = DeltaContinuity {
            strength: 0.1 * h * c0,
            hydrostatic_gradient: model.gravity.map(|g| g * DENSITY / (c0 * c0)),
        };
        let friction =
            ArtificialViscosity { strength: 0.1 * h * c0 * DENSITY, softening: 0.01 * h * h };
        Scheme::of::<WendlandC2>(density, (SymmetricPressure, friction))
            .walls(WallContinuity, WallPressure { sound_speed: c0 })
            .build()
    }

    /// The water.
    pub fn fluid(&self) -> State<3> {
        let dp = self.spacing;
        let column = COLUMN.map(|l| (l / dp).round() as i32);
        let eos = self.model().equation_of_state;
        let rate =
            if self.collapsing { 2.0 * (GRAVITY * COLUMN[2]).sqrt() / COLUMN[0] } else { 0.0 };
        let mut state = State::default();
        for z in 0..column[2] {
            for y in 0..column[1] {
                for x in 0..column[0] {
                    let x = [x, y, z].map(|i| (f64::from(i) + 0.5) * dp);
                    let depth = (COLUMN[2] - x[2]).max(0.0);
                    state.id.push(state.id.len() as u64);
                    state.mass.push(DENSITY * dp.powi(3));
                    state.density.push(eos.density(DENSITY * GRAVITY * depth));
                    state.position.push(x);
                    state.velocity.push([rate * x[0], 0.0, -rate * x[2]]);
                }
            }
        }
        state
    }

    /// The walls: a box with an open top.
    pub fn walls(&self) -> WallElements<3> {
        let dp = self.spacing;
        let size = BOX.map(|l| (l / dp).round() * dp);
        let high = [size[0], size[1], 2.0 * size[2]];
        let shape = Shape::cuboid([0.0; 3], high).expect("a box");
        let tank = Solid::new("box", shape, FluidSide::Inside);
        let lattice = Lattice::new([0.0; 3], dp).expect("a lattice");
        let domain = Domain::new(Aabb::new([0.0; 3], size));
        let mut walls =
            WallElements::of_solids(&[tank], &lattice, self.support * dp, &domain, 1 << 40)
                .expect("walls");
        let below: Vec<u32> =
            (0..walls.len() as u32).filter(|&i| walls.position[i as usize][2] < size[2]).collect();
        walls.keep(&below);
        walls
    }

    /// Wall particles in the layer next to the inside of the box.
    pub fn layer(&self) -> u64 {
        let [x, y, z] = BOX.map(|l| (l / self.spacing).round() as u64);
        (x + 2) * (y + 2) * (z + 1) - x * y * z
    }

    /// The simulation on one rank.
    pub fn simulation<'a, S: Real + Pod>(
        &self,
        comm: &'a dyn Communicator,
        threads: usize,
    ) -> Result<Simulation<'a, 3, S>, RunError> {
        let team = Team::new(threads)?;
        let (fluid, walls) = (self.fluid(), self.walls());
        Simulation::new(comm, team, self.model(), self.scheme(), fluid, walls, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sph_decomp::Solo;

    #[test]
    fn a_coarse_dam_breaks() {
        let case = DamBreak { spacing: 0.05, support: 3.0, skin: 0.2, collapsing: true };
        let mut simulation = case.simulation::<f32>(&Solo, 1).expect("a sound set-up");
        for _ in 0..20 {
            simulation.step(false).expect("steps");
        }
        let fluid = simulation.rank().fluid.owned();
        assert_eq!(fluid, 8 * 13 * 6);
        let front =
            simulation.rank().state.position[..fluid].iter().map(|x| x[0]).fold(0.0, f64::max);
        assert!(front > COLUMN[0], "{front}");
    }

    #[test]
    fn the_spacing_gives_the_count() {
        let spacing = DamBreak::spacing_for(1000);
        let case = DamBreak { spacing, support: 3.0, skin: 0.2, collapsing: false };
        let fluid = case.fluid().len();
        assert!((900..1100).contains(&fluid), "{fluid}");
    }
}
