//! Which Courant numbers a scheme bears: two blocks that collide and a tank at rest, in the plane, at Courant
//! numbers that a scene would not be given, beside the limit that the solver sets.
//!
//! `cargo run --release -p sph-benches --bin courant`, two minutes on one core. Noise counts as unstable: more
//! than three times the elastic energy that the collision leaves at a Courant number of 0.4, or more than three
//! times the kinetic energy of the tank at rest, or energy that grows by a thousandth.

use sph_decomp::Solo;
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid};
use sph_kernels::WendlandC2;
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost, SolidModel};
use sph_solver::run::samples::budget;
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::stability::largest_courant;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    ArtificialViscosity, DeltaContinuity, Shifting, SymmetricPressure, WallContinuity, WallPressure,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;
use std::error::Error;

const DENSITY: f64 = 1000.0;
const SPACING: f64 = 0.05;
const SUPPORT: f64 = 3.0 * SPACING;
const H: f64 = 0.5 * SUPPORT;

/// What is varied.
#[derive(Clone, Copy)]
struct Choice {
    delta: f64,
    alpha: f64,
    shifts: bool,
}

/// A flow to try it on.
#[derive(Clone, Copy)]
enum Flow {
    /// Two square blocks at ±1 m/s without gravity.
    Collision,
    /// Water of 1 m × 1 m at rest in a tank.
    Tank,
}

/// Noise of a run: a mean energy over its second half (J/m), and the largest growth of the energy as a share.
struct Noise {
    energy: f64,
    growth: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| scheme | δ | α | collision: calm up to | tank: calm up to | limit of the solver |");
    println!("|---|---|---|---|---|---|");
    for shifts in [false, true] {
        for (delta, alpha) in
            [(0.1, 0.0), (0.1, 0.02), (0.1, 0.2), (0.05, 0.0), (0.2, 0.0), (0.3, 0.02)]
        {
            let choice = Choice { delta, alpha, shifts };
            let name = if shifts { "delta-plus" } else { "delta" };
            let calm = [Flow::Collision, Flow::Tank].map(|flow| largest_calm(flow, choice));
            let [collision, tank] = calm;
            let limit = largest_courant(delta, alpha);
            println!("| {name} | {delta} | {alpha} | {} | {} | {limit:.2} |", collision?, tank?);
        }
    }
    Ok(())
}

/// The largest Courant number before the first one at which a flow is noisy, and what happens there.
fn largest_calm(flow: Flow, choice: Choice) -> Result<String, Box<dyn Error>> {
    let Some(calm) = noise(flow, choice, 0.4)? else { return Ok("below 0.4".into()) };
    let mut last = 0.4;
    for k in 1..=26 {
        let courant = 0.4 + 0.05 * f64::from(k);
        let how = match noise(flow, choice, courant)? {
            None => "diverges".to_owned(),
            Some(noise) if noise.energy > 3.0 * calm.energy => {
                format!("noise × {:.1}", noise.energy / calm.energy)
            }
            Some(noise) if noise.growth > calm.growth + 1e-3 => {
                format!("energy + {:.1} %", 100.0 * noise.growth)
            }
            Some(_) => {
                last = courant;
                continue;
            }
        };
        return Ok(format!("{last:.2} (then {how})"));
    }
    Ok(format!("{last:.2}, the last one tried"))
}

/// The noise of a flow at a Courant number; none if the run ends with an error.
fn noise(flow: Flow, choice: Choice, cfl: f64) -> Result<Option<Noise>, Box<dyn Error>> {
    let (gravity, sound_speed, end) = match flow {
        Flow::Collision => ([0.0; 2], 50.0, 1.0),
        Flow::Tank => ([0.0, -9.81], 60.0, 4.0),
    };
    let equation_of_state = EquationOfState::Linear { density0: DENSITY, sound_speed };
    let model = Model {
        spacing: SPACING,
        support_radius: SUPPORT,
        grading: None,
        skin: 0.15 * SUPPORT,
        gravity,
        equation_of_state,
        limits: StepLimits { cfl, smoothing_length: H, sound_speed, kinematic_viscosity: 0.0 },
        domain: ([-9.0; 2], [9.0; 2]),
        periods: [None; 2],
        lowest_pressure: f64::NEG_INFINITY,
        closed: false,
        on_lost: OnLost::Remove,
        solids: vec![SolidModel { name: "tank".into(), center: [0.0; 2], slips: true, thin: None }],
    };
    let lattice = Lattice::new([0.0; 2], SPACING)?;
    let mut state = State::<2>::default();
    let lower = if matches!(flow, Flow::Tank) { [0.0; 2] } else { [-1.0, 0.0] };
    for x in sph_geometry::fill_lattice(&Shape::cuboid(lower, [1.0, 1.0])?, &lattice)? {
        let pressure = -DENSITY * gravity[1] * (1.0 - x[1]);
        let speed = if matches!(flow, Flow::Tank) { 0.0 } else { -x[0].signum() };
        state.id.push(state.id.len() as u64);
        state.mass.push(DENSITY * SPACING * SPACING);
        state.density.push(equation_of_state.density(pressure));
        state.position.push(x);
        state.velocity.push([speed, 0.0]);
    }
    let walls = match flow {
        Flow::Collision => WallElements::default(),
        Flow::Tank => {
            let shape = Shape::cuboid([0.0; 2], [1.0, 2.0])?;
            let tank = Solid::new("tank", shape, FluidSide::Inside);
            let domain = Domain::new(Aabb::new([0.0; 2], [1.0, 2.0]));
            WallElements::of_solids(&[tank], &lattice, SUPPORT, &domain, state.len() as u64)?
        }
    };
    let scheme = scheme(flow, choice, &model);
    let mut simulation = Simulation::new(&Solo, Team::new(1)?, model, scheme, state, walls, None)?;
    let (mut sum, mut count, mut start, mut most) = (0.0, 0.0, None, 0.0_f64);
    while simulation.time() < end {
        let report = simulation.steps().is_multiple_of(8);
        let Ok(full) = simulation.step(report) else { return Ok(None) };
        let Some(full) = full else { continue };
        let now = budget(&Solo, simulation.model(), &full)?;
        let energy = now.kinetic + now.potential + now.elastic;
        most = most.max(energy / *start.get_or_insert(energy) - 1.0);
        if full.time > 0.5 * end {
            sum += if matches!(flow, Flow::Tank) { now.kinetic } else { now.elastic };
            count += 1.0;
        }
    }
    Ok(Some(Noise { energy: sum / count, growth: most }))
}

fn scheme(flow: Flow, choice: Choice, model: &Model<2>) -> Scheme<2, f32> {
    let c0 = model.limits.sound_speed;
    let density = DeltaContinuity {
        strength: choice.delta * H * c0,
        hydrostatic_gradient: model.gravity.map(|g| g * DENSITY / (c0 * c0)),
    };
    let friction =
        ArtificialViscosity { strength: choice.alpha * H * c0 * DENSITY, softening: 0.01 * H * H };
    let builder = Scheme::of::<WendlandC2>(density, (SymmetricPressure, friction));
    let shifting = Shifting::<WendlandC2>::new(SUPPORT, SPACING);
    let builder = if choice.shifts { builder.shifting(shifting) } else { builder };
    match flow {
        Flow::Collision => builder.build(),
        Flow::Tank => {
            let builder = builder.walls(WallContinuity, WallPressure { sound_speed: c0 });
            if choice.shifts { builder.wall_shifting(shifting).build() } else { builder.build() }
        }
    }
}
