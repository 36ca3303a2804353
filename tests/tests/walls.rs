//! What walls do: exact slip at any angle, friction, loads that balance, periodic sides.

use sph_tests::{Results, Run, write_scene};
use std::f64::consts::PI;

/// Block of water 1 m × 0.4 m on a frictionless floor; everything is turned by an angle, the lattice
/// is not. It slides at 1 m/s under gravity normal to the floor, or starts from rest under gravity that
/// points down.
fn block(degrees: f64, slides: bool) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned = |x: f64, y: f64| format!("[{:.9}, {:.9}]", x * cos - y * sin, x * sin + y * cos);
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.0, 0.4)].map(|(x, y)| turned(x, y));
    let gravity = if slides { turned(0.0, -9.81) } else { "[0.0, -9.81]".into() };
    let speed = if slides { 1.0 } else { 0.0 };
    format!(
        r#"name = "block"
dimension = 2
end_time = 0.5
gravity = {gravity}

[numerics]
spacing = 0.04

[domain]
min = [-4, -4]
max = [4, 4]

[fluid.water]
density = 1000.0
velocity = ["{}", "{}"]
regions = [{{ polygon = [{}] }}]

[[solid]]
name = "floor"
plane = {{ point = [0, 0], normal = {} }}

[output]
energies = 0.05
"#,
        speed * cos,
        speed * sin,
        corners.join(", "),
        turned(0.0, 1.0),
    )
}

/// Momentum along a floor at this angle, kg m/s, at the times of the rows.
fn along(results: &Results, degrees: f64) -> Vec<(f64, f64)> {
    let energies = results.table("energies");
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (x, y) = (energies.column("momentum_x"), energies.column("momentum_y"));
    let momenta = x.iter().zip(&y).map(|(x, y)| x * cos + y * sin);
    energies.times().into_iter().zip(momenta).collect()
}

fn run(text: &str) -> Results {
    let folder = tempfile::tempdir().expect("a scratch folder");
    Results::of(Run::new(write_scene(folder.path(), text)).threads(1))
}

#[test]
fn what_slides_along_a_plane_keeps_its_momentum() {
    for degrees in [0.0, 17.0, 30.0, 45.0] {
        let momenta = along(&run(&block(degrees, true)), degrees);
        let (first, last) = (momenta[0].1, momenta[momenta.len() - 1].1);
        assert!((last / first - 1.0).abs() < 0.005, "{degrees}°: {first} to {last} kg m/s");
    }
}

#[test]
fn what_slides_down_a_plane_falls_freely_along_it() {
    for degrees in [17.0, 45.0] {
        let momenta = along(&run(&block(degrees, false)), degrees);
        let sin = f64::to_radians(degrees).sin();
        let mass = mass_of(&block(degrees, false));
        let (time, momentum) = momenta[momenta.len() - 1];
        let share = -momentum / (mass * 9.81 * sin * time);
        assert!((share - 1.0).abs() < 0.01, "{degrees}°: {share} of free fall");
    }
}

/// Nothing is under pressure in a fluid that falls: a wall beside it does not carry it, from the first step on.
#[test]
fn what_falls_along_a_wall_falls_freely() {
    let text = r#"name = "fall"
dimension = 2
end_time = 0.1
gravity = [0, -9.81]
[domain]
min = [-1, -1]
max = [1, 1]
[numerics]
spacing = 0.04
[fluid.water]
density = 1000.0
regions = [{ box = { min = [0, 0], max = [0.4, 0.4] } }]
[[solid]]
name = "wall"
plane = { point = [0, 0], normal = [1, 0] }
[output]
energies = 0.05
"#;
    let energies = run(text).table("energies");
    let (times, momentum) = (energies.times(), energies.column("momentum_y"));
    let last = times.len() - 1;
    let share = momentum[last] / (-9.81 * 1000.0 * 0.16 * times[last]);
    assert!((share - 1.0).abs() < 1e-3, "{share} of free fall");
}

/// Water on both sides of a wall that stands in its tank as a solid of its own stays at rest.
#[test]
fn water_in_the_corner_of_two_solids_stays_at_rest() {
    let text = r#"name = "corner"
dimension = 2
end_time = 2.0
gravity = [0, -9.81]
[numerics]
spacing = 0.02
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{ box = { min = [0, 0], max = [0.4, 0.4] } }, { box = { min = [0.52, 0], max = [1, 0.4] } }]
[[solid]]
name = "tank"
box = { min = [0, 0], max = [1, 0.8] }
fluid_side = "inside"
[[solid]]
name = "wall"
box = { min = [0.4, -0.1], max = [0.52, 0.8] }
fluid_side = "outside"
[output]
energies = 0.05
"#;
    let speed = run(text).table("energies").column("speed");
    let late = speed[speed.len() / 2..].iter().copied().fold(0.0, f64::max);
    let scale = f64::sqrt(9.81 * 0.4);
    assert!(late < 0.01 * scale, "{} √(gH)", late / scale);
}

/// Mass of the water of a scene, kg per metre of depth.
fn mass_of(text: &str) -> f64 {
    let summary = run(text).summary();
    let particles = summary["particles"]["fluid"].as_u64().expect("a count");
    particles as f64 * 1000.0 * 0.04 * 0.04
}

#[test]
fn loads_are_what_the_fluid_feels() {
    let text = r#"name = "loads"
dimension = 2
end_time = 0.4
gravity = [0.0, -9.81]
[numerics]
spacing = 0.025
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{ box = { min = [0, 0], max = [0.4, 0.5] } }]
[[solid]]
name = "tank"
box = { min = [0, 0], max = [1, 1] }
fluid_side = "inside"
[[solid]]
name = "post"
box = { min = [0.7, 0], max = [0.8, 0.3] }
fluid_side = "outside"
[output]
energies = 0.02
"#;
    let results = run(text);
    let (energies, tank, post) =
        (results.table("energies"), results.table("solid-tank"), results.table("solid-post"));
    let times = energies.times();
    let weight = 1000.0 * 0.4 * 0.5 * 9.81;
    for (axis, pull) in [("x", 0.0), ("y", -weight)] {
        let momentum = energies.column(&format!("momentum_{axis}"));
        let mean = format!("mean_force_{axis}");
        let (on_tank, on_post) = (tank.column(&mean), post.column(&mean));
        for k in 1..times.len() {
            // What the fluid gains is what gravity gives and the solids lose.
            let gained = (momentum[k] - momentum[k - 1]) / (times[k] - times[k - 1]);
            let lost = on_tank[k] + on_post[k];
            assert!(
                (gained + lost - pull).abs() < 1e-6 * weight,
                "{axis} at {}: {gained} {lost}",
                times[k]
            );
        }
    }
    // The post is hit; before the water arrives it feels nothing.
    let force = post.column("force_x");
    assert_eq!(force[2], 0.0);
    assert!(force.iter().copied().fold(0.0, f64::max) > 100.0, "{force:?}");
    // The floor carries the weight at the start.
    let carried = tank.column("force_y")[0] / -weight;
    assert!((carried - 1.0).abs() < 0.02, "{carried}");
}

/// A viscous fluid of 1 m height between two walls, without ends along x; with keys for the scene, the fluid
/// and both walls, and what is written.
fn channel(keys: &str, of_fluid: &str, of_walls: &str, output: &str) -> String {
    format!(
        r#"name = "channel"
dimension = 2
{keys}
periodic = ["x"]
[domain]
min = [0, -0.2]
max = [0.4, 1.2]
[numerics]
spacing = 0.05
sound_speed = 10
[fluid.water]
density = 1.0
viscosity = 0.1
{of_fluid}regions = [{{ box = {{ min = [0, 0], max = [0.4, 1] }} }}]
[[solid]]
name = "bottom"
plane = {{ point = [0, 0], normal = [0, 1] }}
{of_walls}[[solid]]
name = "top"
plane = {{ point = [0, 1], normal = [0, -1] }}
{of_walls}{output}"#
    )
}

/// Plane Poiseuille flow between x-periodic sides, started from rest: the series of Batchelor (1967).
#[test]
fn poiseuille_flow_starts_as_its_series_says() {
    let output = "[[probe]]\nname = \"middle\"\nat = [0.2, 0.5]\nfields = [\"velocity\"]\n\
                  [output]\nenergies = 0.25\n";
    let text = channel("end_time = 1.0\ngravity = [0.8, 0]", "", "", output);
    let results = run(&text);
    let middle = results.table("probe-middle");
    let (times, found) = (middle.times(), middle.column("velocity_x"));
    for (t, u) in times.iter().zip(found).skip(1) {
        let term = |n: f64| {
            let k = (2.0 * n + 1.0) * PI;
            4.0 * 0.8 / (0.1 * k.powi(3)) * (-0.1 * k * k * t).exp() * (0.5 * k).sin()
        };
        let exact = 0.8 / (8.0 * 0.1) - (0..20).map(|n| term(f64::from(n))).sum::<f64>();
        assert!((u / exact - 1.0).abs() < 0.02, "u = {u} at t = {t}, {exact} expected");
    }
    // Both walls drag on the fluid, by friction alone, and they do so alike.
    let [bottom, top] = ["bottom", "top"].map(|name| results.table(&format!("solid-{name}")));
    let last = |table: &sph_tests::Table, name: &str| *table.column(name).last().expect("a row");
    let drag = last(&bottom, "friction_force_x");
    assert!(drag > 0.05 && (drag / last(&top, "friction_force_x") - 1.0).abs() < 0.01, "{drag}");
}

#[test]
fn a_viscous_fluid_slips_along_a_wall_that_says_so() {
    let slips = "wall_friction = \"slip\"\n";
    let output = "[output]\nenergies = 0.1\n";
    let text = channel("end_time = 0.4", "velocity = [\"1\", \"0\"]\n", slips, output);
    let results = run(&text);
    let energies = results.table("energies");
    // Nothing holds it back.
    for (t, momentum) in energies.times().iter().zip(energies.column("momentum_x")) {
        assert!((momentum - 0.4).abs() < 1e-9, "{momentum} kg m/s at t = {t}");
    }
    for name in ["bottom", "top"] {
        let friction = results.table(&format!("solid-{name}")).column("friction_force_x");
        assert!(friction.iter().all(|force| *force == 0.0), "{name}: {friction:?}");
    }
}

/// Taylor–Green vortices in a box without sides (Taylor & Green 1937), shifted.
fn vortices(scheme: &str) -> String {
    format!(
        r#"name = "vortices"
dimension = 2
end_time = 0.5
periodic = ["x", "y"]
[domain]
min = [0, 0]
max = [1, 1]
[numerics]
spacing = 0.0125
sound_speed = 10
scheme = "{scheme}"
[fluid.water]
density = 1.0
viscosity = 0.01
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
pressure = "-0.25*(cos(4*pi*x) + cos(4*pi*y))"
regions = [{{ box = {{ min = [0, 0], max = [1, 1] }} }}]
[output]
energies = 0.1
"#
    )
}

#[test]
fn a_periodic_flow_has_the_same_bits_on_any_ranks_and_decays_as_it_should() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let scene = write_scene(folder.path(), &vortices("delta-plus"));
    let of = |ranks: usize| Results::of(Run::new(&scene).ranks(ranks).threads(1)).summary();
    let alone = of(1);
    for ranks in [2, 5] {
        assert_eq!(of(ranks)["state_digest"], alone["state_digest"], "{ranks} ranks");
    }
    let energy = |when: &str| alone["energies"][when]["kinetic"].as_f64().expect("an energy");
    let exact = (-16.0 * PI * PI * 0.01 * 0.5).exp();
    let found = energy("end") / energy("start");
    assert!((found / exact - 1.0).abs() < 0.02, "{found} of the energy is left, {exact} expected");
    for k in 0..2 {
        assert!(alone["momentum"][k].as_f64().expect("a number").abs() < 1e-6);
    }
    assert_eq!(alone["lost_particles"], 0);
}
