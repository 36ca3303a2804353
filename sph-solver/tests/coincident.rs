//! Particles that coincide: forces stay finite, and momentum is that of the start.

use sph_decomp::Solo;
use sph_kernels::WendlandC2;
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost};
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{ArtificialViscosity, DeltaContinuity, Shifting, SymmetricPressure};
use sph_solver::timestep::StepLimits;

const SPACING: f64 = 0.1;
const SUPPORT: f64 = 3.0 * SPACING;
const SOUND_SPEED: f64 = 20.0;

fn model() -> Model<2> {
    let (density0, sound_speed) = (1000.0, SOUND_SPEED);
    Model {
        spacing: SPACING,
        support_radius: SUPPORT,
        grading: None,
        skin: 0.15 * SUPPORT,
        gravity: [0.0; 2],
        equation_of_state: EquationOfState::Linear { density0, sound_speed },
        limits: StepLimits {
            cfl: 1.0,
            smoothing_length: 0.5 * SUPPORT,
            sound_speed,
            kinematic_viscosity: 0.0,
        },
        domain: ([-50.0; 2], [50.0; 2]),
        periods: [None; 2],
        lowest_pressure: f64::NEG_INFINITY,
        closed: false,
        on_lost: OnLost::Stop,
        solids: Vec::new(),
    }
}

/// A block that shears, with two particles in the middle `apart` spacings from each other.
fn block(apart: f64) -> State<2> {
    let mut state = State::default();
    let mut place = |x: [f64; 2]| {
        state.id.push(state.id.len() as u64);
        state.mass.push(1000.0 * SPACING * SPACING);
        state.density.push(1000.0);
        state.position.push(x);
        state.velocity.push([0.5 * x[1], 0.3 * x[0]]);
    };
    for row in -6..=6 {
        for column in -6..=6 {
            place([f64::from(column) * SPACING, f64::from(row) * SPACING]);
        }
    }
    place([apart * SPACING, 0.0]);
    state
}

#[test]
fn they_stay_finite_and_keep_the_momentum() {
    for apart in [0.0, 1e-8] {
        for shifts in [false, true] {
            let h = 0.5 * SUPPORT;
            let density =
                DeltaContinuity { strength: 0.1 * h * SOUND_SPEED, hydrostatic_gradient: [0.0; 2] };
            let viscosity = ArtificialViscosity {
                strength: 0.02 * h * SOUND_SPEED * 1000.0,
                softening: 0.01 * h * h,
            };
            let scheme =
                Scheme::<2, f64>::of::<WendlandC2>(density, (SymmetricPressure, viscosity));
            let shifting = Shifting::<WendlandC2>::new(SUPPORT, SPACING);
            let scheme = if shifts { scheme.shifting(shifting) } else { scheme }.build();
            let state = block(apart);
            let momentum = |mass: &[f64], velocity: &[[f64; 2]], k: usize| -> f64 {
                mass.iter().zip(velocity).map(|(m, v)| m * v[k]).sum()
            };
            let before = [0, 1].map(|k| momentum(&state.mass, &state.velocity, k));
            let scale: f64 =
                state.mass.iter().zip(&state.velocity).map(|(m, v)| m * v[0].hypot(v[1])).sum();
            let walls = sph_solver::walls::WallElements::default();
            let team = Team::new(1).unwrap();
            let mut simulation =
                Simulation::new(&Solo, team, model(), scheme, state, walls, None).unwrap();
            let mut last = None;
            for step in 0..500 {
                last = simulation.step(step == 499).unwrap();
            }
            let full = last.expect("the last step was asked for");
            assert!(full.position.iter().chain(&full.velocity).flatten().all(|x| x.is_finite()));
            for (k, before) in before.iter().enumerate() {
                let change = momentum(&full.mass, &full.velocity, k) - before;
                assert!(change.abs() < 1e-12 * scale, "{apart} {shifts}: {change}");
            }
        }
    }
}
