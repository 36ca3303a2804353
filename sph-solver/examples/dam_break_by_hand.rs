//! A dam break put together from the library, without a scene file: particles, terms, steps.
//!
//! Run with `cargo run --release -p sph-solver --example dam_break_by_hand`.

use sph_decomp::Solo;
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid};
use sph_kernels::WendlandC2;
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost, SolidModel};
use sph_solver::run::samples::budget;
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, DeltaContinuity, SymmetricPressure, WallContinuity, WallPressure,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A column of water, 1 m wide and 2 m high, in a tank of 4 m × 3 m.
    let (column, tank, dp) = ([1.0, 2.0], [4.0, 3.0], 0.05);
    let gravity = [0.0, -9.81];
    let density0 = 1000.0;
    let sound_speed = 10.0 * 2.0 * f64::sqrt(9.81 * column[1]);
    let (h, support_radius) = (1.5 * dp, 3.0 * dp);
    let equation_of_state = EquationOfState::Linear { density0, sound_speed };
    let model = Model {
        spacing: dp,
        support_radius,
        grading: None,
        skin: 0.1 * support_radius,
        gravity,
        equation_of_state,
        limits: StepLimits { cfl: 1.0, smoothing_length: h, sound_speed, kinematic_viscosity: 0.0 },
        domain: ([-0.5, -0.5], [4.5, 3.5]),
        periods: [None; 2],
        lowest_pressure: f64::NEG_INFINITY,
        closed: false,
        on_lost: OnLost::Stop,
        solids: vec![SolidModel { name: "tank".into(), center: [0.0; 2], slips: true, thin: None }],
    };

    // The column on a lattice, under the weight of the water above.
    let lattice = Lattice::new([0.0; 2], dp)?;
    let mut state = State::<2>::default();
    for x in sph_geometry::fill_lattice(&Shape::cuboid([0.0; 2], column)?, &lattice)? {
        let pressure = density0 * 9.81 * (column[1] - x[1]);
        state.id.push(state.id.len() as u64);
        state.mass.push(density0 * dp * dp);
        state.density.push(equation_of_state.density(pressure));
        state.position.push(x);
        state.velocity.push([0.0; 2]);
    }
    let inside = Solid::new("tank", Shape::cuboid([0.0; 2], tank)?, FluidSide::Inside);
    let domain = Domain::new(Aabb::new([0.0; 2], tank));
    let first_id = state.len() as u64;
    let walls = WallElements::of_solids(&[inside], &lattice, support_radius, &domain, first_id)?;

    let density = DeltaContinuity {
        strength: 0.1 * h * sound_speed,
        hydrostatic_gradient: gravity.map(|g| g * density0 / (sound_speed * sound_speed)),
    };
    let friction = ArtificialViscosity {
        strength: 0.02 * h * sound_speed * density0,
        softening: 0.01 * h * h,
    };
    let scheme = Scheme::<2, f32>::of::<WendlandC2>(density, (SymmetricPressure, friction))
        .walls(WallContinuity, WallPressure { sound_speed })
        .build();
    let mut simulation = Simulation::new(&Solo, Team::new(1)?, model, scheme, state, walls, None)?;
    let mut next = 0.0;
    while simulation.time() < 1.0 {
        let report = simulation.time() >= next;
        if let Some(full) = simulation.step(report)? {
            let front = full.position.iter().map(|x| x[0]).fold(0.0, f64::max);
            let energy = budget(&Solo, simulation.model(), &full)?;
            println!(
                "t = {:.3} s  front = {front:.3} m  kinetic = {:.0} J/m  compression = {:.4}",
                full.time, energy.kinetic, energy.compression
            );
            next += 0.1;
        }
    }
    Ok(())
}
