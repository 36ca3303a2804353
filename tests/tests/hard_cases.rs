//! Cases on which schemes fail, in short. `SPH_LONG=1 cargo test --release -p sph-tests --test hard_cases --
//! --nocapture` runs them at full length and says what it measures; `docs/results/stability.md` has the table.
//! Coincident particles are a test of the solver itself, `sph-solver/tests/coincident.rs`.

use serde_json::Value;
use sph_tests::{Results, Run, Vtu, read_vtu, scene};
use std::time::Duration;

const G: f64 = 9.81;

/// A short length or a long one.
fn length(short: f64, long: f64) -> f64 {
    if std::env::var_os("SPH_LONG").is_some() { long } else { short }
}

/// Says a measured value beside its criterion.
fn tell(case: &str, criterion: &str, value: f64) {
    println!("{case}: {criterion}: {value:.3e}");
}

fn hard(name: &str) -> Run {
    Run::new(scene(&format!("hard/{name}"))).threads(1).patience(Duration::from_secs(3600))
}

/// Runs to the end; nothing is lost, numbers are finite, and steps are no shorter than a twentieth of those at
/// the start.
#[track_caller]
fn survives(run: Run) -> (Results, Value) {
    let results = Results::of(run);
    let summary = results.summary();
    assert_eq!(summary["lost_particles"], 0, "{summary:#}");
    for name in ["kinetic", "elastic"] {
        let joule = summary["energies"]["end"][name].as_f64();
        assert!(joule.is_some_and(f64::is_finite), "{summary:#}");
    }
    let mean = summary["simulated_time"].as_f64().unwrap() / summary["steps"].as_f64().unwrap();
    let last = summary["time_step"].as_f64().unwrap();
    assert!(last > 0.05 * mean, "steps collapsed from {mean} to {last}");
    (results, summary)
}

/// The fluid of the last snapshot.
fn last_snapshot(results: &Results) -> Vtu {
    let series = results.series();
    let fluid =
        series.iter().filter(|entry| entry.part == 0).max_by(|a, b| a.time.total_cmp(&b.time));
    read_vtu(&results.path().join(&fluid.expect("a snapshot").file))
}

fn points(vtu: &Vtu) -> Vec<[f64; 2]> {
    vtu.array("Points").values.chunks_exact(3).map(|x| [x[0], x[1]]).collect()
}

/// Case 1. Rest: |v| < 1e-3 √(g H) in the end.
fn rests(case: &str, run: Run, height: f64, bound: f64) {
    let (results, summary) = survives(run);
    let table = results.table("energies");
    let (speed, kinetic) = (table.column("speed"), table.column("kinetic"));
    let scale = (G * height).sqrt();
    let tail = speed.len() - speed.len() / 5..;
    let largest = speed[tail.clone()].iter().copied().fold(0.0, f64::max) / scale;
    tell(case, "largest |v|/sqrt(g H) in the last fifth", largest);
    let mass = summary["particles"]["fluid"].as_f64().unwrap();
    tell(case, "kinetic energy per particle, J", kinetic[kinetic.len() - 1] / mass);
    assert!(largest < bound, "{case}: {largest}");
}

#[test]
fn rest_in_a_tank() {
    let run = Run::new(scene("hydrostatic-2d")).set("numerics.spacing=0.05").threads(1);
    let run = run.set("output.energies=0.05").patience(Duration::from_secs(3600));
    rests("1 tank", run.end_time(length(10.0, 120.0)), 1.0, 5e-3);
}

#[test]
fn rest_in_a_wedge_of_30_degrees() {
    let run = hard("rest-in-a-wedge").end_time(length(6.0, 110.0));
    rests("1 wedge", run, 1.0, 0.1);
}

/// Case 2. Negative pressure: the square patch keeps its energy and its angular momentum.
#[test]
fn a_rotating_patch_under_tension() {
    let end = length(1.0, 8.0);
    let run = Run::new(scene("rotating-patch-2d")).set("numerics.spacing=0.04").end_time(end);
    let run = run.set("numerics.scheme=auto").set("output.snapshots=1").threads(1);
    let (results, summary) = survives(run.patience(Duration::from_secs(3600)));
    let energy = |when: &str| summary["energies"][when]["kinetic"].as_f64().unwrap();
    let lost = 1.0 - energy("end") / energy("start");
    tell("2", "kinetic energy lost", lost);
    let vtu = last_snapshot(&results);
    let velocity = vtu.array("velocity");
    let v = velocity.values.chunks_exact(velocity.components);
    let spin: f64 = points(&vtu).iter().zip(v).map(|(x, v)| x[0] * v[1] - x[1] * v[0]).sum();
    let series = results.series();
    let first = read_vtu(&results.path().join(&series[0].file));
    let velocity = first.array("velocity");
    let v = velocity.values.chunks_exact(velocity.components);
    let before: f64 = points(&first).iter().zip(v).map(|(x, v)| x[0] * v[1] - x[1] * v[0]).sum();
    tell("2", "change of angular momentum", spin / before - 1.0);
    assert!(lost.abs() < 0.1 && (spin / before - 1.0).abs() < 0.01, "{lost} {}", spin / before);
}

/// Case 3. Drops and pairs of drops fly as parabolas to 1e-6 m. A pair one over the other moves apart a
/// little: the density diffusion expects the hydrostatic difference, which free fall lacks.
#[test]
fn isolated_particles_fly_ballistically() {
    let (results, _) = survives(hard("drops"));
    let time = results.series().iter().map(|entry| entry.time).fold(0.0, f64::max);
    let vtu = last_snapshot(&results);
    let (ids, found) = (&vtu.array("id").values, points(&vtu));
    let starts: [([f64; 2], [f64; 2]); 6] = [
        ([0.01, 0.01], [1.0, 3.0]),
        ([-1.99, 1.01], [-0.5, 2.0]),
        ([2.01, 0.01], [0.7, 4.0]),
        ([2.03, 0.01], [0.7, 4.0]),
        ([4.01, 0.01], [0.3, 5.0]),
        ([4.01, 0.03], [0.3, 5.0]),
    ];
    let mut off = [[0.0; 2]; 6];
    for (id, x) in ids.iter().zip(&found) {
        let (x0, v) = starts[*id as usize];
        let fall = 0.5 * G * time * time;
        off[*id as usize] = [x[0] - x0[0] - v[0] * time, x[1] - x0[1] - v[1] * time + fall];
    }
    let length = |x: [f64; 2]| x[0].hypot(x[1]);
    let alone = off[..4].iter().map(|x| length(*x)).fold(0.0, f64::max);
    tell("3", "distance of drops and a level pair from the parabola, m", alone);
    let middle = length([0.5 * (off[4][0] + off[5][0]), 0.5 * (off[4][1] + off[5][1])]);
    tell("3", "distance of the middle of an upright pair from it, m", middle);
    tell("3", "distance of its drops from it, m", length(off[4]).max(length(off[5])));
    assert!(alone < 1e-6 && middle < 1e-6, "{alone} {middle}");
}

/// Case 5. Without walls momentum stays: |ΔP|/Σ m|v| < 1e-12 in double and 1e-5 in mixed precision.
#[test]
fn a_periodic_flow_keeps_its_momentum() {
    for (precision, bound) in [("double", 1e-12), ("mixed", 1e-5)] {
        let end = length(2.0, 60.0);
        let run = Run::new(scene("taylor-green-2d")).set("numerics.spacing=0.04").end_time(end);
        let run = run.set(&format!("numerics.precision={precision}")).threads(1);
        let (results, summary) = survives(run.patience(Duration::from_secs(3600)));
        let table = results.table("energies");
        let speed = table.column("speed")[0];
        let mut worst = 0.0_f64;
        for name in ["momentum_x", "momentum_y"] {
            let momentum = table.column(name);
            worst = momentum.iter().map(|p| (p - momentum[0]).abs()).fold(worst, f64::max);
        }
        // Σ m |v| at the start: 0.4 of mass times largest speed, for Taylor and Green's vortices.
        let share = worst / (0.4 * speed);
        let steps = summary["steps"].as_f64().unwrap();
        tell("5", &format!("|dP|/sum m|v| after {steps} steps, {precision}"), share);
        assert!(share < bound, "{precision}: {share}");
    }
}

/// Particles that a jet of this Mach number has brought to where `through` says.
fn brought(name: &str, mach: f64, set: Option<&str>, through: impl Fn([f64; 2]) -> bool) -> usize {
    let run = hard(&format!("jet-on-{name}")).set(&format!("numerics.sound_speed={}", 1.0 / mach));
    let (results, _) = survives(set.into_iter().fold(run, Run::set));
    let count = points(&last_snapshot(&results)).into_iter().filter(|x| through(*x)).count();
    tell(
        "7",
        &format!("particles through the {name} at Mach {mach} {}", set.unwrap_or("")),
        count as f64,
    );
    count
}

/// Case 7. Nothing comes through a blade of one spacing, a plate of two, and a corner of 30°.
#[test]
fn jets_do_not_come_through() {
    let plate = |thickness: f64| {
        format!(
            "solid=[{{name=\"plate\",box={{min=[0,-1],max=[{thickness},1]}},fluid_side=\"outside\"}}]"
        )
    };
    let slope = 15.0_f64.to_radians().tan();
    for mach in [0.1, 0.5] {
        let in_blade = |x: [f64; 2]| x[0] > 0.05 && x[1].abs() < 0.00625;
        assert_eq!(brought("knife", mach, None, in_blade), 0);
        let behind = |x: [f64; 2]| x[0] > 0.05 && x[1].abs() < 0.9;
        assert_eq!(brought("plate", mach, Some(&plate(0.05)), behind), 0);
        // One spacing holds too: each of its sides is a wall of its own, which a note tells.
        assert_eq!(brought("plate", mach, None, behind), 0);
    }
    let note = Run::check(scene("hard/jet-on-plate")).succeed().output;
    assert!(note.contains("each of its sides is a wall of its own"), "{note}");
    let outside = |x: [f64; 2]| x[0] > -0.8 && x[1].abs() > (0.5 - x[0]) * slope + 0.0125;
    assert_eq!(brought("corner", 0.1, None, outside), 0);
    let folder = tempfile::tempdir().unwrap();
    // A wedge that closes at half the speed of sound doubles the density, and the run says that it ends.
    let outcome =
        hard("jet-on-corner").set("numerics.sound_speed=2").out(folder.path().join("out")).fail(1);
    assert!(outcome.message.contains("diverged"), "{outcome}");
}

/// Case 8. At the default Courant number and 20 % above, energy does not grow by 1e-3.
#[test]
fn energy_does_not_grow() {
    for cfl in [1.0, 1.2] {
        for (name, end, long) in [("hydrostatic-2d", 2.0, 20.0), ("dam-break-2d", 1.5, 10.0)] {
            let run = Run::new(scene(name)).set("numerics.spacing=0.05").threads(1);
            let run = run.set(&format!("numerics.cfl={cfl}")).set("output.energies=0.02");
            let run = run.end_time(length(end, long)).patience(Duration::from_secs(3600));
            let (results, summary) = survives(run);
            let table = results.table("energies");
            let kinds = ["kinetic", "potential", "elastic"].map(|kind| table.column(kind));
            let energy = |row: usize| kinds.iter().map(|kind| kind[row]).sum::<f64>();
            let most = (0..table.rows.len()).map(energy).fold(0.0, f64::max) / energy(0) - 1.0;
            let steps = summary["steps"].as_f64().unwrap();
            tell("8", &format!("growth of energy, {name}, Courant {cfl}, {steps} steps"), most);
            assert!(most < 1e-3, "{name} at {cfl}: {most}");
        }
    }
}

#[test]
fn an_unstable_courant_number_is_refused_or_made_smaller() {
    let outcome = Run::check(scene("dam-break-2d")).set("numerics.cfl=1.8").fail(2);
    assert!(outcome.message.contains("numerics.cfl"), "{outcome}");
    let check = Run::check(scene("dam-break-2d")).set("numerics.density_diffusion=0.5").succeed();
    assert!(check.output.contains("steps have the Courant number 0.400"), "{check}");
}

/// Case 9. Violent sloshing: the 95th percentile of |δρ/ρ| stays below 2 %, the volume within 1 %.
#[test]
fn sloshing_stays_nearly_incompressible() {
    let (results, summary) = survives(hard("sloshing").end_time(length(2.5, 25.0)));
    let (mut percentile, mut volume) = (0.0_f64, 0.0_f64);
    for entry in results.series().iter().filter(|entry| entry.part == 0) {
        let vtu = read_vtu(&results.path().join(&entry.file));
        let density = &vtu.array("density").values;
        let mut off: Vec<f64> = density.iter().map(|density| (density / 1e3 - 1.0).abs()).collect();
        off.sort_by(f64::total_cmp);
        percentile = percentile.max(off[off.len() * 95 / 100]);
        let mean: f64 = density.iter().map(|density| 1e3 / density).sum::<f64>() / off.len() as f64;
        volume = volume.max((mean - 1.0).abs());
    }
    tell("9", "largest 95th percentile of |drho/rho|", percentile);
    tell("9", "largest change of volume", volume);
    tell("9", "largest Mach number", summary["largest_mach"]["number"].as_f64().unwrap());
    assert!(percentile < 0.02 && volume < 0.01, "{percentile} {volume}");
}

/// Case 10. A body of a tenth of the density of water, dropped into it, never gets faster than by its fall.
#[test]
fn a_light_body_is_not_thrown() {
    let (results, _) = survives(hard("light-body").end_time(length(1.5, 5.0)));
    let table = results.table("solid-box");
    let speed = |row: usize| {
        let of = |name: &str| table.column(name)[row];
        of("velocity_x").hypot(of("velocity_y"))
    };
    let fastest = (0..table.rows.len()).map(speed).fold(0.0, f64::max);
    // 0.2 m down to the water, and the buoyancy of a box that is pushed under by its fall.
    let fall = (2.0 * G * 0.2).sqrt();
    tell("10", "largest speed of the body / speed of its fall", fastest / fall);
    assert!(fastest < 1.2 * fall, "{fastest} m/s");
    let height = table.column("y");
    tell("10", "largest height of its middle, m", height.iter().copied().fold(0.0, f64::max));
}

/// A flow that is too fast for its sound is told of, while it runs and after.
#[test]
fn a_flow_beyond_mach_0_15_is_told() {
    let (_, summary) = survives(hard("jet-on-plate").set("numerics.sound_speed=5").end_time(0.1));
    assert!(summary["largest_mach"]["number"].as_f64().unwrap() > 0.15);
    assert!(summary["notes"].to_string().contains("beyond 0.15"), "{summary:#}");
}
