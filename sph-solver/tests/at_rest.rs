//! A tank at rest stays at rest, and nothing leaves a closed box.

mod common;

use common::{Case, GRAVITY};
use sph_decomp::Solo;
use sph_solver::run::samples::budget;

/// Water over the whole floor of a tank, 20 particles deep.
const TANK: Case<2> = Case { column: [20, 20], tank: [20, 30], spacing: 0.05, skin: 0.15 };

#[test]
fn a_hydrostatic_tank_stays_at_rest() {
    let mut simulation = TANK.simulation::<f32>(&Solo, 1).unwrap();
    let scale = GRAVITY.sqrt();
    for _ in 0..2000 {
        simulation.step(false).unwrap();
    }
    let full = simulation.step(true).unwrap().unwrap();
    let budget = budget(&Solo, simulation.model(), &full).unwrap();
    let deepest = full.position.iter().position(|x| x[1] < 0.06).unwrap();
    let depth = 1.0 - full.position[deepest][1];
    let pressure = simulation.model().equation_of_state.pressure(full.density[deepest]);
    eprintln!(
        "speed {:.2e} of sqrt(gH), p/(rho g d) {:.4}",
        budget.speed / scale,
        pressure / (1000.0 * GRAVITY * depth)
    );
    assert!(budget.speed < 0.02 * scale, "{budget:?}");
    assert!((pressure / (1000.0 * GRAVITY * depth) - 1.0).abs() < 0.05);
}

#[test]
fn a_dam_break_stays_in_its_box_and_loses_energy() {
    let case = Case { column: [20, 40], tank: [60, 60], spacing: 0.025, skin: 0.15 };
    let mut simulation = case.simulation::<f32>(&Solo, 1).unwrap();
    let first = simulation.step(true).unwrap().unwrap();
    let before = budget(&Solo, simulation.model(), &first).unwrap();
    while simulation.time() < 1.0 {
        simulation.step(false).unwrap();
    }
    let full = simulation.step(true).unwrap().unwrap();
    let after = budget(&Solo, simulation.model(), &full).unwrap();
    let energy = |b: &sph_solver::run::samples::Budget<2>| b.kinetic + b.potential + b.elastic;
    eprintln!(
        "energy {:.1} -> {:.1}, compression {:.4}",
        energy(&before),
        energy(&after),
        after.compression
    );
    assert!(energy(&after) < energy(&before));
    assert_eq!(before.mass, after.mass);
    let dp = 0.025;
    for x in &full.position {
        assert!(
            x[0] > -0.5 * dp && x[0] < 60.5 * dp && x[1] > -0.5 * dp && x[1] < 60.5 * dp,
            "{x:?}"
        );
    }
    assert_eq!(simulation.counters().stale_steps, 0);
}
