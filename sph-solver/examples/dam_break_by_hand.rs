//! A dam break put together from the library, without a scene file: particles, terms, steps.
//!
//! Run with `cargo run --release -p sph-solver --example dam_break_by_hand`.

use sph_decomp::Solo;
use sph_kernels::WendlandC2;
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost};
use sph_solver::physics::Terms;
use sph_solver::run::samples::budget;
use sph_solver::simulation::Simulation;
use sph_solver::state::{FLUID, State};
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, Continuity, DeltaContinuity, OneSidedRiemannWall, SymmetricPressure,
};
use sph_solver::timestep::StepLimits;

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
        skin: 0.1 * support_radius,
        gravity,
        equation_of_state,
        limits: StepLimits { cfl: 1.0, smoothing_length: h, sound_speed, kinematic_viscosity: 0.0 },
        domain: ([-0.5, -0.5], [4.5, 3.5]),
        on_lost: OnLost::Stop,
    };

    let mut state = State::<2>::default();
    let mut add = |x: [f64; 2], kind: u16, pressure: f64| {
        state.id.push(state.id.len() as u64);
        state.kind.push(kind);
        state.mass.push(density0 * dp * dp);
        state.density.push(equation_of_state.density(pressure));
        state.position.push(x);
        state.velocity.push([0.0; 2]);
    };
    let cells = |length: f64| (length / dp).round() as i32;
    let centre = |i: i32| (f64::from(i) + 0.5) * dp;
    let inside =
        |i, j, size: [f64; 2]| (0..cells(size[0])).contains(&i) && (0..cells(size[1])).contains(&j);
    for j in -3..cells(tank[1]) + 3 {
        for i in -3..cells(tank[0]) + 3 {
            let x = [centre(i), centre(j)];
            if inside(i, j, column) {
                add(x, FLUID, density0 * 9.81 * (column[1] - x[1]));
            } else if !inside(i, j, tank) {
                add(x, 1, 0.0);
            }
        }
    }

    let physics = Terms {
        fluid_density: DeltaContinuity {
            strength: 0.1 * h * sound_speed,
            hydrostatic_gradient: gravity.map(|g| g * density0 / (sound_speed * sound_speed)),
        },
        fluid_force: (
            SymmetricPressure,
            ArtificialViscosity {
                strength: 0.02 * h * sound_speed * density0,
                softening: 0.01 * h * h,
            },
        ),
        wall_density: Continuity,
        wall_force: OneSidedRiemannWall { gravity, sound_speed },
    };
    let mut simulation = Simulation::<2, f32, WendlandC2, _>::new(
        &Solo,
        Team::new(1)?,
        model,
        physics,
        state,
        None,
    )?;
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
