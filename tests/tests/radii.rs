//! Particles of different spacings: at rest, in motion, on any ranks, after a restart.

use sph_tests::{Results, Run, write_scene};
use std::path::Path;

/// A tank of 2 m × 0.8 m whose particles are eight times finer around a point of the floor or of the surface.
fn tank(height: f64, end_time: f64) -> String {
    format!(
        r#"name = "graded"
dimension = 2
end_time = {end_time}
gravity = [0.0, -9.81]

[numerics]
spacing = 0.04

[[refine]]
factor = 8
sphere = {{ center = [1.0, {height}], radius = 0.05 }}
within = 0.05

[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{{ box = {{ min = [0, 0], max = [2, 0.8] }} }}]

[[solid]]
name = "tank"
box = {{ min = [0, 0], max = [2, 1.2] }}
fluid_side = "inside"

[output]
energies = 0.05
"#
    )
}

/// A full box without walls that repeats, whose fluid flows through a band of fine particles.
const PERIODIC: &str = r#"name = "stream"
dimension = 2
end_time = 0.5
periodic = ["x", "y"]
domain = { min = [0, 0], max = [2, 1] }

[numerics]
spacing = 0.04
sound_speed = 12.0
precision = "double"

[[refine]]
factor = 4
box = { min = [0.9, 0.4], max = [1.1, 0.6] }

[fluid.water]
density = 1000.0
velocity = ["1 + 0.2*sin(2*pi*y)", "0.2*cos(pi*x)"]
regions = [{ box = { min = [0, 0], max = [2, 1] } }]

[output]
energies = 0.05
"#;

fn run(folder: &Path, text: &str) -> Results {
    Results::of(Run::new(write_scene(folder, text)).threads(1))
}

#[test]
fn a_graded_tank_stays_at_rest() {
    let wave = (9.81_f64 * 0.8).sqrt();
    for height in [0.0, 0.8] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let results = run(folder.path(), &tank(height, 1.0));
        let energies = results.table("energies");
        let (kinetic, potential) = (energies.column("kinetic"), energies.column("potential"));
        // Root of the mean square of the speed: the water weighs 1600 kg.
        let fastest = kinetic.iter().fold(0.0_f64, |most, k| most.max((2.0 * k / 1600.0).sqrt()));
        assert!(fastest < 6e-3 * wave, "refined at {height} m: {fastest} m/s");
        // The surface sinks by less than a tenth of a coarse spacing.
        let sunk = (potential[0] - potential[potential.len() - 1]) / potential[0];
        assert!(sunk.abs() < 2e-3, "refined at {height} m: {sunk}");
    }
}

#[test]
fn a_stream_through_a_fine_band_keeps_its_momentum() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let results = run(folder.path(), PERIODIC);
    let energies = results.table("energies");
    for axis in ["momentum_x", "momentum_y"] {
        let momentum = energies.column(axis);
        let change = (momentum[momentum.len() - 1] - momentum[0]).abs() / 2000.0;
        assert!(change < 1e-12, "{axis}: {change}");
    }
    let kinetic = energies.column("kinetic");
    assert!(kinetic[kinetic.len() - 1] > 0.98 * kinetic[0], "{kinetic:?}");
}

#[test]
fn graded_runs_have_the_same_bits_on_any_ranks_and_after_a_restart() {
    for text in [tank(0.8, 0.1), PERIODIC.replace("end_time = 0.5", "end_time = 0.1")] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let scene = write_scene(folder.path(), &text);
        let outcome = |run: Run| {
            let summary = Results::of(run).summary();
            (summary["state_digest"].clone(), summary["pair_interactions"].clone())
        };
        let alone = outcome(Run::new(&scene).ranks(1).threads(1));
        for (ranks, threads) in [(1, 2), (2, 1), (3, 1), (5, 1), (8, 1)] {
            let other = outcome(Run::new(&scene).ranks(ranks).threads(threads));
            assert_eq!(other, alone, "{ranks} ranks of {threads} threads");
        }
        let results = Results::new();
        let begun = Run::new(&scene).ranks(2).threads(1).checkpoint_every(0.02);
        results.add(begun.end_time(0.05));
        results.add(Run::new(&scene).ranks(3).threads(1).end_time(0.1).resume());
        let summary = results.summary();
        assert!(summary["resumed_at"].as_f64().is_some_and(|time| time > 0.0), "{summary:#}");
        assert_eq!(summary["state_digest"], alone.0, "after a restart");
    }
}

#[test]
fn everything_refined_is_the_scene_with_a_smaller_spacing() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let all = tank(0.0, 0.2).replace("factor = 8", "factor = 2").replace(
        "sphere = { center = [1.0, 0], radius = 0.05 }",
        "box = { min = [-1, -1], max = [3, 3] }",
    );
    let plain: String = {
        let (before, rest) = all.split_once("[[refine]]").expect("a refinement");
        let (_, after) = rest.split_once("within = 0.05").expect("its last key");
        format!("{before}{after}").replace("spacing = 0.04", "spacing = 0.02")
    };
    let [all, plain] = [all, plain].map(|text| {
        let own = tempfile::tempdir_in(folder.path()).expect("a scratch folder");
        let results = run(own.path(), &text);
        (
            results.summary()["pair_interactions"].clone(),
            results.table("energies").column("potential"),
        )
    });
    assert_eq!(all.0, plain.0);
    for (one, other) in all.1.iter().zip(&plain.1) {
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}

#[test]
fn mistakes_in_refinements_are_explained() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    for (from, to, expected) in [
        ("factor = 8", "factor = 3", "2, 4, 8 or 16"),
        ("within = 0.05", "growth = 1.5", "between 1.01 and 1.1"),
        ("within = 0.05", "solid = \"tank\"", "has a shape and names solid"),
        (
            "sphere = { center = [1.0, 0], radius = 0.05 }",
            "solid = \"tonk\"",
            "did you mean `tank`",
        ),
    ] {
        let text = tank(0.0, 0.1).replace(from, to);
        assert!(text.contains(to), "{from}");
        let scene = write_scene(folder.path(), &text);
        Run::check(&scene).fail(2).message.assert_contains(&[expected]);
    }
}
