//! Solids that move: prescribed motion, free bodies, contacts, loads that balance, the same bits.

use sph_tests::{Results, Run, write_scene};
use std::f64::consts::PI;

fn run(text: &str) -> Results {
    let folder = tempfile::tempdir().expect("a scratch folder");
    Results::of(Run::new(write_scene(folder.path(), text)).threads(1))
}

/// A tank of water in which a box floats, half under water.
const FLOATING: &str = r#"name = "floating"
dimension = 2
end_time = 1.0
gravity = [0.0, -9.81]
[numerics]
spacing = 0.025
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{ difference = [
    { box = { min = [0, 0], max = [1.2, 0.5] } },
    { box = { min = [0.4, 0.3], max = [0.8, 0.7] } },
] }]
[[solid]]
name = "tank"
box = { min = [0, 0], max = [1.2, 1] }
fluid_side = "inside"
[[solid]]
name = "box"
box = { min = [0.4, 0.3], max = [0.8, 0.7] }
fluid_side = "outside"
body = { density = 500.0 }
[output]
energies = 0.05
"#;

#[test]
fn what_floats_stays_where_it_floats() {
    let results = run(FLOATING);
    let table = results.table("solid-box");
    let weight = 0.16 * 500.0 * 9.81;
    for (y, angle) in table.column("y").iter().zip(table.column("rotation_z")) {
        assert!((y - 0.5).abs() < 0.5 * 0.025, "its middle is at {y} m");
        assert!(angle.abs() < 0.01, "it leans by {angle} rad");
    }
    let lift = table.column("mean_force_y");
    let mean = lift[10..].iter().sum::<f64>() / (lift.len() - 10) as f64;
    assert!((mean / weight - 1.0).abs() < 0.02, "{mean} N/m carry {weight} N/m");
}

#[test]
fn water_body_and_tank_exchange_momentum_to_the_last_digit() {
    let text = FLOATING.replace("body = {", "body = { velocity = [0.3, -0.5], spin = 2.0,");
    let results = run(&text.replace("end_time = 1.0", "end_time = 0.3"));
    let (energies, tank, body) =
        (results.table("energies"), results.table("solid-tank"), results.table("solid-box"));
    let times = energies.times();
    let mass = 0.16 * 500.0;
    // The particles hold what the regions hold.
    let water = 1000.0 * (1.2 * 0.5 - 0.4 * 0.2);
    for (axis, gravity) in [("x", 0.0), ("y", -9.81)] {
        let momentum = energies.column(&format!("momentum_{axis}"));
        let velocity = body.column(&format!("velocity_{axis}"));
        let on_tank = tank.column(&format!("mean_force_{axis}"));
        let all = |k: usize| momentum[k] + mass * velocity[k];
        let mut impulse = 0.0;
        for k in 1..times.len() {
            let span = times[k] - times[k - 1];
            impulse += span * ((water + mass) * gravity - on_tank[k]);
            let found = all(k) - all(0);
            let scale = mass + water;
            assert!((found - impulse).abs() < 1e-7 * scale, "{axis}: {found} and {impulse}");
        }
    }
}

#[test]
fn a_tank_that_moves_is_as_one_at_rest() {
    let scene = |speed: f64| {
        format!(
            r#"name = "moving"
dimension = 2
end_time = 0.4
gravity = [0.0, -9.81]
[numerics]
spacing = 0.04
sound_speed = 30
precision = "double"
[domain]
min = [-1, -1]
max = [4, 2]
[fluid.water]
density = 1000.0
velocity = ["{speed}", "0"]
regions = [{{ box = {{ min = [0, 0], max = [0.4, 0.6] }} }}]
[[solid]]
name = "tank"
box = {{ min = [0, 0], max = [1, 1] }}
fluid_side = "inside"
motion = {{ velocity = [{speed}, 0.0] }}
[output]
energies = 0.1
[[probe]]
name = "front"
kind = "front"
axis = "x"
"#
        )
    };
    let [rests, moves] = [0.0, 1.0].map(|speed| run(&scene(speed)));
    let front = |results: &Results, speed: f64| {
        let table = results.table("probe-front");
        let mut row = table.times().into_iter().zip(table.column("x")).skip(1);
        row.next().map(|(t, x)| (t, x - speed * t)).expect("a row")
    };
    let (a, b) = (front(&rests, 0.0), front(&moves, 1.0));
    // Steps end at other times, at which the front has moved on a little.
    assert!((a.1 - b.1).abs() < 0.004 + 2.0 * (a.0 - b.0).abs(), "{a:?} and {b:?}");
    let force = |results: &Results| results.table("solid-tank").column("mean_force_y");
    for (a, b) in force(&rests).iter().zip(force(&moves)).skip(1) {
        assert!((a / b - 1.0).abs() < 0.02, "{a} and {b} N/m on the floor");
    }
}

#[test]
fn a_drum_takes_a_viscous_fluid_round() {
    let text = r#"name = "drum"
dimension = 2
end_time = 0.5
[numerics]
spacing = 0.05
sound_speed = 20
[domain]
min = [-1, -1]
max = [1, 1]
[fluid.water]
density = 1000.0
viscosity = 5.0
velocity = ["-2*y", "2*x"]
pressure = "2000*(x^2 + y^2)"
regions = [{ sphere = { center = [0, 0], radius = 0.5 } }]
[[solid]]
name = "drum"
sphere = { center = [0, 0], radius = 0.5 }
fluid_side = "inside"
motion = { rotation = "2*t" }
[output]
energies = 0.1
"#;
    let energy = run(text).table("energies").column("kinetic");
    let (first, last) = (energy[0], energy[energy.len() - 1]);
    assert!((last / first - 1.0).abs() < 0.01, "{first} J/m became {last} J/m");
}

/// Everything at once: a body on the floor, one on a spring, a paddle, contacts.
const TUMBLE: &str = r#"name = "tumble"
dimension = 2
end_time = 0.5
gravity = [0.0, -9.81]
[numerics]
spacing = 0.03
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{ box = { min = [0, 0], max = [0.48, 0.48] } }]
[[solid]]
name = "tank"
box = { min = [0, 0], max = [2, 1.2] }
fluid_side = "inside"
[[solid]]
name = "box"
box = { min = [0.8, 0.0], max = [1.0, 0.2] }
fluid_side = "outside"
body = { density = 300.0, friction = 0.3 }
[[solid]]
name = "log"
sphere = { center = [0.8, 0.6], radius = 0.1 }
fluid_side = "outside"
body = { density = 600.0, restitution = 0.2, springs = [
    { anchor = [0.8, 1.1], stiffness = 200.0, damping = 5.0 },
] }
[[solid]]
name = "paddle"
box = { min = [1.5, 0.05], max = [1.55, 0.5] }
fluid_side = "outside"
motion = { displacement = ["0.05*sin(6*t)", "0"], rotation = "0.4*sin(6*t)", about = [1.525, 0.05] }
[output]
energies = 0.05
snapshots = 0.25
"#;

#[test]
fn bodies_move_by_the_same_bits_on_any_ranks_and_after_a_restart() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let scene = write_scene(folder.path(), TUMBLE);
    let run =
        |ranks: usize, threads: usize| Results::of(Run::new(&scene).ranks(ranks).threads(threads));
    let alone = run(1, 1);
    let tables = ["solid-box", "solid-log", "solid-paddle", "solid-tank", "energies"];
    let same = |other: &Results, what: &str| {
        assert_eq!(other.summary()["state_digest"], alone.summary()["state_digest"], "{what}");
        for name in tables {
            let text = |results: &Results| {
                std::fs::read_to_string(results.path().join(format!("{name}.csv")))
                    .expect("a table")
            };
            assert_eq!(text(other), text(&alone), "{what}: {name}");
        }
    };
    for (ranks, threads) in [(1, 2), (2, 1), (5, 1)] {
        same(&run(ranks, threads), &format!("{ranks} ranks, {threads} threads"));
    }
    let parts = Results::of(Run::new(&scene).threads(1).checkpoint_every(0.1).end_time(0.3));
    parts.add(Run::new(&scene).ranks(2).threads(1).resume());
    same(&parts, "after a restart");
}

#[test]
fn a_body_on_a_spring_swings_with_its_period() {
    let text = r#"name = "swing"
dimension = 2
end_time = 2.0
gravity = [0.0, 0.0]
[numerics]
spacing = 0.05
sound_speed = 20
[domain]
min = [-3, -3]
max = [3, 3]
[fluid.water]
density = 1000.0
regions = [{ box = { min = [2, 2], max = [2.5, 2.5] } }]
[[solid]]
name = "bob"
box = { min = [-0.1, -1.1], max = [0.1, -0.9] }
fluid_side = "outside"
body = { mass = 10.0, fixed = ["x", "rotation-z"], velocity = [0.0, 0.5], springs = [
    { anchor = [0, 0], stiffness = 400.0 },
] }
[output]
energies = 0.01
"#;
    let results = run(text);
    let table = results.table("solid-bob");
    let pulse = (400.0_f64 / 10.0).sqrt();
    for (t, y) in table.times().iter().zip(table.column("y")) {
        let exact = -1.0 + 0.5 / pulse * (pulse * t).sin();
        assert!((y - exact).abs() < 1e-4, "{y} m and {exact} m at t = {t}");
    }
    assert!(2.0 * PI / pulse < 1.0, "it swings more than once");
}

#[test]
fn what_cannot_move_is_refused_with_the_way_out() {
    let line = "body = { density = 500.0 }";
    for (wrong, words) in [
        ("body = { density = 500.0 }\nmotion = { spin = 1.0 }", "both a `motion` and a `body`"),
        ("body = {}", "neither of `density` and `mass`"),
        ("body = { density = -1.0 }", "positive"),
        ("body = { mass = 1.0, inertia = [1, 2, 3] }", "has 3 numbers"),
        ("body = { mass = 1.0, fixed = [\"z\"] }", "no such degree of freedom"),
        ("body = { mass = 1.0, axis = [0, 0, 1] }", "no meaning in two dimensions"),
        ("motion = {}", "in one way how the solid moves"),
        ("motion = { velocity = [1, 0], rotation = \"t\" }", "in one way how the solid moves"),
        ("motion = { displacement = [\"x\", \"0\"] }", "it uses x, but it is a function of time"),
        ("motion = { rotation = \"1/t\" }", "not defined at t = 0"),
        ("motion = { table = \"nowhere.csv\" }", "nowhere.csv"),
    ] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let scene = write_scene(folder.path(), &FLOATING.replace(line, wrong));
        let outcome = Run::new(scene).threads(1).fail(2);
        outcome.message.assert_contains(&[words]);
    }
    let folder = tempfile::tempdir().expect("a scratch folder");
    std::fs::write(folder.path().join("path.csv"), "time,x\n0,0\n0,1\n").expect("a file");
    let table = "motion = { table = \"path.csv\" }";
    let scene = write_scene(folder.path(), &FLOATING.replace(line, table));
    let outcome = Run::new(scene).threads(1).fail(2);
    outcome.message.assert_contains(&["row 3 is not later than before"]);
}
