//! Mixed and double precision give the same flow: Taylor–Green vortices from a jittered lattice.
//!
//! Between the planes of symmetry of the vortices there is no flow through nor friction along them, so
//! a box with slipping walls holds the exact solution of the periodic problem (Taylor & Green 1937):
//! u = sin 2πx cos 2πy f, v = −cos 2πx sin 2πy f, f = exp(−8π²νt).

use sph_decomp::Solo;
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid};
use sph_kernels::{Real, WendlandC2};
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost, SolidModel};
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    DeltaContinuity, LaminarViscosity, SymmetricPressure, WallContinuity, WallPressure,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;
use std::f64::consts::PI;

const CELLS: i32 = 40;
const DP: f64 = 1.0 / CELLS as f64;
const DENSITY: f64 = 1.0;
/// Reynolds number 100.
const VISCOSITY: f64 = 0.01;
const SOUND_SPEED: f64 = 10.0;
const END: f64 = 0.4;

fn exact([x, y]: [f64; 2], t: f64) -> [f64; 2] {
    let f = (-8.0 * PI * PI * VISCOSITY * t).exp();
    let (sx, cx) = (2.0 * PI * x).sin_cos();
    let (sy, cy) = (2.0 * PI * y).sin_cos();
    [sx * cy * f, -cx * sy * f]
}

fn particles(equation_of_state: EquationOfState, mut seed: u64) -> State<2> {
    let mut state = State::default();
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0
    };
    for j in 0..CELLS {
        for i in 0..CELLS {
            let x = [i, j].map(|k| (f64::from(k) + 0.5 + 0.1 * noise()) * DP);
            // A background pressure, so that nothing is under tension.
            let waves = (4.0 * PI * x[0]).cos() + (4.0 * PI * x[1]).cos();
            let pressure = DENSITY * (2.0 + 0.25 * waves);
            state.id.push(state.id.len() as u64);
            state.density.push(equation_of_state.density(pressure));
            state.mass.push(state.density[state.density.len() - 1] * DP * DP);
            state.velocity.push(exact(x, 0.0));
            state.position.push(x);
        }
    }
    state
}

fn walls(support_radius: f64) -> WallElements<2> {
    let shape = Shape::cuboid([0.0; 2], [1.0; 2]).unwrap();
    let tank = Solid::new("box", shape, FluidSide::Inside);
    let lattice = Lattice::new([0.0; 2], DP).unwrap();
    let domain = Domain::new(Aabb::new([0.0; 2], [1.0; 2]));
    WallElements::of_solids(&[tank], &lattice, support_radius, &domain, 1 << 32).unwrap()
}

/// Mean difference of speeds over mean speed, at the end.
fn error<S: Real + bytemuck::Pod>(seed: u64) -> f64 {
    let (h, support_radius) = (2.0 * DP, 4.0 * DP);
    let (density0, sound_speed) = (DENSITY, SOUND_SPEED);
    let equation_of_state = EquationOfState::Linear { density0, sound_speed };
    let model = Model {
        spacing: DP,
        support_radius,
        grading: None,
        skin: 0.15 * support_radius,
        gravity: [0.0; 2],
        equation_of_state,
        limits: StepLimits {
            cfl: 1.0,
            smoothing_length: h,
            sound_speed,
            kinematic_viscosity: VISCOSITY / DENSITY,
        },
        domain: ([-0.2; 2], [1.2; 2]),
        periods: [None; 2],
        lowest_pressure: f64::NEG_INFINITY,
        closed: true,
        on_lost: OnLost::Stop,
        solids: vec![SolidModel { name: "box".into(), center: [0.5; 2], slips: true, thin: None }],
    };
    let friction = LaminarViscosity { dynamic_viscosity: VISCOSITY };
    let density =
        DeltaContinuity { strength: 0.1 * h * sound_speed, hydrostatic_gradient: [0.0; 2] };
    let wall = WallPressure { sound_speed };
    let scheme = Scheme::<2, S>::of::<WendlandC2>(density, (SymmetricPressure, friction))
        .walls(WallContinuity, wall)
        .build();
    let state = particles(equation_of_state, seed);
    let team = Team::new(1).unwrap();
    let mut simulation =
        Simulation::new(&Solo, team, model, scheme, state, walls(support_radius), None).unwrap();
    while simulation.time() < END {
        simulation.step(false).unwrap();
    }
    let full = simulation.step(true).unwrap().unwrap();
    let length = |v: [f64; 2]| v[0].hypot(v[1]);
    let (mut difference, mut sum) = (0.0, 0.0);
    for (x, v) in full.position.iter().zip(&full.velocity) {
        let expected = length(exact(*x, full.time));
        difference += (length(*v) - expected).abs();
        sum += expected;
    }
    difference / sum
}

#[test]
fn mixed_and_double_have_the_same_error() {
    for seed in 1..=3 {
        let (mixed, double) = (error::<f32>(seed), error::<f64>(seed));
        assert!(double > 1e-4 && double < 0.1, "{double}");
        assert!((mixed / double - 1.0).abs() < 0.01, "{mixed} {double}");
    }
}
