//! A pair term of one's own beside those of the crate: a drop that is pulled apart, with and without it.
//!
//! Run with `cargo run --release -p sph-solver --example own_term`.

use sph_decomp::Solo;
use sph_kernels::{Kernel, Lanes, Real, WendlandC2};
use sph_solver::eos::EquationOfState;
use sph_solver::model::{Model, OnLost};
use sph_solver::scheme::Scheme;
use sph_solver::simulation::Simulation;
use sph_solver::state::State;
use sph_solver::team::Team;
use sph_solver::terms::{
    DeltaContinuity, Pair, PairTerm, Pressure, Source, SymmetricPressure, Target,
};
use sph_solver::timestep::StepLimits;
use sph_solver::walls::WallElements;

/// Repulsion under tension: dv_i/dt += (1/ρ_i) Σ_j ε (min(p_i, 0) + min(p_j, 0)) (W_ij/W(Δx))⁴ ∇W_ij V_j,
/// so that particles in a fluid that is pulled apart do not clump.
///
/// Source: Monaghan (2000), J. Comput. Phys. 159, "SPH without a tensile instability", for negative pressures.
#[derive(Debug, Clone, Copy)]
struct Repulsion {
    /// ε.
    strength: f64,
    /// Support radius R, m.
    support_radius: f64,
    /// Distance of the particles at the start Δx, m.
    spacing: f64,
}

impl<const D: usize> PairTerm<D, Pressure> for Repulsion {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        let constant = |value: f64| L::splat(<L::Scalar as Real>::from_f64(value));
        let q = pair.distance * pair.unit * constant(1.0 / self.support_radius);
        let at_spacing: f64 = WendlandC2::w(self.spacing / self.support_radius);
        let ratio = WendlandC2::w(q) * constant(1.0 / at_spacing);
        let tension = i.quantity.min(L::zero()) + j.quantity.min(L::zero());
        let square = ratio * ratio;
        constant(self.strength) * tension * square * square
    }
}

/// Steps until 0.3 s and returns the smallest distance between two particles, m.
fn closest(force: impl PairTerm<2, Pressure> + 'static) -> Result<f64, Box<dyn std::error::Error>> {
    let (dp, radius, density0, sound_speed) = (0.05, 0.5, 1000.0, 40.0);
    let (h, support_radius) = (1.5 * dp, 3.0 * dp);
    let model = Model {
        spacing: dp,
        support_radius,
        grading: None,
        skin: 0.1 * support_radius,
        gravity: [0.0; 2],
        equation_of_state: EquationOfState::Linear { density0, sound_speed },
        limits: StepLimits { cfl: 1.0, smoothing_length: h, sound_speed, kinematic_viscosity: 0.0 },
        domain: ([-5.0; 2], [5.0; 2]),
        periods: [None; 2],
        lowest_pressure: f64::NEG_INFINITY,
        closed: false,
        on_lost: OnLost::Stop,
        solids: Vec::new(),
    };
    let mut state = State::<2>::default();
    for (a, b) in (-10..10).flat_map(|a| (-10..10).map(move |b| (a, b))) {
        let x = [a, b].map(|k| (f64::from(k) + 0.5) * dp);
        if x[0].hypot(x[1]) < radius {
            state.id.push(state.id.len() as u64);
            state.mass.push(density0 * dp * dp);
            state.density.push(density0);
            state.position.push(x);
            // It grows to all sides.
            state.velocity.push([2.0 * x[0], 2.0 * x[1]]);
        }
    }
    let density =
        DeltaContinuity { strength: 0.1 * h * sound_speed, hydrostatic_gradient: [0.0; 2] };
    let scheme = Scheme::<2, f64>::of::<WendlandC2>(density, force).build();
    let walls = WallElements::default();
    let mut simulation = Simulation::new(&Solo, Team::new(1)?, model, scheme, state, walls, None)?;
    let mut last = None;
    while simulation.time() < 0.3 {
        last = simulation.step(true)?;
    }
    let places = last.ok_or("there was no step")?.position;
    let pairs =
        places.iter().enumerate().flat_map(|(k, a)| places[..k].iter().map(move |b| (a, b)));
    Ok(pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(f64::INFINITY, f64::min))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let repulsion = Repulsion { strength: 0.2, support_radius: 0.15, spacing: 0.05 };
    println!("closest pair without the term: {:.4} m", closest(SymmetricPressure)?);
    println!("closest pair with the term:    {:.4} m", closest((SymmetricPressure, repulsion))?);
    Ok(())
}
